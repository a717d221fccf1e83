#include "touchdown/analysis/boundary_models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "require.h"
#include "touchdown/analysis/contact.h"
#include "touchdown/analysis/impact.h"
#include "touchdown/analysis/spin_boundary.h"

namespace touchdown::analysis {
namespace {

using core::AbsentBecause;
using core::BodyKind;
using core::kDegree;

constexpr double kRightAngle = std::numbers::pi / 2.0;

// The paper's numbers and what stands behind their last digit.
constexpr double kPublishedSphere_rad = 11.8 * kDegree;
constexpr double kPublishedRectangle_rad = 7.8 * kDegree;
constexpr double kPublishedGrain_rad = 0.1 * kDegree;

// The friction of the replication: the value of g that a program printed in the
// place of mu. 9.7417 to 9.8234 give both digits.
constexpr double kReplicationFriction = 9.8;

constexpr const char* kSphereNeverDetaches =
    "a sphere touches below its centre: A = 1/m and b = -g at every angle, "
    "spin "
    "and friction, so it never detaches (errata E5)";

bool IsSphere(const BoundaryInputs& in) { return in.body == BodyKind::kSphere; }

core::Expected<double> Spin(const BoundaryInputs& in) {
  const SpinBoundary b = SolveSpinBoundary(
      in.radius_m.value, in.omega_rad_per_s.value, in.gravity_mps2.value);
  if (b.status != SpinBoundaryStatus::kNone) return b.alpha_rad;
  if (in.omega_rad_per_s.value == 0.0) {
    return AbsentBecause("without spin b = -g < 0: slide at every angle");
  }
  return AbsentBecause(fmt::format(
      "R omega^2 = {:.4g} m/s^2 is less than g: slide at every angle",
      in.radius_m.value * in.omega_rad_per_s.value * in.omega_rad_per_s.value));
}

core::Expected<double> CorrectedLcp(const BoundaryInputs& in) {
  if (IsSphere(in)) return AbsentBecause(kSphereNeverDetaches);
  const auto spin = Spin(in);
  const double kappa = in.kappa.value;
  // On the trailing corner A_hat > 0 for every angle.
  if (in.slip != Slip::kLeading || kappa == 0.0) return spin;
  const Wedge wedge = PainleveWedge(kappa, in.mu.value);
  if (!wedge.exists) return spin;
  return spin ? std::min(*spin, wedge.low_rad) : wedge.low_rad;
}

core::Expected<double> Replication(const BoundaryInputs& in) {
  const Wedge wedge = PainleveWedge(
      IsSphere(in) ? Kappa(MassLayout::kHoop) : Kappa(MassLayout::kRectangle),
      kReplicationFriction);
  return wedge.low_rad;
}

// Where a function of alpha in (0, 90 deg] reaches 1: scanned, then bisected.
// The scan finds stretches wider than its step.
constexpr int kScanSteps = 360;  // of a quarter degree

double Bisect(const BoundaryInputs& in, double low, double high, bool rises) {
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    ((BounceRatio(in, middle) >= 1.0) == rises ? high : low) = middle;
  }
  return high;
}

std::vector<AngleRange> BounceRanges(const BoundaryInputs& in,
                                     bool only_first) {
  std::vector<AngleRange> out{{0.0, 0.0, "stays down"}};
  bool bounces = false;
  for (int i = 1; i <= kScanSteps; ++i) {
    const double alpha = kRightAngle * i / kScanSteps;
    if ((BounceRatio(in, alpha) >= 1.0) == bounces) continue;
    bounces = !bounces;
    const double edge =
        Bisect(in, kRightAngle * (i - 1) / kScanSteps, alpha, bounces);
    out.back().to_rad = edge;
    out.push_back({edge, edge, bounces ? "bounce" : "stays down"});
    if (only_first) break;
  }
  out.back().to_rad = kRightAngle;
  return out;
}

core::Expected<double> DetectableBounce(const BoundaryInputs& in) {
  if (IsSphere(in)) {
    // sin(angle) = sqrt(2 g h) / (e V)
    const double sine =
        std::sqrt(2.0 * in.gravity_mps2.value * in.bounce_height_m.value) /
        (in.restitution.value * in.speed_mps.value);
    if (sine <= 1.0) return std::asin(sine);
  } else {
    const auto ranges = BounceRanges(in, true);
    if (ranges.size() > 1) return ranges[1].from_rad;
  }
  return AbsentBecause(
      "it does not rise above the bounce height at any angle: too slow, or "
      "restitution too low");
}

void Check(const BoundaryInputs& in) {
  RequireNotNegative("kappa", in.kappa.value);
  RequirePositive("radius", in.radius_m.value, "m");
  RequireNotNegative("mu", in.mu.value);
  RequireFinite("omega", in.omega_rad_per_s.value, "rad/s");
  RequirePositive("gravity", in.gravity_mps2.value, "m/s^2");
  RequireBetween("restitution", in.restitution.value, 0.0, 1.0);
  RequirePositive("speed", in.speed_mps.value, "m/s");
  RequirePositive("bounce height", in.bounce_height_m.value, "m");
  if (!IsSphere(in) && in.slip == Slip::kNone) {
    throw std::invalid_argument(
        "corner is flush, must be leading or trailing for a boundary angle");
  }
}

// The inputs that can carry an uncertainty, and where they may lie.
struct Uncertain {
  const char* name;
  core::Estimate BoundaryInputs::*field;
  double low;
  double high;
};

constexpr double kTiny = std::numeric_limits<double>::min();
constexpr double kHuge = std::numeric_limits<double>::max();

constexpr std::array<Uncertain, 8> kUncertain = {{
    {"kappa", &BoundaryInputs::kappa, 0.0, kHuge},
    {"radius_m", &BoundaryInputs::radius_m, kTiny, kHuge},
    {"mu", &BoundaryInputs::mu, 0.0, kHuge},
    {"omega_rad_per_s", &BoundaryInputs::omega_rad_per_s, -kHuge, kHuge},
    {"gravity_mps2", &BoundaryInputs::gravity_mps2, kTiny, kHuge},
    {"restitution", &BoundaryInputs::restitution, 0.0, 1.0},
    {"speed_mps", &BoundaryInputs::speed_mps, kTiny, kHuge},
    {"bounce_height_m", &BoundaryInputs::bounce_height_m, kTiny, kHuge},
}};

// Whether the model's boundary depends on the input at all.
bool Uses(BoundaryModel model, const BoundaryInputs& in,
          const Uncertain& what) {
  using Field = core::Estimate BoundaryInputs::*;
  const Field f = what.field;
  const bool of_spin = f == &BoundaryInputs::radius_m ||
                       f == &BoundaryInputs::omega_rad_per_s ||
                       f == &BoundaryInputs::gravity_mps2;
  const bool of_corner =
      f == &BoundaryInputs::kappa || f == &BoundaryInputs::mu;
  switch (model) {
    case BoundaryModel::kPublished:
    case BoundaryModel::kPaperReplication:
      return false;
    case BoundaryModel::kPrintedEquations:
      return of_spin;
    case BoundaryModel::kCorrectedLcp:
      return !IsSphere(in) &&
             (of_spin || (of_corner && in.slip == Slip::kLeading));
    case BoundaryModel::kDetectableBounce:
      break;
  }
  const bool of_rectangle = of_corner || f == &BoundaryInputs::radius_m;
  return f != &BoundaryInputs::omega_rad_per_s &&
         !(IsSphere(in) && of_rectangle);
}

core::Expected<double> WithShift(BoundaryModel model, BoundaryInputs in,
                                 const Uncertain& what, double shift) {
  double& value = (in.*what.field).value;
  value = std::clamp(value + shift, what.low, what.high);
  return BoundaryAngle(model, in);
}

// A boundary of spin goes as the square root of w - 1, w = R omega^2/g: first
// order needs w - 1 > 10 u(w).
bool IsFarFromThreshold(BoundaryModel model, const BoundaryInputs& in,
                        double boundary_rad) {
  if (model == BoundaryModel::kDetectableBounce) return true;
  const auto spin = Spin(in);
  if (!spin || *spin != boundary_rad) return true;
  const auto relative = [](const core::Estimate& e) { return e.u / e.value; };
  const double w = in.radius_m.value * in.omega_rad_per_s.value *
                   in.omega_rad_per_s.value / in.gravity_mps2.value;
  const double u_w =
      w * std::hypot(relative(in.radius_m), 2.0 * relative(in.omega_rad_per_s),
                     relative(in.gravity_mps2));
  constexpr double kSafety = 10.0;
  return w - 1.0 > kSafety * u_w;
}

// First order by central differences over u/10, which is as far from rounding
// as from curvature; and whether the slope survives 3 u.
void PropagateFirstOrder(BoundaryModel model, const BoundaryInputs& in,
                         BoundaryAnswer& out) {
  double variance = 0.0;
  bool valid = true;
  for (const Uncertain& what : kUncertain) {
    const double u = (in.*what.field).u;
    if (u == 0.0 || !Uses(model, in, what)) continue;
    const double step = 0.1 * u;
    const auto up = WithShift(model, in, what, step);
    const auto down = WithShift(model, in, what, -step);
    if (!up || !down) {
      valid = false;
      continue;
    }
    const double slope = (*up - *down) / (2.0 * step);
    out.sensitivities.push_back({what.name, slope, std::abs(slope) * u});
    variance += slope * u * slope * u;
    for (const double reach : {3.0 * u, -3.0 * u}) {
      const auto far = WithShift(model, in, what, reach);
      valid = valid && far &&
              std::abs(*far - *out.boundary_rad - slope * reach) <=
                  0.5 * std::abs(slope * reach);
    }
  }
  out.uncertainty.first_order_u_rad = std::sqrt(variance);
  out.uncertainty.first_order_is_valid =
      valid && IsFarFromThreshold(model, in, *out.boundary_rad);
}

void PropagateByDraws(BoundaryModel model, const BoundaryInputs& in,
                      std::mt19937_64& engine, int n_draws,
                      BoundaryUncertainty& out) {
  std::normal_distribution<double> normal;
  std::vector<double> angles;
  angles.reserve(static_cast<std::size_t>(n_draws));
  for (int i = 0; i < n_draws; ++i) {
    BoundaryInputs drawn = in;
    for (const Uncertain& what : kUncertain) {
      core::Estimate& e = drawn.*what.field;
      if (e.u == 0.0 || !Uses(model, in, what)) continue;
      // What cannot be (a negative friction) is drawn again.
      double value = 0.0;
      do {
        value = (in.*what.field).value + e.u * normal(engine);
      } while (!(value >= what.low && value <= what.high));
      e.value = value;
    }
    if (const auto angle = BoundaryAngle(model, drawn)) {
      angles.push_back(*angle);
    }
  }
  out.n_draws = n_draws;
  out.p_none = 1.0 - static_cast<double>(angles.size()) / n_draws;
  constexpr std::size_t kFew = 100;  // too few for a 2.5 % quantile
  if (angles.size() < kFew) return;
  std::sort(angles.begin(), angles.end());
  double sum = 0.0;
  for (const double a : angles) sum += a;
  const double n = static_cast<double>(angles.size());
  const double mean = sum / n;
  double square = 0.0;
  for (const double a : angles) square += (a - mean) * (a - mean);
  const auto quantile = [&](double p) {
    const double position = p * (n - 1.0);
    const auto i = static_cast<std::size_t>(position);
    const std::size_t j = std::min(i + 1, angles.size() - 1);
    return std::lerp(angles[i], angles[j], position - std::floor(position));
  };
  out.mean_rad = mean;
  out.u_rad = std::sqrt(square / (n - 1.0));
  out.low_rad = quantile(0.025);
  out.high_rad = quantile(0.975);
}

bool HasUncertainty(BoundaryModel model, const BoundaryInputs& in) {
  bool any = false;
  for (const Uncertain& what : kUncertain) {
    const double u = (in.*what.field).u;
    RequireNotNegative(std::string("u of ") + what.name, u);
    any = any || (u > 0.0 && Uses(model, in, what));
  }
  return any;
}

// Stretches of angle between the given edges, named by the contact problem in
// their middle.
std::vector<AngleRange> ContactRanges(const BoundaryInputs& in, double kappa,
                                      double mu, Slip slip,
                                      std::vector<double> edges) {
  edges.push_back(0.0);
  edges.push_back(kRightAngle);
  std::sort(edges.begin(), edges.end());
  std::vector<AngleRange> out;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    if (edges[i + 1] <= edges[i]) continue;
    ContactProblem p;
    p.alpha = RoundedSinCosOfRadians(0.5 * (edges[i] + edges[i + 1]));
    p.mu = mu;
    p.slip = slip;
    p.radius_m = in.radius_m.value;
    p.kappa = kappa;
    p.omega_rad_per_s = in.omega_rad_per_s.value;
    p.gravity_mps2 = in.gravity_mps2.value;
    std::string state;
    switch (SolveSlidingContact(p).regime) {
      case Regime::kSlide:
        state = "slide";
        break;
      case Regime::kDetach:
        state = "detach";
        break;
      case Regime::kIndeterminate:
        state = "detach, or slide unstably (two solutions)";
        break;
      case Regime::kInconsistent:
        state = "no solution: impact without collision";
        break;
      default:
        state = "on an edge within rounding";
    }
    out.push_back({edges[i], edges[i + 1], state});
  }
  return out;
}

