// Trials logged on the page, and the report built there.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/report/report.h"
#include "app/review/analyses.h"
#include "app/review/recordings.h"
#include "touchdown/db/store.h"

namespace touchdown::review {

// A trial by hand, fields as the flags of `touchdown log` with underscores:
// campaign, who, state, angle_deg, angle_u_deg, set_angle_deg, set_speed_mps,
// corner, note. Numbers may come as text, as they were typed. Throws
// pipeline::FieldError.
db::Logged LogTyped(const std::filesystem::path& store,
                    const nlohmann::json& asked);

// A recording that is to be analysed and logged: recording ({folder, name}),
// campaign, who, set_angle_deg, set_speed_mps, conditions, again, and
// other_camera: true where the settings of the campaign's last recording do not
// hold. Throws pipeline::FieldError and core::StoreError.
AnalysisOrder ReadOrder(const std::filesystem::path& store,
                        const RecordingFolders& folders,
                        const nlohmann::json& asked);

// What the campaign's last recording that counts was analysed with
// (pipeline::ReadCameraOptions); nothing where there is none.
std::optional<pipeline::AnalyzeOptions> LastCamera(const db::Store& store,
                                                   const std::string& campaign);

// The report of the whole store, into `folder`; how many trials are in it.
// `reach_of`: what the next angle stays within.
std::size_t BuildReport(const std::filesystem::path& store,
                        const std::filesystem::path& folder,
                        const report::ReachOf& reach_of = {});

}  // namespace touchdown::review
