// Work against precision: what one method of one stage costs, and how far off
// it is. Shared by the stages of touchdown_precision_benchmark.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace touchdown::accuracy {

// One point of a work-precision diagram. Failures are counted apart, never
// averaged in.
struct WorkPoint {
  std::string stage;      // "chain" or "outline"
  std::string method;     // a curve
  std::string knob;       // its points
  std::string unit;       // of error and bound
  double per_item = 1.0;  // frames in one timed item, mean
  std::vector<double> errors;
  std::vector<double> seconds;  // processor time, one an item
  std::size_t failures = 0;
  double bound = 0.0;  // rms of the Cramer-Rao bound over all items
};

// Processor time of this process so far, s: what else the machine does leaves
// it alone.
double ProcessorSeconds();

// Processor time that `work` takes, s.
double Timed(const std::function<void()>& work);

void PrintHeading();
void PrintPoint(const WorkPoint& point);

// The whole chain, pixels to approach angle, over the first `clips` clips of
// the regular design.
void MeasureChain(std::uint64_t clips);

// One outline in one frame: a sphere in `clips` clips of standard levels.
void MeasureOutline(std::uint64_t clips);

}  // namespace touchdown::accuracy
