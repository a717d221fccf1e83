// An analysis out of the store again: the track and all that it was judged
// with, so that it can be looked at and corrected without reading the clip.
//
// In the document it stands under "replay": options (SI, radians), the ground
// line with its reference point, the body's image and, a line of text for each
// frame, the poses to 1e-5 px (a thousandth of what is known of them).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "app/measure/analyze.h"
#include "touchdown/core/expected.h"
#include "touchdown/core/trial.h"

namespace touchdown::pipeline {

nlohmann::ordered_json ReplayJson(const Analysis& analysis);

// The trial that an analysis makes: for the store and the report. id, revision
// and time stamps are the store's.
core::Trial ToTrial(const Analysis& analysis);

// The analysis that the trial's document holds, judged again by this program
// (judge.h). Absent, with the reason, where the trial has no document, its
// analysis saw no body or no ground, or an earlier program wrote it, which kept
// no track.
core::Expected<Analysis> Replay(const core::Trial& trial);

// What the trial's analysis was told of the camera: frame rate, gamma, scale,
// calibration and crop; nothing of the body or of this one clip. Nothing where
// its document does not say.
std::optional<AnalyzeOptions> ReadCameraOptions(const core::Trial& trial);

// The trial as it is to be stored after a correction: who, when and the clip
// stay, what was measured is the analysis's.
core::Trial WithAnalysis(const core::Trial& seen, const Analysis& analysis);

}  // namespace touchdown::pipeline
