// Where a body of known shape may be in a picture of change.
//
// A change picture E holds for each cell 0 (as the still picture), 1 (changed)
// or something between; 0.5 where the still picture is not known. Its score for
// the shape at place p and angle phi is the mean of E under the shape:
//   S(p, phi) = sum_x K_phi(x - p) E(x) / sum_x K_phi(x)
// with K_phi the cells' coverage. Correlations with all angles share the
// transform of E (convolution theorem), so that the cost does not depend on the
// body's size: one transform a picture and one an angle.
#pragma once

#include <cstdint>
#include <vector>

#include "touchdown/core/points.h"
#include "touchdown/core/words.h"

namespace touchdown::vision {

// A body's shape and size, in units of what it is sought in (px or cells).
struct KnownShape {
  core::BodyKind kind = core::BodyKind::kSphere;
  double long_side = 0.0;   // a sphere's diameter
  double short_side = 0.0;  // as long_side for a sphere
};

// Angles after which the shape's outline is the same again, rad: a half turn,
// or a quarter for a square. Not for spheres, which have none.
double SymmetryPeriod(const KnownShape& shape);

// The shape somewhere, with its score.
struct PlacedShape {
  core::PixelPoint centre;  // cells
  double angle_rad = 0.0;   // of the long side, +x towards +y (image)
  double score = 0.0;
};

class ShapeSearch {
 public:
  // Pictures of `width` x `height` cells; `shape` in cells. The angles lie so
  // close that between two of them the ends of the long side move by less than
  // 0.35 of the short one. Throws std::invalid_argument where a size is not
  // positive.
  ShapeSearch(const KnownShape& shape, std::int32_t width, std::int32_t height);

  // The `most` best local maxima of the score, best first, at least a sixth of
  // the short side apart; of each place also the angles that are nearly as
  // good, up to twice as many in all. Centres and angles lie between cells by a
  // parabola through the neighbouring scores. `every` second (third, ...) angle
  // only is tried. Empty where nothing has changed.
  std::vector<PlacedShape> FindMaxima(const std::vector<float>& change,
                                      std::size_t most,
                                      std::size_t every = 1) const;

  std::size_t angles() const { return spectra_.size(); }
  double angle_step_rad() const { return step_rad_; }

 private:
  std::vector<float> ScoreAngle(const std::vector<float>& spectrum,
                                std::size_t angle) const;

  KnownShape shape_;
  std::int32_t width_;
  std::int32_t height_;
  std::int32_t padded_width_;
  std::int32_t padded_height_;
  double step_rad_ = 0.0;
  std::vector<std::vector<float>> spectra_;  // of K_phi / sum K_phi
};

}  // namespace touchdown::vision
