// Table 1, end to end, on rendered clips: simulate, analyse, log, report, and
// compare with the truth that the clips were rendered from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "touchdown/core/estimate.h"
#include "touchdown/core/words.h"

namespace touchdown::pipeline {

struct DemoOptions {
  std::filesystem::path folder;   // made if it is not there
  std::uint64_t seed = 1;         // of the clips' noise
  int threads = 0;                // 0: one for each core
  std::optional<double> limit_s;  // as AnalyzeOptions::limit_s, of each clip
  std::function<void(double share, const std::string& what)> progress;
};

struct DemoRow {
  std::string clip;
  core::AngleKind kind = core::AngleKind::kApproach;
  double true_angle_rad = 0.0;
  core::Measured angle_rad = core::AbsentBecause("not analysed");
  core::MotionState true_state = core::MotionState::kUndecided;
  core::MotionState state = core::MotionState::kUndecided;
  double analyze_s = 0.0;
  std::int64_t frames = 0;

  // As bounce or not; an undecided trial is not right.
  bool right() const;
};

struct DemoResult {
  std::vector<DemoRow> rows;
  int right = 0;
  double rmse_rad = 0.0;  // of the contact angle, over trials that have one
  int angles = 0;         // so many
  std::filesystem::path store;
  std::filesystem::path report;  // table1.html
};

// Writes clips/, evidence/, demo.db and report/ into the folder. A second run
// adds revisions to the same store. Throws what its parts throw.
DemoResult RunDemo(const DemoOptions& options);

}  // namespace touchdown::pipeline
