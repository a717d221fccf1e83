#include "tracking/layer_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace touchdown::vision {

using layers::FitLayersOptions;
using layers::LayerPose;
using layers::Shape;

LayerEvidence ReadEvidence(Clip& clip, const Background& background,
                           const core::PixelRect& box, LayerPath path,
                           const Shape& shape) {
  LayerEvidence evidence;
  evidence.box = box;
  evidence.still = CropBackground(background, box);
  evidence.noise_dn = std::sqrt(background.UsualVariance());
  evidence.path = std::move(path);
  evidence.stack = ReadPath(clip, evidence.still, evidence.path, shape, box);
  return evidence;
}

LayerEvidence GatherEvidence(Clip& clip, const Background& background,
                             const Track& track, const Shape& shape,
                             const FitLayersOptions& options) {
  const core::PixelRect box =
      SweptBox(background, track, shape, options.prior.value[layers::kBlur]);
  // So many samples are kept: 256 MiB.
  constexpr std::size_t kMostSamples = std::size_t{1} << 26U;
  const std::size_t pixels = static_cast<std::size_t>(box.width) *
                             static_cast<std::size_t>(box.height);
  const std::size_t most_frames =
      std::clamp(kMostSamples / std::max<std::size_t>(pixels, 1),
                 kLeastLayerPoses, kMostLearned);
  const LayerPath all = PathInBox(track, box, options.turns);
  LayerEvidence evidence = ReadEvidence(
      clip, background, box,
      Choose(all, SpreadEvenly(all.frames.size(), most_frames)), shape);
  evidence.most_frames = most_frames;
  return evidence;
}

std::vector<layers::StillLine> FindLines(const Background& background,
                                         const LayerEvidence& evidence,
                                         const Shape& shape, double blur_px) {
  // Of the frames. A background is the middle of what was seen.
  constexpr float kMostCovered = 0.2F;
  constexpr double kRim = 3.5;  // blurs, beyond which a body is not seen
  const core::PixelRect whole{0, 0, background.width_px, background.height_px};
  const std::vector<float> levels = CropBackground(background, whole);
  const auto frames = static_cast<float>(evidence.path.poses.size());
  std::vector<float> clear(levels.size(), 2.0F + kMostCovered * frames);
  const double reach = shape.Reach() + kRim * blur_px;
  for (const LayerPose& pose : evidence.path.poses) {
    const double x = pose.x + evidence.box.x;
    const double y = pose.y + evidence.box.y;
    const auto column = [&](double at) {
      return std::clamp(static_cast<std::int32_t>(std::lround(at)), 0,
                        whole.width);
    };
    const auto row = [&](double at) {
      return std::clamp(static_cast<std::int32_t>(std::lround(at)), 0,
                        whole.height);
    };
    for (std::int32_t j = row(y - reach); j < row(y + reach); ++j) {
      for (std::int32_t i = column(x - reach); i < column(x + reach); ++i) {
        clear[static_cast<std::size_t>(j) *
                  static_cast<std::size_t>(whole.width) +
              static_cast<std::size_t>(i)] -= 1.0F;
      }
    }
  }
  std::vector<layers::StillLine> lines = layers::FindStillLines(
      {levels.data(), clear, whole.width, whole.height}, blur_px,
      layers::kLeastStillStep * evidence.noise_dn);
  for (layers::StillLine& line : lines) {
    line = line.Within(evidence.box.x, evidence.box.y);
  }
  return lines;
}

}  // namespace touchdown::vision
