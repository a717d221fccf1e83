#include "touchdown/db/maintenance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "tests/db/fixture.h"
#include "tests/support/random_trials.h"
#include "touchdown/core/errors.h"

namespace touchdown::db {
namespace {

using core::StoreError;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A hand in the file behind the store's back; returns SQLite's message.
std::string Tamper(const std::filesystem::path& path, const std::string& sql) {
  sqlite3* handle = nullptr;
  sqlite3_open(path.c_str(), &handle);
  char* text = nullptr;
  sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, &text);
  const std::string message = text == nullptr ? "" : text;
  sqlite3_free(text);
  sqlite3_close(handle);
  return message;
}

// A store with two trials, three revisions, an exclusion and a budget.
std::string Fill(Store& store) {
  store.AddCampaign(SphereCampaign());
  core::Trial trial = SphereTrial(1);
  trial.first.contact.approach_budget = {{"ground", 0.001}};
  const std::string id = store.LogTrial(trial).id;
  store.LogTrial(SphereTrial(1));
  store.LogTrial(SphereTrial(2));
  store.Exclude(id, "Ada", "lamp");
  return id;
}

TEST(AppendOnly, NoOrdinaryStatementChangesOrRemovesEvidence) {
  Folder folder;
  const auto path = folder / "lab.db";
  {
    Store store = OpenFixed(path);
    Fill(store);
  }
  Tamper(path,
         "INSERT INTO conditions (revision_id, anomaly, anomaly_note, "
         "temperature_k_absent, relative_humidity_absent) VALUES (1, "
         "'none', '', 'not read', 'not read')");
  for (const std::string table :
       {"trials", "revisions", "statements", "contacts", "budget_lines",
        "exclusions", "conditions"}) {
    SCOPED_TRACE(table);
    EXPECT_THAT(Tamper(path, "DELETE FROM " + table), HasSubstr("append-only"));
    const std::string column = table == "trials"      ? "uuid"
                               : table == "revisions" ? "author"
                                                      : "revision_id";
    EXPECT_THAT(
        Tamper(path, "UPDATE " + table + " SET " + column + " = " + column),
        HasSubstr("append-only"));
    // REPLACE deletes without firing DELETE triggers unless told to.
    EXPECT_NE(Tamper(path, "INSERT OR REPLACE INTO " + table +
                               " SELECT * FROM " + table),
              "");
  }
  // Nor by the row's hidden number, nor what evidence leans on.
  EXPECT_THAT(Tamper(path,
                     "REPLACE INTO contacts (rowid, revision_id, ordinal, "
                     "found, not_found_because, from_start, state, "
                     "state_because, micro_bounce) SELECT 1, revision_id, "
                     "ordinal + 1, found, '', 0, state, '', 0 FROM contacts"),
              HasSubstr("append-only"));
  for (const std::string table : {"clips", "campaigns"}) {
    EXPECT_THAT(
        Tamper(path, "REPLACE INTO " + table + " SELECT * FROM " + table),
        HasSubstr("kept"));
  }
  EXPECT_THAT(Tamper(path,
                     "UPDATE clips SET sha256 = 'x' WHERE id = 1; "
                     "UPDATE clips SET sha256 = 'y' WHERE id = 1"),
              HasSubstr("keeps its digest"));
  EXPECT_THAT(Tamper(path, "UPDATE campaigns SET margin_rad = 1.0"),
              HasSubstr("keeps its conventions"));
  EXPECT_THAT(Tamper(path, "DELETE FROM campaigns"), HasSubstr("kept"));
  const Store store = Store::Open(path, OpenMode::kRead);
  // What could be added, the conditions and a clip's SHA-256, is found.
  EXPECT_THAT(Check(store).problems,
              ElementsAre(AllOf(HasSubstr("trial"),
                                HasSubstr("is not what was recorded")),
                          HasSubstr("clip clip-1 is not in the chain")));
  EXPECT_EQ(store.Trials().size(), 2u);
}

TEST(Check, CountsAndFindsNothingInASoundStore) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  Fill(store);
  const CheckReport report = Check(store);
  EXPECT_THAT(report.problems, IsEmpty());
  EXPECT_EQ(report.campaigns, 1);
  EXPECT_EQ(report.trials, 2);
  EXPECT_EQ(report.revisions, 4);
  EXPECT_EQ(report.clips_without_digest, 2);
}