std::vector<AngleRange> RangesOf(BoundaryModel model, const BoundaryInputs& in,
                                 const core::Expected<double>& boundary) {
  switch (model) {
    case BoundaryModel::kPublished:
      return {{0.0, *boundary, "slide"}, {*boundary, kRightAngle, "bounce"}};
    case BoundaryModel::kPrintedEquations: {
      if (!boundary) return {{0.0, kRightAngle, "slide"}};
      return {{0.0, *boundary, "slide"}, {*boundary, kRightAngle, "detach"}};
    }
    case BoundaryModel::kCorrectedLcp: {
      if (IsSphere(in)) return {{0.0, kRightAngle, "slide or roll"}};
      std::vector<double> edges;
      if (const auto spin = Spin(in)) edges.push_back(*spin);
      if (in.slip == Slip::kLeading && in.kappa.value > 0.0) {
        const Wedge wedge = PainleveWedge(in.kappa.value, in.mu.value);
        if (wedge.exists) {
          edges.push_back(wedge.low_rad);
          edges.push_back(wedge.high_rad);
        }
      }
      return ContactRanges(in, in.kappa.value, in.mu.value, in.slip, edges);
    }
    case BoundaryModel::kPaperReplication: {
      const Wedge wedge =
          PainleveWedge(IsSphere(in) ? Kappa(MassLayout::kHoop)
                                     : Kappa(MassLayout::kRectangle),
                        kReplicationFriction);
      return {{0.0, wedge.low_rad, "slide"},
              {wedge.low_rad, wedge.high_rad,
               "no solution, which the paper calls bounce"},
              {wedge.high_rad, kRightAngle, "slide"}};
    }
    case BoundaryModel::kDetectableBounce:
      break;
  }
  return BounceRanges(in, false);
}

