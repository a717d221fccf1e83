// How much the body's picture varies about a quadratic: whether it is flat, and
// what a texture's prior is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "layers/layer_model.h"

namespace touchdown::vision::layers {

// The quadratics that T is free to be, as an orthonormal basis of its
// coefficients: what lies outside of them has the variance texture_dn^2.
class FreePart {
 public:
  FreePart() = default;
  explicit FreePart(const PictureGrid& grid);
  // x - Pi x.
  void RemoveComponent(const float* from, float* to) const;

 private:
  Eigen::MatrixXd basis_;
};

// Of a flat body: standard deviation of what its residuals have in common, cell
// by cell of its own picture, DN: means over the frames, less the noise of a
// mean.
double MeasureCommonTexture(const PictureStack& stack, const Layers& layers,
                            const std::vector<LayerPose>& poses,
                            const std::vector<FrameSamples>& frames);

// How often each coefficient of a spline T is seen: the sum of squared
// coverage.
std::vector<float> WeighPicture(const Layers& layers,
                                const std::vector<FrameSamples>& frames);

// Empirical Bayes: the standard deviation of a spline T about its own
// quadratic, DN, over the cells inside of the blurred edge, where T is not to
// be mistaken for the outline's place. `weight`: WeighPicture.
double MeasureTexture(const Layers& layers, const std::vector<float>& weight);

}  // namespace touchdown::vision::layers
