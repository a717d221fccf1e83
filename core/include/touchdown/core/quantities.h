// Every measured number of a trial, once: its name in columns, JSON and
// histories, and where it lies in the structs of a trial. The order is the
// order of columns; a change here is a change of the store's schema and needs a
// migration.
#pragma once

#include <array>
#include <string_view>

#include "touchdown/core/trial.h"

namespace touchdown::core {

struct ContactQuantity {
  std::string_view name;
  std::string_view meaning;
  Measured Contact::*contact = nullptr;
  Measured StateDecision::*state = nullptr;
  Measured Motion::*motion = nullptr;
};

inline constexpr std::array<ContactQuantity, 21> kContactQuantities{{
    {.name = "time_s",
     .meaning = "instant of touchdown; 0 is the middle of frame 0",
     .contact = &Contact::time_s},
    {.name = "frame",
     .meaning = "the same instant, in frames from 0",
     .contact = &Contact::frame},
    {.name = "approach_angle_rad",
     .meaning = "between the ground and the centre's velocity",
     .contact = &Contact::approach_angle_rad},
    {.name = "radius_angle_rad",
     .meaning = "acute, of the line from the centre to the contact point",
     .contact = &Contact::radius_angle_rad},
    {.name = "face_angle_rad",
     .meaning = "of the long side to the ground, leading end up",
     .contact = &Contact::face_angle_rad},
    {.name = "duration_s",
     .meaning = "from touchdown to release",
     .contact = &Contact::duration_s},
    {.name = "max_gap_m",
     .meaning = "greatest gap between release and the end of the film",
     .state = &StateDecision::max_gap_m},
    {.name = "bounce_height_m",
     .meaning = "rising above it is what bounce means",
     .state = &StateDecision::bounce_height_m},
    {.name = "detectable_gap_m",
     .meaning = "the least gap that would have been seen",
     .state = &StateDecision::detectable_gap_m},
    {.name = "before_speed_mps",
     .meaning = "of the centre at touchdown",
     .motion = &Motion::before_speed_mps},
    {.name = "before_normal_mps",
     .meaning = "of the centre at touchdown; below 0: downward",
     .motion = &Motion::before_normal_mps},
    {.name = "before_tangential_mps",
     .meaning = "of the centre at touchdown, along the ground",
     .motion = &Motion::before_tangential_mps},
    {.name = "before_omega_rad_per_s",
     .meaning = "spin at touchdown, counter-clockwise",
     .motion = &Motion::before_omega_rad_per_s},
    {.name = "after_normal_mps",
     .meaning = "of the centre at release",
     .motion = &Motion::after_normal_mps},
    {.name = "after_tangential_mps",
     .meaning = "of the centre at release, along the ground",
     .motion = &Motion::after_tangential_mps},
    {.name = "after_omega_rad_per_s",
     .meaning = "spin at release, counter-clockwise",
     .motion = &Motion::after_omega_rad_per_s},
    {.name = "restitution",
     .meaning = "of the contact point's normal velocity",
     .motion = &Motion::restitution},
    {.name = "centre_rebound_ratio",
     .meaning = "of the centre's normal velocity",
     .motion = &Motion::centre_rebound_ratio},
    {.name = "impulse_ratio",
     .meaning = "change of tangential over change of normal velocity",
     .motion = &Motion::impulse_ratio},
    {.name = "gravity_check_mps2",
     .meaning = "gravity fitted freely: a check of scale and frame rate",
     .motion = &Motion::gravity_check_mps2},
    // Last, because version 4 of the store added it to files that existed.
    {.name = "extrapolated_gap_m",
     .meaning = "that a flight would reach which the film cut off",
     .state = &StateDecision::extrapolated_gap_m},
}};

// The number itself, const as the record is.
template <class Record>
auto& At(Record& record, const ContactQuantity& quantity) {
  if (quantity.contact != nullptr) return record.contact.*quantity.contact;
  if (quantity.state != nullptr) return record.state.*quantity.state;
  return record.motion.*quantity.motion;
}

struct BodyQuantity {
  std::string_view name;
  std::string_view meaning;
  Measured Body::*member;
};

inline constexpr std::array<BodyQuantity, 3> kBodyQuantities{{
    {"diameter_m", "of a sphere", &Body::diameter_m},
    {"long_m", "long side of a rectangle", &Body::long_m},
    {"short_m", "short side of a rectangle", &Body::short_m},
}};

struct BudgetOf {
  std::string_view name;
  Budget Contact::*member;
};

inline constexpr std::array<BudgetOf, 2> kBudgets{{
    {"approach", &Contact::approach_budget},
    {"attitude", &Contact::attitude_budget},
}};

}  // namespace touchdown::core
