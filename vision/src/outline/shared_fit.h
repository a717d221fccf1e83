// What all frames of a body share: its size, the picture's blur, the exposure.
//
// Each frame's fit at held values tells its normal equations for these four
// with all else of the frame eliminated (Schur complement); their sums over the
// frames give the step to the values that fit all frames at once, and its
// covariance. A mean of values that frames are fitted to one by one is drawn to
// where a frame's own uncertainty is the smaller (a sharper picture seems the
// better known), by the square of the noise, which no number of frames takes
// away; and a size at the mean blur does not know that the blur is uncertain
// (shared_fit_test.cc, HasNotTheBiasOfAWeightedMean).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "numbers/symmetric_factor.h"
#include "outline/track_shape.h"

namespace touchdown::vision {

// The Schur complement of a frame's normal equations for the four parameters in
// the rows `at`; -1: the frame does not tell that one.
SharedTerms WithoutOwn(const NormalMatrix& normal, const NormalVector& gradient,
                       const std::array<int, 4>& at);

struct SharedStep {
  // In the order of SharedTerms, with its standard uncertainty: that of the
  // sums, or what the frames' own steps in size scatter by, if that is more. 0
  // for what the frames do not tell.
  Eigen::Vector4d step = Eigen::Vector4d::Zero();
  Eigen::Vector4d u = Eigen::Vector4d::Zero();
};

// From fits with OutlineOptions::tell_shared, all at the same held values.
// Frames that see the outline whole are taken alone where there are three of
// them, and those whose own step is off the median by more than four times the
// scatter are left out. Nothing where fewer than three remain.
std::optional<SharedStep> StepTogether(std::span<const Fitted> all);

}  // namespace touchdown::vision
