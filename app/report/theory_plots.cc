// The contact theory as plots. A contact is written as the linear
// complementarity problem y = A f + B with f >= 0, y >= 0 and f y = 0: f is the
// normal force, y the normal acceleration of the contact point. The signs of A
// and B decide how many solutions there are, which is the regime.
#include "app/report/theory_plots.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/report/gnuplot.h"
#include "app/report/plot_style.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using analysis::Regime;

// A regime in the key of the map, with its colour.
struct Shade {
  const char* label;
  const char* colour;
};

// Order of the colours in a map.
constexpr std::array<Shade, 5> kShades = {{
    {"slide", kSkyBlue},
    {"detach", kGreen},
    {"two solutions (detach, or slide unstably)", kYellow},
    {"no solution (impact without collision)", kVermilion},
    {"on an edge within rounding", kBlack},
}};

// Index into kShades. Regimes that rounding leaves on an edge are the last.
int ChooseShade(Regime regime) {
  switch (regime) {
    case Regime::kSlide:
      return 0;
    case Regime::kDetach:
      return 1;
    case Regime::kIndeterminate:
      return 2;
    case Regime::kInconsistent:
      return 3;
    default:
      return 4;
  }
}

// The solutions of y = A f + B in the plane as lines "f y" of a data block:
// where the line meets the axis f = 0 (B >= 0: the body detaches) and the axis
// y = 0 (A and B of opposite sign: it stays in contact).
std::string Solutions(double slope, double intercept) {
  std::string out;
  if (intercept >= 0.0) out += fmt::format("0 {:.9g}\n", intercept);
  if (slope * intercept < 0.0) {
    out += fmt::format("{:.9g} 0\n", -intercept / slope);
  }
  return out;
}

// The edges of the regimes as curves, over the staircase of the cells: b = 0
// and, on the leading corner, A_hat = 0. Further elements of the plot command.
std::string Edges(const analysis::RegimeMap& map) {
  constexpr const char* kStyle = "with lines lw 1.5 lc rgb '#303030' notitle";
  const analysis::ContactProblem& p = map.problem;
  const bool over_mu = map.axis == analysis::MapAxis::kMu;
  const double top = map.axis_value.back();
  std::string out;
  // A vertical line at an angle: gnuplot's '+' runs through 400 samples, 0 to
  // 399.
  const auto vertical = [&](double alpha_rad) {
    out += fmt::format(", \\\n  '+' using ({:.9g}):({:.9g}*$0/399.0) {}",
                       alpha_rad / core::kDegree, top, kStyle);
  };
  // b = 0 where r omega^2 sin(alpha) = g: at one angle, whatever the friction.
  if (over_mu) {
    const double lift = p.radius_m * p.omega_rad_per_s * p.omega_rad_per_s;
    if (lift > p.gravity_mps2) vertical(std::asin(p.gravity_mps2 / lift));
    if (p.slip == analysis::Slip::kLeading) {
      // mu = G_NN / G_NT
      out += fmt::format(
          ", \\\n  [0.1:89.9] (1+{0:.9g}*cos(x*pi/180)**2)/"
          "({0:.9g}*sin(x*pi/180)*cos(x*pi/180)) {1}",
          p.kappa, kStyle);
    }
    return out;
  }
  // The same condition solved for the spin.
  out += fmt::format(", \\\n  [0.1:90] sqrt({:.9g}/sin(x*pi/180)) {}",
                     p.gravity_mps2 / p.radius_m, kStyle);
  if (p.slip == analysis::Slip::kLeading && p.kappa > 0.0) {
    // A_hat does not depend on the spin: its edges are two angles.
    const analysis::Wedge wedge = analysis::PainleveWedge(p.kappa, p.mu);
    if (wedge.exists) {
      vertical(wedge.low_rad);
      vertical(wedge.high_rad);
    }
  }
  return out;
}

}  // namespace

