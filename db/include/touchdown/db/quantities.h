// Every measured number of a trial, once: its name in columns, JSON and
// histories, and where it lies in the core structs. The order is the order of
// columns; a change here is a change of the schema and needs a migration.
#pragma once

#include <array>
#include <string_view>

#include "touchdown/core/trial.h"

namespace touchdown::db {

struct ContactQuantity {
  std::string_view name;
  std::string_view meaning;
  core::Measured core::Contact::*contact = nullptr;
  core::Measured core::StateDecision::*state = nullptr;
  core::Measured core::Motion::*motion = nullptr;
};

inline constexpr std::array<ContactQuantity, 21> kContactQuantities{{
    {.name = "time_s",
     .meaning = "instant of touchdown; 0 is the middle of frame 0",
     .contact = &core::Contact::time_s},
    {.name = "frame",
     .meaning = "the same instant, in frames from 0",
     .contact = &core::Contact::frame},
    {.name = "approach_angle_rad",
     .meaning = "between the ground and the centre's velocity",
     .contact = &core::Contact::approach_angle_rad},
    {.name = "radius_angle_rad",
     .meaning = "acute, of the line from the centre to the contact point",
     .contact = &core::Contact::radius_angle_rad},
    {.name = "face_angle_rad",
     .meaning = "of the long side to the ground, leading end up",
     .contact = &core::Contact::face_angle_rad},
    {.name = "duration_s",
     .meaning = "from touchdown to release",
     .contact = &core::Contact::duration_s},
    {.name = "max_gap_m",
     .meaning = "greatest gap between release and the end of the film",
     .state = &core::StateDecision::max_gap_m},
    {.name = "bounce_height_m",
     .meaning = "rising above it is what bounce means",
     .state = &core::StateDecision::bounce_height_m},
    {.name = "detectable_gap_m",
     .meaning = "the least gap that would have been seen",
     .state = &core::StateDecision::detectable_gap_m},
    {.name = "before_speed_mps",
     .meaning = "of the centre at touchdown",
     .motion = &core::Motion::before_speed_mps},
    {.name = "before_normal_mps",
     .meaning = "of the centre at touchdown; below 0: downward",
     .motion = &core::Motion::before_normal_mps},
    {.name = "before_tangential_mps",
     .meaning = "of the centre at touchdown, along the ground",
     .motion = &core::Motion::before_tangential_mps},
    {.name = "before_omega_rad_per_s",
     .meaning = "spin at touchdown, counter-clockwise",
     .motion = &core::Motion::before_omega_rad_per_s},
    {.name = "after_normal_mps",
     .meaning = "of the centre at release",
     .motion = &core::Motion::after_normal_mps},
    {.name = "after_tangential_mps",
     .meaning = "of the centre at release, along the ground",
     .motion = &core::Motion::after_tangential_mps},
    {.name = "after_omega_rad_per_s",
     .meaning = "spin at release, counter-clockwise",
     .motion = &core::Motion::after_omega_rad_per_s},
    {.name = "restitution",
     .meaning = "of the contact point's normal velocity",
     .motion = &core::Motion::restitution},
    {.name = "centre_rebound_ratio",
     .meaning = "of the centre's normal velocity",
     .motion = &core::Motion::centre_rebound_ratio},
    {.name = "impulse_ratio",
     .meaning = "change of tangential over change of normal velocity",
     .motion = &core::Motion::impulse_ratio},
    {.name = "gravity_check_mps2",
     .meaning = "gravity fitted freely: a check of scale and frame rate",
     .motion = &core::Motion::gravity_check_mps2},
    // Last, because version 4 of the store added it to files that existed.
    {.name = "extrapolated_gap_m",
     .meaning = "that a flight would reach which the film cut off",
     .state = &core::StateDecision::extrapolated_gap_m},
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
  core::Measured core::Body::*member;
};

inline constexpr std::array<BodyQuantity, 3> kBodyQuantities{{
    {"diameter_m", "of a sphere", &core::Body::diameter_m},
    {"long_m", "long side of a rectangle", &core::Body::long_m},
    {"short_m", "short side of a rectangle", &core::Body::short_m},
}};

struct BudgetOf {
  std::string_view name;
  core::Budget core::Contact::*member;
};

inline constexpr std::array<BudgetOf, 2> kBudgets{{
    {"approach", &core::Contact::approach_budget},
    {"attitude", &core::Contact::attitude_budget},
}};

}  // namespace touchdown::db
