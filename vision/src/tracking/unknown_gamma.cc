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

}  // namespace

double EdgeShift(double first_dn, double second_dn, double blur_px,
                 double gamma) {
  const double power = 1.0 / gamma;
  const double first = std::pow(std::max(first_dn, 0.0), power);
  const double second = std::pow(std::max(second_dn, 0.0), power);
  if (first == second) return 0.0;
  // The integral of level(c) over c, in closed form.
  const double mean_dn =
      (std::pow(second, gamma + 1.0) - std::pow(first, gamma + 1.0)) /
      ((gamma + 1.0) * (second - first));
  return 2.0 * std::sqrt(std::numbers::pi) * blur_px *
         ((mean_dn - first_dn) / (second_dn - first_dn) - 0.5);
}

double UnknownShift(const Background& background, const Track& track) {
  const std::vector<double> behind = LevelsBehind(background, track);
  double body_dn = track.body.contrast_dn;
  double weights = 0.0;
  for (const double level : behind) {
    body_dn += level / static_cast<double>(behind.size());
  }
  body_dn = std::clamp(body_dn, 0.0, background.full_scale_dn);
  const auto weigh = [&](double level) {
    return (body_dn - level) * (body_dn - level);
  };
  for (const double level : behind) weights += weigh(level);
  if (!(weights > 0.0)) return 0.0;
  // Of the mean over gammas; 8 differ from 100 by less than 1 %.
  constexpr int kGammas = 8;
  constexpr double kNotLinear = 0.5;  // of all cameras
  double square = 0.0;
  for (int k = 0; k < kGammas; ++k) {
    const double gamma = std::pow(kLeastGamma, (k + 0.5) / kGammas);
    double shift = 0.0;
    for (const double level : behind) {
      shift += weigh(level) / weights *
               EdgeShift(level, body_dn, track.body.blur_px, gamma);
    }
    square += kNotLinear / kGammas * shift * shift;
  }
  return std::sqrt(square);
}

}  // namespace touchdown::vision
