// How much the body's picture varies, and how far that reaches: whether it is
// flat, and what a texture's prior is.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "layers/layer_model.h"

namespace touchdown::vision::layers {

// The variance of a texture with tau = 1 (Texture in layer_model.h).
double UnitVariance(double rate);

// What is known of T before any picture: it is a quadratic, which may be any,
// plus a texture.
class PicturePrior {
 public:
  PicturePrior() = default;
  PicturePrior(const PictureGrid& grid, const Texture& texture);
  // (1 - Pi) Q (1 - Pi) x, with the projector Pi on the quadratics. `to` may
  // be `from`.
  void Multiply(const float* from, float* to) const;
  // Q.
  Eigen::SparseMatrix<float> MakePrecision() const;

 private:
  void RemoveQuadratic(Eigen::VectorXf& x) const;

  Eigen::MatrixXd basis_;              // of the quadratics, orthonormal
  Eigen::SparseMatrix<float> slopes_;  // kappa^2 + L
  float precision_ = 0.0F;             // 1 / tau^2
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

// Empirical Bayes: the texture of a spline T, from its variance about its mean
// and its autocorrelation over two pixels, which is about an edge's blur, over
// the cells inside of the blurred edge, where T is not to be mistaken for the
// outline's place. `weight`: WeighPicture. A shading counts as texture: the
// prior is the wider for it.
Texture MeasureTexture(const Layers& layers, const std::vector<float>& weight);

}  // namespace touchdown::vision::layers
