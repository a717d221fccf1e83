#include "layers/layer_model.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "layers/edge_product.h"

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

// A node's own numbers.
struct Placed {
  float x = 0.0F;
  float y = 0.0F;
  float cosine = 1.0F;
  float sine = 0.0F;
  float weight = 1.0F;
  float tau = 0.0F;
};

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

PictureGrid::Tilt ComputeTilt(const Terms& quadratic, const Terms& terms,
                              float per_reach) {
  PictureGrid::Tilt tilt;
  for (std::size_t j = 0; j < kTerms; ++j) {
    tilt.value += quadratic[j] * terms[j];
  }
  const float x = terms[1];
  const float y = terms[2];
  tilt.by_x =
      (quadratic[1] + 2.0F * quadratic[3] * x + quadratic[4] * y) * per_reach;
  tilt.by_y =
      (quadratic[2] + quadratic[4] * x + 2.0F * quadratic[5] * y) * per_reach;
  return tilt;
}

// The product's derivatives by a quadratic T: s^2 grad M . grad of each term.
void AddOwnSlopes(float factor, const CoverAt& m, float x, float y,
                  float per_reach, std::array<float, kShared>& by_shared) {
  const float along = factor * per_reach * m.by_x;
  const float across = factor * per_reach * m.by_y;
  by_shared[kQuadratic + 1] += along;
  by_shared[kQuadratic + 2] += across;
  by_shared[kQuadratic + 3] += 2.0F * x * along;
  by_shared[kQuadratic + 4] += y * along + x * across;
  by_shared[kQuadratic + 5] += 2.0F * y * across;
}

