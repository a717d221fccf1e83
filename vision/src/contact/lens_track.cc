#include "touchdown/vision/contact/lens_track.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "numbers/robust.h"
#include "numbers/symmetric_factor.h"
#include "track/image_size.h"

namespace touchdown::vision {
namespace {

// x, y, angle, long half side (or radius), short half side.
using ShapeVector = Eigen::Matrix<double, 5, 1>;

// A point of the outline with its outward normal.
struct RimPoint {
  core::PixelPoint at;
  Eigen::Vector2d normal;
};

// Points spread evenly along the outline, with outward normals.
std::vector<RimPoint> SpreadPoints(core::BodyKind kind, const ShapeVector& s) {
  std::vector<RimPoint> points;
  const double c = std::cos(s[2]);
  const double n = std::sin(s[2]);
  if (kind == core::BodyKind::kSphere) {
    // A lens's distortion is smooth over a body, so that few points suffice.
    // Not studied.
    constexpr int kPoints = 32;
    for (int k = 0; k < kPoints; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kPoints;
      const Eigen::Vector2d e(std::cos(angle), std::sin(angle));
      points.push_back({{s[0] + s[3] * e.x(), s[1] + s[3] * e.y()}, e});
    }
    return points;
  }
  // Points around a rectangle, whose sides are sampled one by one. Not studied.
  constexpr int kAround = 64;
  const double spacing = 4.0 * (s[3] + s[4]) / kAround;
  const auto side = [&](double half, double away, double ax, double ay,
                        double nx, double ny) {
    // Four points at least on each side: two would not separate its turn from
    // its place.
    const int count = std::max(4, static_cast<int>(2.0 * half / spacing));
    for (int k = 0; k < count; ++k) {
      const double along = half * (2.0 * (k + 0.5) / count - 1.0);
      points.push_back(
          {{s[0] + along * ax + away * nx, s[1] + along * ay + away * ny},
           {nx, ny}});
    }
  };
  side(s[3], s[4], c, n, -n, c);
  side(s[3], s[4], c, n, n, -c);
  side(s[4], s[3], -n, c, c, n);
  side(s[4], s[3], -n, c, -c, -n);
  return points;
}

// The outline that fits the distorted image of `ideal` best, as its difference
// from `seen`: least squares of the normal distances.
std::optional<ShapeVector> DistortedOffset(core::BodyKind kind,
                                           const ShapeVector& ideal,
                                           const ShapeVector& seen,
                                           const calib::Lens& lens) {
  const bool sphere = kind == core::BodyKind::kSphere;
  const double c = std::cos(seen[2]);
  const double n = std::sin(seen[2]);
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  ShapeVector right = ShapeVector::Zero();
  for (const RimPoint& p : SpreadPoints(kind, ideal)) {
    const core::PixelPoint q = calib::Distort(lens, p.at);
    const Eigen::Vector2d d(q.x_px - seen[0], q.y_px - seen[1]);
    ShapeVector row = ShapeVector::Zero();
    double off = 0.0;
    if (sphere) {
      const double r = d.norm();
      row[0] = d.x() / r;
      row[1] = d.y() / r;
      row[3] = 1.0;
      off = r - seen[3];
    } else {
      // The side on which the point lies keeps its name: angles differ little.
      const double turn = seen[2] - ideal[2];
      const Eigen::Vector2d e(
          std::cos(turn) * p.normal.x() - std::sin(turn) * p.normal.y(),
          std::sin(turn) * p.normal.x() + std::cos(turn) * p.normal.y());
      const bool end = std::abs(e.x() * c + e.y() * n) > 0.5;
      const Eigen::Vector2d along(-e.y(), e.x());
      row[0] = e.x();
      row[1] = e.y();
      // A turned normal meets a point farther along the side sooner.
      row[2] = -along.dot(d);
      row[end ? 3 : 4] = 1.0;
      off = e.dot(d) - seen[end ? 3 : 4];
    }
    normal += row * row.transpose();
    right += row * off;
  }
  if (sphere) {
    // A sphere has neither angle nor short side: their rows are held.
    normal(2, 2) = 1.0;
    normal(4, 4) = 1.0;
  }
  const ShapeVector solution = SymmetricFactor(normal).Solve(right);
  if (!solution.allFinite()) return std::nullopt;
  return solution;
}

// Finds the ideal outline whose distorted image is `seen`: fixed-point
// iteration with the lens's jacobian at the centre, which is exact but for the
// distortion's change across the body.
std::optional<ShapeVector> FindIdealShape(core::BodyKind kind,
                                          const ShapeVector& seen,
                                          const calib::Lens& lens,
                                          Eigen::Matrix2d& jacobian) {
  const auto centre = calib::Undistort(lens, {seen[0], seen[1]});
  if (!centre) return std::nullopt;
  jacobian = centre->jacobian;
  // Mean magnification at the centre: the square root of the change of area.
  const double magnified = std::sqrt(jacobian.determinant());
  const Eigen::Vector2d along =
      jacobian * Eigen::Vector2d(std::cos(seen[2]), std::sin(seen[2]));
  ShapeVector ideal;
  ideal << centre->point.x_px, centre->point.y_px,
      seen[2] + std::remainder(std::atan2(along.y(), along.x()) - seen[2],
                               2.0 * std::numbers::pi),
      magnified * seen[3], magnified * seen[4];
  if (kind == core::BodyKind::kSphere) ideal[2] = 0.0;
  // A bound only: the loop ends at the limit below. Not studied.
  constexpr int kMaxSteps = 8;
  // px: far below any u of a pose.
  constexpr double kConverged_px = 1e-7;
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto off = DistortedOffset(kind, ideal, seen, lens);
    if (!off) return std::nullopt;
    ideal.head<2>() -= jacobian * off->head<2>();
    if (kind != core::BodyKind::kSphere) ideal[2] -= (*off)[2];
    ideal.tail<2>() -= magnified * off->tail<2>();
    if (off->cwiseAbs().maxCoeff() < kConverged_px) break;
  }
  if (!ideal.allFinite() || !(ideal[3] > 0.0) || !(ideal[4] > 0.0)) {
    return std::nullopt;
  }
  return ideal;
}

// The outline as it was seen: a sphere's radius stands for both half sides.
ShapeVector SeenShape(const Track& track, const Pose& pose) {
  const bool sphere = track.body.kind == core::BodyKind::kSphere;
  ShapeVector s;
  s << pose.centre.x_px, pose.centre.y_px, sphere ? 0.0 : pose.angle_rad,
      (sphere ? track.body.radius_px : track.body.half_long_px).value,
      (sphere ? track.body.radius_px : track.body.half_short_px).value;
  s.tail<2>() *= pose.relative_size;
  return s;
}

core::Estimate Grown(const core::Estimate& e, double factor) {
  return core::Scaled(e, factor);
}

}  // namespace

