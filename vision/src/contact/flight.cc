#include "touchdown/vision/contact/flight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "contact/drag.h"
#include "numbers/symmetric_factor.h"

namespace touchdown::vision {
namespace {

// Weighted least squares of value(t) = sum over k of factors[k] c[k] ((t - t0)
// / unit)^k, k < N, with an optional prior on the last coefficient. `unit`
// scales time to order one, which keeps the normal equations well conditioned.
// Writes `solution` and `covariance` in physical units; returns the sum of
// squared weighted residuals, that of the prior included.
template <int N>
double FitPolynomial(std::span<const PlaneSample> samples, double t0,
                     double unit, double PlaneSample::*value,
                     double PlaneSample::*u,
                     const Eigen::Matrix<double, N, 1>& factors,
                     const core::Estimate* prior,
                     Eigen::Matrix<double, N, 1>& solution,
                     Eigen::Matrix<double, N, N>& covariance) {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  Matrix a = Matrix::Zero();
  Vector b = Vector::Zero();
  // Values relative to the first one: a far origin costs no digits.
  const double origin = samples.front().*value;
  const auto row_at = [&](const PlaneSample& s) {
    Vector row;
    double power = 1.0;
    for (int k = 0; k < N; ++k) {
      row[k] = factors[k] * power;
      power *= (s.time_s - t0) / unit;
    }
    return row;
  };
  for (const PlaneSample& s : samples) {
    const Vector row = row_at(s);
    const double w = 1.0 / (s.*u * s.*u);
    a.noalias() += w * row * row.transpose();
    b.noalias() += (w * (s.*value - origin)) * row;
  }
  // The last parameter in scaled units is physical * unit^(N-1).
  const double scale = std::pow(unit, N - 1);
  if (prior != nullptr) {
    const double w = 1.0 / (prior->u * prior->u * scale * scale);
    a(N - 1, N - 1) += w;
    b[N - 1] += w * prior->value * scale;
  }
  const SymmetricFactor factor(a);
  solution = factor.Solve(b);
  covariance = factor.Inverse();
  double chi2 = 0.0;
  for (const PlaneSample& s : samples) {
    const double r = (s.*value - origin - row_at(s).dot(solution)) / (s.*u);
    chi2 += r * r;
  }
  if (prior != nullptr) {
    const double r = (solution[N - 1] / scale - prior->value) / prior->u;
    chi2 += r * r;
  }
  solution[0] += origin;
  double power = 1.0;
  Vector to_physical;
  for (int k = 0; k < N; ++k) {
    to_physical[k] = power;
    power /= unit;
  }
  solution = solution.cwiseProduct(to_physical).eval();
  covariance =
      (to_physical.asDiagonal() * covariance * to_physical.asDiagonal()).eval();
  return chi2;
}

// Birge's ratio: the factor by which residuals that exceed the poses' u widen
// the covariance.
double WideningFactor(double chi2, int degrees) {
  // With few degrees of freedom chi2 says little: never narrow.
  return degrees > 0 ? std::max(1.0, chi2 / degrees) : 1.0;
}

// Takes what drag does out of the places and fits the parabola that is left,
// `fit`, until neither changes.
template <typename FitParabola>
void FitUnderDrag(std::span<const PlaneSample> samples,
                  const FlightOptions& options, const FitParabola& fit,
                  Flight& f) {
  f.drag_per_px = options.drag_per_px;
  std::vector<PlaneSample> parabola(samples.begin(), samples.end());
  // Each pass leaves the share k times the path of the last one's change. A
  // bound only.
  constexpr int kMaxPasses = 30;
  // px: far below any pose's u.
  constexpr double kSame_px = 1e-7;
  double change = 1.0;
  for (int i = 0; i < kMaxPasses && change > kSame_px; ++i) {
    change = 0.0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const DragOffset drag =
          ComputeDragOffset(f.along[1], f.height[1], f.height[2], f.drag_per_px,
                            samples[k].time_s - f.t0_s);
      const double along = samples[k].along_px - drag.along_px;
      const double height = samples[k].height_px - drag.height_px;
      change = std::max({change, std::abs(along - parabola[k].along_px),
                         std::abs(height - parabola[k].height_px)});
      parabola[k].along_px = along;
      parabola[k].height_px = height;
    }
    fit(parabola);
  }
}

}  // namespace

