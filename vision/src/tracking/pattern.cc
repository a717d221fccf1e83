#include "tracking/pattern.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "footage/box_around.h"
#include "numbers/robust.h"
#include "numbers/symmetric_factor.h"
#include "outline/outline_pixels.h"

namespace touchdown::vision {
namespace {

// Of a cell that nothing was seen of.
constexpr double kNoLevel = std::numeric_limits<double>::quiet_NaN();

// Keys' cubic convolution (IEEE Trans. Acoust. Speech Signal Process. 29, 1981,
// 1153), a = -1/2: weights of four samples at `t` beyond the second.
std::array<double, 4> KeysWeights(double t) {
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
          0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)};
}

// Tukey's biweight (1 - t^2)^2; t in units of the cut.
double Tukey(double t) {
  return std::abs(t) < 1.0 ? (1.0 - t * t) * (1.0 - t * t) : 0.0;
}

// Directions of the template's axes in the picture: the body's, or the
// picture's own.
struct Axes {
  double cosine = 1.0;
  double sine = 0.0;
};
Axes BodyAxes(const Pose& pose, bool turns) {
  if (!turns) return {};
  return {std::cos(pose.angle_rad), std::sin(pose.angle_rad)};
}

// Place of a template node in the picture.
core::PixelPoint LocatePlace(const Pose& pose, const Axes& axes, double x,
                             double y) {
  return {pose.centre.x_px + x * axes.cosine - y * axes.sine,
          pose.centre.y_px + x * axes.sine + y * axes.cosine};
}

// Gradient of the still picture at a pixel, DN per px.
double LocalSlope(const Background& background, std::int32_t x,
                  std::int32_t y) {
  const auto at = [&](std::int32_t column, std::int32_t row) {
    return static_cast<double>(
        background.at(std::clamp(column, 0, background.width_px - 1),
                      std::clamp(row, 0, background.height_px - 1)));
  };
  return 0.5 *
         std::hypot(at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1));
}

// Robust level of a few values: one step of a mean with Tukey's weights about
// the median, and the scatter as the scaled median deviation.
struct Usual {
  double level = 0.0;
  double scatter = 0.0;
};
Usual ComputeUsual(const std::vector<double>& values) {
  Usual usual;
  usual.level = Median(values);
  std::vector<double> off;
  off.reserve(values.size());
  for (const double v : values) off.push_back(std::abs(v - usual.level));
  usual.scatter = kSigmaPerMedian * Median(std::move(off));
  if (!(usual.scatter > 0.0)) return usual;
  double sw = 0.0;
  double swv = 0.0;
  for (const double v : values) {
    const double w = Tukey((v - usual.level) / (kTukeyCut * usual.scatter));
    sw += w;
    swv += w * v;
  }
  usual.level = swv / sw;
  return usual;
}

}  // namespace

double PatternView::At(double x_px, double y_px) const {
  const double x = x_px - rect.x;
  const double y = y_px - rect.y;
  const double left = std::floor(x);
  const double top = std::floor(y);
  if (!(left >= 1.0 && top >= 1.0 && left + 2.0 < rect.width &&
        top + 2.0 < rect.height)) {
    return kNoLevel;
  }
  const std::array<double, 4> across = KeysWeights(x - left);
  const std::array<double, 4> down = KeysWeights(y - top);
  const float* row = value.data() +
                     static_cast<std::ptrdiff_t>(top - 1.0) * rect.width +
                     static_cast<std::ptrdiff_t>(left - 1.0);
  double sum = 0.0;
  for (const double weight : down) {
    sum += weight * (across[0] * static_cast<double>(row[0]) +
                     across[1] * static_cast<double>(row[1]) +
                     across[2] * static_cast<double>(row[2]) +
                     across[3] * static_cast<double>(row[3]));
    row += rect.width;
  }
  return sum;
}

PatternView ReadView(Clip& clip, std::int64_t frame,
                     const core::PixelPoint& centre, double reach_px) {
  PatternView view;
  view.rect = ClippedBox(centre, reach_px, clip.info());
  const core::Frame pixels = clip.Read(frame, view.rect);
  view.time_s = pixels.time_s;
  view.value.reserve(static_cast<std::size_t>(view.rect.width) *
                     static_cast<std::size_t>(view.rect.height));
  for (std::int32_t y = 0; y < view.rect.height; ++y) {
    for (std::int32_t x = 0; x < view.rect.width; ++x) {
      view.value.push_back(static_cast<float>(pixels.at(x, y)));
    }
  }
  return view;
}

