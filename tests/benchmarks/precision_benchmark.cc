// Prints CSV, a row a point of the work-precision diagrams.
// Usage: touchdown_precision_benchmark chain|outline CLIPS
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tests/accuracy/score.h"
#include "tests/benchmarks/precision.h"
#include "tests/support/statistics.h"

namespace touchdown::accuracy {
namespace {

// The value that a share of the values lies below; nearest rank.
double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(
      std::lround(share * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(),
                   values.begin() + static_cast<std::ptrdiff_t>(rank),
                   values.end());
  return values[rank];
}

// A cell of the CSV; names of methods have commas.
std::string Cell(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  return text;
}

}  // namespace

double ProcessorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) +
         1e-9 * static_cast<double>(now.tv_nsec);
}

double Timed(const std::function<void()>& work) {
  const double start = ProcessorSeconds();
  work();
  return ProcessorSeconds() - start;
}

void PrintHeading() {
  fmt::print(
      "stage,method,knob,n,failures,ms_median,ms_p10,ms_p90,frames_per_s,"
      "unit,rmse,rmse_low95,rmse_high95,median_error,bound,efficiency\n");
}

void PrintPoint(const WorkPoint& p) {
  const double median_s = Quantile(p.seconds, 0.5);
  fmt::print("{},{},{},{},{},{:.5g},{:.5g},{:.5g},{:.5g},{},", p.stage,
             Cell(p.method), Cell(p.knob), p.seconds.size(), p.failures,
             1e3 * median_s, 1e3 * Quantile(p.seconds, 0.1),
             1e3 * Quantile(p.seconds, 0.9), p.per_item / median_s, p.unit);
  if (p.errors.empty()) {
    fmt::print(",,,,{:.5g},\n", p.bound);
    return;
  }
  const double rmse = testing::Rms(p.errors);
  const core::Interval interval = RmsInterval95(p.errors);
  std::vector<double> sizes = p.errors;
  for (double& e : sizes) e = std::abs(e);
  fmt::print("{:.5g},{:.5g},{:.5g},{:.5g},{:.5g},{:.4g}\n", rmse, interval.low,
             interval.high, Quantile(sizes, 0.5), p.bound,
             p.bound * p.bound / (rmse * rmse));
}

}  // namespace touchdown::accuracy

int main(int argc, char** argv) {
  const std::string_view stage = argc == 3 ? argv[1] : "";
  if (stage != "chain" && stage != "outline") {
    fmt::print(stderr,
               "usage: touchdown_precision_benchmark chain|outline CLIPS\n");
    return 2;
  }
  const std::uint64_t clips = std::strtoull(argv[2], nullptr, 10);
  touchdown::accuracy::PrintHeading();
  if (stage == "chain") {
    touchdown::accuracy::MeasureChain(clips);
  } else {
    touchdown::accuracy::MeasureOutline(clips);
  }
  return 0;
}
