// Small rendered recordings on the disk.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>

#include "tests/pipeline/filmed.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::pipeline::filmed {

// As `path` (.mraw) with its header. Another seed is another recording of the
// same throw.
inline void WriteFilm(const std::filesystem::path& path, const Film& film,
                      std::uint64_t seed) {
  const auto clip = vision::OpenScene(BuildScene(film), seed);
  vision::MrawOptions options;
  options.fps = film.camera.fps;
  std::int64_t frame = 0;
  vision::WriteMraw(path, options, [&]() -> std::optional<core::Frame> {
    if (frame == clip->info().frames) return std::nullopt;
    return clip->Read(frame++);
  });
}

// A sphere of 24 mm at `angle_deg`.
inline Film ThrownSphere(double angle_deg) {
  Film film = Default(core::BodyKind::kSphere);
  const double angle = angle_deg * core::kDegree;
  film.thrown.before = {1.3 * std::cos(angle), -1.3 * std::sin(angle), 0.0};
  film.thrown.after = {1.1 * std::cos(angle), 0.8 * std::sin(angle), 0.0};
  return film;
}
inline void WriteSphere(const std::filesystem::path& path, double angle_deg,
                        std::uint64_t seed) {
  WriteFilm(path, ThrownSphere(angle_deg), seed);
}

// As a folder of PNG, which tells no frame rate; of the film of WriteSphere.
inline void WriteImages(const std::filesystem::path& folder, double angle_deg,
                        std::uint64_t seed) {
  const auto clip =
      vision::OpenScene(BuildScene(ThrownSphere(angle_deg)), seed);
  std::int64_t frame = 0;
  vision::WriteImageFolder(folder, {}, [&]() -> std::optional<core::Frame> {
    if (frame == clip->info().frames) return std::nullopt;
    return clip->Read(frame++);
  });
}

// Something that has the name of a recording and is none.
inline void WriteRubbish(const std::filesystem::path& path) {
  std::ofstream(path, std::ios::binary) << "not a recording";
}

}  // namespace touchdown::pipeline::filmed
