// Measured numbers and conditions as they are typed: at the command line, at
// the rig and on the page.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "touchdown/core/conditions.h"
#include "touchdown/core/estimate.h"

namespace touchdown::pipeline {

// What a number is given without: `relative` of the value, and `absolute` in
// its unit; the larger of the two.
struct DefaultU {
  double relative = 0.0;
  double absolute = 0.0;
};

// Of a plain scale or size, everywhere (rig.toml too): 0.1 %, a caliper's 0.02
// mm on 20 mm. Smaller claims more than a bare number tells; larger hides what
// the picture says of a wrong one.
inline constexpr DefaultU kPlainSize = {.relative = 1e-3};

// "40" or "40+-0.02", in SI by `unit`. Throws std::invalid_argument with the
// flag's name, what was given and what is expected; so do the others.
core::Estimate ParseEstimate(const std::string& flag, const std::string& text,
                             double unit, DefaultU u = {});

// "60x20" or "60+-0.02x20+-0.02", likewise.
std::pair<core::Estimate, core::Estimate> ParseSides(const std::string& flag,
                                                     const std::string& text,
                                                     double unit,
                                                     DefaultU u = {});

// The two of a field that is named as the flag is, without dashes; they throw
// FieldError (statement.h).
core::Estimate ParseEstimateField(const std::string& field,
                                  const std::string& text, double unit,
                                  DefaultU u = {});
std::pair<core::Estimate, core::Estimate> ParseSidesField(
    const std::string& field, const std::string& text, double unit,
    DefaultU u = {});

// "40+-0.02", its standard uncertainty always given, or "absent:REASON"; in SI
// as value * unit + offset.
core::Measured ParseMeasured(const std::string& flag, const std::string& text,
                             double unit, double offset = 0.0);

inline constexpr const char* kAnomalyWords =
    "none, rig, camera, light, body, surface, operator, other, not applicable "
    "or not recorded";

// rig, spring ... temperature_c, elevation_deg ... note, anomaly, anomaly_note.
const std::vector<std::string>& ConditionKeys();

// Puts one condition, by its key, into `conditions`; false where there is no
// such key. Throws FieldError (statement.h) naming the key.
bool SetCondition(const std::string& key, const std::string& value,
                  core::Conditions& conditions);

}  // namespace touchdown::pipeline
