// Which trials a statistic or a report is made of, and where they come from.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "touchdown/core/campaign.h"
#include "touchdown/core/trial.h"
#include "touchdown/core/words.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"

namespace touchdown::pipeline {

// Exactly one of `store`, `csv` and `paper_table1` is the source.
struct SelectionOptions {
  std::filesystem::path store;
  std::filesystem::path csv;
  bool paper_table1 = false;
  double paper_u_rad = 0.0;  // assumed u of the paper's angles

  // Filters; each that is set must hold. Excluded trials are always selected:
  // a report lists them with their reasons.
  std::optional<std::string> campaign;
  std::optional<std::string> surface;
  std::optional<core::BodyKind> body;  // of a CSV file: what was thrown
  std::optional<core::AngleKind> angle_kind;
  std::optional<core::Origin> origin;
  std::optional<std::string> from_utc;  // first logged from <= t < until
  std::optional<std::string> until_utc;
  // Of a store: also what the program said of trials that a person revised, and
  // the documents of the analyses. A report wants them, an estimate does not.
  bool with_evidence = false;
  bool reviewed_only = false;  // only trials that a person has corrected

  // The theory and margin of a CSV file, which has no campaign to declare one.
  std::string theory_name;
  std::optional<double> theory_rad;
  double theory_u_rad = 0.0;
  double margin_rad = 0.0;  // 0: the default of a campaign
};

// One trial's two labels.
struct TwoLabels {
  std::string trial;  // id
  core::MotionState by_program = core::MotionState::kUndecided;
  core::MotionState by_person = core::MotionState::kUndecided;
};

struct Selection {
  std::vector<core::Trial> trials;
  std::vector<core::Campaign> campaigns;
  std::vector<TwoLabels> labels;  // with_evidence: of those that bear both
  std::string source;             // in words: file and filters
  std::vector<db::PlanEvent> plan = {};  // of a store's campaigns
  // with_evidence, of a store: when trials that were revised had been logged,
  // by id, and the versions of the register that the trials name.
  std::map<std::string, std::string> first_logged_utc = {};
  std::vector<db::Entry> register_entries = {};
};

// Throws std::invalid_argument unless there is exactly one source,
// core::InputError and core::StoreError where it cannot be read.
Selection SelectTrials(const SelectionOptions& options);

}  // namespace touchdown::pipeline
