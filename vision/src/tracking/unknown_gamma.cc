#include "tracking/unknown_gamma.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "tracking/layer_pictures.h"

namespace touchdown::vision {
namespace {

// Where the still picture is known.
std::optional<double> LevelAt(const Background& background,
                              const core::PixelPoint& at) {
  const auto x = static_cast<std::int32_t>(std::lround(at.x_px));
  const auto y = static_cast<std::int32_t>(std::lround(at.y_px));
  if (x < 0 || x >= background.width_px || y < 0 || y >= background.height_px ||
      !background.known_at(x, y)) {
    return std::nullopt;
  }
  return background.at(x, y);
}

// The still picture beside the outlines of some poses.
std::vector<double> LevelsBehind(const Background& background,
                                 const Track& track) {
  // Poses, and places on an outline. Fewer miss a change of what lies behind;
  // more change the third digit of a standard uncertainty.
  constexpr std::size_t kPoses = 12;
  constexpr int kPlaces = 16;
  const BodyImage& body = track.body;
  const bool sphere = body.kind == core::BodyKind::kSphere;
  std::vector<double> levels;
  for (const std::size_t i : SpreadEvenly(track.poses.size(), kPoses)) {
    const Pose& pose = track.poses[i];
    const double cosine = std::cos(pose.angle_rad);
    const double sine = std::sin(pose.angle_rad);
    for (int place = 0; place < kPlaces; ++place) {
      const double turn = 2.0 * std::numbers::pi * (place + 0.5) / kPlaces;
      double along = std::cos(turn);
      double across = std::sin(turn);
      if (sphere) {
        along *= body.radius_px.value;
        across *= body.radius_px.value;
      } else {
        const double side = std::max(std::abs(along), std::abs(across));
        along *= body.half_long_px.value / side;
        across *= body.half_short_px.value / side;
      }
      const auto level = LevelAt(
          background, {pose.centre.x_px + cosine * along - sine * across,
                       pose.centre.y_px + sine * along + cosine * across});
      if (level) levels.push_back(*level);
    }
  }
  return levels;
}

// The part of the shift that both levels make.
double ShiftByLevels(double first_dn, double second_dn) {
  const double sum_dn = first_dn + second_dn;
  return sum_dn > 0.0 ? (second_dn - first_dn) / sum_dn : 0.0;
}

// The part that gamma makes.
double ShiftByGamma(double gamma) {
  return std::sqrt(std::numbers::pi) / 3.0 * (1.0 / gamma - 1.0);
}

// Its mean square over the gammas of cameras: by y = 1 / gamma,
//   the mean of (y - 1)^2 over log y = (y^2 / 2 - 2 y + log y) / log y
// between 1 and the largest y.
double MeanSquareShift() {
  constexpr double kNotLinear = 0.5;  // of all cameras
  const double y = 1.0 / kLeastGamma;
  const double of_one = ShiftByGamma(0.5);  // y - 1 = 1
  return kNotLinear * of_one * of_one *
         (0.5 * y * y - 2.0 * y + 1.5 + std::log(y)) / std::log(y);
}

}  // namespace

double EdgeShift(double first_dn, double second_dn, double blur_px,
                 double gamma) {
  return blur_px * ShiftByGamma(gamma) * ShiftByLevels(first_dn, second_dn);
}

double UnknownShift(const Background& background, const Track& track) {
  const std::vector<double> behind = LevelsBehind(background, track);
  double body_dn = track.body.contrast_dn;
  for (const double level : behind) {
    body_dn += level / static_cast<double>(behind.size());
  }
  body_dn = std::clamp(body_dn, 0.0, background.full_scale_dn);
  double shift = 0.0;
  double weights = 0.0;
  for (const double level : behind) {
    const double weight = (body_dn - level) * (body_dn - level);
    weights += weight;
    shift += weight * ShiftByLevels(level, body_dn);
  }
  if (!(weights > 0.0)) return 0.0;
  return track.body.blur_px * std::abs(shift / weights) *
         std::sqrt(MeanSquareShift());
}

}  // namespace touchdown::vision
