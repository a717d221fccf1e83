// The group's plot, and what it shows in words and numbers.
#include <fmt/core.h>

#include "app/report/boundary_plot.h"
#include "app/report/content.h"
#include "app/report/sentences.h"
#include "app/text/format.h"
#include "touchdown/core/normal.h"
#include "touchdown/core/units.h"

namespace touchdown::report {

using core::kDegree;

namespace {

// With more trials than this the table behind the plot would repeat the table
// of trials at length.
constexpr std::size_t kShowNumbersUpTo = 200;

// The marks of the plot as a table: angle and 2 u in degrees, P(bounce).
// Without rows for a large group.
Table Numbers(const Group& group) {
  Table table{"",
              {{AngleName(group) + " (deg)", true},
               {"2 u (deg)", true},
               {"P(bounce)", true}},
              {}};
  if (group.trials.observations.size() > kShowNumbersUpTo) return table;
  for (const auto& o : group.trials.observations) {
    table.rows.push_back({{Plain(o.angle_rad / kDegree, 3)},
                          {Plain(2 * o.u_rad / kDegree, 3)},
                          {Plain(o.p_bounce, 4)}});
  }
  return table;
}

// P(bounce) at any angle, as the trials leave boundary and scatter: the mean
// over their joint posterior of Phi((x - boundary) / scatter).
PlotCurve MakeChance(const analysis::BoundaryPosterior& posterior) {
  const analysis::BoundaryGrid& grid = posterior.grid;
  PlotCurve curve{"P(bounce), as fitted", {}, {}};
  constexpr int kSteps = 180;  // of half a degree
  for (int i = 0; i <= kSteps; ++i) {
    const double x = i * 0.5 * kDegree;
    double sum = 0.0;
    std::size_t at = 0;
    // The weights lie row by row: all scatters of the first boundary, then of
    // the next.
    for (const double boundary : grid.angle_rad) {
      for (const double scatter : grid.scatter_rad) {
        sum += grid.weight[at++] * core::NormalCdf((x - boundary) / scatter);
      }
    }
    curve.angle_rad.push_back(x);
    // A share `lapse` of the trials goes wrong either way, whatever the angle.
    curve.height.push_back(posterior.lapse + (1 - 2 * posterior.lapse) * sum);
  }
  return curve;
}

// Why one end of the interval is an arrow; empty where neither is.
std::string OpenEndSentence(analysis::DataStatus status) {
  if (status == analysis::DataStatus::kOnlySlides) {
    return " Arrow: every body stayed down, so that the trials set no upper "
           "end "
           "to the interval; the number given for it is the prior's.";
  }
  if (status == analysis::DataStatus::kOnlyBounces) {
    return " Arrow: every body bounced, so that the trials set no lower end to "
           "the interval; the number given for it is the prior's.";
  }
  return "";
}

}  // namespace

Figure MakeFigure(const Group& group, std::size_t index) {
  const analysis::BoundaryStudy& study = group.study;
  BoundaryPlot plot;
  plot.angle_name = AngleName(group) + " at touchdown";
  plot.observations = group.trials.observations;
  plot.bracket = study.bracket;
  plot.simulated = group.simulated();
  plot.id = fmt::format("p{}", index);
  // Every theory of the group is a line, declared or not.
  for (const auto& theory : study.theories) {
    plot.lines.push_back(
        {fmt::format("{} {} deg", theory.theory.name,
                     Plain(theory.theory.boundary_rad / kDegree)),
         theory.theory.boundary_rad, theory.theory.u_rad});
  }
  // Without a decided trial the posterior is nothing but the prior, and is not
  // drawn.
  if (study.counts.decided() > 0) {
    plot.density = {"posterior", study.posterior.angle_rad,
                    study.posterior.density_per_rad};
    plot.p_bounce = MakeChance(study.posterior);
  }

  const analysis::BoundaryPosterior& posterior = study.posterior;
  if (study.counts.decided() > 0) {
    // Where all bounced the low end is open, where all stayed down the high
    // one.
    plot.interval =
        PlotInterval{posterior.interval95_rad, posterior.median_rad,
                     posterior.status == analysis::DataStatus::kOnlyBounces,
                     posterior.status == analysis::DataStatus::kOnlySlides};
  }

  Figure figure;
  figure.svg = DrawBoundaryPlot(plot);
  figure.caption = fmt::format(
      "{}{}, {}: what was seen at each {}. Bars are {} 2 u (95 %). Line: the "
      "probability of a bounce at each angle, as the trials leave it.{} "
      "Area on the axis: posterior density of the boundary angle, on a scale "
      "of its own; bar: its median and 95 % interval.",
      group.simulated() ? "Simulated. " : "", core::Name(group.trials.body),
      group.trials.campaign.empty() ? "no campaign" : group.trials.campaign,
      AngleName(group), kPlusMinus,
      study.bracket.closed() ? " Shaded: the bracket." : "");
  figure.caption += OpenEndSentence(posterior.status);
  // What the plot shows, for a reader who cannot see it: counts, bracket,
  // boundary, lines.
  figure.alt = fmt::format(
      "{}Plot of {} trials of a {} over the {} in degrees: {} slide, {} "
      "bounce, {} undecided; {}. Posterior of the boundary: {}.",
      group.simulated() ? "Simulated trials. " : "",
      group.trials.observations.size(), core::Name(group.trials.body),
      AngleName(group), study.counts.not_bounce, study.counts.bounce,
      study.counts.undecided, BracketSentence(study.bracket),
      BoundarySentence(study));
  for (const auto& theory : study.theories) {
    figure.alt +=
        fmt::format(" Line: {} boundary at {} deg.", theory.theory.name,
                    Plain(theory.theory.boundary_rad / kDegree));
  }
  figure.data = Numbers(group);
  return figure;
}

}  // namespace touchdown::report
