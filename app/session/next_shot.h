// The next shot of a campaign: what there is to know so far, the angle to
// throw, and the rig's settings for it.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/report/group.h"
#include "touchdown/analysis/next_angle.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"
#include "touchdown/rig/description.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::session {

// The rig that throws, and what is asked of it.
struct Thrower {
  rig::Description rig;
  rig::ContactWish wish;  // all but the angle
  std::string file;       // the rig's description, for messages
};

// `speed_mps` at touchdown; 0: the middle of the campaign's band. Throws
// std::invalid_argument naming the flag where the rig's body is not the
// campaign's or there is no speed; core::InputError as rig::ReadDescription.
Thrower MakeThrower(const std::filesystem::path& rig_file,
                    const core::Campaign& campaign, double speed_mps = 0.0,
                    std::optional<core::Corner> corner = std::nullopt);

// The contact angles that it can throw. Throws std::invalid_argument naming the
// rig's file and the reason where there are none.
core::Interval RequireReach(const Thrower& thrower);

// The settings for a contact at `angle_rad`, with what they predict.
core::Expected<rig::SetPoint> PlanNext(const Thrower& thrower,
                                       double angle_rad);

// rig, speed_mps, possible, reason, elevation_deg, compression_mm,
// muzzle_height_mm; null or left out where there is none.
nlohmann::ordered_json SetPointsJson(
    const Thrower& thrower, const core::Expected<rig::SetPoint>& point);

// "elevation 12.50 deg, compression 30.25 mm, muzzle height 300.0 mm (bench
// ejector, 1.3 m/s at touchdown)", or "none: " and why.
std::string SetPointsText(const Thrower& thrower,
                          const core::Expected<rig::SetPoint>& point);

// A group without a trial yet: there is nothing but the prior.
report::Group EmptyGroup(const core::Campaign& campaign,
                         const analysis::StudyOptions& study);

}  // namespace touchdown::session
