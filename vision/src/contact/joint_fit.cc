#include "contact/joint_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "contact/drag.h"
#include "numbers/symmetric_factor.h"

namespace touchdown::vision {
namespace {

// Sign(0) = 1: at face angles where two corners are level the derivative is
// that of one of them.
double Sign(double v) { return v < 0.0 ? -1.0 : 1.0; }

// Height of the centre above the lowest point, S = a |sin face| + b |cos face|,
// with its derivatives (a, b: half sides; a sphere has S = radius).
struct Support {
  double value = 0.0;
  double d_long = 0.0;
  double d_short = 0.0;
  double d_face = 0.0;
};

Support ComputeSupport(bool sphere, const JointVector& p, double face) {
  Support s;
  if (sphere) {
    s.value = p[kHalfLong];
    s.d_long = 1.0;
    return s;
  }
  const double sine = std::sin(face);
  const double cosine = std::cos(face);
  s.d_long = std::abs(sine);
  s.d_short = std::abs(cosine);
  s.value = p[kHalfLong] * s.d_long + p[kHalfShort] * s.d_short;
  s.d_face =
      p[kHalfLong] * cosine * Sign(sine) - p[kHalfShort] * sine * Sign(cosine);
  return s;
}

// The parameters that one side of the contact uses.
struct Side {
  JointParameter t, x, vx, vy, face, omega, gravity;
};

Side SideParameters(const JointFit& fit, bool after) {
  if (!after) return {kT, kX, kVx, kVy, kFace, kOmega, kGravity};
  const JointParameter gravity = fit.active[kGravity2] ? kGravity2 : kGravity;
  // An instant contact shares instant, place and attitude between the flights.
  if (fit.instant) return {kT, kX, kVx2, kVy2, kFace, kOmega2, gravity};
  return {kT2, kX2, kVx2, kVy2, kFace2, kOmega2, gravity};
}

// A predicted number with its derivatives by all parameters.
struct Predicted {
  double value = 0.0;
  JointVector d = JointVector::Zero();
};

struct PredictedPose {
  Predicted along;
  Predicted height;
  Predicted face;
};

// Adds what drag does within s frames of the contact, with its derivatives by
// the velocities there; those by gravity are of second order.
void AddDrag(const JointFit& fit, const Side& side, double s,
             PredictedPose& pose) {
  if (fit.drag_per_px == 0.0) return;
  const JointVector& p = fit.p;
  const auto offset = [&](double more_x, double more_y) {
    return ComputeDragOffset(p[side.vx] + more_x, p[side.vy] + more_y,
                             p[side.gravity], fit.drag_per_px, s);
  };
  const DragOffset drag = offset(0.0, 0.0);
  pose.along.value += drag.along_px;
  pose.height.value += drag.height_px;
  pose.along.d[side.t] -= drag.v_t;
  pose.height.d[side.t] -= drag.v_n;
  // px a frame: small against any speed that drag shows at.
  constexpr double kStep = 1e-3;
  const DragOffset by_x = offset(kStep, 0.0);
  const DragOffset by_y = offset(0.0, kStep);
  pose.along.d[side.vx] += (by_x.along_px - drag.along_px) / kStep;
  pose.height.d[side.vx] += (by_x.height_px - drag.height_px) / kStep;
  pose.along.d[side.vy] += (by_y.along_px - drag.along_px) / kStep;
  pose.height.d[side.vy] += (by_y.height_px - drag.height_px) / kStep;
}

// The model of joint_fit.h at time t (frames after the origin).
PredictedPose PredictPose(const JointFit& fit, const Side& side, double t) {
  const JointVector& p = fit.p;
  const double s = t - p[side.t];
  PredictedPose pose;
  pose.along.value = p[side.x] + p[side.vx] * s;
  pose.along.d[side.x] = 1.0;
  pose.along.d[side.vx] = s;
  pose.along.d[side.t] = -p[side.vx];

  const Support support =
      ComputeSupport(fit.sphere, p, p[side.face] - p[kSlope]);
  // The ground at the contact: level plus slope times the distance from the
  // line's reference point.
  const double reach = p[side.x] - fit.reference_px;
  Predicted& h = pose.height;
  h.value = p[kGround] + p[kSlope] * reach + support.value + p[side.vy] * s -
            0.5 * p[side.gravity] * s * s;
  h.d[kGround] = 1.0;
  h.d[kSlope] = reach - support.d_face;
  h.d[side.x] = p[kSlope];
  h.d[kHalfLong] = support.d_long;
  h.d[kHalfShort] = support.d_short;
  h.d[side.vy] = s;
  h.d[side.gravity] = -0.5 * s * s;
  h.d[side.t] = -(p[side.vy] - p[side.gravity] * s);
  if (fit.turns) {
    h.d[side.face] = support.d_face;
    pose.face.value = p[side.face] + p[side.omega] * s;
    pose.face.d[side.face] = 1.0;
    pose.face.d[side.omega] = s;
    pose.face.d[side.t] = -p[side.omega];
  }
  AddDrag(fit, side, s, pose);
  return pose;
}

// Gauss-Newton. Each flight alone gives the start values, so that a few steps
// suffice.
class Solver {
 public:
  Solver(const PlaneTrack& track, const JointInput& input)
      : track_(track), input_(input) {}
  std::optional<JointFit> Run();

