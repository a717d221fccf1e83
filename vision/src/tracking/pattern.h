// A body that is no smooth face, as a picture that moves with it: several
// parts, a rim, marks.
//
// Outlines of such a body wander, as its parts stand out more or less from what
// lies behind them. Its picture T tells where it is whatever it shows:
//   I(c + R q) = g T(q) + b + s q,   q from the body's centre, along its axes
// in each frame by least squares of c, R (rectangles) and the light's g, b and
// s (image registration: Lucas and Kanade 1981; Baker and Matthews 2004,
// section 3), with T the frames' robust mean, in turns. A body that falls gets
// its light from another side: without s its picture seems to move towards it.
// Only where the picture behind is another does a place count for the body's:
// an edge along its path would look as if it went with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/outline/outline.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// What a frame shows around a place.
struct PatternView {
  double time_s = 0.0;
  core::PixelRect rect;
  std::vector<float> value;  // DN, row by row
  // Between pixels, by cubic convolution; NaN outside (and at its rim).
  double At(double x_px, double y_px) const;
};

// `reach_px`: how far from the centre all is held.
PatternView ReadView(Clip& clip, std::int64_t frame,
                     const core::PixelPoint& centre, double reach_px);

// What the light makes of a pattern in a frame.
struct PatternLight {
  double gain = 1.0;
  double offset_dn = 0.0;
  double slope_x = 0.0;  // DN per px, along the pattern's axes
  double slope_y = 0.0;
  double At(double level, double x_px, double y_px) const {
    return gain * level + offset_dn + slope_x * x_px + slope_y * y_px;
  }
  double Undone(double value, double x_px, double y_px) const {
    return (value - offset_dn - slope_x * x_px - slope_y * y_px) / gain;
  }
};

// Where a pattern lies in a frame, and the frame's light.
struct PatternPose {
  Pose pose;
  PatternLight light;
};

class Pattern {
 public:
  // Nodes over the outline and a little beyond.
  // `turns`: its axes are the body's, which turn; else the image's.
  Pattern(const Outline& outline, bool turns, const Background& background);

  double reach_px() const;
  bool turns() const { return turns_; }

  // Learns the pattern from frames at the poses given. False where too little
  // of it differs from the background.
  bool Learn(const std::vector<PatternView>& views,
             const std::vector<PatternPose>& poses);

  // The pose from one near by; nothing where it does not converge, or less than
  // half of the pattern is seen. `within_px`: where it is sought first, to each
  // side. misfit is that of the body's places.
  std::optional<PatternPose> Register(const PatternView& view,
                                      const Pose& start,
                                      double within_px = 0.0) const;

 private:
  struct Node {
    double x_px = 0.0;  // along the pattern's axes
    double y_px = 0.0;
    bool inside = false;  // the outline, or near it
    bool at_rim = false;  // not clear inside it
    double level = 0.0;
    double slope_x = 0.0;
    double slope_y = 0.0;
    double u = 0.0;  // scatter of its level
  };

  // Root mean square of what is left, over the noise, without outliers.
  double ComputeMisfit(const std::vector<double>& rest, double scale) const;
  // Any value not below `least` where it is not below it: no more is asked.
  double Mismatch(const PatternView& view, const Pose& at, double least) const;
  void SetSlopes();

  const Background* background_;  // must outlive it
  bool turns_;
  int columns_ = 0;
  int rows_ = 0;
  double spacing_px_ = 1.0;
  std::vector<Node> nodes_;       // (rows, columns)
  std::vector<std::size_t> own_;  // the body's
};

}  // namespace touchdown::vision
