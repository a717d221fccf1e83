// What `analyze` can be told of a clip, shared with the commands that analyse
// many.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/measure/analyze.h"

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
  std::optional<double> gamma;
  std::string ground;
  double ground_u_px = 0.5;
  std::optional<std::int64_t> contact_frame;
  std::string frames;
  std::string region;
  std::string angle_kind;
  std::optional<double> bounce_height_mm;
  bool stop_early = false;
  double limit_s = pipeline::kUsualLimit_s;
};

// --limit-s alone, for commands that analyse clips of their own.
void AddLimitFlag(CLI::App& command, double& limit_s);
// Throws std::invalid_argument for a limit that is none.
double ToLimit(double limit_s);

void AddAnalyzeFlags(CLI::App& command, AnalyzeFlags& flags);

// Throws std::invalid_argument naming the flag, what was given and what is
// expected.
pipeline::AnalyzeOptions ToOptions(const AnalyzeFlags& flags);

}  // namespace touchdown::cli
