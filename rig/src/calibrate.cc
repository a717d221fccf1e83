#include "touchdown/rig/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "touchdown/core/require.h"

namespace touchdown::rig {
namespace {

// One equation y = a[0] p[0] + a[1] p[1] with standard deviation `sigma`.
struct Row {
  std::array<double, 2> a{};
  double y = 0.0;
  double sigma = 1.0;
};

struct LineFit {
  std::array<double, 2> p{};
  std::array<double, 2> u{};
  double covariance = 0.0;
  double residual = 0.0;  // sqrt(sum r^2 / dof), unweighted
  double chi2_per_dof = 0.0;
  std::size_t dof = 0;
};

// Weighted least squares in 1 or 2 unknowns by orthogonalizing the columns
// (modified Gram-Schmidt): no normal equations, whose condition is squared.
// Nothing where the columns are dependent.
std::optional<LineFit> Solve(const std::vector<Row>& rows, std::size_t unknowns,
                             bool sigma_known) {
  const auto weighted_dot = [&](auto&& f, auto&& g) {
    double sum = 0.0;
    for (const Row& r : rows) sum += f(r) * g(r) / (r.sigma * r.sigma);
    return sum;
  };
  const auto a0 = [](const Row& r) { return r.a[0]; };
  const auto a1 = [](const Row& r) { return r.a[1]; };
  const auto y = [](const Row& r) { return r.y; };
  const double r00 = weighted_dot(a0, a0);
  if (!(r00 > 0.0)) return std::nullopt;
  LineFit fit;
  fit.dof = rows.size() - unknowns;
  double var1 = 0.0;
  double shear = 0.0;
  if (unknowns == 2) {
    shear = weighted_dot(a0, a1) / r00;
    const auto q1 = [&](const Row& r) { return r.a[1] - shear * r.a[0]; };
    const double r11 = weighted_dot(q1, q1);
    constexpr double kDependent = 1e-20;  // of the column's square: eps^2-like
    if (!(r11 > kDependent * weighted_dot(a1, a1))) return std::nullopt;
    fit.p[1] = weighted_dot(q1, y) / r11;
    var1 = 1.0 / r11;
  }
  const double p1 = fit.p[1];
  const auto rest = [&](const Row& r) { return r.y - p1 * r.a[1]; };
  fit.p[0] = weighted_dot(a0, rest) / r00;
  double chi2 = 0.0;
  double squares = 0.0;
  for (const Row& r : rows) {
    const double residual = r.y - fit.p[0] * r.a[0] - fit.p[1] * r.a[1];
    squares += residual * residual;
    chi2 += residual * residual / (r.sigma * r.sigma);
  }
  const auto dof = static_cast<double>(fit.dof);
  fit.residual = std::sqrt(squares / dof);
  fit.chi2_per_dof = chi2 / dof;
  const double scale =
      sigma_known ? std::fmax(1.0, fit.chi2_per_dof) : fit.chi2_per_dof;
  fit.u[1] = std::sqrt(scale * var1);
  fit.u[0] = std::sqrt(scale * (1.0 / r00 + shear * shear * var1));
  fit.covariance = -scale * shear * var1;
  return fit;
}

// True where all points bear a u, false where none does; throws otherwise.
template <class Points, class Value>
bool AllBearU(const Points& points, const char* field, Value value) {
  std::size_t with = 0;
  for (const auto& point : points) {
    core::RequireFinite("compression_m", point.compression_m);
    core::RequireFinite(field, value(point).value);
    core::RequireNotNegative("u", value(point).u);
    with += value(point).u > 0.0 ? 1 : 0;
  }
  if (with != 0 && with != points.size()) {
    core::Refuse("number of points with u > 0", static_cast<double>(with),
                 "none or all of them");
  }
  return with != 0;
}

core::Estimate WithStudent(double value, double u, std::size_t dof) {
  const double half = StudentT975(dof) * u;
  return {value, u, core::Interval{value - half, value + half}};
}

void WarnOfScatter(const LineFit& fit, bool sigma_known,
                   std::vector<Finding>& findings) {
  constexpr double kScatter = 4.0;  // chi^2/dof: twice the claimed u
  if (sigma_known && fit.chi2_per_dof > kScatter) {
    findings.push_back(
        {Severity::kWarning,
         fmt::format("the points scatter {:.2g} times as much as their u says; "
                     "the fit's u is enlarged by that",
                     std::sqrt(fit.chi2_per_dof))});
  }
}

// t value of a quadratic term added to the line; 0 with too few points.
double CurvatureT(const std::vector<Row>& rows, bool sigma_known) {
  // Points: three parameters, and two degrees of freedom for their scatter.
  constexpr std::size_t kMinForCurvature = 5;
  if (rows.size() < kMinForCurvature) return 0.0;
  // Residuals of y and of x^2 after constant and slope, then one unknown.
  std::vector<Row> square = rows;
  for (Row& r : square) r.y = r.a[0] * r.a[0];
  const auto line = Solve(rows, 2, sigma_known);
  const auto bend = Solve(square, 2, sigma_known);
  if (!line || !bend) return 0.0;
  std::vector<Row> rest;
  rest.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto residual = [&](const Row& r, const LineFit& f) {
      return r.y - f.p[0] * r.a[0] - f.p[1] * r.a[1];
    };
    rest.push_back({{residual(square[i], *bend), 0.0},
                    residual(rows[i], *line),
                    rows[i].sigma});
  }
  const auto fit = Solve(rest, 1, true);
  if (!fit) return 0.0;
  // Solve counts one unknown; the line took two more.
  const auto dof = static_cast<double>(rows.size() - 3);
  const double chi2_per_dof =
      fit->chi2_per_dof * static_cast<double>(fit->dof) / dof;
  const double u_per_scale =
      fit->u[0] / std::sqrt(std::fmax(1.0, fit->chi2_per_dof));
  const double scale =
      sigma_known ? std::fmax(1.0, chi2_per_dof) : chi2_per_dof;
  return scale > 0.0 ? fit->p[0] / (u_per_scale * std::sqrt(scale)) : 0.0;
}

}  // namespace

