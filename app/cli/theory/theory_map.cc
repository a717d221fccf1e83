// touchdown theory map shows the regimes over the radius angle and a second
// axis, friction or spin, as a CSV and as drawings in one folder. Beside the
// map come the paper's figures of the complementarity problem.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/case_file.h"
#include "app/cli/theory/theory_options.h"
#include "app/report/theory_plots.h"
#include "touchdown/analysis/theory/regime_map.h"
#include "touchdown/core/errors.h"

namespace touchdown::cli {
namespace {

using analysis::MapAxis;
using core::kDegree;

// The contact angles of the paper's Table 1.
const std::vector<double> kPaperAngles_rad = {
    0.0 * kDegree,  3.9 * kDegree,  7.8 * kDegree,
    11.8 * kDegree, 27.4 * kDegree, 43.0 * kDegree,
    58.7 * kDegree, 74.4 * kDegree, 90.0 * kDegree};

// Writes one line a cell: angle, value of the second axis, regime, and the
// normal force of the sliding solution per mass. The angle runs fastest.
std::string Csv(const analysis::RegimeMap& map) {
  std::string out =
      fmt::format("alpha_deg,{},regime,normal_force_per_mass_mps2\n",
                  map.axis == MapAxis::kMu ? "mu" : "omega_rad_per_s");
  for (std::size_t j = 0; j < map.axis_value.size(); ++j) {
    for (std::size_t i = 0; i < map.alpha_rad.size(); ++i) {
      const auto& cell = map.At(i, j);
      fmt::format_to(std::back_inserter(out), "{:.10g},{:.10g},{},{:.10g}\n",
                     map.alpha_rad[i] / kDegree, map.axis_value[j],
                     Name(cell.regime), cell.normal_per_mass_mps2);
    }
  }
  return out;
}

// Says what the map holds fixed, for the heading of its drawing.
std::string Circumstances(const analysis::ContactProblem& p, MapAxis axis) {
  const char* corner =
      p.slip == analysis::Slip::kLeading ? "leading" : "trailing";
  const std::string other =
      axis == MapAxis::kMu ? fmt::format("ω = {:.4g} rad/s", p.omega_rad_per_s)
                           : fmt::format("μ = {:.4g}", p.mu);
  // Without spin R plays no part.
  const bool spins = axis == MapAxis::kOmega || p.omega_rad_per_s != 0.0;
  return fmt::format("{} corner, κ = {:.4g}, {}{}", corner, p.kappa,
                     spins ? fmt::format("R = {:.4g} m, ", p.radius_m) : "",
                     other);
}

}  // namespace

// Computes the map and writes it into --out; lists the files on stdout. Returns
// 0. Throws std::invalid_argument for flags, core::OutputError where folder or
// files cannot be written.
int RunMap(const TheoryFlags& flags) {
  const CornerFlags& f = flags.corner;
  const MapFlags& m = flags.map;
  analysis::RegimeMapOptions options;
  options.axis = m.over == "mu" ? MapAxis::kMu : MapAxis::kOmega;
  options.alpha_points = m.alpha_points;
  options.axis_points = m.axis_points;
  analysis::ContactProblem& p = options.problem;
  if (IsSphere(f)) {
    throw std::invalid_argument(
        "--body is a sphere, must be rectangle or hoop for a map: a sphere's "
        "contact has no angle");
  }
  p.kappa = NeedKappa(f);
  p.slip = NeedSlip(f);
  p.gravity_mps2 = f.gravity_mps2;
  p.omega_rad_per_s = f.omega_rad_per_s.value_or(0.0);
  // The radius enters through the spin alone.
  const bool needs_radius =
      options.axis == MapAxis::kOmega || p.omega_rad_per_s != 0.0;
  p.radius_m =
      needs_radius ? Need(f.radius_m, "--radius-m") : f.radius_m.value_or(1.0);
  if (options.axis == MapAxis::kOmega) {
    p.mu = Need(f.mu, "--mu");
    constexpr double kTimesThreshold = 3.0;  // shows where detachment begins
    options.axis_max = m.max.value_or(kTimesThreshold *
                                      std::sqrt(p.gravity_mps2 / p.radius_m));
  } else {
    constexpr double kMuShown = 6.0;  // the wedge of a rectangle begins at 4/3
    options.axis_max = m.max.value_or(kMuShown);
  }
  if (flags.result.out.empty()) {
    throw std::invalid_argument(
        "--out is missing; give a folder for regime_map.csv and the drawings");
  }
  const analysis::RegimeMap map = analysis::ComputeRegimeMap(options);

  // The map is computed before the folder is made: impossible numbers leave
  // nothing behind.
  const std::filesystem::path folder = flags.result.out;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw core::OutputError(fmt::format("{}: folder cannot be made: {}",
                                        folder.string(), error.message()));
  }
  std::vector<std::string> written;
  // Writes one file whole and remembers its name for the list.
  const auto write = [&](const char* name, const std::string& text) {
    const std::string path = (folder / name).string();
    WriteResult(text, path);
    written.push_back(path);
  };
  write("regime_map.csv", Csv(map));
  if (!m.no_plots) {
    write("regime_map.svg",
          report::DrawRegimeMap(map, "Regimes of the sliding contact: " +
                                         Circumstances(p, options.axis)));
    write("fig2_complementarity.svg", report::DrawComplementarityCases());
    // The paper's Figs. 6 and 7: its "sphere" (a hoop) and its rectangle, at
    // the angles of its Table 1, with the friction and spin asked for.
    analysis::ContactProblem line = p;
    if (options.axis == MapAxis::kMu) line.mu = f.mu.value_or(0.5);
    for (const auto& [name, kappa, body] :
         {std::tuple{"fig6_sphere.svg", analysis::MassLayout::kHoop,
                     "the paper's sphere"},
          std::tuple{"fig7_rectangle.svg", analysis::MassLayout::kRectangle,
                     "the rectangle"}}) {
      // The two figures differ in the mass layout only.
      line.kappa = Kappa(kappa);
      write(name,
            report::DrawComplementarityLines(
                analysis::ComplementarityLines(line, kPaperAngles_rad),
                fmt::format(
                    "{} (κ = {:.4g}), {} corner, μ = {:.4g}, Rω²/g = {:.4g}",
                    body, line.kappa,
                    line.slip == analysis::Slip::kLeading ? "leading"
                                                          : "trailing",
                    line.mu,
                    line.radius_m * line.omega_rad_per_s *
                        line.omega_rad_per_s / line.gravity_mps2)));
    }
  }
  if (flags.result.json) {
    const nlohmann::ordered_json json = {{"schema", "touchdown.theory.map/1"},
                                         {"over", m.over},
                                         {"alpha_points", options.alpha_points},
                                         {"axis_points", options.axis_points},
                                         {"axis_max", options.axis_max},
                                         {"files", written}};
    // The folder's name may be no UTF-8.
    WriteResult(json.dump(2, ' ', false,
                          nlohmann::ordered_json::error_handler_t::replace) +
                    "\n",
                "");
  } else {
    std::string text;
    for (const std::string& path : written) text += path + "\n";
    WriteResult(text, "");
  }
  return 0;
}

}  // namespace touchdown::cli
