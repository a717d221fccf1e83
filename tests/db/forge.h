// What the tests of forgeries share: a store to forge, and a forger's hands.
#pragma once

#include <sqlite3.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <random>
#include <string>

#include "db/src/schema.h"
#include "tests/db/fixture.h"

namespace touchdown::db {

namespace fs = std::filesystem;

// 500 in the long form.
inline int Rounds(int brief) {
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

inline std::string Bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline void Write(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

// Trials with corrections, exclusions, conditions, budgets, digests of clips.
inline void MakeStore(const fs::path& path, std::uint64_t seed, int trials) {
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
inline void Settle(const fs::path& path) {
  Sqlite(path).Run("PRAGMA wal_checkpoint(TRUNCATE)");
  fs::remove(path.string() + "-wal");
  fs::remove(path.string() + "-shm");
}

// The store's file and what lies beside it.
inline void Remove(const fs::path& path) {
  for (const char* beside : {"", "-wal", "-shm"}) {
    fs::remove(path.string() + beside);
  }
}

// Of today's schema.
inline std::string TriggerSql(const std::string& name) {
  const std::string schema = SchemaSql();
  const std::size_t at = schema.find("CREATE TRIGGER " + name + " ");
  const std::size_t end = schema.find("\nCREATE ", at);
  return schema.substr(at, end == std::string::npos ? end : end - at);
}

// What of the file is evidence: all that a report could rest on.
inline std::optional<std::string> Evidence(const fs::path& path) {
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

}  // namespace touchdown::db
