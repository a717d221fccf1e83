#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "campaigns.h"
#include "evidence.h"
#include "plan_rows.h"
#include "register_rows.h"
#include "rows.h"
#include "statement.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::db {
namespace {

using core::StoreError;

class Restorer {
 public:
  Restorer(Store& into, std::string_view source)
      : store_(into), connection_(into.connection()), source_(source) {}

  void AddCampaign(core::Campaign campaign) {
    RequireStorable(campaign);
    const std::string name = campaign.name;
    if (const auto here = SelectCampaign(connection_, name)) {
      if (SameConventions(*here, campaign)) return;
      campaign.name = fmt::format("{} ({})", name, source_.substr(0, 8));
      renamed_[name] = campaign.name;
      report_.conflicts.push_back(fmt::format(
          "campaign '{}' has other conventions there: its trials are here in "
          "campaign '{}'",
          name, campaign.name));
      if (const auto again = SelectCampaign(connection_, campaign.name)) {
        if (SameConventions(*again, campaign)) return;
        throw StoreError(fmt::format(
            "{}: campaign '{}' is here already with other conventions; nothing "
            "was merged",
            store_.path().string(), campaign.name));
      }
    }
    InsertCampaign(connection_, campaign, store_.sources().new_uuid(),
                   store_.sources().now_utc());
    ++report_.campaigns_added;
  }

  void Add(const std::vector<Revision>& history) {
    if (history.empty()) return;
    std::vector<const Revision*> unknown;
    for (const auto& revision : history) {
      RequireSound(revision, history.front());
      if (Known(revision.id)) {
        ++report_.revisions_known;
      } else {
        unknown.push_back(&revision);
      }
    }
    if (unknown.empty()) return;
    const TrialRow row = KeepTrial(history);
    const auto before = FindHead(connection_, row.row);
    // Theirs only goes on from ours: then theirs is in force, as it was there.
    // Proposals are never in force, and there is nothing to settle about them.
    const auto theirs =
        std::find_if(unknown.rbegin(), unknown.rend(), [](const Revision* one) {
          return one->kind != RevisionKind::kProposed;
        });
    const bool goes_on =
        !before || theirs == unknown.rend() ||
        (!HasOthers(row.row, history) && *theirs == &RevisionInForce(history));
    for (const Revision* revision : unknown) Append(row, *revision);
    if (!goes_on) Settle(row, *before, **theirs);
  }

  // Looks at a campaign there were looks at its trials, which are here now.
  void AddPlan(PlanEvent event) {
    const auto name = renamed_.find(event.campaign);
    if (name != renamed_.end()) event.campaign = name->second;
    if (InsertPlanEvent(connection_, event)) ++report_.plan_events_added;
  }

  // All of the other side's, in the order of AllVersions.
  void AddRegister(std::span<const Entry> entries) {
    std::map<std::pair<RegisterKind, std::string>, Diverged> names;
    for (const Entry& entry : entries) {
      RequireSound(entry);
      Diverged& name = names[{entry.kind, entry.name}];
      name.there = &entry;
      if (!name.here) name.here = InForce(connection_, entry.kind, entry.name);
      if (name.here && name.here->id == entry.id) name.goes_on = true;
      if (HasVersion(connection_, entry.kind, entry.id)) continue;
      name.added = true;
      InsertEntry(connection_, entry);
      ++report_.register_versions_added;
    }
    for (const auto& [key, name] : names) {
      if (!name.added || !name.here || name.goes_on) continue;
      if (Changes(*name.here, *name.there).empty()) continue;
      const auto now = InForce(connection_, key.first, key.second);
      report_.conflicts.push_back(fmt::format(
          "{} '{}' is described here by {} at {} and there by {} at {}; both "
          "are kept, the one {} is in force",
          Name(key.first), key.second, name.here->author,
          name.here->recorded_at_utc, name.there->author,
          name.there->recorded_at_utc,
          now && now->id == name.here->id ? "here" : "there"));
    }
  }

  MergeReport Done() { return std::move(report_); }

