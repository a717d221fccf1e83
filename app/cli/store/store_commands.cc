// touchdown list and show tell what is in the store. `list` prints a line a
// trial, `show` everything of one. Both only read.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tuple>

#include "app/batch/triage.h"
#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/exchange/trial_json.h"
#include "app/exchange/trial_list.h"
#include "app/text/json.h"
#include "app/trials/statement.h"
#include "touchdown/core/quantities.h"
#include "touchdown/core/units.h"
#include "touchdown/db/identity.h"
#include "touchdown/db/register.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {
namespace {

using core::kDegree;
using core::kMillimetre;
using report::Json;

constexpr double kPercent = 0.01;

// --- list --------------------------------------------------------------------

// Holds the filters as typed; empty ones let every trial pass.
struct ListFlags {
  std::string db;
  std::string campaign;
  std::string origin;
  std::string body;
  std::string state;
  std::string from;
  std::string until;
  bool counting = false;
  bool excluded = false;
  bool json = false;
};

// Returns the typed filters for the store. `campaign_given` tells --campaign ''
// (trials in none) from no --campaign. Throws std::invalid_argument for a word
// that is none of the flag's.
db::TrialFilter MakeFilter(const ListFlags& flags, bool campaign_given) {
  db::TrialFilter filter;
  if (campaign_given) filter.campaign = flags.campaign;
  if (!flags.origin.empty()) {
    filter.origin =
        ParseWord<core::Origin>("--origin", flags.origin, core::ParseOrigin,
                                "recorded, simulated or manual");
  }
  if (!flags.body.empty()) {
    filter.body = ParseWord<core::BodyKind>(
        "--body", flags.body, core::ParseBodyKind, "sphere or rectangle");
  }
  if (!flags.state.empty()) {
    filter.state = ParseWord<core::MotionState>(
        "--state", flags.state, core::ParseMotionState, pipeline::kStateWords);
  }
  if (!flags.from.empty()) filter.from_utc = flags.from;
  if (!flags.until.empty()) filter.until_utc = flags.until;
  if (flags.counting) filter.excluded = false;
  if (flags.excluded) filter.excluded = true;
  // No column shows the analysis documents, which are most of a store's bytes.
  filter.with_documents = false;
  return filter;
}

// Returns the touchdown.list/1 document: degrees and millimetres, null for what
// is absent.
std::string ListJson(const std::vector<core::Trial>& trials) {
  Json list = Json::array();
  for (const auto& trial : trials) list.push_back(report::TrialRowJson(trial));
  const Json json = {{"schema", "touchdown.list/1"},
                     {"trials", std::move(list)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

// Returns what a reader must know of a trial before its numbers, such as
// "SIMULATED; EXCLUDED: wrong body"; "" for most.
std::string Marks(const core::Trial& trial) {
  std::string marks;
  const auto add = [&marks](const std::string& mark) {
    marks += (marks.empty() ? "" : "; ") + mark;
  };
  if (trial.origin == core::Origin::kSimulated) add("SIMULATED");
  if (trial.excluded) add("EXCLUDED: " + Printable(trial.exclusion_reason));
  if (trial.first.state.micro_bounce) add("micro-bounce");
  if (!trial.first.contact.found) {
    add("no contact: " + Printable(trial.first.contact.reason));
  }
  return marks;
}

// Returns the value in `unit` with fixed decimals, or "-".
std::string Shown(const std::optional<double>& value, int decimals,
                  double unit) {
  return value ? fmt::format("{:.{}f}", *value / unit, decimals) : "-";
}

// Returns a table with one line a trial, and a line that counts them. An
// excluded or simulated trial is counted apart: nobody must take it for one
// that counts.
std::string ListText(const std::vector<core::Trial>& trials) {
  std::vector<std::vector<std::string>> rows = {
      {"id", "campaign", "origin", "body", "angle kind", "contact angle, deg",
       "set, deg", "state", "P(bounce)", "rev", "recorded, UTC", "remarks"}};
  std::size_t simulated = 0;
  std::size_t excluded = 0;
  for (const auto& trial : trials) {
    simulated += trial.origin == core::Origin::kSimulated ? 1 : 0;
    excluded += trial.excluded ? 1 : 0;
    // An id is cut to its beginning, by which `show` finds it; of a time the
    // fraction of the second is left out.
    rows.push_back({db::ShortId(trial.id), Printable(trial.campaign),
                    std::string(core::Name(trial.origin)), BodyText(trial.body),
                    std::string(core::Name(trial.angle_kind)),
                    WithU(core::ContactAngle(trial), kDegree),
                    Shown(trial.set_angle_rad, 2, kDegree),
                    std::string(core::Name(trial.first.state.label)),
                    Shown(trial.first.state.p_bounce, 4, 1.0),
                    fmt::format("{}", trial.revision),
                    trial.recorded_at_utc.substr(0, 19), Marks(trial)});
  }
  std::string text = trials.empty() ? "" : Aligned(rows);
  text +=
      fmt::format("{} trial{}", trials.size(), trials.size() == 1 ? "" : "s");
  if (excluded != 0) text += fmt::format(", {} excluded", excluded);
  if (simulated != 0) {
    text += fmt::format(", {} simulated (no verdict on a theory rests on them)",
                        simulated);
  }
  return text + '\n';
}

// --- show --------------------------------------------------------------------

// Adds a row for each measured quantity of one contact: its name with the unit
// it is shown in, value and u, and the 95 % interval where the normal one would
// mislead; or the reason of its absence.
void ShowContact(const core::ContactRecord& record,
                 std::vector<std::vector<std::string>>& rows) {
  for (const auto& quantity : core::kContactQuantities) {
    const auto& measured = core::At(record, quantity);
    std::string name(quantity.name);
    double unit = 1.0;
    // The record's names bear SI units; people read degrees and millimetres.
    if (name.ends_with("_rad")) {
      name.replace(name.size() - 3, 3, "deg");
      unit = kDegree;
    } else if (name.ends_with("_m")) {
      name += "m";
      unit = kMillimetre;
    }
    if (measured) {
      std::string value = WithU(measured, unit);
      if (measured->interval95) {
        value +=
            fmt::format("  [{:.6g}, {:.6g}]", measured->interval95->low / unit,
                        measured->interval95->high / unit);
      }
      rows.push_back({"  " + name, value});
    } else {
      rows.push_back(
          {"  " + name, "absent: " + Printable(measured.error().reason)});
    }
  }
}

// Adds the conditions of the shot: entries of the register with the beginning
// of the version's id, numbers with u, note and anomaly.
void ShowConditions(const core::Conditions& conditions,
                    std::vector<std::vector<std::string>>& rows) {
  rows.push_back({"conditions", ""});
  for (const auto& entry : db::kConditionEntries) {
    const core::Registered& named = conditions.*entry.member;
    if (named.name.empty()) continue;
    rows.push_back(
        {fmt::format("  {}", db::Name(entry.kind)),
         fmt::format("{} ({})", Printable(named.name), db::ShortId(named.id))});
  }
  if (auto celsius = conditions.temperature_k) {
    // A shift leaves u as it is.
    celsius->value -= core::kIcePoint_k;
    rows.push_back({"  temperature, deg C", WithU(celsius, 1.0)});
  }
  if (conditions.relative_humidity) {
    rows.push_back({"  relative humidity, %",
                    WithU(conditions.relative_humidity, kPercent)});
  }
  for (const auto& [name, number, unit] :
       {std::tuple("  elevation, deg", &conditions.elevation_rad,
                   core::kDegree),
        std::tuple("  compression, mm", &conditions.compression_m,
                   core::kMillimetre),
        std::tuple("  muzzle height, mm", &conditions.muzzle_height_m,
                   core::kMillimetre)}) {
    if (*number) rows.push_back({name, WithU(*number, unit)});
  }
  if (!conditions.note.empty()) {
    rows.push_back({"  note", Printable(conditions.note)});
  }
  rows.push_back(
      {"  anomaly", conditions.anomaly_note.empty()
                        ? std::string(core::Name(conditions.anomaly))
                        : fmt::format("{}: {}", core::Name(conditions.anomaly),
                                      Printable(conditions.anomaly_note))});
}

// Returns all of one trial, as the revision in force states it.
std::string ShowText(const core::Trial& trial) {
  std::string text;
  if (trial.origin == core::Origin::kSimulated) {
    text += "SIMULATED: no verdict on a theory rests on this trial\n";
  }
  std::vector<std::vector<std::string>> rows = {
      {"trial", trial.id},
      {"campaign", trial.campaign.empty() ? "-" : Printable(trial.campaign)},
      {"origin", std::string(core::Name(trial.origin))},
      {"revision",
       fmt::format("{}, {} by {}{}{}", trial.revision, trial.recorded_at_utc,
                   Printable(trial.author), trial.reason.empty() ? "" : ": ",
                   Printable(trial.reason))},
      {"clip", trial.clip.path.empty() ? "-" : Printable(trial.clip.path)},
      {"clip sha256", trial.clip.sha256.empty() ? "-" : trial.clip.sha256},
      {"body", BodyText(trial.body)},
      {"set angle, deg", Shown(trial.set_angle_rad, 3, kDegree)},
      {"set speed, m/s", Shown(trial.set_speed_mps, 3, 1.0)},
      {"contact angle, deg",
       fmt::format("{} ({})", WithU(core::ContactAngle(trial), kDegree),
                   core::Name(trial.angle_kind))},
      {"state", std::string(core::Name(trial.first.state.label))},
      {"P(bounce)", Shown(trial.first.state.p_bounce, 4, 1.0)},
      {"because", Printable(trial.first.state.reason)}};
  if (trial.excluded) {
    rows.push_back({"excluded", Printable(trial.exclusion_reason)});
  }
  if (const auto corner = trial.first.contact.corner) {
    rows.push_back({"corner", std::string(core::Name(*corner))});
  }
  if (trial.conditions) ShowConditions(*trial.conditions, rows);
  rows.push_back({"measured", ""});
  ShowContact(trial.first, rows);
  // The first contact is "contact 1", shown above without a number.
  for (std::size_t i = 0; i < trial.later.size(); ++i) {
    rows.push_back({fmt::format("contact {}", i + 2),
                    std::string(core::Name(trial.later[i].state.label))});
    ShowContact(trial.later[i], rows);
  }
  return text + Aligned(rows);
}

// Says what a new analysis would change of a trial that a person has corrected,
// field by field, and how to accept it.
std::string ProposalText(const core::Trial& trial,
                         const core::Trial& proposal) {
  std::string text =
      fmt::format("proposal\n  {}\n",
                  Printable(pipeline::ProposalSentence(trial, proposal)));
  for (const auto& change : db::Changes(trial, proposal)) {
    text += fmt::format("       {}: {} -> {}\n", change.field,
                        Printable(change.from), Printable(change.to));
  }
  return text;
}

// Lists every revision, oldest first, with what it changed. A proposal is
// compared with the revision in force when it came, like all others.
std::string TrialHistoryText(const std::vector<db::Revision>& history) {
  std::string text = "history\n";
  for (std::size_t i = 0; i < history.size(); ++i) {
    const core::Trial& trial = history[i].trial;
    text += fmt::format(
        "  {}  {}  {} by {}{}{}\n", trial.revision, trial.recorded_at_utc,
        Name(history[i].kind), Printable(trial.author),
        trial.reason.empty() ? "" : ": ", Printable(trial.reason));
    if (i == 0) continue;
    for (const auto& change :
         db::Changes(db::RevisionInForce({history.data(), i}).trial,
                     history[i].trial)) {
      text += fmt::format("       {}: {} -> {}\n", change.field,
                          Printable(change.from), Printable(change.to));
    }
  }
  return text;
}

// Holds the flags of `show` as typed; `id` may be the beginning of one.
struct ShowFlags {
  std::string db;
  std::string id;
  bool history = false;
  bool json = false;
};

}  // namespace

void AddList(CLI::App& app, Action& action) {
  auto flags = std::make_shared<ListFlags>();
  CLI::App* command = AddCommand(app, "list", "the trials of a store");
  AddDbFlag(*command, flags->db);
  const Option campaign =
      AddOption(*command, "--campaign", flags->campaign,
                "only of this campaign ('' for trials in none)");
  AddOption(*command, "--origin", flags->origin,
            "recorded, simulated or manual");
  AddOption(*command, "--body", flags->body, "sphere or rectangle");
  AddOption(*command, "--state", flags->state, pipeline::kStateWords);
  AddOption(*command, "--from", flags->from,
            "first logged at or after, UTC, e.g. 2026-08-01");
  AddOption(*command, "--until", flags->until, "first logged before, UTC");
  const Option counting = AddFlag(*command, "--counting", flags->counting,
                                  "leave excluded trials out");
  AddFlag(*command, "--excluded", flags->excluded, "only excluded trials")
      .Exclude(counting);
  AddFlag(*command, "--json", flags->json, "one JSON document");
  // Only after parsing is it known whether --campaign was given.
  SetAction(*command, action, [flags, campaign] {
    const auto filter = MakeFilter(*flags, campaign.IsGiven());
    const auto store = db::Store::Open(flags->db, db::OpenMode::kRead);
    const auto trials = store.Trials(filter);
    fmt::print("{}", flags->json ? ListJson(trials) + '\n' : ListText(trials));
    return 0;
  });
}

void AddShow(CLI::App& app, Action& action) {
  auto flags = std::make_shared<ShowFlags>();
  CLI::App* command = AddCommand(app, "show", "one trial, all of it");
  AddOption(*command, "ID", flags->id, "of the trial, or the beginning of it")
      .Require();
  AddDbFlag(*command, flags->db);
  AddFlag(*command, "--history", flags->history,
          "who changed what, when and why");
  AddFlag(*command, "--json", flags->json, "one JSON document");
  SetAction(*command, action, [flags] {
    const auto store = db::Store::Open(flags->db, db::OpenMode::kRead);
    const core::Trial trial = RequireTrial(store, flags->id);
    const auto history = store.History(trial.id);
    if (flags->json) {
      fmt::print("{}\n", report::HistoryJson(history));
      return 0;
    }
    fmt::print("{}", ShowText(trial));
    if (const db::Revision* proposal = db::OpenProposal(history)) {
      fmt::print("{}", ProposalText(trial, proposal->trial));
    }
    if (flags->history) fmt::print("{}", TrialHistoryText(history));
    return 0;
  });
}

}  // namespace touchdown::cli
