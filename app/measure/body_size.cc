#include "app/measure/body_size.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "touchdown/vision/track/beside_body.h"

namespace touchdown::pipeline {
namespace {

// A size of the body, seen and as stated at the scale, px.
struct SizePair {
  const char* name;
  core::Estimate* seen;  // half of it
  core::Estimate stated;
  double stated_m = 0.0;
};

// The sizes that can be compared: of a whole body of the stated kind, where a
// scale that the body itself did not make is known. Else empty. What of a seen
// size hangs on a gamma is part of its u then.
std::vector<SizePair> SizePairs(vision::BodyImage& seen,
                                const AnalyzeOptions& options) {
  std::vector<SizePair> pairs;
  const std::optional<vision::BodySize> stated = StatedSize(options);
  if (!stated || seen.whole_px > 0.0) return pairs;
  const core::Estimate half_long = vision::HalfLong(seen);
  const core::Estimate half_short = vision::HalfShort(seen);
  const auto add = [&](const char* name, core::Estimate& half,
                       const core::Estimate& with_gamma,
                       const core::Estimate& whole,
                       const core::Estimate& metres) {
    half = with_gamma;
    pairs.push_back({name, &half, core::Scaled(whole, 0.5), metres.value});
  };
  if (seen.kind == core::BodyKind::kSphere && options.diameter_m) {
    add("diameter", seen.radius_px, half_long, stated->long_px,
        *options.diameter_m);
  } else if (seen.kind == core::BodyKind::kRectangle && options.long_m) {
    const core::Body sides = core::Rectangle(*options.long_m, *options.short_m);
    add("long side", seen.half_long_px, half_long, stated->long_px,
        *sides.long_m);
    add("short side", seen.half_short_px, half_short, stated->short_px,
        *sides.short_m);
  }
  if (!pairs.empty()) seen.gamma_long_px = seen.gamma_short_px = 0.0;
  return pairs;
}

// Beyond so many standard deviations chance is no explanation of a difference;
// up to there image and statement are averaged by their u and nothing is said.
// Larger lets more pass as chance.
constexpr double kConflict = 4.0;  // u

// How far the outline lies beside the stated one, px, by more than chance.
double BeyondChance(const SizePair& pair) {
  const double off = pair.seen->value - pair.stated.value;
  const double chance = kConflict * std::hypot(pair.seen->u, pair.stated.u);
  return std::sqrt(std::max(0.0, off * off - chance * chance));
}

// An outline that lies beside the body puts its place off, and its angle by as
// much over half of the long side. A body that turned in an impact has other
// edges at the ground: it changes there.
void WidenCommon(double beside_px, vision::BodyImage& body) {
  const double u_px = vision::PlaceUncertaintyBeside(beside_px);
  body.u_texture_px = std::hypot(body.u_texture_px, u_px);
  body.u_common_px = std::hypot(body.u_common_px, u_px);
  if (body.kind == core::BodyKind::kRectangle) {
    body.u_common_angle_rad =
        std::hypot(body.u_common_angle_rad, u_px / body.half_long_px.value);
  }
}

// What one cause would explain all of the differences.
std::string ExplainDifferences(const std::vector<SizePair>& pairs) {
  // A wrong scale makes all sizes wrong by one ratio; an outline that lies too
  // far out makes them wrong by one number of pixels. A sphere has one size:
  // the two cannot be told apart.
  const SizePair& a = pairs.front();
  const SizePair& b = pairs.back();
  const auto ratio = [](const SizePair& p) {
    return p.seen->value / p.stated.value;
  };
  const auto outside_px = [](const SizePair& p) {
    return p.seen->value - p.stated.value;
  };
  const std::string scale =
      fmt::format("a scale of {:.1f} px/m", 2.0 * a.seen->value / a.stated_m);
  if (pairs.size() == 1) {
    return fmt::format("{} or a {} of {:.3f} mm would explain it", scale,
                       a.name, 1e3 * a.stated_m * ratio(a));
  }
  // px by which each cause leaves the second side unexplained.
  const double by_scale = std::abs(ratio(a) - ratio(b)) * b.stated.value;
  const double by_outline = std::abs(outside_px(a) - outside_px(b));
  // px. A cause that leaves less than this of the second side explains both;
  // larger names causes that are none. Not studied.
  constexpr double kSame_px = 0.1;
  if (std::min(by_scale, by_outline) > kSame_px) {
    return "neither a scale nor a common error of the outline explains both: "
           "check the sides, or whether another body was followed";
  }
  if (by_scale <= by_outline) return scale + " would explain both";
  return fmt::format(
      "outlines {:.2f} px too far {} would explain both, as a camera's gamma "
      "or too much light makes them",
      std::abs(outside_px(a)), outside_px(a) > 0.0 ? "out" : "in");
}

}  // namespace

vision::Track WithStatedSize(vision::Track seen,
                             const AnalyzeOptions& options) {
  double beside_px = 0.0;
  for (const SizePair& pair : SizePairs(seen.body, options)) {
    beside_px = std::max(beside_px, BeyondChance(pair));
    *pair.seen = core::Combined(*pair.seen, pair.stated);
  }
  // Layers have counted it already, while they saw the size.
  if (!seen.layered) WidenCommon(beside_px, seen.body);
  return seen;
}

std::optional<SizeConflict> FindSizeConflict(const vision::BodyImage& seen,
                                             const AnalyzeOptions& options) {
  vision::BodyImage body = seen;
  const std::vector<SizePair> pairs = SizePairs(body, options);
  SizeConflict conflict;
  for (const SizePair& pair : pairs) {
    const double off = core::Disagreement(*pair.seen, pair.stated);
    if (off <= kConflict) continue;
    conflict.relative =
        std::max(conflict.relative,
                 std::abs(pair.seen->value / pair.stated.value - 1.0));
    // In whole sizes, as a caliper shows them; the pairs hold halves, as the
    // fit has them.
    conflict.reason += fmt::format(
        "{}{}: {:.2f} +- {:.2f} px are seen, {:.2f} +- {:.2f} px stated",
        conflict.reason.empty() ? "" : ", ", pair.name, 2.0 * pair.seen->value,
        2.0 * pair.seen->u, 2.0 * pair.stated.value, 2.0 * pair.stated.u);
  }
  if (conflict.reason.empty()) return std::nullopt;
  conflict.reason += "; " + ExplainDifferences(pairs);
  return conflict;
}

core::Estimate Divide(const core::Estimate& a, const core::Estimate& b) {
  const double value = a.value / b.value;
  return {value, value * std::hypot(a.u / a.value, b.u / b.value),
          std::nullopt};
}

core::Expected<calib::Scale> FindScale(const AnalyzeOptions& options,
                                       const vision::BodyImage& image) {
  if (options.scale_px_per_m) {
    return calib::Scale{*options.scale_px_per_m, calib::ScaleSource::kUser};
  }
  if (options.calibration && options.calibration->scale) {
    return calib::Scale{options.calibration->scale->px_per_m,
                        calib::ScaleSource::kCalibration};
  }
  // The size of a part is not that of the body.
  if (image.whole_px > 0.0) {
    return core::AbsentBecause(
        "the body shows in parts; give --scale-px-per-m");
  }
  if (options.diameter_m && image.kind == core::BodyKind::kSphere) {
    return calib::Scale{
        Divide(core::Scaled(vision::HalfLong(image), 2.0), *options.diameter_m),
        calib::ScaleSource::kBodySize};
  }
  if (options.long_m && image.kind == core::BodyKind::kRectangle) {
    // The long side is the better known one, relative to its length.
    const core::Estimate& a = *options.long_m;
    const core::Estimate& b = *options.short_m;
    return calib::Scale{Divide(core::Scaled(vision::HalfLong(image), 2.0),
                               a.value >= b.value ? a : b),
                        calib::ScaleSource::kBodySize};
  }
  return core::AbsentBecause(
      "give --calibration, --scale-px-per-m, --diameter-mm or --sides-mm");
}

std::optional<vision::BodySize> StatedSize(const AnalyzeOptions& options) {
  // In a turned plane the picture's size is not that of the plane.
  if (options.calibration && options.calibration->ground &&
      options.calibration->ground->yaw_rad) {
    return std::nullopt;
  }
  // Of a body without a size in the picture only what was told is a scale.
  // FindScale is asked with a body whose size in the picture is not known, so
  // that the answer cannot come of that size.
  vision::BodyImage unseen;
  unseen.whole_px = 1.0;
  const auto scale = FindScale(options, unseen);
  if (!scale) return std::nullopt;
  const core::Estimate& s = scale->px_per_m;
  const auto in_px = [&s](const core::Estimate& length_m) {
    const double value = length_m.value * s.value;
    return core::Estimate{
        value, std::hypot(length_m.u * s.value, length_m.value * s.u),
        std::nullopt};
  };
  if (options.diameter_m) {
    return vision::BodySize{in_px(*options.diameter_m),
                            in_px(*options.diameter_m)};
  }
  if (!options.long_m) return std::nullopt;
  const core::Body sides = core::Rectangle(*options.long_m, *options.short_m);
  return vision::BodySize{in_px(*sides.long_m), in_px(*sides.short_m)};
}

core::Body DetermineBody(const AnalyzeOptions& options,
                         const vision::BodyImage& image,
                         const core::Expected<calib::Scale>& scale) {
  // Half a size in px to a whole one in m, with u of pixels and of scale.
  const auto metres = [&](const core::Estimate& half_px) -> core::Measured {
    if (!scale) return core::AbsentBecause("no scale");
    const core::Estimate& s = scale->px_per_m;
    const double value = 2.0 * half_px.value / s.value;
    return core::Estimate{
        value, std::hypot(2.0 * half_px.u / s.value, value * s.u / s.value),
        std::nullopt};
  };
  core::Body body;
  body.kind = image.kind;
  if (image.kind == core::BodyKind::kSphere) {
    body.diameter_m = options.diameter_m ? core::Measured(*options.diameter_m)
                                         : metres(vision::HalfLong(image));
  } else if (options.long_m) {
    body = core::Rectangle(*options.long_m, *options.short_m);
  } else {
    body.long_m = metres(vision::HalfLong(image));
    body.short_m = metres(vision::HalfShort(image));
  }
  return body;
}

}  // namespace touchdown::pipeline
