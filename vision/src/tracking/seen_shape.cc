#include "tracking/seen_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "layers/shape_cover.h"
#include "tracking/layer_pictures.h"

namespace touchdown::vision {
namespace {

using layers::LayerPose;
using layers::PictureStack;
using layers::Shape;

// I - B at any place of a picture, between four pixels. Absent where one of
// them is not in the window, or not known of the background.
std::optional<double> DifferenceAt(const PictureStack& stack,
                                   std::size_t picture,
                                   const Background& background, double x,
                                   double y) {
  const auto level = stack.LevelAt(picture, x, y);
  if (!level) return std::nullopt;
  const auto left = static_cast<std::int32_t>(std::floor(x));
  const auto top = static_cast<std::int32_t>(std::floor(y));
  double behind = 0.0;
  for (std::int32_t j = top; j <= top + 1; ++j) {
    for (std::int32_t i = left; i <= left + 1; ++i) {
      if (!background.known_at(i, j)) return std::nullopt;
      behind += static_cast<double>(background.at(i, j)) *
                (1.0 - std::abs(x - i)) * (1.0 - std::abs(y - j));
    }
  }
  return static_cast<double>(*level) - behind;
}

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
    const double cosine = std::cos(pose.angle_rad);
    const double sine = std::sin(pose.angle_rad);
    for (int row = 0; row < rows(); ++row) {
      for (int column = 0; column < columns(); ++column) {
        const double along = x_of(column);
        const double across = y_of(row);
        const auto d = DifferenceAt(stack, picture, background,
                                    pose.x + cosine * along - sine * across,
                                    pose.y + sine * along + cosine * across);
        if (!d) continue;
        Cell& cell = cells_[Index(column, row)];
        cell.sum += *d;
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

// D beside an edge: of a place along it, so many px beyond where it should be.
using DifferenceBeside =
    std::function<std::optional<double>(std::size_t place, double beyond_px)>;

// px beyond an edge's expected place: where it is sought. From -5, with what is
// within from -5 to -3, a face's texture has more of a say: of 62 sides of
// photographed blocks one in twenty was off by 0.54 px or more, with these
// 0.31.
constexpr double kFrom_px = -3.0;
// A wider search meets what stands beside the body; a narrower one loses sides
// that were stated too small. Not studied.
constexpr double kTo_px = 4.0;

// Where the root mean square of D over an edge's places has fallen to half of
// what it is within the body, px beyond the expected place: a blurred edge is
// there, whatever the blur and the sign of the contrast. Absent where it does
// not fall, or fewer than `least` places are known.
std::optional<double> FindEdge(const DifferenceBeside& beside,
                               std::size_t places, std::size_t least) {
  // Within: clear of the blur, and near, since a face has a texture.
  constexpr double kWithin_px = -1.5;
  constexpr int kSteps = 4;  // a px; lines between
  const int last = static_cast<int>((kTo_px - kFrom_px) * kSteps);
  std::vector<std::optional<double>> rms;
  double within = 0.0;
  int of_within = 0;
  for (int k = 0; k <= last; ++k) {
    const double beyond_px = kFrom_px + static_cast<double>(k) / kSteps;
    double sum = 0.0;
    std::size_t known = 0;
    for (std::size_t place = 0; place < places; ++place) {
      const auto d = beside(place, beyond_px);
      if (!d) continue;
      sum += *d * *d;
      ++known;
    }
    rms.emplace_back();
    if (known < least) continue;
    rms.back() = std::sqrt(sum / static_cast<double>(known));
    if (beyond_px > kWithin_px) continue;
    within += *rms.back();
    ++of_within;
  }
  if (of_within == 0) return std::nullopt;
  const double half = 0.5 * within / of_within;
  for (std::size_t k = rms.size() - 1; k > 0; --k) {
    const auto& outer = rms[k];
    const auto& inner = rms[k - 1];
    if (!outer || !inner || *outer > half || *inner <= half) continue;
    return kFrom_px +
           (static_cast<double>(k - 1) + (*inner - half) / (*inner - *outer)) /
               kSteps;
  }
  return std::nullopt;
}

constexpr double kLength = 0.8;  // of a side: corners have two edges

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

Side End(const Rectangle& at, double way) {
  return {way, 0.0, at.half_long, at.half_short};
}
Side LongSide(const Rectangle& at, double way) {
  return {0.0, way, at.half_short, at.half_long};
}

// px that the edges of sides, taken together, are beyond them. Absent where
// they are not seen, or fewer than `least` px along them.
std::optional<double> FindSides(const MeanDifference& difference,
                                const Rectangle& at,
                                std::span<const Side> sides,
                                std::size_t least) {
  const double cosine = std::cos(at.turn_rad);
  const double sine = std::sin(at.turn_rad);
  const auto reach = static_cast<std::size_t>(kLength * sides.front().half);
  const std::size_t length = 2 * reach + 1;
  return FindEdge(
      [&](std::size_t place, double beyond_px) {
        const Side& side = sides[place / length];
        const double k =
            static_cast<double>(place % length) - static_cast<double>(reach);
        const double out = side.reach + beyond_px;
        const double u = side.out_x * out - side.out_y * k;
        const double v = side.out_y * out + side.out_x * k;
        return difference.Between(at.x + cosine * u - sine * v,
                                  at.y + sine * u + cosine * v);
      },
      sides.size() * length, least);
}

// The rectangle with each side where its edge is.
Rectangle MoveToEdges(const MeanDifference& difference, const Rectangle& at) {
  // px beyond each; 0 where an edge is not seen along half of its side.
  const auto edge = [&](const Side& side) {
    return FindSides(difference, at, {&side, 1},
                     static_cast<std::size_t>(kLength * side.half) + 1)
        .value_or(0.0);
  };
  const double ahead = edge(End(at, 1.0));
  const double back = edge(End(at, -1.0));
  const double down = edge(LongSide(at, 1.0));
  const double up = edge(LongSide(at, -1.0));
  Rectangle out = at;
  out.half_long += 0.5 * (ahead + back);
  out.half_short += 0.5 * (down + up);
  const double along = 0.5 * (ahead - back);
  const double across = 0.5 * (down - up);
  out.x += std::cos(at.turn_rad) * along - std::sin(at.turn_rad) * across;
  out.y += std::sin(at.turn_rad) * along + std::cos(at.turn_rad) * across;
  return out;
}

// Noise is a seventh in the mean of so many; more cost time.
constexpr std::size_t kMostFrames = 48;

// D within `shape` about a track's poses.
MeanDifference MeasureAlong(Clip& clip, const Background& background,
                            const Track& track, const Shape& shape) {
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
  return difference;
}

// A circle in the body's coordinates, and a part of it.
struct Circle {
  double x = 0.0;
  double y = 0.0;
  double radius = 0.0;
};
struct Arc {
  double middle_rad = 0.0;
  double reach_rad = std::numbers::pi;  // to both ends
};

// px that the edge of a circle's arc is beyond it. Absent where it is not seen,
// or fewer than `least` px along it.
std::optional<double> FindArc(const MeanDifference& difference,
                              const Circle& at, const Arc& arc,
                              std::size_t least) {
  const double length = 2.0 * arc.reach_rad * at.radius;
  return FindEdge(
      [&](std::size_t place, double beyond_px) {
        const double angle = arc.middle_rad - arc.reach_rad +
                             static_cast<double>(place) / at.radius;
        const double out = at.radius + beyond_px;
        return difference.Between(at.x + out * std::cos(angle),
                                  at.y + out * std::sin(angle));
      },
      static_cast<std::size_t>(length), least);
}

// The circle with each quarter where its edge is.
Circle MoveToEdges(const MeanDifference& difference, const Circle& at) {
  constexpr double kQuarter_rad = 0.5 * std::numbers::pi;  // of a turn
  const double quarter_px = kQuarter_rad * at.radius;
  // px beyond; 0 where an edge is not seen along half of its quarter.
  const auto edge = [&](double middle_rad) {
    return FindArc(difference, at, {middle_rad, 0.5 * kQuarter_rad},
                   static_cast<std::size_t>(0.5 * quarter_px) + 1)
        .value_or(0.0);
  };
  const double ahead = edge(0.0);
  const double back = edge(2.0 * kQuarter_rad);
  const double down = edge(kQuarter_rad);
  const double up = edge(3.0 * kQuarter_rad);
  return {at.x + 0.5 * (ahead - back), at.y + 0.5 * (down - up),
          at.radius + 0.25 * (ahead + back + down + up)};
}

}  // namespace

std::optional<SeenRectangle> TakeSeenRectangle(Clip& clip,
                                               const Background& background,
                                               const Track& track) {
  const Shape shape{false, track.body.half_long_px.value,
                    track.body.half_short_px.value};
  const MeanDifference difference =
      MeasureAlong(clip, background, track, shape);
  // Standard deviations of a mean: more, and a faint face is not seen.
  constexpr double kSigmas = 4.0;
  const double noise_dn =
      kSigmas *
      std::sqrt(background.UsualVariance() /
                static_cast<double>(std::min(track.poses.size(), kMostFrames)));
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
  Rectangle at{static_cast<double>(least.center.x),
               static_cast<double>(least.center.y), turn,
               0.5 * static_cast<double>(sides.width),
               0.5 * static_cast<double>(sides.height)};
  // Twice: the least rectangle has the blur within.
  for (int round = 0; round < 2; ++round) at = MoveToEdges(difference, at);
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

std::optional<SeenSides> MeasureSeenSides(Clip& clip,
                                          const Background& background,
                                          const Track& track) {
  const BodyImage& body = track.body;
  constexpr std::size_t kLeast = 8;  // places, px: fewer are one mark's
  constexpr double kReach_px = kTo_px + 1.0;  // D lies between two pixels
  // Layers that settled on one wrong side have their poses off by half of it:
  // the edges about the moved centre, where each side alone tells the same.
  const auto choose = [](std::optional<double> about_moved, double each_px,
                         std::optional<double> about_own) {
    constexpr double kSame_px = 0.5;  // not studied
    return about_moved && std::abs(*about_moved - each_px) < kSame_px
               ? about_moved
               : about_own;
  };
  if (body.kind == core::BodyKind::kSphere) {
    const Circle at{.radius = body.radius_px.value};
    const double reach = at.radius + kReach_px;
    const MeanDifference difference =
        MeasureAlong(clip, background, track, {true, reach, reach});
    const Circle moved = MoveToEdges(difference, at);
    const auto beyond =
        choose(FindArc(difference, {moved.x, moved.y, at.radius}, {}, kLeast),
               moved.radius - at.radius, FindArc(difference, at, {}, kLeast));
    if (!beyond) return std::nullopt;
    return SeenSides{at.radius + *beyond, at.radius + *beyond};
  }
  const Rectangle at{.half_long = body.half_long_px.value,
                     .half_short = body.half_short_px.value};
  const MeanDifference difference = MeasureAlong(
      clip, background, track,
      {false, at.half_long + kReach_px, at.half_short + kReach_px});
  const Rectangle moved = MoveToEdges(difference, at);
  const Rectangle about{moved.x, moved.y, 0.0, at.half_long, at.half_short};
  const auto find = [&](const std::array<Side, 2>& pair, double each_px) {
    return choose(FindSides(difference, about, pair, kLeast), each_px,
                  FindSides(difference, at, pair, kLeast));
  };
  const auto ends =
      find({End(at, 1.0), End(at, -1.0)}, moved.half_long - at.half_long);
  const auto sides = find({LongSide(at, 1.0), LongSide(at, -1.0)},
                          moved.half_short - at.half_short);
  if (!ends || !sides) return std::nullopt;
  return SeenSides{at.half_long + *ends, at.half_short + *sides};
}

}  // namespace touchdown::vision
