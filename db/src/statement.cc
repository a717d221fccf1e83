#include "statement.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <stdexcept>
#include <thread>

#include "touchdown/core/errors.h"

namespace touchdown::db {
namespace {

using core::StoreError;

std::int64_t NowNs() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

// "file:" name of a file that nobody can be writing to.
std::string ImmutableUri(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : path.string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       (c >= '0' && c <= '9') || c == '/' || c == '.' ||
                       c == '_' || c == '-';
    if (plain) {
      uri += c;
    } else {
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return uri + "?immutable=1";
}

// SQLite counts its memory under a lock of the whole process; nobody reads the
// count, and without it a bulk import takes 9 % less. Only before the first
// connection: later it has no effect.
void LeaveMemoryUncounted() {
  static const int once = sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0);
  static_cast<void>(once);
}

}  // namespace

Connection::Connection(const std::filesystem::path& path, Access access,
                       double patience_s)
    : path_(path), patience_s_(patience_s) {
  LeaveMemoryUncounted();
  // An absolute name is never ":memory:" nor an URI.
  const std::filesystem::path absolute = std::filesystem::absolute(path);
  const int create = access == Access::kCreate ? SQLITE_OPEN_CREATE : 0;
  try {
    int code = OpenFile(absolute.string(), SQLITE_OPEN_READWRITE | create);
    if (access == Access::kRead &&
        (code == SQLITE_CANTOPEN || code == SQLITE_READONLY) &&
        !std::filesystem::exists(absolute.string() + "-wal")) {
      // A read-only folder: SQLite cannot make its lock files there, and with
      // no log beside it the file is whole as it lies.
      sqlite3_close(handle_);
      handle_ = nullptr;
      code = OpenFile(ImmutableUri(absolute),
                      SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    }
    if (code != SQLITE_OK) Fail(code);
    // Off for good: nobody needs them, and a damaged file could use them.
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    Execute(
        "PRAGMA foreign_keys = ON;"
        "PRAGMA trusted_schema = OFF;"
        "PRAGMA recursive_triggers = ON;"  // REPLACE must not evade a trigger
        "PRAGMA cell_size_check = ON;"
        "PRAGMA synchronous = FULL;"  // every commit is on the disk
        // Room for a bulk import: with 2 MB, the default, pages of the indexes
        // are written out and read back again and again.
        "PRAGMA cache_size = -32768;"  // KiB
        "PRAGMA temp_store = MEMORY;");
    if (access == Access::kRead) Execute("PRAGMA query_only = ON");
  } catch (...) {
    sqlite3_close(handle_);
    throw;
  }
}

Connection::~Connection() {
  for (auto& [sql, statements] : idle_) {
    for (sqlite3_stmt* statement : statements) sqlite3_finalize(statement);
  }
  sqlite3_close(handle_);
}

int Connection::OpenFile(const std::string& name, int flags) {
  // One thread uses a Store, so SQLite need not lock for others.
  int code = sqlite3_open_v2(name.c_str(), &handle_,
                             flags | SQLITE_OPEN_NOMUTEX, nullptr);
  if (code != SQLITE_OK) return code;
  sqlite3_extended_result_codes(handle_, 1);
  // Small pieces of memory of its own, 600 kB: enough for the hundred columns
  // of a contact (the default is a tenth).
  constexpr int kSlotBytes = 1200;
  constexpr int kSlots = 500;
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_LOOKASIDE, nullptr, kSlotBytes,
                    kSlots);
  sqlite3_busy_handler(handle_, &Connection::OnBusy, this);
  // The first look at the file: opens log and lock files, recovers after a
  // crash. SQLite reports some collisions here without asking the busy handler.
  const std::int64_t start_ns = NowNs();
  while (true) {
    code = sqlite3_exec(handle_, "SELECT count(*) FROM sqlite_schema", nullptr,
                        nullptr, nullptr);
    const int primary = code & 0xff;
    const bool collision = primary == SQLITE_BUSY || primary == SQLITE_PROTOCOL;
    const double waited_s = static_cast<double>(NowNs() - start_ns) * 1e-9;
    if (!collision || waited_s > patience_s_) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const int primary = code & 0xff;
  return primary == SQLITE_CANTOPEN || primary == SQLITE_READONLY ? primary
                                                                  : code;
}

int Connection::OnBusy(void* self, int tries) {
  auto& connection = *static_cast<Connection*>(self);
  if (tries == 0) connection.busy_since_ns_ = NowNs();
  const double waited_s =
      static_cast<double>(NowNs() - connection.busy_since_ns_) * 1e-9;
  if (waited_s > connection.patience_s_) return 0;
  // 0.5 ms, growing to 16 ms: a durable commit takes milliseconds, and a longer
  // pause starves the slow among many writers. The jitter keeps them apart.
  const int doublings = std::min(tries, 5);
  std::minstd_rand jitter(static_cast<unsigned>(NowNs()));
  const auto base_us = 500 << doublings;
  std::this_thread::sleep_for(std::chrono::microseconds(
      base_us / 2 +
      static_cast<int>(jitter() % static_cast<unsigned>(base_us))));
  return 1;
}

void Connection::Execute(const std::string& sql) {
  const int code =
      sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) Fail(code);
}

std::int64_t Connection::Integer(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.Step() ? statement.TakeInteger() : 0;
}

void Connection::Fail(int code) const {
  const std::string file = path_.string();
  const char* said =
      handle_ != nullptr ? sqlite3_errmsg(handle_) : sqlite3_errstr(code);
  const int system = handle_ != nullptr ? sqlite3_system_errno(handle_) : 0;
  const std::string why = system != 0 ? std::strerror(system) : said;
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_PROTOCOL:
      throw StoreError(fmt::format(
          "{}: another process has kept the trial store busy for {:.0f} s; "
          "nothing of this was recorded, repeat when it has finished",
          file, patience_s_));
    case SQLITE_FULL:
      throw StoreError(fmt::format(
          "{}: the disk is full; nothing of this was recorded, make room and "
          "repeat",
          file));
    case SQLITE_READONLY:
    case SQLITE_PERM:
      throw StoreError(fmt::format(
          "{}: the trial store cannot be written (read-only file or folder); "
          "nothing was recorded, make it writable or choose another --db",
          file));
    case SQLITE_CANTOPEN:
      throw StoreError(fmt::format(
          "{}: the trial store cannot be opened ({}); check the path and the "
          "permissions of the file and its folder",
          file, why));
    case SQLITE_NOTADB:
      throw StoreError(fmt::format(
          "{}: this is not a trial store (not an SQLite file); choose another "
          "--db",
          file));
    case SQLITE_CORRUPT:
      throw StoreError(fmt::format(
          "{}: the trial store is damaged ({}); see `touchdown db check`, or "
          "go back to a backup",
          file, said));
    case SQLITE_IOERR:
      throw StoreError(fmt::format(
          "{}: reading or writing the trial store failed ({}); the last entry "
          "counts as not recorded, check the disk and repeat",
          file, why));
    default:
      throw StoreError(fmt::format("{}: trial store: {}", file, said));
  }
}

