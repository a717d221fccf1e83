// One page a trial: everything that is known of it, for whoever doubts a number
// of the report.
#pragma once

#include <filesystem>
#include <string>

#include "app/report/document.h"
#include "app/report/report.h"
#include "touchdown/core/trial.h"

namespace touchdown::report {

// The file's name inside the folder `evidence/` of a report: the trial's id, or
// what of it a file name can hold with a digest of the whole.
std::string EvidencePageName(const core::Trial& trial);

// Where the report links to, "" where it has no pages.
std::string EvidenceLink(const ReportInput& input, const core::Trial& trial);

// State, angles, budget, motion, set-points, calibration, picture, record. The
// same input gives the same page. Throws core::InputError where the trial's
// picture cannot be read.
Document MakeEvidencePage(const core::Trial& trial, const ReportInput& input);

// Writes evidence/<name>.html for every trial, below `folder` (made where it is
// missing), one after the other: memory does not grow with their number.
// Throws core::InputError.
void WriteEvidencePages(const ReportInput& input,
                        const std::filesystem::path& folder);

}  // namespace touchdown::report
