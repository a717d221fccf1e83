// One Gauss-Newton step in everything at once: poses, what the frames share,
// the body's picture T and the still picture B.
//
// A common offset of the outline against T, and with it of all poses, is told
// only by the edges: minimising over poses and pictures in turns finds it in
// hundreds of rounds. So the normal equations
//   (sum_i w_i J_i J_i' + P) d = sum_i w_i J_i r_i - P (x - x0)
// are solved for all unknowns together, by conjugate gradients (M. R. Hestenes
// and E. Stiefel, J. Res. NBS 49, 1952; normal_equations.h).
#pragma once

#include <cstddef>
#include <vector>

#include "layers/normal_equations.h"

namespace touchdown::vision::layers {

struct JointStepOptions {
  SharedPrior prior;
  bool turns = true;  // false: angles are held (a disc without marks)
  // Conjugate gradients end when the residual has fallen to this share.
  double tolerance = 1e-3;
  // Or when what is left, r' M^-1 r over the noise's variance, is below this:
  // all unknowns together are a sixth of a standard deviation off then, were
  // they independent. Not studied alone: with 1e-2, half the tolerance and no
  // coarse space 112 photographed clips had the same errors or larger ones.
  double least_chi2 = 3e-2;
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

// `poses`: those of `frames`. `layers` hold a spline.
CoarseSpace FindCoarseSpace(const Layers& layers,
                            const std::vector<FrameSamples>& frames,
                            const StillEvidence& evidence,
                            const std::vector<LayerPose>& poses,
                            const JointStepOptions& options);

// `coarse`: may be empty.
JointStep SolveJointStep(const Layers& layers,
                         const std::vector<FrameSamples>& frames,
                         const StillEvidence& evidence,
                         const CoarseSpace& coarse,
                         const JointStepOptions& options);

// Standard uncertainties of what all frames have in common, which no scatter of
// theirs shows: w' A^-1 w times the noise's variance, w being the mean of the
// poses along one of the body's axes, or one shared parameter. A solution each.
struct CommonUncertainty {
  double x_px = 0.0;  // the place, along the body's long axis
  double y_px = 0.0;
  double angle_rad = 0.0;  // 0 where angles are held
  double long_px = 0.0;    // half sides; 0 where they are held
  double short_px = 0.0;
};
CommonUncertainty MeasureCommonUncertainty(
    const Layers& layers, const std::vector<FrameSamples>& frames,
    const StillEvidence& evidence, const CoarseSpace& coarse,
    const std::vector<LayerPose>& poses, const JointStepOptions& options);

}  // namespace touchdown::vision::layers
