// Trials from a CSV file: what a person types into a spreadsheet.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "touchdown/core/trial.h"
#include "touchdown/core/words.h"

namespace touchdown::pipeline {

// What a file of bare angles does not say of its trials.
struct CsvTrials {
  std::string campaign;
  core::BodyKind body = core::BodyKind::kSphere;
  core::AngleKind angle_kind = core::AngleKind::kApproach;
  core::Origin origin = core::Origin::kManual;
};

// Reads columns angle_deg, u_deg and p_bounce, optionally set_angle_deg,
// common_u_deg (an error that the trials of a set-up share, beside u_deg) and
// calibration (which tells one set-up from another), in any order, named in the
// first line; other columns are ignored. Angles from 0 to
// 90, u_deg >= 0, p_bounce from 0 to 1: 1 bounce, 0 slide, between them how
// sure it is (0.025 to 0.975 is undecided). Throws core::InputError naming
// file, line and column.
std::vector<core::Trial> ReadTrialsCsv(const std::filesystem::path& path,
                                       const CsvTrials& what);

}  // namespace touchdown::pipeline
