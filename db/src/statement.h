// SQLite behind two classes: a connection, and the one statement class. Nothing
// outside db/src sees them.
#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchdown::db {

// An open store file. Owns the handle and the prepared statements.
class Connection {
 public:
  enum class Access { kRead, kWrite, kCreate };

  // Opens the file (kRead falls back to a file that cannot be written) and sets
  // what every connection needs. `patience_s`: how long another process may
  // hold the store before we give up. Throws core::StoreError.
  Connection(const std::filesystem::path& path, Access access,
             double patience_s);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  sqlite3* handle() const { return handle_; }
  const std::filesystem::path& path() const { return path_; }

  // Runs statements that return nothing and take nothing.
  void Execute(const std::string& sql);
  std::int64_t Integer(const std::string& sql);  // one row, one integer

  // One line for a person: which store, what went wrong, what to do.
  [[noreturn]] void Fail(int code) const;

 private:
  friend class Statement;
  int OpenFile(const std::string& name, int flags);

  static int OnBusy(void* self, int tries);

  std::filesystem::path path_;
  sqlite3* handle_ = nullptr;
  double patience_s_;
  std::int64_t busy_since_ns_ = 0;
  std::map<std::string, std::vector<sqlite3_stmt*>, std::less<>> idle_;
};

// One SQL statement. Values go in one after the other with Add, columns come
// out one after the other with Take. The prepared form returns to its
// connection, reset, when the Statement dies, so that no forgotten query holds
// a snapshot.
class Statement {
 public:
  Statement(Connection& connection, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Binds the next parameter. Text and numbers travel bit for bit; there is no
  // other way by which a value enters SQL. NaN is refused (SQLite would make it
  // NULL): callers check before.
  Statement& Add(std::int64_t value);
  Statement& Add(int value) { return Add(std::int64_t{value}); }
  Statement& Add(bool value) { return Add(std::int64_t{value}); }
  Statement& Add(double value);
  Statement& Add(std::string_view value);
  Statement& Add(const std::string& value) {
    return Add(std::string_view(value));
  }
  Statement& Add(const char* value) { return Add(std::string_view(value)); }
  Statement& Add(std::nullopt_t);
  template <class T>
  Statement& Add(const std::optional<T>& value) {
    return value ? Add(*value) : Add(std::nullopt);
  }

  // True while there is a row to take from.
  bool Step();
  // Steps to the end and makes ready for the next round of Add.
  void Run();

  // The next column of the row.
  std::int64_t TakeInteger();
  bool TakeBool() { return TakeInteger() != 0; }
  double TakeReal();
  std::string TakeText();
  std::optional<double> TakeOptionalReal();
  std::optional<std::int64_t> TakeOptionalInteger();
  std::optional<std::string> TakeOptionalText();
  bool NextIsNull() const;
  // Adds the row, as a text that no other row has: of each column that is not
  // NULL its name, its type, its bytes.
  void AppendRow(std::string& text) const;
  void Skip(int columns) { column_ += columns; }

 private:
  void Check(int code);

  Connection& connection_;
  std::map<std::string, std::vector<sqlite3_stmt*>, std::less<>>::iterator
      home_;
  sqlite3_stmt* statement_ = nullptr;
  int parameter_ = 0;
  int column_ = 0;
};

// All or nothing: rolls back unless committed. kWrite takes the write lock at
// once, so that two writers queue instead of colliding; kRead gives all its
// queries one snapshot.
class Transaction {
 public:
  enum class Kind { kRead, kWrite };
  Transaction(Connection& connection, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  // On return the changes are on the disk.
  void Commit();

 private:
  Connection& connection_;
  bool open_ = true;
};

}  // namespace touchdown::db