std::string DrawRegimeMap(const analysis::RegimeMap& map,
                          const std::string& title) {
  const bool over_mu = map.axis == analysis::MapAxis::kMu;
  std::string script = PlotHead(760, 560);
  script += "set samples 400\n";
  script += fmt::format("set title {}\n", GnuplotQuote(title));
  script += "set xlabel 'radius angle α / deg'\n";
  script += over_mu ? "set ylabel 'friction coefficient μ'\n"
                    : "set ylabel 'spin after the impact ω / (rad/s)'\n";
  script +=
      fmt::format("set xrange [0:{:.9g}]\nset yrange [0:{:.9g}]\n",
                  map.alpha_rad.back() / core::kDegree, map.axis_value.back());
  script += "set xtics 15\nset ytics autofreq\n";
  script +=
      "set key below center Left reverse maxrows 3 samplen 1.5 spacing 1.2\n";
  // The palette is five flat colours, one for each shade, with its number in
  // the middle.
  script += "unset colorbox\nset cbrange [-0.5:4.5]\nset palette defined (";
  for (std::size_t i = 0; i < kShades.size(); ++i) {
    script += fmt::format("{}{} '{}', {} '{}'", i == 0 ? "" : ", ",
                          static_cast<double>(i) - 0.5, kShades[i].colour,
                          static_cast<double>(i) + 0.5, kShades[i].colour);
  }
  script += ") maxcolors 5\n";
  // Viewers would resample an image of the cells: rows of boxes instead, one
  // box for each run of equal cells. `cells` counts the cells of each shade.
  std::array<std::size_t, kShades.size()> cells{};
  script += "$boxes << EOD\n";
  const double width = map.alpha_rad[1] / core::kDegree;
  const double height = map.axis_value[1];
  const double right = map.alpha_rad.back() / core::kDegree;
  for (std::size_t j = 0; j < map.axis_value.size(); ++j) {
    std::size_t start = 0;
    for (std::size_t i = 1; i <= map.alpha_rad.size(); ++i) {
      const int shade = ChooseShade(map.At(start, j).regime);
      // The run goes on.
      if (i < map.alpha_rad.size() &&
          ChooseShade(map.At(i, j).regime) == shade) {
        continue;
      }
      cells[static_cast<std::size_t>(shade)] += i - start;
      // Cells are centred on their grid points, so that a box begins half a
      // step before its first one; boxes at the edges are cut to the axes.
      const double low = static_cast<double>(start) * width - 0.5 * width;
      const double high = static_cast<double>(i) * width - 0.5 * width;
      const double y = map.axis_value[j];
      script +=
          fmt::format("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {}\n",
                      0.5 * (low + high), y, std::max(0.0, low),
                      std::min(right, high), std::max(0.0, y - 0.5 * height),
                      std::min(map.axis_value.back(), y + 0.5 * height), shade);
      start = i;
    }
  }
  script += "EOD\n";
  script += "set grid front lw 0.5 lc rgb '#40ffffff'\nset border back\n";
  script +=
      "plot $boxes using 1:2:3:4:5:6:7 with boxxyerror fs solid 1.0 noborder "
      "lc palette notitle";
  script += Edges(map);
  for (std::size_t i = 0; i < kShades.size(); ++i) {
    constexpr std::size_t kVisible = 1000;  // a thousandth of the picture
    // A regime that can hardly be seen has no place in the key.
    if (cells[i] * kVisible < map.cells.size()) continue;
    script += fmt::format(
        ", \\\n  NaN with boxes fs solid 1.0 noborder lc rgb '{}' title {}",
        kShades[i].colour, GnuplotQuote(kShades[i].label));
  }
  script += "\n";
  return RunGnuplot(script);
}

