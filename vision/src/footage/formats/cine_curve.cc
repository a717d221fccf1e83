#include "footage/formats/cine_curve.h"

#include <algorithm>
#include <cmath>

namespace touchdown::vision {
namespace {

// Levels of the linear 12-bit scale: white, and saturation.
constexpr std::int32_t kWhiteLevel = 4064;
constexpr std::int32_t kSaturated = (1 << kCineLinearBits) - 1;
// Black and range of the linear and of the coded scale, in levels. Fitted; see
// the header.
constexpr double kBlack = 63.999;
constexpr double kRange = 4034.445;
constexpr double kCodeBlack = 63.527;
constexpr double kCodeRange = 954.376;

std::int32_t EncodeLevel(std::int32_t x) {
  // The curve is that of ITU-R BT.709: linear below 0.018, else a power of
  // 0.45.
  constexpr double kLinearBelow = 0.018;
  const double light = (x - kBlack) / kRange;
  const double v = light < kLinearBelow ? 4.5 * light
                                        : 1.099 * std::pow(light, 0.45) - 0.099;
  const double code = std::floor(kCodeBlack + kCodeRange * v + 0.5);
  return std::clamp(static_cast<std::int32_t>(code), 0,
                    (1 << kCineCodeBits) - 1);
}

}  // namespace

// The inverse: for each code the middle of the levels that give it.
CineCurve CineLinearOfCode() {
  CineCurve linear{};
  const std::int32_t last = EncodeLevel(kWhiteLevel);
  std::int32_t x = 0;
  std::int32_t mean = 0;
  for (std::int32_t code = 0; code <= last; ++code) {
    const std::int32_t first = x;
    while (x <= kSaturated && EncodeLevel(x) == code) ++x;
    if (x > first) mean = (first + x - 1) / 2;
    linear[static_cast<std::size_t>(code)] =
        static_cast<std::uint16_t>(std::min(mean, kWhiteLevel));
  }
  std::fill(linear.begin() + last + 1, linear.end(),
            static_cast<std::uint16_t>(kSaturated));
  return linear;
}

}  // namespace touchdown::vision
