// The linear light behind the samples of a packed 10-bit .cine.
//
// The camera has 12-bit samples x, black at 64 and white at 4064, and stores
// them in 10 bits by the curve of Rec. ITU-R BT.709 (item 1.2):
//
//   L = (x - kBlack) / kRange
//   V = 4.5 L for L < 0.018, else 1.099 L^0.45 - 0.099
//   code = round(kCodeBlack + kCodeRange V)
//
// The format ("The Cine File Format", Vision Research) defines the way back by
// a table of 1024 numbers. It is the mean, rounded down, of the x that share a
// code; the code before where none has it (small x are further apart than
// codes); 4064 at most, and above that code 4095, saturation. The four
// constants were fitted to the table: of its 1024 numbers they give 1023, and
// 32 for 33 at code 30.
#pragma once

#include <array>
#include <cstdint>

namespace touchdown::vision {

// Bits of a packed sample, and of the linear level that it stands for.
inline constexpr std::int32_t kCineCodeBits = 10;
inline constexpr std::int32_t kCineLinearBits = 12;

// The 12-bit linear sample of each code.
using CineCurve = std::array<std::uint16_t, 1 << kCineCodeBits>;
CineCurve CineLinearOfCode();

}  // namespace touchdown::vision
