// Each function reads a case file, answers every row and returns the answers as
// CSV, in the columns of the reference cases. A quantity that does not exist is
// an empty cell. An argument that is impossible (std::invalid_argument of the
// module) becomes a core::InputError that names file and line:
// CaseRow::Answer().
#include "app/cli/theory/theory_cases.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/cli/case_file.h"
#include "app/cli/theory/theory_words.h"
#include "touchdown/analysis/theory/contact.h"
#include "touchdown/analysis/theory/flat_contact.h"
#include "touchdown/analysis/theory/impact.h"
#include "touchdown/analysis/theory/lcp.h"
#include "touchdown/analysis/theory/spin_boundary.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

using core::kDegree;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Returns the degrees of an angle that may be absent.
std::optional<double> InDegrees(std::optional<double> angle_rad) {
  if (!angle_rad) return std::nullopt;
  return *angle_rad / kDegree;
}

// Reads -1 (trailing), 0 (at rest) or 1 (leading) (analysis/theory/corner.h).
analysis::Slip SlipOfCase(const CaseRow& row) {
  return static_cast<analysis::Slip>(row.Choice("slip_sign", {-1, 0, 1}));
}

}  // namespace

// The answer has columns for two solutions, the most that a sliding contact
// has. One at rest has a single solution: with b > 0 the sticking force pulls
// and no slip keeps its direction, with b < 0 one of the three holds.
std::string RegimeCases(const std::string& path) {
  const CaseTable table = ReadCases(
      path, {"id", "alpha_rad", "mu", "slip_sign", "m", "R", "omega", "g"});
  std::vector<std::string> columns = {"id",
                                      "regime",
                                      "regime_with_tolerance",
                                      "within_tolerance",
                                      "n_solutions",
                                      "A_hat",
                                      "A",
                                      "B",
                                      "B_over_g"};
  constexpr int kShown = 2;
  for (int i = 1; i <= kShown; ++i) {
    // These are the columns of the two solutions: sol1_kind, sol1_Fn ...
    // sol2_residual.
    for (const char* name : {"kind", "Fn", "Ft", "gddN", "gddT", "residual"}) {
      columns.push_back(fmt::format("sol{}_{}", i, name));
    }
  }
  for (const char* name : {"tol_A_hat", "tol_B", "cond_A", "cond_B"}) {
    columns.emplace_back(name);
  }
  CaseWriter out(columns);
  for (const CaseRow& row : table.rows) {
    row.Answer([&] {
      analysis::ContactProblem p;
      p.alpha = analysis::SinCosOfRadians(row.Number("alpha_rad"));
      p.mu = row.Number("mu");
      p.slip = SlipOfCase(row);
      p.mass_kg = row.Number("m");
      p.radius_m = row.Number("R");
      p.omega_rad_per_s = row.Number("omega");
      p.gravity_mps2 = row.Number("g");
      // The shape is given once: as kappa = R^2/k^2 or as the radius of
      // gyration k.
      const auto kappa = row.OptionalNumber("kappa_in");
      const auto gyration = row.OptionalNumber("k_in");
      if (kappa.has_value() == gyration.has_value()) {
        row.Refuse(kappa ? "k_in" : "kappa_in",
                   "either kappa_in or k_in to be given");
      }
      if (kappa) p.kappa = *kappa;
      if (gyration) {
        if (!(*gyration > 0.0)) row.Refuse("k_in", "a positive length");
        p.gyration_radius_m = *gyration;
      }
      const analysis::ContactResult r = analysis::SolveContact(p);
      // A_hat belongs to sliding; at rest its cells are empty.
      const bool rests = p.slip == analysis::Slip::kNone;
      // A = A_hat / m may leave the range of double where neither does.
      const long double a = static_cast<long double>(r.a_hat) / p.mass_kg;
      std::vector<std::string> cells = {
          row.Text("id"),
          Cell(Name(r.regime)),
          Cell(Name(r.tolerant_regime)),
          Cell(r.within_tolerance ? "yes" : "no"),
          Cell(r.n_solutions),
          rests ? "" : Cell(r.a_hat),
          rests ? "" : fmt::format("{:.19Lg}", a),
          Cell(r.b_mps2),
          p.gravity_mps2 > 0.0 ? Cell(r.b_mps2 / p.gravity_mps2) : ""};
      for (int i = 0; i < kShown; ++i) {
        if (i >= r.n_solutions) {
          // Six empty cells hold the place of a solution that does not exist.
          cells.insert(cells.end(), 6, "");
          continue;
        }
        const auto& s = r.solution[static_cast<std::size_t>(i)];
        for (std::string cell :
             {Cell(Name(s.kind)), Cell(s.normal_n), Cell(s.tangential_n),
              Cell(s.normal_mps2), Cell(s.tangential_mps2), Cell(s.residual)}) {
          cells.push_back(std::move(cell));
        }
      }
      cells.push_back(rests ? "" : Cell(r.a_hat_tolerance));
      cells.push_back(Cell(r.b_tolerance_mps2));
      cells.push_back(rests ? "" : Cell(r.a_hat_condition));
      cells.push_back(Cell(r.b_condition));
      out.Add(cells);
    });
  }
  return out.Csv();
}

