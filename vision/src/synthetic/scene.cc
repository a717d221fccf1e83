#include "touchdown/vision/synthetic/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace touchdown::vision {
namespace {

// Throws for a value out of its range, with field, value and range.
void Require(bool holds, const char* field, double value, const char* range) {
  if (holds) return;
  throw std::invalid_argument(
      fmt::format("scene: {} is {}, must be {}", field, value, range));
}

void RequireSize(const core::Measured& size, const char* field) {
  if (!size) {
    throw std::invalid_argument(
        fmt::format("scene: {} is absent ({}), a size is needed to draw the "
                    "body",
                    field, size.error().reason));
  }
  Require(std::isfinite(size->value) && size->value > 0.0, field, size->value,
          "positive and finite");
}

// Levels are shares of full scale.
bool IsLevel(double value) { return value >= 0.0 && value <= 1.0; }

// What each disturbance may be; lens and wavy ground or shadow are not drawn
// together.
void ValidateTrouble(const SceneTrouble& trouble, bool lens) {
  Require(std::abs(trouble.shading_x) <= 1.0, "trouble.shading_x",
          trouble.shading_x, "-1 .. 1");
  Require(std::abs(trouble.shading_y) <= 1.0, "trouble.shading_y",
          trouble.shading_y, "-1 .. 1");
  Require(IsLevel(std::abs(trouble.highlight_level)), "trouble.highlight_level",
          trouble.highlight_level, "-1 .. 1");
  Require(std::isfinite(trouble.highlight_x), "trouble.highlight_x",
          trouble.highlight_x, "finite");
  Require(std::isfinite(trouble.highlight_y), "trouble.highlight_y",
          trouble.highlight_y, "finite");
  Require(trouble.highlight_sigma > 0.0 && trouble.highlight_sigma <= 10.0,
          "trouble.highlight_sigma", trouble.highlight_sigma,
          "more than 0, at most 10");
  Require(IsLevel(trouble.shadow_depth), "trouble.shadow_depth",
          trouble.shadow_depth, "0 .. 1");
  Require(IsLevel(trouble.flicker_amplitude), "trouble.flicker_amplitude",
          trouble.flicker_amplitude, "0 .. 1");
  Require(trouble.flicker_hz >= 0.0 && std::isfinite(trouble.flicker_hz),
          "trouble.flicker_hz", trouble.flicker_hz, "at least 0 and finite");
  Require(trouble.wave_amplitude_px >= 0.0 && trouble.wave_amplitude_px <= 1e3,
          "trouble.wave_amplitude_px", trouble.wave_amplitude_px, "0 .. 1000");
  Require(trouble.wave_length_px >= 2.0 && trouble.wave_length_px <= 1e5,
          "trouble.wave_length_px", trouble.wave_length_px, "2 .. 100000");
  Require(!lens ||
              (trouble.wave_amplitude_px == 0.0 && trouble.shadow_depth == 0.0),
          "camera.lens", 1.0, "absent where there is a shadow or a wave");
  Require(trouble.specks >= 0 && trouble.specks <= 10000, "trouble.specks",
          trouble.specks, "0 .. 10000");
  Require(trouble.speck_diameter_px > 0.0 && trouble.speck_diameter_px <= 1e3,
          "trouble.speck_diameter_px", trouble.speck_diameter_px,
          "more than 0, at most 1000");
  Require(std::abs(trouble.speck_speed_px) <= 1e4, "trouble.speck_speed_px",
          trouble.speck_speed_px, "-10000 .. 10000");
  Require(IsLevel(trouble.obstacle_level), "trouble.obstacle_level",
          trouble.obstacle_level, "0 .. 1");
}

}  // namespace

bool HasTrouble(const SceneTrouble& t) {
  return t.shading_x != 0.0 || t.shading_y != 0.0 || t.highlight_level != 0.0 ||
         t.shadow_depth > 0.0 || t.flicker_amplitude > 0.0 ||
         t.wave_amplitude_px > 0.0 || t.specks > 0 || t.obstacle;
}

