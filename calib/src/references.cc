#include "touchdown/calib/references.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <stdexcept>
#include <utility>

namespace touchdown::calib {
namespace {

core::PixelPoint Ideal(const std::optional<Lens>& lens, core::PixelPoint p) {
  if (!lens) return p;
  const auto ideal = Undistort(*lens, p);
  if (!ideal) {
    throw std::invalid_argument(
        fmt::format("point {},{} is {}: the lens model does not hold there, "
                    "must be a point of the picture",
                    p.x_px, p.y_px, "out of range"));
  }
  return ideal->point;
}

struct Segment {
  double length_px = 0.0;
  double angle_rad = 0.0;  // from +x towards +y
  double u_px = 0.0;       // of the length; over the length, of the angle
};

Segment MakeSegment(const MarkedPair& pair, const std::optional<Lens>& lens) {
  const core::PixelPoint a = Ideal(lens, pair.p1);
  const core::PixelPoint b = Ideal(lens, pair.p2);
  const double dx = b.x_px - a.x_px;
  const double dy = b.y_px - a.y_px;
  Segment segment{std::hypot(dx, dy), std::atan2(dy, dx),
                  std::numbers::sqrt2 * pair.u_point_px};
  if (!(segment.length_px > 0.0)) {
    throw std::invalid_argument(
        fmt::format("points are {},{} and {},{}, must be two different ones",
                    pair.p1.x_px, pair.p1.y_px, pair.p2.x_px, pair.p2.y_px));
  }
  return segment;
}

void RequireLength(const core::Estimate& length_m) {
  if (length_m.value > 0.0 && std::isfinite(length_m.value)) return;
  throw std::invalid_argument(fmt::format(
      "length is {} m, must be positive and finite", length_m.value));
}

using Pose = Eigen::Matrix<double, 6, 1>;

// What is read off a pose: yaw, pitch, scale, and the two ends of the middle
// row in the picture.
using Reading = Eigen::Matrix<double, 7, 1>;

Reading Read(const Pose& pose, const Board& board, const Lens& lens) {
  cv::Mat turn;
  cv::Rodrigues(cv::Vec3d(pose[0], pose[1], pose[2]), turn);
  const auto points = ListBoardPoints(board);
  double width_m = 0.0;
  double middle_m = 0.0;
  for (const core::PlanePoint& p : points) {
    width_m = std::max(width_m, p.x_m);
    middle_m = std::max(middle_m, 0.5 * p.y_m);
  }
  std::array<core::PixelPoint, 2> ideal;
  std::array<core::PixelPoint, 2> seen;
  const double f = IdealFocal(lens);
  for (std::size_t k = 0; k < 2; ++k) {
    const double x = k == 0 ? 0.0 : width_m;
    std::array<double, 3> c{};
    for (int i = 0; i < 3; ++i) {
      c[static_cast<std::size_t>(i)] = turn.at<double>(i, 0) * x +
                                       turn.at<double>(i, 1) * middle_m +
                                       pose[3 + i];
    }
    ideal[k] = {f * c[0] / c[2] + lens.cx_px, f * c[1] / c[2] + lens.cy_px};
    seen[k] = Distort(lens, ideal[k]);
  }
  // To the right in the picture.
  const double right = turn.at<double>(0, 0) < 0.0 ? -1.0 : 1.0;
  const double up = turn.at<double>(1, 2) > 0.0 ? -1.0 : 1.0;
  Reading reading;
  reading << std::asin(std::clamp(right * turn.at<double>(2, 0), -1.0, 1.0)),
      // The ground's normal leans towards the camera that looks down.
      std::asin(std::clamp(-up * turn.at<double>(2, 2), -1.0, 1.0)),
      std::hypot(ideal[1].x_px - ideal[0].x_px, ideal[1].y_px - ideal[0].y_px) /
          width_m,
      seen[0].x_px, seen[0].y_px, seen[1].x_px, seen[1].y_px;
  return reading;
}

}  // namespace

ScaleRecord MeasureScale(const MarkedPair& pair, const core::Estimate& length_m,
                         const std::optional<Lens>& lens) {
  RequireLength(length_m);
  const Segment segment = MakeSegment(pair, lens);
  const double value = segment.length_px / length_m.value;
  ScaleRecord record;
  record.px_per_m = {value,
                     value * std::hypot(segment.u_px / segment.length_px,
                                        length_m.u / length_m.value),
                     std::nullopt};
  record.length_m = length_m.value;
  return record;
}

core::Estimate CheckError(const ScaleRecord& scale, const MarkedPair& pair,
                          const core::Estimate& length_m,
                          const std::optional<Lens>& lens) {
  RequireLength(length_m);
  const Segment segment = MakeSegment(pair, lens);
  const double measured_m = segment.length_px / scale.px_per_m.value;
  const double u_measured_m =
      measured_m * std::hypot(segment.u_px / segment.length_px,
                              scale.px_per_m.u / scale.px_per_m.value);
  return {measured_m - length_m.value, std::hypot(u_measured_m, length_m.u),
          std::nullopt};
}

core::Estimate MeasureSlope(const MarkedPair& ground, const MarkedPair& plumb,
                            const std::optional<Lens>& lens) {
  const Segment along = MakeSegment(ground, lens);
  const Segment down = MakeSegment(plumb, lens);
  // A level line is across the plumb line; both have no direction of their own.
  const double slope =
      std::remainder(down.angle_rad - 0.5 * std::numbers::pi - along.angle_rad,
                     std::numbers::pi);
  return {slope,
          std::hypot(along.u_px / along.length_px, down.u_px / down.length_px),
          std::nullopt};
}

core::Expected<BoardOnGround> LocateBoard(
    const std::vector<core::PixelPoint>& points, const Board& board,
    const Lens& lens) {
  const auto plane = ListBoardPoints(board);
  if (points.size() != plane.size()) {
    throw std::invalid_argument(fmt::format(
        "points are {}, must be the board's {}", points.size(), plane.size()));
  }
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    object.emplace_back(plane[i].x_m, plane[i].y_m, 0.0);
    image.emplace_back(points[i].x_px, points[i].y_px);
  }
  const cv::Matx33d camera(lens.fx_px, 0.0, lens.cx_px, 0.0, lens.fy_px,
                           lens.cy_px, 0.0, 0.0, 1.0);
  const cv::Vec<double, 5> distortion(lens.k1, lens.k2, lens.p1, lens.p2,
                                      lens.k3);
  cv::Mat rotation;
  cv::Mat shift;
  Pose pose;
  Eigen::Matrix<double, 6, 6> covariance;
  BoardOnGround out;
  try {
    if (!cv::solvePnP(object, image, camera, distortion, rotation, shift)) {
      return core::AbsentBecause("the board's pose could not be found");
    }
    cv::solvePnPRefineLM(object, image, camera, distortion, rotation, shift);
    std::vector<cv::Point2d> projected;
    cv::Mat jacobian;
    cv::projectPoints(object, rotation, shift, camera, distortion, projected,
                      jacobian);
    Eigen::Matrix<double, 6, 6> information =
        Eigen::Matrix<double, 6, 6>::Zero();
    double squares = 0.0;
    for (int row = 0; row < jacobian.rows; ++row) {
      for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < 6; ++k) {
          information(i, k) +=
              jacobian.at<double>(row, i) * jacobian.at<double>(row, k);
        }
      }
    }
    for (std::size_t i = 0; i < image.size(); ++i) {
      const cv::Point2d off = image[i] - projected[i];
      squares += off.dot(off);
    }
    const auto n = static_cast<double>(image.size());
    out.rms_px = std::sqrt(squares / n);
    covariance = squares / (2.0 * n - 6.0) * information.inverse();
    for (int i = 0; i < 3; ++i) {
      pose[i] = rotation.at<double>(i);
      pose[3 + i] = shift.at<double>(i);
    }
  } catch (const cv::Exception& trouble) {
    return core::AbsentBecause(
        fmt::format("the board's pose could not be found ({})", trouble.err));
  }
  if (!covariance.allFinite() || covariance.diagonal().minCoeff() < 0.0) {
    return core::AbsentBecause(
        "the board is seen edge-on; raise the camera for this picture, or "
        "tilt it down");
  }
  const Reading reading = Read(pose, board, lens);
  Eigen::Matrix<double, 7, 6> slope;
  for (int k = 0; k < 6; ++k) {
    // A hundredth of the standard uncertainty: differences far above rounding,
    // far below curvature.
    const double step =
        std::max(1e-9, 0.01 * std::sqrt(std::max(covariance(k, k), 0.0)));
    Pose up = pose;
    Pose down = pose;
    up[k] += step;
    down[k] -= step;
    slope.col(k) =
        (Read(up, board, lens) - Read(down, board, lens)) / (2.0 * step);
  }
  const Eigen::Matrix<double, 7, 7> spread =
      slope * covariance * slope.transpose();
  const auto estimate = [&](int i) {
    return core::Estimate{reading[i], std::sqrt(std::max(spread(i, i), 0.0)),
                          std::nullopt};
  };
  out.ground.yaw_rad = estimate(0);
  out.pitch_rad = estimate(1);
  out.px_per_m = estimate(2);
  out.ground.p1 = {reading[3], reading[4]};
  out.ground.p2 = {reading[5], reading[6]};
  if (out.ground.p2.x_px < out.ground.p1.x_px) {
    std::swap(out.ground.p1, out.ground.p2);
  }
  out.ground.u_point_px =
      std::sqrt(std::max(0.5 * (spread(4, 4) + spread(6, 6)), 0.0));
  return out;
}

}  // namespace touchdown::calib