TEST(Check, FindsWhatAHandBehindItsBackDid) {
  const auto problems = [](const std::string& sql) {
    Folder folder;
    const auto path = folder / "lab.db";
    {
      Store store = OpenFixed(path);
      Fill(store);
    }
    EXPECT_EQ(Tamper(path, "PRAGMA foreign_keys = OFF; " + sql), "");
    return Check(Store::Open(path, OpenMode::kRead)).problems;
  };
  const std::string drop_contacts = "DROP TRIGGER contacts_refuse_DELETE; ";
  EXPECT_THAT(problems(drop_contacts),
              ElementsAre(HasSubstr("contacts_refuse_DELETE is missing")));
  EXPECT_THAT(
      problems(drop_contacts + "DELETE FROM contacts WHERE revision_id = 3"),
      Contains(HasSubstr("should hold 1 contacts, but holds 0")));
  EXPECT_THAT(problems("DROP TRIGGER revisions_refuse_DELETE; "
                       "DELETE FROM revisions WHERE id = 1"),
              Contains(HasSubstr("not numbered 1 to")));
  EXPECT_THAT(problems("DROP TRIGGER revisions_refuse_DELETE; "
                       "DELETE FROM revisions WHERE id = 3"),
              Contains(HasSubstr("has no revision")));
  EXPECT_THAT(problems("DROP TRIGGER revisions_refuse_UPDATE; "
                       "UPDATE revisions SET statement_id = 3 WHERE id = 1"),
              Contains(HasSubstr("belongs to another trial")));
}

TEST(Check, ComparesClipsWithTheirDigests) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  for (int i = 0; i < 4; ++i) {
    core::Trial trial = SphereTrial(i, "");
    if (i < 3) trial.clip.sha256 = std::string(64, static_cast<char>('a' + i));
    store.LogTrial(trial);
  }
  const CheckReport report =
      Check(store, [](const auto& path) -> std::optional<std::string> {
        if (path == "/lab/clips/0.mraw") return std::string(64, 'a');
        if (path == "/lab/clips/1.mraw") return std::string(64, 'f');
        return std::nullopt;
      });
  EXPECT_EQ(report.clips_verified, 1);
  EXPECT_THAT(report.clips_changed, ElementsAre("/lab/clips/1.mraw"));
  EXPECT_THAT(report.clips_missing, ElementsAre("/lab/clips/2.mraw"));
  EXPECT_EQ(report.clips_without_digest, 1);
}

TEST(Check, ReportsADamagedFile) {
  Folder folder;
  const auto path = folder / "lab.db";
  {
    Store store = OpenFixed(path);
    for (int i = 0; i < 50; ++i) store.LogTrial(SphereTrial(i, ""));
  }
  const auto size = std::filesystem::file_size(path);
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  // The middle: tables, not the header nor the schema.
  file.seekp(static_cast<std::streamoff>(size * 3 / 4));
  file << std::string(8192, '\x55');
  file.close();
  try {
    EXPECT_FALSE(Check(Store::Open(path, OpenMode::kRead)).problems.empty());
  } catch (const StoreError& error) {
    EXPECT_THAT(error.what(), HasSubstr("damaged"));
  }
}

TEST(Backup, IsTheSameStoreInOneFile) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  Fill(store);
  Backup(store, folder / "copy.db");
  {
    const Store copy = Store::Open(folder / "copy.db", OpenMode::kRead);
    EXPECT_THAT(Check(copy).problems, IsEmpty());
    EXPECT_EQ(copy.Trials().size(), 2u);
    EXPECT_EQ(copy.uuid(), store.uuid());
  }
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("lab.db")) names.insert(name);
  }
  EXPECT_THAT(names, ElementsAre("copy.db"));
  EXPECT_THROW(Backup(store, folder / "copy.db"), StoreError);
  EXPECT_THROW(Backup(store, folder / "no/copy.db"), StoreError);
}

// What a store says, without the order in which merges brought it in.
std::set<std::string> Sayings(const Store& store) {
  std::set<std::string> sayings;
  store.ForEachHistory([&sayings](const std::vector<Revision>& history) {
    for (const auto& revision : history) {
      sayings.insert(revision.trial.id + revision.id +
                     std::string(Name(revision.kind)) + revision.trial.author +
                     revision.trial.reason + revision.trial.recorded_at_utc +
                     std::string(core::Name(revision.trial.first.state.label)));
    }
  });
  return sayings;
}