double StudentT975(std::size_t dof) {
  if (dof < 1) core::Refuse("dof", 0.0, "at least 1");
  constexpr double kTail = 0.05;  // both sides together
  // Closed forms for one and two degrees of freedom; else Hill's series (Comm.
  // ACM 13, 1970, algorithm 396).
  constexpr double kHalfPi = std::numbers::pi / 2.0;
  if (dof == 1) return 1.0 / std::tan(kTail * kHalfPi);
  if (dof == 2) return std::sqrt(2.0 / (kTail * (2.0 - kTail)) - 2.0);
  const auto n = static_cast<double>(dof);
  const double a = 1.0 / (n - 0.5);
  const double b = 48.0 / (a * a);
  double c = ((20700.0 * a / b - 98.0) * a - 16.0) * a + 96.36;
  const double d =
      ((94.5 / (b + c) - 3.0) / b + 1.0) * std::sqrt(a * kHalfPi) * n;
  double y = std::pow(d * kTail, 2.0 / n);
  if (y > 0.05 + a) {
    double x = -core::kNormal975;
    y = x * x;
    if (dof < 5) c += 0.3 * (n - 4.5) * (x + 0.6);
    c += (((0.05 * d * x - 5.0) * x - 7.0) * x - 2.0) * x + b;
    y = (((((0.4 * y + 6.3) * y + 36.0) * y + 94.5) / c - y - 3.0) / b + 1.0) *
        x;
    y = a * y * y;
    y = y > 0.002 ? std::expm1(y) : 0.5 * y * y + y;
  } else {
    y = ((1.0 / (((n + 6.0) / (n * y) - 0.089 * d - 0.822) * (n + 2.0) * 3.0) +
          0.5 / (n + 4.0)) *
             y -
         1.0) *
            (n + 1.0) / (n + 2.0) +
        1.0 / y;
  }
  return std::sqrt(n * y);
}

core::Expected<StiffnessFit> FitStiffness(std::span<const ForcePoint> points,
                                          const StiffnessFitOptions& options) {
  core::RequireNotNegative("u_compression_m", options.u_compression_m);
  const bool u_given = AllBearU(points, "force_n",
                                [](const ForcePoint& p) { return p.force_n; });

  // Points: two parameters, and one degree of freedom for their scatter.
  constexpr std::size_t kMinPoints = 3;
  if (points.size() < kMinPoints) {
    return core::AbsentBecause(
        fmt::format("{} points, a line with its uncertainty needs {}",
                    points.size(), kMinPoints));
  }
  const bool sigma_known = u_given || options.u_compression_m > 0.0;
  std::vector<Row> rows;
  rows.reserve(points.size());
  for (const ForcePoint& p : points) {
    rows.push_back(
        {{p.compression_m, 1.0}, p.force_n.value, u_given ? p.force_n.u : 1.0});
  }
  auto fit = Solve(rows, 2, sigma_known);
  if (fit && options.u_compression_m > 0.0) {
    // Effective variance u_F^2 + (H u_X)^2; H hardly moves: two rounds do.
    for (int round = 0; round < 2 && fit; ++round) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].sigma = std::hypot(u_given ? points[i].force_n.u : 0.0,
                                   fit->p[0] * options.u_compression_m);
        if (!(rows[i].sigma > 0.0)) rows[i].sigma = 1.0;
      }
      fit = Solve(rows, 2, sigma_known);
    }
  }
  if (!fit) return core::AbsentBecause("all compressions are equal");
  if (!(fit->p[0] > 0.0)) {
    return core::AbsentBecause(fmt::format(
        "the fitted stiffness is {:.4g} N/m: forces do not grow with the "
        "compression",
        fit->p[0]));
  }
  StiffnessFit out;
  out.dof = fit->dof;
  out.stiffness_n_per_m = WithStudent(fit->p[0], fit->u[0], fit->dof);
  out.force_at_zero_n = WithStudent(fit->p[1], fit->u[1], fit->dof);
  out.residual_n = fit->residual;
  const double product = fit->u[0] * fit->u[1];
  out.correlation = product > 0.0 ? fit->covariance / product : 0.0;
  WarnOfScatter(*fit, sigma_known, out.findings);
  constexpr double kCurved = 3.0;  // one false alarm in some hundred fits
  if (const double t = CurvatureT(rows, sigma_known); std::abs(t) > kCurved) {
    out.findings.push_back(
        {Severity::kWarning,
         fmt::format(
             "the characteristic is curved (quadratic term {:.1f} times "
             "its u): {}",
             t,
             t > 0.0 ? "coils close early, measure at less compression"
                     : "the spring softens: buckling or friction")});
  }
  return out;
}

