// Files of every released version are read for ever.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <fstream>
#include <map>
#include <sstream>

#include "db/src/schema.h"
#include "tests/db/fixture.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::db {
namespace {

using ::testing::IsEmpty;

void Load(const std::filesystem::path& path, const std::string& fixture) {
  std::ifstream in(std::filesystem::path(TOUCHDOWN_SOURCE_DIR) /
                   "tests/db/data" / fixture);
  ASSERT_TRUE(in) << fixture;
  std::stringstream sql;
  sql << in.rdbuf();
  sqlite3* handle = nullptr;
  sqlite3_open(path.c_str(), &handle);
  char* error = nullptr;
  ASSERT_EQ(sqlite3_exec(handle, sql.str().c_str(), nullptr, nullptr, &error),
            SQLITE_OK)
      << error;
  sqlite3_close(handle);
}

// Every table, index and trigger with its text.
std::map<std::string, std::string> SchemaOf(const std::filesystem::path& path) {
  std::map<std::string, std::string> schema;
  sqlite3* handle = nullptr;
  sqlite3_open(path.c_str(), &handle);
  sqlite3_exec(
      handle, "SELECT name, sql FROM sqlite_schema WHERE sql IS NOT NULL",
      [](void* map, int, char** text, char**) {
        (*static_cast<std::map<std::string, std::string>*>(map))[text[0]] =
            text[1];
        return 0;
      },
      &schema, nullptr);
  sqlite3_close(handle);
  return schema;
}

TEST(Migrate, ReadsAStoreOfVersion1) {
  Folder folder;
  const auto path = folder / "lab.db";
  Load(path, "v1.sql");
  Migrate(path);
  Store store = Store::Open(path, OpenMode::kWrite);
  EXPECT_THAT(Check(store).problems, IsEmpty());
  const auto trials = store.Trials();
  ASSERT_EQ(trials.size(), 3u);
  EXPECT_EQ(trials[0].campaign, "asphalt");
  EXPECT_EQ(trials[0].first.state.label, core::MotionState::kBounce);
  EXPECT_EQ(trials[0].first.contact.approach_angle_rad->value,
            20.0 * core::kDegree);
  EXPECT_EQ(trials[1].revision, 3);
  EXPECT_EQ(trials[1].first.state.label, core::MotionState::kRoll);
  EXPECT_TRUE(trials[1].excluded);
  EXPECT_EQ(trials[1].exclusion_reason, "the lamp failed");
  EXPECT_EQ(trials[2].body.long_m->value, 60.0 * core::kMillimetre);
  EXPECT_EQ(trials[2].first.contact.corner, core::Corner::kLeading);
  EXPECT_EQ(store.FindCampaign("asphalt")->theory_boundary_rad,
            11.8 * core::kDegree);
  store.LogTrial(SphereTrial(1));
  EXPECT_EQ(store.Trials().size(), 4u);
}

// The schema follows from a table of quantities: whoever adds one there must
// raise kSchemaVersion, write the step, and freeze a new fixture.
TEST(Migrate, TheSchemaIsThatOfTheLastFixture) {
  Folder folder;
  Load(folder / "frozen.db", "v" + std::to_string(kSchemaVersion) + ".sql");
  OpenFixed(folder / "new.db");
  EXPECT_EQ(SchemaOf(folder / "new.db"), SchemaOf(folder / "frozen.db"));
}

}  // namespace
}  // namespace touchdown::db