Pattern::Pattern(const Outline& outline, bool turns,
                 const Background& background)
    : background_(&background), turns_(turns) {
  // px to either side of the outline: the blurred edge belongs to the template,
  // a shadow beyond it does not. Not studied.
  constexpr double kRim_px = 2.0;
  Outline own = outline;
  own.centre = {0.0, 0.0};
  if (turns) own.angle_rad = 0.0;
  double half_x = own.radius_px;
  double half_y = own.radius_px;
  const double cosine = std::cos(own.angle_rad);
  const double sine = std::sin(own.angle_rad);
  if (own.kind == core::BodyKind::kRectangle) {
    half_x = own.half_long_px * std::abs(cosine) +
             own.half_short_px * std::abs(sine);
    half_y = own.half_long_px * std::abs(sine) +
             own.half_short_px * std::abs(cosine);
  }
  half_x += kRim_px;
  half_y += kRim_px;
  // Nodes: of large bodies every other pixel, or fewer, is enough. More cost
  // time in proportion. Not studied.
  constexpr double kMaxNodes = 20000.0;
  spacing_px_ = std::max(1.0, std::sqrt(4.0 * half_x * half_y / kMaxNodes));
  const int left = static_cast<int>(std::ceil(half_x / spacing_px_));
  const int up = static_cast<int>(std::ceil(half_y / spacing_px_));
  columns_ = 2 * left + 1;
  rows_ = 2 * up + 1;
  for (int row = -up; row <= up; ++row) {
    for (int column = -left; column <= left; ++column) {
      Node node;
      node.x_px = column * spacing_px_;
      node.y_px = row * spacing_px_;
      const double depth = SignedDepth(own, node.x_px, node.y_px, cosine, sine);
      node.inside = depth > -kRim_px;
      node.at_rim = depth < kRim_px;
      nodes_.push_back(node);
    }
  }
}

double Pattern::reach_px() const {
  return std::hypot(nodes_.back().x_px, nodes_.back().y_px);
}

// Central differences of the template along its axes; nodes at its border keep
// a slope of 0.
void Pattern::SetSlopes() {
  const auto at = [&](int row, int column) -> Node& {
    return nodes_[static_cast<std::size_t>(row * columns_ + column)];
  };
  for (int row = 1; row + 1 < rows_; ++row) {
    for (int column = 1; column + 1 < columns_; ++column) {
      const double half = 0.5 / spacing_px_;
      at(row, column).slope_x =
          half * (at(row, column + 1).level - at(row, column - 1).level);
      at(row, column).slope_y =
          half * (at(row + 1, column).level - at(row - 1, column).level);
    }
  }
}

// The template's level at each node is the robust mean over the frames, with
// each frame's light undone. A node belongs to the body only where the picture
// behind it is clearly another in enough frames: an edge along the path would
// look as if it went with the body.
bool Pattern::Learn(const std::vector<PatternView>& views,
                    const std::vector<PatternPose>& poses) {
  // Share of the frames that must show a node. Not studied.
  constexpr double kMinSeenShare = 0.5;
  // Share of the frames in which something else must lie behind a node of the
  // body. Smaller takes the picture behind for the body's; larger loses the
  // parts that are mostly like it. Set with the recorded hoops.
  constexpr double kDifferentShare = 0.25;
  // Standard deviations of the noise by which it must differ. Not studied.
  constexpr double kClearSigmas = 4.0;
  // Slope of the background, in noise per px, at which a node of the rim mixes
  // the body with an edge behind it. Not studied.
  constexpr double kSteepSigmas = 2.0;
  own_.clear();
  std::vector<double> values;
  std::vector<double> changes;
  std::vector<double> slopes;  // of what is behind
  std::vector<Axes> axes;
  axes.reserve(poses.size());
  for (const PatternPose& p : poses) axes.push_back(BodyAxes(p.pose, turns_));
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    values.clear();
    changes.clear();
    slopes.clear();
    for (std::size_t k = 0; k < views.size(); ++k) {
      const Pose& pose = poses[k].pose;
      const core::PixelPoint at =
          LocatePlace(pose, axes[k], node.x_px, node.y_px);
      const double value = views[k].At(at.x_px, at.y_px);
      if (!std::isfinite(value)) continue;
      values.push_back(poses[k].light.Undone(value, node.x_px, node.y_px));
      const auto x = static_cast<std::int32_t>(std::lround(at.x_px));
      const auto y = static_cast<std::int32_t>(std::lround(at.y_px));
      if (background_->known_at(x, y)) {
        changes.push_back(
            std::abs(value - static_cast<double>(background_->at(x, y))));
        if (node.at_rim) slopes.push_back(LocalSlope(*background_, x, y));
      }
    }
    if (static_cast<double>(values.size()) <
        std::max(3.0, kMinSeenShare * static_cast<double>(views.size()))) {
      continue;
    }
    const Usual usual = ComputeUsual(values);
    // Nodes that are not the body's keep their level, too: slopes need
    // neighbours.
    node.level = usual.level;
    if (!node.inside || changes.size() * 2 < values.size()) continue;
    const double noise = std::sqrt(background_->Variance(usual.level));
    node.u = std::max(noise, usual.scatter);
    const auto often =
        changes.begin() +
        static_cast<std::ptrdiff_t>((1.0 - kDifferentShare) *
                                    static_cast<double>(changes.size()));
    std::nth_element(changes.begin(), often, changes.end());
    if (*often < kClearSigmas * noise || *often < usual.scatter) continue;
    // A rim node before a strong edge of the background is left out.
    if (!slopes.empty() && Median(slopes) > kSteepSigmas * noise) continue;
    own_.push_back(i);
  }
  SetSlopes();
  // Nodes: seven parameters, and outliers. Not studied.
  constexpr std::size_t kMinNodes = 60;
  return own_.size() >= kMinNodes;
}

