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
  core::Measured core::Contact::*contact = nullptr;
  core::Measured core::StateDecision::*state = nullptr;
  core::Measured core::Motion::*motion = nullptr;
};

inline constexpr std::array<ContactQuantity, 21> kContactQuantities{{
    {.name = "time_s", .contact = &core::Contact::time_s},
    {.name = "frame", .contact = &core::Contact::frame},
    {.name = "approach_angle_rad",
     .contact = &core::Contact::approach_angle_rad},
    {.name = "radius_angle_rad", .contact = &core::Contact::radius_angle_rad},
    {.name = "face_angle_rad", .contact = &core::Contact::face_angle_rad},
    {.name = "duration_s", .contact = &core::Contact::duration_s},
    {.name = "max_gap_m", .state = &core::StateDecision::max_gap_m},
    {.name = "bounce_height_m", .state = &core::StateDecision::bounce_height_m},
    {.name = "detectable_gap_m",
     .state = &core::StateDecision::detectable_gap_m},
    {.name = "before_speed_mps", .motion = &core::Motion::before_speed_mps},
    {.name = "before_normal_mps", .motion = &core::Motion::before_normal_mps},
    {.name = "before_tangential_mps",
     .motion = &core::Motion::before_tangential_mps},
    {.name = "before_omega_rad_per_s",
     .motion = &core::Motion::before_omega_rad_per_s},
    {.name = "after_normal_mps", .motion = &core::Motion::after_normal_mps},
    {.name = "after_tangential_mps",
     .motion = &core::Motion::after_tangential_mps},
    {.name = "after_omega_rad_per_s",
     .motion = &core::Motion::after_omega_rad_per_s},
    {.name = "restitution", .motion = &core::Motion::restitution},
    {.name = "centre_rebound_ratio",
     .motion = &core::Motion::centre_rebound_ratio},
    {.name = "impulse_ratio", .motion = &core::Motion::impulse_ratio},
    {.name = "gravity_check_mps2", .motion = &core::Motion::gravity_check_mps2},
    // Last, because version 4 of the store added it to files that existed.
    {.name = "extrapolated_gap_m",
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
  core::Measured core::Body::*member;
};

inline constexpr std::array<BodyQuantity, 3> kBodyQuantities{{
    {"diameter_m", &core::Body::diameter_m},
    {"long_m", &core::Body::long_m},
    {"short_m", &core::Body::short_m},
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
