#include "app/batch/triage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "app/facts/campaign_checks.h"
#include "app/facts/stored_document.h"
#include "app/text/format.h"
#include "app/text/text.h"
#include "touchdown/core/units.h"
#include "touchdown/db/identity.h"
#include "touchdown/db/records.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;
using nlohmann::ordered_json;

// The warnings of the analysis, from its document.
std::vector<std::string> ReadWarnings(const core::Trial& trial) {
  std::vector<std::string> warnings;
  const auto document = report::StoredDocument(trial);
  for (const auto& warning : report::FindValue(document, {"warnings"})) {
    if (warning.is_string()) warnings.push_back(warning);
  }
  return warnings;
}

}  // namespace

std::string_view Name(Done done) {
  switch (done) {
    case Done::kLogged:
      return "logged";
    case Done::kKnown:
      return "known";
    case Done::kCopy:
      return "copy";
    case Done::kFailed:
      break;
  }
  return "failed";
}

std::string_view Name(Attention attention) {
  switch (attention) {
    case Attention::kFailed:
      return "failed";
    case Attention::kNoContact:
      return "no contact";
    case Attention::kUndecided:
      return "undecided";
    case Attention::kNoAngle:
      return "no angle";
    case Attention::kProposed:
      return "proposed";
    case Attention::kWarned:
      return "warned";
    case Attention::kCopy:
      return "copy";
    case Attention::kNone:
      break;
  }
  return "-";
}

std::string ProposalSentence(const core::Trial& trial,
                             const core::Trial& proposal) {
  // "bounce, approach angle 20.013 ± 0.048 deg"
  const auto words = [](const core::Trial& one) {
    return fmt::format("{}, {} angle {} deg", core::Name(one.first.state.label),
                       core::Name(one.angle_kind),
                       report::WithUOrReason(ContactAngle(one), kDegree));
  };
  const std::size_t differences = db::Changes(trial, proposal).size();
  return fmt::format(
      "a person's correction ({}) stays in force; the analysis of {} proposes "
      "{} ({} difference{} in all, `touchdown show {} --history` lists them). "
      "Accept it with `touchdown correct {} --accept {} --by NAME --why "
      "REASON`",
      words(trial), proposal.recorded_at_utc, words(proposal), differences,
      differences == 1 ? "" : "s", db::ShortId(trial.id), db::ShortId(trial.id),
      proposal.revision);
}

TriageEntry MakeTriageEntry(const std::string& clip, Done done,
                            const core::Trial& trial,
                            const core::Trial* proposal) {
  TriageEntry entry;
  entry.clip = clip;
  entry.done = done;
  entry.trial_id = trial.id;
  entry.revision = trial.revision;
  entry.state = trial.first.state.label;
  entry.p_bounce = trial.first.state.p_bounce;
  entry.angle_kind = trial.angle_kind;
  entry.angle_rad = ContactAngle(trial);
  // The first that applies is why a person should look. They are asked in the
  // order of Attention, the most pressing first.
  const auto warnings = ReadWarnings(trial);
  if (!trial.first.contact.found) {
    entry.attention = Attention::kNoContact;
    entry.reason = trial.first.contact.reason;
  } else if (trial.first.state.label == core::MotionState::kUndecided) {
    entry.attention = Attention::kUndecided;
    // 1 for a toss-up (P = 0.5) or for no probability at all, 0 for certainty.
    entry.urgency =
        entry.p_bounce ? 1.0 - 2.0 * std::abs(*entry.p_bounce - 0.5) : 1.0;
    entry.reason = trial.first.state.reason;
  } else if (!entry.angle_rad) {
    entry.attention = Attention::kNoAngle;
    entry.reason = entry.angle_rad.error().reason;
  } else if (!warnings.empty()) {
    entry.attention = Attention::kWarned;
    entry.urgency = static_cast<double>(warnings.size());
    for (const auto& warning : warnings) {
      entry.reason += (entry.reason.empty() ? "" : "; ") + warning;
    }
  } else {
    // All is well; the least certain angle still comes first.
    entry.attention = Attention::kNone;
    entry.urgency = entry.angle_rad->u / kDegree;
  }
  if (proposal == nullptr) return entry;
  // A proposal presses more than warnings do and less than a missing answer;
  // what else there is to look at is told as well.
  if (entry.attention > Attention::kProposed) {
    entry.attention = Attention::kProposed;
    entry.urgency = 0.0;
  }
  entry.reason +=
      (entry.reason.empty() ? "" : "; ") + ProposalSentence(trial, *proposal);
  return entry;
}

bool NeedsMore(const TriageEntry& a, const TriageEntry& b) {
  if (a.attention != b.attention) return a.attention < b.attention;
  return a.urgency > b.urgency;
}

void SortByNeed(std::vector<TriageEntry>& entries) {
  std::stable_sort(entries.begin(), entries.end(), NeedsMore);
}

