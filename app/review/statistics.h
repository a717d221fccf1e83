// What the trials of a store say together: the same groups, sentences, tables
// and plots as `touchdown boundary`, `next` and `report`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/report/report.h"

namespace touchdown::review {

struct Statistics {
  // touchdown.review.statistics/1: `groups` (the fields of touchdown.boundary/1
  // with name, sentences and the plot's text), `table1` (tables of one origin
  // each), `without_trials` (campaigns with the angle to begin with),
  // `check_shots` (what their control charts say).
  std::string json;
  std::vector<std::string> plots;  // SVG, one a group
};

// `reach_of`: what the next angle stays within; empty: any angle. Throws as the
// report does: core::StoreError, core::InputError without a plotter.
Statistics MakeStatistics(const std::filesystem::path& store,
                          const report::ReachOf& reach_of = {});

}  // namespace touchdown::review
