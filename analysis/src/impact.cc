#include "touchdown/analysis/impact.h"

#include <cmath>
#include <limits>

#include "require.h"

namespace touchdown::analysis {
namespace {

// How velocities change per unit of normal impulse in one phase.
struct Slopes {
  double ratio = 0.0;  // r = dT/dP
  double normal = 0.0;
  double tangential = 0.0;
};

class Marcher {
 public:
  explicit Marcher(const ImpactProblem& problem)
      : p_(problem),
        g_(DelassusOf(problem.alpha, problem.kappa)),
        slip_(SlipOf(problem.tangential_mps)) {
    result_.tangential_mps = p_.tangential_mps;
    result_.normal_mps = p_.normal_mps;
    result_.alpha_rate_rad_per_s = p_.alpha_rate_rad_per_s;
  }

  ImpactResult Run() {
    if (p_.normal_mps < 0.0) {
      result_.status = ImpactStatus::kCollision;
    } else if (p_.normal_mps == 0.0 && IsInconsistentSlip()) {
      result_.status = ImpactStatus::kWithoutCollision;
    } else {
      return result_;
    }
    if (slip_ == Slip::kNone) LeaveSlip();
    Compress();
    Restitute();
    const double s = p_.alpha.sin;
    const double c = p_.alpha.cos;
    result_.alpha_rate_rad_per_s -=
        p_.kappa *
        (c * result_.normal_impulse_mps + s * result_.tangential_impulse_mps) /
        p_.radius_m;
    return result_;
  }

 private:
  bool IsInconsistentSlip() const {
    return slip_ != Slip::kNone &&
           SlidingResponse(p_.alpha, p_.kappa, p_.mu, slip_) <= 0.0;
  }

  Slopes Now() const {
    if (sticks_) {
      // Exactly det G / G_TT: written so, it cannot lose digits.
      return {-g_.nt / g_.tt, (1.0 + p_.kappa) / g_.tt, 0.0};
    }
    const double ratio = -Sign(slip_) * p_.mu;
    return {ratio, SlidingResponse(p_.alpha, p_.kappa, p_.mu, slip_),
            std::fma(g_.tt, ratio, g_.nt)};
  }

  // v_T has reached 0: P sticks, or slips the way G_NT pushes it.
  void LeaveSlip() {
    result_.tangential_mps = 0.0;
    sticks_ = std::abs(g_.nt) <= p_.mu * g_.tt;
    slip_ = sticks_ ? Slip::kNone : SlipOf(g_.nt);
  }

  // Normal impulse after which the present slip stops.
  double ImpulseToStop(const Slopes& slopes) const {
    if (sticks_ || slopes.tangential * result_.tangential_mps >= 0.0) {
      return std::numeric_limits<double>::infinity();
    }
    return -result_.tangential_mps / slopes.tangential;
  }

  void Advance(const Slopes& slopes, double impulse, bool compression) {
    result_.normal_impulse_mps += impulse;
    result_.tangential_impulse_mps += slopes.ratio * impulse;
    result_.normal_mps += slopes.normal * impulse;
    result_.tangential_mps += slopes.tangential * impulse;
    result_.phase[static_cast<std::size_t>(result_.n_phases++)] = {
        slip_, compression, impulse};
  }

  void Compress() {
    Slopes slopes = Now();
    double stop = ImpulseToStop(slopes);
    // The impulse to v_N = 0. In the wedge (slope <= 0) slip cannot bring it
    // there and has to stop first; it does, because then mu G_TT > G_NT slip.
    double end = slopes.normal > 0.0 ? -result_.normal_mps / slopes.normal
                                     : std::numeric_limits<double>::infinity();
    if (stop < end) {
      Advance(slopes, stop, true);
      LeaveSlip();
      slopes = Now();
      end = -result_.normal_mps / slopes.normal;
    }
    Advance(slopes, end, true);
    result_.normal_mps = 0.0;
    result_.compression_impulse_mps = result_.normal_impulse_mps;
  }

  void Restitute() {
    double left = p_.restitution * result_.compression_impulse_mps;
    Slopes slopes = Now();
    const double stop = ImpulseToStop(slopes);
    if (stop < left) {
      Advance(slopes, stop, false);
      LeaveSlip();
      slopes = Now();
      left -= stop;
    }
    Advance(slopes, left, false);
    result_.normal_impulse_mps =
        (1.0 + p_.restitution) * result_.compression_impulse_mps;
  }

  const ImpactProblem& p_;
  const Delassus g_;
  Slip slip_;
  bool sticks_ = false;
  ImpactResult result_;
};

void CheckImpactProblem(const ImpactProblem& p) {
  RequireFinite("sin alpha", p.alpha.sin);
  RequireFinite("cos alpha", p.alpha.cos);
  RequirePositive("radius", p.radius_m, "m");
  RequireNotNegative("kappa", p.kappa);
  RequireNotNegative("mu", p.mu);
  RequireBetween("restitution", p.restitution, 0.0, 1.0);
  RequireFinite("tangential velocity", p.tangential_mps, "m/s");
  RequireFinite("normal velocity", p.normal_mps, "m/s");
  RequireFinite("rate of alpha", p.alpha_rate_rad_per_s, "rad/s");
}

}  // namespace

ImpactResult Impact(const ImpactProblem& problem) {
  CheckImpactProblem(problem);
  return Marcher(problem).Run();
}

BodyImpactResult ImpactOfBody(const BodyImpact& body) {
  RequireFinite("offset x", body.offset_x_m, "m");
  RequireFinite("offset y", body.offset_y_m, "m");
  RequirePositive("radius of gyration", body.gyration_radius_m, "m");
  ImpactProblem p;
  p.radius_m = std::hypot(body.offset_x_m, body.offset_y_m);
  RequirePositive("length of offset", p.radius_m, "m");
  p.alpha.cos = body.offset_x_m / p.radius_m;
  p.alpha.sin = -body.offset_y_m / p.radius_m;
  const double quotient = p.radius_m / body.gyration_radius_m;
  p.kappa = quotient * quotient;
  p.mu = body.mu;
  p.restitution = body.restitution;
  // Velocity of P = velocity of C + omega x r.
  p.tangential_mps =
      body.velocity_x_mps - body.omega_rad_per_s * body.offset_y_m;
  p.normal_mps = body.velocity_y_mps + body.omega_rad_per_s * body.offset_x_m;
  p.alpha_rate_rad_per_s = -body.omega_rad_per_s;
  BodyImpactResult out;
  out.impact = Impact(p);
  out.velocity_x_mps = body.velocity_x_mps + out.impact.tangential_impulse_mps;
  out.velocity_y_mps = body.velocity_y_mps + out.impact.normal_impulse_mps;
  out.omega_rad_per_s = -out.impact.alpha_rate_rad_per_s;
  return out;
}

}  // namespace touchdown::analysis