Statement::Statement(Connection& connection, std::string_view sql)
    : connection_(connection) {
  home_ = connection_.idle_.find(sql);
  if (home_ == connection_.idle_.end()) {
    home_ = connection_.idle_
                .emplace(std::string(sql), std::vector<sqlite3_stmt*>())
                .first;
  }
  auto& idle = home_->second;
  if (!idle.empty()) {
    statement_ = idle.back();
    idle.pop_back();
    return;
  }
  const std::string& text = home_->first;
  const int code = sqlite3_prepare_v3(
      connection_.handle_, text.c_str(), static_cast<int>(text.size() + 1),
      SQLITE_PREPARE_PERSISTENT, &statement_, nullptr);
  if (code != SQLITE_OK) connection_.Fail(code);
}

Statement::~Statement() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
  home_->second.push_back(statement_);
}

void Statement::Check(int code) {
  if (code != SQLITE_OK) connection_.Fail(code);
}

Statement& Statement::Add(std::int64_t value) {
  Check(sqlite3_bind_int64(statement_, ++parameter_, value));
  return *this;
}

Statement& Statement::Add(double value) {
  if (std::isnan(value)) throw std::logic_error("a NaN reached the store");
  Check(sqlite3_bind_double(statement_, ++parameter_, value));
  return *this;
}

