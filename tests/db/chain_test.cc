// `db check` finds whatever another program changed, inserted or removed, and
// each flipped bit that changes evidence; and has nothing to say of an honest
// store. TOUCHDOWN_LONG_TESTS=1 runs 500 of each.
#include "db/src/chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "db/src/schema_parts.h"
#include "tests/db/fixture.h"
#include "tests/db/forge.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"

namespace touchdown::db {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

bool IsFound(const fs::path& path) {
  try {
    const Store store = Store::Open(path, OpenMode::kRead);
    return !Check(store).problems.empty();
  } catch (const core::StoreError&) {
    return true;  // it cannot even be read
  }
}

TEST(Chain, HonestStoresAreSound) {
  for (int round = 0; round < Rounds(10); ++round) {
    SCOPED_TRACE(round);
    Folder folder;
    const auto seed = static_cast<std::uint64_t>(round + 1);
    MakeStore(folder / "a.db", seed, 3);
    {
      MakeStore(folder / "b.db", seed + 10'000, 2);
      Store store = OpenFixed(folder / "a.db", seed + 20'000, OpenMode::kWrite);
      Merge(store, Store::Open(folder / "b.db", OpenMode::kRead));
      // A clip's digest that becomes known later.
      core::Trial late = SphereTrial(1);
      late.clip.sha256 = std::string(64, 'e');
      store.LogTrial(late);
      Backup(store, folder / "copy.db");
    }
    for (const char* name : {"a.db", "b.db", "copy.db"}) {
      const Store store = Store::Open(folder / name, OpenMode::kRead);
      EXPECT_THAT(Check(store).problems, IsEmpty()) << name;
    }
    if (HasFailure()) return;
  }
}

TEST(Chain, EachFlippedBitOfEvidenceIsFound) {
  Folder folder;
  MakeStore(folder / "lab.db", 3, 8);
  Settle(folder / "lab.db");
  const std::string whole = Bytes(folder / "lab.db");
  const auto evidence = Evidence(folder / "lab.db");
  ASSERT_TRUE(evidence);
  std::mt19937_64 random(20261128);
  int flipped = 0;
  int silent = 0;
  while (flipped < Rounds(40)) {
    const std::size_t at = random() % whole.size();
    const int bit = static_cast<int>(random() % 8);
    SCOPED_TRACE("byte " + std::to_string(at) + ", bit " + std::to_string(bit));
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
    const fs::path path = folder / "flipped.db";
    Remove(path);
    Write(path, bytes);
    const auto now = Evidence(path);
    if (now == evidence) {
      ++silent;  // free space, an index, a date on which a clip was seen
      continue;
    }
    ++flipped;
    EXPECT_TRUE(IsFound(path));
    if (HasFailure()) return;
  }
  std::printf("%d flipped bits changed evidence, %d did not\n", flipped,
              silent);
}

// The plan before the first trial is what a verdict is judged by.
TEST(Chain, AnAlteredPlanIsFound) {
  Folder folder;
  {
    Store store = OpenFixed(folder / "lab.db");
    store.AddCampaign(SphereCampaign());
    const std::string name = SphereCampaign().name;
    SetPlan(store, name, {"", "after 40 trials", ""}, "Ada", "");
    store.LogTrial(SphereTrial(1));
    RecordLook(store, name, "report");
    EXPECT_THAT(Check(store).problems, IsEmpty());
  }
  Settle(folder / "lab.db");
  const std::string whole = Bytes(folder / "lab.db");
  for (const char* act :
       {"UPDATE plan_events SET stopping_rule = 'after 20 trials'",
        "UPDATE plan_events SET trials = 0 WHERE kind = 'look'",
        "UPDATE plan_events SET at_utc = '2020-01-01T00:00:00.000Z'",
        "DELETE FROM plan_events WHERE kind = 'look'",
        "DELETE FROM plan_events",
        "INSERT INTO plan_events SELECT 9, replace(uuid, '-', '+'), "
        "campaign_id, kind, design, stopping_rule, error_rates, trials, "
        "author, reason, at_utc FROM plan_events WHERE id = 1"}) {
    SCOPED_TRACE(act);
    const fs::path path = folder / "forged.db";
    Write(path, whole);
    {
      Sqlite file(path);
      ASSERT_TRUE(
          file.Run("DROP TRIGGER plan_events_refuse_UPDATE; DROP "
                   "TRIGGER plan_events_refuse_DELETE;"));
      ASSERT_TRUE(file.Run(act));
      ASSERT_GT(file.changes(), 0);
    }
    EXPECT_THAT(
        Check(Store::Open(path, OpenMode::kRead)).problems,
        Contains(AnyOf(HasSubstr("the plan of campaign"),
                       AllOf(HasSubstr("plan "), HasSubstr(" is gone")))));
    Remove(path);
  }
}

TEST(Chain, EachForgedRowIsFound) {
  Folder folder;
  MakeStore(folder / "lab.db", 4, 8);
  Settle(folder / "lab.db");
  const std::string whole = Bytes(folder / "lab.db");
  std::mt19937_64 random(20261129);
  const std::vector<std::string> tables = {
      "trials",       "revisions",  "statements", "contacts",
      "budget_lines", "exclusions", "conditions"};
  int forged = 0;
  std::map<std::string, int> count;
  while (forged < Rounds(60)) {
    const fs::path path = folder / "forged.db";
    Remove(path);
    Write(path, whole);
    const std::string& table = tables[random() % tables.size()];
    std::string act;
    bool done = false;
    {
      Sqlite file(path);
      // Without the guards, which are put back afterwards.
      file.Run(
          "PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = "
          "ON;");
      std::string triggers = *file.Text(
          "SELECT group_concat('DROP TRIGGER ' || name, ';') FROM "
          "sqlite_schema WHERE type = 'trigger'");
      triggers.resize(triggers.size() - 2);  // "|\n"
      ASSERT_TRUE(file.Run(triggers));
      std::vector<std::string> columns;
      std::istringstream names(
          *file.Text("SELECT name FROM pragma_table_info('" + table + "')"));
      for (std::string name; std::getline(names, name, '|');) {
        columns.push_back(name);
        names.ignore(1);
      }
      std::string list;
      for (const auto& column : columns) {
        list += (list.empty() ? "" : ", ") + column;
      }
      const int rows = std::stoi(*file.Text("SELECT count(*) FROM " + table));
      if (rows == 0) continue;
      const std::string key =
          table == "trials" || table == "revisions" ? "id" : "revision_id";
      // One row, whatever its key is.
      const std::string where = " WHERE (" + key + ") = (SELECT " + key +
                                " FROM " + table + " LIMIT 1 OFFSET " +
                                std::to_string(random() % rows) + ")";
      switch (random() % 3) {
        case 0: {
          const std::string& column = columns[random() % columns.size()];
          act = "UPDATE " + table + " SET " + column + " = CASE typeof(" +
                column + ") WHEN 'real' THEN " + column +
                " * (1.0 + 1e-12) + 1e-300 WHEN 'integer' THEN " + column +
                " + 1 WHEN 'text' THEN " + column +
                " || ' ' ELSE 'stated' END" + where;
          break;
        }
        case 1:
          act = "DELETE FROM " + table + where;
          break;
        default: {
          // A copy under the next key.
          std::string copy = list;
          const std::string next =
              table == "contacts" || table == "budget_lines" ? "ordinal" : key;
          const auto at = copy.find(next);
          copy.replace(at, next.size(),
                       "(SELECT max(" + next + ") + 1 FROM " + table + ")");
          if (const auto uuid = copy.find("uuid"); uuid != std::string::npos) {
            copy.replace(uuid, 4,
                         "'00000000-0000-4000-8000-' || printf('%012d', "
                         "random() & 65535)");
          }
          if (const auto number = copy.find("number");
              number != std::string::npos) {
            copy.replace(number, 6, "number + 1");
          }
          act = "INSERT INTO " + table + " (" + list + ") SELECT " + copy +
                " FROM " + table + where;
        }
      }
      done = file.Run(act) && file.changes() > 0;
      ASSERT_TRUE(file.Run(TriggersSql()));
    }
    if (!done) continue;  // a key that must be unique
    SCOPED_TRACE(act);
    ++forged;
    ++count[table + " " + act.substr(0, 6)];
    EXPECT_TRUE(IsFound(path));
    if (HasFailure()) return;
  }
  for (const auto& [what, n] : count) std::printf("%s: %d\n", what.c_str(), n);
}

TEST(Chain, IsKept) {
  Folder folder;
  const fs::path path = folder / "lab.db";
  MakeStore(path, 5, 2);
  {
    Sqlite file(path);
    for (const char* act :
         {"DELETE FROM chain", "UPDATE chain SET sha256 = sha256",
          "INSERT OR REPLACE INTO chain SELECT * FROM chain",
          "INSERT INTO chain SELECT number + 100, subject, key || 'x', "
          "row_sha256, sha256 FROM chain"}) {
      EXPECT_FALSE(file.Run(act)) << act;
    }
  }
  // Whoever takes a link away, or adds one, is found, too.
  for (const char* act :
       {"DELETE FROM chain", "DELETE FROM chain WHERE number = 3",
        "DELETE FROM chain WHERE number = (SELECT max(number) FROM chain)",
        "INSERT INTO chain SELECT max(number) + 1, subject, key || 'x', "
        "row_sha256, sha256 FROM chain"}) {
    fs::copy_file(path, folder / "forged.db");
    ASSERT_TRUE(Sqlite(folder / "forged.db")
                    .Run(std::string("DROP TRIGGER chain_refuse_DELETE;") +
                         act + ";" + TriggerSql("chain_refuse_DELETE")));
    EXPECT_TRUE(IsFound(folder / "forged.db")) << act;
    Remove(folder / "forged.db");
  }
}

// What is in the file, and would show what is not so, is the program's.
TEST(Chain, AForgedViewOrTriggerIsFound) {
  Folder folder;
  const fs::path path = folder / "lab.db";
  for (const char* act :
       {"DROP VIEW v_trials",
        "DROP VIEW v_trials; CREATE VIEW v_trials AS SELECT 1",
        "CREATE TRIGGER more AFTER INSERT ON trials BEGIN SELECT 1; END",
        "DROP INDEX trials_by_date"}) {
    MakeStore(path, 6, 1);
    ASSERT_TRUE(Sqlite(path).Run(act));
    EXPECT_TRUE(IsFound(path)) << act;
    Remove(path);
  }
}

}  // namespace
}  // namespace touchdown::db
