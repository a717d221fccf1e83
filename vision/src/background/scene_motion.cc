#include "background/scene_motion.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "background/cubic.h"
#include "numbers/robust.h"
#include "numbers/symmetric_factor.h"

namespace touchdown::vision {
namespace {

// The side of the blocks whose means are compared, px: the picture is then
// about as large as 640 x 480. Smaller loses sight of fast motion, larger of
// slow. Not studied.
std::int32_t ChooseBlock(const core::Frame& frame) {
  constexpr double kArea_px = 640.0 * 480.0;  // of means
  const double area = static_cast<double>(frame.width_px) * frame.height_px;
  return std::max(
      1, static_cast<std::int32_t>(std::lround(std::sqrt(area / kArea_px))));
}

// A frame by the means of its blocks, each computed when it is asked for.
class Means {
 public:
  Means(const core::Frame& frame, std::int32_t block_px)
      : frame_(frame), block_px_(block_px) {}

  std::int32_t width() const { return frame_.width_px / block_px_; }
  std::int32_t height() const { return frame_.height_px / block_px_; }

  float At(std::int32_t x, std::int32_t y) const {
    return frame_.is_16_bit() ? MeanOf<std::uint16_t>(x, y)
                              : MeanOf<std::uint8_t>(x, y);
  }

  std::optional<float> Between(double x, double y) const {
    return InterpolateCubic(
        width(), height(), x, y,
        [this](std::int32_t i, std::int32_t j) { return At(i, j); });
  }

 private:
  template <class Sample>
  float MeanOf(std::int32_t x, std::int32_t y) const {
    if (block_px_ == 1) return static_cast<float>(frame_.row<Sample>(y)[x]);
    std::uint32_t sum = 0;
    for (std::int32_t j = 0; j < block_px_; ++j) {
      const Sample* const row =
          frame_.row<Sample>(block_px_ * y + j) + block_px_ * x;
      for (std::int32_t i = 0; i < block_px_; ++i) sum += row[i];
    }
    return static_cast<float>(sum) / static_cast<float>(block_px_ * block_px_);
  }

  const core::Frame& frame_;
  std::int32_t block_px_;
};

// The nine levels about a pixel.
struct Neighbours {
  double at[3][3];

