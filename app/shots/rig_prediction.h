// What a rig was expected to do in trials that have set-points.
#pragma once

#include <filesystem>
#include <span>

#include "app/report/shot_prediction.h"
#include "touchdown/core/trial.h"
#include "touchdown/rig/description.h"

namespace touchdown::pipeline {

// The setting that gives the trial's set angle at its set launch speed, and the
// launch speed and approach angle that this setting predicts; the trial's own
// launch speed from its speed at touchdown, v0^2 = v^2 - 2 g h with h the fall
// of that setting. Absent with the reason where a set-point is missing, the
// body is another, or the rig cannot do it.
report::ShotPrediction PredictShot(const rig::Description& rig,
                                   const core::Trial& trial);

// Of every trial with a set-point, and the rig's own facts with the digest of
// its file. Throws core::InputError where the file cannot be read.
report::RigUsed PredictTrials(const std::filesystem::path& rig_file,
                              std::span<const core::Trial> trials);

}  // namespace touchdown::pipeline
