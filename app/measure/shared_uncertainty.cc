#include "app/measure/shared_uncertainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "touchdown/core/quantities.h"

namespace touchdown::pipeline {
namespace {

using core::kContactQuantities;

// That a shared input can move: the bounce height is a convention, and the
// detectable gap no measurement.
bool IsMoved(const core::ContactQuantity& quantity) {
  return quantity.state != &core::StateDecision::bounce_height_m &&
         quantity.state != &core::StateDecision::detectable_gap_m;
}

// Adds a standard uncertainty in quadrature; an asymmetric interval grows by
// the same factor on both sides.
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
  // First contact and later ones in order; a moved result may have fewer, and
  // its i-th belongs to our i-th.
  std::vector<core::ContactRecord*> records = {&contacts.first};
  for (core::ContactRecord& later : contacts.later) records.push_back(&later);
  std::vector<std::array<double, kContactQuantities.size()>> variances(
      records.size());
  for (auto& of_record : variances) of_record.fill(0.0);
  for (const MovedContacts& each : moved) {
    vision::ContactResult other = each.contacts;
    std::vector<core::ContactRecord*> others = {&other.first};
    for (core::ContactRecord& later : other.later) others.push_back(&later);
    for (std::size_t i = 0; i < records.size() && i < others.size(); ++i) {
      for (std::size_t q = 0; q < kContactQuantities.size(); ++q) {
        const core::Measured& ours =
            core::At(*records[i], kContactQuantities[q]);
        const core::Measured& theirs =
            core::At(*others[i], kContactQuantities[q]);
        if (!ours || !theirs) continue;
        const double change = theirs->value - ours->value;
        variances[i][q] += each.weight * change * change;
      }
    }
  }
  if (core::Measured& pooled = contacts.restitution.value) {
    double variance = 0.0;
    for (const auto& [other, weight] : moved) {
      if (!other.restitution.value) continue;
      const double change = other.restitution.value->value - pooled->value;
      variance += weight * change * change;
    }
    Widen(*pooled, std::sqrt(variance));
  }
  for (std::size_t i = 0; i < records.size(); ++i) {
    for (std::size_t q = 0; q < kContactQuantities.size(); ++q) {
      if (!IsMoved(kContactQuantities[q])) continue;
      core::Measured& ours = core::At(*records[i], kContactQuantities[q]);
      if (ours) Widen(*ours, std::sqrt(variances[i][q]));
    }
    // What was added to an angle, for its line of the budget.
    const auto u_shared = [&](core::Measured core::Contact::*angle) {
      const auto at = std::ranges::find(kContactQuantities, angle,
                                        &core::ContactQuantity::contact);
      return std::sqrt(variances[i][static_cast<std::size_t>(
          at - kContactQuantities.begin())]);
    };
    core::Contact& contact = records[i]->contact;
    core::Measured& approach = contact.approach_angle_rad;
    if (approach && approach->value < core::kNormal975 * approach->u) {
      // As near 0 as without it (vision/src/contact/contact_record.cc).
      approach->interval95 =
          core::Interval{0.0, approach->value + core::kNormal975 * approach->u};
    }
    if (!contact.approach_budget.empty()) {
      contact.approach_budget.push_back(
          {source, u_shared(&core::Contact::approach_angle_rad)});
    }
    if (!contact.attitude_budget.empty()) {
      contact.attitude_budget.push_back(
          {source, u_shared(contact.radius_angle_rad
                                ? &core::Contact::radius_angle_rad
                                : &core::Contact::face_angle_rad)});
    }
  }
}

}  // namespace touchdown::pipeline