Track Undistorted(const Track& track, const calib::Lens& lens) {
  Track out = track;
  out.poses.clear();
  std::vector<double> growth_long;   // ideal size over the size in the image
  std::vector<double> growth_short;  //
  std::vector<double> sizes;         // ideal size over the common one
  std::size_t lost = 0;
  for (const Pose& pose : track.poses) {
    const ShapeVector seen = SeenShape(track, pose);
    Eigen::Matrix2d j;
    const auto ideal = FindIdealShape(track.body.kind, seen, lens, j);
    if (!ideal) {
      ++lost;
      continue;
    }
    Pose p = pose;
    p.centre = {(*ideal)[0], (*ideal)[1]};
    Eigen::Matrix2d covariance;
    const double xy = pose.correlation_xy * pose.u_x_px * pose.u_y_px;
    // Place: C' = J C J^T.
    covariance << pose.u_x_px * pose.u_x_px, xy, xy, pose.u_y_px * pose.u_y_px;
    covariance = j * covariance * j.transpose();
    p.u_x_px = std::sqrt(covariance(0, 0));
    p.u_y_px = std::sqrt(covariance(1, 1));
    const double product = p.u_x_px * p.u_y_px;
    p.correlation_xy =
        product > 0.0 ? std::clamp(covariance(0, 1) / product, -1.0, 1.0) : 0.0;
    if (track.body.kind == core::BodyKind::kRectangle) {
      const Eigen::Vector2d along(std::cos(pose.angle_rad),
                                  std::sin(pose.angle_rad));
      p.angle_rad = (*ideal)[2];
      // A direction e turns by det(J) / |J e|^2 for each radian.
      p.u_angle_rad *= j.determinant() / (j * along).squaredNorm();
    }
    growth_long.push_back((*ideal)[3] / seen[3]);
    growth_short.push_back((*ideal)[4] / seen[4]);
    sizes.push_back(pose.relative_size * growth_long.back());
    out.poses.push_back(p);
  }
  if (lost > 0) {
    out.warnings.push_back(fmt::format(
        "in {} frames the body lies where the lens model does not hold; they "
        "are left out",
        lost));
  }
  if (out.poses.empty()) return out;

  // The common size is a mean over frames in which the body's image had the
  // sizes size / growth.
  const double by_long = Median(growth_long);
  const double by_short = Median(growth_short);
  out.body.radius_px = Grown(track.body.radius_px, by_long);
  out.body.half_long_px = Grown(track.body.half_long_px, by_long);
  out.body.half_short_px = Grown(track.body.half_short_px, by_short);
  out.body.whole_px *= by_long;
  out.body.blur_px *= by_long;
  if (!IsSteady(track)) {
    const double common = Median(sizes);
    const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
    // Of the size: a change below it is only the lens's (FollowSize takes one
    // below 1 % for none, too). Larger: a body that nears the camera is held at
    // one size.
    constexpr double kMinSizeChange = 0.01;
    const bool steady = (*most - *least) < kMinSizeChange * common;
    for (std::size_t i = 0; i < out.poses.size(); ++i) {
      out.poses[i].relative_size = sizes[i] / common;
    }
    out.body.radius_px = Grown(track.body.radius_px, common);
    if (steady) KeepSize(out);
  }
  return out;
}

}  // namespace touchdown::vision
