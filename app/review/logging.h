// Trials logged on the page, and the report built there.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "app/report/report.h"
#include "touchdown/db/store.h"

namespace touchdown::review {

// A trial by hand, fields as the flags of `touchdown log` with underscores:
// campaign, who, state, angle_deg, angle_u_deg, set_angle_deg, set_speed_mps,
// corner, note. Numbers may come as text, as they were typed. Throws
// pipeline::FieldError.
db::Logged LogTyped(const std::filesystem::path& store,
                    const nlohmann::json& asked);

// Analyses a recording of this machine as `touchdown analyze --db --campaign`
// does, and logs it: campaign, clip, set_angle_deg, set_speed_mps.
db::Logged LogRecording(const std::filesystem::path& store,
                        const nlohmann::json& asked);

// The report of the whole store, into `folder`; how many trials are in it.
// `reach_of`: what the next angle stays within.
std::size_t BuildReport(const std::filesystem::path& store,
                        const std::filesystem::path& folder,
                        const report::ReachOf& reach_of = {});

}  // namespace touchdown::review