double Pattern::ComputeMisfit(const std::vector<double>& rest,
                              double scale) const {
  double sw = 0.0;
  double sum = 0.0;
  for (std::size_t k = 0; k < own_.size(); ++k) {
    const Node& node = nodes_[own_[k]];
    const double w = Tukey(rest[k] / (kTukeyCut * scale));
    if (!(w > 0.0)) continue;
    // `rest` is in units of the node's scatter, which holds the template's own
    // errors; the misfit is in units of the pixels' noise.
    const double off_dn = rest[k] * node.u;
    sw += w;
    sum += w * off_dn * off_dn / background_->Variance(node.level);
  }
  return std::sqrt(sum / std::max(sw, 1.0));
}

double Pattern::Mismatch(const PatternView& view, const Pose& at,
                         double least) const {
  // Medians are slow: the mean of what is cut off does to choose a start.
  const Axes axes = BodyAxes(at, turns_);
  double sum = 0.0;
  double seen = 0.0;
  // If all nodes were seen and the rest had no mismatch at all, it would still
  // not be below `least`: a bad place is known by its first nodes. The factor
  // covers the rounding of the sum.
  constexpr double kRounding = 1.0 + 1e-12;
  // Every third node chooses a start well enough.
  const std::size_t looked_at = (own_.size() + 2) / 3;
  const double enough = kRounding * least * static_cast<double>(looked_at);
  for (std::size_t k = 0; k < own_.size() && sum < enough; k += 3) {
    const Node& node = nodes_[own_[k]];
    const core::PixelPoint p = LocatePlace(at, axes, node.x_px, node.y_px);
    const double value = view.At(p.x_px, p.y_px);
    if (!std::isfinite(value)) continue;
    const double r = (value - node.level) / node.u;
    sum += std::min(std::abs(r), kTukeyCut);
    seen += 1.0;
  }
  return seen > 0.0 ? sum / seen : kTukeyCut;
}

