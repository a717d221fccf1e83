// How many impacts a contact was, and the restitution of those that were
// resolved.
#pragma once

#include <string>

#include "contact/joint_fit.h"
#include "touchdown/core/trial.h"
#include "touchdown/vision/contact/contact.h"

namespace touchdown::vision {

// Of the normal impulse between the two flights, the share that the corner took
// which is the second lowest: 0 where the body struck with the lowest alone, so
// that the impulse through it (x, -S from the centre) turns it,
//   k^2 dw = x dv_n + S dv_t,  k^2 = (a^2 + b^2) / 3 of the half sides a, b.
// Of a homogeneous rectangle; absent where that corner is no other (a sphere)
// or the normal velocity hardly changed.
core::Measured ShareOfSecondCorner(const PlaneTrack& track,
                                   const JointFit& fit);

// Why one restitution cannot be of this contact: the share lies above 0.1 (what
// an uneven mass may make it) by more than 3.3 u. Empty where it can.
std::string WhySeveralImpacts(const PlaneTrack& track, const JointFit& fit);

// Over all contacts of a clip: the weighted mean of the restitutions that were
// measured, its u widened to their scatter, with their number and that of the
// impacts that were not resolved.
RestitutionOfImpacts PoolRestitution(const ContactResult& contacts);

}  // namespace touchdown::vision
