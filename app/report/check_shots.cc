#include "app/report/check_shots.h"

#include <fmt/core.h>

#include <algorithm>
#include <tuple>

#include "app/report/content.h"
#include "app/report/control_plot.h"
#include "app/report/set_points.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;

// One quantity of the shots in their order of time, in multiples of `unit`,
// with its control chart. Excluded shots and those without the quantity are
// left out; the chart is absent where fewer than two values remain.
CheckSeries MakeSeries(std::string quantity, double unit,
                       const core::Measured& (*measured)(const core::Trial&),
                       const std::vector<std::size_t>& shots,
                       std::span<const core::Trial> trials) {
  CheckSeries out;
  out.quantity = std::move(quantity);
  std::vector<double> values;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const core::Trial& trial = trials[shots[i]];
    const core::Measured& m = measured(trial);
    if (trial.excluded || !m) continue;
    out.values.push_back(core::Scaled(*m, 1.0 / unit));
    // Keeps the place in the table of all shots, by which a person finds a
    // value that is beyond the limits.
    out.shots.push_back(i);
    values.push_back(out.values.back().value);
  }
  out.chart = analysis::ChartIndividuals(values);
  return out;
}

// The control chart as a figure. `index` makes the identifiers inside the SVG
// unique in the page. The series must have a chart.
Figure MakeChart(const CheckShots& checks, const CheckSeries& series,
                 std::size_t index) {
  ControlPlot plot;
  plot.quantity = series.quantity;
  for (const core::Estimate& e : series.values) {
    plot.values.push_back(e.value);
    plot.twice_u.push_back(2 * e.u);
  }
  plot.chart = *series.chart;
  plot.simulated = checks.origin == core::Origin::kSimulated;
  plot.id = fmt::format("c{}", index);
  Figure figure;
  figure.svg = DrawControlPlot(plot);
  figure.alt = fmt::format("Control chart of the {}: {}", series.quantity,
                           CheckSentence(series));
  figure.caption = fmt::format(
      "{}: individuals control chart. Limits: mean {} 3 sigma, sigma = mean "
      "moving range / 1.128 (NIST/SEMATECH e-Handbook, 6.3.2.2). Bars are {} 2 "
      "u.",
      series.quantity, kPlusMinus, kPlusMinus);
  return figure;
}

// Every shot with its number in the chart, also those that are excluded.
Table MakeShotTable(const CheckShots& checks,
                    std::span<const core::Trial> trials,
                    const ReportInput& input) {
  Table table{"Every check shot, in the order of time",
              {{"no.", true},
               {"recorded (UTC)"},
               {fmt::format("speed {} u (m/s)", kPlusMinus), true},
               {fmt::format("approach angle {} u (deg)", kPlusMinus), true},
               {"remark"},
               {"clip or trial"}},
              {}};
  for (std::size_t i = 0; i < checks.shots.size(); ++i) {
    const core::Trial& trial = trials[checks.shots[i]];
    table.rows.push_back(
        {{fmt::format("{}", i + 1)},
         {trial.recorded_at_utc},
         {WithUOrReason(trial.first.motion.before_speed_mps, 1.0)},
         {WithUOrReason(trial.first.contact.approach_angle_rad, kDegree)},
         {trial.excluded ? "excluded: " + trial.exclusion_reason
                         : trial.reason},
         TrialCell(trial, input)});
  }
  return table;
}

}  // namespace

std::vector<CheckShots> CollectCheckShots(const ReportInput& input,
                                          std::span<const core::Trial> trials) {
  std::vector<CheckShots> out;
  for (const core::Campaign& campaign : input.campaigns) {
    // A campaign is one of check shots by its surface. Its shots are split by
    // origin, as nothing is pooled over origins.
    if (!core::HasCheckShots(campaign)) continue;
    for (const core::Origin origin :
         {core::Origin::kRecorded, core::Origin::kManual,
          core::Origin::kSimulated}) {
      CheckShots checks;
      checks.campaign = campaign;
      checks.origin = origin;
      for (std::size_t t = 0; t < trials.size(); ++t) {
        if (trials[t].campaign == campaign.name && trials[t].origin == origin) {
          checks.shots.push_back(t);
        }
      }
      if (checks.shots.empty()) continue;
      // A control chart is about the order in time; the id settles equal times,
      // so that the same store gives the same report.
      std::sort(checks.shots.begin(), checks.shots.end(),
                [&](std::size_t a, std::size_t b) {
                  return std::tie(trials[a].recorded_at_utc, trials[a].id) <
                         std::tie(trials[b].recorded_at_utc, trials[b].id);
                });
      checks.speed = MakeSeries(
          "speed at touchdown (m/s)", 1.0,
          [](const core::Trial& t) -> const core::Measured& {
            return t.first.motion.before_speed_mps;
          },
          checks.shots, trials);
      checks.angle = MakeSeries(
          "approach angle (deg)", kDegree,
          [](const core::Trial& t) -> const core::Measured& {
            return t.first.contact.approach_angle_rad;
          },
          checks.shots, trials);
      out.push_back(std::move(checks));
    }
  }
  return out;
}

std::string CheckSentence(const CheckSeries& series) {
  const std::size_t n = series.values.size();
  if (!series.chart) {
    return fmt::format("{} value{}: {}.", n, n == 1 ? "" : "s",
                       series.chart.error().reason);
  }
  const analysis::IndividualsChart& chart = *series.chart;
  std::string text = fmt::format(
      "{} values, mean {:.5g}, limits {:.5g} to "
      "{:.5g}; ",
      n, chart.centre, chart.lower, chart.upper);
  if (chart.beyond.empty()) {
    text += "all are within the limits.";
  } else {
    std::string numbers;
    // Numbers as in the table, from 1: `shots` leads from the values to the
    // shots.
    for (const std::size_t i : chart.beyond) {
      numbers +=
          fmt::format("{}{}", numbers.empty() ? "" : ", ", series.shots[i] + 1);
    }
    text += fmt::format(
        "beyond them: no. {}. Look at what changed before that shot: camera, "
        "lens, scale, frame rate, height of the drop.",
        numbers);
  }
  if (chart.provisional) {
    text += fmt::format(" The limits are provisional below {} values.",
                        analysis::kEnoughForLimits);
  }
  return text;
}

Section MakeCheckSection(const CheckShots& checks,
                         std::span<const core::Trial> trials,
                         const ReportInput& input, std::size_t& figures) {
  Section section{checks.origin == core::Origin::kSimulated, {}};
  auto& out = section.blocks;
  out.push_back(PageBreak{});
  out.push_back(Heading{2, fmt::format("{}, {}", checks.campaign.name,
                                       core::Name(checks.origin))});
  out.push_back(Paragraph{
      "Check shots show whether camera and software are as they were. They "
      "have no boundary, no verdict and no place in Table 1."});
  for (const CheckSeries* series : {&checks.speed, &checks.angle}) {
    out.push_back(Paragraph{
        fmt::format("The {}: {}", series->quantity, CheckSentence(*series))});
    if (series->chart) out.push_back(MakeChart(checks, *series, ++figures));
  }
  out.push_back(MakeShotTable(checks, trials, input));
  return section;
}

}  // namespace touchdown::report
