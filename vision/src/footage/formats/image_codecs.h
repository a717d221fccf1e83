// The three still-image codecs behind image_file.h. Each decoder takes the
// whole file in memory; `name` stands for the file in messages. Each encoder
// writes to an open stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {

using FileBytes = std::span<const std::uint8_t>;

void DecodePng(FileBytes file, const std::string& name, Image& image);
void DecodeTiff(FileBytes file, const std::string& name, Image& image);
void DecodeJpeg(FileBytes file, const std::string& name, Image& image);

// How many pixels a file of that size may stand for: what a header says
// beyond it is damage, and is found out before a byte is allocated.
std::int64_t MostPixels(std::size_t file_bytes);

// Sets the geometry and makes room, after checking that the size is sane for a
// file of `file_bytes`.
void Allocate(std::int64_t width_px, std::int64_t height_px,
              std::int32_t bit_depth, std::size_t file_bytes,
              const std::string& name, Image& image);

// Rec. ITU-R BT.601 luma of samples of up to 16 bits, rounded to the nearest;
// the weights times 2^16, which sum to 2^16, so that gray stays what it is.
inline std::uint32_t Luma(std::uint32_t r, std::uint32_t g, std::uint32_t b) {
  // Weights of ITU-R BT.601 (0.299, 0.587, 0.114) times 2^16, and half for
  // rounding.
  constexpr std::uint32_t kR = 19595, kG = 38470, kB = 7471, kHalf = 1u << 15;
  static_assert(kR + kG + kB == 1u << 16);
  return (kR * r + kG * g + kB * b + kHalf) >> 16;
}

}  // namespace touchdown::vision
