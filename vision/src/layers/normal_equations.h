// The normal equations of one Gauss-Newton step in everything at once: poses,
// what the frames share, the body's picture T and the still picture B.
//   A d = g,  A = sum_i w_i J_i J_i' + P,  g = sum_i w_i J_i r_i - P (x - x0)
// A is not stored: a product costs one pass over the samples.
//
// Their preconditioner has two levels (R. A. Nicolaides, SIAM J. Numer. Anal.
// 24(2), 1987; additive, as in A. Toselli and O. Widlund, Domain Decomposition
// Methods, 2005, section 2.2):
//   M^-1 = blocks^-1 + W (W' A W)^-1 W'
// The blocks are those of each pose, T and the diagonal of B. The
// directions W are those that pixels tell little of, for T can follow them: a
// slope of the light, or a common shift of all poses.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "layers/coarse_space.h"
#include "layers/layer_model.h"
#include "layers/still_evidence.h"
#include "layers/texture.h"
#include "layers/unknowns.h"
#include "numbers/symmetric_factor.h"

namespace touchdown::vision::layers {

// What is known beforehand of the shared parameters: standard uncertainties;
// 0: held.
struct SharedPrior {
  std::array<double, kShared> value{};
  std::array<double, kShared> u{};
};

// The pixels that some sample shows, by row, and which of them each sample
// does. The body passes over a small share of all (a fifteenth where it crosses
// the picture once): no equation joins the others, and each is solved by
// itself.
struct ShownPixels {
  std::vector<std::size_t> pixel;
  std::vector<std::vector<std::uint32_t>> of_samples;  // by frame

  ShownPixels(const std::vector<FrameSamples>& frames, std::size_t pixels);
  std::size_t size() const { return pixel.size(); }
};

class NormalEquations {
 public:
  using SharedMatrix = Eigen::Matrix<double, kShared, kShared>;

  // `turns`: false: angles are held. `coarse`: may be empty.
  NormalEquations(const Layers& layers, const std::vector<FrameSamples>& frames,
                  const StillEvidence& evidence, const SharedPrior& prior,
                  bool turns, const CoarseSpace& coarse, int threads);

  const ShownPixels& shown() const { return shown_; }
  Unknowns Zero() const;

  // The right side g, and the preconditioner.
  void Fill(Unknowns& right);
  void Multiply(const Unknowns& in, Unknowns& out);
  void Precondition(const Unknowns& in, Unknowns& out);

  // After Fill. `poses`: those of the frames.
  CoarseSpace FindCoarseSpace(const std::vector<LayerPose>& poses);

 private:
  // work(samples, frame, part) over all frames, part by part.
  template <class Work>
  void AccumulateParts(const Work& work);
  std::size_t PartOf(const Unknowns& sums) const {
    return static_cast<std::size_t>(&sums - parts_.data());
  }
  void Collect(Unknowns& out);
  std::shared_ptr<const PictureFactor> FactorPicture(
      const std::vector<float>& weight) const;
  void PreconditionPicture(const float* in, float* out) const;
  void AddCoarse(const Unknowns& in, Unknowns& out);
  void InvertCoarse(const SharedMatrix& shared);

  const Layers& layers_;
  const std::vector<FrameSamples>& frames_;
  const StillEvidence& evidence_;
  const SharedPrior& known_;
  const CoarseSpace& coarse_;
  bool turns_;
  int threads_;
  ShownPixels shown_;
  PicturePrior picture_prior_;   // of a T that is a spline
  std::size_t cells_;            // unknown coefficients of T
  std::size_t columns_;          // of the shared parameters that are not held
  std::vector<Unknowns> parts_;  // each part's sums of what frames share
  std::vector<float> outside_;
  float variance_ = 0.0F;  // of a pixel
  std::array<double, kShared> prior_{};

  // The preconditioner.
  std::vector<Eigen::Matrix3d> pose_inverse_;
  NormalMatrix coarse_inverse_;
  std::shared_ptr<const PictureFactor> picture_factor_;
  std::vector<float> still_inverse_;
};

}  // namespace touchdown::vision::layers
