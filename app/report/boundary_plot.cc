// The plot of a group as a gnuplot script: P(bounce) over the contact angle in
// degrees. Trials are marks at 1 (bounced), 0 (stayed down) or their P(bounce)
// (undecided); behind them stand the bracket, the posterior of the boundary and
// the lines of theory. The data blocks ($slides, $density ...) come before the
// one plot command that draws them.
#include "app/report/boundary_plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "app/report/gnuplot.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using analysis::Observation;
using analysis::Outcome;
using core::kDegree;

// Above so many trials marks of one outcome are spread over a few rows, so that
// they do not hide each other.
constexpr std::size_t kSpreadAbove = 40;
// Half-height of that spread, in units of P(bounce).
constexpr double kSpread = 0.06;

// How far the mark of trial `i` of `n` is moved up or down: one of seven rows.
// Stepping by three rows puts neighbours in angle far apart.
double Spread(std::size_t i, std::size_t n) {
  if (n <= kSpreadAbove) return 0.0;
  constexpr int kRows = 7;
  return kSpread * (2.0 * static_cast<double>(i * 3 % kRows) / (kRows - 1) - 1);
}

// The horizontal axis. It goes up to 2 degrees beyond 0 and 90, so that marks
// at these angles are drawn whole.
struct AxisRange {
  double low_deg = 0.0;
  double high_deg = 90.0;
};

// All of 0..90 where the trials need most of it, else what they, the lines and
// the whole interval of the boundary occupy, to whole 5 degrees.
AxisRange ChooseAxisRange(const BoundaryPlot& plot) {
  double low = 90.0;
  double high = 0.0;
  const auto include = [&](double a, double b) {
    low = std::min(low, a / kDegree);
    high = std::max(high, b / kDegree);
  };
  for (const Observation& o : plot.observations) {
    include(o.angle_rad - 2 * o.u_rad, o.angle_rad + 2 * o.u_rad);
  }
  for (const PlotLine& line : plot.lines) {
    include(line.angle_rad, line.angle_rad);
  }
  if (plot.interval) {
    include(plot.interval->angle_rad.low, plot.interval->angle_rad.high);
  }
  if (low > high) return {};
  AxisRange range{std::floor((low - 2) / 5) * 5, std::ceil((high + 2) / 5) * 5};
  range.low_deg = std::max(range.low_deg, -2.0);
  range.high_deg = std::min(range.high_deg, 92.0);
  return range;
}

// The data block `name` of the trials with one outcome, a line for each: angle
// in degrees, height of the mark, and 2 u in degrees as the half-length of its
// bar.
std::string OutcomeBlock(const BoundaryPlot& plot, Outcome outcome,
                         std::string_view name) {
  std::string block = fmt::format("${} << EOD\n", name);
  for (std::size_t i = 0; i < plot.observations.size(); ++i) {
    const Observation& o = plot.observations[i];
    if (o.outcome != outcome) continue;
    const double level = outcome == Outcome::kBounce      ? 1.0
                         : outcome == Outcome::kNotBounce ? 0.0
                                                          : o.p_bounce;
    block += fmt::format("{:.6f} {:.6f} {:.6f}\n", o.angle_rad / kDegree,
                         level + Spread(i, plot.observations.size()),
                         2 * o.u_rad / kDegree);
  }
  return block + "EOD\n";
}

// Whether any trial had that outcome: else it has no place in the key.
bool Any(const BoundaryPlot& plot, Outcome outcome) {
  return std::any_of(
      plot.observations.begin(), plot.observations.end(),
      [outcome](const Observation& o) { return o.outcome == outcome; });
}

