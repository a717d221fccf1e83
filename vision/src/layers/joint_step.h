// One Gauss-Newton step in everything at once: poses, what the frames share,
// the body's picture T and the still picture B.
//
// A common offset of the outline against T, and with it of all poses, is told
// only by the edges: minimising over poses and pictures in turns finds it in
// hundreds of rounds. So the normal equations
//   (sum_i w_i J_i J_i' + P) d = sum_i w_i J_i r_i - P (x - x0)
// are solved for all unknowns together, by conjugate gradients with blocks as
// preconditioner (M. R. Hestenes and E. Stiefel, J. Res. NBS 49, 1952; Jacobi
// blocks of each pose and of the shared ones, the diagonal of B and that of T's
// levels). No matrix is stored: a product costs one pass over the samples.
#pragma once

#include <cstddef>
#include <vector>

#include "layers/layer_model.h"

namespace touchdown::vision::layers {

// What is known beforehand of the shared parameters: standard uncertainties;
// 0: held.
struct SharedPrior {
  std::array<double, kShared> value{};
  std::array<double, kShared> u{};
};

// What all pixels say of B that no sample of a body contains.
struct StillEvidence {
  std::vector<float> weight;
  std::vector<float> residual;  // sum of w (I - B)
};
// `frames`: samples of each picture of the stack.
StillEvidence WeighStill(const PictureStack& stack, const Layers& layers,
                         const std::vector<FrameSamples>& frames, int threads);

// The quadratics that T is free to be, as an orthonormal basis of its
// coefficients: what lies outside of them has the variance texture_dn^2.
class FreePart {
 public:
  explicit FreePart(const PictureGrid& grid);
  // x - Pi x.
  void RemoveComponent(const float* from, float* to) const;

 private:
  std::vector<std::vector<float>> basis_;
};

struct JointStepOptions {
  SharedPrior prior;
  bool turns = true;  // false: angles are held (a disc without marks)
  // Conjugate gradients end when the residual has fallen to this share.
  double tolerance = 1e-3;
  // Or when what is left, r' M^-1 r over the noise's variance, is below this:
  // all unknowns together are a tenth of a standard deviation off then, were
  // they independent. With 1e-9 answers of four textured clips differ by at
  // most 0.1 of their u, and cost 1.1 to 1.2 times as much.
  double least_chi2 = 1e-2;
  int most_products = 60;
  int threads = 0;
};

struct JointStep {
  std::vector<LayerPose> poses;
  std::array<double, kShared> shared{};
  std::vector<float> picture;
  std::vector<float> still;
  int products = 0;
};

JointStep SolveJointStep(const Layers& layers,
                         const std::vector<FrameSamples>& frames,
                         const StillEvidence& evidence, const FreePart& free,
                         const JointStepOptions& options);

}  // namespace touchdown::vision::layers
