// export --format tidy: the views of the store as CSV, and for every CSV that
// is exported its schema beside it (CSV on the Web, W3C: FILE-metadata.json).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/db/store.h"
#include "touchdown/db/views.h"

namespace touchdown::cli {

// trials.csv, contacts.csv, tracks.csv, campaigns.csv and revisions.csv, each
// with its schema, into `folder` (made where there is none): of one campaign
// where it is named. All of them, or none: throws core::OutputError.
void WriteTidy(const db::Store& store, std::string_view campaign,
               const std::filesystem::path& folder);

// The schema of what WriteTrialsCsv writes, beside `csv`.
void WriteTrialsSchema(const std::filesystem::path& csv);

}  // namespace touchdown::cli