TriageCounts Count(std::span<const TriageEntry> entries) {
  TriageCounts counts;
  for (const auto& entry : entries) {
    counts.logged += entry.done == Done::kLogged ? 1 : 0;
    counts.known += entry.done == Done::kKnown ? 1 : 0;
    counts.copies += entry.done == Done::kCopy ? 1 : 0;
    counts.failed += entry.done == Done::kFailed ? 1 : 0;
    counts.to_look_at += entry.attention != Attention::kNone ? 1 : 0;
  }
  return counts;
}

std::vector<CampaignWord> CampaignWords(const db::Store& store,
                                        std::span<const TriageEntry> entries) {
  // The campaigns that this batch touched, each once.
  std::set<std::string> names;
  for (const TriageEntry& entry : entries) {
    if (entry.trial_id.empty()) continue;
    const auto trial = store.Find(entry.trial_id);
    if (trial && !trial->campaign.empty()) names.insert(trial->campaign);
  }
  std::vector<CampaignWord> out;
  for (const std::string& name : names) {
    const auto trials = store.Trials({.campaign = name});
    std::vector<std::size_t> members(trials.size());
    std::iota(members.begin(), members.end(), std::size_t{0});
    const report::CampaignChecks checks =
        report::CheckCampaign(members, trials);
    out.push_back({name, checks.Failed(),
                   checks.Failed() ? checks.explanation
                                   : report::WhatChecksShow(checks) + "."});
  }
  return out;
}

std::string TriageJson(std::span<const TriageEntry> entries,
                       std::span<const CampaignWord> campaigns) {
  const TriageCounts counts = Count(entries);
  ordered_json document;
  document["schema"] = "touchdown.batch/1";
  document["counts"] = {
      {"clips", entries.size()}, {"logged", counts.logged},
      {"known", counts.known},   {"copies", counts.copies},
      {"failed", counts.failed}, {"to_look_at", counts.to_look_at}};
  document["clips"] = ordered_json::array();
  for (const auto& entry : entries) {
    ordered_json one;
    one["clip"] = entry.clip;
    one["done"] = Name(entry.done);
    // A field that does not apply is null; it is not left out.
    one["attention"] = entry.attention == Attention::kNone
                           ? ordered_json()
                           : ordered_json(Name(entry.attention));
    one["reason"] =
        entry.reason.empty() ? ordered_json() : ordered_json(entry.reason);
    one["trial"] =
        entry.trial_id.empty() ? ordered_json() : ordered_json(entry.trial_id);
    one["revision"] =
        entry.revision == 0 ? ordered_json() : ordered_json(entry.revision);
    one["state"] =
        entry.state ? ordered_json(core::Name(*entry.state)) : ordered_json();
    one["p_bounce"] =
        entry.p_bounce ? ordered_json(*entry.p_bounce) : ordered_json();
    one["angle_kind"] = entry.angle_kind
                            ? ordered_json(core::Name(*entry.angle_kind))
                            : ordered_json();
    if (entry.angle_rad) {
      one["angle_deg"] = {{"value", entry.angle_rad->value / kDegree},
                          {"u", entry.angle_rad->u / kDegree}};
    } else {
      one["angle_deg"] = ordered_json();
      one["absent"] = {{"angle_deg", entry.angle_rad.error().reason}};
    }
    document["clips"].push_back(std::move(one));
  }
  document["campaigns"] = ordered_json::array();
  for (const CampaignWord& word : campaigns) {
    document["campaigns"].push_back({{"campaign", word.campaign},
                                     {"checks_failed", word.failed},
                                     {"checks", word.sentence}});
  }
  // A file's name need not be UTF-8.
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

std::string TriageCsv(std::span<const TriageEntry> entries) {
  // One row a clip, in the order given. An absent value is an empty cell.
  // CsvCell guards against formulas in names and reasons.
  std::string csv =
      "clip,done,attention,reason,trial,revision,state,p_bounce,angle_kind,"
      "angle_deg,angle_u_deg\r\n";
  for (const auto& entry : entries) {
    csv += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{}\r\n", report::CsvCell(entry.clip),
        Name(entry.done),
        entry.attention == Attention::kNone ? "" : Name(entry.attention),
        report::CsvCell(entry.reason), entry.trial_id,
        entry.revision == 0 ? "" : fmt::format("{}", entry.revision),
        entry.state ? core::Name(*entry.state) : "",
        entry.p_bounce ? fmt::format("{}", *entry.p_bounce) : "",
        entry.angle_kind ? core::Name(*entry.angle_kind) : "",
        entry.angle_rad ? fmt::format("{}", entry.angle_rad->value / kDegree)
                        : "",
        entry.angle_rad ? fmt::format("{}", entry.angle_rad->u / kDegree) : "");
  }
  return csv;
}

}  // namespace touchdown::pipeline
