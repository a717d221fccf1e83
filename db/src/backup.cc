#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

#include "schema.h"
#include "statement.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/unfinished.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::db {
namespace {

namespace fs = std::filesystem;
using core::StoreError;

// Brings a file or a folder to the disk.
void Sync(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0 || fsync(file) != 0) {
    const int error = errno;
    if (file >= 0) close(file);
    throw StoreError(fmt::format("{}: cannot be brought to the disk ({})",
                                 path.string(), std::strerror(error)));
  }
  close(file);
}

// Removes what is left of a copy that failed.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {
    for (const char* suffix : kSuffixes) {
      unfinished_.push_back(
          std::make_unique<core::Unfinished>(path_.string() + suffix));
    }
  }
  ~TemporaryFile() {
    std::error_code ignored;
    for (const char* suffix : kSuffixes) {
      fs::remove(path_.string() + suffix, ignored);
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& path() const { return path_; }

 private:
  // The files that SQLite may keep beside a database.
  static constexpr const char* kSuffixes[] = {"", "-wal", "-shm", "-journal"};

  fs::path path_;
  std::vector<std::unique_ptr<core::Unfinished>> unfinished_;
};

void RequireNew(const fs::path& to) {
  if (fs::exists(to)) {
    throw StoreError(fmt::format(
        "{}: this file exists; a backup expects a new name", to.string()));
  }
  const fs::path folder = fs::absolute(to).parent_path();
  if (!fs::is_directory(folder)) {
    throw StoreError(
        fmt::format("{}: its folder {} does not exist; make it first",
                    to.string(), folder.string()));
  }
}

// `name` is of the copy while it is made.
void CopyDatabase(Connection& source, const fs::path& to,
                  const std::string& name) {
  RequireNew(to);
  const fs::path folder = fs::absolute(to).parent_path();
  const TemporaryFile temporary(fs::path(to.string() + "." + name + ".part"));
  {
    Connection copy(temporary.path(), Connection::Access::kCreate, 0.0);
    sqlite3_backup* backup =
        sqlite3_backup_init(copy.handle(), "main", source.handle(), "main");
    if (backup == nullptr) copy.Fail(sqlite3_extended_errcode(copy.handle()));
    // All pages in one step: one snapshot, and in WAL mode nobody waits for it.
    const int code = sqlite3_backup_step(backup, -1);
    sqlite3_backup_finish(backup);
    if (code != SQLITE_DONE) copy.Fail(code);
    Statement check(copy, "PRAGMA integrity_check");
    if (!check.Step() || check.TakeText() != "ok") {
      throw StoreError(fmt::format(
          "{}: the copy is damaged, so the store may be; see `touchdown db "
          "check`",
          to.string()));
    }
  }
  Sync(temporary.path());
  // link() fails where rename() would silently replace; file systems without
  // hard links (sticks, mostly) must do with the latter.
  int error = link(temporary.path().c_str(), to.c_str()) == 0 ? 0 : errno;
  if ((error == EPERM || error == ENOTSUP) && !fs::exists(to)) {
    error = rename(temporary.path().c_str(), to.c_str()) == 0 ? 0 : errno;
  }
  if (error != 0) {
    throw StoreError(fmt::format("{}: the backup cannot take this name ({})",
                                 to.string(), std::strerror(error)));
  }
  Sync(folder);
}

// Where the store as it was stays: "lab.db.version7"; the next free name.
fs::path OldStorePath(const fs::path& path, std::int64_t version) {
  const std::string name = fmt::format("{}.version{}", path.string(), version);
  fs::path free = name;
  for (int i = 2; fs::exists(free); ++i) free = fmt::format("{}-{}", name, i);
  return free;
}

// Before an upgrade is committed.
void RequireSound(Connection& connection, const fs::path& path) {
  Statement keys(connection, "PRAGMA foreign_key_check");
  Statement pages(connection, "PRAGMA integrity_check");
  if (keys.Step() || !pages.Step() || pages.TakeText() != "ok") {
    throw StoreError(fmt::format(
        "{}: the trial store is damaged and was not upgraded; go back to a "
        "backup, or see `touchdown db check` of the version that made it",
        path.string()));
  }
}

// All steps in one transaction: killed in between, it is the old store. Returns
// the version that it had.
std::int64_t UpgradeFile(Connection& connection) {
  // Foreign keys are checked, all of them, before the commit.
  connection.Execute("PRAGMA foreign_keys = OFF");
  Transaction transaction(connection, Transaction::Kind::kWrite);
  // Another process may have been faster.
  const std::int64_t from = connection.Integer("PRAGMA user_version");
  Upgrade(connection, from);
  connection.Execute(fmt::format("PRAGMA user_version = {}", kSchemaVersion));
  RequireSound(connection, connection.path());
  transaction.Commit();
  return from;
}

}  // namespace

void Backup(const Store& store, const fs::path& to) {
  CopyDatabase(store.connection(), to, store.sources().new_uuid());
}

Migration Migrate(const fs::path& path, OpenOptions options) {
  if (!fs::exists(path)) {
    throw StoreError(fmt::format(
        "{}: there is no such trial store; check the path", path.string()));
  }
  Migration migration{kSchemaVersion, kSchemaVersion, {}};
  {
    Connection connection(path, Connection::Access::kWrite, options.patience_s);
    const std::int64_t version = connection.Integer("PRAGMA user_version");
    const bool ours =
        connection.Integer("PRAGMA application_id") == kApplicationId;
    if (ours && version >= 1 && version < kSchemaVersion) {
      // Older programs cannot read the upgraded one: as it was, it stays.
      migration.old_store = OldStorePath(path, version);
      CopyDatabase(connection, migration.old_store, options.sources.new_uuid());
      try {
        migration.from_version = UpgradeFile(connection);
      } catch (...) {
        std::error_code ignored;
        fs::remove(migration.old_store, ignored);
        throw;
      }
    }
  }
  // Says what is wrong with a newer file, or one that is not a store.
  Store::Open(path, OpenMode::kWrite, std::move(options));
  return migration;
}

}  // namespace touchdown::db