TEST(Merge, AddsEverythingOnceAndCanBeRepeated) {
  Folder folder;
  Store a = OpenFixed(folder / "a.db", 1);
  Store b = OpenFixed(folder / "b.db", 2);
  Fill(a);
  b.AddCampaign(SphereCampaign());
  testing::RandomTrials random(3);
  for (int i = 0; i < 50; ++i) b.LogTrial(random.Trial());
  const std::string id = b.LogTrial(SphereTrial(7)).id;
  b.Exclude(id, "Bob", "dust");
  const MergeReport report = Merge(a, b);
  EXPECT_EQ(report.trials_added, 51);
  EXPECT_EQ(report.revisions_added, 52);
  EXPECT_EQ(report.campaigns_added, 0);
  EXPECT_THAT(report.conflicts, IsEmpty());
  EXPECT_TRUE(a.Find(id)->excluded);
  EXPECT_EQ(a.Find(id)->exclusion_reason, "dust");
  EXPECT_EQ(a.Trials().size(), 53u);
  EXPECT_TRUE(std::ranges::includes(Sayings(a), Sayings(b)));
  const auto before = Sayings(a);
  const MergeReport again = Merge(a, b);
  EXPECT_EQ(again.revisions_added, 0);
  EXPECT_EQ(again.revisions_known, 52);
  EXPECT_EQ(Sayings(a), before);
  EXPECT_THAT(Check(a).problems, IsEmpty());
  // Statements arrive bit for bit.
  const auto theirs = b.History(id);
  const auto ours = a.History(id);
  ASSERT_EQ(theirs.size(), ours.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_THAT(Changes(theirs[i].trial, ours[i].trial), IsEmpty());
  }
}

// Property: however two diverged stores are merged into each other, both end
// with the same sayings and the same statement in force: the later one.
TEST(Merge, DivergedStoresAgreeWhicheverIsMergedFirst) {
  for (int order = 0; order < 4; ++order) {
    SCOPED_TRACE(order);
    Folder folder;
    std::string id;
    {
      Store a = OpenFixed(folder / "a.db", 1);
      id = Fill(a);
      Backup(a, folder / "b.db");
    }
    Store a = OpenFixed(folder / "a.db", 10);
    Store b = OpenFixed(folder / "b.db", 20);
    // The clocks: order 0 and 1 make the correction in a the later one.
    const auto correct = [&id](Store& store, const std::string& who, int wait) {
      for (int i = 0; i < wait; ++i) store.sources().now_utc();
      core::Trial trial = *store.Find(id);
      trial.first.state.label =
          who == "Ada" ? core::MotionState::kRoll : core::MotionState::kStick;
      store.Correct(trial, who, "seen");
    };
    correct(a, "Ada", order < 2 ? 600 : 300);
    correct(b, "Bob", order < 2 ? 300 : 600);
    MergeReport report;
    if (order % 2 == 0) {
      report = Merge(a, b);
      Merge(b, a);
    } else {
      report = Merge(b, a);
      Merge(a, b);
    }
    ASSERT_EQ(report.conflicts.size(), 1u);
    EXPECT_THAT(report.conflicts[0], HasSubstr("both are kept"));
    EXPECT_EQ(Merge(a, b).revisions_added, 0);
    EXPECT_EQ(Merge(b, a).revisions_added, 0);
    EXPECT_EQ(Sayings(a), Sayings(b));
    const auto later =
        order < 2 ? core::MotionState::kRoll : core::MotionState::kStick;
    EXPECT_EQ(a.Find(id)->first.state.label, later);
    EXPECT_EQ(b.Find(id)->first.state.label, later);
    EXPECT_THAT(Check(a).problems, IsEmpty());
    EXPECT_THAT(Check(b).problems, IsEmpty());
  }
}

