#include "tracking/seen_rectangle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "layers/shape_cover.h"
#include "tracking/layer_pictures.h"

namespace touchdown::vision {
namespace {

using layers::LayerPose;
using layers::PictureStack;
using layers::Shape;

// D on a grid of pixels over the body's coordinates.
class MeanDifference {
 public:
  explicit MeanDifference(const Shape& shape)
      : reach_x_(static_cast<int>(std::ceil(shape.half_long))),
        reach_y_(static_cast<int>(std::ceil(shape.half_short))),
        cells_(static_cast<std::size_t>(columns()) *
               static_cast<std::size_t>(rows())) {}

  int columns() const { return 2 * reach_x_ + 1; }
  int rows() const { return 2 * reach_y_ + 1; }
  double x_of(int column) const { return column - reach_x_; }
  double y_of(int row) const { return row - reach_y_; }
  // At any place, between four of the grid. Absent where one of them is.
  std::optional<double> Between(double x, double y) const {
    const double u = x + reach_x_;
    const double v = y + reach_y_;
    const int column = static_cast<int>(std::floor(u));
    const int row = static_cast<int>(std::floor(v));
    if (column < 0 || row < 0 || column + 1 >= columns() || row + 1 >= rows()) {
      return std::nullopt;
    }
    double sum = 0.0;
    for (int j = 0; j <= 1; ++j) {
      for (int i = 0; i <= 1; ++i) {
        const auto d = At(column + i, row + j);
        if (!d) return std::nullopt;
        sum += *d * (1.0 - std::abs(u - (column + i))) *
               (1.0 - std::abs(v - (row + j)));
      }
    }
    return sum;
  }
  // Absent where too few frames tell.
  std::optional<double> At(int column, int row) const {
    constexpr int kLeastFrames = 3;  // one or two may be an outlier's
    const Cell& cell = cells_[Index(column, row)];
    if (cell.frames < kLeastFrames) return std::nullopt;
    return cell.sum / cell.frames;
  }

  void Add(const PictureStack& stack, std::size_t picture,
           const LayerPose& pose, const Background& background) {
    const core::PixelRect& window = stack.windows[picture];
    const double cosine = std::cos(pose.angle_rad);
    const double sine = std::sin(pose.angle_rad);
    for (int row = 0; row < rows(); ++row) {
      for (int column = 0; column < columns(); ++column) {
        const double along = x_of(column);
        const double across = y_of(row);
        const auto x = static_cast<std::int32_t>(
            std::lround(pose.x + cosine * along - sine * across));
        const auto y = static_cast<std::int32_t>(
            std::lround(pose.y + sine * along + cosine * across));
        if (x < window.x || y < window.y || x >= window.x + window.width ||
            y >= window.y + window.height || !background.known_at(x, y)) {
          continue;
        }
        Cell& cell = cells_[Index(column, row)];
        cell.sum += static_cast<double>(
            stack.WindowRow(picture, y)[x - window.x] - background.at(x, y));
        ++cell.frames;
      }
    }
  }

 private:
  struct Cell {
    double sum = 0.0;
    int frames = 0;
  };
  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns()) +
           static_cast<std::size_t>(column);
  }

  int reach_x_;
  int reach_y_;
  std::vector<Cell> cells_;
};

