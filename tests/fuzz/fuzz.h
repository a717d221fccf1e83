// What the fuzz targets share. Each <name>_fuzz.cc defines
// LLVMFuzzerTestOneInput, which feeds one reader with bytes: whatever they are,
// the reader answers or refuses with one of the project's own errors, and
// everything else (a crash, a sanitizer's finding, another exception, a broken
// promise) ends the program.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "touchdown/core/errors.h"
#include "touchdown/core/frame.h"

namespace touchdown::fuzz {

inline std::string_view Text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Ends the program where what must hold does not.
inline void Require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: this must hold: %s\n", what);
  std::abort();
}

// Runs `read`; true unless the input was refused, in one line.
template <class Read>
bool Answers(const Read& read) {
  try {
    read();
    return true;
  } catch (const core::InputError& error) {
    const std::string_view what = error.what();
    Require(!what.empty(), "an error says what is wrong");
    return false;
  }
}

// A folder of this process in memory, for readers that take paths.
inline const std::filesystem::path& Scratch() {
  static const std::filesystem::path folder = [] {
    std::filesystem::path root = "/dev/shm";
    std::error_code ignored;
    if (!std::filesystem::is_directory(root, ignored)) {
      root = std::filesystem::temp_directory_path();
    }
    root /= "touchdown-fuzz-" + std::to_string(getpid());
    std::filesystem::create_directories(root);
    std::atexit([] {
      std::error_code trouble;
      std::filesystem::remove_all(Scratch(), trouble);
    });
    return root;
  }();
  return folder;
}

inline std::filesystem::path WriteScratch(const char* name,
                                          std::string_view bytes) {
  const std::filesystem::path path = Scratch() / name;
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

// Touches every sample, so that the sanitizer sees a view that is too large,
// and checks that no sample has more bits than the view says.
inline void Touch(const core::Frame& frame) {
  std::uint32_t all = 0;
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    for (std::int32_t x = 0; x < frame.width_px; ++x) all |= frame.at(x, y);
  }
  Require(frame.is_16_bit() || all <= 0xFF, "8-bit samples have 8 bits");
}

}  // namespace touchdown::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size);
