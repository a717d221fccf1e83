#include "layers/layer_model.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "layers/edge_product.h"
#include "layers/pixel_lanes.h"

namespace touchdown::vision::layers {
namespace {

struct Node {
  double tau;
  double weight;
};

// More nodes where the body's farthest point moves more px in the exposure; at
// one place nothing tells it.
std::span<const Node> ChooseNodes(double way, bool at_one_place) {
  // Gauss's of one, two, three and five points, on -1/2 to 1/2.
  static constexpr std::array<Node, 1> kOne = {{{0.0, 1.0}}};
  static constexpr std::array<Node, 2> kTwo = {
      {{-0.28867513459481287, 0.5}, {0.28867513459481287, 0.5}}};
  static constexpr std::array<Node, 3> kThree = {
      {{-0.3872983346207417, 5.0 / 18.0},
       {0.0, 8.0 / 18.0},
       {0.3872983346207417, 5.0 / 18.0}}};
  static constexpr std::array<Node, 5> kFive = {
      {{-0.453089922969332, 0.11846344252809454},
       {-0.2692346550528415, 0.23931433524968324},
       {0.0, 0.28444444444444444},
       {0.2692346550528415, 0.23931433524968324},
       {0.453089922969332, 0.11846344252809454}}};
  if (way < 0.3 && at_one_place) return kOne;
  if (way < 2.0) return kTwo;
  if (way < 4.5) return kThree;
  return kFive;
}

struct SampleWindow {
  std::int32_t left = 0;
  std::int32_t top = 0;
  std::int32_t right = 0;
  std::int32_t bottom = 0;
};

SampleWindow ComputeSampleWindow(const PictureStack& stack, std::size_t picture,
                                 const Layers& layers, const LayerPose& pose,
                                 const LayerPose& motion) {
  constexpr double kBlurs = 3.5;  // coverage is below 3e-4 beyond
  const double rim = kBlurs * layers.blur + 1.0;
  double reach_x = layers.shape.half_long;
  double reach_y = layers.shape.half_long;
  if (!layers.shape.disc) {
    const double cosine = std::abs(std::cos(pose.angle_rad));
    const double sine = std::abs(std::sin(pose.angle_rad));
    reach_x = cosine * layers.shape.half_long + sine * layers.shape.half_short;
    reach_y = sine * layers.shape.half_long + cosine * layers.shape.half_short;
  }
  const double turn =
      0.5 * std::abs(motion.angle_rad) * layers.exposure * layers.shape.Reach();
  reach_x += rim + 0.5 * std::abs(motion.x) * layers.exposure + turn;
  reach_y += rim + 0.5 * std::abs(motion.y) * layers.exposure + turn;
  // The still picture's slope takes a pixel on each side.
  const auto from = [](double at, std::int32_t begin) {
    return std::max({1, begin, static_cast<std::int32_t>(std::ceil(at))});
  };
  const auto to = [](double at, std::int32_t end, std::int32_t size) {
    return std::min(
        {size - 1, end, static_cast<std::int32_t>(std::floor(at)) + 1});
  };
  const core::PixelRect& seen = stack.windows[picture];
  return {from(pose.x - reach_x, seen.x), from(pose.y - reach_y, seen.y),
          to(pose.x + reach_x, seen.x + seen.width, stack.width),
          to(pose.y + reach_y, seen.y + seen.height, stack.height)};
}

Placed PlaceAt(double x, double y, double angle_rad, const Node& node) {
  return {static_cast<float>(x),
          static_cast<float>(y),
          static_cast<float>(std::cos(angle_rad)),
          static_cast<float>(std::sin(angle_rad)),
          static_cast<float>(node.weight),
          static_cast<float>(node.tau)};
}

std::vector<Placed> PlaceInExposure(const Layers& layers, const LayerPose& pose,
                                    const LayerPose& motion,
                                    Derivatives derivatives) {
  const double pace = std::hypot(motion.x, motion.y) +
                      std::abs(motion.angle_rad) * layers.shape.Reach();
  // px a frame: no picture of a slower body tells the exposure.
  constexpr double kLeastPace = 1.0;
  const bool at_one_place =
      derivatives == Derivatives::kByPose || pace < kLeastPace;
  std::vector<Placed> placed;
  for (const Node& node : ChooseNodes(layers.exposure * pace, at_one_place)) {
    const double shift = node.tau * layers.exposure;
    placed.push_back(PlaceAt(pose.x + motion.x * shift,
                             pose.y + motion.y * shift,
                             pose.angle_rad + motion.angle_rad * shift, node));
  }
  return placed;
}

// The pixels of one row that see the body at one of its places.
struct Columns {
  std::int32_t begin = 0;
  std::int32_t end = 0;
};
Columns FindColumns(const ShapeCover& cover, const std::vector<Placed>& placed,
                    std::int32_t row, const SampleWindow& window) {
  auto from = static_cast<float>(window.right);
  auto to = static_cast<float>(window.left - 1);
  for (const Placed& node : placed) {
    const RowPart seen = cover.FindSeen(static_cast<float>(row) - node.y,
                                        node.cosine, node.sine);
    if (seen.to < seen.from) continue;
    from = std::min(from, node.x + seen.from);
    to = std::max(to, node.x + seen.to);
  }
  const std::int32_t begin =
      std::max(window.left, static_cast<std::int32_t>(std::ceil(from)));
  const std::int32_t end =
      std::min(window.right, static_cast<std::int32_t>(std::floor(to)) + 1);
  return {begin, std::max(begin, end)};
}

using Terms = std::array<float, kTerms>;
Terms EvaluateTerms(float x, float y) {
  return {1.0F, x, y, x * x, x * y, y * y};
}

double Apart(const LayerPose& a, const LayerPose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

// The pixels of one row, from frame to samples.
class RowLinearizer {
 public:
  RowLinearizer(const PictureStack& stack, std::size_t picture,
                const Layers& layers, const LayerPose& pose,
                const LayerPose& motion, const std::vector<Placed>& placed,
                Derivatives derivatives, FrameSamples& samples)
      : stack_(stack),
        layers_(layers),
        cover_(layers.shape, layers.blur),
        all_(derivatives == Derivatives::kAll),
        picture_(picture),
        places_(placed.size()),
        shares_(placed.size()),
        samples_(samples) {
    NodeNumbers node;
    node.blur2 = static_cast<float>(layers.blur * layers.blur);
    node.twice_blur = static_cast<float>(2.0 * layers.blur);
    node.per_reach = static_cast<float>(1.0 / layers.shape.Reach());
    node.per_exposure = static_cast<float>(0.5 / layers.exposure);
    node.slope_x = static_cast<float>(layers.slope_x) * node.per_reach;
    node.slope_y = static_cast<float>(layers.slope_y) * node.per_reach;
    node.v_x = static_cast<float>(motion.x);
    node.v_y = static_cast<float>(motion.y);
    node.v_turn = static_cast<float>(motion.angle_rad);
    node.flat = layers.flat;
    std::copy(layers.quadratic.begin(), layers.quadratic.end(),
              node.quadratic.begin());
    for (const Placed& at : placed) {
      node.at = at;
      nodes_.push_back(node);
    }
    middle_ = PlaceAt(pose.x, pose.y, pose.angle_rad, {0.0, 1.0});
  }

  const ShapeCover& cover() const { return cover_; }

  // Of columns `begin` to `end`, at most kChunk.
  void Linearize(std::int32_t row, std::int32_t begin, std::int32_t end);
  std::size_t count() const { return count_; }

 private:
  void Look(const NodeNumbers& node, std::size_t k, std::int32_t row,
            std::int32_t begin, std::int32_t end);
  bool at_middle() const {
    return samples_.nodes < nodes_.size() && !layers_.flat;
  }
  void LookAtMiddle(std::int32_t row, std::int32_t begin, std::int32_t end);
  void Append(std::int32_t first_pixel, const Lanes& levels, std::size_t from,
              std::size_t to);

  const PictureStack& stack_;
  const Layers& layers_;
  ShapeCover cover_;
  bool all_;
  std::size_t picture_;
  std::vector<NodeNumbers> nodes_;
  Placed middle_;
  std::array<SplinePlace, kChunk> middle_places_{};
  Lanes middle_x_{}, middle_y_{};
  std::vector<std::array<SplinePlace, kChunk>> places_;  // by node
  std::vector<Lanes> shares_;
  NodeLanes seen_{};
  PixelLanes sums_{};
  FrameSamples& samples_;
  std::size_t count_ = 0;
};

// What one place of the exposure shows in a row's pixels.
void RowLinearizer::Look(const NodeNumbers& node, std::size_t k,
                         std::int32_t row, std::int32_t begin,
                         std::int32_t end) {
  const auto most_slope =
      static_cast<float>(0.5 * kLeastStillStep * layers_.noise_dn);
  const float* const still = layers_.still.data();
  seen_ = {};
  for (std::int32_t column = begin; column < end; ++column) {
    const auto i = static_cast<std::size_t>(column - begin);
    const float dx = static_cast<float>(column) - node.at.x;
    const float x = node.at.cosine * dx + node.at.sine * node.down;
    const float y = node.at.cosine * node.down - node.at.sine * dx;
    const CoverAt m = cover_.At(x, y);
    if (!layers_.flat) {
      places_[k][i] = layers_.grid.LocatePlace(x, y);
      shares_[k][i] = node.at.weight * m.value;
    }
    if (m.value < kLeastCover && m.by_blur == 0.0F) continue;
    seen_.right[i] = dx;
    seen_.x[i] = x;
    seen_.y[i] = y;
    seen_.cover[i] = m.value;
    if (!layers_.flat) {
      const PictureGrid::Tilt tilt =
          layers_.grid.EvaluateTilt(layers_.picture.data(), places_[k][i]);
      seen_.tilt[i] = tilt.value;
      seen_.tilt_x[i] = tilt.by_x;
      seen_.tilt_y[i] = tilt.by_y;
      if (at_middle()) {
        seen_.middle_x[i] = middle_x_[i] - tilt.by_x;
        seen_.middle_y[i] = middle_y_[i] - tilt.by_y;
      }
    }
    if (m.by_long == 0.0F && m.by_short == 0.0F) continue;
    seen_.by_x[i] = m.by_x;
    seen_.by_y[i] = m.by_y;
    seen_.by_blur[i] = m.by_blur;
    seen_.by_long[i] = m.by_long;
    seen_.by_short[i] = m.by_short;
    const std::int32_t pixel = row * stack_.width + column;
    const StillEdge edge = layers_.edges.empty()
                               ? StillEdge{}
                               : layers_.edges[static_cast<std::size_t>(pixel)];
    if (edge.contrast != 0.0F) {
      const Product product =
          cover_.WithEdge(x, y, edge, node.at.cosine, node.at.sine);
      seen_.product[i] = product.value;
      seen_.product_x[i] = product.by_x;
      seen_.product_y[i] = product.by_y;
      continue;
    }
    const float step_x = 0.5F * (still[pixel + 1] - still[pixel - 1]);
    const float step_y =
        0.5F * (still[pixel + stack_.width] - still[pixel - stack_.width]);
    if (std::max(std::abs(step_x), std::abs(step_y)) < most_slope) {
      seen_.still_x[i] = step_x;
      seen_.still_y[i] = step_y;
    }
  }
}

// The middle of the exposure, where derivatives by T are taken.
void RowLinearizer::LookAtMiddle(std::int32_t row, std::int32_t begin,
                                 std::int32_t end) {
  const float down = static_cast<float>(row) - middle_.y;
  for (std::int32_t column = begin; column < end; ++column) {
    const auto i = static_cast<std::size_t>(column - begin);
    const float right = static_cast<float>(column) - middle_.x;
    middle_places_[i] =
        layers_.grid.LocatePlace(middle_.cosine * right + middle_.sine * down,
                                 middle_.cosine * down - middle_.sine * right);
    const PictureGrid::Tilt tilt =
        layers_.grid.EvaluateTilt(layers_.picture.data(), middle_places_[i]);
    middle_x_[i] = tilt.by_x;
    middle_y_[i] = tilt.by_y;
  }
}

// Pixels `from` to `to` of those that were looked at.
void RowLinearizer::Append(std::int32_t first_pixel, const Lanes& levels,
                           std::size_t from, std::size_t to) {
  const std::size_t n = to - from;
  const auto append = [&](const Lanes& lanes, std::vector<float>& column) {
    std::copy_n(lanes.begin() + static_cast<std::ptrdiff_t>(from), n,
                column.begin() + static_cast<std::ptrdiff_t>(count_));
  };
  for (std::size_t i = 0; i < n; ++i) {
    samples_.pixel[count_ + i] =
        first_pixel + static_cast<std::int32_t>(from + i);
    samples_.open[count_ + i] = 1.0F - sums_.covered[from + i];
  }
  append(levels, samples_.level);
  append(sums_.residual, samples_.residual);
  append(sums_.weight, samples_.weight);
  append(sums_.covered, samples_.cover);
  for (std::size_t a = 0; a < kPose; ++a) {
    append(sums_.by_pose[a], samples_.by_pose[a]);
  }
  for (std::size_t a = 0; all_ && a < kShared; ++a) {
    append(sums_.by_shared[a], samples_.by_shared[a]);
  }
  for (std::size_t k = 0; k < samples_.nodes; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t at = (count_ + i) * samples_.nodes + k;
      samples_.place[at] = places_[k][from + i];
      if (all_) samples_.share[at] = shares_[k][from + i];
    }
  }
  count_ += n;
}

void RowLinearizer::Linearize(std::int32_t row, std::int32_t begin,
                              std::int32_t end) {
  const std::int32_t first_pixel = row * stack_.width + begin;
  const auto n = static_cast<std::size_t>(end - begin);
  sums_ = {};
  std::copy_n(layers_.still.begin() + first_pixel, n, sums_.behind.begin());
  sums_.model = sums_.behind;
  if (at_middle()) LookAtMiddle(row, begin, end);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    NodeNumbers& node = nodes_[k];
    node.down = static_cast<float>(row) - node.at.y;
    Look(node, k, row, begin, end);
    if (node.flat) EvaluateFlat(node, seen_);
    AddNode(node, seen_, all_, sums_);
  }
  if (at_middle()) {
    places_[0] = middle_places_;
    shares_[0] = sums_.covered;
  }
  Lanes levels{};
  std::copy_n(
      stack_.WindowRow(picture_, row) + (begin - stack_.windows[picture_].x), n,
      levels.begin());
  FinishPixels(levels, static_cast<float>(layers_.noise_dn), sums_);
  // From one pixel that shows nothing of the body to the next.
  for (std::size_t from = 0; from < n;) {
    std::size_t to = from;
    while (to < n && sums_.covered[to] >= kLeastCover) ++to;
    if (to > from) Append(first_pixel, levels, from, to);
    from = to + 1;
  }
}

}  // namespace

