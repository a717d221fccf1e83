// Error against the Cramer-Rao bound, bias and coverage over the declared
// design (tests/accuracy/design.h). Prints CSV, a row a clip; the table of them
// goes to the error output.
// Usage: touchdown_accuracy_benchmark [REGULAR] [PER_HARDSHIP] [STATES]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/accuracy/score.h"
#ifdef TOUCHDOWN_HAS_PEERS
#include "tests/benchmarks/peers.h"
#include "tests/support/statistics.h"
#endif
#include "touchdown/core/units.h"

namespace {

using namespace touchdown;
using namespace touchdown::accuracy;

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
      const core::Interval band = s.CoverageBand();
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

#ifdef TOUCHDOWN_HAS_PEERS
// Errors of one method over the same clips; failures apart.
struct Method {
  std::string name;
  std::vector<double> angle_deg;
  std::vector<double> frame;
  std::vector<double> seconds;
  std::size_t failures = 0;
};

std::string RmsText(const std::vector<double>& errors) {
  if (errors.empty()) return "-";
  const core::Interval interval = RmsInterval95(errors);
  return fmt::format("{:.3g} ({:.3g} to {:.3g})", testing::Rms(errors),
                     interval.low, interval.high);
}

void PrintPeers(const std::vector<Outcome>& outcomes, std::size_t clips) {
  std::vector<Method> methods(1);
  methods[0].name = "touchdown";
  for (std::size_t i = 0; i < std::min(clips, outcomes.size()); ++i) {
    const Outcome& o = outcomes[i];
    methods[0].seconds.push_back(o.seconds);
    if (o.readings[kApproach] && o.readings[kFrame]) {
      methods[0].angle_deg.push_back(o.readings[kApproach]->error /
                                     core::kDegree);
      methods[0].frame.push_back(o.readings[kFrame]->error);
    } else {
      ++methods[0].failures;
    }
  }
  for (const Peer peer : Peers()) {
    Method method;
    method.name = Name(peer);
    for (std::size_t i = 0; i < std::min(clips, outcomes.size()); ++i) {
      const Case& c = outcomes[i].made;
      const auto start = std::chrono::steady_clock::now();
      const auto reading = Measure(c, peer);
      method.seconds.push_back(std::chrono::duration<double>(
                                   std::chrono::steady_clock::now() - start)
                                   .count());
      if (!reading) {
        ++method.failures;
        continue;
      }
      method.angle_deg.push_back(
          (reading->approach_rad - c.film.thrown.ContactAngle()) /
          core::kDegree);
      method.frame.push_back(reading->frame - c.film.contact_frame);
    }
    methods.push_back(method);
  }
  fmt::print(stderr,
             "\n| method, {} regular clips | approach angle RMSE, deg (95 %) | "
             "contact time RMSE, frames (95 %) | failures | ms a clip |\n"
             "|---|---:|---:|---:|---:|\n",
             clips);
  for (Method& m : methods) {
    std::nth_element(
        m.seconds.begin(),
        m.seconds.begin() + static_cast<std::ptrdiff_t>(m.seconds.size() / 2),
        m.seconds.end());
    fmt::print(stderr, "| {} | {} | {} | {} | {:.0f} |\n", m.name,
               RmsText(m.angle_deg), RmsText(m.frame), m.failures,
               1e3 * m.seconds[m.seconds.size() / 2]);
  }
}
#endif

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
  std::vector<Outcome> of_hard;
  std::vector<Outcome> of_unpictured;
  for (const Outcome& o : outcomes) {
    const bool is_regular = o.made.levels.hardship == Hardship::kNone;
    (is_regular ? of_regular : of_hard).push_back(o);
    if (!is_regular && o.made.levels.hardship != Hardship::kPictured) {
      of_unpictured.push_back(o);
    }
  }
  PrintTable(of_hard,
             [](const Levels&) { return std::string("all hardships"); });
  PrintTable(of_unpictured, [](const Levels&) {
    return std::string("all hardships but a pictured face");
  });
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
#ifdef TOUCHDOWN_HAS_PEERS
  constexpr std::size_t kForPeers = 200;
  if (!of_regular.empty()) {
    PrintPeers(of_regular, std::min(kForPeers, of_regular.size()));
  }
#endif
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
