// touchdown theory regime|impact|flat|lcp: each fills a problem of
// analysis/theory from the flags, solves it, and makes text and JSON of the
// answer together, so that the two show the same numbers. With --cases each
// answers a file instead (theory_cases.h).
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/case_file.h"
#include "app/cli/theory/theory_cases.h"
#include "app/cli/theory/theory_options.h"
#include "app/cli/theory/theory_words.h"
#include "app/text/json.h"
#include "touchdown/analysis/theory/contact.h"
#include "touchdown/analysis/theory/flat_contact.h"
#include "touchdown/analysis/theory/impact.h"
#include "touchdown/analysis/theory/lcp.h"

namespace touchdown::cli {
namespace {

using core::kDegree;
using report::Json;

// Writes the answer as JSON or text, to --out or stdout; returns 0.
int WriteAnswer(const TheoryFlags& flags, const Json& json,
                const std::string& text) {
  WriteResult(flags.result.json ? json.dump(2) + "\n" : text, flags.result.out);
  return 0;
}

// JSON has no infinity: a margin that no change of the input reaches is null.
Json FiniteOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

// Returns a signed change in the unit of the flag, or "never" where none is
// enough.
std::string ChangeText(double value, double per_unit, const char* unit) {
  return std::isfinite(value) ? fmt::format("{:+.4g}{}", value / per_unit, unit)
                              : std::string("never");
}

}  // namespace

// Answers `theory regime`: every solution of the contact problem, and how far
// each input is from a change of regime.
int RunRegime(const TheoryFlags& flags) {
  if (!flags.result.cases.empty()) {
    return AnswerCases(flags.result, RegimeCases);
  }
  const CornerFlags& f = flags.corner;
  analysis::ContactProblem p;
  p.alpha = NeedAlpha(f);
  p.mu = Need(f.mu, "--mu");
  p.slip = NeedSlip(f);
  p.kappa = NeedKappa(f);
  p.mass_kg = f.mass_kg.value_or(1.0);
  p.omega_rad_per_s = f.omega_rad_per_s.value_or(0.0);
  // Without spin the radius plays no part.
  p.radius_m = p.omega_rad_per_s == 0.0 ? f.radius_m.value_or(1.0)
                                        : Need(f.radius_m, "--radius-m");
  p.gravity_mps2 = f.gravity_mps2;
  // A sphere's contact point stays below its centre: neither angle nor spin
  // enters, so the problem is made anew.
  if (IsSphere(f)) {
    p = analysis::SphereContact(p.mass_kg, p.radius_m, p.kappa, p.mu, p.slip,
                                p.gravity_mps2);
  }
  const analysis::ContactResult r = analysis::SolveContact(p);

  Json json = {{"schema", "touchdown.theory.regime/1"},
               {"regime", Name(r.regime)},
               {"regime_with_tolerance", Name(r.tolerant_regime)},
               {"within_tolerance", r.within_tolerance},
               {"solutions", Json::array()}};
  std::string text = fmt::format("regime   {}, {} solution{}\n", Name(r.regime),
                                 r.n_solutions, r.n_solutions == 1 ? "" : "s");
  // Each solution gets a line: there are two where the contact is
  // indeterminate, and none where it is inconsistent.
  for (const analysis::ContactSolution& s : r.Solutions()) {
    json["solutions"].push_back(
        {{"kind", Name(s.kind)},
         {"normal_n", FiniteOrNull(s.normal_n)},
         {"tangential_n", FiniteOrNull(s.tangential_n)},
         {"normal_mps2", FiniteOrNull(s.normal_mps2)},
         {"tangential_mps2", FiniteOrNull(s.tangential_mps2)},
         {"residual", FiniteOrNull(s.residual)}});
    text += fmt::format(
        "  {:<7}F_n = {:.6g} N   F_t = {:.6g} N   g_N'' = {:.6g} m/s^2   "
        "g_T'' = {:.6g} m/s^2\n",
        Name(s.kind), s.normal_n, s.tangential_n, s.normal_mps2,
        s.tangential_mps2);
  }
  if (r.regime == analysis::Regime::kInconsistent) {
    text +=
        "         no finite force keeps the contact: see `touchdown theory "
        "impact --normal-mps 0`\n";
  }
  if (IsSphere(f)) {
    text +=
        "         a sphere touches below its centre: spin and angle play no "
        "part in its normal force\n";
  }
  // The numbers as given decide the regime above. Whoever rounded them must
  // know that a neighbouring regime is possible.
  if (r.within_tolerance) {
    text += fmt::format(
        "         within rounding of an edge: for rounded inputs {}\n",
        Name(r.tolerant_regime));
  }
  const analysis::ContactMargins& m = r.margins;
  json["b_mps2"] = FiniteOrNull(r.b_mps2);
  json["b_tolerance_mps2"] = FiniteOrNull(r.b_tolerance_mps2);
  json["b_condition"] = FiniteOrNull(r.b_condition);
  Json margins = {{"b_alpha_deg", FiniteOrNull(m.b_alpha_rad / kDegree)},
                  {"b_omega_rad_per_s", FiniteOrNull(m.b_omega_rad_per_s)},
                  {"b_radius_m", FiniteOrNull(m.b_radius_m)},
                  {"b_gravity_mps2", FiniteOrNull(m.b_gravity_mps2)}};
  // A sliding contact is decided by the signs of A_hat and b, one at rest by
  // the friction cone and b.
  if (p.slip != analysis::Slip::kNone) {
    json["a_hat"] = FiniteOrNull(r.a_hat);
    json["a_hat_tolerance"] = FiniteOrNull(r.a_hat_tolerance);
    json["a_hat_condition"] = FiniteOrNull(r.a_hat_condition);
    margins["a_hat_alpha_deg"] = FiniteOrNull(m.a_hat_alpha_rad / kDegree);
    margins["a_hat_mu"] = FiniteOrNull(m.a_hat_mu);
    margins["a_hat_kappa"] = FiniteOrNull(m.a_hat_kappa);
    text += fmt::format(
        "A_hat    {:.6g} (condition {:.3g}); to its change of sign: alpha {}, "
        "mu {}, kappa {}\n",
        r.a_hat, r.a_hat_condition,
        ChangeText(m.a_hat_alpha_rad, kDegree, " deg"),
        ChangeText(m.a_hat_mu, 1.0, ""), ChangeText(m.a_hat_kappa, 1.0, ""));
  } else {
    margins["cone_mu"] = FiniteOrNull(m.cone_mu);
    text += fmt::format("cone     mu - |F_t/F_n| of sticking = {:.4g}\n",
                        m.cone_mu);
  }
  text += fmt::format(
      "b        {:.6g} m/s^2 (condition {:.3g}); to its change of sign: alpha "
      "{}, omega {}, R {}\n",
      r.b_mps2, r.b_condition, ChangeText(m.b_alpha_rad, kDegree, " deg"),
      ChangeText(m.b_omega_rad_per_s, 1.0, " rad/s"),
      ChangeText(m.b_radius_m, 1.0, " m"));
  json["margins"] = margins;
  return WriteAnswer(flags, json, text);
}

// Answers `theory impact`: velocities of the contact point and spin after the
// impact. The state before is given as velocity of the centre (speed and
// approach angle) or of the contact point itself.
int RunImpact(const TheoryFlags& flags) {
  if (!flags.result.cases.empty()) {
    return AnswerCases(flags.result, ImpactCases);
  }
  const CornerFlags& f = flags.corner;
  const ImpactFlags& i = flags.impact;
  analysis::ImpactProblem p;
  p.alpha = NeedAlpha(f);
  p.radius_m = Need(f.radius_m, "--radius-m");
  p.kappa = NeedKappa(f);
  p.mu = Need(f.mu, "--mu");
  p.restitution = Need(i.restitution, "--restitution");
  const double omega = f.omega_rad_per_s.value_or(0.0);
  // In the frame of corner.h P lies at +x; there a trailing corner moves to -x
  // and what is counter-clockwise for the viewer is clockwise.
  double mirror = 1.0;
  // The velocity of the contact point is in the frame of corner.h already.
  if (i.tangential_mps || i.normal_mps) {
    if (i.speed_mps || i.approach_deg || !f.corner.empty()) {
      throw std::invalid_argument(
          "--tangential-mps and --normal-mps are the velocity of the contact "
          "point, --speed-mps, --approach-deg and --corner say that of the "
          "centre; give the one or the other");
    }
    p.tangential_mps = Need(i.tangential_mps, "--tangential-mps");
    p.normal_mps = Need(i.normal_mps, "--normal-mps");
    p.alpha_rate_rad_per_s = -omega;
  } else {
    const double speed = Need(i.speed_mps, "--speed-mps");
    const auto approach =
        analysis::SinCosOfDegrees(Need(i.approach_deg, "--approach-deg"));
    mirror = Sign(NeedSlip(f));
    p.alpha_rate_rad_per_s = -mirror * omega;
    // v_P = v_C + omega x r, with d(alpha)/dt = -omega.
    p.tangential_mps = mirror * speed * approach.cos -
                       p.alpha_rate_rad_per_s * p.radius_m * p.alpha.sin;
    p.normal_mps = -speed * approach.sin -
                   p.alpha_rate_rad_per_s * p.radius_m * p.alpha.cos;
  }
  const analysis::ImpactResult r = analysis::Impact(p);
  // From here on signs are those of the viewer's frame, with motion to the
  // right.
  const double omega_after = -mirror * r.alpha_rate_rad_per_s;
  const double slip_before = mirror * p.tangential_mps;
  const double slip_after = mirror * r.tangential_mps;
  const Json json = {{"schema", "touchdown.theory.impact/1"},
                     {"status", Word(r.status)},
                     {"phases", PhasesText(r)},
                     {"before",
                      {{"tangential_mps", slip_before},
                       {"normal_mps", p.normal_mps},
                       {"omega_rad_per_s", omega}}},
                     {"after",
                      {{"tangential_mps", slip_after},
                       {"normal_mps", r.normal_mps},
                       {"omega_rad_per_s", omega_after}}},
                     {"impulse_per_mass_mps",
                      {{"compression", r.compression_impulse_mps},
                       {"normal", r.normal_impulse_mps},
                       {"tangential", mirror * r.tangential_impulse_mps}}}};
  std::string text = fmt::format(
      "impact     {}\n"
      "phases     {}\n"
      "contact point before: along the ground {:.6g} m/s, away from it {:.6g} "
      "m/s; spin {:.6g} rad/s\n"
      "contact point after:  along the ground {:.6g} m/s, away from it {:.6g} "
      "m/s; spin {:.6g} rad/s\n"
      "impulse per mass (change of the centre's velocity): normal {:.6g} m/s, "
      "tangential {:.6g} m/s\n",
      Word(r.status), r.n_phases > 0 ? PhasesText(r) : "none", slip_before,
      p.normal_mps, omega, slip_after, r.normal_mps, omega_after,
      r.normal_impulse_mps, mirror * r.tangential_impulse_mps);
  return WriteAnswer(flags, json, text);
}

// Answers `theory flat`: forces on both edges of a rectangle that slides on one
// side, or that no solution exists.
int RunFlat(const TheoryFlags& flags) {
  if (!flags.result.cases.empty()) {
    return AnswerCases(flags.result, FlatCases);
  }
  analysis::FlatProblem p;
  p.length_m = Need(flags.flat.length_m, "--length-m");
  p.height_m = Need(flags.flat.height_m, "--height-m");
  p.mu = Need(flags.corner.mu, "--mu");
  p.mass_kg = flags.corner.mass_kg.value_or(1.0);
  p.gravity_mps2 = flags.corner.gravity_mps2;
  const analysis::FlatResult r = analysis::SolveFlatContact(p);
  Json json = {{"schema", "touchdown.theory.flat/1"},
               {"tipping", r.tipping},
               {"matrix", {{r.m_rr, r.m_rf}, {r.m_fr, r.m_ff}}},
               {"within_tolerance", r.within_tolerance},
               {"solution", nullptr}};
  std::string text = fmt::format(
      "tipping  mu b/a = {:.6g} (an edge lifts above 1)\n", r.tipping);
  if (const auto& s = r.solution) {
    json["solution"] = {
        {"feet", Name(s->feet)},     {"rear_n", s->rear_n},
        {"front_n", s->front_n},     {"tangential_n", s->tangential_n},
        {"rear_mps2", s->rear_mps2}, {"front_mps2", s->front_mps2}};
    text += fmt::format(
        "carried by {}: rear {:.6g} N, front {:.6g} N, friction {:.6g} N in "
        "all\nrising   rear {:.6g} m/s^2, front {:.6g} m/s^2\n",
        Name(s->feet), s->rear_n, s->front_n, s->tangential_n, s->rear_mps2,
        s->front_mps2);
  } else {
    text += fmt::format(
        "no solution: M_ff = {:.6g} < 0, the front edge jams (Painleve)\n",
        r.m_ff);
  }
  return WriteAnswer(flags, json, text);
}

namespace {

// Reads "1, 4/3" as numbers. Throws std::invalid_argument with the flag's name.
std::vector<double> ParseVector(const std::string& text, const char* flag) {
  std::vector<double> out;
  std::size_t start = 0;
  while (true) {
    const std::size_t comma = text.find(',', start);
    std::string entry = text.substr(start, comma - start);
    std::erase(entry, ' ');
    try {
      out.push_back(ParseFraction(entry));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("{}: {}", flag, error.what()));
    }
    if (comma == std::string::npos) return out;
    start = comma + 1;
  }
}

}  // namespace

