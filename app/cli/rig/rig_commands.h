// The parts of `touchdown rig`; what they share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/text/json.h"
#include "touchdown/rig/predict.h"

namespace touchdown::cli {

using report::Json;

void AddRigSpring(CLI::App& rig, Action& action);
void AddRigLaunch(CLI::App& rig, Action& action);
void AddRigPlan(CLI::App& rig, Action& action);
void AddRigCalibrate(CLI::App& rig, Action& action);

// Of the predictions; repeated with the same seed they are the same to the
// byte.
struct DrawFlags {
  std::size_t draws = rig::PredictOptions{}.draws;
  std::uint64_t seed = 1;
};

void AddDrawFlags(CLI::App& app, DrawFlags& flags);

// Throws std::invalid_argument unless 2 <= draws <= 1e8.
void RequireDraws(std::size_t draws);

void Print(const Json& json);

}  // namespace touchdown::cli
