// The plot of one group of trials: what was seen at which angle.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/estimate.h"

namespace touchdown::report {

// A vertical line at an angle.
struct PlotLine {
  std::string name;
  double angle_rad = 0.0;
  double u_rad = 0.0;  // a band of +- 2 u is drawn where it is not 0
};

// A curve over the angle.
struct PlotCurve {
  std::string name;
  std::vector<double> angle_rad;
  std::vector<double> height;
};

// The interval of the boundary, drawn whole as a bar. An end that the trials
// leave open has an arrow, which goes to the end of the axis.
struct PlotInterval {
  core::Interval angle_rad;
  double middle_rad = 0.0;
  bool open_low = false;
  bool open_high = false;
};

struct BoundaryPlot {
  std::string angle_name;  // of the horizontal axis, e.g. "approach angle"
  std::vector<analysis::Observation> observations;
  analysis::Bracket bracket;
  std::vector<PlotLine> lines;
  std::optional<PlotInterval> interval;  // of the boundary angle, 95 %
  PlotCurve density;   // of the boundary angle, to its own height; empty: none
  PlotCurve p_bounce;  // against the axis; empty: none
  bool simulated = false;
  std::string id;  // prefix of the identifiers inside the SVG: unique in a
                   // document, letters and digits
};

// Draws it as an SVG element to stand inside an HTML page, by gnuplot. The same
// input gives the same bytes. Throws like RunGnuplot().
std::string DrawBoundaryPlot(const BoundaryPlot& plot);

}  // namespace touchdown::report
