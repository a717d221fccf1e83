#include "app/review/words.h"

#include <algorithm>
#include <array>
#include <utility>

#include "touchdown/core/edge_unit.h"
#include "touchdown/core/units.h"

namespace touchdown::review {
namespace {

using Words = std::pair<std::string_view, std::string_view>;

// A contact's numbers come first, in the order in which a person looks for them
// (kContactWords of them, then everything else).
constexpr std::array kWords{
    Words{"approach_angle_rad", "approach angle"},
    Words{"radius_angle_rad", "radius angle"},
    Words{"face_angle_rad", "face angle (+: leading end up)"},
    Words{"max_gap_m", "greatest gap after release"},
    Words{"extrapolated_gap_m", "gap that the flight would reach"},
    Words{"bounce_height_m", "bounce height"},
    Words{"detectable_gap_m", "least gap that would be seen"},
    Words{"restitution", "restitution of the contact point"},
    Words{"centre_rebound_ratio", "rebound ratio of the centre"},
    Words{"impulse_ratio", "impulse ratio"},
    Words{"before_speed_mps", "speed at touchdown"},
    Words{"before_normal_mps", "upward, at touchdown"},
    Words{"before_tangential_mps", "along the ground, at touchdown"},
    Words{"before_omega_rad_per_s", "spin at touchdown"},
    Words{"after_normal_mps", "upward, at release"},
    Words{"after_tangential_mps", "along the ground, at release"},
    Words{"after_omega_rad_per_s", "spin at release"},
    Words{"gravity_check_mps2", "gravity, fitted freely"},
    Words{"time_s", "touchdown, from frame 0"},
    Words{"frame", "touchdown, in frames"},
    Words{"duration_s", "time on the ground"},
    Words{"state", "motion state"},
    Words{"state_because", "evidence of the state"},
    Words{"p_bounce", "P(bounce)"},
    Words{"found", "contact found"},
    Words{"not_found_because", "why no contact was found"},
    Words{"from_start", "on the ground from the start"},
    Words{"corner", "corner that lands first"},
    Words{"micro_bounce", "leaves the ground below the bounce height"},
    Words{"contacts", "number of contacts"},
    Words{"approach_budget", "uncertainty of the approach angle, from"},
    Words{"attitude_budget", "uncertainty of radius and face angle, from"},
    Words{"clip_path", "recording"},
    Words{"angle_kind", "kind of the contact angle"},
    Words{"body_kind", "body"},
    Words{"diameter_m", "diameter"},
    Words{"long_m", "long side"},
    Words{"short_m", "short side"},
    Words{"set_angle_rad", "set angle"},
    Words{"set_speed_mps", "set speed"},
    Words{"document", "document of the analysis"},
    Words{"exclusion_reason", "why it is excluded"},
    Words{"person", "operator"},
    Words{"temperature_k", "temperature of the air"},
    Words{"relative_humidity", "relative humidity, 0 to 1"},
    Words{"elevation_rad", "elevation, as set"},
    Words{"compression_m", "compression, as set"},
    Words{"muzzle_height_m", "height of the muzzle, as set"},
    Words{"anomaly_note", "what was not as it should be"},
    Words{"note", "the operator's note"},
};
constexpr std::size_t kContactWords = 21;  // the first are a contact's numbers

// Units are found by the suffix that core::AtTheEdge gives a name.
constexpr std::array kUnits{
    Words{"_deg", "deg"},         Words{"_mm", "mm"}, Words{"_mps", "m/s"},
    Words{"_mps2", "m/s\u00b2"},  Words{"_s", "s"},   Words{"_c", "\u00b0C"},
    Words{"_deg_per_s", "deg/s"},
};

// Returns the word for a key; `otherwise` where the table has none.
std::string_view LookUpWord(std::span<const Words> table, std::string_view key,
                            std::string_view otherwise) {
  const auto found = std::ranges::find(table, key, &Words::first);
  return found == table.end() ? otherwise : found->second;
}

constexpr auto kColumns = [] {
  std::array<std::string_view, kContactWords> columns;
  for (std::size_t i = 0; i < kContactWords; ++i) columns[i] = kWords[i].first;
  return columns;
}();

}  // namespace

Shown ShownAs(std::string_view column) {
  // Documents keep rad/s; people are shown deg/s.
  core::EdgeUnit edge = core::AtTheEdge(column);
  if (edge.suffix == "_rad_per_s") {
    edge.suffix = "_deg_per_s";
    edge.factor = core::kDegree;
  }
  std::string stem = edge.stem;
  // A column without words of its own is told by its name: "software version".
  std::ranges::replace(stem, '_', ' ');
  return {edge.stem + edge.suffix,
          std::string(LookUpWord(kWords, column, stem)),
          std::string(LookUpWord(kUnits, edge.suffix, "")), edge.factor,
          edge.offset};
}

std::string Label(const Shown& shown) {
  return shown.unit.empty() ? shown.words : shown.words + ", " + shown.unit;
}

std::span<const std::string_view> ColumnsInOrder() { return kColumns; }

}  // namespace touchdown::review
