// What the trials of a campaign say together of scale, frame rate and the
// body's size: gravity from their flights, the size that was seen, restitution.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "touchdown/analysis/statistics/campaign_checks.h"
#include "touchdown/core/trial.h"

namespace touchdown::report {

// What one trial tells, from its motion and its document; each over what it
// should be. Absent with the reason.
struct TrialRatios {
  core::Measured gravity;  // over standard gravity
  core::Measured size;  // seen over stated, where the scale is not the body's
  double common_gravity_u = 0.0;  // relative: scale, local gravity
  double common_size_u = 0.0;     // relative: scale, statement, outline
  std::optional<double> px_per_m = {};
  std::optional<double> fps = {};
  bool scale_of_body = false;
};
TrialRatios ReadRatios(const core::Trial& trial);

struct CampaignChecks {
  core::Expected<analysis::PooledCheck> gravity =
      core::AbsentBecause("not looked at");
  core::Expected<analysis::PooledCheck> size =
      core::AbsentBecause("not looked at");
  // The mean restitution over 1, where it is above: no rebound gains speed.
  core::Expected<analysis::PooledCheck> restitution =
      core::AbsentBecause("not looked at");
  std::string explanation;  // of what failed; empty where nothing did

  bool Failed() const { return !explanation.empty(); }
  // "scale, frame rate or size", "the ground line", or both: what the failed
  // checks accuse.
  std::string Suspects() const;
};

// Of those of `members` that are recorded or simulated and not excluded; each
// an index into `trials`. Trials of several set-ups are pooled: what is wrong
// in all of them shows.
CampaignChecks CheckCampaign(std::span<const std::size_t> members,
                             std::span<const core::Trial> trials);

// "gravity agrees to 0.3 %: a scale 1.1 % wrong or a frame rate 0.6 % wrong
// would show", or that nothing can show it and why: one sentence.
std::string WhatChecksShow(const CampaignChecks& checks);

}  // namespace touchdown::report