// NaN stands for a number that does not exist: Cell() leaves it empty.
std::string FlatCases(const std::string& path) {
  const CaseTable table =
      ReadCases(path, {"id", "a", "b", "mu", "slip_sign", "m", "g"});
  CaseWriter out({"id", "M_rr", "M_rf", "M_fr", "M_ff", "det", "slip*mu*H/L",
                  "n_solutions", "s1_kind", "s1_F_rear", "s1_F_front",
                  "s1_gdd_rear", "s1_gdd_front", "within_tolerance"});
  for (const CaseRow& row : table.rows) {
    row.Answer([&] {
      analysis::FlatProblem p;
      p.length_m = row.Number("a");
      p.height_m = row.Number("b");
      p.mu = row.Number("mu");
      p.slip = SlipOfCase(row);
      p.mass_kg = row.Number("m");
      p.gravity_mps2 = row.Number("g");
      const analysis::FlatResult r = analysis::SolveFlatContact(p);
      const auto& s = r.solution;
      out.Add({row.Text("id"), Cell(r.m_rr), Cell(r.m_rf), Cell(r.m_fr),
               Cell(r.m_ff), Cell(r.determinant), Cell(r.tipping),
               Cell(s ? 1 : 0), s ? Cell(Name(s->feet)) : "",
               Cell(s ? s->rear_n : kNaN), Cell(s ? s->front_n : kNaN),
               Cell(s ? s->rear_mps2 : kNaN), Cell(s ? s->front_mps2 : kNaN),
               Cell(r.within_tolerance ? "yes" : "no")});
    });
  }
  return out.Csv();
}

// Impulses are per unit mass, so their unit is m/s.
std::string ImpactCases(const std::string& path) {
  const CaseTable table = ReadCases(path, {"id", "alpha", "mu", "kappa", "R",
                                           "vT0", "vN0", "alphadot0", "e"});
  CaseWriter out({"id", "P_compress_per_m", "P_total_per_m", "T_total_per_m",
                  "vN1", "vT1", "alphadot1", "phases", "status"});
  for (const CaseRow& row : table.rows) {
    row.Answer([&] {
      analysis::ImpactProblem p;
      p.alpha = analysis::SinCosOfRadians(row.Number("alpha"));
      p.mu = row.Number("mu");
      p.kappa = row.Number("kappa");
      p.radius_m = row.Number("R");
      p.tangential_mps = row.Number("vT0");
      p.normal_mps = row.Number("vN0");
      p.alpha_rate_rad_per_s = row.Number("alphadot0");
      p.restitution = row.Number("e");
      const analysis::ImpactResult r = analysis::Impact(p);
      out.Add({row.Text("id"), Cell(r.compression_impulse_mps),
               Cell(r.normal_impulse_mps), Cell(r.tangential_impulse_mps),
               Cell(r.normal_mps), Cell(r.tangential_mps),
               Cell(r.alpha_rate_rad_per_s), PhasesText(r),
               Cell(Word(r.status))});
    });
  }
  return out.Csv();
}

namespace {

// Answers the boundary of an omega that is uncertain (column u_omega): first
// order, the chance that there is no boundary, and mean, u and quantiles where
// there is one. Angles are in degrees.
std::string UncertainBoundaryCases(const CaseTable& table) {
  CaseWriter out({"id", "w", "alpha_deg", "GUM_first_order_u_deg",
                  "second_order_mean_deg", "P_no_boundary", "cond_mean_deg",
                  "cond_std_deg", "cond_q2.5_deg", "cond_q97.5_deg",
                  "first_order_is_valid"});
  for (const CaseRow& row : table.rows) {
    row.Answer([&] {
      const double radius = row.Number("R");
      const double omega = row.Number("omega");
      const double gravity = row.Number("g");
      const auto b = analysis::SolveSpinBoundary(radius, omega, gravity);
      const auto u = analysis::SpinBoundaryOfUncertainOmega(
          radius, omega, row.Number("u_omega"), gravity);
      const bool exists = b.status != analysis::SpinBoundaryStatus::kNone;
      out.Add({row.Text("id"), Cell(b.w),
               Cell(exists ? b.alpha_rad / kDegree : kNaN),
               Cell(InDegrees(u.first_order_u_rad)),
               Cell(InDegrees(u.second_order_mean_rad)), Cell(u.p_none),
               Cell(InDegrees(u.mean_rad)), Cell(InDegrees(u.u_rad)),
               Cell(InDegrees(u.low_rad)), Cell(InDegrees(u.high_rad)),
               Cell(u.first_order_is_valid ? "yes" : "no")});
    });
  }
  return out.Csv();
}

}  // namespace