// Checks every field against the range that scene.h states.
void Validate(const Scene& scene) {
  const SceneCamera& camera = scene.camera;
  Require(camera.width_px >= 1 && camera.width_px <= 65536, "camera.width_px",
          camera.width_px, "1 .. 65536");
  Require(camera.height_px >= 1 && camera.height_px <= 65536,
          "camera.height_px", camera.height_px, "1 .. 65536");
  Require(camera.px_per_m > 0.0 && std::isfinite(camera.px_per_m),
          "camera.px_per_m", camera.px_per_m, "positive and finite");
  Require(std::isfinite(camera.ground_point.x_px), "camera.ground_point.x_px",
          camera.ground_point.x_px, "finite");
  Require(std::isfinite(camera.ground_point.y_px), "camera.ground_point.y_px",
          camera.ground_point.y_px, "finite");
  Require(std::abs(camera.roll_rad) < 0.5 * std::numbers::pi, "camera.roll_rad",
          camera.roll_rad, "within -pi/2 .. pi/2");
  Require(camera.fps > 0.0 && std::isfinite(camera.fps), "camera.fps",
          camera.fps, "positive and finite");
  Require(camera.exposure_s >= 0.0 && camera.exposure_s * camera.fps <= 1.0,
          "camera.exposure_s", camera.exposure_s, "0 .. 1/fps");
  Require(camera.psf_sigma_px == 0.0 ||
              (camera.psf_sigma_px >= 0.1 && camera.psf_sigma_px <= 10.0),
          "camera.psf_sigma_px", camera.psf_sigma_px, "0, or 0.1 .. 10");
  Require(camera.bit_depth >= 1 && camera.bit_depth <= 16, "camera.bit_depth",
          camera.bit_depth, "1 .. 16");
  if (camera.lens) {
    Require(
        calib::IsInvertible(*camera.lens, camera.width_px, camera.height_px),
        "camera.lens.k1", camera.lens->k1,
        "such that the lens does not fold the picture back on itself");
    Require(std::abs(camera.roll_rad) < std::numbers::pi / 3.0,
            "camera.roll_rad", camera.roll_rad,
            "within -pi/3 .. pi/3 where there is a lens");
  }
  Require(std::abs(camera.yaw_rad) < std::numbers::pi / 3.0 &&
              (camera.yaw_rad == 0.0 || camera.lens.has_value()),
          "camera.yaw_rad", camera.yaw_rad,
          "within -pi/3 .. pi/3, and 0 where there is no lens");
  Require(camera.row_delay_s >= 0.0 &&
              camera.row_delay_s * camera.height_px * camera.fps <= 1.0,
          "camera.row_delay_s", camera.row_delay_s, "0 .. 1/(fps height_px)");
  Require(camera.row_delay_s == 0.0 || !HasTrouble(scene.trouble),
          "camera.row_delay_s", camera.row_delay_s, "0 where there is trouble");

  const SceneLook& look = scene.look;
  Require(IsLevel(look.body_level), "look.body_level", look.body_level,
          "0 .. 1");
  Require(IsLevel(look.background_level), "look.background_level",
          look.background_level, "0 .. 1");
  Require(IsLevel(look.ground_level), "look.ground_level", look.ground_level,
          "0 .. 1");
  Require(std::abs(look.gradient_x) <= 2.0, "look.gradient_x", look.gradient_x,
          "-2 .. 2");
  Require(std::abs(look.gradient_y) <= 2.0, "look.gradient_y", look.gradient_y,
          "-2 .. 2");
  Require(look.texture_amplitude >= 0.0 && look.texture_amplitude <= 10.0,
          "look.texture_amplitude", look.texture_amplitude, "0 .. 10");
  Require(
      look.texture_correlation_px >= 0.0 && look.texture_correlation_px <= 1e3,
      "look.texture_correlation_px", look.texture_correlation_px, "0 .. 1000");
  Require(look.hole >= 0.0 && look.hole < 1.0, "look.hole", look.hole,
          "at least 0, below 1");
  if (look.face) {
    Require(IsLevel(look.face->amplitude) && look.face->amplitude > 0.0,
            "look.face.amplitude", look.face->amplitude,
            "more than 0, at most 1");
    Require(
        look.face->correlation_px >= 1.0 && look.face->correlation_px <= 1e3,
        "look.face.correlation_px", look.face->correlation_px, "1 .. 1000");
    Require(!camera.lens, "look.face.amplitude", look.face->amplitude,
            "absent where there is a lens");
  }
  if (look.mark) {
    Require(IsLevel(look.mark->level), "look.mark.level", look.mark->level,
            "0 .. 1");
    Require(look.mark->radius > 0.0, "look.mark.radius", look.mark->radius,
            "more than 0");
    Require(look.mark->distance + look.mark->radius <= 1.0 &&
                (look.hole == 0.0 ||
                 look.mark->distance - look.mark->radius >= look.hole),
            "look.mark.distance", look.mark->distance,
            "such that the mark lies on the body");
  }

  ValidateTrouble(scene.trouble, camera.lens.has_value());
  Require(scene.noise.read_dn >= 0.0 && std::isfinite(scene.noise.read_dn),
          "noise.read_dn", scene.noise.read_dn, "at least 0 and finite");
  Require(scene.noise.shot_dn2_per_dn >= 0.0 &&
              std::isfinite(scene.noise.shot_dn2_per_dn),
          "noise.shot_dn2_per_dn", scene.noise.shot_dn2_per_dn,
          "at least 0 and finite");
  Require(scene.frames >= 1, "frames", static_cast<double>(scene.frames),
          "at least 1");
  if (!scene.pose) {
    throw std::invalid_argument("scene: pose is empty, must be a function");
  }
  if (scene.body.kind == core::BodyKind::kSphere) {
    RequireSize(scene.body.diameter_m, "body.diameter_m");
  } else {
    RequireSize(scene.body.long_m, "body.long_m");
    RequireSize(scene.body.short_m, "body.short_m");
  }
}