// The bar of the interval, its ends marked or open: below the slides, where no
// mark is. The caption names it; the key has no room.
void AddInterval(const PlotInterval& interval, const AxisRange& range,
                 std::string& script, std::vector<std::string>& parts) {
  constexpr double kLevel = -0.1;
  constexpr double kEnd = 0.04;  // half-height of a closed end
  constexpr std::string_view kColour = "#5b2a86";
  const double low =
      interval.open_low ? range.low_deg : interval.angle_rad.low / kDegree;
  const double high =
      interval.open_high ? range.high_deg : interval.angle_rad.high / kDegree;
  const double middle = interval.middle_rad / kDegree;
  // One half of the bar, from the median outward, with a stop or an arrowhead
  // at its end.
  const auto arrow = [&](double end, bool open) {
    script += fmt::format(
        "set arrow from {0:.6f},{1} to {2:.6f},{1} {3} lw 3 lc rgb '{4}' "
        "front\n",
        middle, kLevel, end,
        open ? "head filled size screen 0.012,20" : "nohead", kColour);
    if (open) return;
    script += fmt::format(
        "set arrow from {0:.6f},{1} to {0:.6f},{2} nohead lw 3 lc rgb '{3}' "
        "front\n",
        end, kLevel - kEnd, kLevel + kEnd, kColour);
  };
  arrow(low, interval.open_low);
  arrow(high, interval.open_high);
  script += fmt::format("$middle << EOD\n{:.6f} {}\nEOD\n", middle, kLevel);
  parts.push_back(fmt::format(
      "$middle using 1:2 with points pt 13 ps 1.2 lc rgb '{}' notitle",
      kColour));
}

