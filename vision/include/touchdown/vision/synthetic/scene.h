// A scene with known truth: what the camera is, what it sees, how the body
// moves. Plain data; render.h turns it into frames. The motion is a function of
// time, so that vision knows no theory: tests pass closed forms, `touchdown
// simulate` passes the rigid-body motion of analysis.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "touchdown/calib/lens.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/body.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/synthetic/scene_trouble.h"

namespace touchdown::vision {

// Where the body is: its centre in the plane frame and its angle, positive
// counter-clockwise in the plane frame (x in the direction of travel, y up), so
// that a rectangle's angle is its face angle: leading end up.
struct ScenePose {
  core::PlanePoint centre;
  double angle_rad = 0.0;
};
using PoseFunction = std::function<ScenePose(double time_s)>;

// A camera whose axis is perpendicular to the plane of motion, but for the yaw.
struct SceneCamera {
  std::int32_t width_px = 640;
  std::int32_t height_px = 400;
  double px_per_m = 1000.0;
  // Where the plane frame's origin (0, 0), a point of the ground, is seen.
  core::PixelPoint ground_point{320.0, 330.0};
  // Direction of the ground line in the image: from +x towards +y (image y
  // points down), as calib::ImageAngle. |roll| < pi/2.
  double roll_rad = 0.0;
  // The direction of travel is to the left in the image: the plane frame is
  // seen mirrored.
  bool travels_left = false;
  double fps = 2000.0;
  // Frame i collects light in [i/fps - exposure/2, i/fps + exposure/2].
  double exposure_s = 100e-6;
  // Standard deviation of the lens's Gaussian blur: 0 (none; coverage is then
  // the exact area of a pixel) or 0.1 to 10.
  double psf_sigma_px = 0.7;
  std::int32_t bit_depth = 8;  // 1..16
  // Distorts what the camera sees; the fields above are those of the ideal
  // picture (calib/lens.h). Nothing: no distortion. Needs |roll| < 60 degrees.
  std::optional<calib::Lens> lens;
  // The plane of motion is turned about its vertical through `ground_point`:
  // positive where its right end is farther away (vision/plane_yaw.h). The
  // scale is then that at `ground_point`. Needs a lens, whose focal length f
  // says how far away that is: f / px_per_m, m. |yaw| < 60 degrees.
  double yaw_rad = 0.0;
  // Rolling shutter: row y collects its light y times this later than row 0,
  // whose time is the frame's. At most 1/fps over the picture; no trouble then.
  double row_delay_s = 0.0;
};

// A patch on the body that turns with it: a disc, in units of half the body's
// smallest size; distance + radius <= 1.
struct SceneMark {
  double level = 0.9;     // fraction of full scale, as the body's
  double distance = 0.5;  // of its centre from the body's, where the body's
                          // angle points
  double radius = 0.25;   // more than 0
};

// A picture on the body's face that turns with it in the plane: a Gaussian
// random field about the body's level, cut off where it would leave 0 .. 1.
struct SceneFace {
  double amplitude = 0.05;      // standard deviation, of full scale; > 0
  double correlation_px = 3.0;  // l of exp(-d^2 / (2 l^2)); at least 1
  std::uint64_t seed = 1;
};

// Brightness, as fractions of full scale at the picture's centre.
struct SceneLook {
  double body_level = 0.15;
  double background_level = 0.65;
  double ground_level = 0.40;
  // Relative change of the illumination from one side of the picture to the
  // other: everything is multiplied by 1 + gx (x/(w-1) - 1/2) + gy (...).
  double gradient_x = 0.0;
  double gradient_y = 0.0;
  // The ground's texture as the camera sees it (lens included): a Gaussian
  // random field with this standard deviation, relative to the ground level,
  // whose autocorrelation is exp(-d^2 / (2 l^2)); l = 0: independent pixels.
  double texture_amplitude = 0.0;
  double texture_correlation_px = 2.0;
  std::uint64_t texture_seed = 1;
  std::optional<SceneMark> mark;
  std::optional<SceneFace> face;  // not with a lens
  // A ring: through a concentric round hole of this share of the body's
  // smallest size what is behind it is seen. 0 (none) to below 1; a mark lies
  // on the ring: distance - radius >= hole.
  double hole = 0.0;
};

// Sensor noise in DN (digital numbers of the recorded bit depth): a sample with
// the clean value v has the variance read^2 + shot * v, in DN^2.
struct SensorNoise {
  double read_dn = 0.0;
  double shot_dn2_per_dn = 0.0;
};

struct Scene {
  core::Body body;  // sizes present; u is not used
  PoseFunction pose;
  std::int64_t frames = 1;
  SceneCamera camera;
  SceneLook look;
  SceneTrouble trouble;
  SensorNoise noise;
};

// Throws std::invalid_argument naming the field, its value and its allowed
// range if the scene cannot be rendered.
void Validate(const Scene& scene);

// Image of a point of the plane, without and with the lens's distortion.
core::PixelPoint ToIdealImage(const SceneCamera& camera,
                              core::PlanePoint point);
core::PixelPoint ToImage(const SceneCamera& camera, core::PlanePoint point);

// Of the camera's depth: that of a point of the plane over that of
// `ground_point`. 1 without yaw.
double RelativeDepth(const SceneCamera& camera, core::PlanePoint point);

// Direction of the ground line in the ideal picture, as calib::ImageAngle: the
// roll, but for what a yaw does away from the axis.
double IdealGroundAngle(const SceneCamera& camera);

// The four corners of a rectangle in the plane, counter-clockwise, beginning
// with the upper leading one (+long/2, +short/2). Throws std::invalid_argument
// for other bodies.
std::array<core::PlanePoint, 4> Corners(const core::Body& body,
                                        const ScenePose& pose);

// Height of the body's lowest outline point above the ground, in metres.
double Gap(const core::Body& body, const ScenePose& pose);

// What is true of frame `index`, at the middle of its exposure.
struct SceneTruth {
  std::int64_t index = 0;
  double time_s = 0.0;
  ScenePose pose;           // in the plane
  core::PixelPoint centre;  // in the image: of the centre itself
  // In the ideal picture:
  double image_angle_rad = 0.0;  // of the long side, from +x towards +y
  double radius_px = 0.0;  // of a sphere; half the diagonal of a rectangle
  double gap_px = 0.0;     // as seen at `ground_point`
};
SceneTruth ComputeTruth(const Scene& scene, std::int64_t index);

// The exact ground line in the image, from its left to its right border; u = 0.
// With a lens: through two points at which the ground is seen; between them it
// is bent.
calib::GroundLine TrueGroundLine(const SceneCamera& camera);

}  // namespace touchdown::vision
