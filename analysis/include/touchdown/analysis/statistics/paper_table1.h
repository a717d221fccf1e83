// The paper's Table 1, the data set that every report is compared with.
#pragma once

#include <vector>

#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/words.h"

namespace touchdown::analysis {

// The nine trials of Table 1 for one body (omega = 0): angles
// 0, 3.9, 7.8, 11.8, 27.4, 43, 58.7, 74.4 and 90 deg. The paper gives no
// uncertainty of its angles and they read like set-points, so `u_rad` is the
// caller's assumption. Section 4 of the paper swaps the two bodies in the text;
// the table is used. Throws std::invalid_argument unless u_rad is finite and
// not negative.
std::vector<Observation> PaperTable1(core::BodyKind body, double u_rad);

// The boundary that the paper states: 11.8 deg for its sphere, 7.8 deg for its
// rectangle. Published, not derived: for omega = 0 the printed equations have
// B = -g < 0 and A > 0 at every angle, so they say "slide" everywhere.
TheoryBoundary PaperTable1Boundary(core::BodyKind body);

}  // namespace touchdown::analysis
