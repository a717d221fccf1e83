// The columns of a CSV of trials. Internal to trial_csv.cc.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/exchange/trial_csv.h"
#include "touchdown/core/trial.h"

namespace touchdown::report {

// A column: how a cell is written, and how it is read. Reading throws
// std::invalid_argument, saying what was expected.
struct TrialColumn {
  CsvColumn about;
  std::function<std::string(const core::Trial&)> write;
  std::function<void(core::Trial&, const std::string&)> read;
  bool is_uncertainty = false;  // to be read after the values
};

// The i-th measured quantity of core::kBodyQuantities and
// core::kContactQuantities.
core::Measured& BodyMeasured(core::Trial& trial, std::size_t i);
core::Measured& ContactMeasured(core::Trial& trial, std::size_t i);

const std::vector<TrialColumn>& AllColumns();

// Nothing where there is no column of that name.
const TrialColumn* FindColumn(std::string_view name);

}  // namespace touchdown::report
