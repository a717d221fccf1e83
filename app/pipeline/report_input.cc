#include "app/pipeline/report_input.h"

#include <string>
#include <utility>

#include "app/pipeline/version.h"

namespace touchdown::pipeline {

report::ReportInput InputOf(Selection selection) {
  report::ReportInput input;
  input.trials = std::move(selection.trials);
  input.campaigns = std::move(selection.campaigns);
  for (const TwoLabels& pair : selection.labels) {
    input.labels.push_back({pair.trial, pair.by_program, pair.by_person});
  }
  input.plan = std::move(selection.plan);
  input.source = std::move(selection.source);
  input.software_version = std::string(Version());
  return input;
}

}  // namespace touchdown::pipeline
