// Selected trials as the report takes them.
#pragma once

#include <filesystem>

#include "app/report/report.h"
#include "app/trials/trial_selection.h"

namespace touchdown::pipeline {

// With this program's version and the day (UTC); theories and study are the
// defaults.
report::ReportInput MakeReportInput(Selection selection);

// What stands in report.toml beside the store; nothing where there is none.
// Throws core::InputError as report::ReadDetails.
report::Details ReadStoreDetails(const std::filesystem::path& store);

}  // namespace touchdown::pipeline
