// Layers of a clip's levels and, where the camera counted a power of the light
// (linear_clip.h), of its light. Blur and coverage mix light: the edges of a
// body that were fitted in levels lie up to tenths of a pixel beside it, toward
// the darker side.
#pragma once

#include <memory>
#include <optional>

#include "layers/fit_layers.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track_options.h"
#include "tracking/layer_evidence.h"

namespace touchdown::vision {

struct LightFit {
  // Of the camera: evidence and layers are its light. Absent: levels.
  std::optional<double> gamma;
  std::unique_ptr<Clip> light;  // a view of the clip, with gamma alone
  LayerEvidence evidence;
  layers::LayerFit fit;
};

// By how much outlines lie beside a stated size, px, beyond its own u: the
// larger of both sides', and of sides that a texture holds.
double OutlinesBeside(const layers::LayerFit& fit, const BodySize& size);

// Whether light explains the levels (LayerFit::loss) better than what was
// fitted before while the outlines lie no farther beside a stated size, or
// about as well while they lie much nearer.
bool IsBetterInLight(const layers::LayerFit& light,
                     const layers::LayerFit& before,
                     const std::optional<BodySize>& size);

// Levels first. Where their outlines show a gamma that matters
// (LayerFit::curve) light is fitted from there, and once more where the
// outlines still show one, as long as that is better. Of a clip that is in
// light already levels are all. `evidence`: of the levels.
// Throws what Clip::Read throws.
LightFit FitLevelsThenLight(Clip& clip, const Background& background,
                            const layers::Shape& shape, LayerEvidence evidence,
                            const std::optional<BodySize>& size,
                            layers::FitLayersOptions options);

}  // namespace touchdown::vision
