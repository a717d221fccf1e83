#include "app/report/trial_json.h"

#include <fmt/format.h>

#include <cmath>
#include <istream>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "touchdown/core/errors.h"
#include "touchdown/db/quantities.h"

namespace touchdown::report {
namespace {

using Json = nlohmann::ordered_json;

// --- there -------------------------------------------------------------------

bool IsUtf8(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto byte = static_cast<unsigned char>(text[i]);
    std::size_t more = 0;
    unsigned code = 0;
    if (byte < 0x80) {
      ++i;
      continue;
    }
    if (byte >= 0xc2 && byte <= 0xdf) {
      more = 1;
      code = byte & 0x1fU;
    } else if (byte >= 0xe0 && byte <= 0xef) {
      more = 2;
      code = byte & 0x0fU;
    } else if (byte >= 0xf0 && byte <= 0xf4) {
      more = 3;
      code = byte & 0x07U;
    } else {
      return false;
    }
    if (i + more >= text.size()) return false;
    for (std::size_t k = 1; k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xc0U) != 0x80U) return false;
      code = (code << 6U) | (next & 0x3fU);
    }
    const bool overlong =
        (more == 2 && code < 0x800) || (more == 3 && code < 0x10000);
    if (overlong || code > 0x10ffff || (code >= 0xd800 && code <= 0xdfff)) {
      return false;
    }
    i += more + 1;
  }
  return true;
}

Json Text(const std::string& text) {
  if (IsUtf8(text)) return text;
  std::string hex;
  for (const char c : text) {
    hex += fmt::format("{:02x}", static_cast<unsigned char>(c));
  }
  return {{"bytes", hex}};
}

Json Number(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json OptionalNumber(const std::optional<double>& value) {
  return value ? Number(*value) : Json(nullptr);
}

Json MeasuredJson(const core::Measured& measured) {
  if (!measured) return {{"absent", Text(measured.error().reason)}};
  Json json = {{"value", Number(measured->value)}, {"u", Number(measured->u)}};
  if (measured->interval95) {
    json["interval95"] = Json::array({Number(measured->interval95->low),
                                      Number(measured->interval95->high)});
  }
  return json;
}

Json BodyJson(const core::Body& body) {
  Json json = {{"kind", core::Name(body.kind)}};
  for (const auto& quantity : db::kBodyQuantities) {
    json[std::string(quantity.name)] = MeasuredJson(body.*quantity.member);
  }
  return json;
}

Json ContactJson(const core::ContactRecord& record) {
  const core::Contact& contact = record.contact;
  Json json = {{"found", contact.found},
               {"not_found_because", Text(contact.reason)},
               {"from_start", contact.from_start},
               {"corner", nullptr},
               {"state", core::Name(record.state.label)},
               {"p_bounce", OptionalNumber(record.state.p_bounce)},
               {"state_because", Text(record.state.reason)},
               {"micro_bounce", record.state.micro_bounce}};
  if (contact.corner) json["corner"] = core::Name(*contact.corner);
  for (const auto& quantity : db::kContactQuantities) {
    json[std::string(quantity.name)] = MeasuredJson(db::At(record, quantity));
  }
  for (const auto& budget : db::kBudgets) {
    Json lines = Json::array();
    for (const auto& line : contact.*budget.member) {
      lines.push_back(
          {{"source", Text(line.source)}, {"u_rad", Number(line.u)}});
    }
    json[fmt::format("{}_budget", budget.name)] = std::move(lines);
  }
  return json;
}

Json RevisionObject(const db::Revision& revision) {
  const core::Trial& trial = revision.trial;
  Json json = {{"schema", "touchdown.revision/1"},
               {"id", trial.id},
               {"revision", trial.revision},
               {"revision_id", revision.id},
               {"kind", Name(revision.kind)},
               {"campaign", Text(trial.campaign)},
               {"origin", core::Name(trial.origin)},
               {"author", Text(trial.author)},
               {"reason", Text(trial.reason)},
               {"recorded_at_utc", trial.recorded_at_utc},
               {"software_version", Text(trial.software_version)},
               {"options_hash", Text(trial.options_hash)},
               {"clip",
                {{"path", Text(trial.clip.path)},
                 {"id", Text(trial.clip.id)},
                 {"sha256", Text(trial.clip.sha256)},
                 {"size_bytes", trial.clip.size_bytes}}},
               {"body", BodyJson(trial.body)},
               {"angle_kind", core::Name(trial.angle_kind)},
               {"set_angle_rad", OptionalNumber(trial.set_angle_rad)},
               {"set_speed_mps", OptionalNumber(trial.set_speed_mps)},
               {"contacts", Json::array({ContactJson(trial.first)})},
               {"excluded", trial.excluded},
               {"exclusion_reason", Text(trial.exclusion_reason)},
               {"document", Text(trial.document_json)}};
  for (const auto& later : trial.later) {
    json["contacts"].push_back(ContactJson(later));
  }
  return json;
}

// --- and back ----------------------------------------------------------------

const Json& Field(const Json& json, const std::string& name) {
  const auto it = json.is_object() ? json.find(name) : json.end();
  if (!json.is_object() || it == json.end()) {
    throw std::invalid_argument(fmt::format("field '{}' is missing", name));
  }
  return *it;
}

[[noreturn]] void Wrong(const std::string& name, std::string_view expected) {
  throw std::invalid_argument(
      fmt::format("field '{}' must be {}", name, expected));
}

std::string TextOf(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  if (field.is_string()) return field.get<std::string>();
  const auto bytes = field.is_object() ? field.find("bytes") : field.end();
  if (!field.is_object() || bytes == field.end() || !bytes->is_string()) {
    Wrong(name, "a text");
  }
  const auto hex = bytes->get<std::string>();
  std::string text;
  if (hex.size() % 2 != 0 ||
      hex.find_first_not_of("0123456789abcdef") != std::string::npos) {
    Wrong(name, "bytes in hexadecimal");
  }
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    text += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  }
  return text;
}

