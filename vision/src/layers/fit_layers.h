// Poses, pictures and optics of a clip, from poses that are about right.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "layers/joint_step.h"
#include "layers/layer_model.h"
#include "layers/still_edges.h"
#include "touchdown/core/cancellation.h"

namespace touchdown::vision::layers {

struct FitLayersOptions {
  // First values and what is known of them (SharedPrior).
  SharedPrior prior;
  bool turns = true;
  // Whether the body is known to have a texture. Else it is flat until its
  // pictures say that it is not.
  bool textured = false;
  // Steps at the most; fewer where the poses no longer move.
  int steps = 8;
  // And so many more as long as a pose moves by a third of a pixel: it is not
  // where it belongs yet, and what it shows there spoils T.
  int steps_astray = 0;
  // Where conjugate gradients end (joint_step.h). With 0.1 outlines lie up to
  // 0.03 px beside strong textures: what pixels tell little of comes last.
  double tolerance = 0.02;
  int threads = 0;
  core::Cancellation until;  // asked before each step
  // Straight edges of the whole still picture, in the stack's coordinates.
  std::vector<StillLine> lines;
};

// What is known of the optics at first: whatever told them, pictures tell them
// far better. Blur in px, exposure in frame intervals.
void SetOptics(double blur, double exposure, SharedPrior& prior);

struct LayerFit {
  Layers layers;
  std::vector<LayerPose> poses;  // of each picture of the stack
  bool converged = false;
  CommonUncertainty common;  // of a textured body
  // px by which outlines lie beside sizes that are held before a texture; 0 of
  // others. What moves outlines, as a camera's gamma does, moves all edges of a
  // body in the air outward alike; at the ground one of them counts for less,
  // and the place is off by up to as much.
  double beyond_px = 0.0;
};

// From layers and poses that are nearly right: those of another scale of
// levels.
LayerFit ImproveLayers(const PictureStack& stack, LayerFit fit,
                       const FitLayersOptions& options);

// `still`: a first B. Poses within about 2 s of the truth; from farther they
// may settle elsewhere: begin with halved pictures.
LayerFit FitLayers(const PictureStack& stack, const Shape& shape,
                   const std::vector<LayerPose>& poses,
                   const std::vector<float>& still, double noise_dn,
                   const FitLayersOptions& options);

// What a pixel's level and the model's cost.
using Loss = std::function<double(float level, float model)>;

// Mean over the pixels that show something of the body, so that fits of one
// clip whose levels are not of one scale can be compared.
double MeanLoss(const PictureStack& stack, const LayerFit& fit,
                const Loss& loss);

}  // namespace touchdown::vision::layers
