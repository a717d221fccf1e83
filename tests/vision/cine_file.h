// Phantom .cine files made by tests, by the format's own layout (see
// vision/src/footage/formats/cine_header.h).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "touchdown/core/frame.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {

struct CineFile {
  std::int32_t first_image = -5;
  std::uint32_t stated_fps = 1000;
  std::uint32_t real_bits = 0;  // RealBPP; 0: as many as are stored
  bool packed_10 = false;
  std::vector<Image> frames;        // 10 bits if packed
  std::vector<double> stamps_s;     // of each frame; empty: no such block
  std::vector<double> exposures_s;  // likewise
  std::uint64_t since_1970_s = 1'700'000'000;  // of the stamps' origin

  std::string Bytes() const;
};

namespace cine_file {

inline void Put(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) {
    out += i < 8 ? static_cast<char>(value >> (8 * i) & 0xFF) : '\0';
  }
}

inline void PutAt(std::string& out, std::size_t at, std::uint64_t value,
                  int bytes) {
  std::string text;
  Put(text, value, bytes);
  out.replace(at, text.size(), text);
}

// Four samples in five bytes, the first in the upper bits; rows run downwards.
inline std::string Packed10(const core::Frame& frame) {
  std::string out;
  std::uint64_t bits = 0;
  int count = 0;
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    for (std::int32_t x = 0; x < frame.width_px; ++x) {
      bits = bits << 10 | frame.at(x, y);
      for (count += 10; count >= 8; count -= 8) {
        out += static_cast<char>(bits >> (count - 8) & 0xFF);
      }
    }
  }
  return out;
}

// Rows run upwards.
inline std::string Plain(const core::Frame& frame) {
  std::string out;
  for (std::int32_t y = frame.height_px - 1; y >= 0; --y) {
    for (std::int32_t x = 0; x < frame.width_px; ++x) {
      Put(out, frame.at(x, y), frame.is_16_bit() ? 2 : 1);
    }
  }
  return out;
}

}  // namespace cine_file

inline std::string CineFile::Bytes() const {
  using cine_file::Put;
  using cine_file::PutAt;
  constexpr std::uint32_t kHeader = 44;
  constexpr std::uint32_t kBitmap = 40;
  constexpr std::uint32_t kSetup = 7308;
  const core::Frame first = frames.front().View();
  const auto images = static_cast<std::uint32_t>(frames.size());
  std::string blocks;
  if (!stamps_s.empty()) {
    Put(blocks, 8 + 8 * stamps_s.size(), 4);
    Put(blocks, 1002, 4);
    for (const double stamp : stamps_s) {
      const auto ticks =
          static_cast<std::uint64_t>(std::llround(std::ldexp(stamp, 32)));
      constexpr std::uint64_t kFlags = 3;
      Put(blocks, ((since_1970_s << 32) + ticks) | kFlags, 8);
    }
  }
  if (!exposures_s.empty()) {
    Put(blocks, 8 + 4 * exposures_s.size(), 4);
    Put(blocks, 1003, 4);
    for (const double exposure : exposures_s) {
      Put(blocks, static_cast<std::uint64_t>(std::ldexp(exposure, 32)), 4);
    }
  }
  const std::uint32_t offsets =
      kHeader + kBitmap + kSetup + static_cast<std::uint32_t>(blocks.size());

  std::string out = "CI";
  Put(out, kHeader, 2);
  Put(out, 0, 2);  // gray
  Put(out, 1, 2);
  for (int i = 0; i < 2; ++i) {
    Put(out, static_cast<std::uint32_t>(first_image), 4);
    Put(out, images, 4);
  }
  Put(out, kHeader, 4);
  Put(out, kHeader + kBitmap, 4);
  Put(out, offsets, 4);
  Put(out, 0, 8);  // time of the trigger

  std::string setup(kSetup, '\0');
  setup.replace(140, 2, "ST");
  PutAt(setup, 142, kSetup, 2);
  PutAt(setup, 768, stated_fps, 4);
  const std::uint32_t stored = packed_10 ? 10 : first.is_16_bit() ? 16 : 8;
  PutAt(setup, 896, real_bits > 0 ? real_bits : stored, 4);

  const auto picture = [&](const Image& image) {
    return packed_10 ? cine_file::Packed10(image.View())
                     : cine_file::Plain(image.View());
  };
  const std::size_t bytes = picture(frames.front()).size();
  Put(out, kBitmap, 4);
  Put(out, static_cast<std::uint32_t>(first.width_px), 4);
  Put(out, static_cast<std::uint32_t>(first.height_px), 4);
  Put(out, 1, 2);
  Put(out, first.is_16_bit() ? 16 : 8, 2);
  Put(out, packed_10 ? 256 : 0, 4);
  Put(out, bytes, 4);
  Put(out, 0, 16);
  out += setup;
  out += blocks;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Put(out, offsets + 8 * frames.size() + i * (bytes + 8), 8);
  }
  for (const Image& frame : frames) {
    Put(out, 8, 4);  // the annotation: its length and that of the picture
    Put(out, bytes, 4);
    out += picture(frame);
  }
  return out;
}

}  // namespace touchdown::vision
