// An individuals control chart as a gnuplot script: value over number of the
// shot, with the mean, the limits at 3 sigma and a bar of +- 2 u on each value.
#include "app/report/control_plot.h"

#include <fmt/core.h>

#include <algorithm>

#include "app/report/gnuplot.h"

namespace touchdown::report {
namespace {

// A horizontal line of the plot command at `y`, with its title in the key.
std::string LimitLine(double y, const char* style, const char* title) {
  return fmt::format("{:.9g} with lines {} title '{}'", y, style, title);
}

std::string ControlScript(const ControlPlot& plot) {
  const analysis::IndividualsChart& chart = plot.chart;
  // The axis holds the limits and every bar.
  double low = chart.lower;
  double high = chart.upper;
  for (std::size_t i = 0; i < plot.values.size(); ++i) {
    low = std::min(low, plot.values[i] - plot.twice_u[i]);
    high = std::max(high, plot.values[i] + plot.twice_u[i]);
  }
  // Of values that are all the same the axis still has a length.
  const double room = high > low ? 0.08 * (high - low) : 1.0;
  const std::size_t n = plot.values.size();
  std::string s = fmt::format(
      "set terminal svg size 940,260 dynamic noenhanced "
      "font 'Arial,14' name '{}'\n"
      "set lmargin 12\nset rmargin 3\nset tmargin 2.2\nset bmargin 3.4\n"
      "set border 3 lc rgb '#1c2126'\nset tics nomirror\n"
      "set xrange [0.5:{}.5]\nset yrange [{:.9g}:{:.9g}]\n"
      "set xtics {}\nset xlabel 'check shot, in the order of time'\n"
      "set ylabel {}\n"
      "set key outside top right horizontal maxrows 1 samplen 1.6 width 0 font "
      "',13'\n",
      plot.id, n, low - room, high + room, std::max<std::size_t>(1, n / 20),
      GnuplotQuote(plot.quantity));
  if (plot.simulated) {
    s += "set label 'SIMULATED' at graph 0.5,0.5 center rotate by 12 font "
         "',60' tc rgb '#e9cfce' back\n";
  }
  // The shots within the limits, or beyond them, as a data block: number from
  // 1, value, 2 u. They are drawn with different marks.
  const auto block = [&](const char* name, bool beyond) {
    s += fmt::format("${} << EOD\n", name);
    for (std::size_t i = 0; i < n; ++i) {
      const bool is_beyond = std::find(chart.beyond.begin(), chart.beyond.end(),
                                       i) != chart.beyond.end();
      if (is_beyond != beyond) continue;
      s += fmt::format("{} {:.9g} {:.9g}\n", i + 1, plot.values[i],
                       plot.twice_u[i]);
    }
    s += "EOD\n";
  };
  // A thin line through all shots in the order of time shows drifts and steps.
  s += "$all << EOD\n";
  for (std::size_t i = 0; i < n; ++i) {
    s += fmt::format("{} {:.9g}\n", i + 1, plot.values[i]);
  }
  s += "EOD\n";
  block("within", false);
  block("beyond", true);
  s += "plot " + LimitLine(chart.centre, "lw 1.5 lc rgb '#1f6f3f'", "mean") +
       ", \\\n  " +
       LimitLine(chart.upper, "lw 1.5 dt (10,5) lc rgb '#7a4a00'",
                 "mean +- 3 sigma") +
       ", \\\n  " +
       fmt::format(
           "{:.9g} with lines lw 1.5 dt (10,5) lc rgb '#7a4a00' "
           "notitle, \\\n  ",
           chart.lower) +
       "$all using 1:2 with lines lw 1 lc rgb '#9aa7b2' notitle";
  // A block without shots has no place in the key.
  if (chart.beyond.size() < n) {
    s += ", \\\n  $within using 1:2:3 with yerrorbars pt 7 ps 0.8 lw 1.2 lc "
         "rgb '#17548f' title 'check shot'";
  }
  if (!chart.beyond.empty()) {
    s += ", \\\n  $beyond using 1:2:3 with yerrorbars pt 9 ps 1.2 lw 1.2 lc "
         "rgb '#b3430f' title 'beyond the limits'";
  }
  return s + "\n";
}

}  // namespace

std::string DrawControlPlot(const ControlPlot& plot) {
  return InlineSvg(RunGnuplot(ControlScript(plot)), plot.id);
}

}  // namespace touchdown::report
