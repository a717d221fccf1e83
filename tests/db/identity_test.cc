#include "touchdown/db/identity.h"

#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <set>

namespace touchdown::db {
namespace {

// RFC 9562, appendix A.3 gives a version 4 UUID; its 122 random bits in, the
// same text out.
TEST(UuidFromBits, IsTheExampleOfTheStandard) {
  EXPECT_EQ(UuidFromBits(0x919108f752d133'20ULL, 0x5bacf847db4148a8ULL),
            "919108f7-52d1-4320-9bac-f847db4148a8");
}

TEST(RandomUuid, IsOneAndNeverRepeats) {
  std::mt19937_64 engine(7);
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string uuid = RandomUuid(engine);
    ASSERT_TRUE(IsUuid(uuid)) << uuid;
    EXPECT_EQ(uuid[14], '4');
    EXPECT_NE(std::string("89ab").find(uuid[19]), std::string::npos);
    EXPECT_TRUE(seen.insert(uuid).second);
  }
}

TEST(IsUuid, RefusesWhatIsNot) {
  EXPECT_FALSE(IsUuid(""));
  EXPECT_FALSE(IsUuid("919108F7-52D1-4320-9BAC-F847DB4148A8"));
  EXPECT_FALSE(IsUuid("919108f7-52d1-4320-9bac-f847db4148a"));
  EXPECT_FALSE(IsUuid("919108f7a52d1-4320-9bac-f847db4148a8"));
}

TEST(UuidOfPair, IsTheSameEitherWayRound) {
  std::mt19937_64 engine(8);
  const std::string a = RandomUuid(engine);
  const std::string b = RandomUuid(engine);
  EXPECT_TRUE(IsUuid(UuidOfPair(a, b)));
  EXPECT_EQ(UuidOfPair(a, b), UuidOfPair(b, a));
  EXPECT_NE(UuidOfPair(a, b), a);
  EXPECT_THROW(UuidOfPair(a, "b"), std::invalid_argument);
}

TEST(UtcStamp, IsIso8601WithMilliseconds) {
  using std::chrono::milliseconds;
  using std::chrono::system_clock;
  EXPECT_EQ(UtcStamp(system_clock::time_point(milliseconds(0))),
            "1970-01-01T00:00:00.000Z");
  // 2^31 seconds: the end of 32-bit time.
  EXPECT_EQ(UtcStamp(system_clock::time_point(milliseconds(2147483648125))),
            "2038-01-19T03:14:08.125Z");
  EXPECT_EQ(UtcStamp(system_clock::time_point(milliseconds(-1))),
            "1969-12-31T23:59:59.999Z");
  EXPECT_TRUE(IsUtcStamp("2026-08-01T09:30:00.125Z"));
  EXPECT_FALSE(IsUtcStamp("2026-08-01 09:30:00.125Z"));
  EXPECT_FALSE(IsUtcStamp("2026-08-01"));
}

TEST(SystemSources, GiveAStampAndAUuid) {
  const Sources sources = SystemSources();
  EXPECT_TRUE(IsUtcStamp(sources.now_utc()));
  EXPECT_TRUE(IsUuid(sources.new_uuid()));
  EXPECT_NE(sources.new_uuid(), sources.new_uuid());
}

}  // namespace
}  // namespace touchdown::db
