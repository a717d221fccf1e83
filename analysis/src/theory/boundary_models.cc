#include "touchdown/analysis/theory/boundary_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "theory/boundary_uncertainty.h"
#include "touchdown/analysis/theory/contact.h"
#include "touchdown/analysis/theory/impact.h"
#include "touchdown/analysis/theory/spin_boundary.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

using core::AbsentBecause;
using core::AngleKind;
using core::kDegree;

// rad: 90 deg.
constexpr double kRightAngle = std::numbers::pi / 2.0;

// The paper's numbers and what stands behind their last digit.
constexpr double kPublishedSphere_rad = 11.8 * kDegree;
constexpr double kPublishedRectangle_rad = 7.8 * kDegree;
constexpr double kPublishedGrain_rad = 0.1 * kDegree;

// The friction of the replication: the value of g that a program printed in the
// place of mu. 9.7417 to 9.8234 give both digits.
constexpr double kReplicationFriction = 9.8;

// Reason of the two models in which a sphere has no boundary.
constexpr const char* kSphereNeverDetaches =
    "a sphere touches below its centre: A = 1/m and b = -g at every angle, "
    "spin "
    "and friction, so it never detaches (errata E5)";

core::Expected<double> CorrectedLcp(const BoundaryInputs& in) {
  if (IsSphere(in)) return AbsentBecause(kSphereNeverDetaches);
  auto spin = SpinAngle(in);
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
constexpr double kFlattest_rad = 1e-6;

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
  // A held angle may bounce at the flattest of the other.
  bool bounces = BounceRatio(in, kFlattest_rad) >= 1.0;
  std::vector<AngleRange> out{{0.0, 0.0, bounces ? "bounce" : "stays down"}};
  for (int i = 1; i <= kScanSteps; ++i) {
    const double alpha = kRightAngle * i / kScanSteps;
    if ((BounceRatio(in, alpha) >= 1.0) == bounces) continue;
    bounces = !bounces;
    const double edge =
        Bisect(in, kRightAngle * (i - 1) / kScanSteps, alpha, bounces);
    out.back().to_rad = edge;
    out.push_back({edge, edge, bounces ? "bounce" : "stays down"});
    if (only_first && bounces) break;
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
    if (ranges.size() > 1 && ranges.back().state == "bounce") {
      return ranges.back().from_rad;
    }
    if (ranges.front().state == "bounce") {
      return AbsentBecause(fmt::format(
          "it bounces from the flattest {} angle on, and never begins to",
          core::Name(ModelAngleKind(BoundaryModel::kDetectableBounce, in))));
    }
  }
  return AbsentBecause(
      "it does not rise above the bounce height at any angle: too slow, or "
      "restitution too low");
}

void CheckBoundaryInputs(const BoundaryInputs& in) {
  core::RequireNotNegative("kappa", in.kappa.value);
  core::RequirePositive("radius", in.radius_m.value, "m");
  core::RequireNotNegative("mu", in.mu.value);
  core::RequireFinite("omega", in.omega_rad_per_s.value, "rad/s");
  core::RequirePositive("gravity", in.gravity_mps2.value, "m/s^2");
  core::RequireInRange("restitution", in.restitution.value, 0.0, 1.0);
  core::RequirePositive("speed", in.speed_mps.value, "m/s");
  core::RequirePositive("bounce height", in.bounce_height_m.value, "m");
  if (!IsSphere(in) && in.slip == Slip::kNone) {
    throw std::invalid_argument(
        "corner is flush, must be leading or trailing for a boundary angle");
  }
  if (in.held_kind == AngleKind::kFace) {
    throw std::invalid_argument(
        "held angle is a face angle, must be an approach or a radius angle");
  }
  if (in.held_kind) {
    core::RequireInRange("held angle in rad", in.held_angle_rad.value, 0.0,
                         kRightAngle);
  }
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

std::vector<AngleRange> ListRanges(BoundaryModel model,
                                   const BoundaryInputs& in,
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
      if (const auto spin = SpinAngle(in)) edges.push_back(*spin);
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

std::vector<std::string> MakeNotes(BoundaryModel model,
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
      if (!IsSphere(in) && !in.held_kind) {
        out.push_back(
            "approach and radius angle are taken as equal, as in the paper; a "
            "throw has both: hold the one that the campaign does not vary");
      }
      break;
  }
  return out;
}

}  // namespace

core::Expected<double> SpinAngle(const BoundaryInputs& in) {
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

double BounceRatio(const BoundaryInputs& in, double angle_rad) {
  const auto angle = [&](AngleKind kind) {
    const bool held = !IsSphere(in) && in.held_kind == kind;
    return RoundedSinCosOfRadians(held ? in.held_angle_rad.value : angle_rad);
  };
  const SinCos alpha = angle(AngleKind::kRadius);
  const SinCos approach = angle(AngleKind::kApproach);
  const double g = in.gravity_mps2.value;
  const double v = in.speed_mps.value;
  double rise_mps = in.restitution.value * v * approach.sin;
  double lift_mps2 = 0.0;
  if (!IsSphere(in)) {
    ImpactProblem p;
    p.alpha = alpha;
    p.radius_m = in.radius_m.value;
    p.kappa = in.kappa.value;
    p.mu = in.mu.value;
    p.restitution = in.restitution.value;
    p.tangential_mps = Sign(in.slip) * v * approach.cos;
    p.normal_mps = -v * approach.sin;
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
  CheckBoundaryInputs(inputs);
  switch (model) {
    case BoundaryModel::kPublished:
      return IsSphere(inputs) ? kPublishedSphere_rad : kPublishedRectangle_rad;
    case BoundaryModel::kPrintedEquations:
      return SpinAngle(inputs);
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
  out.angle_kind = ModelAngleKind(model, inputs);
  out.boundary_rad = BoundaryAngle(model, inputs);
  out.ranges = ListRanges(model, inputs, out.boundary_rad);
  out.notes = MakeNotes(model, inputs);
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

core::AngleKind ModelAngleKind(BoundaryModel model,
                               const BoundaryInputs& inputs) {
  // The contact problem speaks of the radius; for a sphere only the path's
  // angle can vary (errata E5).
  const bool sphere = IsSphere(inputs);
  if (sphere && model != BoundaryModel::kPrintedEquations) {
    return core::AngleKind::kApproach;
  }
  if (!sphere && model == BoundaryModel::kDetectableBounce &&
      inputs.held_kind == AngleKind::kRadius) {
    return core::AngleKind::kApproach;
  }
  return core::AngleKind::kRadius;
}

}  // namespace touchdown::analysis
