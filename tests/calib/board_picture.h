// Boards in space, seen through a known lens: their points, and pictures of
// them by casting a ray through every quarter of a pixel.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "touchdown/calib/board.h"
#include "touchdown/calib/lens.h"
#include "touchdown/calib/lens_calibration.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::calib::board_picture {

// Board coordinates to the camera's (x right, y down, z ahead).
struct BoardPose {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
};

inline Lens TestLens() {
  Lens lens;
  lens.fx_px = 801.0;
  lens.fy_px = 799.0;
  lens.cx_px = 323.4;
  lens.cy_px = 237.1;
  lens.k1 = -0.21;
  lens.k2 = 0.08;
  lens.p1 = 0.0007;
  lens.p2 = -0.0004;
  lens.k3 = -0.02;
  return lens;
}

inline std::vector<core::PixelPoint> Seen(const Board& board,
                                          const BoardPose& pose,
                                          const Lens& lens) {
  std::vector<core::PixelPoint> points;
  const double f = IdealFocal(lens);
  for (const core::PlanePoint& p : ListBoardPoints(board)) {
    const Eigen::Vector3d c =
        pose.turn * Eigen::Vector3d(p.x_m, p.y_m, 0.0) + pose.shift;
    points.push_back(Distort(lens, {f * c.x() / c.z() + lens.cx_px,
                                    f * c.y() / c.z() + lens.cy_px}));
  }
  return points;
}

// A board of `board` at `where` of the picture (0..1 each way), turned about
// its x and y axes; `size`: its width over the picture's.
inline BoardPose PoseAt(const Board& board, const Lens& lens, double where_x,
                        double where_y, double tilt_x, double tilt_y,
                        double size, double width_px = 640.0,
                        double height_px = 480.0) {
  BoardPose pose;
  pose.turn = (Eigen::AngleAxisd(tilt_y, Eigen::Vector3d::UnitY()) *
               Eigen::AngleAxisd(tilt_x, Eigen::Vector3d::UnitX()))
                  .toRotationMatrix();
  double wide_m = 0.0;
  double high_m = 0.0;
  for (const core::PlanePoint& p : ListBoardPoints(board)) {
    wide_m = std::max(wide_m, p.x_m);
    high_m = std::max(high_m, p.y_m);
  }
  const double f = IdealFocal(lens);
  const double depth = f * wide_m / (size * width_px);
  const Eigen::Vector3d centre(depth * (where_x * width_px - lens.cx_px) / f,
                               depth * (where_y * height_px - lens.cy_px) / f,
                               depth);
  pose.shift =
      centre - pose.turn * Eigen::Vector3d(0.5 * wide_m, 0.5 * high_m, 0.0);
  return pose;
}

// `count` views all over the picture, tilted to all sides by up to `tilt`.
inline std::vector<BoardPose> ManyPoses(const Board& board, const Lens& lens,
                                        int count, double tilt,
                                        std::mt19937_64& engine) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<BoardPose> poses;
  for (int i = 0; i < count; ++i) {
    const double x = 0.5 + 0.22 * (i % 3 - 1) + 0.03 * unit(engine);
    const double y = 0.5 + 0.24 * (i / 3 % 3 - 1) + 0.03 * unit(engine);
    poses.push_back(PoseAt(board, lens, x, y, tilt * unit(engine),
                           tilt * unit(engine), 0.45 + 0.05 * unit(engine)));
  }
  return poses;
}

inline std::vector<BoardView> Views(const Board& board,
                                    const std::vector<BoardPose>& poses,
                                    const Lens& lens, double noise_px,
                                    std::mt19937_64& engine) {
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<BoardView> views;
  for (const BoardPose& pose : poses) {
    BoardView view{"view" + std::to_string(views.size()),
                   Seen(board, pose, lens)};
    for (core::PixelPoint& p : view.points) {
      p.x_px += noise_px * normal(engine);
      p.y_px += noise_px * normal(engine);
    }
    views.push_back(view);
  }
  return views;
}

// 0 where the board is black at (x, y), 1 where it is white.
inline double Paint(const Board& board, double x_m, double y_m) {
  const double u = x_m / board.pitch_m;
  const double v = y_m / board.pitch_m;
  if (board.kind == BoardKind::kChessboard) {
    // One square more than inner corners on every side.
    if (u < -1.0 || v < -1.0 || u > board.columns || v > board.rows) return 1.0;
    const auto square =
        static_cast<int>(std::floor(u)) + static_cast<int>(std::floor(v));
    return square % 2 == 0 ? 0.1 : 0.9;
  }
  constexpr double kRadius = 0.28;  // of the pitch
  const bool shifted = board.kind == BoardKind::kAsymmetricCircles;
  const double row = shifted ? 2.0 * v : v;
  const double r = std::round(row);
  if (r < 0.0 || r > board.rows - 1) return 0.9;
  const double from = shifted && static_cast<int>(r) % 2 != 0 ? 0.5 : 0.0;
  const double c = std::round(u - from);
  if (c < 0.0 || c > board.columns - 1) return 0.9;
  const double radius = shifted ? 0.8 * kRadius : kRadius;
  const double dx = u - from - c;
  const double dy = v - (shifted ? 0.5 * r : r);
  return dx * dx + dy * dy < radius * radius ? 0.1 : 0.9;
}

inline vision::Image Picture(const Board& board, const BoardPose& pose,
                             const Lens& lens, std::int32_t width_px = 640,
                             std::int32_t height_px = 480,
                             double noise_dn = 0.0, std::uint64_t seed = 1) {
  vision::Image image;
  image.width_px = width_px;
  image.height_px = height_px;
  image.bit_depth = 8;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  const double f = IdealFocal(lens);
  const Eigen::Matrix3d back = pose.turn.transpose();
  const Eigen::Vector3d eye = -back * pose.shift;
  constexpr int kPart = 4;
  for (std::int32_t y = 0; y < height_px; ++y) {
    for (std::int32_t x = 0; x < width_px; ++x) {
      double sum = 0.0;
      for (int k = 0; k < kPart * kPart; ++k) {
        const double px = x + (k % kPart + 0.5) / kPart - 0.5;
        const double py = y + (k / kPart + 0.5) / kPart - 0.5;
        const auto ideal = Undistort(lens, {px, py});
        if (!ideal) continue;
        const Eigen::Vector3d ray =
            back * Eigen::Vector3d((ideal->point.x_px - lens.cx_px) / f,
                                   (ideal->point.y_px - lens.cy_px) / f, 1.0);
        const double t = -eye.z() / ray.z();
        sum += Paint(board, eye.x() + t * ray.x(), eye.y() + t * ray.y());
      }
      const double level =
          255.0 * sum / (kPart * kPart) + noise_dn * normal(engine);
      image.pixels.push_back(static_cast<std::byte>(
          std::clamp(static_cast<int>(std::lround(level)), 0, 255)));
    }
  }
  return image;
}

}  // namespace touchdown::calib::board_picture
