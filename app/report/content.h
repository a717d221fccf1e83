// What the report says, computed once, before it is written three ways.
// Internal to app/report.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/report/document.h"
#include "app/report/report.h"
#include "touchdown/analysis/agreement.h"
#include "touchdown/analysis/observation.h"

namespace touchdown::report {

// One theory's boundary beside the trials of a group.
struct Compared {
  ReportTheory theory;
  bool declared = false;  // the campaign's own: the only one with a verdict
  analysis::Agreement agreement;
};

// One group of trials with all that is said of it.
struct Group {
  analysis::TrialGroup trials;
  core::Campaign campaign;  // made up from the trials where not registered
  bool registered = false;  // the campaign is known to the store
  std::vector<std::size_t> members;  // its trials, in the order of the tables
  analysis::Counts counts;
  analysis::Bracket bracket;
  std::vector<Compared> compared;                // the declared theory first
  std::optional<analysis::Judgement> judgement;  // of the declared theory

  bool simulated() const { return trials.origin == core::Origin::kSimulated; }
};

// All groups; `trials` must be sorted by SortTrials().
std::vector<Group> MakeGroups(const ReportInput& input,
                              std::span<const core::Trial> trials);

// The order of every table: campaign, body, kind, origin, set-point, measured
// angle, clip, identity. A total order, so that the report does not depend on
// the order in which a store gives its trials.
void SortTrials(std::vector<core::Trial>& trials);

// "sphere", or "sphere (campaign)" where `groups` has several of that body.
std::string ShortName(const Group& group, std::span<const Group> groups);

// "approach angle"; the contact angle's name for a group.
std::string AngleName(const Group& group);

// The paper's word: every not-bounce is "slide".
std::string PaperWord(core::MotionState state);

// "bracket [11.8, 27.4) deg" in words.
std::string BracketText(const analysis::Bracket& bracket);

// One sentence on how a theory agrees with the trials.
std::string AgreementText(const Compared& compared);

// The Table 1 of groups that share an origin (paper_table.cc).
std::vector<Table> MakeTable1(std::span<const Group> groups,
                              std::span<const core::Trial> trials);

// The group's own pages (group_section.cc).
Section MakeGroupSection(const Group& group, std::span<const Group> groups,
                         std::span<const core::Trial> trials);

// The group's plot with its text. `index` makes identifiers unique.
Figure MakeFigure(const Group& group, std::size_t index);

// The group's verdict in a box, for page 1.
Callout MakeVerdict(const Group& group, std::span<const Group> groups);

// What the paper's own Table 1 supports, and its errata (paper_section.cc).
Section MakePaperSection();

// table1.csv (report_csv.cc).
std::string MakeCsv(std::span<const Group> groups,
                    std::span<const core::Trial> trials);

}  // namespace touchdown::report
