// What the trials of a store say together: the same groups, sentences, tables
// and plots as `touchdown boundary`, `next` and `report`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace touchdown::review {

struct Statistics {
  // touchdown.review.statistics/1: `groups` (the fields of touchdown.boundary/1
  // with name, sentences and the plot's text), `table1` (tables of one origin
  // each), `without_trials` (campaigns with the angle to begin with).
  std::string json;
  std::vector<std::string> plots;  // SVG, one a group
};

// Throws as the report does: core::StoreError, core::InputError without a
// plotter.
Statistics MakeStatistics(const std::filesystem::path& store);

}  // namespace touchdown::review
