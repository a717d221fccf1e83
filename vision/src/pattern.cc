#include "pattern.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "box_around.h"
#include "outline_pixels.h"
#include "robust.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

constexpr double kNoLevel = std::numeric_limits<double>::quiet_NaN();

// Weights of Keys' cubic convolution (1981), a = -1/2, at `t` beyond the second
// of four samples.
std::array<double, 4> KeysWeights(double t) {
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
          0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)};
}

double Tukey(double t) {
  return std::abs(t) < 1.0 ? (1.0 - t * t) * (1.0 - t * t) : 0.0;
}

struct Axes {
  double cosine = 1.0;
  double sine = 0.0;
};
Axes AxesOf(const Pose& pose, bool turns) {
  if (!turns) return {};
  return {std::cos(pose.angle_rad), std::sin(pose.angle_rad)};
}

core::PixelPoint PlaceOf(const Pose& pose, const Axes& axes, double x,
                         double y) {
  return {pose.centre.x_px + x * axes.cosine - y * axes.sine,
          pose.centre.y_px + x * axes.sine + y * axes.cosine};
}

// How much the still picture changes in a pixel.
double SlopeAt(const Background& background, std::int32_t x, std::int32_t y) {
  const auto at = [&](std::int32_t column, std::int32_t row) {
    return static_cast<double>(
        background.at(std::clamp(column, 0, background.width_px - 1),
                      std::clamp(row, 0, background.height_px - 1)));
  };
  return 0.5 *
         std::hypot(at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1));
}

// Of a few values: the mean with Tukey's weights about the median, and their
// robust scatter.
struct Usual {
  double level = 0.0;
  double scatter = 0.0;
};
Usual UsualOf(const std::vector<double>& values) {
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

PatternView ViewAround(Clip& clip, std::int64_t frame,
                       const core::PixelPoint& centre, double reach_px) {
  PatternView view;
  view.rect = BoxAround(centre, reach_px, clip.info());
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
  // The blurred edge, and no shadow beyond.
  constexpr double kBeyond_px = 2.0;
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
  half_x += kBeyond_px;
  half_y += kBeyond_px;
  // Of large bodies every other pixel, or fewer, is enough.
  constexpr double kMostNodes = 20000.0;
  spacing_px_ = std::max(1.0, std::sqrt(4.0 * half_x * half_y / kMostNodes));
  const int left = static_cast<int>(std::ceil(half_x / spacing_px_));
  const int up = static_cast<int>(std::ceil(half_y / spacing_px_));
  columns_ = 2 * left + 1;
  rows_ = 2 * up + 1;
  for (int row = -up; row <= up; ++row) {
    for (int column = -left; column <= left; ++column) {
      Node node;
      node.x_px = column * spacing_px_;
      node.y_px = row * spacing_px_;
      const double depth = DepthInside(own, node.x_px, node.y_px, cosine, sine);
      node.inside = depth > -kBeyond_px;
      node.at_rim = depth < kBeyond_px;
      nodes_.push_back(node);
    }
  }
}

double Pattern::reach_px() const {
  return std::hypot(nodes_.back().x_px, nodes_.back().y_px);
}

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

bool Pattern::Learn(const std::vector<PatternView>& views,
                    const std::vector<PatternPose>& poses) {
  constexpr double kMostSeen = 0.5;  // of the frames must show a node
  // At least so often something else is behind a node of the body.
  constexpr double kOften = 0.25;
  constexpr double kClear = 4.0;  // of the noise
  constexpr double kSteep = 2.0;  // of the noise, in a pixel
  own_.clear();
  std::vector<double> values;
  std::vector<double> changes;
  std::vector<double> slopes;  // of what is behind
  std::vector<Axes> axes;
  axes.reserve(poses.size());
  for (const PatternPose& p : poses) axes.push_back(AxesOf(p.pose, turns_));
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    values.clear();
    changes.clear();
    slopes.clear();
    for (std::size_t k = 0; k < views.size(); ++k) {
      const Pose& pose = poses[k].pose;
      const core::PixelPoint at = PlaceOf(pose, axes[k], node.x_px, node.y_px);
      const double value = views[k].At(at.x_px, at.y_px);
      if (!std::isfinite(value)) continue;
      values.push_back(poses[k].light.Undone(value, node.x_px, node.y_px));
      const auto x = static_cast<std::int32_t>(std::lround(at.x_px));
      const auto y = static_cast<std::int32_t>(std::lround(at.y_px));
      if (background_->known_at(x, y)) {
        changes.push_back(
            std::abs(value - static_cast<double>(background_->at(x, y))));
        if (node.at_rim) slopes.push_back(SlopeAt(*background_, x, y));
      }
    }
    if (static_cast<double>(values.size()) <
        std::max(3.0, kMostSeen * static_cast<double>(views.size()))) {
      continue;
    }
    const Usual usual = UsualOf(values);
    node.level = usual.level;
    if (!node.inside || changes.size() * 2 < values.size()) continue;
    const double noise = std::sqrt(background_->Variance(usual.level));
    node.u = std::max(noise, usual.scatter);
    const auto often =
        changes.begin() +
        static_cast<std::ptrdiff_t>((1.0 - kOften) *
                                    static_cast<double>(changes.size()));
    std::nth_element(changes.begin(), often, changes.end());
    if (*often < kClear * noise || *often < usual.scatter) continue;
    // Half body, half an edge behind it.
    if (!slopes.empty() && Median(slopes) > kSteep * noise) continue;
    own_.push_back(i);
  }
  SetSlopes();
  constexpr std::size_t kLeast = 60;  // nodes: seven parameters, and outliers
  return own_.size() >= kLeast;
}

