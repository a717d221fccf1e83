// The text beside a Photron recording: .cih ("Key : value" lines) or .cihx (the
// same facts as XML between binary blocks).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct PhotronHeader {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int64_t frames = 0;       // in the file
  std::int32_t stored_bits = 0;  // of a sample in the file: 8, 12 (packed), 16
  std::int32_t effective_bits = 0;  // that carry signal, <= 16
  bool effective_higher = false;    // they are the upper ones of the container
  double record_rate_hz = 0.0;      // of the camera, before save_step
  std::int64_t save_step = 1;    // every n-th recorded frame was saved; 0: odd
  std::int64_t start_frame = 0;  // camera's number of the first; may be < 0
  std::optional<SensorOrigin> sensor_origin;
};

// Reads and checks a header; `path` decides between the two forms by its
// extension. Throws core::InputError naming the file, the entry, its value and
// what was expected, if an entry that matters is missing or impossible, or if
// the recording is of a kind that is not read (colour, bits other than 8, 12,
// 16, another file format than MRaw).
PhotronHeader ReadPhotronHeader(const std::filesystem::path& path);

// The same from bytes in memory; `name` stands for the file in messages.
PhotronHeader ParseCih(std::string_view text, const std::string& name);
PhotronHeader ParseCihx(std::string_view bytes, const std::string& name);

}  // namespace touchdown::vision
