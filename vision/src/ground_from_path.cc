#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "path_trend.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/contact.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

// Least squares of a parabola, its residuals' robust scatter.
struct Parabola {
  double acceleration = 0.0;  // px/s^2
  double u_acceleration = 0.0;
  double scatter_px = 0.0;
};

std::optional<Parabola> FitParabola(const std::vector<double>& t,
                                    const std::vector<double>& v) {
  // Time in half ranges from the middle: nothing cancels.
  const double middle = 0.5 * (t.front() + t.back());
  const double half = 0.5 * (t.back() - t.front());
  if (!(half > 0.0)) return std::nullopt;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double s = (t[i] - middle) / half;
    const Eigen::Vector3d row(1.0, s, s * s);
    normal += row * row.transpose();
    right += row * v[i];
  }
  const Eigen::LDLT<Eigen::Matrix3d> factor(normal);
  const Eigen::Vector3d p = factor.solve(right);
  if (!p.allFinite()) return std::nullopt;
  std::vector<double> off;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double s = (t[i] - middle) / half;
    off.push_back(std::abs(v[i] - p[0] - p[1] * s - p[2] * s * s));
  }
  Parabola out;
  constexpr double kOfMedian = 1.4826;  // of |normal|
  out.scatter_px = kOfMedian * Median(off);
  const double per_s2 = 2.0 / (half * half);
  out.acceleration = per_s2 * p[2];
  const Eigen::Matrix3d inverse = factor.solve(Eigen::Matrix3d::Identity());
  out.u_acceleration = per_s2 * out.scatter_px * std::sqrt(inverse(2, 2));
  return out;
}

// The body's reach from its centre in the direction `down`.
double ReachOf(const Track& track, const Eigen::Vector2d& down) {
  if (track.body.kind == core::BodyKind::kSphere) {
    return track.body.radius_px.value;
  }
  std::vector<double> reach;
  for (const Pose& pose : track.poses) {
    const Eigen::Vector2d side(std::cos(pose.angle_rad),
                               std::sin(pose.angle_rad));
    const double along = std::abs(side.dot(down));
    const double across = std::abs(side.x() * down.y() - side.y() * down.x());
    reach.push_back(track.body.half_long_px.value * along +
                    track.body.half_short_px.value * across);
  }
  return Median(std::move(reach));
}

}  // namespace

std::optional<calib::GroundLine> GroundFromPath(const Track& track) {
  constexpr std::size_t kLeast = 8;
  if (track.poses.size() < kLeast) return std::nullopt;
  const core::PixelPoint origin = track.poses.front().centre;
  const auto from_origin = [&](const Pose& pose) {
    return Eigen::Vector2d(pose.centre.x_px - origin.x_px,
                           pose.centre.y_px - origin.y_px);
  };
  // The path's direction, by the middles of its first and last thirds; then by
  // least squares of what lies across it.
  const std::size_t n = track.poses.size();
  const std::size_t third = n / 3;
  Eigen::Vector2d early = Eigen::Vector2d::Zero();
  Eigen::Vector2d late = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < third; ++i) {
    early += from_origin(track.poses[i]) / static_cast<double>(third);
    late += from_origin(track.poses[n - 1 - i]) / static_cast<double>(third);
  }
  Eigen::Vector2d along = late - early;
  if (along.x() < 0.0) along = -along;  // to the right
  const double size = track.body.kind == core::BodyKind::kSphere
                          ? 2.0 * track.body.radius_px.value
                          : 2.0 * track.body.half_long_px.value;
  if (!(along.norm() > size)) return std::nullopt;
  along.normalize();
  for (int pass = 0; pass < 3; ++pass) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    const Eigen::Vector2d across(-along.y(), along.x());
    for (const Pose& pose : track.poses) {
      const double x = along.dot(from_origin(pose));
      const double y = across.dot(from_origin(pose));
      sx += x;
      sy += y;
      sxx += x * x;
      sxy += x * y;
    }
    const auto count = static_cast<double>(n);
    const double slope = (count * sxy - sx * sy) / (count * sxx - sx * sx);
    along = (along + slope * across).normalized();
  }
  // Down the picture: y grows.
  const Eigen::Vector2d down(-along.y(), along.x());
  std::vector<double> t, s, q;
  for (const Pose& pose : track.poses) {
    t.push_back(pose.time_s);
    s.push_back(along.dot(from_origin(pose)));
    q.push_back(down.dot(from_origin(pose)));
  }
  const double middle = 0.5 * (*std::min_element(s.begin(), s.end()) +
                               *std::max_element(s.begin(), s.end()));
  const double offset = Median(q);
  const auto path = FitParabola(t, s);
  const auto side = FitParabola(t, q);
  if (!path || !side) return std::nullopt;
  // Flight would accelerate down the picture.
  constexpr double kRolled_rad = 15.0 * core::kDegree;
  const double to_vertical = std::atan2(along.x(), std::abs(along.y()));
  if (to_vertical < kRolled_rad) return std::nullopt;
  constexpr double kClear = 5.0;
  const double a = std::abs(path->acceleration);
  const double c = std::abs(side->acceleration);
  if (a < kClear * path->u_acceleration ||
      c > std::max(kCarried * a, 3.0 * side->u_acceleration)) {
    return std::nullopt;
  }
  // As flight, an acceleration along the path would show as much across it as
  // the vertical lies across it; that must be clear of its own uncertainty.
  const double as_flight = a * std::abs(std::tan(to_vertical - kRolled_rad));
  if (as_flight < kClear * side->u_acceleration) return std::nullopt;

  const double ground = offset + ReachOf(track, down);
  const double from = *std::min_element(s.begin(), s.end());
  const double to = *std::max_element(s.begin(), s.end());
  const auto at = [&](double x) {
    const Eigen::Vector2d p = x * along + ground * down;
    return core::PixelPoint{origin.x_px + p.x(), origin.y_px + p.y()};
  };
  calib::GroundLine line = calib::GroundThrough(at(from), at(to), 0.0);
  line.reference = at(middle);
  line.source = calib::GroundSource::kContactPoints;
  constexpr double kCounting = 0.25;
  const double count = std::max(2.0, kCounting * static_cast<double>(n));
  std::vector<double> off;
  off.reserve(q.size());
  for (const double value : q) off.push_back(std::abs(value - offset));
  constexpr double kOfMedian = 1.4826;
  const double scatter = kOfMedian * Median(std::move(off));
  const double u_size = track.body.kind == core::BodyKind::kSphere
                            ? track.body.radius_px.u
                            : track.body.half_short_px.u;
  line.u_offset_px = std::hypot(scatter / std::sqrt(count), u_size);
  line.u_angle_rad = scatter * std::sqrt(12.0 / count) / (to - from);
  return line;
}

}  // namespace touchdown::vision
