#include "touchdown/core/conditions.h"

#include <array>
#include <utility>

namespace touchdown::core {
namespace {

// Words of columns, commands and documents: they are never changed.
constexpr std::array<std::pair<Anomaly, std::string_view>, 10> kAnomalies{{
    {Anomaly::kNotRecorded, "not recorded"},
    {Anomaly::kNone, "none"},
    {Anomaly::kRig, "rig"},
    {Anomaly::kCamera, "camera"},
    {Anomaly::kLight, "light"},
    {Anomaly::kBody, "body"},
    {Anomaly::kSurface, "surface"},
    {Anomaly::kOperator, "operator"},
    {Anomaly::kOther, "other"},
    {Anomaly::kNotApplicable, "not applicable"},
}};

}  // namespace

std::string_view Name(Anomaly anomaly) {
  for (const auto& [key, name] : kAnomalies) {
    if (key == anomaly) return name;
  }
  return "?";
}

std::optional<Anomaly> ParseAnomaly(std::string_view word) {
  for (const auto& [key, name] : kAnomalies) {
    if (name == word) return key;
  }
  return std::nullopt;
}

}  // namespace touchdown::core
