// The hard-case ladder: error against the Cramer-Rao bound, coverage and the
// share of absent results, one trouble at a time made worse step by step while
// all else stays at standard levels. Prints CSV, a row a rung and quantity.
// Usage: touchdown_ladder_benchmark CLIPS    of each rung
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "tests/accuracy/score.h"
#include "tests/support/statistics.h"
#include "touchdown/analysis/statistics/agreement_statistics.h"
#include "touchdown/core/units.h"

namespace {

using namespace touchdown;
using namespace touchdown::accuracy;

// What a careful set-up gives: the middle of the regular design.
Levels Standard() {
  Levels levels;
  levels.size_px = 24.0;
  levels.contrast = -0.5;
  levels.noise = 0.008;
  levels.blur_px = 0.8;
  levels.speed_px = 2.0;
  levels.angle_deg = 20.0;
  levels.open = 0.1;
  levels.frames_before = 20;
  levels.frames_after = 12;
  return levels;
}

// One trouble; the rungs go from easy to hard.
struct Ladder {
  std::string name;  // without a comma: it goes into CSV
  std::vector<double> rungs;
  std::function<void(Levels&, double)> set;
};

std::vector<Ladder> Ladders() {
  return {
      {"size (px)",
       {400.0, 240.0, 160.0, 80.0, 40.0, 24.0, 16.0, 12.0, 8.0, 6.0},
       [](Levels& l, double v) { l.size_px = v; }},
      {"contrast over noise",
       {30.0, 20.0, 12.0, 8.0, 6.0, 4.0, 3.0, 2.0},
       [](Levels& l, double v) { l.noise = std::abs(l.contrast = -0.2) / v; }},
      {"blur of the lens (px)",
       {0.5, 0.8, 1.4, 2.0, 3.0, 4.0, 6.0},
       [](Levels& l, double v) { l.blur_px = v; }},
      {"frames on either side",
       {25.0, 12.0, 8.0, 5.0, 4.0, 3.0, 2.0},
       [](Levels& l, double v) {
         l.frames_before = l.frames_after = static_cast<int>(v);
       }},
      {"approach angle (deg)",
       {60.0, 40.0, 20.0, 10.0, 5.0, 3.0, 2.0, 1.0},
       [](Levels& l, double v) { l.angle_deg = v; }},
      {"hidden share of the approach",
       {0.0, 0.25, 0.5, 0.65, 0.8, 0.9},
       [](Levels& l, double v) {
         l.hardship = Hardship::kObstacle;
         l.hidden = v;
       }},
  };
}

// A smaller block comes down on its other corner at once.
constexpr double kLeastBlock_px = 12.0;

// Every other clip has a block.
std::vector<Case> CasesOf(const Ladder& ladder, double rung,
                          unsigned long clips) {
  std::vector<Case> cases;
  for (unsigned long i = 0; i < clips; ++i) {
    Levels levels = Standard();
    ladder.set(levels, rung);
    if (i % 2 == 1 && levels.size_px >= kLeastBlock_px) {
      levels.kind = core::BodyKind::kRectangle;
    }
    cases.push_back(DrawAt(i, levels));
  }
  return cases;
}

// Errors over their bounds, whose root mean square is `bound`.
void PrintRatios(const std::vector<double>& ratios, double bound) {
  const core::Interval interval = RmsInterval95(ratios);
  std::vector<double> sizes = ratios;
  for (double& v : sizes) v = std::abs(v);
  const auto middle =
      sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  fmt::print("{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},", bound, testing::Rms(ratios),
             interval.low, interval.high, *middle);
}

void PrintRung(const std::string& ladder, double rung,
               const std::vector<Outcome>& outcomes, Quantity quantity) {
  Sum sum;
  std::vector<double> ratios;
  double bound2 = 0.0;
  for (const Outcome& o : outcomes) {
    Add(sum, o, quantity);
    if (const auto& r = o.readings[quantity]) {
      ratios.push_back(r->error / r->bound);
      bound2 += r->bound * r->bound;
    }
  }
  if (sum.expected == 0) return;
  const std::size_t absent = sum.expected - sum.measured;
  const core::Interval absence = analysis::WilsonInterval(
      static_cast<int>(absent), static_cast<int>(sum.expected), 0.95);
  fmt::print("{},{},{},{},{},{:.4g},{:.4g},{:.4g},", ladder, rung,
             kQuantityNames[quantity], sum.expected, absent,
             static_cast<double>(absent) / static_cast<double>(sum.expected),
             absence.low, absence.high);
  const bool is_time = quantity == kFrame;
  if (ratios.empty()) {
    fmt::print("{},,,,,,,,,\n", is_time ? "frame" : "deg");
    return;
  }
  const double unit = is_time ? 1.0 : core::kDegree;
  const core::Interval band = sum.CoverageBand();
  fmt::print("{},{:.4g},", is_time ? "frame" : "deg", sum.Rmse() / unit);
  if (!std::isfinite(bound2)) {  // of some clip there is no bound
    fmt::print(",,,,,");
  } else {
    PrintRatios(ratios,
                std::sqrt(bound2 / static_cast<double>(sum.measured)) / unit);
  }
  fmt::print("{:.4g},{:.4g},{:.4g}\n", sum.Coverage(), band.low, band.high);
}

}  // namespace

int main(int argc, char** argv) {
  const unsigned long clips =
      argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 40;
  fmt::print(
      "ladder,rung,quantity,n,absent,absent_share,absent_low95,absent_high95,"
      "unit,rmse,bound,rmse_over_bound,ratio_low95,ratio_high95,"
      "median_error_over_bound,coverage,coverage_low99,coverage_high99\n");
  for (const Ladder& ladder : Ladders()) {
    fmt::print(stderr, "bench: ladder, {}\n", ladder.name);
    for (const double rung : ladder.rungs) {
      const std::vector<Outcome> outcomes =
          AnalyseAll(CasesOf(ladder, rung, clips));
      for (const Quantity quantity : {kApproach, kFrame, kFace}) {
        PrintRung(ladder.name, rung, outcomes, quantity);
      }
      std::fflush(stdout);
    }
  }
  return 0;
}
