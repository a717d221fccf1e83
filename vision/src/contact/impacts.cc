#include "contact/impacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace touchdown::vision {
namespace {

// Of the impulse at the second corner: above it no body of nearly even mass
// struck with one corner alone. Smaller: an uneven block loses its restitution;
// larger: two impacts pass for one. Chosen, not measured: it moves the centre
// of mass by a tenth of the side.
constexpr double kUnevenMass = 0.1;

// Places of the lowest and the second lowest corner along the ground from the
// centre, and how far the lowest lies below the centre.
struct LowestCorners {
  double first = 0.0;
  double second = 0.0;
  double depth = 0.0;
};

LowestCorners FindLowestCorners(const JointVector& p) {
  const double face = p[kFace] - p[kSlope];
  const double s = std::sin(face);
  const double c = std::cos(face);
  std::array<std::pair<double, double>, 4> corners;  // height, along
  std::size_t i = 0;
  for (const double a : {-p[kHalfLong], p[kHalfLong]}) {
    for (const double b : {-p[kHalfShort], p[kHalfShort]}) {
      corners[i++] = {a * s + b * c, a * c - b * s};
    }
  }
  std::sort(corners.begin(), corners.end());
  return {corners[0].second, corners[1].second, -corners[0].first};
}

// Change of the centre's velocity along the ground's normal: the normal impulse
// per mass.
double NormalChange(const JointVector& p) {
  return p[kVy2] - p[kVy] - p[kSlope] * (p[kVx2] - p[kVx]);
}

// Share of the second corner (impacts.h): the impulse acts at the weighted mean
// place of both corners, `lever`, which the change of spin tells.
double Share(const JointVector& p) {
  const LowestCorners corners = FindLowestCorners(p);
  // Radius of gyration of a homogeneous rectangle: k^2 = (a^2 + b^2) / 3.
  constexpr double kThird = 1.0 / 3.0;
  const double k2 =
      kThird * (p[kHalfLong] * p[kHalfLong] + p[kHalfShort] * p[kHalfShort]);
  const double along = p[kVx2] - p[kVx] + p[kSlope] * (p[kVy2] - p[kVy]);
  const double lever =
      (k2 * (p[kOmega2] - p[kOmega]) - corners.depth * along) / NormalChange(p);
  return (corners.first - lever) / (corners.first - corners.second);
}

}  // namespace

core::Measured ShareOfSecondCorner(const PlaneTrack& track,
                                   const JointFit& fit) {
  if (track.kind != core::BodyKind::kRectangle) {
    return core::AbsentBecause("no corners");
  }
  const core::Estimate change = fit.EstimateFunction(NormalChange);
  if (!(std::abs(change.value) > kMeasurable * change.u)) {
    return core::AbsentBecause("the normal velocity hardly changes");
  }
  return fit.EstimateFunction(Share);
}

std::string WhySeveralImpacts(const PlaneTrack& track, const JointFit& fit) {
  // Standard deviations: one honest contact in 2000 loses its restitution
  // (one-sided). Two impacts whose share is less clear keep a wrong one.
  constexpr double kClearSigmas = 3.3;
  const core::Measured share = ShareOfSecondCorner(track, fit);
  if (!share || share->value - kClearSigmas * share->u < kUnevenMass) return "";
  return fmt::format(
      "more than one impact between two frames: {:.0f} +- {:.0f} % of the "
      "impulse was at the other corner",
      100.0 * share->value, 100.0 * share->u);
}

RestitutionOfImpacts PoolRestitution(const ContactResult& contacts) {
  RestitutionOfImpacts out;
  double weights = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  // A body that strikes again has left the ground before, seen or not: a
  // contact without a restitution then is an impact that was not resolved.
  const auto add = [&](const core::Motion& motion, bool strikes_again) {
    const core::Measured& e = motion.restitution;
    out.unresolved += !e && strikes_again
                          ? std::max(1, motion.unresolved_impacts)
                          : motion.unresolved_impacts;
    if (!e || !(e->u > 0.0)) return;
    const double w = 1.0 / (e->u * e->u);
    weights += w;
    sum += w * e->value;
    squares += w * e->value * e->value;
    ++out.resolved;
  };
  add(contacts.first.motion, !contacts.later.empty());
  for (const core::ContactRecord& later : contacts.later) {
    add(later.motion, &later != &contacts.later.back());
  }
  if (out.resolved == 0) {
    out.value = core::AbsentBecause("no impact was resolved");
    return out;
  }
  const double mean = sum / weights;
  const double chi2 = std::max(0.0, squares - weights * mean * mean);
  // The mean's u is widened where the values scatter by more than their u.
  const double birge =
      out.resolved > 1 ? std::max(1.0, chi2 / (out.resolved - 1)) : 1.0;
  out.value = core::Estimate{mean, std::sqrt(birge / weights), std::nullopt};
  return out;
}

}  // namespace touchdown::vision
