// What a group's boundary might depend on besides the angle: the order of the
// trials, speed, spin, surface, operator. One table of score tests.
#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "app/report/content.h"
#include "app/text/format.h"
#include "app/text/parse_number.h"
#include "touchdown/analysis/statistics/score_tests.h"
#include "touchdown/analysis/statistics/set_angles.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using Covariate = std::vector<std::optional<double>>;

// A test below this p is called telling. Five are made for each group: one of
// them falls below by chance in one report of twenty.
constexpr double kTelling = 0.01;

// The number in "line 12", the name of a trial from a CSV file.
std::optional<int> ParseLineNumber(std::string_view id) {
  constexpr std::string_view kLine = "line ";
  if (!id.starts_with(kLine)) return std::nullopt;
  return ParseNumber<int>(id.substr(kLine.size()));
}

// The place of each observation in time: 0 for the first trial to 1 for the
// last, in the order in which a store took them or a file lists them. All are
// absent where neither is known, or where all have one time.
Covariate Order(const Group& group, std::span<const core::Trial> trials) {
  const auto& observations = group.trials.observations;
  // Time, line of the file, and index of the observation: sorts by the first
  // that is known.
  std::vector<std::tuple<std::string, int, std::size_t>> order;
  // A mixture of dated and undated trials has no order in time.
  bool dated = true;
  bool listed = true;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const core::Trial& trial = trials[observations[i].trial];
    const auto line = ParseLineNumber(trial.id);
    dated = dated && !trial.recorded_at_utc.empty();
    listed = listed && line.has_value();
    order.emplace_back(trial.recorded_at_utc, line.value_or(0), i);
  }
  Covariate out(observations.size());
  if (order.size() < 2 || !(dated || listed)) return out;
  std::sort(order.begin(), order.end());
  // Trials that a store took in at one time have no order.
  if (dated && std::get<0>(order.front()) == std::get<0>(order.back())) {
    return out;
  }
  for (std::size_t k = 0; k < order.size(); ++k) {
    out[std::get<2>(order[k])] =
        static_cast<double>(k) / static_cast<double>(order.size() - 1);
  }
  return out;
}

// `value` of the trial of each observation, in the order of the observations,
// as the score tests take them.
template <class Value>
auto OfEach(const Group& group, std::span<const core::Trial> trials,
            Value value) {
  std::vector<decltype(value(trials.front()))> out;
  for (const auto& o : group.trials.observations) {
    out.push_back(value(trials[o.trial]));
  }
  return out;
}

// The value without its u: the tests take a covariate as exact.
std::optional<double> ValueIfMeasured(const core::Measured& measured) {
  if (!measured) return std::nullopt;
  return measured->value;
}

// The table of the tests, and those in it that stand out, as one text: "order
// of the trials (+3.1 ± 0.9 deg from the first to the last)". Empty: none does.
struct Dependence {
  Table table;
  std::string telling;
};

// All five tests for one group. A covariate that does not vary, or that fewer
// than ten trials bear, has no row.
Dependence Test(const Group& group, std::span<const core::Trial> trials) {
  Table table{"What the boundary might depend on besides the angle",
              {{"what"},
               {"trials", true},
               {"Z", true},
               {"p, two-sided", true},
               {"how the boundary moves"}},
              {}};
  const auto& posterior = group.study.posterior;
  // The same angles as the boundary was fitted with.
  const auto observations =
      analysis::UseSetAngles(group.trials.observations).observations;
  std::string telling;
  // Adds a test to the table, and to `telling` where it is clear. `moves` says
  // how the boundary moves.
  const auto row = [&](const std::string& what, const analysis::ScoreTest& test,
                       const std::string& moves) {
    const bool clear = test.p < kTelling;
    if (clear) {
      telling +=
          fmt::format("{}{} ({})", telling.empty() ? "" : ", ", what, moves);
    }
    table.rows.push_back(
        {{what},
         {fmt::format("{}", test.trials)},
         {Signed(test.z, 2)},
         {Probability(test.p), clear ? Tone::kBad : Tone::kPlain},
         {moves}});
  };
  // A covariate that is a number: the slope of the boundary, in degrees `per`
  // unit of it.
  const auto number = [&](const std::string& what, const char* per,
                          const Covariate& covariate) {
    const auto test =
        analysis::TestCovariate(observations, covariate, posterior);
    if (!test) return;
    row(what, *test,
        fmt::format(
            "{} deg {}",
            DifferenceWithU({test->slope_rad, test->u_slope_rad, {}}, kDegree),
            per));
  };
  // A covariate that is a name: the one that stands out most, against all
  // others.
  const auto name = [&](const std::string& what,
                        const std::vector<std::string>& names) {
    const auto test = analysis::TestNames(observations, names, posterior);
    if (!test) return;
    row(what, test->test,
        fmt::format(
            "{} deg for {} against the others",
            DifferenceWithU({test->test.slope_rad, test->test.u_slope_rad, {}},
                            kDegree),
            test->name));
  };
  number("order of the trials", "from the first to the last",
         Order(group, trials));
  number("speed at touchdown", "for 1 m/s more",
         OfEach(group, trials, [](const core::Trial& t) {
           return ValueIfMeasured(t.first.motion.before_speed_mps);
         }));
  number("spin at touchdown", "for 1 rad/s more",
         OfEach(group, trials, [](const core::Trial& t) {
           return ValueIfMeasured(t.first.motion.before_omega_rad_per_s);
         }));
  name("surface", OfEach(group, trials, [](const core::Trial& t) {
         return t.conditions ? t.conditions->surface.name : std::string();
       }));
  name("operator", OfEach(group, trials, [](const core::Trial& t) {
         return t.conditions ? t.conditions->person.name : std::string();
       }));
  return {std::move(table), std::move(telling)};
}

// For the page: what was found and what to do about it.
std::string Sentence(const std::string& telling) {
  return fmt::format(
      "The boundary depends on more than the angle, or drifted: {}. One "
      "boundary for all these trials is then an average over what was thrown: "
      "find the cause before more are thrown.",
      telling);
}

}  // namespace

std::string TellingDependence(const Group& group,
                              std::span<const core::Trial> trials) {
  return Test(group, trials).telling;
}

std::vector<Block> MakeDependence(const Group& group,
                                  std::span<const core::Trial> trials) {
  Dependence found = Test(group, trials);
  std::vector<Block> out;
  if (found.table.rows.empty()) return out;
  out.push_back(std::move(found.table));
  out.push_back(Paragraph{
      found.telling.empty()
          ? "Score tests: none of these moves the boundary beyond chance (p "
            "below 0.01)."
          : Sentence(found.telling),
      found.telling.empty()});
  return out;
}

std::optional<Callout> MakeDependenceCallout(
    const Group& group, std::span<const Group> groups,
    std::span<const core::Trial> trials) {
  const Dependence found = Test(group, trials);
  if (found.telling.empty()) return std::nullopt;
  return Callout{ShortName(group, groups) + ": not one boundary.",
                 Sentence(found.telling), Tone::kBad};
}

}  // namespace touchdown::report
