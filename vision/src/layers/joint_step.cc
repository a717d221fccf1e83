#include "layers/joint_step.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace touchdown::vision::layers {

CoarseSpace FindCoarseSpace(const Layers& layers,
                            const std::vector<FrameSamples>& frames,
                            const StillEvidence& evidence,
                            const std::vector<LayerPose>& poses,
                            const JointStepOptions& options) {
  const CoarseSpace none;
  NormalEquations equations(layers, frames, evidence, options.prior,
                            options.turns, none, options.threads);
  Unknowns right = equations.Zero();
  equations.Fill(right);
  return equations.FindCoarseSpace(poses);
}

JointStep SolveJointStep(const Layers& layers,
                         const std::vector<FrameSamples>& frames,
                         const StillEvidence& evidence,
                         const CoarseSpace& coarse,
                         const JointStepOptions& options) {
  NormalEquations equations(layers, frames, evidence, options.prior,
                            options.turns, coarse, options.threads);
  Unknowns residual = equations.Zero();
  equations.Fill(residual);
  Unknowns step = equations.Zero();
  Unknowns scaled = step;
  equations.Precondition(residual, scaled);
  Unknowns direction = scaled;
  Unknowns product = step;
  double power = residual.Dot(scaled);
  const double goal =
      std::max(power * options.tolerance * options.tolerance,
               options.least_chi2 * layers.noise_dn * layers.noise_dn);
  JointStep out;
  while (out.products < options.most_products && power > goal) {
    equations.Multiply(direction, product);
    ++out.products;
    const double along = direction.Dot(product);
    if (!(along > 0.0)) break;
    const double length = power / along;
    step.Add(length, direction);
    residual.Add(-length, product);
    equations.Precondition(residual, scaled);
    const double next = residual.Dot(scaled);
    direction.TurnTo(scaled, next / power);
    power = next;
  }
  for (std::size_t t = 0; t < frames.size(); ++t) {
    out.poses.push_back({step.poses[kPose * t], step.poses[kPose * t + 1],
                         step.poses[kPose * t + 2]});
  }
  out.shared = step.shared;
  out.picture = std::move(step.picture);
  out.still.resize(layers.still.size());
  for (std::size_t x = 0; x < out.still.size(); ++x) {
    out.still[x] = evidence.residual[x] / (evidence.weight[x] + kLeastStill);
  }
  const ShownPixels& shown = equations.shown();
  for (std::size_t i = 0; i < shown.size(); ++i) {
    out.still[shown.pixel[i]] = step.still[i];
  }
  return out;
}

}  // namespace touchdown::vision::layers
