#include "app/measure/shared_uncertainty.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace touchdown::pipeline {
namespace {

constexpr std::size_t kQuantities = 19;

// Every number of a contact that a shared input can move.
std::array<core::Measured*, kQuantities> ListQuantities(
    core::ContactRecord& record) {
  core::Contact& c = record.contact;
  core::Motion& m = record.motion;
  return {&c.approach_angle_rad,
          &c.radius_angle_rad,
          &c.face_angle_rad,
          &c.time_s,
          &c.frame,
          &c.duration_s,
          &record.state.max_gap_m,
          &record.state.extrapolated_gap_m,
          &m.before_speed_mps,
          &m.before_normal_mps,
          &m.before_tangential_mps,
          &m.before_omega_rad_per_s,
          &m.after_normal_mps,
          &m.after_tangential_mps,
          &m.after_omega_rad_per_s,
          &m.restitution,
          &m.centre_rebound_ratio,
          &m.impulse_ratio,
          &m.gravity_check_mps2};
}

void Widen(core::Estimate& e, double u_shared) {
  const double before = e.u;
  e.u = std::hypot(e.u, u_shared);
  if (e.interval95 && before > 0.0) {
    const double factor = e.u / before;
    e.interval95->low = e.value - factor * (e.value - e.interval95->low);
    e.interval95->high = e.value + factor * (e.interval95->high - e.value);
  }
}

}  // namespace

void AddShared(vision::ContactResult& contacts, const std::string& source,
               const std::vector<MovedContacts>& moved) {
  std::vector<core::ContactRecord*> records = {&contacts.first};
  for (core::ContactRecord& later : contacts.later) records.push_back(&later);
  std::vector<std::array<double, kQuantities>> variances(records.size());
  for (auto& of_record : variances) of_record.fill(0.0);
  for (const MovedContacts& each : moved) {
    vision::ContactResult other = each.contacts;
    std::vector<core::ContactRecord*> others = {&other.first};
    for (core::ContactRecord& later : other.later) others.push_back(&later);
    for (std::size_t i = 0; i < records.size() && i < others.size(); ++i) {
      const auto ours = ListQuantities(*records[i]);
      const auto theirs = ListQuantities(*others[i]);
      for (std::size_t q = 0; q < kQuantities; ++q) {
        if (!*ours[q] || !*theirs[q]) continue;
        const double change = (*theirs[q])->value - (*ours[q])->value;
        variances[i][q] += each.weight * change * change;
      }
    }
  }
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto ours = ListQuantities(*records[i]);
    for (std::size_t q = 0; q < kQuantities; ++q) {
      if (*ours[q]) Widen(**ours[q], std::sqrt(variances[i][q]));
    }
    core::Contact& contact = records[i]->contact;
    core::Measured& approach = contact.approach_angle_rad;
    if (approach && approach->value < core::kNormal975 * approach->u) {
      // As near 0 as without it (vision/src/contact/contact_record.cc).
      approach->interval95 =
          core::Interval{0.0, approach->value + core::kNormal975 * approach->u};
    }
    if (!contact.approach_budget.empty()) {
      contact.approach_budget.push_back({source, std::sqrt(variances[i][0])});
    }
    if (!contact.attitude_budget.empty()) {
      contact.attitude_budget.push_back(
          {source, std::sqrt(variances[i][contact.radius_angle_rad ? 1 : 2])});
    }
  }
}

}  // namespace touchdown::pipeline
