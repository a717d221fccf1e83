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

// Angles of all pictures, radians, from +x to +y, beginning with 0; each within
// half a turn of where the two before it lead. Nothing where the pictures are
// not explained better by a face that turns than by one that does not, by
// Schwarz's criterion; where the disc is too small to show a face, or reaches
// beyond the pictures.
std::optional<std::vector<double>> FindTurns(
    const PictureStack& stack, const Shape& disc, double blur_px,
    const std::vector<LayerPose>& poses);

}  // namespace touchdown::vision::layers
