// A campaign made on the page: its conventions, its body, the camera, scale and
// ground as they were marked on a recording. The recording is analysed with
// them first and shown; nothing is stored until a person says so, and then the
// campaign and its first trial are.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/review/desk.h"
#include "touchdown/db/store.h"

namespace touchdown::review {

// The test that the page asks for:
//   {"recording": {folder, name},
//    "campaign": {name, body, diameter_mm, sides_mm, surface, angle_kind,
//                 bounce_height_mm, speed_mps, theory, theory_boundary_deg,
//                 theory_u_deg, margin_deg},
//    "camera": {camera, fps, scale_px: [x1, y1, x2, y2], length_mm,
//               ground_px: [x1, y1, x2, y2], lens: a touchdown.calibration/1}}
// Points are of the recorded picture, each good to a careful click
// (pipeline::kByHand_px); what is absent is found in the clip. Throws
// pipeline::FieldError; also for a campaign that has trials already.
AnalysisOrder ReadTestOrder(Desk& desk, const nlohmann::json& asked);

// A lens from a folder of board pictures, as `touchdown calibrate lens` makes
// it: {"pictures": {folder, name}, "board": text, "camera": name}. The answer
// holds it as "calibration", for ReadTestOrder, with how good it is. Throws
// pipeline::FieldError, and core::InputError where the pictures tell none.
nlohmann::ordered_json LensJson(const RecordingFolders& folders,
                                const nlohmann::json& asked);

// touchdown.review.test/1: what became of it, its numbers and picture, what was
// known of the camera, and each check of the answer.
nlohmann::ordered_json TestJson(const AnalysisStatus& status);

// Makes the store where there is none, the campaign, and logs the trial as
// `touchdown analyze --db` does. `status` is of a test that is done. Throws
// like ReadTestOrder and core::StoreError.
db::Logged Keep(const std::filesystem::path& store,
                const AnalysisStatus& status, const std::string& who);

}  // namespace touchdown::review
