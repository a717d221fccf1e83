// The paper's Table 1 as trials: the first report of a new user is the paper's.
#pragma once

#include <vector>

#include "touchdown/core/campaign.h"
#include "touchdown/core/trial.h"

namespace touchdown::pipeline {

struct PaperTrials {
  std::vector<core::Trial> trials;        // 18, origin manual
  std::vector<core::Campaign> campaigns;  // one a body, with its theory
};

// Nine angles for each of the two bodies. The paper gives no uncertainty of its
// angles; `u_rad` (>= 0) is the caller's assumption. The sphere's angle is
// taken as the approach angle (its radius angle is always 90 deg), the
// rectangle's as the radius angle of the paper's Fig. 1. Sizes and surface are
// not in the paper.
PaperTrials PaperTable1Trials(double u_rad);

}  // namespace touchdown::pipeline
