// What all pixels say of the still picture B that no sample of a body contains.
#pragma once

#include <vector>

#include "layers/layer_model.h"

namespace touchdown::vision::layers {

// By pixel of B.
struct StillEvidence {
  std::vector<float> weight;    // sum of w: as if so many frames showed it
  std::vector<float> residual;  // sum of w (I - B)
};

// B of a pixel that nothing tells keeps its level: as if a hundredth of a frame
// had shown it.
inline constexpr float kLeastStill = 0.01F;

// `frames`: samples of each picture of the stack.
StillEvidence WeighStill(const PictureStack& stack, const Layers& layers,
                         const std::vector<FrameSamples>& frames, int threads);

}  // namespace touchdown::vision::layers
