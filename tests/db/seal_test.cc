// A seal finds whatever was altered since, also where every digest was made
// anew with this program's own code, and names the first row; a store that has
// only grown never fails it. TOUCHDOWN_LONG_TESTS=1 runs 500 forgeries and 500
// honest stores.
#include "touchdown/db/seal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "db/src/chain.h"
#include "db/src/schema_parts.h"
#include "tests/db/fixture.h"
#include "tests/db/forge.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"

namespace touchdown::db {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

SealHead HeadOnly(const Seal& seal) { return seal.head; }

// --- honest stores -----------------------------------------------------------

// One honest act on the store at `path`.
void Act(const fs::path& path, std::mt19937_64& random) {
  const std::uint64_t seed = random();
  Store store = OpenFixed(path, seed, OpenMode::kWrite);
  const auto trials = store.Trials();
  const core::Trial* const some =
      trials.empty() ? nullptr : &trials[random() % trials.size()];
  switch (random() % 10) {
    case 0: {  // a campaign that changes before its first trial
      core::Campaign campaign =
          SphereCampaign("campaign " + std::to_string(seed));
      store.AddCampaign(campaign);
      SetPlan(store, campaign.name, {"", "after 40 trials", ""}, "Ada", "");
      campaign.margin_rad *= 2.0;
      store.ChangeCampaign(campaign);
      break;
    }
    case 1: {
      Entry spring = NewEntry(RegisterKind::kSpring, "S 3");
      spring.author = "Ada";
      if (const auto there = FindEntry(store, RegisterKind::kSpring, "S 3")) {
        spring = *there;
        spring.reason = "measured again";
        spring.texts["note"] = std::to_string(seed);
        ChangeEntry(store, spring);
      } else {
        AddEntry(store, spring);
      }
      break;
    }
    case 2:
      RecordLook(store, SphereCampaign().name, "report");
      break;
    case 3:
      if (some != nullptr) {
        core::Trial corrected = *some;
        corrected.first.state.reason = std::to_string(seed);
        store.Correct(corrected, "Ada", "seen again");
      }
      break;
    case 4:
      if (some != nullptr && !some->excluded) store.Exclude(some->id, "A", "x");
      break;
    case 5:
      if (some != nullptr) {  // its digest, known later; seen elsewhere
        core::Trial again = *some;
        again.id.clear();
        again.clip.path = "/moved/" + again.clip.id;
        if (again.clip.sha256.empty()) again.clip.sha256 = std::string(64, 'e');
        again.document_json = R"({"replay": 1})";
        store.LogTrial(again);
      }
      break;
    case 6: {
      const fs::path other = path.string() + "." + std::to_string(seed);
      MakeStore(other, seed, 1);
      Merge(store, Store::Open(other, OpenMode::kRead));
      Remove(other);
      break;
    }
    default:
      store.LogTrial(SphereTrial(static_cast<int>(seed % 100'000)));
  }
}

TEST(Seal, AStoreThatOnlyGrewIsHonest) {
  std::mt19937_64 random(20261123);
  std::int64_t grown = 0;
  for (int round = 0; round < Rounds(12); ++round) {
    SCOPED_TRACE(round);
    Folder folder;
    const fs::path path = folder / "lab.db";
    MakeStore(path, random(), 1);
    std::vector<std::string> seals;
    for (int act = 0; act < 8; ++act) {
      seals.push_back(SealText(MakeSeal(Store::Open(path, OpenMode::kRead))));
      Act(path, random);
    }
    Backup(Store::Open(path, OpenMode::kRead), folder / "copy.db");
    ASSERT_TRUE(Sqlite(path).Run("VACUUM"));
    for (const char* name : {"lab.db", "copy.db"}) {
      const Store store = Store::Open(folder / name, OpenMode::kRead);
      EXPECT_THAT(Check(store).problems, IsEmpty());
      for (const std::string& text : seals) {
        const Seal seal = ParseSeal(text, "a seal");
        const SealCheck check = CheckStoreSeal(store, seal);
        EXPECT_EQ(check.problem, "");
        grown += check.links_since;
        EXPECT_EQ(CheckStoreSeal(store, {HeadOnly(seal), "", {}}).problem, "");
      }
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(grown, 0);
}

// What an upgrade of later versions does: columns are added, and are NULL.
TEST(Seal, OutlivesColumnsThatAreAdded) {
  Folder folder;
  const fs::path path = folder / "lab.db";
  MakeStore(path, 1, 3);
  const Seal seal = MakeSeal(Store::Open(path, OpenMode::kRead));
  for (const char* table : {"statements", "conditions", "trials", "contacts",
                            "revisions", "springs", "store"}) {
    ASSERT_TRUE(Sqlite(path).Run(std::string("ALTER TABLE ") + table +
                                 " ADD COLUMN later TEXT"));
  }
  EXPECT_EQ(CheckStoreSeal(Store::Open(path, OpenMode::kRead), seal).problem,
            "");
}

// --- forgeries ---------------------------------------------------------------

// All digests as this program would have made them, of what stands there now.
// Links of rows that are gone go; rows that are new come in after the first.
void MakeDigestsAnew(const fs::path& path) {
  Connection connection(path, Connection::Access::kWrite, 5.0);
  std::vector<Link> links;
  VisitLinks(connection, [&](const Link& link) { links.push_back(link); });
  std::erase_if(links, [&](const Link& link) {
    return RowDigest(connection, link.subject, link.key).empty();
  });
  std::vector<Link> added;
  {
    Statement row(connection,
                  "SELECT uuid FROM revisions WHERE uuid NOT IN (SELECT key "
                  "FROM chain)");
    while (row.Step()) added.push_back({0, "revision", row.TakeText(), "", ""});
  }
  links.insert(links.begin() + 1, added.begin(), added.end());
  connection.Execute(
      "DROP TRIGGER IF EXISTS chain_refuse_DELETE; DELETE FROM chain");
  for (const Link& link : links) KeepLink(connection, link.subject, link.key);
  connection.Execute(TriggerSql("chain_refuse_DELETE"));
}

// Without the guards, which are put back afterwards. False where nothing came
// of it.
bool Forge(const fs::path& path, const std::string& act) {
  Sqlite file(path);
  file.Run("PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON;");
  std::string triggers = *file.Text(
      "SELECT group_concat('DROP TRIGGER ' || name, ';') FROM sqlite_schema "
      "WHERE type = 'trigger'");
  triggers.resize(triggers.size() - 2);  // "|\n"
  EXPECT_TRUE(file.Run(triggers));
  const bool done = file.Run(act) && file.changes() > 0;
  EXPECT_TRUE(file.Run(TriggersSql()));
  return done;
}

// What stood there when it was sealed.
struct Sealed {
  std::string bytes;
  Seal seal;
  std::int64_t revisions = 0;
  std::map<std::string, std::int64_t> number;  // of the link of each key
};

// Of all kinds of rows; grown since.
Sealed MakeSealed(const fs::path& path) {
  Sealed sealed;
  MakeStore(path, 11, 6);
  {
    Store store = OpenFixed(path, 12, OpenMode::kWrite);
    for (const RegisterKind kind :
         {RegisterKind::kRig, RegisterKind::kSpring, RegisterKind::kOperator}) {
      Entry entry = NewEntry(kind, "E");
      entry.author = "Ada";
      AddEntry(store, entry);
    }
    core::Trial trial = SphereTrial(50);
    trial.conditions.emplace().spring.name = "E";
    trial.conditions->elevation_rad = core::Estimate{0.2, 0.003, std::nullopt};
    store.LogTrial(trial);
    SetPlan(store, "asphalt", {"", "after 40 trials", ""}, "Ada", "late");
    RecordLook(store, "asphalt", "report");
    sealed.seal = MakeSeal(store);
    for (const SealLine& line : sealed.seal.lines) {
      sealed.number[line.key] =
          static_cast<std::int64_t>(1 + sealed.number.size());
    }
    sealed.revisions =
        std::stoll(*Sqlite(path).Text("SELECT max(id) FROM revisions"));
    for (int i = 60; i < 63; ++i) store.LogTrial(SphereTrial(i));
  }
  Settle(path);
  sealed.bytes = Bytes(path);
  return sealed;
}

std::vector<std::string> Lines(const std::optional<std::string>& rows) {
  std::vector<std::string> lines;
  std::istringstream in(rows.value_or(""));
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line.substr(0, line.size() - 1));
  }
  return lines;
}

// A forgery of rows: what is done, and the keys of the links that it alters,
// one of which is the first.
struct Forgery {
  std::string kind;
  std::string act;
  std::set<std::string> keys;
};

Forgery ForgeryOfARow(Sqlite& file, const Sealed& sealed,
                      std::mt19937_64& random) {
  struct Table {
    std::string name;
    std::string condition;  // of rows that were sealed
    std::string keys;       // of the links that cover row `rowid`
  };
  const std::string old_revision =
      "revision_id <= " + std::to_string(sealed.revisions);
  const auto of_revision = [](const std::string& table) {
    return "SELECT uuid FROM revisions WHERE id = (SELECT revision_id FROM " +
           table + " WHERE ROW)";
  };
  const std::string sealed_rows = "id <= " + std::to_string(sealed.revisions);
  std::vector<Table> tables = {
      {"trials", "id <= 7",
       "SELECT uuid FROM revisions WHERE trial_id = (SELECT id FROM trials "
       "WHERE ROW) AND " +
           sealed_rows},
      {"campaigns", "true",
       "SELECT uuid FROM revisions WHERE " + sealed_rows +
           " UNION SELECT uuid FROM plan_events"},
      {"revisions", sealed_rows, "SELECT uuid FROM revisions WHERE ROW"},
      {"plan_events", "true", "SELECT uuid FROM plan_events WHERE ROW"},
      {"clips", "sha256 IS NOT NULL AND id <= 6",
       "SELECT id FROM clips WHERE ROW UNION SELECT r.uuid FROM revisions r "
       "JOIN trials t ON t.id = r.trial_id WHERE t.clip_id = (SELECT id FROM "
       "clips WHERE ROW)"},
      {"springs", "true", "SELECT uuid FROM springs WHERE ROW"},
      {"rigs", "true", "SELECT uuid FROM rigs WHERE ROW"},
      {"operators", "true", "SELECT uuid FROM operators WHERE ROW"},
      {"surfaces", "true", "SELECT uuid FROM surfaces WHERE ROW"},
  };
  for (const char* table :
       {"statements", "contacts", "conditions", "exclusions", "budget_lines"}) {
    tables.push_back({table, old_revision, of_revision(table)});
  }
  const Table& table = tables[random() % tables.size()];
  const std::string key =
      table.keys.find("revision_id FROM " + table.name) != std::string::npos
          ? "revision_id"
          : "id";
  const auto rows = Lines(file.Text("SELECT DISTINCT " + key + " FROM " +
                                    table.name + " WHERE " + table.condition));
  if (rows.empty()) return {};
  const std::string row = key + " = " + rows[random() % rows.size()];
  Forgery forgery;
  std::string keys = table.keys;
  for (std::size_t at; (at = keys.find("ROW")) != std::string::npos;) {
    keys.replace(at, 3, row);
  }
  for (const std::string& one : Lines(file.Text(keys))) {
    forgery.keys.insert(one);
  }
  if (random() % 3 == 0) {
    forgery.kind = "row removed";
    forgery.act = "DELETE FROM " + table.name + " WHERE " + row;
    return forgery;
  }
  // Not the key of the link itself, nor where a clip was last seen.
  std::vector<std::string> columns;
  for (const std::string& column : Lines(file.Text(
           "SELECT name FROM pragma_table_info('" + table.name + "')"))) {
    if (column != "id" && column != "uuid" && column != "revision_id" &&
        !column.starts_with("last_seen")) {
      columns.push_back(column);
    }
  }
  const std::string& column = columns[random() % columns.size()];
  forgery.kind = "row changed";
  forgery.act = "UPDATE " + table.name + " SET " + column + " = CASE typeof(" +
                column + ") WHEN 'real' THEN " + column +
                " * (1.0 + 1e-12) + 1e-300 WHEN 'integer' THEN " + column +
                " + 1000 WHEN 'text' THEN substr(" + column + ", 1, length(" +
                column + ") - 1) || CASE WHEN " + column +
                " LIKE '%Z' THEN 'Y' ELSE 'Z' END ELSE 'stated' END WHERE " +
                row;
  return forgery;
}

Forgery ForgeryOfATrial(Sqlite& file, const Sealed& sealed,
                        std::mt19937_64& random) {
  const auto trials =
      Lines(file.Text("SELECT DISTINCT trial_id FROM revisions WHERE id <= " +
                      std::to_string(sealed.revisions)));
  const std::string trial = trials[random() % trials.size()];
  const std::string revisions =
      "(SELECT id FROM revisions WHERE trial_id = " + trial + ")";
  Forgery forgery;
  if (random() % 2 == 0) {
    forgery.kind = "trial removed";
    for (const char* table : {"budget_lines", "contacts", "exclusions",
                              "conditions", "statements"}) {
      forgery.act += std::string("DELETE FROM ") + table +
                     " WHERE revision_id IN " + revisions + ";";
    }
    for (const std::string& uuid : Lines(file.Text(
             "SELECT uuid FROM revisions WHERE trial_id = " + trial))) {
      forgery.keys.insert(uuid);
    }
    forgery.act += "DELETE FROM revisions WHERE trial_id = " + trial +
                   "; DELETE FROM trials WHERE id = " + trial;
    return forgery;
  }
  // A copy of its first revision, as another trial.
  forgery.kind = "trial added";
  const auto copy = [&](const std::string& table, const std::string& key,
                        const std::map<std::string, std::string>& other) {
    std::string names;
    std::string values;
    for (const std::string& column : Lines(file.Text(
             "SELECT name FROM pragma_table_info('" + table + "')"))) {
      const auto at = other.find(column);
      names += (names.empty() ? "" : ", ") + column;
      values += (values.empty() ? "" : ", ") +
                (at == other.end() ? column : at->second);
    }
    forgery.act += "INSERT INTO " + table + " (" + names + ") SELECT " +
                   values + " FROM " + table + " WHERE " + key + ";";
  };
  const std::string first =
      "(SELECT min(id) FROM revisions WHERE trial_id = " + trial + ")";
  const std::string uuid = "'00000000-0000-4000-8000-" +
                           std::to_string(100'000'000'000 + random() % 1000) +
                           "'";
  copy("trials", "id = " + trial,
       {{"id", "9000"}, {"uuid", uuid}, {"clip_id", "NULL"}});
  copy("statements", "revision_id = " + first, {{"revision_id", "9000"}});
  copy("contacts", "revision_id = " + first, {{"revision_id", "9000"}});
  copy("budget_lines", "revision_id = " + first, {{"revision_id", "9000"}});
  copy("revisions", "id = " + first,
       {{"id", "9000"},
        {"uuid", uuid},
        {"trial_id", "9000"},
        {"statement_id", "9000"},
        {"exclusion_id", "NULL"},
        {"conditions_id", "NULL"}});
  return forgery;
}

// What `db check --against` says; empty: nothing is wrong.
struct Verdict {
  bool is_found = false;
  bool is_found_without = false;  // by `db check` alone
  std::string of_seal;
};

Verdict Look(const fs::path& path, const Seal& seal) {
  Verdict verdict;
  try {
    const Store store = Store::Open(path, OpenMode::kRead);
    verdict.is_found_without = !Check(store).problems.empty();
    verdict.of_seal = CheckStoreSeal(store, seal).problem;
    const std::string of_head =
        CheckStoreSeal(store, {seal.head, "", {}}).problem;
    EXPECT_EQ(of_head.empty(), verdict.of_seal.empty()) << verdict.of_seal;
    verdict.is_found = verdict.is_found_without || !verdict.of_seal.empty();
  } catch (const core::StoreError&) {
    verdict.is_found = verdict.is_found_without = true;  // cannot even be read
  }
  return verdict;
}

TEST(Seal, EveryForgeryIsFoundAndNamed) {
  Folder folder;
  const Sealed sealed = MakeSealed(folder / "lab.db");
  const auto evidence = Evidence(folder / "lab.db");
  const fs::path path = folder / "forged.db";
  std::mt19937_64 random(20261124);
  std::map<std::string, int> count;
  int forged = 0;
  int only_by_seal = 0;
  while (forged < Rounds(80)) {
    Remove(path);
    Write(path, sealed.bytes);
    Forgery forgery;
    if (random() % 5 == 0) {
      std::string bytes = sealed.bytes;
      const std::size_t at = random() % bytes.size();
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random() % 8)));
      Write(path, bytes);
      if (Evidence(path) == evidence) continue;  // free space, an index ...
      forgery.kind = "byte";
    } else {
      {
        Sqlite file(path);
        forgery = random() % 3 == 0 ? ForgeryOfATrial(file, sealed, random)
                                    : ForgeryOfARow(file, sealed, random);
      }
      if (forgery.act.empty() || !Forge(path, forgery.act)) continue;
      if (random() % 2 == 0) {
        MakeDigestsAnew(path);
        forgery.kind += ", digests made anew";
      }
    }
    SCOPED_TRACE(forgery.kind + ": " + forgery.act);
    ++forged;
    ++count[forgery.kind];
    const Verdict verdict = Look(path, sealed.seal);
    EXPECT_TRUE(verdict.is_found);
    if (!verdict.is_found_without) ++only_by_seal;
    // Named: the first link, of those that cover what was forged.
    if (!forgery.keys.empty()) {
      std::int64_t first = sealed.seal.head.links + 1;
      for (const std::string& key : forgery.keys) {
        const auto at = sealed.number.find(key);
        if (at != sealed.number.end()) first = std::min(first, at->second);
      }
      EXPECT_THAT(verdict.of_seal,
                  HasSubstr("(link " + std::to_string(first) + ")"));
    } else if (forgery.kind == "trial added, digests made anew") {
      EXPECT_THAT(verdict.of_seal, HasSubstr("was put in the place of"));
    }
    if (HasFailure()) return;
  }
  for (const auto& [kind, n] : count) std::printf("%s: %d\n", kind.c_str(), n);
  std::printf("%d forgeries found, %d of them by the seal alone\n", forged,
              only_by_seal);
  EXPECT_GT(only_by_seal, 0);
}

TEST(Seal, AStoreGoneBackIsFound) {
  Folder folder;
  const fs::path path = folder / "lab.db";
  MakeStore(path, 1, 2);
  Backup(Store::Open(path, OpenMode::kRead), folder / "before.db");
  {
    Store store = OpenFixed(path, 2, OpenMode::kWrite);
    store.LogTrial(SphereTrial(70));
  }
  const Seal seal = MakeSeal(Store::Open(path, OpenMode::kRead));
  Store before = OpenFixed(folder / "before.db", 3, OpenMode::kWrite);
  EXPECT_THAT(CheckStoreSeal(before, seal).problem, HasSubstr("was removed"));
  before.LogTrial(SphereTrial(71));
  EXPECT_THAT(CheckStoreSeal(before, seal).problem, HasSubstr("was removed"));
  EXPECT_NE(CheckStoreSeal(before, {seal.head, "", {}}).problem, "");
}

TEST(Seal, OfAnotherStoreIsRefused) {
  Folder folder;
  MakeStore(folder / "a.db", 1, 1);
  MakeStore(folder / "b.db", 2, 1);
  const Seal seal = MakeSeal(Store::Open(folder / "a.db", OpenMode::kRead));
  EXPECT_THAT(
      CheckStoreSeal(Store::Open(folder / "b.db", OpenMode::kRead), seal)
          .problem,
      HasSubstr("another store"));
}

TEST(Seal, AnUnsoundStoreIsNotSealed) {
  Folder folder;
  const fs::path path = folder / "lab.db";
  MakeStore(path, 1, 1);
  ASSERT_TRUE(Forge(path, "UPDATE statements SET clip_path = 'another'"));
  EXPECT_THAT(
      [&] { MakeSeal(Store::Open(path, OpenMode::kRead)); },
      ThrowsMessage<core::StoreError>(HasSubstr("such a store is not sealed")));
}

TEST(ParseSeal, TakesWhatWasWrittenAndNothingElse) {
  Folder folder;
  MakeStore(folder / "lab.db", 1, 3);
  const Seal seal = MakeSeal(Store::Open(folder / "lab.db", OpenMode::kRead));
  const std::string text = SealText(seal);
  const Seal back = ParseSeal(text, "s");
  EXPECT_EQ(back.head, seal.head);
  EXPECT_EQ(back.lines, seal.lines);
  EXPECT_EQ(back.sealed_at_utc, seal.sealed_at_utc);
  EXPECT_EQ(ParseHead(HeadText(seal.head)), seal.head);
  for (const char* no : {"", "x", "a:1:b", "touchdown seal 1"}) {
    EXPECT_EQ(ParseHead(no), std::nullopt) << no;
    EXPECT_THROW(ParseSeal(no, "s"), core::InputError) << no;
  }
  // Each byte matters, but for those of the date.
  std::mt19937_64 random(1);
  const std::size_t date = text.find("sealed ") + 7;
  for (int i = 0; i < 300; ++i) {
    std::string other = text;
    const std::size_t at = random() % text.size();
    if (at >= date && at < date + seal.sealed_at_utc.size()) continue;
    other[at] = static_cast<char>(other[at] ^ (1 << (random() % 8)));
    EXPECT_THROW(ParseSeal(other, "s"), core::InputError) << at;
    EXPECT_THROW(ParseSeal(text.substr(0, at), "s"), core::InputError) << at;
  }
}

}  // namespace
}  // namespace touchdown::db
