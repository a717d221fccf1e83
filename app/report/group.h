// Groups of trials that may be pooled, with all that is said of each: what the
// commands print and the report is made of.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "app/report/report.h"
#include "touchdown/analysis/statistics/boundary_study.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/trial.h"

namespace touchdown::report {

// A trial that the statistics leave out, as a person knows it.
struct NamedLeftOut {
  std::string trial;   // id
  std::string name;    // of the clip, else the beginning of the id
  std::string reason;  //
};

struct Group {
  analysis::TrialGroup trials;
  core::Campaign campaign;  // made up from the trials where not registered
  bool registered = false;  // the campaign is known to the store
  std::vector<std::size_t> members;  // its trials, in the order of the tables
  analysis::ScatterPrior prior;      // that the posterior was made with
  analysis::BoundaryStudy study;
  core::Expected<Reach> reach = core::AbsentBecause("no rig was given");
  // What the boundary was found to depend on beside the angle, where that
  // leaves the declared theory undecided; else empty.
  std::string dependence;
  std::vector<NamedLeftOut> left_out;
  std::vector<LabelPair> labels;   // of those members that bear both
  std::vector<std::string> notes;  // where each of study.theories comes from

  bool simulated() const { return trials.origin == core::Origin::kSimulated; }
  // The campaign's own theory, or nothing.
  const analysis::TheoryComparison* declared() const;
};

// The order of every table: campaign, body, kind, origin, set-point, measured
// angle, clip, identity. A total order, so that nothing depends on the order in
// which a store gives its trials.
void SortTrials(std::vector<core::Trial>& trials);

// All groups of `trials`, which SortTrials() has sorted; spheres first, as in
// the paper, then by campaign. Check shots are in none. Throws
// std::invalid_argument where two campaigns have one name.
std::vector<Group> MakeGroups(const ReportInput& input,
                              std::span<const core::Trial> trials);

// A group without a trial yet: there is nothing but the prior, and the angle to
// begin with.
Group EmptyGroup(const ReportInput& input, const core::Campaign& campaign);

// Why the statistics leave a trial out, by its index in the trials.
std::map<std::size_t, std::string> ReasonsLeftOut(const Group& group);

// "asphalt: sphere, approach angle, recorded": tells any two groups apart.
std::string FullName(const Group& group);

// "sphere", or "sphere (campaign)" where `groups` has several of that body.
std::string ShortName(const Group& group, std::span<const Group> groups);

// "approach angle": what the group's contact angle is.
std::string AngleName(const Group& group);

// The paper's word: every not-bounce is "slide".
std::string PaperWord(core::MotionState state);

}  // namespace touchdown::report