bool FlagOf(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  if (!field.is_boolean()) Wrong(name, "true or false");
  return field.get<bool>();
}

std::int64_t IntegerOf(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  if (!field.is_number_integer()) Wrong(name, "a whole number");
  return field.get<std::int64_t>();
}

double ToNumber(const Json& field, const std::string& name) {
  if (field.is_number()) return field.get<double>();
  if (field == "inf") return std::numeric_limits<double>::infinity();
  if (field == "-inf") return -std::numeric_limits<double>::infinity();
  Wrong(name, "a number");
}

double NumberOf(const Json& json, const std::string& name) {
  return ToNumber(Field(json, name), name);
}

std::optional<double> OptionalNumberOf(const Json& json,
                                       const std::string& name) {
  const Json& field = Field(json, name);
  if (field.is_null()) return std::nullopt;
  return ToNumber(field, name);
}

template <class T>
T WordOf(const Json& json, const std::string& name,
         std::optional<T> (*parse)(std::string_view)) {
  const Json& field = Field(json, name);
  const auto word =
      field.is_string() ? parse(field.get<std::string>()) : std::optional<T>();
  if (!word) Wrong(name, "one of the words of the field");
  return *word;
}

core::Measured MeasuredOf(const Json& json, const std::string& name) {
  const Json& field = Field(json, name);
  if (field.is_object() && field.contains("absent")) {
    return core::AbsentBecause(TextOf(field, "absent"));
  }
  if (!field.is_object()) Wrong(name, "a value with u, or absent");
  core::Estimate estimate;
  estimate.value = ToNumber(Field(field, "value"), name + ".value");
  estimate.u = ToNumber(Field(field, "u"), name + ".u");
  if (const auto interval = field.find("interval95"); interval != field.end()) {
    if (!interval->is_array() || interval->size() != 2) {
      Wrong(name + ".interval95", "[low, high]");
    }
    estimate.interval95 = core::Interval{ToNumber((*interval)[0], name),
                                         ToNumber((*interval)[1], name)};
  }
  return estimate;
}

core::Body BodyOf(const Json& json) {
  core::Body body;
  body.kind = WordOf(json, "kind", core::ParseBodyKind);
  for (const auto& quantity : db::kBodyQuantities) {
    body.*quantity.member = MeasuredOf(json, std::string(quantity.name));
  }
  return body;
}