double Pattern::MisfitOf(const std::vector<double>& rest, double scale) const {
  double sw = 0.0;
  double sum = 0.0;
  for (std::size_t k = 0; k < own_.size(); ++k) {
    const Node& node = nodes_[own_[k]];
    const double w = Tukey(rest[k] / (kTukeyCut * scale));
    if (!(w > 0.0)) continue;
    const double off_dn = rest[k] * node.u;
    sw += w;
    sum += w * off_dn * off_dn / background_->Variance(node.level);
  }
  return std::sqrt(sum / std::max(sw, 1.0));
}

double Pattern::Mismatch(const PatternView& view, const Pose& at,
                         double least) const {
  // Medians are slow: the mean of what is cut off does to choose a start.
  const Axes axes = AxesOf(at, turns_);
  double sum = 0.0;
  double seen = 0.0;
  // Were all nodes seen and the others without any mismatch, it would still be
  // no less: a place that is far off is known as such by its first nodes.
  constexpr double kRounding = 1.0 + 1e-12;
  const double enough =
      kRounding * least * static_cast<double>((own_.size() + 2) / 3);
  for (std::size_t k = 0; k < own_.size() && sum < enough; k += 3) {
    const Node& node = nodes_[own_[k]];
    const core::PixelPoint p = PlaceOf(at, axes, node.x_px, node.y_px);
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
  // Gain, offset and slopes of the light; x, y and turn of the pattern.
  constexpr int kLight = 4;
  constexpr int kShiftX = kLight;
  constexpr int kShiftY = kLight + 1;
  constexpr int kTurn = kLight + 2;
  using Matrix = Eigen::Matrix<double, kLight + 3, kLight + 3>;
  using Vector = Eigen::Matrix<double, kLight + 3, 1>;
  Pose pose = start;
  if (within_px > 0.0) {
    constexpr double kStep_px = 1.0;
    double least =
        Mismatch(view, start, std::numeric_limits<double>::infinity());
    for (double y = -within_px; y <= within_px; y += kStep_px) {
      for (double x = -within_px; x <= within_px; x += kStep_px) {
        Pose other = start;
        other.centre.x_px += x;
        other.centre.y_px += y;
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
  constexpr int kRounds = 20;
  constexpr double kFine_px = 1e-3;
  // Robust weights may go to and fro for ever, by much less than they tell.
  constexpr double kToAndFro_px = 0.02;
  constexpr double kMostStep_px = 1.5;
  constexpr double kMostSeen = 0.5;
  double scale = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const Axes axes = AxesOf(pose, turns_);
    for (std::size_t k = 0; k < n; ++k) {
      const Node& node = nodes_[own_[k]];
      const core::PixelPoint p = PlaceOf(pose, axes, node.x_px, node.y_px);
      value[k] = view.At(p.x_px, p.y_px);
    }
    Matrix normal;
    Vector p;
    // The light first, robustly; then all of it with these weights.
    PatternLight light;
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
          kMostSeen * static_cast<double>(n)) {
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
        row << node.level, 1.0, node.x_px, node.y_px, -sx, -sy,
            sx * node.y_px - sy * node.x_px;
        if (!last) row.tail<3>().setZero();
        if (!turns_) row[kTurn] = 0.0;
        normal.selfadjointView<Eigen::Lower>().rankUpdate(row, w);
        right += w * value[k] * row;
      }
      normal = Matrix(normal.selfadjointView<Eigen::Lower>());
      if (!last) normal(kShiftX, kShiftX) = normal(kShiftY, kShiftY) = 1.0;
      if (!last || !turns_) normal(kTurn, kTurn) = 1.0;
      const Eigen::LDLT<Matrix> factor(normal);
      p = factor.solve(right);
      if (!p.allFinite()) return std::nullopt;
      light = {p[0], p[1], p[2], p[3]};
      constexpr double kLeastGain = 0.3;  // the light's changes are smaller
      if (!(light.gain > kLeastGain && light.gain < 1.0 / kLeastGain)) {
        return std::nullopt;
      }
    }
    const double dx =
        std::clamp(p[kShiftX] / light.gain, -kMostStep_px, kMostStep_px);
    const double dy =
        std::clamp(p[kShiftY] / light.gain, -kMostStep_px, kMostStep_px);
    const double reach = reach_px();
    const double turn =
        turns_ ? std::clamp(p[kTurn] / light.gain, -kMostStep_px / reach,
                            kMostStep_px / reach)
               : 0.0;
    pose.centre = PlaceOf(pose, axes, dx, dy);
    pose.angle_rad += turn;
    if (std::max({std::abs(dx), std::abs(dy), std::abs(turn) * reach}) <
        (2 * round < kRounds ? kFine_px : kToAndFro_px)) {
      const Matrix covariance =
          Eigen::LDLT<Matrix>(normal).solve(Matrix::Identity()) *
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
      const double vx = c * c * xx + s * s * yy - 2.0 * c * s * xy;
      const double vy = s * s * xx + c * c * yy + 2.0 * c * s * xy;
      pose.u_x_px = std::sqrt(vx);
      pose.u_y_px = std::sqrt(vy);
      pose.correlation_xy =
          (c * s * (xx - yy) + (c * c - s * s) * xy) / std::sqrt(vx * vy);
      pose.u_angle_rad = turns_ ? std::sqrt(covariance(kTurn, kTurn)) : 0.0;
      pose.misfit = MisfitOf(rest, scale);
      pose.time_s = view.time_s;
      return PatternPose{pose, light};
    }
  }
  return std::nullopt;
}

}  // namespace touchdown::vision