 private:
  void Start();
  void Accumulate();
  void Prior(JointParameter k, double value, double u);
  void Add(const Predicted& predicted, double measured, double u);

  const PlaneTrack& track_;
  const JointInput& input_;
  JointFit fit_;
  JointVector start_ = JointVector::Zero();
  JointVector gradient_;
  double gravity_ = 0.0;
  double u_gravity_ = 0.0;
};

// Start values from separate fits of both flights, and which parameters are
// free: a sphere has no attitude; without a rebound there is no second side;
// with known gravity one parameter holds for both flights.
void Solver::Start() {
  fit_.sphere = track_.kind == core::BodyKind::kSphere;
  fit_.turns = ShowsTurn(track_);
  fit_.instant = input_.instant;
  fit_.interval_s = track_.frame_interval_s;
  fit_.drag_per_px = input_.drag_per_px;
  fit_.origin_s = input_.touchdown_s;
  const double dt = fit_.interval_s;
  const FlightOptions options{input_.gravity_px_per_s2, input_.drag_per_px};
  const Flight before = FitFlight(input_.before, options);
  const FlightState b = before.At(input_.touchdown_s);
  fit_.origin_px = b.along_px;
  fit_.reference_px = input_.reference_along_px - fit_.origin_px;
  fit_.active.setConstant(true);
  JointVector& p = fit_.p;
  p.setZero();
  p[kVx] = b.v_t * dt;
  p[kVy] = b.v_n * dt;
  p[kGround] = input_.ground_px.value;
  p[kHalfLong] = track_.half_long_px;
  p[kHalfShort] = track_.half_short_px;
  p[kFace] = b.face_rad;
  p[kOmega] = b.omega * dt;
  p[kGravity] = before.height[2] * dt * dt;
  p[kT2] = (input_.release_s - input_.touchdown_s) / dt;
  if (input_.gravity_px_per_s2) {
    gravity_ = input_.gravity_px_per_s2->value * dt * dt;
    u_gravity_ = input_.gravity_px_per_s2->u * dt * dt;
    p[kGravity] = gravity_;
  }
  const auto leave_out = [&](std::initializer_list<JointParameter> unused) {
    for (const JointParameter k : unused) fit_.active[k] = false;
  };
  if (fit_.sphere) leave_out({kHalfShort});
  if (!fit_.turns) leave_out({kFace, kOmega, kOmega2, kFace2});
  if (input_.after.empty()) leave_out({kVx2, kVy2, kOmega2});
  if (input_.after.empty() || input_.instant) leave_out({kT2, kX2, kFace2});
  if (input_.after.empty() || input_.gravity_px_per_s2) leave_out({kGravity2});
  if (!input_.after.empty()) {
    const Flight after = FitFlight(input_.after, options);
    const FlightState a = after.At(input_.release_s);
    p[kGravity2] = after.height[2] * dt * dt;
    p[kVx2] = a.v_t * dt;
    p[kVy2] = a.v_n * dt;
    p[kOmega2] = a.omega * dt;
    p[kX2] = a.along_px - fit_.origin_px;
    p[kFace2] = a.face_rad;
  }
  start_ = p;
}

// Adds one measured number to the normal equations: information += w d d^T,
// gradient += w r d, chi^2 += w r^2, with w = 1/u^2.
void Solver::Add(const Predicted& predicted, double measured, double u) {
  const double w = 1.0 / (u * u);
  const double r = measured - predicted.value;
  const JointVector weighted = w * predicted.d;
  for (Eigen::Index k = 0; k < predicted.d.size(); ++k) {
    // A number depends on a few parameters only.
    if (predicted.d[k] == 0.0) continue;
    fit_.information.col(k) += predicted.d[k] * weighted;
  }
  gradient_.noalias() += (w * r) * predicted.d;
  fit_.chi2 += w * r * r;
}

void Solver::Prior(JointParameter k, double value, double u) {
  Predicted predicted;
  predicted.value = fit_.p[k];
  predicted.d[k] = 1.0;
  Add(predicted, value, u);
}

// Normal equations at the present parameters: all poses, then the priors of
// ground, slope, sizes and gravity. A prior counts as a measured number, so
// that the degrees of freedom do not fall with it.
void Solver::Accumulate() {
  fit_.information.setZero();
  gradient_.setZero();
  fit_.chi2 = 0.0;
  fit_.degrees = 0;
  const double dt = fit_.interval_s;
  const auto add = [&](std::span<const PlaneSample> samples, bool after) {
    const Side side = SideParameters(fit_, after);
    for (const PlaneSample& s : samples) {
      const PredictedPose pose =
          PredictPose(fit_, side, (s.time_s - fit_.origin_s) / dt);
      Add(pose.along, s.along_px - fit_.origin_px, s.u_along_px);
      Add(pose.height, s.height_px, s.u_height_px);
      fit_.degrees += 2;
      if (fit_.turns) {
        Add(pose.face, s.face_rad, s.u_face_rad);
        ++fit_.degrees;
      }
    }
  };
  add(input_.before, false);
  add(input_.after, true);
  // px or rad: a prior without u holds its parameter.
  constexpr double kMinPriorU = 1e-9;
  const int measured = fit_.degrees;
  Prior(kGround, input_.ground_px.value,
        std::max(kMinPriorU, input_.ground_px.u));
  Prior(kSlope, 0.0, std::max(kMinPriorU, input_.u_slope_rad));
  const double u_half = std::max(kMinPriorU, track_.u_half_px);
  Prior(kHalfLong, start_[kHalfLong], u_half);
  if (!fit_.sphere) Prior(kHalfShort, start_[kHalfShort], u_half);
  int with_prior = fit_.sphere ? 3 : 4;
  if (input_.gravity_px_per_s2) {
    Prior(kGravity, gravity_, std::max(1e-9 * gravity_, u_gravity_));
    ++with_prior;
  }
  fit_.degrees =
      measured - (static_cast<int>(fit_.active.count()) - with_prior);
  for (int k = 0; k < kJointParameters; ++k) {
    if (fit_.active[k]) continue;
    fit_.information.row(k).setZero();
    fit_.information.col(k).setZero();
    fit_.information(k, k) = 1.0;
    gradient_[k] = 0.0;
  }
}

// Solves the normal equations with each parameter in the unit of its own
// information (Jacobi scaling): px, frames and radians then compare.
std::optional<JointVector> Solve(const JointMatrix& information,
                                 const JointVector& gradient,
                                 JointMatrix* covariance) {
  const JointVector unit = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!unit.allFinite()) return std::nullopt;
  const JointMatrix scaled =
      unit.asDiagonal() * information * unit.asDiagonal();
  const SymmetricFactor factor(scaled);
  // Smallest pivot of the scaled matrix, whose diagonal is 1: below it the
  // frames do not determine some combination of parameters. Rounding reaches
  // 1e-15.
  constexpr double kSingular = 1e-13;
  if (!factor.succeeded() || !(factor.smallest_pivot() > kSingular)) {
    return std::nullopt;
  }
  const JointVector step =
      unit.asDiagonal() * factor.Solve(unit.asDiagonal() * gradient);
  if (covariance != nullptr) {
    *covariance = unit.asDiagonal() * factor.Inverse() * unit.asDiagonal();
  }
  if (!step.allFinite()) return std::nullopt;
  return step;
}

std::optional<JointFit> Solver::Run() {
  Start();
  // Gauss-Newton steps. A bound: without convergence there is no fit. Not
  // studied.
  constexpr int kMaxIterations = 30;
  bool converged = false;
  for (int i = 0; i < kMaxIterations && !converged; ++i) {
    Accumulate();
    const auto step = Solve(fit_.information, gradient_, nullptr);
    if (!step) return std::nullopt;
    // Frames by which one step may move the touchdown: farther away the
    // parabola is not the one that was linearised. Not studied.
    constexpr double kMaxStepFrames = 5.0;
    const double shrink =
        std::min(1.0, kMaxStepFrames / std::max(std::abs((*step)[kT]), 1e-300));
    fit_.p += shrink * *step;
    const double cost = step->dot(gradient_);
    // Of chi^2: what the last step could still gain, far below any effect on p.
    constexpr double kNegligibleGain = 1e-10;
    converged = std::abs(cost) < kNegligibleGain * (1.0 + fit_.chi2);
  }
  if (!converged) return std::nullopt;
  Accumulate();
  if (!Solve(fit_.information, gradient_, &fit_.covariance)) {
    return std::nullopt;
  }
  for (int k = 0; k < kJointParameters; ++k) {
    if (fit_.active[k]) continue;
    fit_.covariance.row(k).setZero();
    fit_.covariance.col(k).setZero();
  }
  // Birge's ratio: residuals that exceed the poses' u widen all u, never narrow
  // them.
  if (fit_.degrees > 0) {
    fit_.covariance *= std::max(1.0, fit_.chi2 / fit_.degrees);
  }
  return fit_;
}

// Central differences of any function of the parameters.
JointVector Gradient(const JointFit& fit, const JointFit::Function& f) {
  JointVector gradient = JointVector::Zero();
  for (int k = 0; k < kJointParameters; ++k) {
    if (!fit.active[k]) continue;
    // A hundredth of the parameter's own u: the function is linear over it, and
    // rounding does not yet show.
    const double step = 0.01 * std::sqrt(fit.covariance(k, k)) + 1e-12;
    JointVector up = fit.p;
    JointVector down = fit.p;
    up[k] += step;
    down[k] -= step;
    gradient[k] = (f(up) - f(down)) / (2.0 * step);
  }
  return gradient;
}

// Writes one side as a Flight about the instant of contact, with its covariance
// J C J^T. J holds the derivatives of (along, v_t, height, v_n, g, face,
// omega), at fixed time, by the parameters.
Flight MakeFlight(const JointFit& fit, const Side& side,
                  std::span<const PlaneSample> samples) {
  Flight flight;
  const double fps = 1.0 / fit.interval_s;
  const double t = fit.p[side.t];
  flight.t0_s = fit.ToSeconds(t);
  flight.drag_per_px = fit.drag_per_px;
  flight.frames = static_cast<int>(samples.size());
  flight.first_frame = samples.front().frame;
  flight.last_frame = samples.back().frame;
  // The state at the fixed time t0, as functions of the parameters: the
  // velocity at t0 also depends on T, through gravity.
  Eigen::Matrix<double, 7, kJointParameters> d;
  const PredictedPose pose = PredictPose(fit, side, t);
  d.row(0) = pose.along.d;
  d.row(1).setZero();
  d(1, side.vx) = fps;
  d.row(2) = pose.height.d;
  d.row(3).setZero();
  d(3, side.vy) = fps;
  d(3, side.t) = fps * fit.p[side.gravity];
  d.row(4).setZero();
  d(4, side.gravity) = fps * fps;
  d.row(5) = pose.face.d;
  d.row(6).setZero();
  if (fit.turns) d(6, side.omega) = fps;
  const Eigen::Matrix<double, 7, 7> covariance =
      d * fit.covariance * d.transpose();
  flight.along = {fit.origin_px + pose.along.value, fps * fit.p[side.vx]};
  flight.height = {pose.height.value, fps * fit.p[side.vy],
                   fps * fps * fit.p[side.gravity]};
  flight.along_cov = covariance.block<2, 2>(0, 0);
  flight.height_cov = covariance.block<3, 3>(2, 2);
  flight.face.setZero();
  flight.face_cov.setZero();
  if (fit.turns) {
    flight.face = {pose.face.value, fps * fit.p[side.omega]};
    flight.face_cov = covariance.block<2, 2>(5, 5);
  }
  double chi2 = 0.0;
  double square = 0.0;
  for (const PlaneSample& s : samples) {
    const FlightState at = flight.At(s.time_s);
    const double along = s.along_px - at.along_px;
    const double height = s.height_px - at.height_px;
    square += along * along + height * height;
    chi2 +=
        std::pow(along / s.u_along_px, 2) + std::pow(height / s.u_height_px, 2);
  }
  const double n = flight.frames;
  flight.rms_px = std::sqrt(square / (2.0 * n));
  flight.reduced_chi2 = chi2 / std::max(1.0, 2.0 * n - 4.0);
  return flight;
}

}  // namespace