// A proposal comes along, is in force nowhere, and makes no conflict.
TEST(Merge, ProposalsStayProposals) {
  Folder folder;
  std::string id;
  {
    Store a = OpenFixed(folder / "a.db", 1);
    id = Fill(a);
    core::Trial trial = *a.Find(id);
    trial.first.state.label = core::MotionState::kRoll;
    a.Correct(trial, "Ada", "seen");
    Backup(a, folder / "b.db");
  }
  Store a = OpenFixed(folder / "a.db", 10);
  Store b = OpenFixed(folder / "b.db", 20);
  core::Trial analysed = *a.Find(id);
  analysed.first.state.label = core::MotionState::kStick;
  analysed.document_json = "{}";
  ASSERT_TRUE(a.LogTrial(analysed).is_proposal);
  const MergeReport report = Merge(b, a);
  EXPECT_EQ(report.revisions_added, 1);
  EXPECT_THAT(report.conflicts, IsEmpty());
  EXPECT_EQ(b.Find(id)->first.state.label, core::MotionState::kRoll);
  ASSERT_EQ(b.Proposals().size(), 1u);
  EXPECT_EQ(b.Proposals()[0].first.state.label, core::MotionState::kStick);
  EXPECT_EQ(Sayings(a), Sayings(b));
  // A correction elsewhere goes on from what is in force.
  core::Trial trial = *b.Find(id);
  trial.first.state.label = core::MotionState::kBounce;
  b.Correct(trial, "Bob", "seen again");
  EXPECT_THAT(Merge(a, b).conflicts, IsEmpty());
  EXPECT_EQ(a.Find(id)->first.state.label, core::MotionState::kBounce);
  EXPECT_THAT(a.Proposals(), IsEmpty());
  EXPECT_EQ(Sayings(a), Sayings(b));
  EXPECT_THAT(Check(a).problems, IsEmpty());
}

TEST(Merge, ListsWhatTheTwoSayDifferentlyAndDropsNothing) {
  Folder folder;
  Store a = OpenFixed(folder / "a.db", 1);
  Store b = OpenFixed(folder / "b.db", 2);
  a.AddCampaign(SphereCampaign());
  core::Campaign other = SphereCampaign();
  other.bounce_height_m = 0.002;
  b.AddCampaign(other);
  const std::string here = a.LogTrial(SphereTrial(1)).id;
  b.LogTrial(SphereTrial(1));
  // The same clip, in no campaign, in both.
  const std::string mine = a.LogTrial(SphereTrial(9, "")).id;
  core::Trial nine = SphereTrial(9, "");
  nine.first.state.label = core::MotionState::kUndecided;
  const std::string theirs = b.LogTrial(nine).id;
  const MergeReport report = Merge(a, b);
  const std::string renamed = "asphalt (" + b.uuid().substr(0, 8) + ")";
  EXPECT_THAT(report.conflicts,
              ElementsAre(HasSubstr("are here in"), HasSubstr("added to the"),
                          HasSubstr("both are kept")));
  EXPECT_EQ(a.FindCampaign(renamed)->bounce_height_m, 0.002);
  EXPECT_EQ(a.Trials({.campaign = renamed}).size(), 1u);
  EXPECT_EQ(a.Trials({.campaign = "asphalt"}).size(), 1u);
  EXPECT_EQ(a.History(mine).size(), 3u);  // both, and which one is in force
  EXPECT_TRUE(a.History(theirs).empty());
  EXPECT_EQ(Merge(a, b).revisions_added, 0);
  EXPECT_EQ(a.Find(here)->revision, 1);
  EXPECT_THROW(Merge(a, a), std::invalid_argument);
}

TEST(Migrate, LeavesACurrentStoreAndRefusesANewerOne) {
  Folder folder;
  const auto path = folder / "lab.db";
  {
    Store store = OpenFixed(path);
    Fill(store);
  }
  const Migration none = Migrate(path);
  EXPECT_EQ(none.from_version, none.to_version);
  EXPECT_EQ(Tamper(path, "PRAGMA user_version = 99"), "");
  for (const auto mode : {OpenMode::kRead, OpenMode::kCreate}) {
    try {
      Store::Open(path, mode);
      ADD_FAILURE() << "opened a newer store";
    } catch (const StoreError& error) {
      EXPECT_THAT(error.what(), HasSubstr("has version 99"));
      EXPECT_THAT(error.what(), HasSubstr("use the touchdown that made it"));
    }
  }
  EXPECT_THROW(Migrate(path), StoreError);
  EXPECT_THROW(Migrate(folder / "none.db"), StoreError);
}

}  // namespace
}  // namespace touchdown::db
