#include "tests/db/old_store.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <fstream>
#include <iterator>
#include <string>

namespace touchdown::db {

void MakeOldStore(const std::filesystem::path& path, std::int64_t version) {
  std::ifstream in(std::filesystem::path(TOUCHDOWN_SOURCE_DIR) /
                   "tests/db/data" / fmt::format("v{}.sql", version));
  const std::string sql{std::istreambuf_iterator<char>(in), {}};
  ASSERT_FALSE(sql.empty()) << version;
  sqlite3* store = nullptr;
  sqlite3_open(path.c_str(), &store);
  EXPECT_EQ(sqlite3_exec(store, sql.c_str(), nullptr, nullptr, nullptr),
            SQLITE_OK)
      << sqlite3_errmsg(store);
  sqlite3_close(store);
}

}  // namespace touchdown::db
