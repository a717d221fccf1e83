// The rig that throws, and the contact angles that it can throw in a campaign:
// what bounds the next angle, wherever it is said.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/report/report.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/conditions.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/words.h"
#include "touchdown/db/store.h"
#include "touchdown/rig/description.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::pipeline {

// The rig that throws, and what is asked of it.
struct Thrower {
  rig::Description rig;
  rig::ContactWish wish;   // all but the angle
  std::string file;        // the rig's description, for messages
  std::string document;    // its whole text
  core::Registered entry;  // of the register, where it was taken from there
};

// `speed_mps` at touchdown; 0: the middle of the campaign's band. Throws
// std::invalid_argument naming the flag where the rig's body is not the
// campaign's or there is no speed; core::InputError as rig::ReadDescription.
// `rig_file` is a rig.toml or, where there is no such file, the name of a rig
// in the register of the store at `db`.
Thrower MakeThrower(const std::filesystem::path& rig_file,
                    const core::Campaign& campaign, double speed_mps = 0.0,
                    std::optional<core::Corner> corner = std::nullopt,
                    const std::filesystem::path& db = {});

// The rig of the register whose text is that of `thrower`: its version in
// force, or a new version or entry, made here, by the name that the rig.toml
// gives. So a trial keeps the rig as it was when the shot was made.
core::Registered KeepRig(db::Store& store, const Thrower& thrower,
                         const std::string& author);

// The contact angles that it can throw. Throws std::invalid_argument naming the
// rig's file and the reason where there are none.
core::Interval RequireReach(const Thrower& thrower);

// The same, for report::MakeGroups: with the rig's name and speed in words.
report::Reach ReachOfThrower(const Thrower& thrower);

// Of each campaign that is asked for; absent with the reason where the rig
// cannot throw for it. Throws core::InputError where the rig's description
// cannot be read.
report::ReachOf ReachOfRig(const std::filesystem::path& rig_file,
                           double speed_mps, std::optional<core::Corner> corner,
                           const std::filesystem::path& db = {});

}  // namespace touchdown::pipeline
