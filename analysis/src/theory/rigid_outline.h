// The outline of a rigid body in motion: its corners' heights and when the
// lowest one reaches the ground.
#pragma once

#include <array>

#include "touchdown/analysis/theory/rigid_motion.h"

namespace touchdown::analysis {

struct CornerState {
  core::PlanePoint offset;  // from the centre
  double y_m = 0.0;         // height above the ground
  double vy_mps = 0.0;
};

class RigidOutline {
 public:
  // Throws std::invalid_argument if a size is absent or not positive.
  explicit RigidOutline(const core::Body& body);

  bool is_sphere() const { return is_sphere_; }
  double radius_m() const { return radius_m_; }  // sphere: to the ground
  double half_long_m() const { return half_long_m_; }
  double half_short_m() const { return half_short_m_; }
  double GyrationRadius() const;  // of the homogeneous body

  // Of a rectangle.
  std::array<CornerState, 4> Corners(const BodyState& state) const;

  double Gap(const BodyState& state) const;

  // Time until a point that approaches the ground reaches it in free flight;
  // more than `limit_s` if none does so within it.
  double TimeToContact(const BodyState& state, double gravity_mps2,
                       double limit_s) const;

 private:
  bool is_sphere_;
  double radius_m_ = 0.0;
  double half_long_m_ = 0.0;
  double half_short_m_ = 0.0;
};

// The state at a time of a stretch of constant accelerations.
BodyState Advance(const Stretch& stretch, double time_s);

}  // namespace touchdown::analysis
