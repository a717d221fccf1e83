// Layers of a clip's levels and, where the camera counted a power of the light
// (linear_clip.h), of its light. Blur and coverage mix light: the edges of a
// body that were fitted in levels lie up to tenths of a pixel beside it, toward
// the darker side.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "layers/fit_layers.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track_options.h"
#include "tracking/layer_evidence.h"

namespace touchdown::vision {

// What of a body hangs on the gamma: each edge moves by what lies on both sides
// of it.
struct SidesInLight {
  double half_long_px = 0.0;
  double half_short_px = 0.0;
  layers::LayerPose pose;  // mean of all pictures, in the body's axes
};

struct LightFit {
  // Of the camera: evidence and layers are its light. Absent: levels.
  std::optional<double> gamma;
  std::unique_ptr<Clip> light;  // a view of the clip, with gamma alone
  LayerEvidence evidence;
  layers::LayerFit fit;
  SidesInLight u;  // what they owe to a gamma that is not known better
};

// What a gamma costs: half of chi2, as a log likelihood has it; and the sides
// that go with it.
struct GammaTrial {
  double log_gamma = 0.0;
  double cost = 0.0;
  SidesInLight sides;  // the pose: beside that of the first trial
};

// Where the parabola through three trials is least.
double FindLeastLogGamma(const std::vector<GammaTrial>& trials);

// Standard uncertainty of log gamma: of the parabola around the trial that
// costs least. A camera is as often linear (spike) as of any gamma down to the
// least, g (slab): where levels cost least, and more by k per unit of
// x = -log gamma, the mean square of x is 2 / (k^3 log(1 / g)).
double LogGammaUncertainty(std::vector<GammaTrial> trials);

// By how much outlines lie beside a stated size, px, beyond its own u: the
// larger of both sides', and of sides that a texture holds.
double OutlinesBeside(const layers::LayerFit& fit, const BodySize& size);

// Layers of the levels, or of the light of the gamma that explains the levels
// and the sides that are known (options.prior) best: a profile likelihood.
// Of a clip whose gamma is known levels are all. `evidence`: of the levels.
// Throws what Clip::Read throws.
LightFit FitLevelsOrLight(Clip& clip, const Background& background,
                          const layers::Shape& shape, LayerEvidence evidence,
                          const layers::FitLayersOptions& options);

}  // namespace touchdown::vision
