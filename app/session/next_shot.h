// The next shot of a campaign: the rig's settings for the angle to throw.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/shots/thrower.h"
#include "touchdown/core/expected.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::session {

using pipeline::Thrower;

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

}  // namespace touchdown::session
