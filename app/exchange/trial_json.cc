// Reading and writing mirror each other, field by field and in one order: a
// field that is added here stands in both. Measured numbers are not named but
// walked over by the tables of core/quantities.h, as the store does.
//
// An export is read in one pass: ExportReader keeps one line ahead (`line_`)
// and, where that line begins the next trial, one revision ahead (`ahead_`). A
// file of 100 000 trials is never in memory as a whole.
#include "app/exchange/trial_json.h"

#include <fmt/format.h>

#include <istream>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "app/exchange/plan_json.h"
#include "app/exchange/register_json.h"
#include "app/text/json_fields.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/quantities.h"

namespace touchdown::report {
namespace {

constexpr std::string_view kCampaignSchema = "touchdown.campaign/1";
// Exports of stores below version 4 do not have it, and are read all the same.
constexpr std::string_view kAddedLater = "extrapolated_gap_m";

// Kind and sizes in metres; the sizes that the kind does not have are absent
// with their reason.
Json BodyJson(const core::Body& body) {
  Json json = {{"kind", core::Name(body.kind)}};
  for (const auto& quantity : core::kBodyQuantities) {
    json[std::string(quantity.name)] = MeasuredJson(body.*quantity.member);
  }
  return json;
}

// One contact with state and motion: all that a ContactRecord holds but
// unresolved_impacts, which stands in the analysis document alone. SI, radians.
Json ContactJson(const core::ContactRecord& record) {
  const core::Contact& contact = record.contact;
  Json json = {{"found", contact.found},
               {"not_found_because", TextJson(contact.reason)},
               {"from_start", contact.from_start},
               {"corner", nullptr},
               {"state", core::Name(record.state.label)},
               {"p_bounce", OptionalNumberJson(record.state.p_bounce)},
               {"state_because", TextJson(record.state.reason)},
               {"micro_bounce", record.state.micro_bounce}};
  // A sphere has no corner: null.
  if (contact.corner) json["corner"] = core::Name(*contact.corner);
  for (const auto& quantity : core::kContactQuantities) {
    json[std::string(quantity.name)] = MeasuredJson(core::At(record, quantity));
  }
  // The budgets are arrays of {"source", "u_rad"}.
  for (const auto& budget : core::kBudgets) {
    Json lines = Json::array();
    for (const auto& line : contact.*budget.member) {
      lines.push_back(
          {{"source", TextJson(line.source)}, {"u_rad", NumberJson(line.u)}});
    }
    json[fmt::format("{}_budget", budget.name)] = std::move(lines);
  }
  return json;
}

// One revision as an object. The first contact and the later ones are one
// array, in the order in which the body touched the ground.
Json RevisionObject(const db::Revision& revision) {
  const core::Trial& trial = revision.trial;
  Json json = {
      {"schema", "touchdown.revision/1"},
      {"id", TextJson(trial.id)},
      {"revision", trial.revision},
      {"revision_id", TextJson(revision.id)},
      {"kind", Name(revision.kind)},
      {"campaign", TextJson(trial.campaign)},
      {"origin", core::Name(trial.origin)},
      {"author", TextJson(trial.author)},
      {"reason", TextJson(trial.reason)},
      {"recorded_at_utc", TextJson(trial.recorded_at_utc)},
      {"software_version", TextJson(trial.software_version)},
      {"options_hash", TextJson(trial.options_hash)},
      {"clip",
       {{"path", TextJson(trial.clip.path)},
        {"id", TextJson(trial.clip.id)},
        {"sha256", TextJson(trial.clip.sha256)},
        {"size_bytes", trial.clip.size_bytes}}},
      {"body", BodyJson(trial.body)},
      {"angle_kind", core::Name(trial.angle_kind)},
      {"set_angle_rad", OptionalNumberJson(trial.set_angle_rad)},
      {"set_speed_mps", OptionalNumberJson(trial.set_speed_mps)},
      {"conditions",
       trial.conditions ? ConditionsJson(*trial.conditions) : Json(nullptr)},
      {"contacts", Json::array({ContactJson(trial.first)})},
      {"excluded", trial.excluded},
      {"exclusion_reason", TextJson(trial.exclusion_reason)},
      {"document", TextJson(trial.document_json)}};
  for (const auto& later : trial.later) {
    json["contacts"].push_back(ContactJson(later));
  }
  return json;
}

// These readers throw std::invalid_argument naming the field that is missing or
// wrong; ExportReader adds file and line.
core::Body ReadBodyFields(const Json& json) {
  core::Body body;
  body.kind = ReadWord(json, "kind", core::ParseBodyKind);
  for (const auto& quantity : core::kBodyQuantities) {
    body.*quantity.member = ReadMeasured(json, std::string(quantity.name));
  }
  return body;
}

// The inverse of ContactJson().
core::ContactRecord ReadContact(const Json& json) {
  core::ContactRecord record;
  core::Contact& contact = record.contact;
  contact.found = ReadFlag(json, "found");
  contact.reason = ReadTextField(json, "not_found_because");
  contact.from_start = ReadFlag(json, "from_start");
  if (!Field(json, "corner").is_null()) {
    contact.corner = ReadWord(json, "corner", core::ParseCorner);
  }
  record.state.label = ReadWord(json, "state", core::ParseMotionState);
  record.state.p_bounce = ReadOptionalNumber(json, "p_bounce");
  record.state.reason = ReadTextField(json, "state_because");
  record.state.micro_bounce = ReadFlag(json, "micro_bounce");
  for (const auto& quantity : core::kContactQuantities) {
    const std::string name(quantity.name);
    core::Measured& measured = core::At(record, quantity);
    if (name == kAddedLater && !json.contains(name)) {
      measured = core::AbsentBecause("exported before it was measured");
      continue;
    }
    measured = ReadMeasured(json, name);
  }
  for (const auto& budget : core::kBudgets) {
    const std::string name = fmt::format("{}_budget", budget.name);
    const Json& lines = Field(json, name);
    if (!lines.is_array()) WrongField(name, "an array");
    for (const auto& line : lines) {
      (contact.*budget.member)
          .push_back(
              {ReadTextField(line, "source"), ReadNumberField(line, "u_rad")});
    }
  }
  return record;
}

}  // namespace

std::string CampaignJson(const core::Campaign& campaign) {
  const Json json = {
      {"schema", kCampaignSchema},
      {"name", TextJson(campaign.name)},
      {"body", BodyJson(campaign.body)},
      {"surface", TextJson(campaign.surface)},
      {"angle_kind", core::Name(campaign.angle_kind)},
      {"bounce_height_m", NumberJson(campaign.bounce_height_m)},
      {"speed_min_mps", NumberJson(campaign.speed_min_mps)},
      {"speed_max_mps", NumberJson(campaign.speed_max_mps)},
      {"theory_name", TextJson(campaign.theory_name)},
      {"theory_boundary_rad", OptionalNumberJson(campaign.theory_boundary_rad)},
      {"theory_u_rad", NumberJson(campaign.theory_u_rad)},
      {"margin_rad", NumberJson(campaign.margin_rad)}};
  return json.dump();
}

core::Campaign CampaignFromJson(std::string_view line) {
  const Json json = ParsedLine(line, kCampaignSchema);
  core::Campaign campaign;
  campaign.name = ReadTextField(json, "name");
  campaign.body = ReadBodyFields(Field(json, "body"));
  campaign.surface = ReadTextField(json, "surface");
  campaign.angle_kind = ReadWord(json, "angle_kind", core::ParseAngleKind);
  campaign.bounce_height_m = ReadNumberField(json, "bounce_height_m");
  campaign.speed_min_mps = ReadNumberField(json, "speed_min_mps");
  campaign.speed_max_mps = ReadNumberField(json, "speed_max_mps");
  campaign.theory_name = ReadTextField(json, "theory_name");
  campaign.theory_boundary_rad =
      ReadOptionalNumber(json, "theory_boundary_rad");
  campaign.theory_u_rad = ReadNumberField(json, "theory_u_rad");
  campaign.margin_rad = ReadNumberField(json, "margin_rad");
  return campaign;
}

std::string RevisionJson(const db::Revision& revision) {
  return RevisionObject(revision).dump();
}

// The revision in force stands at the top, so that a script that asks for one
// field need not know of revisions; all of them follow under "history".
std::string HistoryJson(const std::vector<db::Revision>& history) {
  Json json = {{"schema", "touchdown.trial/1"}};
  // A trial that the store does not hold: nothing but the schema.
  if (history.empty()) return json.dump(1);
  const db::Revision& in_force = db::RevisionInForce(history);
  Json current = RevisionObject(in_force);
  // The object has the schema of a trial, not of a revision line.
  current.erase("schema");
  // The analysis document as an object where it is one, not as a text with
  // escaped quotes: scripts look into it. Null where there is none.
  const Json document =
      Json::parse(in_force.trial.document_json, nullptr, false);
  current["document"] = document.is_discarded() ? Json(nullptr) : document;
  json.update(current);
  Json revisions = Json::array();
  // Oldest first, each with what it changed.
  for (std::size_t i = 0; i < history.size(); ++i) {
    const auto& [id, kind, trial] = history[i];
    Json one = {{"revision", trial.revision},
                {"revision_id", TextJson(id)},
                {"kind", Name(kind)},
                {"author", TextJson(trial.author)},
                {"reason", TextJson(trial.reason)},
                {"recorded_at_utc", TextJson(trial.recorded_at_utc)},
                {"changes", Json::array()}};
    // Compared with the revision that was in force until then: a proposal that
    // nobody took is not a state that anything changed from.
    if (i > 0) {
      for (const auto& change :
           db::Changes(db::RevisionInForce({history.data(), i}).trial,
                       history[i].trial)) {
        one["changes"].push_back({{"field", change.field},
                                  {"from", TextJson(change.from)},
                                  {"to", TextJson(change.to)}});
      }
    }
    revisions.push_back(std::move(one));
  }
  json["history"] = std::move(revisions);
  // The number of a proposal that waits for a person, else null. Its
  // differences are those of its entry in the history.
  const db::Revision* proposal = db::OpenProposal(history);
  json["proposal"] =
      proposal != nullptr ? Json(proposal->trial.revision) : Json(nullptr);
  return json.dump(1);
}

db::Revision RevisionFromJson(std::string_view line) {
  const Json json = ParsedLine(line, "touchdown.revision/1");
  db::Revision revision;
  core::Trial& trial = revision.trial;
  trial.id = ReadTextField(json, "id");
  trial.revision = ReadInteger(json, "revision");
  revision.id = ReadTextField(json, "revision_id");
  revision.kind = ReadWord(json, "kind", db::ParseRevisionKind);
  trial.campaign = ReadTextField(json, "campaign");
  trial.origin = ReadWord(json, "origin", core::ParseOrigin);
  trial.author = ReadTextField(json, "author");
  trial.reason = ReadTextField(json, "reason");
  trial.recorded_at_utc = ReadTextField(json, "recorded_at_utc");
  trial.software_version = ReadTextField(json, "software_version");
  trial.options_hash = ReadTextField(json, "options_hash");
  const Json& clip = Field(json, "clip");
  trial.clip.path = ReadTextField(clip, "path");
  trial.clip.id = ReadTextField(clip, "id");
  trial.clip.sha256 = ReadTextField(clip, "sha256");
  trial.clip.size_bytes = ReadInteger(clip, "size_bytes");
  trial.body = ReadBodyFields(Field(json, "body"));
  trial.angle_kind = ReadWord(json, "angle_kind", core::ParseAngleKind);
  trial.set_angle_rad = ReadOptionalNumber(json, "set_angle_rad");
  trial.set_speed_mps = ReadOptionalNumber(json, "set_speed_mps");
  // Exports of earlier versions have no conditions; they stay unstated.
  const auto conditions = json.find("conditions");
  if (conditions != json.end() && !conditions->is_null()) {
    trial.conditions = ReadConditions(*conditions);
  }
  const Json& contacts = Field(json, "contacts");
  // A trial always has a first contact, even one that was not found.
  if (!contacts.is_array() || contacts.empty()) {
    WrongField("contacts", "an array of at least one contact");
  }
  trial.first = ReadContact(contacts.front());
  for (std::size_t i = 1; i < contacts.size(); ++i) {
    trial.later.push_back(ReadContact(contacts[i]));
  }
  trial.excluded = ReadFlag(json, "excluded");
  trial.exclusion_reason = ReadTextField(json, "exclusion_reason");
  trial.document_json = ReadTextField(json, "document");
  return revision;
}

// The store's UUID tells a merge where the trials come from.
void WriteExportHeader(std::ostream& out, const std::string& store_uuid) {
  const Json header = {{"schema", "touchdown.export/1"}, {"store", store_uuid}};
  out << header.dump() << '\n';
}

// The parts of a file stand in an order in which nothing refers to what
// follows: register, campaigns, plans, trials. A line of another schema ends
// the part.
ExportReader::ExportReader(std::istream& in, std::string name)
    : in_(in), name_(std::move(name)) {
  try {
    if (!NextLine()) Fail("the file is empty; an export was expected");
    store_uuid_ =
        ReadTextField(ParsedLine(line_, "touchdown.export/1"), "store");
    bool more = NextLine();
    for (; more && ReadSchema(line_) == kEntrySchema; more = NextLine()) {
      entries_.push_back(EntryFromJson(line_));
    }
    for (; more && ReadSchema(line_) == kCampaignSchema; more = NextLine()) {
      campaigns_.push_back(CampaignFromJson(line_));
    }
    for (; more && ReadSchema(line_) == kPlanSchema; more = NextLine()) {
      plan_.push_back(PlanEventFromJson(line_));
      // A plan of a campaign that is not in the file would have no campaign in
      // the store that takes it.
      const std::string& campaign = plan_.back().campaign;
      if (std::none_of(campaigns_.begin(), campaigns_.end(),
                       [&](const auto& c) { return c.name == campaign; })) {
        Fail(fmt::format("campaign is '{}', must be one of this file",
                         campaign));
      }
    }
  } catch (const std::invalid_argument& error) {
    Fail(error.what());
  }
}

// Reads the next line that is not empty into `line_`, and counts lines for
// error messages. False at the end of the file, where `line_` is empty. The CR
// of a file that went through Windows is dropped.
bool ExportReader::NextLine() {
  while (std::getline(in_, line_)) {
    ++number_;
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    if (!line_.empty()) return true;
  }
  line_.clear();
  return false;
}

// Throws core::InputError: the fault is in the file, at the line read last.
void ExportReader::Fail(const std::string& what) const {
  throw core::InputError(fmt::format("{}:{}: {}", name_, number_, what));
}

std::optional<std::vector<db::Revision>> ExportReader::NextHistory() {
  std::vector<db::Revision> history;
  if (ahead_) history.push_back(*std::exchange(ahead_, std::nullopt));
  // Revisions of one trial stand together, so a change of the id ends the
  // history.
  while (!line_.empty()) {
    std::optional<db::Revision> revision;
    try {
      revision = RevisionFromJson(line_);
    } catch (const std::invalid_argument& error) {
      Fail(error.what());
    }
    // The error above names the line that was read, so the next one is read
    // only after it.
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
