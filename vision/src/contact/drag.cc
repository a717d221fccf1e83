#include "contact/drag.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/track_noise.h"

namespace touchdown::vision {
namespace {

// What one flight tells of k: the derivatives of its coordinates by it, less
// what place, velocity and gravity could take up, against the residuals: the
// Schur complement of the normal equations.
struct DragEvidence {
  double information = 0.0;  // in the unit of the flight's own residuals
  double gradient = 0.0;
};

DragEvidence ComputeDragEvidence(std::span<const PlaneSample> samples,
                                 const FlightOptions& options) {
  const Flight flight = FitFlight(samples, options);
  // Of the speed, over the whole flight: far above rounding, far below what
  // bends the derivative.
  constexpr double kShare = 1e-4;
  double path = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    path += std::hypot(samples[i].along_px - samples[i - 1].along_px,
                       samples[i].height_px - samples[i - 1].height_px);
  }
  DragEvidence out;
  if (!(path > 0.0)) return out;
  const double step = kShare / path;
  std::vector<PlaneSample> derivative(samples.begin(), samples.end());
  for (PlaneSample& s : derivative) {
    const auto offset = [&](double k) {
      return ComputeDragOffset(flight.along[1], flight.height[1],
                               flight.height[2], k, s.time_s - flight.t0_s);
    };
    const DragOffset here = offset(options.drag_per_px);
    const DragOffset more = offset(options.drag_per_px + step);
    s.along_px = (more.along_px - here.along_px) / step;
    s.height_px = (more.height_px - here.height_px) / step;
    s.u_face_rad = 0.0;
  }
  const auto& known = options.gravity_px_per_s2;
  FlightOptions of_derivative;
  if (known) of_derivative.gravity_px_per_s2 = core::Estimate{0.0, known->u};
  const Flight taken_up = FitFlight(derivative, of_derivative);
  std::vector<double> along, height;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const PlaneSample& s = samples[i];
    const FlightState at = flight.At(s.time_s);
    const FlightState lost = taken_up.At(s.time_s);
    const auto add = [&](double residual, double left, double u,
                         std::vector<double>& residuals) {
      out.information += left * left / (u * u);
      out.gradient += left * residual / (u * u);
      residuals.push_back(residual / u);
    };
    add(s.along_px - at.along_px, derivative[i].along_px - lost.along_px,
        s.u_along_px, along);
    add(s.height_px - at.height_px, derivative[i].height_px - lost.height_px,
        s.u_height_px, height);
  }
  if (known) {
    // The prior of gravity is a measured number, as a place is.
    const double left = taken_up.height[2] / known->u;
    out.information += left * left;
    out.gradient += left * (flight.height[2] - known->value) / known->u;
  }
  // Place and velocity of both coordinates, and gravity.
  const int fitted = known ? 4 : 5;
  const double inflation = ComputeInflation(
      {along, height}, 2 * static_cast<int>(samples.size()) - fitted);
  out.information /= inflation * inflation;
  out.gradient /= inflation * inflation;
  return out;
}

}  // namespace

DragOffset ComputeDragOffset(double v_t, double v_n, double gravity,
                             double drag_per_px, double t) {
  DragOffset d;
  if (drag_per_px == 0.0) return d;
  // Steps. The error falls with their fourth power; see the header.
  constexpr int kSteps = 8;
  const double h = t / kSteps;
  struct Acceleration {
    double along, height;
  };
  const auto accelerate = [&](double s, double more_t, double more_n) {
    const double u = v_t + more_t;
    const double v = v_n - gravity * s + more_n;
    const double by = -drag_per_px * std::sqrt(u * u + v * v);
    return Acceleration{by * u, by * v};
  };
  for (int i = 0; i < kSteps; ++i) {
    // Nystrom's form: the acceleration does not depend on place.
    const double s = i * h;
    const Acceleration a = accelerate(s, d.v_t, d.v_n);
    const Acceleration b = accelerate(s + 0.5 * h, d.v_t + 0.5 * h * a.along,
                                      d.v_n + 0.5 * h * a.height);
    const Acceleration c = accelerate(s + 0.5 * h, d.v_t + 0.5 * h * b.along,
                                      d.v_n + 0.5 * h * b.height);
    const Acceleration e =
        accelerate(s + h, d.v_t + h * c.along, d.v_n + h * c.height);
    d.along_px += h * (d.v_t + h / 6.0 * (a.along + b.along + c.along));
    d.height_px += h * (d.v_n + h / 6.0 * (a.height + b.height + c.height));
    d.v_t += h / 6.0 * (a.along + 2.0 * b.along + 2.0 * c.along + e.along);
    d.v_n += h / 6.0 * (a.height + 2.0 * b.height + 2.0 * c.height + e.height);
  }
  return d;
}

std::optional<core::Estimate> FitDrag(const PlaneTrack& track,
                                      std::span<const SampleRange> flights,
                                      const FlightOptions& options) {
  // Frames: residuals of shorter flights are mostly taken up by the fit, as in
  // WidenToCorrelation.
  constexpr std::size_t kMinFrames = 8;
  // Steps. The first is exact to the second order of k times the path. Not
  // studied.
  constexpr int kMaxSteps = 6;
  core::Estimate k;
  for (int i = 0; i < kMaxSteps; ++i) {
    FlightOptions under = options;
    under.drag_per_px = k.value;
    double information = 0.0;
    double gradient = 0.0;
    double square = 0.0;  // of what each flight alone would change, over its u
    int seen = 0;
    for (const SampleRange& range : flights) {
      if (range.size() < kMinFrames) continue;
      const DragEvidence flight =
          ComputeDragEvidence(SelectSamples(track, range), under);
      if (!(flight.information > 0.0)) continue;
      information += flight.information;
      gradient += flight.gradient;
      square += flight.gradient * flight.gradient / flight.information;
      ++seen;
    }
    if (!(information > 0.0)) return std::nullopt;
    const double step = gradient / information;
    k.value += step;
    // Birge's ratio, of the flights among each other.
    const double chi2 = square - step * gradient;
    k.u = std::sqrt(std::max(1.0, seen > 1 ? chi2 / (seen - 1) : 1.0) /
                    information);
    // Of u: a further step would not show.
    constexpr double kNegligible = 0.01;
    // Of u: what may be none is not made better. Larger would leave the first
    // u, of residuals that drag is in, to what lies near the limit of doubt.
    constexpr double kMaybe = 2.0;
    if (k.value < kMaybe * k.u || std::abs(step) < kNegligible * k.u) break;
  }
  return k;
}

}  // namespace touchdown::vision
