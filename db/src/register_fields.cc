#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "register_rows.h"
#include "rows.h"
#include "touchdown/db/register.h"

namespace touchdown::db {
namespace {

using enum FieldType;
using Kind = RegisterKind;

// Each kind of entry with the word for it and its table.
constexpr std::array<std::pair<Kind, RegisterTable>, 7> kTables{{
    {Kind::kRig, {"rig", "rigs"}},
    {Kind::kCamera, {"camera", "cameras"}},
    {Kind::kSpring, {"spring", "springs"}},
    {Kind::kCalibration, {"calibration", "calibrations"}},
    {Kind::kBody, {"body", "bodies"}},
    {Kind::kSurface, {"surface", "surfaces"}},
    {Kind::kOperator, {"operator", "operators"}},
}};

// The order is the order of columns; a change here is a change of the schema
// and needs a migration.
constexpr RegisterField kNote{"note", kText, "whatever else is to be known"};
constexpr RegisterField kDigest{"sha256", kText, "of that file"};

// Fields of each kind, in the order of columns and questions.
constexpr std::array kRig{
    RegisterField{"document", kText, "the whole text of its rig.toml"},
    kDigest,
    kNote,
};
// Of a camera.
constexpr std::array kCamera{
    RegisterField{"maker", kText, "who made it"},
    RegisterField{"model", kText, "as its plate says"},
    RegisterField{"serial", kText, "number on its plate"},
    RegisterField{"firmware", kText, "version"},
    RegisterField{"lens", kText, "maker, focal length, number"},
    kNote,
};
// Of a spring.
constexpr std::array kSpring{
    RegisterField{"rig", kEntry, "of the register, in which it sits", "",
                  Kind::kRig},
    RegisterField{"coil_diameter_kind", kWord, "which diameter was measured",
                  "mean, outer, inner"},
    RegisterField{"wire_diameter_m", kMeasured, "d of Eq. (11)"},
    RegisterField{"coil_diameter_m", kMeasured, "D of Eq. (11)"},
    RegisterField{"active_coils", kMeasured, "N of Eq. (11)"},
    RegisterField{"shear_modulus_pa", kMeasured, "G of Eq. (11)"},
    RegisterField{"stiffness_n_per_m", kMeasured, "as measured"},
    kNote,
};
// Of a calibration.
constexpr std::array kCalibration{
    RegisterField{"camera", kEntry, "of the register, that it is of", "",
                  Kind::kCamera},
    RegisterField{"contents", kWord, "what it calibrates",
                  "lens, scale, ground, several"},
    RegisterField{"made_on", kText, "date"},
    RegisterField{"document", kText, "the whole text of the file"},
    kDigest,
    kNote,
};
// Of a body.
constexpr std::array kBody{
    RegisterField{"shape", kWord, "of the body", "sphere, rectangle"},
    RegisterField{"material", kWord, "what it is made of",
                  "steel, aluminium, glass, rubber, plastic, wood, stone, "
                  "concrete"},
    RegisterField{"diameter_m", kMeasured, "of a sphere"},
    RegisterField{"long_m", kMeasured, "long side of a rectangle"},
    RegisterField{"short_m", kMeasured, "short side of a rectangle"},
    RegisterField{"mass_kg", kMeasured, "weighed"},
    kNote,
};
// Of a surface.
constexpr std::array kSurface{
    RegisterField{"condition", kWord, "when the shots are made",
                  "dry, damp, wet, icy, loose"},
    RegisterField{"friction", kMeasured, "coefficient of friction"},
    RegisterField{"friction_method", kText, "how that was measured"},
    kNote,
};
// Of an operator.
constexpr std::array kOperator{kNote};

// What every coded word may also be.
constexpr std::array<std::string_view, 3> kOpen{"other", "not applicable",
                                                "not recorded"};

bool IsFieldWord(const RegisterField& field, std::string_view word) {
  if (std::ranges::find(kOpen, word) != kOpen.end()) return true;
  std::string_view words = field.words;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(", "), words.size());
    if (words.substr(0, end) == word) return true;
    words.remove_prefix(std::min(end + 2, words.size()));
  }
  return false;
}

