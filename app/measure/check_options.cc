#include "app/measure/check_options.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <type_traits>

#include "app/measure/option_fields.h"

namespace touchdown::pipeline {
namespace {

// `!(v > 0)` refuses NaN as well.
void RequirePositive(const char* name, double value) {
  if (!(value > 0.0 && std::isfinite(value))) {
    throw std::invalid_argument(
        fmt::format("{} is {}, must be positive and finite", name, value));
  }
}
void RequirePositive(const char* name, const core::Estimate& value) {
  RequirePositive(name, value.value);
}

}  // namespace

std::optional<core::BodyKind> DetermineKind(const AnalyzeOptions& options) {
  if (options.diameter_m && (options.long_m || options.short_m)) {
    throw std::invalid_argument(
        "both a diameter and sides are given; a body is a sphere or a "
        "rectangle");
  }
  if (options.long_m.has_value() != options.short_m.has_value()) {
    throw std::invalid_argument("a rectangle needs both sides");
  }
  // A stated size implies the kind, and must not contradict a stated kind.
  std::optional<core::BodyKind> kind = options.body_kind;
  if (options.diameter_m) kind = core::BodyKind::kSphere;
  if (options.long_m) kind = core::BodyKind::kRectangle;
  if (kind && options.body_kind && *kind != *options.body_kind) {
    throw std::invalid_argument(
        fmt::format("body is {}, but the size given is that of a {}",
                    Name(*options.body_kind), Name(*kind)));
  }
  return kind;
}

void CheckOptions(const AnalyzeOptions& options, const vision::ClipInfo& clip) {
  if (options.limit_s) RequirePositive("limit_s", *options.limit_s);
  // Rates, scales and sizes: all numbers that may be stated.
  VisitOptions(options, []<class T>(const char* name, const T& value,
                                    OptionScope /*scope*/) {
    if constexpr (std::is_same_v<T, std::optional<double>> ||
                  std::is_same_v<T, std::optional<core::Estimate>>) {
      if (value) RequirePositive(name, *value);
    }
  });
  DetermineKind(options);
  const std::int64_t frames = clip.frames;
  const std::int64_t last =
      options.last_frame < 0 ? frames : options.last_frame;
  if (options.first_frame < 0 || options.first_frame >= last || last > frames) {
    throw std::invalid_argument(
        fmt::format("frames is {}:{}, must be a range within 0:{}",
                    options.first_frame, last, frames));
  }
  // `width - x` and not `x + width`: the sum of two large numbers overflows.
  const core::PixelRect& r = options.region;
  if (r.width > 0 && (r.x < 0 || r.y < 0 || r.width > clip.width_px - r.x ||
                      r.height > clip.height_px - r.y)) {
    throw std::invalid_argument(fmt::format(
        "region is {},{},{},{}, must lie within the {}x{} picture", r.x, r.y,
        r.width, r.height, clip.width_px, clip.height_px));
  }
}

}  // namespace touchdown::pipeline