Statement& Statement::Add(std::string_view value) {
  // A null pointer would be NULL instead of the empty text.
  const char* data = value.empty() ? "" : value.data();
  Check(sqlite3_bind_text64(statement_, ++parameter_, data, value.size(),
                            SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Statement& Statement::Add(std::nullopt_t) {
  Check(sqlite3_bind_null(statement_, ++parameter_));
  return *this;
}

bool Statement::Step() {
  column_ = 0;
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  connection_.Fail(code);
}

void Statement::Run() {
  while (Step()) {
  }
  sqlite3_reset(statement_);
  parameter_ = 0;
}

std::int64_t Statement::TakeInteger() {
  return sqlite3_column_int64(statement_, column_++);
}

double Statement::TakeReal() {
  return sqlite3_column_double(statement_, column_++);
}

std::string Statement::TakeText() {
  const auto* text = sqlite3_column_text(statement_, column_);
  const int size = sqlite3_column_bytes(statement_, column_++);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text), static_cast<std::size_t>(size)};
}

void Statement::AppendRow(std::string& text) const {
  const int columns = sqlite3_column_count(statement_);
  for (int i = 0; i < columns; ++i) {
    const int type = sqlite3_column_type(statement_, i);
    if (type == SQLITE_NULL) continue;
    text += sqlite3_column_name(statement_, i);
    if (type == SQLITE_INTEGER) {
      text += fmt::format("=i{}\n", sqlite3_column_int64(statement_, i));
    } else if (type == SQLITE_FLOAT) {
      const double value = sqlite3_column_double(statement_, i);
      text += fmt::format("=r{:016x}\n", std::bit_cast<std::uint64_t>(value));
    } else {
      const void* const bytes = sqlite3_column_blob(statement_, i);
      const auto size =
          static_cast<std::size_t>(sqlite3_column_bytes(statement_, i));
      text += fmt::format("={}{}:", type == SQLITE_TEXT ? 't' : 'b', size);
      text.append(static_cast<const char*>(bytes), size);
      text += '\n';
    }
  }
}

bool Statement::NextIsNull() const {
  return sqlite3_column_type(statement_, column_) == SQLITE_NULL;
}

std::optional<double> Statement::TakeOptionalReal() {
  if (NextIsNull()) return ++column_, std::nullopt;
  return TakeReal();
}

std::optional<std::int64_t> Statement::TakeOptionalInteger() {
  if (NextIsNull()) return ++column_, std::nullopt;
  return TakeInteger();
}

std::optional<std::string> Statement::TakeOptionalText() {
  if (NextIsNull()) return ++column_, std::nullopt;
  return TakeText();
}

Transaction::Transaction(Connection& connection, Kind kind)
    : connection_(connection) {
  connection_.Execute(kind == Kind::kWrite ? "BEGIN IMMEDIATE" : "BEGIN");
}

Transaction::~Transaction() {
  if (!open_) return;
  // SQLite itself has rolled back after some errors: nothing to do then.
  if (sqlite3_get_autocommit(connection_.handle()) == 0) {
    sqlite3_exec(connection_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void Transaction::Commit() {
  connection_.Execute("COMMIT");
  open_ = false;
}

}  // namespace touchdown::db
