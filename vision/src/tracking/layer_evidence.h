// What the layers of a clip are learned from.
#pragma once

#include <cstddef>
#include <vector>

#include "layers/fit_layers.h"
#include "layers/picture_stack.h"
#include "layers/still_edges.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"
#include "tracking/layer_pictures.h"

namespace touchdown::vision {

// Pictures of so many frames are learned from; more cost time and memory and
// tell little more.
inline constexpr std::size_t kMostLearned = 96;
inline constexpr std::size_t kLeastLayerPoses = 5;

// A path, its pictures and the first still picture, of the part of the picture
// that the body passes.
struct LayerEvidence {
  core::PixelRect box;
  std::vector<float> still;
  double noise_dn = 1.0;
  std::size_t most_frames = 0;  // at a time
  LayerPath path;
  layers::PictureStack stack;
};

// Of a path in the box's coordinates. `background`: of the clip's levels.
// Throws what Clip::Read throws.
LayerEvidence ReadEvidence(Clip& clip, const Background& background,
                           const core::PixelRect& box, LayerPath path,
                           const layers::Shape& shape);

// Of a track whose outlines are about right. Throws what Clip::Read throws.
LayerEvidence GatherEvidence(Clip& clip, const Background& background,
                             const Track& track, const layers::Shape& shape,
                             const layers::FitLayersOptions& options);

// The straight edges of the whole background, in the box's coordinates. What
// the body covers in many frames may be itself there.
std::vector<layers::StillLine> FindLines(const Background& background,
                                         const LayerEvidence& evidence,
                                         const layers::Shape& shape,
                                         double blur_px);

}  // namespace touchdown::vision