  Neighbours(const Means& means, std::int32_t x, std::int32_t y) {
    for (std::int32_t j = 0; j < 3; ++j) {
      for (std::int32_t i = 0; i < 3; ++i) {
        at[j][i] = static_cast<double>(means.At(x + i - 1, y + j - 1));
      }
    }
  }
  double GradientX() const {  // Sobel
    return 0.125 * (at[0][2] - at[0][0] + 2.0 * (at[1][2] - at[1][0]) +
                    at[2][2] - at[2][0]);
  }
  double GradientY() const {
    return 0.125 * (at[2][0] - at[0][0] + 2.0 * (at[2][1] - at[0][1]) +
                    at[2][2] - at[0][2]);
  }
  // Second differences in both directions: no plane has them.
  double Unevenness() const {
    return at[0][0] + at[0][2] + at[2][0] + at[2][2] + 4.0 * at[1][1] -
           2.0 * (at[0][1] + at[1][0] + at[1][2] + at[2][1]);
  }
};

// The side of the squares of which each has one place, px.
std::int32_t StepFor(double area_px, double places) {
  return std::max(
      1, static_cast<std::int32_t>(std::lround(std::sqrt(area_px / places))));
}

// A place of every square of the picture. Each column begins lower than the one
// before by the golden section of a step: no edge, level or upright, lies
// between all places.
template <class Visit>
void VisitPlaces(const Means& means, std::int32_t step, const Visit& visit) {
  constexpr double kGolden = 0.618034;  // the golden section
  double lower = 0.0;
  for (std::int32_t x = 1; x + 1 < means.width(); x += step) {
    lower = std::fmod(lower + kGolden, 1.0);
    for (auto y = 1 + static_cast<std::int32_t>(lower * step);
         y + 1 < means.height(); y += step) {
      visit(x, y);
    }
  }
}

// What is left of a point's level if the scene moved so; nothing where its
// place lies outside. `centre`: of the picture of means.
template <class Point>
std::optional<float> Residual(const Means& means, const Point& p,
                              const core::PixelPoint& centre,
                              const Similarity& m, double gain) {
  std::optional<float> level;
  if (m == Similarity{}) {
    level = means.At(static_cast<std::int32_t>(p.x),
                     static_cast<std::int32_t>(p.y));
  } else {
    const auto x = static_cast<double>(p.x);
    const auto y = static_cast<double>(p.y);
    const double dx = x - centre.x_px;
    const double dy = y - centre.y_px;
    level = means.Between(x + m.shift_x_px + m.grow * dx - m.turn * dy,
                          y + m.shift_y_px + m.turn * dx + m.grow * dy);
  }
  if (level) *level -= static_cast<float>(gain) * p.level;
  return level;
}

// The light's factor if the scene is at rest.
template <class Point>
double GainAtRest(const Means& means, const std::vector<Point>& points) {
  std::vector<float> gains;
  for (const Point& p : points) {
    if (!(p.level > 0.0F)) continue;
    gains.push_back(means.At(static_cast<std::int32_t>(p.x),
                             static_cast<std::int32_t>(p.y)) /
                    p.level);
  }
  return gains.empty() ? 1.0 : static_cast<double>(MedianInPlace(gains));
}

// Unknowns: shift, growth and turn, px at the picture's corners, and the gain
// of the light.
constexpr int kUnknowns = 5;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Information = Eigen::Matrix<double, kUnknowns, kUnknowns>;

}  // namespace

SceneReference::SceneReference(const core::Frame& frame, int points)
    : block_px_(ChooseBlock(frame)) {
  const Means means(frame, block_px_);
  centre_ = {0.5 * (means.width() - 1), 0.5 * (means.height() - 1)};
  reach_ = std::max(1.0, std::hypot(centre_.x_px, centre_.y_px));
  const double area = static_cast<double>(means.width()) * means.height();
  // Places whose unevenness tells the noise: to 2 %. Not studied.
  constexpr double kNoisePlaces = 1000.0;
  double unevenness = 0.0;
  double places = 0.0;
  VisitPlaces(means, StepFor(area, kNoisePlaces),
              [&](std::int32_t x, std::int32_t y) {
                unevenness += std::abs(Neighbours(means, x, y).Unevenness());
                places += 1.0;
              });
  if (places == 0.0) return;
  // Noise of a pixel, DN (Immerkaer 1996), which texture makes larger, and of
  // Sobel's gradient, DN / px.
  const double noise =
      std::sqrt(std::numbers::pi / 2.0) / 6.0 * unevenness / places;
  const double gradient_noise = std::sqrt(12.0) / 8.0 * noise;
  // Standard deviations of that, of a point's gradient and of what it has
  // across or down, which else is none: along an edge, noise would pass for
  // texture, and where nothing tells of a shift, least squares do not come to
  // an end.
  constexpr double kLeastGradient = 9.0;
  constexpr double kLeastPart = 3.0;
  const double least = std::pow(kLeastGradient * gradient_noise, 2);
  // Places that are looked at for each point that is taken. Not studied.
  constexpr double kPlacesPerPoint = 4.0;
  std::vector<std::pair<double, Point>> found;  // with its gradient's square
  VisitPlaces(
      means, StepFor(area, kPlacesPerPoint * points),
      [&](std::int32_t x, std::int32_t y) {
        // Most places are flat, and four neighbours show it: their difference
        // is at most twice Sobel's on an edge.
        const auto across =
            static_cast<double>(means.At(x + 1, y) - means.At(x - 1, y));
        const auto down =
            static_cast<double>(means.At(x, y + 1) - means.At(x, y - 1));
        if (across * across + down * down <= least) return;
        const Neighbours near(means, x, y);
        const double gx = near.GradientX();
        const double gy = near.GradientY();
        const double square = gx * gx + gy * gy;
        if (square < least ||
            near.at[1][1] >= static_cast<double>(frame.full_scale())) {
          return;
        }
        found.push_back({square,
                         {y * kDown / means.height() * kAcross +
                              x * kAcross / means.width(),
                          static_cast<float>(x), static_cast<float>(y),
                          static_cast<float>(near.at[1][1]),
                          static_cast<float>(gx), static_cast<float>(gy)}});
      });
  // The strongest first.
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first > b.first; });
  const auto most =
      static_cast<std::size_t>(std::max(1, points / static_cast<int>(kTiles)));
  std::vector<std::size_t> taken(kTiles);
  const auto least_part = static_cast<float>(kLeastPart * gradient_noise);
  const auto clear = [least_part](float part) {
    return std::abs(part) < least_part ? 0.0F : part;
  };
  for (auto& [square, point] : found) {
    if (taken[static_cast<std::size_t>(point.tile)]++ >= most) continue;
    point.gx = clear(point.gx);
    point.gy = clear(point.gy);
    points_.push_back(point);
  }
}