void FrameSamples::Resize(std::size_t count, Derivatives derivatives) {
  const bool all = derivatives == Derivatives::kAll;
  pixel.resize(count);
  for (auto* column : {&level, &residual, &weight, &open, &cover}) {
    column->resize(count);
  }
  for (auto& column : by_pose) column.resize(count);
  for (auto& column : by_shared) column.resize(all ? count : 0);
  place.resize(count * nodes);
  share.resize(all ? count * nodes : 0);
}

void Linearize(const PictureStack& stack, std::size_t picture,
               const Layers& layers, const LayerPose& pose,
               const LayerPose& motion, Derivatives derivatives,
               FrameSamples& samples) {
  const SampleWindow window =
      ComputeSampleWindow(stack, picture, layers, pose, motion);
  if (window.right <= window.left || window.bottom <= window.top) {
    samples.Resize(0, derivatives);
    return;
  }
  const std::vector<Placed> placed =
      PlaceInExposure(layers, pose, motion, derivatives);
  // Two nodes are so near to each other that T's derivatives are those at their
  // middle: 140 photographed clips have the same errors, a product costs half.
  samples.nodes = layers.flat ? 0 : placed.size() == 2 ? 1 : placed.size();
  RowLinearizer rows(stack, picture, layers, pose, motion, placed, derivatives,
                     samples);
  std::vector<Columns> seen_in_row;
  std::size_t most = 0;
  for (std::int32_t row = window.top; row < window.bottom; ++row) {
    seen_in_row.push_back(FindColumns(rows.cover(), placed, row, window));
    const Columns& columns = seen_in_row.back();
    most += static_cast<std::size_t>(columns.end - columns.begin);
  }
  samples.Resize(most, derivatives);
  const auto chunk = static_cast<std::int32_t>(kChunk);
  for (std::int32_t row = window.top; row < window.bottom; ++row) {
    const auto [begin, end] =
        seen_in_row[static_cast<std::size_t>(row - window.top)];
    for (std::int32_t from = begin; from < end; from += chunk) {
      rows.Linearize(row, from, std::min(from + chunk, end));
    }
  }
  samples.Resize(rows.count(), derivatives);
}