std::vector<std::string> NotesOf(BoundaryModel model,
                                 const BoundaryInputs& in) {
  std::vector<std::string> out;
  const bool spins = in.omega_rad_per_s.value != 0.0;
  switch (model) {
    case BoundaryModel::kPublished:
      out.push_back(IsSphere(in) ? "the paper's trials place it between 11.8 "
                                   "and 27.4 deg, no finer"
                                 : "the paper's trials place it between 7.8 "
                                   "and 11.8 deg, no finer");
      if (spins) out.push_back("the paper gives no number for a spinning body");
      break;
    case BoundaryModel::kPrintedEquations:
      if (IsSphere(in)) {
        out.push_back(
            "the printed equations treat the contact point as fixed to the "
            "body; a sphere's is not, see corrected-lcp (errata E5, E16)");
      }
      if (!IsSphere(in) && in.slip == Slip::kLeading) {
        out.push_back(
            "the printed friction holds for a trailing corner; this body lands "
            "on its leading one (errata E2)");
      }
      break;
    case BoundaryModel::kCorrectedLcp:
      if (!IsSphere(in)) {
        out.push_back(
            "omega is the spin after the impact: an eccentric impact makes "
            "spin "
            "where there was none (errata E9)");
      }
      break;
    case BoundaryModel::kPaperReplication:
      out.push_back(
          "a replication of the paper's digits, not physics: mu = 9.8 is the "
          "value of g");
      break;
    case BoundaryModel::kDetectableBounce:
      if (spins) {
        out.push_back("spin before the impact is left out of this model");
      }
      break;
  }
  return out;
}

}  // namespace

