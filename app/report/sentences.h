// What the numbers of a group mean, in sentences: the same on the page and in
// the terminal.
#pragma once

#include <string>

#include "app/report/group.h"
#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/boundary_study.h"

namespace touchdown::report {

// "bracket [11.8, 27.4) deg, 15.6 deg wide", or why there is none.
std::string BracketSentence(const analysis::Bracket& bracket);

// "12.4 deg, 95 % interval 11.6 to 13.1 deg", with what limits it.
std::string BoundarySentence(const analysis::BoundaryStudy& study);

// "9 of 9 agree with the published boundary, 11.8 deg, but ..."
std::string AgreementSentence(const analysis::TheoryComparison& theory);

// The word of the verdict, and the reason with what would decide.
std::string VerdictWord(const Group& group);
std::string VerdictSentence(const Group& group);

// "About 8 more trials near 11 deg would decide ..."; empty where decided.
std::string OutlookSentence(const Group& group);

// "12.40 deg (within 5.00 to 60.00 deg, what bench throws at 1.3 m/s).", and
// what is done where all trials bounced or none did: the one next angle, in the
// same words wherever it is said.
std::string NextSentence(const Group& group);

// What kind of data these are, and what follows for the estimate.
std::string StatusSentence(const analysis::BoundaryStudy& study);

}  // namespace touchdown::report
