// The blurred coverage of pixels by a disc or a rectangle that may move while
// the shutter is open, with its derivatives: the model that outline.cc fits.
// By far most of a fit's time is here and in outline_sums.h, so pixels are
// taken in blocks (lanes.h).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "touchdown/core/points.h"
#include "touchdown/vision/outline/outline.h"

namespace touchdown::vision {

// Pixels are worked on so many at a time: their numbers stay in the processor's
// nearest cache.
inline constexpr std::size_t kBlock = 64;
using BlockColumn = std::array<float, kBlock>;

// The coverage of each pixel of a block and its derivatives.
struct alignas(64) CoverBlock {
  BlockColumn value;
  std::array<BlockColumn, 5> d_shape;  // by x, y, size, other size, angle
  BlockColumn d_blur;
  BlockColumn d_open;  // by the share of the frame interval that is exposed
  BlockColumn xi;      // position in the body, in units of its size
  BlockColumn eta;
};

// The places of the exposure at which the body is looked at, and their weights:
// panels of at most 2.1 w of the farthest point's way with three nodes of Gauss
// and Legendre each, or two nodes for up to 0.9 w: 4e-4 of the contrast.
class Smear {
 public:
  // Of the body in one frame interval; `reach_px`: to its farthest point.
  Smear(const core::PixelPoint& travel_px, double turn_rad, double reach_px)
      : travel_px_(travel_px), turn_rad_(turn_rad), reach_px_(reach_px) {}

  // `open`: the share of the frame interval that is exposed. With `resolved`
  // even a way that adds nothing is divided, for its derivative.
  void Set(double blur_px, double open, bool resolved);

  double way_px() const;  // during the exposure, of the farthest point
  bool IsResolved() const { return nodes_.size() > 1; }

 private:
  friend class OutlineImage;

  core::PixelPoint travel_px_;
  double turn_rad_ = 0.0;
  double reach_px_ = 0.0;
  double blur_px_ = 1.0;
  double open_ = 0.0;
  struct Node {
    double share = 0.0;  // of the exposure, from its middle
    double weight = 1.0;
  };
  std::vector<Node> nodes_ = {Node{}};
};

// The blurred image of a disc of less than four w, over the distance from its
// centre: one pixel costs as much as one of the table's places.
class SmallDiscTable {
 public:
  struct Profile {
    double value = 0.0;
    double d_r = 0.0;
    double d_radius = 0.0;
  };
  SmallDiscTable(double radius_px, double w_px);
  // The value to 1e-6, derivatives to 3e-4 of their greatest.
  Profile At(double r_px) const;

 private:
  static constexpr double kPerBlur = 16.0;    // places in w
  static constexpr std::size_t kCount = 176;  // 11 w: beyond R + 6 w is 0

 public:
  struct alignas(64) Columns {
    std::array<double, kCount> r;
    std::array<double, kCount> value;
    std::array<double, kCount> d_r;
    std::array<double, kCount> d_radius;
  };

 private:
  double per_step_;  // places in a pixel
  Columns columns_;
};

// The image of a body: the mean along its way.
class OutlineImage {
 public:
  OutlineImage(const Outline& outline, const Smear& smear);

  // Of the pixels at (x[i], y[i]), i < kBlock.
  void Cover(const double* x, const double* y, CoverBlock& out) const;

 private:
  Outline outline_;
  Smear smear_;
  std::optional<SmallDiscTable> small_;  // of a disc of less than four w
};

}  // namespace touchdown::vision