double Apart(const LayerPose& a, const LayerPose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

template <Derivatives kDerivatives>
void LinearizeModel(const PictureStack& stack, std::size_t picture,
                    const Layers& layers, const LayerPose& pose,
                    const LayerPose& motion, FrameSamples& samples) {
  // Whether those by the shared numbers are wanted, too.
  constexpr bool kAll = kDerivatives == Derivatives::kAll;
  // Below it a pixel shows nothing of the body.
  constexpr float kLeastCover = 2e-4F;
  constexpr float kLeastLevel_dn = 4.0F;  // beside it black is no zero

  const SampleWindow window =
      ComputeSampleWindow(stack, picture, layers, pose, motion);
  if (window.right <= window.left || window.bottom <= window.top) {
    samples.Resize(0, kDerivatives);
    return;
  }
  const double reach = layers.shape.Reach();
  const double pace =
      std::hypot(motion.x, motion.y) + std::abs(motion.angle_rad) * reach;
  // px a frame: no picture of a slower body tells the exposure.
  constexpr double kLeastPace = 1.0;
  std::vector<Placed> placed;
  for (const Node& node :
       ChooseNodes(layers.exposure * pace, !kAll || pace < kLeastPace)) {
    const double shift = node.tau * layers.exposure;
    const double angle = pose.angle_rad + motion.angle_rad * shift;
    placed.push_back({static_cast<float>(pose.x + motion.x * shift),
                      static_cast<float>(pose.y + motion.y * shift),
                      static_cast<float>(std::cos(angle)),
                      static_cast<float>(std::sin(angle)),
                      static_cast<float>(node.weight),
                      static_cast<float>(node.tau)});
  }
  samples.nodes = layers.flat ? 0 : placed.size();
  const ShapeCover cover(layers.shape, layers.blur);
  std::vector<Columns> seen_in_row;
  std::size_t most = 0;
  for (std::int32_t row = window.top; row < window.bottom; ++row) {
    seen_in_row.push_back(FindColumns(cover, placed, row, window));
    const Columns& columns = seen_in_row.back();
    most += static_cast<std::size_t>(columns.end - columns.begin);
  }
  samples.Resize(most, kDerivatives);
  std::size_t count = 0;

  const float* const still = layers.still.data();
  const auto blur2 = static_cast<float>(layers.blur * layers.blur);
  const auto twice_blur = static_cast<float>(2.0 * layers.blur);
  const auto most_slope =
      static_cast<float>(0.5 * kLeastStillStep * layers.noise_dn);
  const auto per_reach = static_cast<float>(1.0 / reach);
  const auto slope_x = static_cast<float>(layers.slope_x) * per_reach;
  const auto slope_y = static_cast<float>(layers.slope_y) * per_reach;
  const auto curve = static_cast<float>(layers.curve);
  const auto v_x = static_cast<float>(motion.x);
  const auto v_y = static_cast<float>(motion.y);
  const auto v_turn = static_cast<float>(motion.angle_rad);
  const auto per_exposure = static_cast<float>(0.5 / layers.exposure);

  Terms quadratic{};
  std::copy(layers.quadratic.begin(), layers.quadratic.end(),
            quadratic.begin());
  std::vector<SplinePlace> places(placed.size());
  std::vector<float> shares(placed.size());
  const std::int32_t first_column = stack.windows[picture].x;
  for (std::int32_t row = window.top; row < window.bottom; ++row) {
    const Columns columns =
        seen_in_row[static_cast<std::size_t>(row - window.top)];
    const float* const levels = stack.WindowRow(picture, row);
    for (std::int32_t column = columns.begin; column < columns.end; ++column) {
      const std::int32_t pixel = row * stack.width + column;
      const float behind = still[pixel];
      const float step_x = 0.5F * (still[pixel + 1] - still[pixel - 1]);
      const float step_y =
          0.5F * (still[pixel + stack.width] - still[pixel - stack.width]);
      const StillEdge edge =
          layers.edges.empty() ? StillEdge{}
                               : layers.edges[static_cast<std::size_t>(pixel)];
      float covered = 0.0F;
      float lifted = 0.0F;  // by what covers it: sum of w M (T + S - B)
      float model = behind;
      std::array<float, kPose> by_pose{};
      std::array<float, kShared> by_shared{};
      for (std::size_t k = 0; k < placed.size(); ++k) {
        const Placed& node = placed[k];
        const float dx = static_cast<float>(column) - node.x;
        const float dy = static_cast<float>(row) - node.y;
        const float x = node.cosine * dx + node.sine * dy;
        const float y = node.cosine * dy - node.sine * dx;
        const CoverAt m = cover.At(x, y);
        shares[k] = node.weight * m.value;
        if (!layers.flat) places[k] = layers.grid.LocatePlace(x, y);
        if (m.value < kLeastCover && m.by_blur == 0.0F) continue;
        PictureGrid::Tilt tilt;
        if (layers.flat) {
          const Terms terms = EvaluateTerms(x * per_reach, y * per_reach);
          tilt = ComputeTilt(quadratic, terms, per_reach);
          for (std::size_t j = 0; kAll && j < kTerms; ++j) {
            by_shared[kQuadratic + j] += shares[k] * terms[j];
          }
        } else {
          tilt = layers.grid.EvaluateTilt(layers.picture.data(), places[k]);
        }
        const float over = tilt.value + slope_x * dx + slope_y * dy - behind;
        // What the blur makes of products: of a smooth picture to first order,
        // of an edge exactly.
        const float m_x = node.cosine * m.by_x - node.sine * m.by_y;
        const float m_y = node.sine * m.by_x + node.cosine * m.by_y;
        float t_x = slope_x;
        float t_y = slope_y;
        if (layers.flat) {
          t_x += node.cosine * tilt.by_x - node.sine * tilt.by_y;
          t_y += node.sine * tilt.by_x + node.cosine * tilt.by_y;
        }
        Product product;
        if (m.by_long != 0.0F || m.by_short != 0.0F) {
          if (edge.contrast != 0.0F) {
            product = cover.WithEdge(x, y, edge, node.cosine, node.sine);
          } else if (std::max(std::abs(step_x), std::abs(step_y)) <
                     most_slope) {
            t_x -= step_x;
            t_y -= step_y;
          }
        }
        const float own = m_x * t_x + m_y * t_y;
        covered += shares[k];
        lifted += shares[k] * over;
        model += shares[k] * over + node.weight * (blur2 * own - product.value);
        const float g_x = m.by_x * over + m.value * tilt.by_x - product.by_x;
        const float g_y = m.by_y * over + m.value * tilt.by_y - product.by_y;
        const float d_x = node.weight * (-node.cosine * g_x + node.sine * g_y -
                                         m.value * slope_x);
        const float d_y = node.weight * (-node.sine * g_x - node.cosine * g_y -
                                         m.value * slope_y);
        const float d_turn = node.weight * (g_x * y - g_y * x);
        by_pose[0] += d_x;
        by_pose[1] += d_y;
        by_pose[2] += d_turn;
        if constexpr (kAll) {
          if (layers.flat) {
            AddOwnSlopes(node.weight * blur2, m, x * per_reach, y * per_reach,
                         per_reach, by_shared);
          }
          by_shared[kBlur] +=
              node.weight * (m.by_blur * over + twice_blur * own);
          by_shared[kExposureSquare] +=
              per_exposure * node.tau *
              (d_x * v_x + d_y * v_y + d_turn * v_turn);
          by_shared[kLong] += node.weight * m.by_long * over;
          by_shared[kShort] += node.weight * m.by_short * over;
          by_shared[kSlopeX] +=
              per_reach * (shares[k] * dx + node.weight * blur2 * m_x);
          by_shared[kSlopeY] +=
              per_reach * (shares[k] * dy + node.weight * blur2 * m_y);
        }
      }
      if (covered < kLeastCover) continue;
      const float step = lifted / covered;
      const float bent = 0.5F * step / std::max(model, kLeastLevel_dn);
      const float by_curve = covered * (1.0F - covered) * step * bent;
      by_shared[kCurve] = by_curve;
      if (curve != 0.0F) {
        model += curve * by_curve;
        const float steeper = 1.0F + curve * (1.0F - 2.0F * covered) * bent;
        for (float& slope : by_pose) slope *= steeper;
        for (const std::size_t i : {kBlur, kExposureSquare, kLong, kShort}) {
          by_shared[i] *= steeper;
        }
      }
      const float level = levels[column - first_column];
      const float residual = level - model;
      const std::size_t at = count++;
      samples.pixel[at] = pixel;
      samples.level[at] = level;
      samples.residual[at] = residual;
      samples.weight[at] = RobustWeight(residual, layers.noise_dn);
      samples.open[at] = 1.0F - covered;
      samples.cover[at] = covered;
      for (std::size_t i = 0; i < kPose; ++i) {
        samples.by_pose[i][at] = by_pose[i];
      }
      for (std::size_t i = 0; kAll && i < kShared; ++i) {
        samples.by_shared[i][at] = by_shared[i];
      }
      for (std::size_t k = 0; k < samples.nodes; ++k) {
        samples.place[at * samples.nodes + k] = places[k];
        if (kAll) samples.share[at * samples.nodes + k] = shares[k];
      }
    }
  }
  samples.Resize(count, kDerivatives);
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
  if (derivatives == Derivatives::kAll) {
    LinearizeModel<Derivatives::kAll>(stack, picture, layers, pose, motion,
                                      samples);
  } else {
    LinearizeModel<Derivatives::kByPose>(stack, picture, layers, pose, motion,
                                         samples);
  }
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
