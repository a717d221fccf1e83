#include "app/exchange/trial_list.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

// {"value", "u"} and, where the estimate has one, "interval95": [low, high],
// all in the unit of the edge, of which `unit` is the size in SI. Null where it
// is absent: a list has no room for reasons.
Json EdgeJson(const core::Measured& measured, double unit) {
  if (!measured) return nullptr;
  Json json = {{"value", measured->value / unit}, {"u", measured->u / unit}};
  if (measured->interval95) {
    json["interval95"] = {measured->interval95->low / unit,
                          measured->interval95->high / unit};
  }
  return json;
}

// A set-point or probability, which has no u; null where there is none.
Json OptionalJson(const std::optional<double>& value, double unit) {
  return value ? Json(*value / unit) : Json(nullptr);
}

}  // namespace

Json TrialRowJson(const core::Trial& trial) {
  const auto& contact = trial.first.contact;
  const auto& state = trial.first.state;
  return {
      {"id", trial.id},
      {"revision", trial.revision},
      {"campaign", trial.campaign},
      {"origin", core::Name(trial.origin)},
      {"body",
       {{"kind", core::Name(trial.body.kind)},
        {"diameter_mm", EdgeJson(trial.body.diameter_m, kMillimetre)},
        {"long_mm", EdgeJson(trial.body.long_m, kMillimetre)},
        {"short_mm", EdgeJson(trial.body.short_m, kMillimetre)}}},
      {"angle_kind", core::Name(trial.angle_kind)},
      {"angle_deg", EdgeJson(core::ContactAngle(trial), kDegree)},
      {"approach_angle_deg", EdgeJson(contact.approach_angle_rad, kDegree)},
      {"set_angle_deg", OptionalJson(trial.set_angle_rad, kDegree)},
      {"set_speed_mps", OptionalJson(trial.set_speed_mps, 1.0)},
      {"state", core::Name(state.label)},
      {"p_bounce", OptionalJson(state.p_bounce, 1.0)},
      {"max_gap_mm", EdgeJson(state.max_gap_m, kMillimetre)},
      {"extrapolated_gap_mm", EdgeJson(state.extrapolated_gap_m, kMillimetre)},
      {"state_because", state.reason},
      {"micro_bounce", state.micro_bounce},
      {"excluded", trial.excluded},
      {"exclusion_reason", trial.exclusion_reason},
      {"clip", {{"path", trial.clip.path}, {"id", trial.clip.id}}},
      {"author", trial.author},
      {"recorded_at_utc", trial.recorded_at_utc}};
}

}  // namespace touchdown::report