// Answers `theory lcp`: all solutions of a small problem, up to 8 unknowns.
int RunLcp(const TheoryFlags& flags) {
  if (!flags.result.cases.empty()) {
    return AnswerCases(flags.result, LcpCases);
  }
  if (flags.lcp.m.empty() || flags.lcp.q.empty()) {
    throw std::invalid_argument(
        "--matrix and --vector are missing; give both, or --cases a file");
  }
  const std::vector<double> q = ParseVector(flags.lcp.q, "--vector");
  std::vector<double> m;
  std::size_t rows = 0;
  // Rows are parted by semicolons; each must be as long as the vector, which is
  // known already. That the matrix is square is checked by SolveLcp().
  for (std::size_t start = 0; start <= flags.lcp.m.size(); ++rows) {
    const std::size_t end =
        std::min(flags.lcp.m.find(';', start), flags.lcp.m.size());
    const auto row =
        ParseVector(flags.lcp.m.substr(start, end - start), "--matrix");
    if (row.size() != q.size()) {
      throw std::invalid_argument(
          fmt::format("--matrix: row {} has {} entries, must have {} as "
                      "--vector has",
                      rows + 1, row.size(), q.size()));
    }
    m.insert(m.end(), row.begin(), row.end());
    start = end + 1;
  }
  const analysis::LcpResult r = analysis::SolveLcp(m, q);
  Json json = {{"schema", "touchdown.theory.lcp/1"},
               {"status", Name(r.status)},
               {"n_basic_solutions", r.n_basic},
               {"n_singular_bases", r.n_singular_bases},
               {"solutions", Json::array()}};
  std::string text =
      fmt::format("status   {}, {} basic solution{}, {} singular bas{}\n",
                  Name(r.status), r.n_basic, r.n_basic == 1 ? "" : "s",
                  r.n_singular_bases, r.n_singular_bases == 1 ? "is" : "es");
  for (const analysis::LcpSolution& s : r.solutions) {
    json["solutions"].push_back(
        {{"z", s.z}, {"w", s.w}, {"residual", s.residual}, {"basic", s.basic}});
    text += fmt::format("  z = ({:.6g})   w = ({:.6g})   residual {:.1e}{}\n",
                        fmt::join(s.z, ", "), fmt::join(s.w, ", "), s.residual,
                        s.basic ? "" : "   corner of a continuum");
  }
  return WriteAnswer(flags, json, text);
}

}  // namespace touchdown::cli
