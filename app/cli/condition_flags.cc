#include "app/cli/condition_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "app/cli/store_flags.h"
#include "app/cli/values.h"
#include "touchdown/core/edge_unit.h"
#include "touchdown/db/register.h"

namespace touchdown::cli {
namespace {

constexpr const char* kAnomalyWords =
    "none, rig, camera, light, body, surface, operator, other, not applicable "
    "or not recorded";

constexpr const char* kForm =
    "KEY=VALUE with one of the keys rig, spring, camera, calibration, body, "
    "surface, operator (names in the register), temperature_c, "
    "relative_humidity (0 .. 1), elevation_deg, compression_mm, "
    "muzzle_height_mm, note, anomaly, anomaly_note";

void ApplyOne(const std::string& flag, core::Conditions& conditions) {
  const std::size_t sign = flag.find('=');
  const std::string key = flag.substr(0, sign);
  const std::string value =
      sign == std::string::npos ? "" : flag.substr(sign + 1);
  if (sign != std::string::npos) {
    for (const auto& entry : db::kConditionEntries) {
      if (key != Name(entry.kind)) continue;
      conditions.*entry.member = {value, ""};
      return;
    }
    for (const auto& quantity : db::kConditionQuantities) {
      const core::EdgeUnit unit = core::AtTheEdge(quantity.name);
      if (key != unit.stem + unit.suffix) continue;
      conditions.*quantity.member =
          ParseMeasured("--condition " + key, value, unit.factor, unit.offset);
      return;
    }
    if (key == "anomaly") {
      conditions.anomaly = ParseWord<core::Anomaly>(
          "--condition anomaly", value, core::ParseAnomaly, kAnomalyWords);
      return;
    }
    if (key == "anomaly_note") {
      conditions.anomaly_note = value;
      return;
    }
    if (key == "note") {
      conditions.note = value;
      return;
    }
  }
  throw std::invalid_argument(
      fmt::format("--condition is '{}', must be {}", flag, kForm));
}

}  // namespace

void AddConditionFlag(CLI::App& command, ConditionFlags& flags) {
  command
      .add_option(
          "--condition", flags,
          std::string("of the shot, ") + kForm + "; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void ApplyConditions(const ConditionFlags& flags,
                     std::optional<core::Conditions>& conditions) {
  if (flags.empty()) return;
  if (!conditions) conditions.emplace();
  for (const std::string& flag : flags) ApplyOne(flag, *conditions);
}

std::optional<core::Conditions> ConditionsOf(const ConditionFlags& flags,
                                             const std::filesystem::path& db) {
  std::optional<core::Conditions> conditions;
  ApplyConditions(flags, conditions);
  if (conditions && db::NameEntries(*conditions)) {
    conditions =
        db::Resolved(db::Store::Open(db, db::OpenMode::kRead), *conditions);
  }
  return conditions;
}

}  // namespace touchdown::cli
