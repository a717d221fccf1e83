#include "app/pipeline/thrower.h"

#include <fmt/core.h>

#include <stdexcept>

#include "app/pipeline/rig_reach.h"

namespace touchdown::pipeline {

Thrower MakeThrower(const std::filesystem::path& rig_file,
                    const core::Campaign& campaign, double speed_mps,
                    std::optional<core::Corner> corner) {
  Thrower out;
  out.file = rig_file.string();
  out.rig = rig::ReadDescription(rig_file);
  if (out.rig.body && out.rig.body->kind != campaign.body.kind) {
    throw std::invalid_argument(fmt::format(
        "--rig: the body of {} is a {}, the trials are of a {}", out.file,
        core::Name(out.rig.body->kind), core::Name(campaign.body.kind)));
  }
  out.wish.kind = campaign.angle_kind;
  out.wish.corner = corner;
  out.wish.speed_mps =
      speed_mps > 0.0 ? speed_mps
                      : (campaign.speed_min_mps + campaign.speed_max_mps) / 2;
  if (!(out.wish.speed_mps > 0.0)) {
    throw std::invalid_argument(
        "--rig: needs --speed-mps, the speed at touchdown: the campaign "
        "declares no speed band");
  }
  return out;
}

core::Interval RequireReach(const Thrower& thrower) {
  const auto reach = ReachableAngles(thrower.rig, thrower.wish);
  if (reach) return *reach;
  throw std::invalid_argument(
      fmt::format("--rig: {} cannot throw any {} angle at {:g} m/s: {}",
                  thrower.file, core::Name(thrower.wish.kind),
                  thrower.wish.speed_mps, reach.error().reason));
}

report::Reach ReachOfThrower(const Thrower& thrower) {
  return {RequireReach(thrower),
          fmt::format("what {} throws at {:g} m/s",
                      thrower.rig.name.empty() ? "the rig" : thrower.rig.name,
                      thrower.wish.speed_mps)};
}

report::ReachOf ReachOfRig(const std::filesystem::path& rig_file,
                           double speed_mps,
                           std::optional<core::Corner> corner) {
  rig::ReadDescription(rig_file);  // throws now, not for each campaign
  return [=](const core::Campaign& campaign) -> core::Expected<report::Reach> {
    try {
      return ReachOfThrower(MakeThrower(rig_file, campaign, speed_mps, corner));
    } catch (const std::invalid_argument& mismatch) {
      return core::AbsentBecause(mismatch.what());
    }
  };
}

}  // namespace touchdown::pipeline