// The places that differ, most of whose neighbours do, too.
std::vector<cv::Point2f> ListSeen(const MeanDifference& difference,
                                  double noise_dn) {
  std::vector<double> sizes;
  for (int row = 0; row < difference.rows(); ++row) {
    for (int column = 0; column < difference.columns(); ++column) {
      if (const auto d = difference.At(column, row)) {
        sizes.push_back(std::abs(*d));
      }
    }
  }
  std::vector<cv::Point2f> seen;
  if (sizes.empty()) return seen;
  // Of the difference that one place in ten exceeds. Parts of a face are
  // fainter than others; a still picture is off by less. Not studied.
  constexpr double kOfStrong = 0.1;
  const auto strong =
      sizes.begin() + static_cast<std::ptrdiff_t>(9 * sizes.size() / 10);
  std::nth_element(sizes.begin(), strong, sizes.end());
  const double least = std::max(kOfStrong * *strong, noise_dn);
  const auto differs = [&](int column, int row) {
    const auto d = difference.At(column, row);
    return d && std::abs(*d) > least;
  };
  for (int row = 1; row + 1 < difference.rows(); ++row) {
    for (int column = 1; column + 1 < difference.columns(); ++column) {
      int count = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) count += differs(column + i, row + j);
      }
      constexpr int kMost = 5;  // of nine
      if (count < kMost) continue;
      seen.emplace_back(static_cast<float>(difference.x_of(column)),
                        static_cast<float>(difference.y_of(row)));
    }
  }
  return seen;
}

// A rectangle in the body's coordinates.
struct Rectangle {
  double x = 0.0;
  double y = 0.0;
  double turn_rad = 0.0;
  double half_long = 0.0;
  double half_short = 0.0;
};

// A side of it: the way out, and what it is away and long, both halved.
struct Side {
  double out_x = 0.0;
  double out_y = 0.0;
  double reach = 0.0;
  double half = 0.0;
};

// Root mean square of D on a line beside a side, `outside` px beyond it. Absent
// where most of it is not known.
std::optional<double> MeasureBeside(const MeanDifference& difference,
                                    const Rectangle& at, const Side& side,
                                    double outside) {
  constexpr double kLength = 0.8;  // of the side: corners have two of them
  const double cosine = std::cos(at.turn_rad);
  const double sine = std::sin(at.turn_rad);
  const int reach = static_cast<int>(kLength * side.half);
  double sum = 0.0;
  int known = 0;
  for (int k = -reach; k <= reach; ++k) {
    const double u = side.out_x * (side.reach + outside) - side.out_y * k;
    const double v = side.out_y * (side.reach + outside) + side.out_x * k;
    const auto d = difference.Between(at.x + cosine * u - sine * v,
                                      at.y + sine * u + cosine * v);
    if (!d) continue;
    sum += *d * *d;
    ++known;
  }
  if (known <= reach) return std::nullopt;
  return std::sqrt(sum / known);
}

// Where a side's difference has fallen to half of what it is within the body:
// px beyond the side. A blurred edge is there, whatever the blur and the sign
// of the contrast along it. 0 where it does not fall.
double FindEdge(const MeanDifference& difference, const Rectangle& at,
                const Side& side) {
  // px: what is within is looked for from kFrom to kWithin, clear of the blur.
  constexpr int kFrom = -5;
  constexpr int kWithin = -3;
  constexpr int kTo = 4;
  constexpr int kSteps = 4;  // a px
  std::vector<std::optional<double>> beside;
  double within = 0.0;
  for (int k = kFrom * kSteps; k <= kTo * kSteps; ++k) {
    const double outside = static_cast<double>(k) / kSteps;
    beside.push_back(MeasureBeside(difference, at, side, outside));
    if (k <= kWithin * kSteps) {
      within +=
          beside.back().value_or(0.0) / ((kWithin - kFrom) * kSteps + 1.0);
    }
  }
  for (std::size_t i = beside.size() - 1; i > 0; --i) {
    if (!beside[i] || !beside[i - 1]) continue;
    const double over = *beside[i - 1] - 0.5 * within;
    const double under = *beside[i] - 0.5 * within;
    if (over <= 0.0 || under > 0.0) continue;
    return kFrom +
           (static_cast<double>(i) - 1.0 + over / (over - under)) / kSteps;
  }
  return 0.0;
}