core::ContactRecord ContactOf(const Json& json) {
  core::ContactRecord record;
  core::Contact& contact = record.contact;
  contact.found = FlagOf(json, "found");
  contact.reason = TextOf(json, "not_found_because");
  contact.from_start = FlagOf(json, "from_start");
  if (!Field(json, "corner").is_null()) {
    contact.corner = WordOf(json, "corner", core::ParseCorner);
  }
  record.state.label = WordOf(json, "state", core::ParseMotionState);
  record.state.p_bounce = OptionalNumberOf(json, "p_bounce");
  record.state.reason = TextOf(json, "state_because");
  record.state.micro_bounce = FlagOf(json, "micro_bounce");
  for (const auto& quantity : db::kContactQuantities) {
    db::At(record, quantity) = MeasuredOf(json, std::string(quantity.name));
  }
  for (const auto& budget : db::kBudgets) {
    const std::string name = fmt::format("{}_budget", budget.name);
    const Json& lines = Field(json, name);
    if (!lines.is_array()) Wrong(name, "an array");
    for (const auto& line : lines) {
      (contact.*budget.member)
          .push_back({TextOf(line, "source"), NumberOf(line, "u_rad")});
    }
  }
  return record;
}

Json Parsed(std::string_view line, std::string_view schema) {
  Json json = Json::parse(line, nullptr, false);
  if (json.is_discarded()) {
    throw std::invalid_argument("this is not JSON");
  }
  const Json& found = Field(json, "schema");
  if (found != Json(schema)) {
    throw std::invalid_argument(
        fmt::format("field 'schema' must be \"{}\"", schema));
  }
  return json;
}

std::string SchemaOf(std::string_view line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object() || !json.contains("schema")) return "";
  const Json& schema = json["schema"];
  return schema.is_string() ? schema.get<std::string>() : "";
}

}  // namespace

std::string CampaignJson(const core::Campaign& campaign) {
  const Json json = {
      {"schema", "touchdown.campaign/1"},
      {"name", Text(campaign.name)},
      {"body", BodyJson(campaign.body)},
      {"surface", Text(campaign.surface)},
      {"angle_kind", core::Name(campaign.angle_kind)},
      {"bounce_height_m", Number(campaign.bounce_height_m)},
      {"speed_min_mps", Number(campaign.speed_min_mps)},
      {"speed_max_mps", Number(campaign.speed_max_mps)},
      {"theory_name", Text(campaign.theory_name)},
      {"theory_boundary_rad", OptionalNumber(campaign.theory_boundary_rad)},
      {"theory_u_rad", Number(campaign.theory_u_rad)},
      {"margin_rad", Number(campaign.margin_rad)}};
  return json.dump();
}

core::Campaign CampaignFromJson(std::string_view line) {
  const Json json = Parsed(line, "touchdown.campaign/1");
  core::Campaign campaign;
  campaign.name = TextOf(json, "name");
  campaign.body = BodyOf(Field(json, "body"));
  campaign.surface = TextOf(json, "surface");
  campaign.angle_kind = WordOf(json, "angle_kind", core::ParseAngleKind);
  campaign.bounce_height_m = NumberOf(json, "bounce_height_m");
  campaign.speed_min_mps = NumberOf(json, "speed_min_mps");
  campaign.speed_max_mps = NumberOf(json, "speed_max_mps");
  campaign.theory_name = TextOf(json, "theory_name");
  campaign.theory_boundary_rad = OptionalNumberOf(json, "theory_boundary_rad");
  campaign.theory_u_rad = NumberOf(json, "theory_u_rad");
  campaign.margin_rad = NumberOf(json, "margin_rad");
  return campaign;
}

std::string RevisionJson(const db::Revision& revision) {
  return RevisionObject(revision).dump();
}

std::string HistoryJson(const std::vector<db::Revision>& history) {
  Json json = {{"schema", "touchdown.trial/1"}};
  if (history.empty()) return json.dump(1);
  Json current = RevisionObject(history.back());
  current.erase("schema");
  // The analysis document as what it is, where it is one.
  const Json document =
      Json::parse(history.back().trial.document_json, nullptr, false);
  current["document"] = document.is_discarded() ? Json(nullptr) : document;
  json.update(current);
  Json revisions = Json::array();
  for (std::size_t i = 0; i < history.size(); ++i) {
    const auto& [id, kind, trial] = history[i];
    Json one = {{"revision", trial.revision},
                {"revision_id", id},
                {"kind", Name(kind)},
                {"author", Text(trial.author)},
                {"reason", Text(trial.reason)},
                {"recorded_at_utc", trial.recorded_at_utc},
                {"changes", Json::array()}};
    if (i > 0) {
      for (const auto& change :
           db::Changes(history[i - 1].trial, history[i].trial)) {
        one["changes"].push_back({{"field", change.field},
                                  {"from", Text(change.from)},
                                  {"to", Text(change.to)}});
      }
    }
    revisions.push_back(std::move(one));
  }
  json["history"] = std::move(revisions);
  return json.dump(1);
}

