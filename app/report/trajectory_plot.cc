#include "app/report/trajectory_plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "app/report/gnuplot.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kMillimetre;

// What a state is drawn with; dashes differ, so that colour is not needed.
struct LineStyle {
  const char* name;
  const char* colour;
  const char* dash;
  bool (*is)(core::MotionState state);
};
constexpr LineStyle kLineStyles[] = {
    {"stayed down", "#17548f", "solid",
     [](core::MotionState s) {
       return s != core::MotionState::kBounce &&
              s != core::MotionState::kUndecided;
     }},
    {"bounce", "#b3430f", "(8,4)",
     [](core::MotionState s) { return s == core::MotionState::kBounce; }},
    {"undecided", "#40505c", "(2,4)",
     [](core::MotionState s) { return s == core::MotionState::kUndecided; }}};

// More samples than this of one line no eye tells apart.
constexpr std::size_t kMostPoints = 160;

// The data block `name` of all paths in one style: way along the ground and gap
// in mm, both from touchdown, with an empty line between two paths. `top` grows
// to the greatest gap in metres. Empty where no path has the style.
std::string PathsBlock(const TrajectoryPlot& plot, const LineStyle& style,
                       const std::string& name, double& top) {
  std::string block = fmt::format("${} << EOD\n", name);
  bool any = false;
  for (const TrajectoryLine& line : plot.lines) {
    if (!style.is(line.state)) continue;
    const Trajectory& path = *line.path;
    // Long recordings are thinned; the last sample of a path may be left out.
    const std::size_t step =
        std::max<std::size_t>(1, path.centre.size() / kMostPoints);
    for (std::size_t i = 0; i < path.centre.size(); i += step) {
      if (std::abs(path.centre[i].x_m) > plot.reach_m) continue;
      top = std::max(top, path.gap_m[i]);
      block += fmt::format("{:.3f} {:.3f}\n", path.centre[i].x_m / kMillimetre,
                           path.gap_m[i] / kMillimetre);
      any = true;
    }
    block += "\n";  // the next line begins anew
  }
  return any ? block + "EOD\n" : "";
}

}  // namespace

std::string DrawTrajectoryPlot(const TrajectoryPlot& plot) {
  // Not beyond what was seen.
  double seen = 0.0;
  for (const TrajectoryLine& line : plot.lines) {
    for (const core::PlanePoint& p : line.path->centre) {
      seen = std::max(seen, std::abs(p.x_m));
    }
  }
  // A little room beside the paths, and never an axis without length.
  const double reach_m = std::min(plot.reach_m, 1.05 * seen + 1e-3);
  std::string data;
  std::vector<std::string> parts;
  double top = 0.0;
  // One element for each state, so that the key names a state once.
  for (const LineStyle& style : kLineStyles) {
    const std::string name = fmt::format("lines{}", parts.size());
    const std::string block = PathsBlock(plot, style, name, top);
    if (block.empty()) continue;
    data += block;
    parts.push_back(fmt::format(
        "${} using 1:2 with lines lw 1.4 dt {} lc rgb '{}' title '{}'", name,
        style.dash, style.colour, style.name));
  }
  if (parts.empty()) parts.emplace_back("NaN notitle");
  // The ground and the instant of touchdown are thin lines through 0.
  std::string s = fmt::format(
      "set terminal svg size 940,300 dynamic noenhanced font 'Arial,14' name "
      "'{}'\n"
      "set lmargin 12\nset rmargin 3\nset tmargin 2.2\nset bmargin 3.4\n"
      "set border 3 lc rgb '#1c2126'\nset tics nomirror\n"
      "set xrange [{:.3f}:{:.3f}]\nset yrange [{:.3f}:{:.3f}]\n"
      "set xlabel 'way of the centre along the ground, from touchdown (mm)'\n"
      "set ylabel 'gap (mm)'\n"
      "set arrow from graph 0,first 0 to graph 1,first 0 nohead lw 1 lc rgb "
      "'#40505c' back\n"
      "set arrow from first 0,graph 0 to first 0,graph 1 nohead lw 1 dt (3,4) "
      "lc rgb '#40505c' back\n"
      "set key outside top right horizontal maxrows 1 samplen 3 width 0 font "
      "',13'\n",
      plot.id, -reach_m / kMillimetre, reach_m / kMillimetre,
      -0.08 * top / kMillimetre - 0.1, 1.05 * top / kMillimetre + 0.1);
  if (plot.simulated) {
    s += "set label 'SIMULATED' at graph 0.5,0.5 center rotate by 12 font "
         "',60' tc rgb '#e9cfce' back\n";
  }
  s += data + "plot ";
  for (std::size_t i = 0; i < parts.size(); ++i) {
    s += (i == 0 ? "" : ", \\\n  ") + parts[i];
  }
  return InlineSvg(RunGnuplot(s + "\n"), plot.id);
}

}  // namespace touchdown::report
