// Which contact angles a rig can throw: what the next angle is clipped to.
#pragma once

#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"
#include "touchdown/rig/description.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::pipeline {

// The widest interval of angles from 0 to 90 deg for which the rig has a
// setting (rig::FindSetting), its ends known to 0.01 deg; `wish.angle_rad` is
// passed over. Gaps narrower than 1 deg are not seen. Absent with the reason at
// 45 deg where there is none. Throws std::invalid_argument like FindSetting.
core::Expected<core::Interval> ReachableAngles(const rig::Description& rig,
                                               rig::ContactWish wish);

}  // namespace touchdown::pipeline