 private:
  // One name of the register, as both sides have it.
  struct Diverged {
    std::optional<Entry> here;     // in force before
    const Entry* there = nullptr;  // the last of the other side
    bool goes_on = false;          // the other side knew what is in force here
    bool added = false;
  };

  void RequireSound(const Entry& entry) const {
    RequireStorable(entry);
    if (!IsUuid(entry.id) || !IsUtcStamp(entry.recorded_at_utc) ||
        entry.version < 1) {
      throw std::invalid_argument(fmt::format(
          "{} '{}' has the id '{}', version {} and date '{}', must have a UUID "
          "in lower case, a number from 1 and a date like "
          "2026-08-01T09:30:00.125Z",
          Name(entry.kind), entry.name, entry.id, entry.version,
          entry.recorded_at_utc));
    }
  }

  bool Known(std::string_view uuid) {
    Statement row(connection_, "SELECT 1 FROM revisions WHERE uuid = ?");
    row.Add(uuid);
    return row.Step();
  }

  void RequireSound(const Revision& revision, const Revision& first) const {
    RequireStorable(revision.trial);
    if (!IsUuid(revision.id) || !IsUuid(revision.trial.id)) {
      throw std::invalid_argument(fmt::format(
          "id of a revision is '{}' and of its trial '{}', must be UUIDs in "
          "lower case",
          revision.id, revision.trial.id));
    }
    if (!IsUtcStamp(revision.trial.recorded_at_utc)) {
      throw std::invalid_argument(
          fmt::format("recorded_at_utc of revision {} is '{}', must be like "
                      "2026-08-01T09:30:00.125Z",
                      revision.id, revision.trial.recorded_at_utc));
    }
    if (revision.trial.id != first.trial.id ||
        revision.trial.campaign != first.trial.campaign ||
        revision.trial.origin != first.trial.origin) {
      throw std::invalid_argument(fmt::format(
          "revision {} has another trial, campaign or origin than the first of "
          "its trial: those never change",
          revision.id));
    }
  }

  core::Trial Renamed(const core::Trial& trial) const {
    core::Trial renamed = trial;
    const auto name = renamed_.find(trial.campaign);
    if (name != renamed_.end()) renamed.campaign = name->second;
    return renamed;
  }

  TrialRow KeepTrial(const std::vector<Revision>& history) {
    const core::Trial first = Renamed(history.front().trial);
    const auto campaign = FindCampaignRow(connection_, first);
    const auto clip =
        KeepClip(connection_, first.clip, history.back().trial.recorded_at_utc,
                 Told::kElsewhere);
    auto row = FindTrial(connection_, first.id);
    if (!row && clip) {
      row = FindTrialOfClip(connection_, campaign, *clip);
      if (row) {
        report_.conflicts.push_back(fmt::format(
            "clip {} of campaign '{}' is trial {} there and {} here: what was "
            "said there was added to the trial here",
            first.clip.path, first.campaign, first.id, row->uuid));
      }
    }
    if (row && row->origin != core::Name(first.origin)) {
      throw StoreError(fmt::format(
          "{}: trial {} is {} here and {} there, and origins are never pooled; "
          "nothing was merged",
          store_.path().string(), row->uuid, row->origin,
          core::Name(first.origin)));
    }
    if (row) return *row;
    ++report_.trials_added;
    return AddTrial(connection_, first.id, campaign, first.origin, clip,
                    first.recorded_at_utc);
  }

  // True if the trial has revisions here, other than proposals, that the other
  // side does not know.
  bool HasOthers(std::int64_t trial_row, const std::vector<Revision>& history) {
    std::set<std::string_view> theirs;
    for (const auto& revision : history) theirs.insert(revision.id);
    Statement row(connection_,
                  "SELECT uuid FROM revisions WHERE trial_id = ? AND kind <> "
                  "'proposed'");
    row.Add(trial_row);
    while (row.Step()) {
      if (!theirs.contains(row.TakeText())) return true;
    }
    return false;
  }