void LearnTexture(Layers& layers) {
  layers.flat = false;
  const auto per_reach = static_cast<float>(1.0 / layers.shape.Reach());
  // The spline of a square's samples lies a third above it.
  const float above = per_reach * per_reach / 3.0F;
  for (std::int32_t j = 0; j < layers.grid.rows(); ++j) {
    for (std::int32_t i = 0; i < layers.grid.columns(); ++i) {
      Terms terms = EvaluateTerms(layers.grid.x_of(i) * per_reach,
                                  layers.grid.y_of(j) * per_reach);
      terms[3] -= above;
      terms[5] -= above;
      float level = 0.0F;
      for (std::size_t k = 0; k < kTerms; ++k) {
        level += static_cast<float>(layers.quadratic[k]) * terms[k];
      }
      layers.picture[static_cast<std::size_t>(j * layers.grid.columns() + i)] =
          level;
    }
  }
}

std::vector<LayerPose> EstimateMotions(
    const std::vector<LayerPose>& poses,
    const std::vector<std::int64_t>& frames) {
  const std::size_t n = poses.size();
  std::vector<LayerPose> motions(n);
  if (n < 2) return motions;
  const auto between = [&](std::size_t a, std::size_t b) {
    const auto gap = static_cast<double>(frames[b] - frames[a]);
    return LayerPose{(poses[b].x - poses[a].x) / gap,
                     (poses[b].y - poses[a].y) / gap,
                     (poses[b].angle_rad - poses[a].angle_rad) / gap};
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (i == 0 || i + 1 == n) {
      motions[i] = i == 0 ? between(0, 1) : between(n - 2, n - 1);
      continue;
    }
    const LayerPose back = between(i - 1, i);
    const LayerPose on = between(i, i + 1);
    const double change_back =
        i >= 2 ? Apart(between(i - 2, i - 1), back) : 0.0;
    const double change_on = i + 2 < n ? Apart(on, between(i + 1, i + 2)) : 0.0;
    if (Apart(back, on) < 2.0 * std::max({change_back, change_on, 0.1})) {
      motions[i] = {0.5 * (back.x + on.x), 0.5 * (back.y + on.y),
                    0.5 * (back.angle_rad + on.angle_rad)};
    } else {
      motions[i] = change_back <= change_on ? back : on;
    }
  }
  return motions;
}

}  // namespace touchdown::vision::layers
