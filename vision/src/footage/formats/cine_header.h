// What a Phantom .cine tells that libav does not: the camera's number of the
// first image, how its samples are packed, and when each image was taken.
//
// Layout ("The Cine File Format", Vision Research), all little-endian:
//   0   header: "CI", FirstImageNo at 16, ImageCount at 20, OffImageHeader at
//       24, OffSetup at 28, OffImageOffsets at 32
//   OffImageHeader  Windows' BITMAPINFOHEADER; biCompression 256: packed 10 bit
//   OffSetup        camera settings, "ST" at 140, their length at 142 (16 bit),
//       FrameRate at 768
//   after them, up to OffImageOffsets: tagged blocks {length with these eight
//       bytes (32 bit), type (16), reserved (16)}; 1002: TIME64 of each image
//       (seconds since 1970, 32.32 bits, the lowest two bits flags); 1003:
//       exposure time of each image (seconds, 0.32 bits)
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace touchdown::vision {

struct CineHeader {
  std::int64_t first_image = 0;  // the camera's number; may be negative
  std::int64_t images = 0;       // in the file, as the header says
  double stated_fps = 0.0;       // FrameRate: a whole number; 0: not told
  bool packed_10 = false;        // 10 bits a sample, companded (cine_curve.h)

  // When each image was taken, in seconds from the first; ascends strictly.
  // Empty where the file has no stamps or they cannot be right.
  std::vector<double> times_s;
  std::string stamps_trouble;  // why they cannot be right, or empty

  std::vector<double> exposures_s;  // of each image; empty: not told
};

// Cameras stamp in microseconds at the coarsest.
inline constexpr double kCineJitterS = 1e-6;

// Reads the header; `name` stands for the file in messages. Throws
// core::InputError naming the file, the byte and what was expected if it is no
// .cine or if what the header points at lies outside the file.
CineHeader ParseCineHeader(std::span<const std::uint8_t> file,
                           const std::string& name);

CineHeader ReadCineHeader(const std::filesystem::path& path);

}  // namespace touchdown::vision
