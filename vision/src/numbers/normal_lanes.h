// The normal distribution of several numbers at a time (lanes.h).
#pragma once

#include <bit>
#include <cstdint>
#include <numbers>

#include "numbers/lanes.h"

namespace touchdown::vision {

// 1 / sqrt(2 pi): the normal density at 0.
inline constexpr double kInverseSqrt2Pi = 0.3989422804014327;

// exp(-y), 0 <= y <= 700, to 1e-9 of itself: 2^-n exp(-r), |r| <= ln(2)/2. The
// sum with 1.5 * 2^52 rounds to a whole number, whose bits are then at hand.
TOUCHDOWN_INLINE void ExpOfMinus(const Four& y, Four& result) {
  // 1.5 * 2^52, see above.
  constexpr double kRound = 0x1.8p52;
  const Four shifted = y * std::numbers::log2e + kRound;
  const Four r = y - (shifted - kRound) * std::numbers::ln2;
  const Four series =
      1.0 +
      r * (-1.0 +
           r * (1.0 / 2 +
                r * (-1.0 / 6 +
                     r * (1.0 / 24 +
                          r * (-1.0 / 120 +
                               r * (1.0 / 720 +
                                    r * (-1.0 / 5040 + r * (1.0 / 40320))))))));
  // The bits of 1.0: n is subtracted from its exponent.
  constexpr std::uint64_t kOne = std::bit_cast<std::uint64_t>(1.0);
  const FourBits scale = kOne - (__builtin_bit_cast(FourBits, shifted) << 52);
  result = series * __builtin_bit_cast(Four, scale);
}

// The normal distribution to 7.5e-8 (Abramowitz, Stegun 26.2.17), its density.
TOUCHDOWN_INLINE void NormalAt(const Four& z, Four& cdf, Four& pdf) {
  constexpr Four kMost = {37.0, 37.0, 37.0, 37.0};  // the density is 1e-298
  const Four size = z < 0.0 ? -z : z;
  const Four near = size < kMost ? size : kMost;
  ExpOfMinus(0.5 * near * near, pdf);
  pdf = pdf * kInverseSqrt2Pi;
  const Four t = 1.0 / (1.0 + 0.2316419 * near);
  const Four tail =
      pdf * t *
      (0.319381530 +
       t * (-0.356563782 +
            t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  cdf = z > 0.0 ? 1.0 - tail : tail;
}

// The same of short numbers, 0 <= y <= 85, to 2e-7 of the greatest. ln(2) in
// two parts, of which the first has few digits: n times it is exact.
TOUCHDOWN_INLINE void ExpOfMinus(const Wide& y, Wide& result) {
  // 1.5 * 2^23, and ln(2) in two parts.
  constexpr float kRound = 0x1.8p23F;
  constexpr float kLn2High = 0.693359375F;
  constexpr float kLn2Low = -2.12194440e-4F;
  const Wide shifted = y * std::numbers::log2e_v<float> + kRound;
  const Wide n = shifted - kRound;
  const Wide r = (y - n * kLn2High) - n * kLn2Low;
  const Wide series =
      1.0F +
      r * (-1.0F +
           r * (1.0F / 2 +
                r * (-1.0F / 6 +
                     r * (1.0F / 24 + r * (-1.0F / 120 + r * (1.0F / 720))))));
  // The bits of 1.0F.
  constexpr std::uint32_t kOne = std::bit_cast<std::uint32_t>(1.0F);
  const WideBits scale = kOne - (__builtin_bit_cast(WideBits, shifted) << 23);
  result = series * __builtin_bit_cast(Wide, scale);
}

TOUCHDOWN_INLINE void NormalAt(const Wide& z, Wide& cdf, Wide& pdf) {
  // The density is 1e-18: nothing beside 1, and what is made of it is no
  // subnormal number yet, which would take a hundred times as long.
  constexpr float kFar = 9.0F;
  const Wide kMost = kFar + Wide{};
  const Wide size = z < 0.0F ? -z : z;
  const Wide near = size < kMost ? size : kMost;
  ExpOfMinus(0.5F * near * near, pdf);
  pdf = pdf * static_cast<float>(kInverseSqrt2Pi);
  const Wide t = 1.0F / (1.0F + 0.2316419F * near);
  const Wide tail =
      pdf * t *
      (0.319381530F +
       t * (-0.356563782F +
            t * (1.781477937F + t * (-1.821255978F + t * 1.330274429F))));
  cdf = z > 0.0F ? 1.0F - tail : tail;
}

}  // namespace touchdown::vision
