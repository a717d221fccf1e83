// Check shots: a known body, dropped. What they say of camera and software.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/report/report.h"
#include "touchdown/analysis/statistics/control_chart.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/trial.h"

namespace touchdown::report {

// One quantity of the check shots over time.
struct CheckSeries {
  std::string quantity;                // "speed at touchdown (m/s)"
  std::vector<core::Estimate> values;  // in that unit
  std::vector<std::size_t> shots;      // index of each in CheckShots::shots
  core::Expected<analysis::IndividualsChart> chart =
      core::AbsentBecause("no check shot");
};

// The check shots of one campaign and origin.
struct CheckShots {
  core::Campaign campaign;
  core::Origin origin = core::Origin::kRecorded;
  std::vector<std::size_t> shots;  // in time order: indices of the trials
  CheckSeries speed;
  CheckSeries angle;
};

// Of `trials` in any order: sorted by when they were recorded, then by id.
// Excluded shots are in `shots` and in no series.
std::vector<CheckShots> CollectCheckShots(const ReportInput& input,
                                          std::span<const core::Trial> trials);

// "12 check shots; mean speed ... ; all within ... ", for a person.
std::string CheckSentence(const CheckSeries& series);

}  // namespace touchdown::report
