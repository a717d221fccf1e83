// What `analyze` can be told of a clip, shared with the commands that analyse
// many.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/pipeline/analyze.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace touchdown::cli {

struct AnalyzeFlags {
  std::string calibration;
  std::string crop;
  std::string scale;
  std::string body = "auto";
  std::string diameter;
  std::string sides;
  std::optional<double> fps;
  std::string ground;
  double ground_u_px = 0.5;
  std::optional<std::int64_t> contact_frame;
  std::string frames;
  std::string region;
  std::string angle_kind;
  std::optional<double> bounce_height_mm;
  bool stop_early = false;
};

void AddAnalyzeFlags(CLI::App& command, AnalyzeFlags& flags);

// Throws std::invalid_argument naming the flag, what was given and what is
// expected.
pipeline::AnalyzeOptions ToOptions(const AnalyzeFlags& flags);

}  // namespace touchdown::cli