// The rectangle with each side where its edge is.
Rectangle MoveToEdges(const MeanDifference& difference, const Rectangle& at) {
  const auto edge = [&](double out_x, double out_y) {
    return std::abs(out_x) > 0.0
               ? FindEdge(difference, at,
                          {out_x, out_y, at.half_long, at.half_short})
               : FindEdge(difference, at,
                          {out_x, out_y, at.half_short, at.half_long});
  };
  const double ahead = edge(1.0, 0.0);
  const double back = edge(-1.0, 0.0);
  const double down = edge(0.0, 1.0);
  const double up = edge(0.0, -1.0);
  Rectangle out = at;
  out.half_long += 0.5 * (ahead + back);
  out.half_short += 0.5 * (down + up);
  const double along = 0.5 * (ahead - back);
  const double across = 0.5 * (down - up);
  out.x += std::cos(at.turn_rad) * along - std::sin(at.turn_rad) * across;
  out.y += std::sin(at.turn_rad) * along + std::cos(at.turn_rad) * across;
  return out;
}

}  // namespace

std::optional<SeenRectangle> TakeSeenRectangle(Clip& clip,
                                               const Background& background,
                                               const Track& track) {
  // Noise is a seventh in the mean of so many; more cost time.
  constexpr std::size_t kMostFrames = 48;
  const Shape shape{false, track.body.half_long_px.value,
                    track.body.half_short_px.value};
  LayerPath path;
  for (const std::size_t i : SpreadEvenly(track.poses.size(), kMostFrames)) {
    const Pose& pose = track.poses[i];
    path.frames.push_back(pose.frame);
    path.poses.push_back({pose.centre.x_px, pose.centre.y_px, pose.angle_rad});
  }
  const PictureStack stack = ReadAround(clip, path, shape);
  MeanDifference difference(shape);
  for (std::size_t t = 0; t < path.poses.size(); ++t) {
    difference.Add(stack, t, path.poses[t], background);
  }
  // Standard deviations of a mean: more, and a faint face is not seen.
  constexpr double kSigmas = 4.0;
  const double noise_dn =
      kSigmas * std::sqrt(background.UsualVariance() /
                          static_cast<double>(path.frames.size()));
  const std::vector<cv::Point2f> seen = ListSeen(difference, noise_dn);
  constexpr std::size_t kLeastPlaces = 20;  // px: fewer make no rectangle
  if (seen.size() < kLeastPlaces) return std::nullopt;
  const cv::RotatedRect least = cv::minAreaRect(seen);
  double turn = static_cast<double>(least.angle) * std::numbers::pi / 180.0;
  cv::Size2f sides = least.size;
  if (sides.width < sides.height) {
    std::swap(sides.width, sides.height);
    turn += 0.5 * std::numbers::pi;
  }
  // To the nearest of the attitudes that look alike.
  turn = std::remainder(turn, std::numbers::pi);
  const Rectangle at =
      MoveToEdges(difference, {static_cast<double>(least.center.x),
                               static_cast<double>(least.center.y), turn,
                               0.5 * static_cast<double>(sides.width),
                               0.5 * static_cast<double>(sides.height)});
  SeenRectangle out{track};
  out.track.body.half_long_px.value = at.half_long;
  out.track.body.half_short_px.value = at.half_short;
  // px: neighbours are asked for, and a start is no better.
  constexpr float kEnd_px = 2.0F;
  const auto end_x =
      static_cast<float>(difference.x_of(difference.columns() - 1)) - kEnd_px;
  const auto end_y =
      static_cast<float>(difference.y_of(difference.rows() - 1)) - kEnd_px;
  out.goes_on =
      std::any_of(seen.begin(), seen.end(), [&](const cv::Point2f& place) {
        return std::abs(place.x) > end_x || std::abs(place.y) > end_y;
      });
  for (Pose& pose : out.track.poses) {
    const double cosine = std::cos(pose.angle_rad);
    const double sine = std::sin(pose.angle_rad);
    pose.centre.x_px += cosine * at.x - sine * at.y;
    pose.centre.y_px += sine * at.x + cosine * at.y;
    pose.angle_rad += turn;
  }
  return out;
}

}  // namespace touchdown::vision
