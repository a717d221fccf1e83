#include "old_digests.h"

#include <fmt/format.h>

#include <string_view>

#include "chain.h"
#include "register_rows.h"

namespace touchdown::db {
namespace {

// Of a revision's digest; ?1 is the revision's row.
const std::vector<DigestPart>& Parts() {
  static const std::vector<DigestPart> parts = [] {
    const std::string of_trial =
        "FROM revisions r JOIN trials t ON t.id = r.trial_id ";
    std::vector<DigestPart> all = {
        {"trial", "SELECT t.* " + of_trial + "WHERE r.id = ?1"},
        {"campaign", "SELECT c.* " + of_trial +
                         "JOIN campaigns c ON c.id = t.campaign_id "
                         "WHERE r.id = ?1"},
        {"surface", "SELECT s.* " + of_trial +
                        "JOIN campaigns c ON c.id = t.campaign_id "
                        "JOIN surfaces s ON s.id = c.surface_id "
                        "WHERE r.id = ?1"},
        {"clip", "SELECT k.clip_id, k.size_bytes " + of_trial +
                     "JOIN clips k ON k.id = t.clip_id WHERE r.id = ?1"},
        {"revision", "SELECT * FROM revisions WHERE id = ?1"},
        {"statement", "SELECT * FROM statements WHERE revision_id = ?1"},
        {"contact",
         "SELECT * FROM contacts WHERE revision_id = ?1 ORDER BY ordinal"},
        {"budget line",
         "SELECT * FROM budget_lines WHERE revision_id = ?1 "
         "ORDER BY ordinal, budget, line"},
        {"exclusion", "SELECT * FROM exclusions WHERE revision_id = ?1"},
        {"conditions", "SELECT * FROM conditions WHERE revision_id = ?1"},
    };
    for (const auto& entry : kConditionEntries) {
      const std::string word(Name(entry.kind));
      all.push_back({word, fmt::format("SELECT e.* FROM conditions c JOIN {} e "
                                       "ON e.id = c.{}_id "
                                       "WHERE c.revision_id = ?1",
                                       TableOf(entry.kind).table, word)});
    }
    return all;
  }();
  return parts;
}

std::string RevisionDigest(Connection& connection, std::string_view before,
                           std::int64_t revision_row) {
  std::string text = fmt::format("touchdown.trial/1\n{}\n", before);
  for (const DigestPart& part : Parts()) {
    Statement row(connection, part.sql);
    row.Add(revision_row);
    while (row.Step()) {
      text += part.word + '\n';
      row.AppendRow(text);
    }
  }
  return Sha256(text);
}

std::string ClipDigestOf(Connection& connection, std::int64_t clip_row) {
  std::string text = "touchdown.clip/1\n";
  Statement row(connection,
                "SELECT clip_id, size_bytes, sha256 FROM clips WHERE id = ?");
  row.Add(clip_row);
  if (row.Step()) row.AppendRow(text);
  return Sha256(text);
}

std::string PlanDigestOf(Connection& connection, std::string_view before,
                         std::int64_t event_row) {
  std::string text = fmt::format("touchdown.plan/1\n{}\n", before);
  Statement row(connection, "SELECT * FROM plan_events WHERE id = ?");
  row.Add(event_row);
  if (row.Step()) row.AppendRow(text);
  return Sha256(text);
}

void CheckPlanDigests(Connection& connection,
                      std::vector<std::string>& problems) {
  Statement campaign(connection,
                     "SELECT c.id, c.name, ifnull(d.events, 0), "
                     "ifnull(d.sha256, '') FROM campaigns c "
                     "LEFT JOIN plan_digests d ON d.campaign_id = c.id "
                     "ORDER BY c.id");
  while (campaign.Step()) {
    const std::int64_t id = campaign.TakeInteger();
    const std::string name = campaign.TakeText();
    const std::int64_t events = campaign.TakeInteger();
    const std::string kept = campaign.TakeText();
    std::string digest;
    std::int64_t count = 0;
    Statement event(connection,
                    "SELECT id FROM plan_events WHERE campaign_id = ? "
                    "ORDER BY id");
    event.Add(id);
    for (; event.Step(); ++count) {
      digest = PlanDigestOf(connection, digest, event.TakeInteger());
    }
    if (events != count) {
      problems.push_back(fmt::format(
          "the plan of campaign '{}' has {} entries, but its digest is of {}: "
          "one was added or removed by another program",
          name, count, events));
    } else if (digest != kept) {
      problems.push_back(
          fmt::format("the plan of campaign '{}' is not what was recorded: its "
                      "digest does not agree",
                      name));
    }
  }
}

}  // namespace

void CheckOldDigests(Connection& connection, std::int64_t version,
                     std::vector<std::string>& problems) {
  if (version < 5) return;
  if (version >= 7) CheckPlanDigests(connection, problems);
  Statement trial(connection,
                  "SELECT t.id, t.uuid, ifnull(d.revisions, 0), "
                  "ifnull(d.sha256, '') FROM trials t "
                  "LEFT JOIN digests d ON d.trial_id = t.id ORDER BY t.id");
  while (trial.Step()) {
    const std::int64_t id = trial.TakeInteger();
    const std::string uuid = trial.TakeText();
    const std::int64_t revisions = trial.TakeInteger();
    const std::string kept = trial.TakeText();
    std::string digest;
    std::int64_t count = 0;
    Statement revision(connection,
                       "SELECT id FROM revisions WHERE trial_id = ? "
                       "ORDER BY number");
    revision.Add(id);
    for (; revision.Step(); ++count) {
      digest = RevisionDigest(connection, digest, revision.TakeInteger());
    }
    if (kept.empty()) {
      problems.push_back(fmt::format("trial {} has no digest", uuid));
    } else if (revisions != count) {
      problems.push_back(fmt::format(
          "trial {} has {} revisions, but its digest is of {}: one was added "
          "or removed by another program",
          uuid, count, revisions));
    } else if (digest != kept) {
      problems.push_back(fmt::format(
          "trial {} is not what was recorded: its digest does not agree",
          uuid));
    }
  }
  Statement clip(connection,
                 "SELECT k.id, k.clip_id, k.sha256 IS NOT NULL, "
                 "ifnull(d.sha256, '') FROM clips k "
                 "LEFT JOIN clip_digests d ON d.clip_id = k.id ORDER BY k.id");
  while (clip.Step()) {
    const std::int64_t id = clip.TakeInteger();
    const std::string name = clip.TakeText();
    const bool is_known = clip.TakeBool();
    const std::string kept = clip.TakeText();
    if (is_known ? kept != ClipDigestOf(connection, id) : !kept.empty()) {
      problems.push_back(fmt::format(
          "clip {} is not what was recorded: its digest does not agree", name));
    }
  }
}

}  // namespace touchdown::db