template <class Map>
const typename Map::mapped_type& Required(const Entry& entry, const Map& map,
                                          std::string_view field) {
  const auto at = map.find(field);
  if (at == map.end()) {
    throw std::invalid_argument(fmt::format(
        "field {} of {} '{}' is missing", field, Name(entry.kind), entry.name));
  }
  return at->second;
}

void RequireField(const Entry& entry, const RegisterField& field) {
  if (field.type == kEntry) {
    Required(entry, entry.entries, field.name);
    return;
  }
  if (field.type == kMeasured) {
    const core::Measured& number = Required(entry, entry.measured, field.name);
    RequireMeasured(field.name, number);
    if (number && !(number->value >= 0.0 && std::isfinite(number->value) &&
                    std::isfinite(number->u))) {
      throw std::invalid_argument(
          fmt::format("{} is {} +- {}, must be at least 0 and finite",
                      field.name, number->value, number->u));
    }
    return;
  }
  const std::string& text = Required(entry, entry.texts, field.name);
  if (field.type != kWord) return;
  if (!IsFieldWord(field, text)) {
    throw std::invalid_argument(
        fmt::format("{} is '{}', must be {}, other, not applicable or not "
                    "recorded",
                    field.name, text, field.words));
  }
  if (text == "other" && entry.texts.at("note").empty()) {
    throw std::invalid_argument(fmt::format(
        "{} is 'other', and the note is empty, must say what", field.name));
  }
}

}  // namespace

const RegisterTable& FindTable(RegisterKind kind) {
  return kTables.at(static_cast<std::size_t>(kind)).second;
}

std::string_view Name(RegisterKind kind) { return FindTable(kind).word; }

std::optional<RegisterKind> ParseRegisterKind(std::string_view word) {
  for (const auto& [kind, table] : kTables) {
    if (table.word == word) return kind;
  }
  return std::nullopt;
}

std::span<const RegisterField> ListFields(RegisterKind kind) {
  switch (kind) {
    case Kind::kRig:
      return kRig;
    case Kind::kCamera:
      return kCamera;
    case Kind::kSpring:
      return kSpring;
    case Kind::kCalibration:
      return kCalibration;
    case Kind::kBody:
      return kBody;
    case Kind::kSurface:
      return kSurface;
    case Kind::kOperator:
      break;
  }
  return kOperator;
}

Entry NewEntry(RegisterKind kind, std::string_view name) {
  Entry entry;
  entry.kind = kind;
  entry.name = name;
  for (const RegisterField& field : ListFields(kind)) {
    const std::string key(field.name);
    switch (field.type) {
      case kText:
        entry.texts[key] = "";
        break;
      case kWord:
        entry.texts[key] = "not recorded";
        break;
      case kMeasured:
        entry.measured.insert_or_assign(key,
                                        core::AbsentBecause("not recorded"));
        break;
      case kEntry:
        entry.entries[key] = {};
        break;
    }
  }
  return entry;
}

void RequireStorable(const Entry& entry) {
  if (entry.name.empty()) {
    throw std::invalid_argument(fmt::format(
        "name of the {} is empty, must be a name", Name(entry.kind)));
  }
  if (entry.author.empty()) {
    throw std::invalid_argument("author is empty, must name the person");
  }
  const auto fields = ListFields(entry.kind);
  for (const RegisterField& field : fields) RequireField(entry, field);
  if (entry.texts.size() + entry.measured.size() + entry.entries.size() !=
      fields.size()) {
    throw std::invalid_argument(
        fmt::format("{} '{}' has a field that no {} has", Name(entry.kind),
                    entry.name, Name(entry.kind)));
  }
}

std::vector<Change> Changes(const Entry& before, const Entry& after) {
  std::vector<Change> changes;
  const auto compare = [&changes](const auto& a, const auto& b,
                                  const auto& text) {
    for (const auto& [field, value] : a) {
      const auto other = b.find(field);
      if (other == b.end() || other->second == value) continue;
      changes.push_back({field, text(value), text(other->second)});
    }
  };
  compare(before.texts, after.texts, [](const std::string& t) { return t; });
  compare(before.measured, after.measured,
          [](const core::Measured& m) { return MeasuredText(m); });
  compare(before.entries, after.entries,
          [](const core::Registered& r) { return RegisteredText(r); });
  return changes;
}

}  // namespace touchdown::db
