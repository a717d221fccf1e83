#include "layers/pixel_lanes.h"

#include "numbers/lanes.h"

namespace touchdown::vision::layers {

TOUCHDOWN_WIDEST
void EvaluateFlat(const NodeNumbers& node, NodeLanes& seen) {
  const std::array<float, kTerms>& q = node.quadratic;
  for (std::size_t i = 0; i < kChunk; ++i) {
    const float x = seen.x[i] * node.per_reach;
    const float y = seen.y[i] * node.per_reach;
    seen.tilt[i] = q[0] + q[1] * x + q[2] * y + q[3] * (x * x) +
                   q[4] * (x * y) + q[5] * (y * y);
    seen.tilt_x[i] = (q[1] + 2.0F * q[3] * x + q[4] * y) * node.per_reach;
    seen.tilt_y[i] = (q[2] + q[4] * x + 2.0F * q[5] * y) * node.per_reach;
  }
}

TOUCHDOWN_WIDEST
void AddNode(const NodeNumbers& node, const NodeLanes& seen, bool all,
             PixelLanes& sums) {
  const float w = node.at.weight;
  const float cosine = node.at.cosine;
  const float sine = node.at.sine;
  const float by_down = node.slope_y * node.down;
  for (std::size_t i = 0; i < kChunk; i += kWide) {
    const Wide right = WideAt(&seen.right[i]);
    const Wide x = WideAt(&seen.x[i]);
    const Wide y = WideAt(&seen.y[i]);
    const Wide cover = WideAt(&seen.cover[i]);
    const Wide by_x = WideAt(&seen.by_x[i]);
    const Wide by_y = WideAt(&seen.by_y[i]);
    const Wide tilt_x = WideAt(&seen.tilt_x[i]);
    const Wide tilt_y = WideAt(&seen.tilt_y[i]);
    const Wide over = WideAt(&seen.tilt[i]) + node.slope_x * right + by_down -
                      WideAt(&sums.behind[i]);
    // What the blur makes of products: of a smooth picture to first order, of
    // an edge exactly.
    const Wide m_x = cosine * by_x - sine * by_y;
    const Wide m_y = sine * by_x + cosine * by_y;
    Wide t_x = node.slope_x - WideAt(&seen.still_x[i]);
    Wide t_y = node.slope_y - WideAt(&seen.still_y[i]);
    if (node.flat) {
      t_x += cosine * tilt_x - sine * tilt_y;
      t_y += sine * tilt_x + cosine * tilt_y;
    }
    const Wide own = m_x * t_x + m_y * t_y;
    const Wide share = w * cover;
    WideAt(&sums.covered[i]) += share;
    WideAt(&sums.model[i]) +=
        share * over + w * (node.blur2 * own - WideAt(&seen.product[i]));
    const Wide g_x = by_x * over + cover * tilt_x - WideAt(&seen.product_x[i]);
    const Wide g_y = by_y * over + cover * tilt_y - WideAt(&seen.product_y[i]);
    const Wide d_x = w * (-cosine * g_x + sine * g_y - cover * node.slope_x);
    const Wide d_y = w * (-sine * g_x - cosine * g_y - cover * node.slope_y);
    const Wide d_turn = w * (g_x * y - g_y * x);
    const Wide l_x = share * WideAt(&seen.middle_x[i]);
    const Wide l_y = share * WideAt(&seen.middle_y[i]);
    WideAt(&sums.by_pose[0][i]) += d_x - cosine * l_x + sine * l_y;
    WideAt(&sums.by_pose[1][i]) += d_y - sine * l_x - cosine * l_y;
    WideAt(&sums.by_pose[2][i]) += d_turn + l_x * y - l_y * x;
    if (!all) continue;
    const auto by = [&sums, i](std::size_t j) -> Wide& {
      return WideAt(&sums.by_shared[j][i]);
    };
    by(kBlur) += w * (WideAt(&seen.by_blur[i]) * over + node.twice_blur * own);
    by(kExposureSquare) +=
        (node.per_exposure * node.at.tau) *
        (d_x * node.v_x + d_y * node.v_y + d_turn * node.v_turn);
    by(kLong) += w * WideAt(&seen.by_long[i]) * over;
    by(kShort) += w * WideAt(&seen.by_short[i]) * over;
    const float blurred = w * node.blur2;
    by(kSlopeX) += node.per_reach * (share * right + blurred * m_x);
    by(kSlopeY) += node.per_reach * (share * node.down + blurred * m_y);
    if (!node.flat) continue;
    // By a quadratic T, with the product's part: s^2 grad M . grad of each
    // term.
    const Wide u = x * node.per_reach;
    const Wide v = y * node.per_reach;
    const Wide along = (blurred * node.per_reach) * by_x;
    const Wide across = (blurred * node.per_reach) * by_y;
    by(kQuadratic) += share;
    by(kQuadratic + 1) += share * u + along;
    by(kQuadratic + 2) += share * v + across;
    by(kQuadratic + 3) += share * (u * u) + 2.0F * u * along;
    by(kQuadratic + 4) += share * (u * v) + v * along + u * across;
    by(kQuadratic + 5) += share * (v * v) + 2.0F * v * across;
  }
}

TOUCHDOWN_WIDEST
void FinishPixels(const Lanes& levels, float noise_dn, PixelLanes& sums) {
  for (std::size_t i = 0; i < kChunk; ++i) {
    sums.residual[i] = levels[i] - sums.model[i];
    sums.weight[i] = RobustWeight(sums.residual[i], noise_dn);
  }
}

}  // namespace touchdown::vision::layers