Eigen::Vector4d SceneReference::Slopes(const Point& p) const {
  const double dx = (static_cast<double>(p.x) - centre_.x_px) / reach_;
  const double dy = (static_cast<double>(p.y) - centre_.y_px) / reach_;
  const auto gx = static_cast<double>(p.gx);
  const auto gy = static_cast<double>(p.gy);
  return {gx, gy, gx * dx + gy * dy, gy * dx - gx * dy};
}

Eigen::Vector4d SceneReference::Lengths(const Similarity& m) const {
  return {m.shift_x_px, m.shift_y_px, m.grow * reach_, m.turn * reach_};
}

Similarity SceneReference::ToBlocks(Similarity motion) const {
  // Growth and turn are the same of both pictures; lengths are not.
  motion.shift_x_px /= block_px_;
  motion.shift_y_px /= block_px_;
  return motion;
}

SceneMotion SceneReference::Fit(const core::Frame& frame,
                                const Similarity& start, double small_step_px,
                                bool can_turn) const {
  // Rounds of least squares. Not studied.
  constexpr int kMostRounds = 12;
  // What nothing tells stays where it is: standard deviation of a step, px, and
  // of the gain. Larger: beside a single edge, points of another motion decide;
  // smaller: what little tells decides slowly. Not studied.
  constexpr double kPriorStep_px = 1.0;
  constexpr double kPriorGain = 0.5;
  constexpr double kLocked = 1e12;  // precision of what does not move
  // Of a difference of two rounded levels, DN.
  const double rounding = 1.0 / std::sqrt(6.0);
  const Means means(frame, block_px_);
  SceneMotion out;
  out.motion = ToBlocks(start);
  std::vector<std::optional<float>> offs(points_.size());
  std::vector<float> sizes;
  Information covariance = Information::Zero();
  for (int round = 0; round < kMostRounds; ++round) {
    sizes.clear();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      offs[i] = Residual(means, points_[i], centre_, out.motion, out.gain);
      if (offs[i]) sizes.push_back(std::abs(*offs[i]));
    }
    if (sizes.size() < kFewPoints) {  // lost
      out.corner_px = std::numeric_limits<double>::infinity();
      return out;
    }
    out.sigma_dn = std::max(
        rounding, kSigmaPerMedian * static_cast<double>(MedianInPlace(sizes)));
    Information information = Information::Zero();
    information.diagonal().head<4>().setConstant(
        1.0 / (kPriorStep_px * kPriorStep_px));
    if (!can_turn) information(2, 2) = information(3, 3) = kLocked;
    information(4, 4) = 1.0 / (kPriorGain * kPriorGain);
    Unknowns pull = Unknowns::Zero();
    for (std::size_t i = 0; i < offs.size(); ++i) {
      if (!offs[i]) continue;
      const auto off = static_cast<double>(*offs[i]);
      const double t = off / (kTukeyCut * out.sigma_dn);
      if (std::abs(t) >= 1.0) continue;
      const double weight =
          (1.0 - t * t) * (1.0 - t * t) / (out.sigma_dn * out.sigma_dn);
      Unknowns j;
      j << out.gain * Slopes(points_[i]),
          -static_cast<double>(points_[i].level);
      information += weight * j * j.transpose();
      pull -= weight * off * j;
    }
    const SymmetricFactor factor(information);
    const Unknowns step = factor.Solve(pull);
    out.motion.shift_x_px += step(0);
    out.motion.shift_y_px += step(1);
    out.motion.grow += step(2) / reach_;
    out.motion.turn += step(3) / reach_;
    out.gain += step(4);
    covariance = factor.Inverse();
    if (step.head<4>().cwiseAbs().maxCoeff() * block_px_ < small_step_px) break;
  }
  const Eigen::Vector4d lengths = Lengths(out.motion);
  const Eigen::Matrix4d of_motion = covariance.topLeftCorner<4, 4>();
  for (const double x : {-centre_.x_px, centre_.x_px}) {
    for (const double y : {-centre_.y_px, centre_.y_px}) {
      Eigen::Matrix<double, 2, 4> at;
      at << 1.0, 0.0, x / reach_, -y / reach_, 0.0, 1.0, y / reach_, x / reach_;
      const Eigen::Vector2d goes = at * lengths;
      if (goes.norm() < out.corner_px) continue;
      out.corner_px = goes.norm();
      // Along the way that it goes.
      const Eigen::Vector2d way = goes.normalized();
      out.u_corner_px =
          std::sqrt(way.dot(at * of_motion * at.transpose() * way));
    }
  }
  out.corner_px *= block_px_;
  out.u_corner_px *= block_px_;
  out.motion.shift_x_px *= block_px_;
  out.motion.shift_y_px *= block_px_;
  return out;
}

