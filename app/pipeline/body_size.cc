#include "app/pipeline/body_size.h"

#include <cmath>

namespace touchdown::pipeline {

core::Estimate QuotientOf(const core::Estimate& a, const core::Estimate& b) {
  const double value = a.value / b.value;
  return {value, value * std::hypot(a.u / a.value, b.u / b.value),
          std::nullopt};
}

std::optional<calib::Scale> FindScale(const AnalyzeOptions& options,
                                      const vision::BodyImage& image) {
  if (options.scale_px_per_m) {
    return calib::Scale{*options.scale_px_per_m, calib::ScaleSource::kUser};
  }
  if (options.calibration && options.calibration->scale) {
    return calib::Scale{options.calibration->scale->px_per_m,
                        calib::ScaleSource::kCalibration};
  }
  // The size of a part is not that of the body.
  if (image.whole_px > 0.0) return std::nullopt;
  if (options.diameter_m && image.kind == core::BodyKind::kSphere) {
    return calib::Scale{
        QuotientOf(core::Scaled(image.radius_px, 2.0), *options.diameter_m),
        calib::ScaleSource::kBodySize};
  }
  if (options.long_m && image.kind == core::BodyKind::kRectangle) {
    // The long side is the better known one, relative to its length.
    const core::Estimate& a = *options.long_m;
    const core::Estimate& b = *options.short_m;
    return calib::Scale{QuotientOf(core::Scaled(image.half_long_px, 2.0),
                                   a.value >= b.value ? a : b),
                        calib::ScaleSource::kBodySize};
  }
  return std::nullopt;
}

std::optional<vision::BodySize> StatedSize(const AnalyzeOptions& options) {
  // Of a body without a size in the picture only what was told is a scale.
  vision::BodyImage unseen;
  unseen.whole_px = 1.0;
  const std::optional<calib::Scale> scale = FindScale(options, unseen);
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

core::Body BodyOf(const AnalyzeOptions& options, const vision::BodyImage& image,
                  const std::optional<calib::Scale>& scale) {
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
                                         : metres(image.radius_px);
  } else if (options.long_m) {
    body = core::Rectangle(*options.long_m, *options.short_m);
  } else {
    body.long_m = metres(image.half_long_px);
    body.short_m = metres(image.half_short_px);
  }
  return body;
}

}  // namespace touchdown::pipeline
