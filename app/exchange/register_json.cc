// The fields of an entry depend on its kind (rig, camera, spring ...), so that
// writing and reading walk over db::ListFields() instead of naming them: a new
// field of the register is in the exchange without a change here.
#include "app/exchange/register_json.h"

#include <stdexcept>

namespace touchdown::report {
namespace {

using db::FieldType;

// A reference to one version of an entry, {"name", "id"}; null where nothing is
// referred to. The id says which version: the spring as it was at the shot.
Json RegisteredJson(const core::Registered& entry) {
  if (entry.name.empty()) return nullptr;
  return {{"name", TextJson(entry.name)}, {"id", TextJson(entry.id)}};
}

// The inverse. Throws std::invalid_argument naming the field `name` where it is
// missing or has no name in it.
core::Registered ReadRegistered(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  if (field.is_null()) return {};
  core::Registered entry{ReadTextField(field, "name"),
                         ReadTextField(field, "id")};
  if (entry.name.empty()) WrongField(name, "null, or an entry with a name");
  return entry;
}

}  // namespace

std::string EntryJson(const db::Entry& entry) {
  Json json = {{"schema", kEntrySchema},
               {"kind", Name(entry.kind)},
               {"name", TextJson(entry.name)},
               {"id", TextJson(entry.id)},
               {"version", entry.version},
               {"author", TextJson(entry.author)},
               {"reason", TextJson(entry.reason)},
               {"recorded_at_utc", TextJson(entry.recorded_at_utc)}};
  // at() throws for a field that the entry does not hold. That is a defect of
  // the program: the store gives every field of the kind.
  for (const db::RegisterField& field : db::ListFields(entry.kind)) {
    const std::string key(field.name);
    switch (field.type) {
      case FieldType::kText:
      case FieldType::kWord:
        json[key] = TextJson(entry.texts.at(key));
        break;
      case FieldType::kMeasured:
        json[key] = MeasuredJson(entry.measured.at(key));
        break;
      case FieldType::kEntry:
        json[key] = RegisteredJson(entry.entries.at(key));
        break;
    }
  }
  return json.dump();
}

// Reads the form alone: whether words and numbers are allowed for their field
// is asked by db::RequireStorable() when the store takes the entry.
db::Entry EntryFromJson(std::string_view line) {
  const Json json = ParsedLine(line, kEntrySchema);
  db::Entry entry;
  entry.kind = ReadWord(json, "kind", db::ParseRegisterKind);
  entry.name = ReadTextField(json, "name");
  entry.id = ReadTextField(json, "id");
  entry.version = ReadInteger(json, "version");
  entry.author = ReadTextField(json, "author");
  entry.reason = ReadTextField(json, "reason");
  entry.recorded_at_utc = ReadTextField(json, "recorded_at_utc");
  // The kind has been read and says which fields must follow.
  for (const db::RegisterField& field : db::ListFields(entry.kind)) {
    const std::string key(field.name);
    switch (field.type) {
      case FieldType::kText:
      case FieldType::kWord:
        entry.texts[key] = ReadTextField(json, key);
        break;
      case FieldType::kMeasured:
        entry.measured.insert_or_assign(key, ReadMeasured(json, key));
        break;
      case FieldType::kEntry:
        entry.entries[key] = ReadRegistered(json, key);
        break;
    }
  }
  return entry;
}

// Entries and numbers stand beside each other in one object, each under the
// name that the tables of db/register.h give it. SI: kelvin, radians, metres.
Json ConditionsJson(const core::Conditions& conditions) {
  Json json = Json::object();
  for (const auto& entry : db::kConditionEntries) {
    json[std::string(Name(entry.kind))] =
        RegisteredJson(conditions.*entry.member);
  }
  for (const auto& quantity : db::kConditionQuantities) {
    json[std::string(quantity.name)] =
        MeasuredJson(conditions.*quantity.member);
  }
  json["anomaly"] = core::Name(conditions.anomaly);
  json["anomaly_note"] = TextJson(conditions.anomaly_note);
  json["note"] = TextJson(conditions.note);
  return json;
}

// Missing fields throw std::invalid_argument, except those that files of
// earlier versions do not have.
core::Conditions ReadConditions(const Json& json) {
  core::Conditions conditions;
  for (const auto& entry : db::kConditionEntries) {
    conditions.*entry.member =
        ReadRegistered(json, std::string(Name(entry.kind)));
  }
  for (const auto& quantity : db::kConditionQuantities) {
    const std::string key(quantity.name);
    // Files of earlier versions do not have it; it stays absent, "not
    // recorded".
    if (quantity.is_later && !json.contains(key)) continue;
    conditions.*quantity.member = ReadMeasured(json, key);
  }
  conditions.anomaly = ReadWord(json, "anomaly", core::ParseAnomaly);
  conditions.anomaly_note = ReadTextField(json, "anomaly_note");
  if (json.contains("note")) conditions.note = ReadTextField(json, "note");
  return conditions;
}

}  // namespace touchdown::report
