// A path followed beyond its ends.
#pragma once

#include <cstdint>

#include "layers/align_pose.h"
#include "layers/fit_layers.h"
#include "touchdown/vision/footage/clip.h"
#include "tracking/layer_pictures.h"

namespace touchdown::vision {

// The frames before and after those of a path that show the body, too: from
// pose to pose with the layers held, at half the resolution.
class LayerExtension {
 public:
  LayerExtension(Clip& clip, const core::PixelRect& box,
                 const layers::LayerFit& half, bool turns)
      : clip_(clip), box_(box), half_(half), turns_(turns) {}

  // Adds them at the end (by = 1, up to frame `end`) or at the beginning
  // (by = -1); poses are at half the resolution.
  void Extend(std::int64_t by, std::int64_t end, LayerPath& path) const;

 private:
  layers::PoseFit Align(std::int64_t frame, const layers::LayerPose& from,
                        const layers::LayerPose& motion) const;

  Clip& clip_;
  const core::PixelRect& box_;
  const layers::LayerFit& half_;
  bool turns_;
};

}  // namespace touchdown::vision