MotionSupport SceneReference::CountSupport(const core::Frame& frame,
                                           const SceneMotion& seen,
                                           double noise_dn) const {
  // Sum of squares, in units of the noise's variance, that the motion would
  // leave in a tile at rest: less cannot be told from noise, as along an edge,
  // where all places look alike. 16: four standard deviations.
  constexpr double kTelling = 16.0;
  // Mean square, in the same units, from which a tile is not at rest. Of eight
  // points noise alone reaches it in one of six tiles.
  constexpr double kNotAtRest = 1.5;
  struct Tile {
    double points = 0.0;
    double telling = 0.0;
    double at_rest = 0.0;
    double moved = 0.0;
  };
  const Means means(frame, block_px_);
  const Similarity motion = ToBlocks(seen.motion);
  const Eigen::Vector4d lengths = Lengths(motion);
  const double gain = GainAtRest(means, points_);
  std::vector<Tile> tiles(kTiles);
  for (const Point& p : points_) {
    const auto moved = Residual(means, p, centre_, motion, seen.gain);
    const auto still = Residual(means, p, centre_, {}, gain);
    if (!moved || !still) continue;
    // What fits neither says nothing: squares are bounded.
    const auto square = [&](double off) {
      return std::min(off * off / (noise_dn * noise_dn), kTukeyCut * kTukeyCut);
    };
    Tile& tile = tiles[static_cast<std::size_t>(p.tile)];
    tile.points += 1.0;
    tile.telling += square(Slopes(p).dot(lengths));
    tile.at_rest += square(static_cast<double>(*still));
    tile.moved += square(static_cast<double>(*moved));
  }
  struct Votes {
    double better = 0.0;
    double restless = 0.0;
    double all = 0.0;
    double ShareOf(double votes) const { return all > 0.0 ? votes / all : 0.0; }
  };
  Votes whole_picture;
  std::array<Votes, 3> thirds;
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    const Tile& tile = tiles[k];
    if (tile.telling < kTelling) continue;
    const bool is_restless = tile.at_rest > kNotAtRest * tile.points;
    const bool is_better = is_restless && tile.moved < tile.at_rest;
    const std::size_t third = 3 * (k % kAcross) / kAcross;
    for (Votes* votes : {&whole_picture, &thirds[third]}) {
      votes->all += 1.0;
      votes->better += is_better ? 1.0 : 0.0;
      votes->restless += is_restless ? 1.0 : 0.0;
    }
  }
  MotionSupport support{whole_picture.ShareOf(whole_picture.better), 1.0, 1.0};
  for (const Votes& third : thirds) {
    support.of_third = std::min(support.of_third, third.ShareOf(third.better));
    support.restless =
        std::min(support.restless, third.ShareOf(third.restless));
  }
  return support;
}

}  // namespace touchdown::vision