core::PixelPoint ToImage(const SceneCamera& camera, core::PlanePoint point) {
  const core::PixelPoint ideal = ToIdealImage(camera, point);
  return camera.lens ? calib::Distort(*camera.lens, ideal) : ideal;
}

core::PixelPoint ToIdealImage(const SceneCamera& camera,
                              core::PlanePoint point) {
  const double c = std::cos(camera.roll_rad);
  const double s = std::sin(camera.roll_rad);
  const double x =
      camera.px_per_m * (camera.travels_left ? -point.x_m : point.x_m);
  const double y = camera.px_per_m * point.y_m;
  // Along the ground (c, s), up its normal (s, -c): image y points down.
  if (camera.yaw_rad == 0.0) {
    return {camera.ground_point.x_px + x * c + y * s,
            camera.ground_point.y_px + x * s - y * c};
  }
  // A pinhole: of the ground point from the axis, and the depth over its.
  const double gx = camera.ground_point.x_px - camera.lens->cx_px;
  const double gy = camera.ground_point.y_px - camera.lens->cy_px;
  const double depth = RelativeDepth(camera, point);
  const double right = (c * gx + s * gy + x * std::cos(camera.yaw_rad)) / depth;
  const double up = (s * gx - c * gy + y) / depth;
  return {camera.lens->cx_px + right * c + up * s,
          camera.lens->cy_px + right * s - up * c};
}

// Depth over that of the ground point: 1 where the camera looks straight at the
// plane.
double RelativeDepth(const SceneCamera& camera, core::PlanePoint point) {
  if (camera.yaw_rad == 0.0) return 1.0;
  const double right = camera.travels_left ? -point.x_m : point.x_m;
  return 1.0 + right * camera.px_per_m * std::sin(camera.yaw_rad) /
                   calib::IdealFocal(*camera.lens);
}

// In turn around the body, from the one ahead and above.
std::array<core::PlanePoint, 4> Corners(const core::Body& body,
                                        const ScenePose& pose) {
  if (body.kind != core::BodyKind::kRectangle) {
    throw std::invalid_argument("body.kind is sphere, must be rectangle");
  }
  RequireSize(body.long_m, "body.long_m");
  RequireSize(body.short_m, "body.short_m");
  const double a = 0.5 * body.long_m->value;
  const double b = 0.5 * body.short_m->value;
  const double c = std::cos(pose.angle_rad);
  const double s = std::sin(pose.angle_rad);
  std::array<core::PlanePoint, 4> corners{{{a, b}, {-a, b}, {-a, -b}, {a, -b}}};
  for (core::PlanePoint& p : corners) {
    p = {pose.centre.x_m + c * p.x_m - s * p.y_m,
         pose.centre.y_m + s * p.x_m + c * p.y_m};
  }
  return corners;
}

