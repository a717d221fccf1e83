#include "tracking/unknown_gamma.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "outline/outline_pixels.h"
#include "outline/track_shape.h"
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
  // Poses, and places on an outline. Fewer miss a change of what lies behind,
  // more cost time. Not studied.
  constexpr std::size_t kPoses = 12;
  constexpr int kPlaces = 16;
  std::vector<double> levels;
  for (const std::size_t i : SpreadEvenly(track.poses.size(), kPoses)) {
    const Outline outline = PlaceOutline(track.body, track.poses[i]);
    const double cosine = std::cos(outline.angle_rad);
    const double sine = std::sin(outline.angle_rad);
    for (int place = 0; place < kPlaces; ++place) {
      const double turn = 2.0 * std::numbers::pi * (place + 0.5) / kPlaces;
      const auto level =
          LevelAt(background, OutlinePoint(outline, cosine, sine, turn));
      if (level) levels.push_back(*level);
    }
  }
  return levels;
}

// The gamma whose shift is the root mean square of those of all cameras. With
// y = 1 / gamma the mean of (y - 1)^2 over log y, from 1 to the largest y, is
//   (y^2 / 2 - 2 y + 3 / 2 + log y) / log y.
double EquivalentGamma() {
  constexpr double kNotLinear = 0.5;  // of all cameras
  const double y = 1.0 / kLeastGamma;
  const double square =
      kNotLinear * (0.5 * y * y - 2.0 * y + 1.5 + std::log(y)) / std::log(y);
  return 1.0 / (1.0 + std::sqrt(square));
}

}  // namespace

double EdgeShift(double first_dn, double second_dn, double blur_px,
                 double gamma) {
  const double sum_dn = first_dn + second_dn;
  if (!(sum_dn > 0.0)) return 0.0;
  return std::sqrt(std::numbers::pi) / 3.0 * blur_px * (1.0 / gamma - 1.0) *
         (second_dn - first_dn) / sum_dn;
}

double UnknownShift(const Background& background, const Track& track) {
  const std::vector<double> behind = LevelsBehind(background, track);
  double body_dn = track.body.contrast_dn;
  for (const double level : behind) {
    body_dn += level / static_cast<double>(behind.size());
  }
  body_dn = std::clamp(body_dn, 0.0, background.full_scale_dn);
  const double gamma = EquivalentGamma();
  double shift = 0.0;
  double weights = 0.0;
  for (const double level : behind) {
    const double weight = (body_dn - level) * (body_dn - level);
    weights += weight;
    shift += weight * EdgeShift(level, body_dn, track.body.blur_px, gamma);
  }
  return weights > 0.0 ? std::abs(shift / weights) : 0.0;
}

void TakeUnknownGamma(const ClipInfo& clip, const Background& background,
                      Track& track) {
  if (clip.gamma_is_known || track.layered) return;
  track.body.gamma_long_px = UnknownShift(background, track);
  track.body.gamma_short_px = track.body.gamma_long_px;
}

}  // namespace touchdown::vision