core::Estimate JointFit::EstimateFunction(const Function& f) const {
  const JointVector gradient = Gradient(*this, f);
  return {f(p), std::sqrt(std::max(0.0, gradient.dot(covariance * gradient))),
          std::nullopt};
}

double JointFit::UncertaintyShare(
    const Function& f, std::initializer_list<JointParameter> known) const {
  const JointVector gradient = Gradient(*this, f);
  const double all = gradient.dot(covariance * gradient);
  // The variance explained by `known`, c^T own^-1 c with c = cov(known, f):
  // what conditioning on them would take away.
  const auto n = static_cast<Eigen::Index>(known.size());
  NormalMatrix cross(kJointParameters, n);
  NormalMatrix own(n, n);
  Eigen::Index i = 0;
  for (const JointParameter a : known) {
    cross.col(i) = covariance.col(a);
    Eigen::Index j = 0;
    for (const JointParameter b : known) own(i, j++) = covariance(a, b);
    if (!(own(i, i) > 0.0)) own(i, i) = 1.0;  // not in use: no share
    ++i;
  }
  const NormalVector through = cross.transpose() * gradient;
  const double share = through.dot(SymmetricFactor(own).Solve(through));
  return std::sqrt(std::clamp(share, 0.0, all));
}

// Height of the lowest point above the ground t frames after the origin:
// support heights at release and then, normal velocity relative to the inclined
// ground, and the fall.
double JointFit::ReboundGap(const JointVector& q, double t) const {
  const Side side = SideParameters(*this, true);
  const double s = t - q[side.t];
  const double at_release =
      ComputeSupport(sphere, q, q[side.face] - q[kSlope]).value;
  const double then =
      ComputeSupport(sphere, q, q[side.face] + q[side.omega] * s - q[kSlope])
          .value;
  const DragOffset drag = ComputeDragOffset(q[side.vx], q[side.vy],
                                            q[side.gravity], drag_per_px, s);
  return at_release - then + (q[side.vy] - q[kSlope] * q[side.vx]) * s -
         0.5 * q[side.gravity] * s * s + drag.height_px -
         q[kSlope] * drag.along_px;
}

Flight JointFit::IncomingFlight(std::span<const PlaneSample> samples) const {
  return MakeFlight(*this, SideParameters(*this, false), samples);
}

Flight JointFit::OutgoingFlight(std::span<const PlaneSample> samples) const {
  return MakeFlight(*this, SideParameters(*this, true), samples);
}

std::optional<JointFit> FitJointly(const PlaneTrack& track,
                                   const JointInput& input) {
  return Solver(track, input).Run();
}

}  // namespace touchdown::vision
