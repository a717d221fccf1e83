#include "touchdown/vision/contact/supported_path.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "numbers/moments.h"
#include "numbers/robust.h"
#include "touchdown/core/units.h"

namespace touchdown::vision {
namespace {

// By how much an edge of the ground seen in perspective may differ in direction
// from the line of contact; more is another line, or none. Larger: the path of
// a body in flight passes for the ground. Not studied.
constexpr double kMaxInclination_rad = 1.0 * core::kDegree;

// Robust line or parabola of v on x, which lies within -1..1: iteratively
// reweighted least squares with Tukey's weights (1 - (r/c)^2)^2.
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
  // Reweighting converges linearly: the last rounds change a fit by less than
  // its u. More cost time only. Not studied.
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
      // Squares are bounded at the cut, so that outliers do not decide between
      // line and parabola.
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

  // Whether the ground (or a ramp) carries the body: a body in flight
  // accelerates across its path, a carried one along it. Of its acceleration
  // along the path so much remains across it at most, or what noise makes of
  // none.
  bool IsCarried() const {
    // Share of the acceleration along. Larger: a flat flight passes for a
    // slide; smaller: a bent line refutes a real one. Not studied.
    constexpr double kMaxShareAcross = 0.1;
    // Standard deviations. Not studied.
    constexpr double kNoiseSigmas = 3.0;
    return along.good() && across.good() &&
           std::abs(across.terms.bend) <
               std::max(kMaxShareAcross * std::abs(along.terms.bend),
                        kNoiseSigmas * across.u_bend());
  }

  double middle_px = 0.0;
  double half_px = 0.0;
  std::vector<double> place, time, gap;
  RobustFit line;           // gap by place
  RobustFit along, across;  // of the line by time, in half paths
};

// Whether the path is bent as a lens without calibration bends a line: the bend
// is small, the body is carried, and a parabola is far likelier than a line.
bool AsksForBend(const PlaneTrack& track, const Path& path,
                 const RobustFit& bent) {
  // A line that was stated or calibrated is straight.
  if (track.ground.source != calib::GroundSource::kContactPoints &&
      track.ground.source != calib::GroundSource::kDetected) {
    return false;
  }
  // Of the path's length: barrel and pincushion of ordinary lenses bend a line
  // by up to 1 %. Larger: a hop passes for a lens.
  constexpr double kMaxBend = 0.01;
  if (!bent.good() ||
      std::abs(bent.terms.bend) > kMaxBend * 2.0 * path.half_px) {
    return false;
  }
  // Of twice the ln odds (here the change of n ln square less ln n): positive
  // evidence begins at 2, strong at 6 (Kass and Raftery 1995).
  constexpr double kStrongEvidence = 6.0;
  const auto n = static_cast<double>(path.gap.size());
  const double gain =
      n * std::log(path.line.square / std::max(bent.square, 1e-300)) -
      std::log(n);
  return gain > kStrongEvidence && path.IsCarried();
}

// The middle of some poses.
core::PixelPoint MeanCentre(std::span<const Pose> poses) {
  core::PixelPoint middle;
  for (const Pose& pose : poses) {
    middle.x_px += pose.centre.x_px / static_cast<double>(poses.size());
    middle.y_px += pose.centre.y_px / static_cast<double>(poses.size());
  }
  return middle;
}

}  // namespace

std::optional<calib::GroundLine> GroundFromPath(const Track& track) {
  // Frames: enough for two parabolas of the path and a robust scatter. Not
  // studied.
  constexpr std::size_t kMinPoses = 8;
  const std::size_t n = track.poses.size();
  if (n < kMinPoses) return std::nullopt;
  // Roughly: from the middle of the first third to that of the last.
  const std::span<const Pose> poses(track.poses);
  core::PixelPoint from = MeanCentre(poses.first(n / 3));
  core::PixelPoint to = MeanCentre(poses.last(n / 3));
  if (to.x_px < from.x_px) std::swap(from, to);
  const double run_px = to.x_px - from.x_px;
  const double rise_px = std::abs(to.y_px - from.y_px);
  const bool sphere = track.body.kind == core::BodyKind::kSphere;
  const core::Estimate& half =
      sphere ? track.body.radius_px : track.body.half_long_px;
  // A body that moves by less than its own size tells of no path.
  if (!(std::hypot(run_px, rise_px) > 2.0 * half.value)) return std::nullopt;
  // How far the camera may be rolled: within it of the vertical the
  // acceleration along the path may be gravity's, and flight cannot be told
  // from a steep ramp. Larger refuses steep ramps. Not studied.
  constexpr double kMaxRoll_rad = 15.0 * core::kDegree;
  const double to_vertical = std::atan2(run_px, rise_px);
  if (to_vertical < kMaxRoll_rad) return std::nullopt;
  const PlaneTrack plane =
      SeenFromGround(track, calib::MakeGroundLine(from, to));
  const Path path(plane);
  if (!path.line.good() || !path.IsCarried()) return std::nullopt;
  // As flight, an acceleration along the path would show as much across it as
  // the vertical lies across it; that must be clear of its own uncertainty.
  // Standard deviations: a ground found by mistake turns every angle, so that
  // the limit is higher than for a warning. Not studied.
  constexpr double kClearSigmas = 5.0;
  const double along = std::abs(path.along.terms.bend);
  const double as_flight =
      along * std::abs(std::tan(to_vertical - kMaxRoll_rad));
  if (along < kClearSigmas * path.along.u_bend() ||
      as_flight < kClearSigmas * path.across.u_bend()) {
    return std::nullopt;
  }
  const auto at = [&](double place) {
    return ToImage(plane, path.middle_px + place * path.half_px,
                   path.line.At(place));
  };
  calib::GroundLine line = plane.direction > 0
                               ? calib::MakeGroundLine(at(-1.0), at(1.0), 0.0)
                               : calib::MakeGroundLine(at(1.0), at(-1.0), 0.0);
  line.reference = at(0.0);
  line.source = calib::GroundSource::kContactPoints;
  // Share of the poses that count as independent: neighbours have much of their
  // error in common. Not studied.
  constexpr double kIndependentShare = 0.25;
  const double count =
      std::max(2.0, kIndependentShare * static_cast<double>(n));
  const double scatter = path.line.scatter;
  const double u_size = sphere ? half.u : track.body.half_short_px.u;
  line.u_offset_px = std::hypot(scatter / std::sqrt(count), u_size);
  // Slope of a line through points spread evenly over a length L: u = s
  // sqrt(12/n) / L.
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
  if (std::abs(trend.slope_rad) > kMaxInclination_rad) return {};
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    // The level at the middle of the path stays: only slope and bend are taken
    // out.
    const double off = fit.At(path.place[i]) - fit.At(0.0);
    track.samples[i].gap_px -= off;
    track.samples[i].height_px -= off;
  }
  return trend;
}

}  // namespace touchdown::vision
