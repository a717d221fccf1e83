#include "touchdown/vision/supported_path.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "moments.h"
#include "robust.h"
#include "touchdown/core/units.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

// An edge of the ground seen in perspective differs from the contact line by so
// much; more is another line, or none.
constexpr double kMostInclined_rad = 1.0 * core::kDegree;

// Robust line or parabola (Tukey's weights) of v on x, which lies within -1..1.
struct RobustFit {
  Polynomial terms;
  bool bent = false;
  double square = 0.0;   // sum of the weighted squares
  double scatter = 0.0;  // robust, of v about it

  double At(double x) const { return bent ? terms.Parabola(x) : terms.Line(x); }
  double u_bend() const { return scatter / std::sqrt(terms.third); }
  bool good() const { return (bent ? terms.third : terms.spread) > 0.0; }
};

RobustFit FitRobustly(const std::vector<double>& x,
                      const std::vector<double>& v, bool bent) {
  constexpr int kRounds = 15;
  RobustFit fit;
  fit.terms.level = Median(v);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> off;
    off.reserve(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) {
      off.push_back(std::abs(v[i] - fit.At(x[i])));
    }
    fit.scatter = kSigmaPerMedian * Median(off);
    const double cut = kTukeyCut * std::max(fit.scatter, 1e-6);
    Moments sums;
    fit.square = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const double t = std::min(1.0, off[i] / cut);
      sums.Add(x[i], v[i], (1.0 - t * t) * (1.0 - t * t));
      fit.square += t * t * cut * cut;
    }
    fit.terms = Polynomial(sums);
    fit.bent = bent;
    if (!fit.good()) return fit;
  }
  return fit;
}

// The path by place, from -1 to 1, and by time, from -1 to 1.
struct Path {
  explicit Path(const PlaneTrack& track) {
    const auto& samples = track.samples;
    const auto [least, most] =
        std::minmax_element(samples.begin(), samples.end(),
                            [](const PlaneSample& a, const PlaneSample& b) {
                              return a.along_px < b.along_px;
                            });
    middle_px = 0.5 * (least->along_px + most->along_px);
    half_px = 0.5 * (most->along_px - least->along_px);
    const double begin = samples.front().time_s;
    const double half_s = 0.5 * (samples.back().time_s - begin);
    if (!(half_px > 0.0 && half_s > 0.0)) return;
    for (const PlaneSample& s : samples) {
      place.push_back((s.along_px - middle_px) / half_px);
      time.push_back((s.time_s - begin) / half_s - 1.0);
      gap.push_back(s.gap_px);
    }
    line = FitRobustly(place, gap, false);
    std::vector<double> off;
    for (std::size_t i = 0; i < gap.size(); ++i) {
      off.push_back((gap[i] - line.At(place[i])) / half_px);
    }
    along = FitRobustly(time, place, true);
    across = FitRobustly(time, off, true);
  }

  // What carries a body leaves so much of its fall beside the acceleration
  // along the ground, at most, and what noise makes of none.
  bool IsCarried() const {
    constexpr double kCarried = 0.1;
    constexpr double kNoise = 3.0;  // standard deviations
    return along.good() && across.good() &&
           std::abs(across.terms.bend) <
               std::max(kCarried * std::abs(along.terms.bend),
                        kNoise * across.u_bend());
  }

  double middle_px = 0.0;
  double half_px = 0.0;
  std::vector<double> place, time, gap;
  RobustFit line;           // gap by place
  RobustFit along, across;  // of the line by time, in half paths
};

bool AsksForBend(const PlaneTrack& track, const Path& path,
                 const RobustFit& bent) {
  if (track.ground.source != calib::GroundSource::kContactPoints &&
      track.ground.source != calib::GroundSource::kDetected) {
    return false;
  }
  // Barrel and pincushion of ordinary lenses bend a line by up to 1 %.
  constexpr double kMostBend = 0.01;
  if (!bent.good() ||
      std::abs(bent.terms.bend) > kMostBend * 2.0 * path.half_px) {
    return false;
  }
  // Positive evidence begins at 2, strong at 6 (Kass and Raftery 1995).
  constexpr double kStrong = 6.0;
  const auto n = static_cast<double>(path.gap.size());
  const double gain =
      n * std::log(path.line.square / std::max(bent.square, 1e-300)) -
      std::log(n);
  return gain > kStrong && path.IsCarried();
}