db::Revision RevisionFromJson(std::string_view line) {
  const Json json = Parsed(line, "touchdown.revision/1");
  db::Revision revision;
  core::Trial& trial = revision.trial;
  trial.id = TextOf(json, "id");
  trial.revision = IntegerOf(json, "revision");
  revision.id = TextOf(json, "revision_id");
  revision.kind = WordOf(json, "kind", db::ParseRevisionKind);
  trial.campaign = TextOf(json, "campaign");
  trial.origin = WordOf(json, "origin", core::ParseOrigin);
  trial.author = TextOf(json, "author");
  trial.reason = TextOf(json, "reason");
  trial.recorded_at_utc = TextOf(json, "recorded_at_utc");
  trial.software_version = TextOf(json, "software_version");
  trial.options_hash = TextOf(json, "options_hash");
  const Json& clip = Field(json, "clip");
  trial.clip.path = TextOf(clip, "path");
  trial.clip.id = TextOf(clip, "id");
  trial.clip.sha256 = TextOf(clip, "sha256");
  trial.clip.size_bytes = IntegerOf(clip, "size_bytes");
  trial.body = BodyOf(Field(json, "body"));
  trial.angle_kind = WordOf(json, "angle_kind", core::ParseAngleKind);
  trial.set_angle_rad = OptionalNumberOf(json, "set_angle_rad");
  trial.set_speed_mps = OptionalNumberOf(json, "set_speed_mps");
  const Json& contacts = Field(json, "contacts");
  if (!contacts.is_array() || contacts.empty()) {
    Wrong("contacts", "an array of at least one contact");
  }
  trial.first = ContactOf(contacts.front());
  for (std::size_t i = 1; i < contacts.size(); ++i) {
    trial.later.push_back(ContactOf(contacts[i]));
  }
  trial.excluded = FlagOf(json, "excluded");
  trial.exclusion_reason = TextOf(json, "exclusion_reason");
  trial.document_json = TextOf(json, "document");
  return revision;
}

void WriteExportHeader(std::ostream& out, const std::string& store_uuid) {
  const Json header = {{"schema", "touchdown.export/1"}, {"store", store_uuid}};
  out << header.dump() << '\n';
}

ExportReader::ExportReader(std::istream& in, std::string name)
    : in_(in), name_(std::move(name)) {
  try {
    if (!NextLine()) Fail("the file is empty; an export was expected");
    store_uuid_ = TextOf(Parsed(line_, "touchdown.export/1"), "store");
    while (NextLine()) {
      if (SchemaOf(line_) != "touchdown.campaign/1") break;
      campaigns_.push_back(CampaignFromJson(line_));
    }
  } catch (const std::invalid_argument& error) {
    Fail(error.what());
  }
}

bool ExportReader::NextLine() {
  while (std::getline(in_, line_)) {
    ++number_;
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    if (!line_.empty()) return true;
  }
  line_.clear();
  return false;
}

void ExportReader::Fail(const std::string& what) const {
  throw core::InputError(fmt::format("{}:{}: {}", name_, number_, what));
}

std::optional<std::vector<db::Revision>> ExportReader::NextHistory() {
  std::vector<db::Revision> history;
  if (ahead_) history.push_back(*std::exchange(ahead_, std::nullopt));
  while (!line_.empty()) {
    std::optional<db::Revision> revision;
    try {
      revision = RevisionFromJson(line_);
    } catch (const std::invalid_argument& error) {
      Fail(error.what());
    }
    NextLine();
    if (!history.empty() && revision->trial.id != history.front().trial.id) {
      ahead_ = std::move(revision);
      break;
    }
    history.push_back(std::move(*revision));
  }
  if (history.empty()) return std::nullopt;
  return history;
}

}  // namespace touchdown::report