FlightState Flight::At(double time_s) const {
  const double t = time_s - t0_s;
  FlightState s;
  s.along_px = along[0] + along[1] * t;
  s.v_t = along[1];
  s.height_px = height[0] + height[1] * t - 0.5 * height[2] * t * t;
  s.v_n = height[1] - height[2] * t;
  const DragOffset drag =
      ComputeDragOffset(along[1], height[1], height[2], drag_per_px, t);
  s.along_px += drag.along_px;
  s.v_t += drag.v_t;
  s.height_px += drag.height_px;
  s.v_n += drag.v_n;
  s.face_rad = face[0] + face[1] * t;
  s.omega = face[1];
  // Derivatives of place and velocity with respect to the coefficients.
  const Eigen::Vector2d line(1.0, t);
  const Eigen::Vector3d position(1.0, t, -0.5 * t * t);
  const Eigen::Vector3d velocity(0.0, 1.0, -t);
  s.u_along_px = std::sqrt(line.dot(along_cov * line));
  s.u_v_t = std::sqrt(along_cov(1, 1));
  s.u_height_px = std::sqrt(position.dot(height_cov * position));
  s.u_v_n = std::sqrt(velocity.dot(height_cov * velocity));
  s.covariance_h_vn = position.dot(height_cov * velocity);
  s.u_face_rad = std::sqrt(line.dot(face_cov * line));
  s.u_omega = std::sqrt(face_cov(1, 1));
  return s;
}

Flight FitFlight(std::span<const PlaneSample> samples,
                 const FlightOptions& options) {
  const bool known = options.gravity_px_per_s2.has_value();
  // Frames: with the prior on gravity two determine a parabola.
  const std::size_t least = known ? 2 : 3;
  if (samples.size() < least) {
    throw std::invalid_argument(
        fmt::format("a flight's frames are {}, must be at least {}",
                    samples.size(), least));
  }
  Flight f;
  f.frames = static_cast<int>(samples.size());
  f.first_frame = samples.front().frame;
  f.last_frame = samples.back().frame;
  const double start = samples.front().time_s;
  const double end = samples.back().time_s;
  f.t0_s = 0.5 * (start + end);
  // Half of the flight's duration: scaled times lie within -1..1.
  const double unit = std::max(0.5 * (end - start), 1e-300);

  // height(t) = h + v t - g t^2 / 2: the third coefficient is gravity itself,
  // so that its prior and its covariance need no conversion.
  const Eigen::Vector3d height_factors(1.0, 1.0, -0.5);
  double chi2_h = 0.0;
  double chi2_s = 0.0;
  const auto fit = [&](std::span<const PlaneSample> parabola) {
    chi2_h = FitPolynomial<3>(parabola, f.t0_s, unit, &PlaneSample::height_px,
                              &PlaneSample::u_height_px, height_factors,
                              known ? &*options.gravity_px_per_s2 : nullptr,
                              f.height, f.height_cov);
    chi2_s =
        FitPolynomial<2>(parabola, f.t0_s, unit, &PlaneSample::along_px,
                         &PlaneSample::u_along_px, Eigen::Vector2d(1.0, 1.0),
                         nullptr, f.along, f.along_cov);
  };
  fit(samples);
  if (options.drag_per_px != 0.0) FitUnderDrag(samples, options, fit, f);
  const bool turns = samples.front().u_face_rad > 0.0;
  double chi2_f = 0.0;
  if (turns) {
    chi2_f = FitPolynomial<2>(
        samples, f.t0_s, unit, &PlaneSample::face_rad, &PlaneSample::u_face_rad,
        Eigen::Vector2d(1.0, 1.0), nullptr, f.face, f.face_cov);
  } else {
    f.face.setZero();
    f.face_cov.setZero();
  }

  const int n = f.frames;
  f.along_cov *= WideningFactor(chi2_s, n - 2);
  f.height_cov *= WideningFactor(chi2_h, known ? n - 2 : n - 3);
  f.face_cov *= WideningFactor(chi2_f, n - 2);
  // Numbers measured, less place and velocity of both coordinates and gravity.
  const int degrees = 2 * n - 4 - (known ? 0 : 1);
  f.reduced_chi2 = degrees > 0 ? (chi2_h + chi2_s) / degrees : 1.0;
  double square = 0.0;
  for (const PlaneSample& s : samples) {
    const FlightState at = f.At(s.time_s);
    const double dh = s.height_px - at.height_px;
    const double ds = s.along_px - at.along_px;
    square += dh * dh + ds * ds;
  }
  f.rms_px = std::sqrt(square / (2.0 * n));
  return f;
}

std::optional<core::Estimate> FitGravity(const PlaneTrack& track,
                                         std::span<const SampleRange> flights,
                                         double drag_per_px) {
  FlightOptions options;
  options.drag_per_px = drag_per_px;
  constexpr std::size_t kMinFrames = 6;  // with fewer u says nothing
  double weights = 0.0;
  double sum = 0.0;
  for (const SampleRange& range : flights) {
    if (range.size() < kMinFrames) continue;
    const Flight flight = FitFlight(SelectSamples(track, range), options);
    const double weight = 1.0 / flight.height_cov(2, 2);
    weights += weight;
    sum += weight * flight.height[2];
  }
  if (!(weights > 0.0)) return std::nullopt;
  return core::Estimate{sum / weights, 1.0 / std::sqrt(weights)};
}

}  // namespace touchdown::vision