double BounceRatio(const BoundaryInputs& in, double alpha_rad) {
  const SinCos alpha = RoundedSinCosOfRadians(alpha_rad);
  const double g = in.gravity_mps2.value;
  const double v = in.speed_mps.value;
  double rise_mps = in.restitution.value * v * alpha.sin;
  double lift_mps2 = 0.0;
  if (!IsSphere(in)) {
    ImpactProblem p;
    p.alpha = alpha;
    p.radius_m = in.radius_m.value;
    p.kappa = in.kappa.value;
    p.mu = in.mu.value;
    p.restitution = in.restitution.value;
    p.tangential_mps = Sign(in.slip) * v * alpha.cos;
    p.normal_mps = -v * alpha.sin;
    const ImpactResult after = Impact(p);
    rise_mps = after.normal_mps;
    lift_mps2 = p.radius_m * after.alpha_rate_rad_per_s *
                after.alpha_rate_rad_per_s * alpha.sin;
  }
  if (lift_mps2 >= g) return std::numeric_limits<double>::infinity();
  return rise_mps * rise_mps /
         (2.0 * (g - lift_mps2) * in.bounce_height_m.value);
}

core::Expected<double> BoundaryAngle(BoundaryModel model,
                                     const BoundaryInputs& inputs) {
  Check(inputs);
  switch (model) {
    case BoundaryModel::kPublished:
      return IsSphere(inputs) ? kPublishedSphere_rad : kPublishedRectangle_rad;
    case BoundaryModel::kPrintedEquations:
      return Spin(inputs);
    case BoundaryModel::kCorrectedLcp:
      return CorrectedLcp(inputs);
    case BoundaryModel::kPaperReplication:
      return Replication(inputs);
    case BoundaryModel::kDetectableBounce:
      break;
  }
  return DetectableBounce(inputs);
}

