// One frame's pose with the layers held, and what it is worth.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "layers/layer_model.h"

namespace touchdown::vision::layers {

// What a pose is worth, from the pixels of its frame.
struct PoseFit {
  LayerPose pose;
  std::array<std::array<double, kPose>, kPose> covariance{};
  // Mean squared residual over noise^2, no pixel counted as more than 16: a few
  // that show something else are no matter, a fifth of them are.
  double chi2 = 0.0;
  double seen = 0.0;  // share of the body that lies within the picture
  // Share of what the body changes in the still picture that its own picture
  // explains: 1 - sum M r^2 / sum M (I - B)^2. Near 0 something else is there.
  double explained = 0.0;
  // How steeply levels rise across the edges that tell x and y, DN/px, and how
  // much the residuals' correlation widens the covariance.
  std::array<double, 2> steepness{};
  double widened = 1.0;
  bool found = false;
};

// One frame's pose with all layers held, its weight falling with what is not
// known of them; the covariance takes the residuals' correlation from pixel to
// pixel into account (sandwich).
PoseFit AlignPose(const PictureStack& stack, std::size_t picture,
                  const Layers& layers, const LayerPose& start,
                  const LayerPose& motion, bool turns);

// Aligns all poses. Where a frame is explained clearly worse than others, its
// pose may be a local minimum: an outline that settled on another edge. It is
// aligned again from around, and moved where it is explained better there. How
// many were moved.
std::size_t AlignPoses(const PictureStack& stack, const Layers& layers,
                       bool turns, int threads, std::vector<LayerPose>& poses);

}  // namespace touchdown::vision::layers
