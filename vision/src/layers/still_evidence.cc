#include "layers/still_evidence.h"

#include <algorithm>
#include <cstdint>

#include "touchdown/core/parallel.h"

namespace touchdown::vision::layers {

StillEvidence WeighStill(const PictureStack& stack, const Layers& layers,
                         const std::vector<FrameSamples>& frames, int threads) {
  StillEvidence evidence;
  evidence.weight.assign(stack.pixels(), 0.0F);
  evidence.residual.assign(stack.pixels(), 0.0F);
  const double noise_dn = layers.noise_dn;
  // Row by row, and in a row frame by frame, so that the compiler can take
  // pixels together and threads do not matter.
  const auto weigh_row = [&](std::int32_t row) {
    const std::size_t first =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(stack.width);
    const float* const still = layers.still.data() + first;
    float* const weights = evidence.weight.data() + first;
    float* const residuals = evidence.residual.data() + first;
    float pictures = 0.0F;
    std::vector<float> shown(static_cast<std::size_t>(stack.width));
    for (std::size_t t = 0; t < frames.size(); ++t) {
      if (frames[t].size() == 0) continue;
      pictures += 1.0F;
      const core::PixelRect& window = stack.windows[t];
      if (row < window.y || row >= window.y + window.height) continue;
      const float* const levels = stack.WindowRow(t, row);
      const std::ptrdiff_t left = window.x;
      for (std::ptrdiff_t i = 0; i < window.width; ++i) {
        const float off = levels[i] - still[left + i];
        const float weight = RobustWeight(off, noise_dn);
        weights[left + i] += weight;
        residuals[left + i] += weight * off;
        shown[static_cast<std::size_t>(left + i)] += 1.0F;
      }
    }
    if (stack.outside.empty()) return;
    const float* const outside = stack.outside.data() + first;
    for (std::ptrdiff_t x = 0; x < stack.width; ++x) {
      const float off = outside[x] - still[x];
      const float weight = (pictures - shown[static_cast<std::size_t>(x)]) *
                           RobustWeight(off, noise_dn);
      weights[x] += weight;
      residuals[x] += weight * off;
    }
  };
  core::InParallel(stack.height, threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (std::int64_t row = begin; row < end; ++row) {
                       weigh_row(static_cast<std::int32_t>(row));
                     }
                   });
  for (const FrameSamples& samples : frames) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto x = static_cast<std::size_t>(samples.pixel[i]);
      const float off = samples.level[i] - layers.still[x];
      const float weight = RobustWeight(off, noise_dn);
      evidence.weight[x] -= weight;
      evidence.residual[x] -= weight * off;
    }
  }
  for (float& weight : evidence.weight) weight = std::max(weight, 0.0F);
  return evidence;
}

}  // namespace touchdown::vision::layers
