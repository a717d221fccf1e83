// Set-points beside measurement, and the rig's prediction where its description
// was given.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/report/document.h"
#include "app/report/group.h"
#include "app/report/report.h"

namespace touchdown::report {

// Of every trial of a group that has set-points; nothing where none has.
std::vector<Block> MakeSetPoints(const Group& group,
                                 std::span<const core::Trial> trials,
                                 const ReportInput& input);

// Of one trial, for its own page.
std::vector<Block> MakeTrialSetPoints(const core::Trial& trial,
                                      const ReportInput& input);

// A trial in a table: its name, with a link to its page where there is one.
Cell TrialCell(const core::Trial& trial, const ReportInput& input);

// The clip's name; without a clip the beginning of the identity, which
// `touchdown show` takes and table1.csv has whole.
std::string TrialName(const core::Trial& trial);

}  // namespace touchdown::report
