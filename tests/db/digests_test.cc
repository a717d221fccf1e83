// `db check` finds whatever another program changed, inserted or removed, and
// each flipped bit that changes evidence; and has nothing to say of an honest
// store. TOUCHDOWN_LONG_TESTS=1 runs 500 of each.
#include "db/src/digests.h"

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
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"

namespace touchdown::db {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

int Rounds(int brief) {
  return std::getenv("TOUCHDOWN_LONG_TESTS") != nullptr ? 500 : brief;
}

// Another program's hands.
class Sqlite {
 public:
  explicit Sqlite(const fs::path& path) {
    sqlite3_open(path.c_str(), &handle_);
  }
  ~Sqlite() { sqlite3_close(handle_); }
  Sqlite(const Sqlite&) = delete;
  Sqlite& operator=(const Sqlite&) = delete;

  // False where SQLite refuses.
  bool Run(const std::string& sql) {
    return sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) ==
           SQLITE_OK;
  }
  int changes() const { return sqlite3_changes(handle_); }
  // All rows, columns by '|', values as SQL; nothing where it cannot be read.
  std::optional<std::string> Text(const std::string& sql) {
    std::string text;
    sqlite3_stmt* row = nullptr;
    int code = sqlite3_prepare_v2(handle_, sql.c_str(), -1, &row, nullptr);
    while (code == SQLITE_OK || code == SQLITE_ROW) {
      code = sqlite3_step(row);
      if (code != SQLITE_ROW) break;
      for (int i = 0; i < sqlite3_column_count(row); ++i) {
        const auto* const value =
            reinterpret_cast<const char*>(sqlite3_column_text(row, i));
        text += value == nullptr ? "NULL" : value;
        text += '|';
      }
      text += '\n';
    }
    sqlite3_finalize(row);
    if (code != SQLITE_DONE) return std::nullopt;
    return text;
  }

 private:
  sqlite3* handle_ = nullptr;
};

std::string Bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void Write(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

// Trials with corrections, exclusions, conditions, budgets, digests of clips.
void MakeStore(const fs::path& path, std::uint64_t seed, int trials) {
  std::mt19937_64 random(seed);
  Store store = OpenFixed(path, seed);
  store.AddCampaign(SphereCampaign());
  core::Trial seen;
  for (int i = 0; i < trials; ++i) {
    core::Trial trial = SphereTrial(i);
    if (random() % 2 == 0) {
      trial.clip.sha256 = std::string(64, static_cast<char>('a' + i % 6));
      trial.clip.sha256[0] = static_cast<char>('0' + i % 10);
      trial.clip.sha256[1] = static_cast<char>('0' + i / 10 % 10);
    }
    trial.document_json = R"({"schema": "touchdown.analysis/1", "replay": )"
                          R"({"track": [1, 2, 3]}, "note": ")" +
                          std::to_string(random()) + "\"}";
    trial.first.contact.approach_budget = {{"localisation", 0.0003},
                                           {"ground", 0.0004}};
    if (random() % 3 == 0) {
      core::Conditions conditions;
      conditions.anomaly_note = "a draught";
      trial.conditions = conditions;
    }
    const Logged logged = store.LogTrial(trial);
    const auto there = store.Find(logged.id);
    switch (random() % 4) {
      case 0:
        store.Exclude(logged.id, "Ada", "dust");
        if (random() % 2 == 0) store.Include(logged.id, "Bob", "no dust");
        break;
      case 1: {
        core::Trial corrected = *there;
        corrected.first.state.label = core::MotionState::kSlide;
        store.Correct(corrected, "Ada", "seen again");
        break;
      }
      case 2:
        store.LogTrial(trial);  // once more, as a batch does
        break;
      default:
        break;
    }
  }
}

// In one file, without a log beside it.
void Settle(const fs::path& path) {
  Sqlite(path).Run("PRAGMA wal_checkpoint(TRUNCATE)");
  fs::remove(path.string() + "-wal");
  fs::remove(path.string() + "-shm");
}

bool IsFound(const fs::path& path) {
  try {
    const Store store = Store::Open(path, OpenMode::kRead);
    return !Check(store).problems.empty();
  } catch (const core::StoreError&) {
    return true;  // it cannot even be read
  }
}

TEST(Digests, HonestStoresAreSound) {
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

// What of the file is evidence: all that a report could rest on.
std::optional<std::string> Evidence(const fs::path& path) {
  Sqlite file(path);
  std::string all;
  for (const char* sql :
       {"SELECT * FROM trials", "SELECT * FROM revisions",
        "SELECT * FROM statements", "SELECT * FROM contacts",
        "SELECT * FROM budget_lines", "SELECT * FROM exclusions",
        "SELECT * FROM conditions", "SELECT * FROM campaigns",
        "SELECT * FROM surfaces",
        "SELECT id, clip_id, size_bytes, sha256 FROM clips"}) {
    // Through the table, not through an index that has a copy.
    const auto rows = file.Text(std::string(sql) + " NOT INDEXED");
    if (!rows) return std::nullopt;
    all += *rows;
  }
  return all;
}

TEST(Digests, EachFlippedBitOfEvidenceIsFound) {
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
    for (const char* beside : {"", "-wal", "-shm"}) {
      fs::remove(path.string() + beside);
    }
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
TEST(Digests, AnAlteredPlanIsFound) {
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
    EXPECT_THAT(Check(Store::Open(path, OpenMode::kRead)).problems,
                Contains(HasSubstr("the plan of campaign")));
    for (const char* beside : {"", "-wal", "-shm"}) {
      fs::remove(path.string() + beside);
    }
  }
}

TEST(Digests, EachForgedRowIsFound) {
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
    for (const char* beside : {"", "-wal", "-shm"}) {
      fs::remove(path.string() + beside);
    }
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

TEST(Digests, GrowWithTheTrialAndAreKept) {
  Folder folder;
  const fs::path path = folder / "lab.db";
  MakeStore(path, 5, 2);
  Sqlite file(path);
  for (const char* act :
       {"DELETE FROM digests", "DELETE FROM clip_digests",
        "UPDATE digests SET sha256 = sha256",
        "UPDATE digests SET revisions = revisions + 2",
        "UPDATE clip_digests SET sha256 = sha256",
        "INSERT OR REPLACE INTO digests SELECT * FROM digests"}) {
    EXPECT_FALSE(file.Run(act)) << act;
  }
  // Whoever takes a digest away is found, too.
  file.Run("DROP TRIGGER digests_refuse_DELETE; DELETE FROM digests");
  EXPECT_TRUE(IsFound(path));
}

}  // namespace
}  // namespace touchdown::db
