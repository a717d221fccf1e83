// Queries stay as fast as they are in a small store: SQLite's own plan of each
// says that it searches an index and scans no table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <string>
#include <vector>

#include "db/src/register_rows.h"
#include "db/src/rows.h"
#include "tests/db/fixture.h"

namespace touchdown::db {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class QueryPlan : public ::testing::Test {
 protected:
  void SetUp() override {
    Store store = OpenFixed(folder_ / "lab.db");
    store.AddCampaign(SphereCampaign());
    store.LogTrial(SphereTrial(1));
  }

  std::string Of(const std::string& sql) {
    sqlite3* handle = nullptr;
    sqlite3_open((folder_ / "lab.db").c_str(), &handle);
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(handle, ("EXPLAIN QUERY PLAN " + sql).c_str(),
                                 -1, &statement, nullptr),
              SQLITE_OK)
        << sqlite3_errmsg(handle);
    std::string plan;
    while (sqlite3_step(statement) == SQLITE_ROW) {
      plan += reinterpret_cast<const char*>(sqlite3_column_text(statement, 3));
      plan += '\n';
    }
    sqlite3_finalize(statement);
    sqlite3_close(handle);
    return plan;
  }

 private:
  Folder folder_;
};

TEST_F(QueryPlan, TheReportSearchesItsCampaignOnly) {
  for (const bool documents : {false, true}) {
    const std::string plan = Of(TrialsSql({.campaign = "asphalt",
                                           .origin = core::Origin::kRecorded,
                                           .excluded = false,
                                           .with_documents = documents}));
    EXPECT_THAT(plan, HasSubstr("SEARCH t USING INDEX "
                                "trials_by_campaign_and_clip (<expr>=?)"));
    EXPECT_THAT(plan, Not(HasSubstr("SCAN")));
  }
}

TEST_F(QueryPlan, EveryFilterOfACampaignSearches) {
  const std::string plan = Of(TrialsSql({.campaign = "asphalt",
                                         .origin = core::Origin::kRecorded,
                                         .body = core::BodyKind::kSphere,
                                         .state = core::MotionState::kBounce,
                                         .from_utc = "2026",
                                         .until_utc = "2027",
                                         .excluded = false}));
  EXPECT_THAT(plan, Not(HasSubstr("SCAN")));
}

TEST_F(QueryPlan, DatesSearchTheirIndex) {
  const std::string plan =
      Of(TrialsSql({.from_utc = "2026-08-01", .until_utc = "2026-08-02"}));
  EXPECT_THAT(plan, AllOf(HasSubstr("trials_by_date"), Not(HasSubstr("SCAN"))));
}

// Without a filter all trials are wanted: one pass over them, and nothing else
// is scanned.
TEST_F(QueryPlan, AListOfEverythingScansTrialsOnly) {
  std::string plan = Of(TrialsSql({}));
  const auto scan = plan.find("SCAN t\n");
  ASSERT_NE(scan, std::string::npos) << plan;
  plan.erase(scan, 4);
  EXPECT_THAT(plan, Not(HasSubstr("SCAN")));
}

TEST_F(QueryPlan, OneTrialIsFoundByItsIndex) {
  EXPECT_THAT(Of(SelectRevisions(true) +
                 "WHERE t.uuid = ? ORDER BY r.number DESC LIMIT 1"),
              Not(HasSubstr("SCAN")));
  EXPECT_THAT(Of("SELECT uuid FROM trials WHERE uuid >= ?1 AND uuid < ?1 || "
                 "'g' ORDER BY uuid LIMIT 3"),
              HasSubstr("SEARCH trials USING COVERING INDEX"));
  EXPECT_THAT(
      Of("SELECT id, uuid, origin FROM trials WHERE "
         "ifnull(campaign_id, 0) = ? AND clip_id = ?"),
      HasSubstr("trials_by_campaign_and_clip (<expr>=? AND clip_id=?)"));
}

TEST_F(QueryPlan, WhatWasLoggedOfAClipIsFoundByItsIndex) {
  EXPECT_THAT(Of(std::string(LastLoggedSql())), Not(HasSubstr("SCAN")));
}

TEST_F(QueryPlan, AnEntryInForceIsFoundByItsIndex) {
  for (const RegisterKind kind : kRegisterKinds) {
    const std::string table(FindTable(kind).table);
    EXPECT_EQ(Of("SELECT id FROM " + table + " WHERE name = ? ORDER BY " +
                 std::string(kInForceFirst) + " LIMIT 1"),
              "SEARCH " + table + " USING COVERING INDEX " + table +
                  "_by_name (name=?)\n");
  }
}

}  // namespace
}  // namespace touchdown::db
