// Poses, pictures and optics of a clip, from poses that are about right.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "joint_step.h"
#include "layer_model.h"

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
  int threads = 0;
};

// What a pose is worth, from the pixels of its frame.
struct PoseFit {
  LayerPose pose;
  std::array<std::array<double, kPose>, kPose> covariance{};
  double chi2 = 0.0;  // mean squared residual over noise^2
  double seen = 0.0;  // share of the body that lies within the picture
  // How steeply levels rise across the edges that tell x and y, DN/px, and how
  // much the residuals' correlation widens the covariance.
  std::array<double, 2> steepness{};
  double widened = 1.0;
  bool found = false;
};

struct LayerFit {
  Layers layers;
  std::vector<LayerPose> poses;  // of each picture of the stack
  double chi2 = 0.0;             // of all pixels that the body reaches
  bool converged = false;
};

// `still`: a first B. Poses within about 2 s of the truth; from farther they
// may settle elsewhere: begin with halved pictures.
LayerFit FitLayers(const PictureStack& stack, const Shape& shape,
                   const std::vector<LayerPose>& poses,
                   const std::vector<float>& still, double noise_dn,
                   const FitLayersOptions& options);

// One frame's pose with all layers held, its weight falling with what is not
// known of them; the covariance takes the residuals' correlation from pixel to
// pixel into account (sandwich).
PoseFit AlignPose(const PictureStack& stack, std::size_t picture,
                  const Layers& layers, const LayerPose& start,
                  const LayerPose& motion, bool turns);

}  // namespace touchdown::vision::layers
