#include "app/session/session_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"

namespace touchdown::session {
namespace {

using ::testing::HasSubstr;

TEST(SessionFile, ComesBack) {
  const testing::TemporaryFolder folder;
  const auto store = folder / "lab.db";
  EXPECT_FALSE(ReadSession(store));
  SessionFile file;
  file.campaign = "asphalt, \"dry\"";
  file.operator_name = "\xc3\x84nne";
  file.phase = Phase::kCheck;
  file.planned = true;
  file.trials_before = 17;
  file.planned_at_s = 1795255000.125;
  file.angle_rad = 0.1 + 0.2;  // to the last bit
  file.is_check = true;
  file.last = {{"trial", "x"}};
  WriteSession(store, file);
  const auto back = ReadSession(store);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->campaign, file.campaign);
  EXPECT_EQ(back->operator_name, file.operator_name);
  EXPECT_EQ(back->phase, Phase::kCheck);
  EXPECT_EQ(back->trials_before, 17u);
  EXPECT_EQ(back->planned_at_s, file.planned_at_s);
  EXPECT_EQ(back->angle_rad, file.angle_rad);
  EXPECT_TRUE(back->is_check);
  EXPECT_EQ(back->last, file.last);
  EXPECT_THAT(testing::ReadAll(SessionPath(store)),
              HasSubstr("\"schema\": \"touchdown.session/1\""));
}

TEST(SessionFile, DamagedIsAsIfItWereNotThere) {
  const testing::TemporaryFolder folder;
  const auto store = folder / "lab.db";
  WriteSession(store, {});
  const std::string whole = testing::ReadAll(SessionPath(store));
  for (std::size_t n = 0; n + 2 < whole.size(); n += 7) {
    folder.Write("lab.db.session.json", whole.substr(0, n));
    EXPECT_FALSE(ReadSession(store)) << n;
  }
  folder.Write("lab.db.session.json",
               "{\"schema\": \"touchdown.session/1\", \"campaign\": 5}");
  EXPECT_FALSE(ReadSession(store));
  // A phase of another version of the program.
  const std::size_t at = whole.find("conventions");
  folder.Write("lab.db.session.json",
               std::string(whole).replace(at, 11, "sleeping"));
  EXPECT_FALSE(ReadSession(store));
}

TEST(SessionLock, IsForOneAtATime) {
  const testing::TemporaryFolder folder;
  const auto store = folder / "lab.db";
  {
    const SessionLock lock(store);
    EXPECT_THROW(SessionLock second(store), core::StoreError);
  }
  const SessionLock again(store);
}

}  // namespace
}  // namespace touchdown::session