// The middle of some poses.
core::PixelPoint MiddleOf(std::span<const Pose> poses) {
  core::PixelPoint middle;
  for (const Pose& pose : poses) {
    middle.x_px += pose.centre.x_px / static_cast<double>(poses.size());
    middle.y_px += pose.centre.y_px / static_cast<double>(poses.size());
  }
  return middle;
}

}  // namespace

std::optional<calib::GroundLine> GroundFromPath(const Track& track) {
  constexpr std::size_t kLeast = 8;
  const std::size_t n = track.poses.size();
  if (n < kLeast) return std::nullopt;
  // Roughly: from the middle of the first third to that of the last.
  const std::span<const Pose> poses(track.poses);
  core::PixelPoint from = MiddleOf(poses.first(n / 3));
  core::PixelPoint to = MiddleOf(poses.last(n / 3));
  if (to.x_px < from.x_px) std::swap(from, to);
  const double run_px = to.x_px - from.x_px;
  const double rise_px = std::abs(to.y_px - from.y_px);
  const bool sphere = track.body.kind == core::BodyKind::kSphere;
  const core::Estimate& half =
      sphere ? track.body.radius_px : track.body.half_long_px;
  if (!(std::hypot(run_px, rise_px) > 2.0 * half.value)) return std::nullopt;
  // Flight would accelerate down the picture.
  constexpr double kRolled_rad = 15.0 * core::kDegree;
  const double to_vertical = std::atan2(run_px, rise_px);
  if (to_vertical < kRolled_rad) return std::nullopt;
  const PlaneTrack plane =
      SeenFromGround(track, calib::GroundThrough(from, to));
  const Path path(plane);
  if (!path.line.good() || !path.IsCarried()) return std::nullopt;
  // As flight, an acceleration along the path would show as much across it as
  // the vertical lies across it; that must be clear of its own uncertainty.
  constexpr double kClear = 5.0;
  const double along = std::abs(path.along.terms.bend);
  const double as_flight =
      along * std::abs(std::tan(to_vertical - kRolled_rad));
  if (along < kClear * path.along.u_bend() ||
      as_flight < kClear * path.across.u_bend()) {
    return std::nullopt;
  }
  const auto at = [&](double place) {
    return ToImage(plane, path.middle_px + place * path.half_px,
                   path.line.At(place));
  };
  calib::GroundLine line = plane.direction > 0
                               ? calib::GroundThrough(at(-1.0), at(1.0), 0.0)
                               : calib::GroundThrough(at(1.0), at(-1.0), 0.0);
  line.reference = at(0.0);
  line.source = calib::GroundSource::kContactPoints;
  constexpr double kCounting = 0.25;
  const double count = std::max(2.0, kCounting * static_cast<double>(n));
  const double scatter = path.line.scatter;
  const double u_size = sphere ? half.u : track.body.half_short_px.u;
  line.u_offset_px = std::hypot(scatter / std::sqrt(count), u_size);
  line.u_angle_rad = scatter * std::sqrt(12.0 / count) / (2.0 * path.half_px);
  return line;
}

PathTrend TakeOutTrend(PlaneTrack& track) {
  const Path path(track);
  PathTrend trend;
  if (!path.line.good()) return trend;
  RobustFit fit = path.line;
  if (const RobustFit bent = FitRobustly(path.place, path.gap, true);
      AsksForBend(track, path, bent)) {
    fit = bent;
    // The straight line and the bend apart: x^2 - 1 vanishes at both ends.
    trend.bend_px = -bent.terms.bend;
  }
  trend.slope_rad = 0.5 * (fit.At(1.0) - fit.At(-1.0)) / path.half_px;
  if (std::abs(trend.slope_rad) > kMostInclined_rad) return {};
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    const double off = fit.At(path.place[i]) - fit.At(0.0);
    track.samples[i].gap_px -= off;
    track.samples[i].height_px -= off;
  }
  return trend;
}

}  // namespace touchdown::vision
