// The motion of a still scene between two frames, by its points of strong
// gradient.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "touchdown/core/frame.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/background/steady_camera.h"

namespace touchdown::vision {

struct SceneMotion {
  Similarity motion;
  double gain = 1.0;  // of the light
  // How far the corner of the picture goes that goes farthest, and its u.
  // Infinite where the scene was lost.
  double corner_px = 0.0;
  double u_corner_px = 0.0;
  // Residual of a point, robust standard deviation, DN.
  double sigma_dn = 0.0;
};

// Of the tiles of the picture whose points tell a motion from rest, the share
// that are not at rest and that the motion explains better: of all, and the
// least of the picture's left, middle and right third. 0 where there are none.
// And the share that are not at rest, whatever explains them, in the third that
// has the least of it.
struct MotionSupport {
  double of_all = 0.0;
  double of_third = 0.0;
  double restless = 0.0;
};

// The points of one frame, against which others of the same size are compared.
class SceneReference {
 public:
  // Of at most `points` points, evenly spread over the picture where it has
  // gradients that stand out of its noise. Large pictures are compared by the
  // means of blocks of pixels: fine texture would be lost from sight after a
  // motion of one pixel.
  SceneReference(const core::Frame& frame, int points);

  // Too few points to tell any motion.
  bool is_empty() const { return points_.size() < kFewPoints; }
  // Robust least squares (Lucas and Kanade 1981, Tukey's weights); `start` may
  // be off by a few pixels. Ends with a step below `small_step_px`.
  SceneMotion Align(const core::Frame& frame, const Similarity& start,
                    double small_step_px = 0.002) const {
    return Fit(frame, start, small_step_px, true);
  }
  // The same of a scene that can only shift, at less cost.
  SceneMotion AlignShift(const core::Frame& frame, double small_step_px) const {
    return Fit(frame, {}, small_step_px, false);
  }
  // `noise_dn`: of a residual between frames at rest, as SceneMotion has it.
  MotionSupport CountSupport(const core::Frame& frame, const SceneMotion& seen,
                             double noise_dn) const;

 private:
  SceneMotion Fit(const core::Frame& frame, const Similarity& start,
                  double small_step_px, bool can_turn) const;
  struct Point {
    std::int32_t tile;
    float x, y;    // px
    float level;   // DN
    float gx, gy;  // gradient, DN / px
  };
  // Of five unknowns, each by a tenth of this. Not studied.
  static constexpr std::size_t kFewPoints = 50;
  // Tiles across and down, of which each has as many points at most, so that no
  // part of the picture outvotes the rest. Not studied.
  static constexpr std::int32_t kAcross = 24;
  static constexpr std::int32_t kDown = 16;
  static constexpr std::size_t kTiles = std::size_t{kAcross} * kDown;

  // Of a point's level, by shift, growth and turn, DN / px.
  Eigen::Vector4d Slopes(const Point& p) const;
  // A motion's shift, and what growth and turn are at the picture's corners.
  Eigen::Vector4d Lengths(const Similarity& motion) const;
  Similarity ToBlocks(Similarity motion) const;

  std::int32_t block_px_ = 1;
  std::vector<Point> points_;
  core::PixelPoint centre_;  // of the picture of block means
  double reach_ = 1.0;       // half of the diagonal, px
};

}  // namespace touchdown::vision
