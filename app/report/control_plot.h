// The control chart of single values, as a plot.
#pragma once

#include <string>
#include <vector>

#include "touchdown/analysis/statistics/control_chart.h"

namespace touchdown::report {

struct ControlPlot {
  std::string quantity;              // "speed at touchdown (m/s)"
  std::vector<double> values;        // in the unit of `quantity`, in time order
  std::vector<double> twice_u;       // half-lengths of their bars
  analysis::IndividualsChart chart;  // of `values`
  bool simulated = false;
  std::string id;  // makes identifiers unique in a page
};

// Throws core::InputError where gnuplot is missing or refuses.
std::string DrawControlPlot(const ControlPlot& plot);

}  // namespace touchdown::report
