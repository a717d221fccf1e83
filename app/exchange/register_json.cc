#include "app/exchange/register_json.h"

#include <stdexcept>

namespace touchdown::report {
namespace {

using db::FieldType;

Json RegisteredJson(const core::Registered& entry) {
  if (entry.name.empty()) return nullptr;
  return {{"name", TextJson(entry.name)}, {"id", TextJson(entry.id)}};
}

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

core::Conditions ReadConditions(const Json& json) {
  core::Conditions conditions;
  for (const auto& entry : db::kConditionEntries) {
    conditions.*entry.member =
        ReadRegistered(json, std::string(Name(entry.kind)));
  }
  for (const auto& quantity : db::kConditionQuantities) {
    const std::string key(quantity.name);
    // An earlier program wrote none.
    if (quantity.is_later && !json.contains(key)) continue;
    conditions.*quantity.member = ReadMeasured(json, key);
  }
  conditions.anomaly = ReadWord(json, "anomaly", core::ParseAnomaly);
  conditions.anomaly_note = ReadTextField(json, "anomaly_note");
  if (json.contains("note")) conditions.note = ReadTextField(json, "note");
  return conditions;
}

}  // namespace touchdown::report