BoundaryAnswer EvaluateBoundary(BoundaryModel model,
                                const BoundaryInputs& inputs,
                                std::mt19937_64& engine,
                                const BoundaryOptions& options) {
  if (options.n_draws < 1) {
    throw std::invalid_argument(fmt::format(
        "number of draws is {}, must be at least 1", options.n_draws));
  }
  BoundaryAnswer out;
  out.model = model;
  out.angle_kind = AngleKindOf(model, inputs.body);
  out.boundary_rad = BoundaryAngle(model, inputs);
  out.ranges = RangesOf(model, inputs, out.boundary_rad);
  out.notes = NotesOf(model, inputs);
  if (model == BoundaryModel::kPublished) {
    // Rectangular within the last printed digit.
    out.uncertainty.first_order_u_rad = kPublishedGrain_rad / std::sqrt(12.0);
    out.uncertainty.first_order_is_valid = true;
    return out;
  }
  if (!HasUncertainty(model, inputs)) {
    out.uncertainty.first_order_is_valid = out.boundary_rad.has_value();
    return out;
  }
  if (out.boundary_rad) PropagateFirstOrder(model, inputs, out);
  PropagateByDraws(model, inputs, engine, options.n_draws, out.uncertainty);
  return out;
}

core::Measured BoundaryAnswer::Value() const {
  if (!boundary_rad) return AbsentBecause(boundary_rad.error().reason);
  core::Estimate out{*boundary_rad, uncertainty.first_order_u_rad,
                     std::nullopt};
  if (!uncertainty.first_order_is_valid && uncertainty.u_rad) {
    out.u = *uncertainty.u_rad;
    out.interval95 =
        core::Interval{*uncertainty.low_rad, *uncertainty.high_rad};
  }
  return out;
}

core::AngleKind AngleKindOf(BoundaryModel model, core::BodyKind body) {
  // The contact problem speaks of the radius; for a sphere only the path's
  // angle can vary (errata E5).
  if (body == BodyKind::kSphere && model != BoundaryModel::kPrintedEquations) {
    return core::AngleKind::kApproach;
  }
  return core::AngleKind::kRadius;
}

}  // namespace touchdown::analysis