core::Expected<EfficiencyFit> FitEfficiency(
    std::span<const SpeedPoint> points, const Launch& launch,
    const EfficiencyFitOptions& options) {
  core::RequireNotNegative("u_stiffness_rel", options.u_stiffness_rel);
  core::RequireNotNegative("u_mass_rel", options.u_mass_rel);
  const bool sigma_known = AllBearU(
      points, "speed_mps", [](const SpeedPoint& p) { return p.speed_mps; });
  for (const SpeedPoint& p : points) {
    core::RequirePositive("compression_m", p.compression_m);
    core::RequirePositive("speed_mps", p.speed_mps.value);
  }
  (void)SolveCompression(launch, 0.0);  // refuses an impossible launch by name
  const std::size_t unknowns = options.losses == LossModel::kNone ? 1 : 2;
  if (points.size() <= unknowns) {
    return core::AbsentBecause(
        fmt::format("{} points, {} unknowns with their uncertainty need {}",
                    points.size(), unknowns, unknowns + 1));
  }
  const double moving_kg = launch.mass_kg + launch.spring_mass_kg / 3.0;
  const double lifted_kg = launch.mass_kg + launch.spring_mass_kg / 2.0;
  const double g = launch.gravity_mps2;
  const double normal_n = launch.mass_kg * g * std::cos(launch.elevation_rad);
  std::vector<Row> rows;
  rows.reserve(points.size());
  for (const SpeedPoint& p : points) {
    const double x = p.compression_m;
    const double v = p.speed_mps.value;
    Row row;
    row.y = v * v + 2.0 * lifted_kg * g * std::sin(launch.elevation_rad) * x /
                        moving_kg;
    row.a[0] = x * (x + 2.0 * launch.preload_m);
    if (options.losses == LossModel::kPerShot) row.a[1] = -2.0 / moving_kg;
    if (options.losses == LossModel::kFriction) {
      row.a[1] = -2.0 * normal_n * x / moving_kg;
    }
    if (sigma_known) row.sigma = 2.0 * v * p.speed_mps.u;
    rows.push_back(row);
  }
  const auto fit = Solve(rows, unknowns, sigma_known);
  if (!fit) {
    return core::AbsentBecause(
        "the compressions are too much alike to part efficiency and losses");
  }
  if (!(fit->p[0] > 0.0)) {
    return core::AbsentBecause(fmt::format(
        "v^2 falls as the compression grows (slope {:.4g} 1/s^2)", fit->p[0]));
  }
  EfficiencyFit out;
  out.dof = fit->dof;
  out.slope_per_s2 = fit->p[0];
  out.residual_m2_per_s2 = fit->residual;
  const double effective = fit->p[0] * moving_kg;
  const double u_slope_rel = fit->u[0] / fit->p[0];
  out.effective_stiffness_n_per_m = WithStudent(
      effective, effective * std::hypot(u_slope_rel, options.u_mass_rel),
      fit->dof);
  const double eta = effective / launch.stiffness_n_per_m;
  out.efficiency = WithStudent(eta,
                               eta * std::hypot(u_slope_rel, options.u_mass_rel,
                                                options.u_stiffness_rel),
                               fit->dof);
  core::Estimate second = WithStudent(fit->p[1], fit->u[1], fit->dof);
  if (options.losses == LossModel::kPerShot) out.loss_j = second;
  if (options.losses == LossModel::kFriction) out.barrel_friction = second;
  WarnOfScatter(*fit, sigma_known, out.findings);
  if (eta > 1.0) {
    out.findings.push_back(
        {Severity::kWarning,
         fmt::format("efficiency {:.4g} is above 1: check the stiffness (kind "
                     "of coil diameter), the masses and the speeds",
                     eta)});
  }
  if (unknowns == 2 && fit->p[1] < 0.0) {
    out.findings.push_back(
        {Severity::kWarning,
         fmt::format("the fitted loss is negative ({:.3g} +- {:.2g}): no loss "
                     "is seen, or the zero of the compression is off",
                     fit->p[1], fit->u[1])});
  }
  return out;
}

}  // namespace touchdown::rig