  void Append(const TrialRow& row, const Revision& revision) {
    const auto head = FindHead(connection_, row.row);
    const core::Trial& trial = revision.trial;
    NewRevision added;
    added.uuid = revision.id;
    added.kind = revision.kind;
    added.recorded_at_utc = trial.recorded_at_utc;
    // Every revision from elsewhere states itself whole, so that it means here
    // what it meant there, whatever it lands on. An exclusion that already is
    // in force is not made twice.
    added.own_exclusion =
        !(head && head->exclusion_id && trial.excluded &&
          ExclusionReason(*head->exclusion_id) == trial.exclusion_reason);
    AddRevision(connection_, row.row, head, added, trial);
    ++report_.revisions_added;
  }

  std::string ExclusionReason(std::int64_t revision_row) {
    Statement row(connection_,
                  "SELECT reason FROM exclusions WHERE revision_id = ?");
    row.Add(revision_row);
    return row.Step() ? row.TakeText() : std::string();
  }

  // Both sides revised the trial: the statement recorded later is in force, and
  // a last revision says so, the same in whichever store it is made.
  void Settle(const TrialRow& row, const Head& ours, const Revision& theirs) {
    const auto history = ReadHistory(connection_, row.uuid);
    const Revision& mine =
        history.at(static_cast<std::size_t>(ours.number - 1));
    const auto age = [](const Revision& revision) {
      return std::pair(revision.trial.recorded_at_utc, revision.id);
    };
    const bool ours_later = age(mine) > age(theirs);
    report_.conflicts.push_back(fmt::format(
        "trial {}: revised here by {} at {} and there by {} at {}; both are "
        "kept, the one {} is in force",
        row.uuid, mine.trial.author, mine.trial.recorded_at_utc,
        theirs.trial.author, theirs.trial.recorded_at_utc,
        ours_later ? "here" : "there"));
    Revision settled = ours_later ? mine : theirs;
    settled.id = UuidOfPair(ours.uuid, theirs.id);
    settled.kind = RevisionKind::kMerged;
    settled.trial.reason = fmt::format(
        "two stores had diverged; the revision of {} is the later one and "
        "stays in force",
        settled.trial.recorded_at_utc);
    if (!Known(settled.id)) Append(row, settled);
  }

  Store& store_;
  Connection& connection_;
  std::string source_;
  std::map<std::string, std::string> renamed_;
  MergeReport report_;
};

}  // namespace

MergeReport Restore(Store& into, std::string_view source,
                    std::span<const Entry> entries,
                    std::span<const core::Campaign> campaigns,
                    std::span<const PlanEvent> plan, const NextHistory& next) {
  Transaction transaction(into.connection(), Transaction::Kind::kWrite);
  Restorer restorer(into, source);
  restorer.AddRegister(entries);
  for (const auto& campaign : campaigns) restorer.AddCampaign(campaign);
  while (const auto history = next()) restorer.Add(*history);
  for (const PlanEvent& event : plan) restorer.AddPlan(event);
  transaction.Commit();
  return restorer.Done();
}

MergeReport Merge(Store& into, const Store& from) {
  if (into.uuid() == from.uuid() &&
      std::filesystem::equivalent(into.path(), from.path())) {
    throw std::invalid_argument(
        fmt::format("{} is to be merged into itself, must be another store",
                    from.path().string()));
  }
  Transaction snapshot(from.connection(), Transaction::Kind::kRead);
  Transaction transaction(into.connection(), Transaction::Kind::kWrite);
  Restorer restorer(into, from.uuid());
  restorer.AddRegister(ReadVersions(from.connection()));
  for (const auto& campaign : from.Campaigns()) restorer.AddCampaign(campaign);
  VisitHistories(from.connection(), [&](const std::vector<Revision>& history) {
    restorer.Add(history);
  });
  for (PlanEvent& event : ReadPlanEvents(from.connection(), "")) {
    restorer.AddPlan(std::move(event));
  }
  transaction.Commit();
  return restorer.Done();
}

}  // namespace touchdown::db