std::string DrawComplementarityCases() {
  struct Case {
    double slope;
    double intercept;
    const char* title;
    const char* verdict;
  };
  constexpr std::array<Case, 4> kCases = {{
      {1.0, -1.0, "A > 0, B < 0", "slide: F_{n} = -B/A"},
      {1.0, 1.0, "A > 0, B > 0", "detach: F_{n} = 0"},
      {-1.0, 1.0, "A < 0, B > 0", "two solutions: indeterminate"},
      {-1.0, -1.0, "A < 0, B < 0", "no solution: inconsistent"},
  }};
  std::string script = PlotHead(860, 700);
  script +=
      "unset key\nset xrange [-0.35:2.4]\nset yrange [-2:2]\n"
      "set xzeroaxis lw 1 lc rgb '#404040'\n"
      "set yzeroaxis lw 1 lc rgb '#404040'\nunset border\n"
      "set xtics axis 1,1,2\nset ytics axis -2,1,2\nunset grid\n"
      "set multiplot layout 2,2 margins 0.05,0.98,0.05,0.94 spacing "
      "0.06,0.11\n";
  for (const Case& c : kCases) {
    script += fmt::format("set title {}\n", GnuplotQuote(c.title));
    script += "unset label\n";
    script += "set label 1 'F_{n}' at 2.4,-0.28 right\n";
    script += "set label 2 'g_{N}″' at 0.08,1.9 left\n";
    // The verdict stands where no line crosses it.
    const bool none = c.slope < 0.0 && c.intercept < 0.0;
    script += fmt::format("set label 3 {} at {} tc rgb '{}'\n",
                          GnuplotQuote(c.verdict),
                          none ? "2.4,1.0 right" : "0.55,-1.75 left",
                          c.slope < 0.0 ? kVermilion : kBlue);
    // The complementarity set: both axes' positive halves.
    script += fmt::format("$set << EOD\n0 2\n0 0\n2.4 0\nEOD\n");
    const std::string points = Solutions(c.slope, c.intercept);
    script += fmt::format("$points << EOD\n{}EOD\n",
                          points.empty() ? "NaN NaN\n" : points);
    script += fmt::format(
        "plot $set with lines lw 4 lc rgb '#c8c8c8', {}*x + ({}) lw 2.5 lc rgb "
        "'{}', $points with points pt 7 ps 1.3 lc rgb '{}'\n",
        c.slope, c.intercept, kBlue, kBlack);
  }
  script += "unset multiplot\n";
  return RunGnuplot(script);
}

std::string DrawComplementarityLines(
    const std::vector<analysis::ComplementarityLine>& lines,
    const std::string& title) {
  // Wide enough for every solution on the force axis.
  double reach = 1.2;
  double top = 1.0;
  for (const auto& line : lines) {
    top = std::max(top, line.intercept);
    if (line.slope * line.intercept >= 0.0) continue;
    constexpr double kMostShown = 3.0;  // nearly singular lines would blank out
    const double force = -line.intercept / line.slope;
    if (force < kMostShown) reach = std::max(reach, 1.15 * force);
  }
  std::string script = PlotHead(820, 520);
  script += fmt::format("set title {}\n", GnuplotQuote(title));
  script +=
      "set xlabel 'normal force F_{n} / (m g)'\n"
      "set ylabel 'normal acceleration g_{N}″ / g'\n"
      "set key outside right top Left reverse title 'angle α, state, F_{n}/(m "
      "g)' samplen 2\n"
      "set xzeroaxis lw 1 lc rgb '#404040'\n";
  script += fmt::format("set xrange [0:{:.6g}]\nset yrange [-2:{:.6g}]\n",
                        reach, std::max(1.5, 1.15 * top));
  script += fmt::format("$set << EOD\n0 {:.6g}\n0 0\n{:.6g} 0\nEOD\n",
                        std::max(1.5, 1.15 * top), reach);
  std::string points;
  std::string plot = "plot $set with lines lw 4 lc rgb '#c8c8c8' notitle";
  constexpr std::array<const char*, 8> kColours = {
      kBlue, kVermilion, kGreen, kOrange, kPurple, kSkyBlue, kBlack, kYellow};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto& line = lines[i];
    // Forces in units of m g, accelerations in units of g.
    points += Solutions(line.slope, line.intercept);
    std::string verdict(analysis::Name(line.regime));
    // "slide", from a name with underscores.
    std::transform(verdict.begin(), verdict.end(), verdict.begin(),
                   [](char c) { return c == '_' ? ' ' : std::tolower(c); });
    std::string label =
        fmt::format("{:.1f}°  {}", line.alpha_rad / core::kDegree, verdict);
    if (line.slope * line.intercept < 0.0) {
      label += fmt::format(", {:.3g}", -line.intercept / line.slope);
    }
    plot += fmt::format(
        ", \\\n  {:.9g}*x + ({:.9g}) with lines lw 2 dt {} lc rgb '{}' title "
        "{}",
        line.slope, line.intercept, i < kColours.size() ? 1 : 2,
        kColours[i % kColours.size()], GnuplotQuote(label));
  }
  if (!points.empty()) {
    script += fmt::format("$points << EOD\n{}EOD\n", points);
    plot += fmt::format(
        ", \\\n  $points with points pt 7 ps 0.9 lc rgb '{}' title 'solution'",
        kBlack);
  }
  return RunGnuplot(script + plot + "\n");
}

}  // namespace touchdown::report
