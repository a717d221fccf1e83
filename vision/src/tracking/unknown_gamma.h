// What edges owe to a gamma that nobody stated.
//
// Blur mixes light, and a camera counts light^gamma (linear_clip.h). Where a
// share c of a pixel is of one side, its level is
//   level(c) = ((1 - c) w^(1 / gamma) + c b^(1 / gamma))^gamma
// between the levels w and b of both sides. An edge that is fitted to levels
// (w + (b - w) c, with c normal in the distance and a blur of s) lies toward w,
// to first order of least squares, by
//   2 sqrt(pi) s (integral of (level(c) - w) / (b - w) over c in 0..1, - 1/2)
//     = sqrt(pi) / 3 s (1 / gamma - 1) (b - w) / (b + w)
// to the second order of level(c). Between levels of a ratio up to 9 it is
// within 15 % of the fit (unknown_gamma_test.cc). No residual tells: a gamma
// and a shift change an edge in nearly the same way. A stated size does.
#pragma once

#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// No camera has less. Of a gamma of which nothing is known: one half of the
// cameras is linear, the other half has any down to this, evenly in its
// logarithm.
inline constexpr double kLeastGamma = 0.3;

// px, of an edge between both levels, toward the first. The blur as a standard
// deviation.
double EdgeShift(double first_dn, double second_dn, double blur_px,
                 double gamma);

// What a gamma of which nothing is known leaves open of the track's outlines:
// root mean square of their shift, px. Where the contrast is strong, a fit has
// its weight.
double UnknownShift(const Background& background, const Track& track);

// Sets BodyImage's gamma_long_px and gamma_short_px to it, where the sizes are
// those of outlines and the clip's gamma is not known.
void TakeUnknownGamma(const ClipInfo& clip, const Background& background,
                      Track& track);

}  // namespace touchdown::vision