std::optional<PatternPose> Pattern::Register(const PatternView& view,
                                             const Pose& start,
                                             double within_px) const {
  // Parameters: gain, offset and slopes of the light, then x, y and turn.
  constexpr int kLight = 4;
  constexpr int kShiftX = kLight;
  constexpr int kShiftY = kLight + 1;
  constexpr int kTurn = kLight + 2;
  using Matrix = Eigen::Matrix<double, kLight + 3, kLight + 3>;
  using Vector = Eigen::Matrix<double, kLight + 3, 1>;
  Pose pose = start;
  if (within_px > 0.0) {
    // px: the fit converges from a start this near. Not studied.
    constexpr double kSearchStep_px = 1.0;
    double least =
        Mismatch(view, start, std::numeric_limits<double>::infinity());
    const auto steps =
        static_cast<int>(std::floor(2.0 * within_px / kSearchStep_px));
    for (int j = 0; j <= steps; ++j) {
      for (int i = 0; i <= steps; ++i) {
        Pose other = start;
        other.centre.x_px += i * kSearchStep_px - within_px;
        other.centre.y_px += j * kSearchStep_px - within_px;
        if (const double m = Mismatch(view, other, least); m < least) {
          least = m;
          pose = other;
        }
      }
    }
  }
  const auto n = own_.size();
  std::vector<double> value(n);
  std::vector<double> rest(n);
  std::vector<double> sizes;
  // A bound; without convergence there is no pose. Not studied.
  constexpr int kMaxRounds = 20;
  // px: a smaller step ends the iteration, far below any u of a pose.
  constexpr double kConverged_px = 1e-3;
  // px: reweighting may cycle. After half of the rounds steps so small are
  // accepted. Set with the recorded cart.
  constexpr double kCycle_px = 0.02;
  // px (at the far end of the template for the turn): beyond it the linearised
  // picture is another. Not studied.
  constexpr double kMaxStep_px = 1.5;
  // Share of the body's nodes that must lie in the picture. Not studied.
  constexpr double kMinInPicture = 0.5;
  double scale = 0.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Axes axes = BodyAxes(pose, turns_);
    for (std::size_t k = 0; k < n; ++k) {
      const Node& node = nodes_[own_[k]];
      const core::PixelPoint p = LocatePlace(pose, axes, node.x_px, node.y_px);
      value[k] = view.At(p.x_px, p.y_px);
    }
    Matrix normal;
    Vector p;
    // First the light alone, reweighted; then light and pose together with
    // these weights. Fitted at once, a wrong light would pull the pose.
    PatternLight light;
    // Reweightings of the light. Not studied.
    constexpr int kLightRounds = 3;
    for (int part = 0; part <= kLightRounds; ++part) {
      const bool last = part == kLightRounds;
      sizes.clear();
      for (std::size_t k = 0; k < n; ++k) {
        rest[k] = kNoLevel;
        if (!std::isfinite(value[k])) continue;
        const Node& node = nodes_[own_[k]];
        rest[k] =
            (value[k] - light.At(node.level, node.x_px, node.y_px)) / node.u;
        sizes.push_back(std::abs(rest[k]));
      }
      if (static_cast<double>(sizes.size()) <
          kMinInPicture * static_cast<double>(n)) {
        return std::nullopt;
      }
      scale = std::max(1.0, kSigmaPerMedian * Median(sizes));
      normal.setZero();
      Vector right = Vector::Zero();
      for (std::size_t k = 0; k < n; ++k) {
        if (!std::isfinite(value[k])) continue;
        const Node& node = nodes_[own_[k]];
        const double sx = node.slope_x;
        const double sy = node.slope_y;
        const double w =
            Tukey(rest[k] / (kTukeyCut * scale)) / (node.u * node.u);
        Vector row;
        // Derivatives of g T + b + s q by the light, and of the picture by
        // shift and turn: -grad T and its moment.
        row << node.level, 1.0, node.x_px, node.y_px, -sx, -sy,
            sx * node.y_px - sy * node.x_px;
        if (!last) row.tail<3>().setZero();
        if (!turns_) row[kTurn] = 0.0;
        normal += w * row * row.transpose();
        right += w * value[k] * row;
      }
      // Parameters that are held get a unit diagonal.
      if (!last) normal(kShiftX, kShiftX) = normal(kShiftY, kShiftY) = 1.0;
      if (!last || !turns_) normal(kTurn, kTurn) = 1.0;
      p = SymmetricFactor(normal).Solve(right);
      if (!p.allFinite()) return std::nullopt;
      light = {p[0], p[1], p[2], p[3]};
      // Factor of the light, either way: no lamp's changes are larger. Beyond
      // it the template lies on something else. Not studied.
      constexpr double kMinGain = 0.3;
      if (!(light.gain > kMinGain && light.gain < 1.0 / kMinGain)) {
        return std::nullopt;
      }
    }
    const double dx =
        std::clamp(p[kShiftX] / light.gain, -kMaxStep_px, kMaxStep_px);
    const double dy =
        std::clamp(p[kShiftY] / light.gain, -kMaxStep_px, kMaxStep_px);
    const double reach = reach_px();
    const double turn =
        turns_ ? std::clamp(p[kTurn] / light.gain, -kMaxStep_px / reach,
                            kMaxStep_px / reach)
               : 0.0;
    pose.centre = LocatePlace(pose, axes, dx, dy);
    pose.angle_rad += turn;
    if (std::max({std::abs(dx), std::abs(dy), std::abs(turn) * reach}) <
        (2 * round < kMaxRounds ? kConverged_px : kCycle_px)) {
      const Matrix covariance = SymmetricFactor(normal).Inverse() *
                                (scale * scale) / (light.gain * light.gain);
      if (!covariance.allFinite() || !(covariance(kShiftX, kShiftX) > 0.0) ||
          !(covariance(kShiftY, kShiftY) > 0.0)) {
        return std::nullopt;
      }
      const double xx = covariance(kShiftX, kShiftX);
      const double yy = covariance(kShiftY, kShiftY);
      const double xy = covariance(kShiftX, kShiftY);
      const double c = axes.cosine;
      const double s = axes.sine;
      // Covariance of the shift, turned from the template's axes to the
      // picture's.
      const double vx = c * c * xx + s * s * yy - 2.0 * c * s * xy;
      const double vy = s * s * xx + c * c * yy + 2.0 * c * s * xy;
      pose.u_x_px = std::sqrt(vx);
      pose.u_y_px = std::sqrt(vy);
      pose.correlation_xy =
          (c * s * (xx - yy) + (c * c - s * s) * xy) / std::sqrt(vx * vy);
      pose.u_angle_rad = turns_ ? std::sqrt(covariance(kTurn, kTurn)) : 0.0;
      pose.misfit = ComputeMisfit(rest, scale);
      pose.time_s = view.time_s;
      return PatternPose{pose, light};
    }
  }
  return std::nullopt;
}

}  // namespace touchdown::vision
