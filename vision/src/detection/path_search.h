// One path of a known shape through pictures of reduced size, and the still
// layer behind it, in turn (layered_start.h has the equations). OpenCV's
// matrices: for layered_start.cc.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "detection/shape_search.h"
#include "detection/still_layer.h"

namespace touchdown::vision {

// What a path is sought in and with. Places are in the pictures' cells.
struct PathSearch {
  const ReducedFrames& sampled;
  ChangeScale scale;
  double noise_dn = 1.0;  // of a cell
  KnownShape shape;       // cells
  std::int32_t by = 1;    // cells of a searched cell's side
  int threads = 0;
};

// The same shape in cells of `by` of the former ones.
KnownShape ReducedShape(const KnownShape& shape, double by);

// Where the shape may be in pictures: where they differ from `still`.
class PlaceFinder {
 public:
  PlaceFinder(const PathSearch& in, const ReducedFrames& pictures,
              const StillLayer& still);

  // The box of what changes in any picture, with half of the shape's diagonal
  // to all sides; empty where nothing does.
  const cv::Rect& searched() const { return searched_; }
  bool has_many_angles() const { return search_.angles() > 1; }

  // The best places for one picture's change in that box; every `every`-th
  // angle is tried.
  std::vector<PlacedShape> Find(const cv::Mat& change, std::size_t every) const;

 private:
  std::int32_t by_;
  cv::Rect searched_;
  ShapeSearch search_;
};

// Marks the cells inside the shape with 1, grown by `grow` cells.
cv::Mat MakeMask(const PlacedShape& at, const KnownShape& shape, double grow,
                 const cv::Size& size);

// Cells by which masks are grown, so that none of the body is taken for the
// still layer: its blur, and the path's error.
double MaskMargin(const KnownShape& shape);

struct FoundPath {
  std::vector<PlacedShape> places;  // of each picture
  double cost = 0.0;                // LinkedPath::cost
  StillLayer still;                 // that it was found before
};

// From a first still layer on, at most `rounds` times; once where that is the
// pictures' median (`is_median`) and the path leaves it right. No place where
// nothing differs from the first layer.
FoundPath FindPathFrom(const PathSearch& in, StillLayer still, bool is_median,
                       int rounds);

// Change that the shape on its path leaves unexplained, cells of all pictures:
// E of an uncovered cell, 1 - E of a covered one. Of two paths the one that
// leaves less is the better.
double MeasureUnexplained(const PathSearch& in, const FoundPath& path);

}  // namespace touchdown::vision