std::string BoundaryCases(const std::string& path) {
  const CaseTable table = ReadCases(path, {"id", "R", "omega", "g"});
  if (table.HasColumn("u_omega")) return UncertainBoundaryCases(table);
  CaseWriter out({"id", "w=R*omega^2/g", "w-1", "status", "alpha_b_rad",
                  "alpha_b_deg", "dalpha_domega", "dalpha_dR", "dalpha_dg",
                  "d2alpha_domega2", "rel_condition_wrt_omega"});
  for (const CaseRow& row : table.rows) {
    row.Answer([&] {
      const auto b = analysis::SolveSpinBoundary(
          row.Number("R"), row.Number("omega"), row.Number("g"));
      const bool exists = b.status != analysis::SpinBoundaryStatus::kNone;
      // At R omega^2 = g the boundary is 90 deg and its derivatives are
      // infinite: their cells are empty.
      const bool smooth = b.status == analysis::SpinBoundaryStatus::kExists;
      const auto derivative = [&](double value) {
        return Cell(smooth ? value : kNaN);
      };
      out.Add({row.Text("id"), Cell(b.w), Cell(b.w_minus_1),
               Cell(Word(b.status)), Cell(exists ? b.alpha_rad : kNaN),
               Cell(exists ? b.alpha_rad / kDegree : kNaN),
               derivative(b.d_omega), derivative(b.d_radius),
               derivative(b.d_gravity), derivative(b.d2_omega),
               derivative(b.condition)});
    });
  }
  return out.Csv();
}

namespace {

// Reads an entry of M or q: 3, "3", "0x1.8p+1" or "4/3". Text allows numbers
// that JSON has no form for, such as exact thirds.
double ParseEntry(const CaseRow& row, const char* column,
                  const nlohmann::json& entry) {
  if (entry.is_number()) return entry.get<double>();
  // What is no number is refused below, with the column's name.
  if (entry.is_string()) {
    try {
      return ParseFraction(entry.get<std::string>());
    } catch (const std::invalid_argument&) {
    }
  }
  row.Refuse(column, "a list of numbers or fractions like \"4/3\"");
}

// Reads the cell as a JSON list; where it is none, it is refused with an
// example.
nlohmann::json ParseList(const CaseRow& row, const char* column) {
  nlohmann::json list = nlohmann::json::parse(row.Text(column), nullptr, false);
  if (!list.is_array()) {
    row.Refuse(column, "a list like [[\"2\", \"1/3\"], [\"0\", \"4\"]]");
  }
  return list;
}

// Returns the basic solutions as a JSON list of lists. Numbers are text with 17
// significant digits.
std::string ListOfSolutions(const analysis::LcpResult& r) {
  auto list = nlohmann::json::array();
  for (const analysis::LcpSolution& s : r.solutions) {
    if (!s.basic) continue;
    auto z = nlohmann::json::array();
    for (const double x : s.z) z.push_back(fmt::format("{:.17g}", x));
    list.push_back(z);
  }
  return list.dump();
}

}  // namespace

std::string LcpCases(const std::string& path) {
  const CaseTable table = ReadCases(path, {"M", "q"});
  // Reference files call the first column name or id. Where both are missing,
  // the second reading makes the usual complaint about the header.
  const bool named = table.HasColumn("name");
  if (!named && !table.HasColumn("id")) {
    static_cast<void>(ReadCases(path, {"id", "M", "q"}));  // complains
  }
  CaseWriter out({"id", "name", "status", "n_basic_solutions",
                  "basic_solutions", "n_singular_bases", "residual"});
  for (const CaseRow& row : table.rows) {
    row.Answer([&] {
      std::vector<double> m;
      std::vector<double> q;
      for (const auto& entry : ParseList(row, "q")) {
        q.push_back(ParseEntry(row, "q", entry));
      }
      for (const auto& line : ParseList(row, "M")) {
        if (!line.is_array() || line.size() != q.size()) {
          row.Refuse("M", "as many rows and columns as q has entries");
        }
        for (const auto& entry : line) {
          m.push_back(ParseEntry(row, "M", entry));
        }
      }
      const analysis::LcpResult r = analysis::SolveLcp(m, q);
      // The worst of the solutions stands for all.
      double residual = 0.0;
      for (const auto& s : r.solutions) {
        residual = std::fmax(residual, s.residual);
      }
      const std::string& name = row.Text(named ? "name" : "id");
      out.Add({row.HasColumn("id") ? row.Text("id") : name, name,
               Cell(Name(r.status)), Cell(r.n_basic), ListOfSolutions(r),
               Cell(r.n_singular_bases),
               Cell(r.solutions.empty() ? kNaN : residual)});
    });
  }
  return out.Csv();
}

}  // namespace touchdown::cli