std::string BoundaryScript(const BoundaryPlot& plot) {
  const AxisRange range = ChooseAxisRange(plot);
  std::string s = fmt::format(
      "set terminal svg size 940,320 dynamic noenhanced "
      "font 'Arial,14' name '{}'\n"
      "set lmargin 13\nset rmargin 3\nset tmargin 2.2\nset bmargin 3.4\n"
      "set border 3 lc rgb '#1c2126'\nset tics nomirror\n"
      "set xrange [{:.1f}:{:.1f}]\nset yrange [-0.16:1.16]\n"
      "set ytics ('slide  0' 0, '0.25' 0.25, '0.5' 0.5, '0.75' 0.75, 'bounce  "
      "1' "
      "1)\n"
      "set grid ytics lw 0.5 lc rgb '#d4dadf'\n"
      "set ylabel 'probability of a bounce'\nset xlabel {}\n"
      "set key outside top right horizontal maxrows 1 samplen 1.6 width 0 font "
      "',13'\n",
      plot.id, range.low_deg, range.high_deg,
      GnuplotQuote(plot.angle_name + " (deg)"));
  // More than half of the axis is labelled every 10 degrees, less every 5.
  s += range.high_deg - range.low_deg > 50 ? "set xtics 10\nset mxtics 2\n"
                                           : "set xtics 5\nset mxtics 5\n";
  // The watermark lies behind all marks and stays in a plot that is copied out.
  if (plot.simulated) {
    s += "set label 'SIMULATED' at graph 0.5,0.5 center rotate by 12 font "
         "',60' tc rgb '#e9cfce' back\n";
  }
  // The bracket as a grey column, then each theory with its +- 2 u.
  if (plot.bracket.closed()) {
    s += fmt::format(
        "set object rectangle from {:.6f},graph 0 to {:.6f},graph 1 fc rgb "
        "'#c3cfda' fs solid 0.75 noborder behind\n",
        *plot.bracket.low_rad / kDegree, *plot.bracket.high_rad / kDegree);
  }
  for (const PlotLine& line : plot.lines) {
    if (line.u_rad <= 0.0) continue;
    s += fmt::format(
        "set object rectangle from {:.6f},graph 0 to {:.6f},graph 1 fc rgb "
        "'#1f6f3f' fs transparent solid 0.12 noborder behind\n",
        (line.angle_rad - 2 * line.u_rad) / kDegree,
        (line.angle_rad + 2 * line.u_rad) / kDegree);
  }
  s += OutcomeBlock(plot, Outcome::kNotBounce, "slides");
  s += OutcomeBlock(plot, Outcome::kBounce, "bounces");
  s += OutcomeBlock(plot, Outcome::kUndecided, "undecided");

  // The elements of the plot command. Later ones lie over earlier ones: the
  // posterior first, the marks of the trials last.
  std::vector<std::string> parts;
  if (!plot.density.angle_rad.empty()) {
    // The density has another unit than the axis, so that its greatest value is
    // put at 0.9: it shows where the boundary lies, not how probable that is.
    const double peak = *std::max_element(plot.density.height.begin(),
                                          plot.density.height.end());
    s += "$density << EOD\n";
    for (std::size_t i = 0; i < plot.density.angle_rad.size(); ++i) {
      s += fmt::format("{:.5f} {:.5f}\n", plot.density.angle_rad[i] / kDegree,
                       peak > 0.0 ? 0.9 * plot.density.height[i] / peak : 0.0);
    }
    s += "EOD\n";
    parts.push_back(fmt::format(
        "$density using 1:2 with filledcurves y=0 fc rgb '#8a6fb0' fs "
        "transparent solid 0.3 title {}",
        GnuplotQuote(plot.density.name)));
  }
  if (!plot.p_bounce.angle_rad.empty()) {
    s += "$chance << EOD\n";
    for (std::size_t i = 0; i < plot.p_bounce.angle_rad.size(); ++i) {
      s += fmt::format("{:.4f} {:.5f}\n", plot.p_bounce.angle_rad[i] / kDegree,
                       plot.p_bounce.height[i]);
    }
    s += "EOD\n";
    parts.push_back(fmt::format(
        "$chance using 1:2 with lines lw 2 lc rgb '#1c2126' title {}",
        GnuplotQuote(plot.p_bounce.name)));
  }
  // Dashes tell the lines apart where colours do not print.
  static constexpr std::string_view kDash[] = {"(10,5)", "(3,4)", "(12,4,3,4)",
                                               "(6,3)"};
  static constexpr std::string_view kLineColour[] = {"#1f6f3f", "#7a4a00",
                                                     "#5b2a86", "#40505c"};
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    // A line is drawn as two points from below the axis to above it, so that it
    // has a place in the key.
    s += fmt::format("$line{} << EOD\n{:.6f} -0.16\n{:.6f} 1.16\nEOD\n", i,
                     plot.lines[i].angle_rad / kDegree,
                     plot.lines[i].angle_rad / kDegree);
    parts.push_back(fmt::format(
        "$line{} using 1:2 with lines lw 2 dt {} lc rgb '{}' title {}", i,
        kDash[i % std::size(kDash)], kLineColour[i % std::size(kLineColour)],
        GnuplotQuote(plot.lines[i].name)));
  }
  if (plot.bracket.closed()) {
    parts.push_back(
        "NaN with boxes fc rgb '#c3cfda' fs solid 0.75 noborder title "
        "'bracket'");
  }
  // Marks of one outcome with their bars. The shapes differ (disc, triangle,
  // square) for readers who do not see the colours.
  const auto marks = [&](Outcome outcome, std::string_view block, int mark,
                         std::string_view colour, std::string_view title) {
    if (!Any(plot, outcome)) return;
    parts.push_back(fmt::format(
        "${0} using 1:2:3 with xerrorbars pt {1} ps 0.8 lw 1.2 lc rgb '{2}' "
        "title '{3}'",
        block, mark, colour, title));
  };
  marks(Outcome::kNotBounce, "slides", 7, "#17548f", "slide");
  marks(Outcome::kBounce, "bounces", 9, "#b3430f", "bounce");
  marks(Outcome::kUndecided, "undecided", 4, "#40505c", "undecided");
  if (plot.interval) AddInterval(*plot.interval, range, s, parts);
  // gnuplot refuses a plot command without an element.
  if (parts.empty()) parts.push_back("NaN notitle");
  s += "plot ";
  for (std::size_t i = 0; i < parts.size(); ++i) {
    s += (i == 0 ? "" : ", \\\n  ") + parts[i];
  }
  return s + "\n";
}

}  // namespace

std::string DrawBoundaryPlot(const BoundaryPlot& plot) {
  return InlineSvg(RunGnuplot(BoundaryScript(plot)), plot.id);
}

}  // namespace touchdown::report
