// Error against the Cramer-Rao bound, bias and coverage over the declared
// design (tests/accuracy/design.h). Prints CSV, a row a clip; the table of them
// goes to the error output.
// Usage: touchdown_accuracy_benchmark [REGULAR] [PER_HARDSHIP] [STATES]
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/accuracy/score.h"
#include "touchdown/core/units.h"

namespace {

using namespace touchdown;
using namespace touchdown::accuracy;

std::vector<Outcome> AnalyseAll(const std::vector<Case>& cases) {
  std::vector<Outcome> outcomes(cases.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < cases.size(); i = next++) {
      outcomes[i] = Analyse(cases[i]);
    }
  };
  std::vector<std::jthread> threads;
  const unsigned count = std::max(1U, std::thread::hardware_concurrency());
  for (unsigned i = 0; i < count; ++i) threads.emplace_back(work);
  threads.clear();
  return outcomes;
}

void PrintCsv(const std::vector<Outcome>& outcomes) {
  fmt::print(
      "case,part,body,size_px,contrast,noise,blur_px,speed_px,angle_deg,open,"
      "frames_before,frames_after,bit_depth,quantity,error,u,bound,covered,"
      "seconds,reason\n");
  for (const Outcome& o : outcomes) {
    const Levels& l = o.made.levels;
    for (int q = 0; q < kQuantities; ++q) {
      if (!o.readings[q] && o.reasons[q].empty()) continue;
      const Reading r = o.readings[q].value_or(Reading{});
      fmt::print("{},{},{},{},{},{},{},{},{},{},{},{},{},{},", o.made.seed,
                 Name(l.hardship), core::Name(l.kind), l.size_px, l.contrast,
                 l.noise, l.blur_px, l.speed_px, l.angle_deg, l.open,
                 l.frames_before, l.frames_after, l.bit_depth,
                 kQuantityNames[q]);
      if (o.readings[q]) {
        fmt::print("{:.6g},{:.6g},{:.6g},{},{:.4f},\n", r.error, r.u, r.bound,
                   r.covered ? 1 : 0, o.seconds);
      } else {
        fmt::print(",,,,{:.4f},\"{}\"\n", o.seconds, o.reasons[q]);
      }
    }
  }
}

using LevelOf = std::function<std::string(const Levels&)>;

void PrintTable(const std::vector<Outcome>& outcomes, const LevelOf& level_of) {
  std::map<std::string, std::array<Sum, kQuantities>> sums;
  for (const Outcome& o : outcomes) {
    const std::string level = level_of(o.made.levels);
    for (int q = 0; q < kQuantities; ++q) {
      Add(sums[level][static_cast<std::size_t>(q)], o,
          static_cast<Quantity>(q));
    }
  }
  for (const auto& [level, of_level] : sums) {
    for (int q = 0; q < kQuantities; ++q) {
      const Sum& s = of_level[static_cast<std::size_t>(q)];
      if (s.measured < 2) continue;
      const bool is_time = q == kFrame;
      const Share band = Wilson99(s.covered, s.measured);
      fmt::print(stderr,
                 "| {} | {} | {} | {} | {:.4g} {} | {:.2f} | {:+.2f} +- {:.2f} "
                 "| {:.3f} ({:.3f} to {:.3f}) |\n",
                 level, kQuantityNames[q], s.measured, s.expected - s.measured,
                 is_time ? s.Rmse() : s.Rmse() / core::kDegree,
                 is_time ? "frame" : "deg", s.RmseOverBound(), s.MeanZ(),
                 s.MeanZBand(), s.Coverage(), band.low, band.high);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int i, unsigned long otherwise) {
    return argc > i ? std::strtoul(argv[i], nullptr, 10) : otherwise;
  };
  const unsigned long regular = number(1, 1000);
  const unsigned long hard = number(2, 60);
  const unsigned long rebounds = number(3, 400);
  std::vector<Case> cases;
  for (unsigned long i = 0; i < regular; ++i) {
    cases.push_back(Draw(i, Hardship::kNone));
  }
  for (const Hardship hardship : kHardships) {
    for (unsigned long i = 0; i < hard; ++i) {
      cases.push_back(Draw(i, hardship));
    }
  }
  const std::vector<Outcome> outcomes = AnalyseAll(cases);
  PrintCsv(outcomes);
  fmt::print(stderr,
             "| part | quantity | clips | not measured | RMSE | RMSE / bound | "
             "mean error/u, 99 % band | coverage of 95 %, 99 % band |\n"
             "|---|---|---:|---:|---:|---:|---:|---:|\n");
  PrintTable(outcomes,
             [](const Levels& l) { return std::string(Name(l.hardship)); });
  std::vector<Outcome> of_regular;
  for (const Outcome& o : outcomes) {
    if (o.made.levels.hardship == Hardship::kNone) of_regular.push_back(o);
  }
  const std::pair<const char*, std::function<double(const Levels&)>> factors[] =
      {{"size, px", [](const Levels& l) { return l.size_px; }},
       {"contrast", [](const Levels& l) { return l.contrast; }},
       {"noise", [](const Levels& l) { return l.noise; }},
       {"blur, px", [](const Levels& l) { return l.blur_px; }},
       {"speed, px/frame", [](const Levels& l) { return l.speed_px; }},
       {"angle, deg", [](const Levels& l) { return l.angle_deg; }},
       {"exposure share", [](const Levels& l) { return l.open; }},
       {"frames before",
        [](const Levels& l) { return static_cast<double>(l.frames_before); }},
       {"bits",
        [](const Levels& l) { return static_cast<double>(l.bit_depth); }}};
  for (const auto& [name, value] : factors) {
    PrintTable(of_regular, [&](const Levels& l) {
      return fmt::format("regular, {} {}", name, value(l));
    });
  }
  PrintTable(of_regular, [](const Levels& l) {
    return fmt::format("regular, {}", core::Name(l.kind));
  });
  cases.clear();
  for (unsigned long i = 0; i < rebounds; ++i) cases.push_back(DrawRebound(i));
  States states;
  for (const Outcome& o : AnalyseAll(cases)) Add(states, o);
  fmt::print(
      stderr,
      "\n| states: clips | off the bounce height by > 2 u | false bounces "
      "| missed bounces | off by > 4 u | undecided there |\n"
      "|---:|---:|---:|---:|---:|---:|\n| {} | {} | {} | {} | {} | {} "
      "|\n",
      states.cases, states.clear, states.false_bounces, states.missed_bounces,
      states.far, states.undecided);
  return 0;
}
