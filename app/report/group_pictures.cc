// A group's trajectories in one plot, and the pictures of each contact.
#include <fmt/core.h>

#include <algorithm>

#include "app/report/content.h"
#include "app/report/set_points.h"
#include "app/report/tally.h"
#include "app/report/trajectory_plot.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

// Beyond so many lines a plot shows no single one.
constexpr std::size_t kMostLines = 200;
// Shown of a path on either side of touchdown, in sizes of the body.
constexpr double kBodiesShown = 4.0;

// All paths of the group that are known, as one figure; nothing where none is.
// `figures` counts the figures of the page.
std::optional<Figure> MakeTrajectories(const Group& group,
                                       std::span<const core::Trial> trials,
                                       const ReportInput& input,
                                       std::size_t& figures) {
  TrajectoryPlot plot;
  double size_m = 0.0;
  for (const std::size_t t : group.members) {
    const auto found = input.trajectories.find(trials[t].id);
    if (found == input.trajectories.end()) continue;
    plot.lines.push_back({&found->second, trials[t].first.state.label});
    // The largest body decides how much of the paths is shown.
    const core::Measured size = core::Size(trials[t].body);
    if (size) size_m = std::max(size_m, size->value);
  }
  if (plot.lines.empty()) return std::nullopt;
  // Too many paths are thinned evenly: the group is sorted by angle, so that
  // the whole range of angles stays.
  const std::size_t known = plot.lines.size();
  if (known > kMostLines) {
    std::vector<TrajectoryLine> some;
    for (std::size_t i = 0; i < kMostLines; ++i) {
      some.push_back(plot.lines[i * known / kMostLines]);
    }
    plot.lines = std::move(some);
  }
  if (size_m > 0.0) plot.reach_m = kBodiesShown * size_m;
  plot.simulated = group.simulated();
  plot.id = fmt::format("t{}", ++figures);
  Figure figure;
  figure.svg = DrawTrajectoryPlot(plot);
  const std::string of = plot.lines.size() == group.members.size()
                             ? fmt::format("all {} trials", known)
                             : fmt::format("{} of {} trials", plot.lines.size(),
                                           group.members.size());
  figure.caption = fmt::format(
      "Paths of {}, laid over each other at touchdown: height of the lowest "
      "point above the ground (gap) over the way along it, in the direction of "
      "travel.{}",
      of,
      known == group.members.size()
          ? ""
          : " The others were followed over no ground, have no scale, or lay "
            "on it from the start.");
  figure.alt = fmt::format(
      "Plot of the gap over the way along the ground for {}, aligned at "
      "touchdown.",
      of);
  return figure;
}

}  // namespace

std::string StripCaption(const core::Trial& trial) {
  const core::Measured angle = core::ContactAngle(trial);
  return fmt::format(
      "{}{}: {} angle {}, {}",
      trial.origin == core::Origin::kSimulated ? "SIMULATED, " : "",
      TrialName(trial), core::Name(trial.angle_kind),
      angle ? WithU(*angle, core::kDegree) + " deg" : "absent",
      core::Name(trial.first.state.label));
}

std::vector<Block> MakePictures(const Group& group,
                                std::span<const core::Trial> trials,
                                const ReportInput& input,
                                std::size_t& figures) {
  std::vector<Block> out;
  if (auto figure = MakeTrajectories(group, trials, input, figures)) {
    out.push_back(Heading{3, "Trajectories"});
    out.push_back(std::move(*figure));
  }
  // Reasons for which trials have no strip, with how many have each.
  Tally without;
  std::vector<Block> strips;
  for (const std::size_t t : group.members) {
    const auto found = input.strips.find(trials[t].id);
    if (found != input.strips.end()) {
      strips.push_back(DrawStrip(found->second, StripCaption(trials[t])));
      continue;
    }
    const auto why = input.no_strip.find(trials[t].id);
    if (why != input.no_strip.end()) without.Add(why->second);
  }
  // A group without recordings has no heading either.
  const std::string reasons = without.Text();
  if (strips.empty() && reasons.empty()) return out;
  out.push_back(Heading{3, "The contacts"});
  if (!strips.empty()) out.push_back(Paragraph{kStripLegend, true});
  for (Block& strip : strips) out.push_back(std::move(strip));
  if (!reasons.empty()) {
    out.push_back(Paragraph{"Without pictures: " + reasons + ".", true});
  }
  return out;
}

}  // namespace touchdown::report