// Height of the lowest outline point above the ground, m.
double Gap(const core::Body& body, const ScenePose& pose) {
  if (body.kind == core::BodyKind::kSphere) {
    RequireSize(body.diameter_m, "body.diameter_m");
    return pose.centre.y_m - 0.5 * body.diameter_m->value;
  }
  const auto corners = Corners(body, pose);
  return std::min_element(corners.begin(), corners.end(),
                          [](core::PlanePoint p, core::PlanePoint q) {
                            return p.y_m < q.y_m;
                          })
      ->y_m;
}

SceneTruth ComputeTruth(const Scene& scene, std::int64_t index) {
  SceneTruth truth;
  truth.index = index;
  truth.time_s = static_cast<double>(index) / scene.camera.fps;
  truth.pose = scene.pose(truth.time_s);
  truth.centre = ToImage(scene.camera, truth.pose.centre);
  // The angle turns the other way in the image (y points down), and back again
  // where the plane is seen mirrored.
  truth.image_angle_rad = scene.camera.roll_rad + (scene.camera.travels_left
                                                       ? truth.pose.angle_rad
                                                       : -truth.pose.angle_rad);
  const double radius_m = scene.body.kind == core::BodyKind::kSphere
                              ? 0.5 * scene.body.diameter_m->value
                              : 0.5 * std::hypot(scene.body.long_m->value,
                                                 scene.body.short_m->value);
  if (scene.camera.yaw_rad != 0.0) {
    // m: a difference quotient for the direction in which the long side is
    // seen.
    constexpr double kStep_m = 1e-6;
    const core::PlanePoint ahead{
        truth.pose.centre.x_m + kStep_m * std::cos(truth.pose.angle_rad),
        truth.pose.centre.y_m + kStep_m * std::sin(truth.pose.angle_rad)};
    const core::PixelPoint a = ToIdealImage(scene.camera, truth.pose.centre);
    const core::PixelPoint b = ToIdealImage(scene.camera, ahead);
    // The long side's direction, seen to the right as without yaw.
    const double seen = std::atan2(b.y_px - a.y_px, b.x_px - a.x_px);
    truth.image_angle_rad +=
        std::remainder(seen - truth.image_angle_rad, std::numbers::pi);
  }
  // Distance to the farthest point of the body; for a sphere its radius.
  truth.radius_px = scene.camera.px_per_m * radius_m /
                    RelativeDepth(scene.camera, truth.pose.centre);
  truth.gap_px = scene.camera.px_per_m * Gap(scene.body, truth.pose);
  return truth;
}

// Direction of the ground in the picture that an ideal lens would give.
double IdealGroundAngle(const SceneCamera& camera) {
  if (camera.yaw_rad == 0.0) return camera.roll_rad;
  // A straight line is seen straight: two points of it, a pixel apart.
  const double step_m = (camera.travels_left ? -1.0 : 1.0) / camera.px_per_m;
  const core::PixelPoint p = ToIdealImage(camera, {step_m, 0.0});
  return std::atan2(p.y_px - camera.ground_point.y_px,
                    p.x_px - camera.ground_point.x_px);
}

calib::GroundLine TrueGroundLine(const SceneCamera& camera) {
  const double slope = std::tan(IdealGroundAngle(camera));
  const auto at = [&](double x) {
    const core::PixelPoint ideal{
        x, camera.ground_point.y_px + slope * (x - camera.ground_point.x_px)};
    return camera.lens ? calib::Distort(*camera.lens, ideal) : ideal;
  };
  // Two points even of a picture one pixel wide.
  return calib::MakeGroundLine(at(0.0), at(std::max(1, camera.width_px - 1)),
                               0.0);
}

}  // namespace touchdown::vision
