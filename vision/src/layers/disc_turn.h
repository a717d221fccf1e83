// How a disc's face turns in the plane of the picture, found from nothing. Its
// outline does not tell.
//
// On circles about the centre a face that has turned by phi shows the same
// levels farther along:  f_t(r, a) = T(r, a - phi_t) + noise.  phi_t is where
// f_t correlates best with T, the mean of the pictures turned back: of those
// before it at first, then of all, until nothing moves. Harmonics of a below
// the third are left out: shading that stays with the light is smooth, and
// would hold the face still.
#pragma once

#include <optional>
#include <vector>

#include "layers/layer_model.h"
#include "layers/picture_stack.h"

namespace touchdown::vision::layers {

// Mean square of what changes in the face from picture to picture, DN^2, the
// first harmonics left out: noise alone, where it has no marks or keeps still.
// 0 where FindTurns has nothing to look at.
double MeasureFaceChange(const PictureStack& stack, const Shape& disc,
                         double blur_px, const std::vector<LayerPose>& poses);

// Angles of all pictures, radians, from +x to +y, 0 where the face is first
// seen whole; each within half a turn of the one before it, and on a straight
// line where it is not seen whole. Nothing where one half of the face is not
// explained better by the turns that the other shows than by none; where turns
// leave more than a quarter of what changes beyond noise; where the disc is too
// small to show a face, or fewer than five pictures do.
std::optional<std::vector<double>> FindTurns(
    const PictureStack& stack, const Shape& disc, double blur_px,
    double noise_dn, const std::vector<LayerPose>& poses);

}  // namespace touchdown::vision::layers
