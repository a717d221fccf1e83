#include "app/report_input/report_input.h"

#include <fmt/chrono.h>

#include <ctime>
#include <string>
#include <system_error>
#include <utility>

#include "app/text/version.h"

namespace touchdown::pipeline {

report::ReportInput MakeReportInput(Selection selection) {
  report::ReportInput input;
  input.trials = std::move(selection.trials);
  input.campaigns = std::move(selection.campaigns);
  for (const TwoLabels& pair : selection.labels) {
    input.labels.push_back({pair.trial, pair.by_program, pair.by_person});
  }
  input.plan = std::move(selection.plan);
  input.source = std::move(selection.source);
  input.first_logged_utc = std::move(selection.first_logged_utc);
  input.register_entries = std::move(selection.register_entries);
  input.software_version = std::string(Version());
  // A report is dated in UTC like the times of its trials, whatever the clock
  // of the machine that makes it.
  input.made_on = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  return input;
}

report::Details ReadStoreDetails(const std::filesystem::path& store) {
  // A laboratory writes report.toml once, beside its store, and every report of
  // the store takes it.
  const std::filesystem::path file = store.parent_path() / "report.toml";
  std::error_code ignored;
  // No store, or no such file, is no error: the report names what is absent. A
  // file that is there but cannot be read is one.
  if (store.empty() || !std::filesystem::exists(file, ignored)) return {};
  return report::ReadDetails(file);
}

}  // namespace touchdown::pipeline
