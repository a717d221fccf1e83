#include "touchdown/core/cancellation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <string>
#include <vector>

#include "touchdown/core/parallel.h"

namespace touchdown::core {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kNever_s = std::numeric_limits<double>::infinity();

std::string WhatIsSaid(const Cancellation& until, std::int64_t frame = -1) {
  try {
    until.Check(frame);
  } catch (const Cancelled& ended) {
    return ended.what();
  }
  return "";
}

TEST(Cancellation, EndsNothingUnlessItIsTold) {
  const Cancellation never;
  never.Enter("outlines are fitted");
  EXPECT_EQ(WhatIsSaid(never, 7), "");
  EXPECT_EQ(WhatIsSaid(Cancellation::After(1e6)), "");
  EXPECT_EQ(WhatIsSaid(Cancellation::After(kNever_s)), "");
}

TEST(Cancellation, SaysHowFarTheWorkGot) {
  const Cancellation until = Cancellation::After(1e-9);
  EXPECT_THAT(WhatIsSaid(until), HasSubstr("while the clip is opened"));
  until.Enter("outlines are fitted");
  EXPECT_EQ(WhatIsSaid(until, 31), "while outlines are fitted, at frame 31");
  // A look at no frame leaves the last one.
  EXPECT_EQ(WhatIsSaid(until), "while outlines are fitted, at frame 31");
}

TEST(Cancellation, TellsOfEachStageOnce) {
  std::vector<std::string> told;
  const Cancellation until = Cancellation::After(
      kNever_s, nullptr, [&](const char* stage) { told.push_back(stage); });
  constexpr const char* kFirst = "outlines are fitted";
  until.Enter(kFirst);
  until.Enter(kFirst);
  const Cancellation copy = until;
  copy.Enter("the ground is looked for");
  EXPECT_THAT(told,
              ElementsAre("outlines are fitted", "the ground is looked for"));
}

TEST(Cancellation, EndsWhenItIsInterrupted) {
  std::atomic<bool> interrupted = false;
  const Cancellation until = Cancellation::After(kNever_s, &interrupted);
  EXPECT_EQ(WhatIsSaid(until), "");
  interrupted = true;
  EXPECT_EQ(WhatIsSaid(until), "interrupted");
}

TEST(Cancellation, EndsAllThreadsOfOneWork) {
  std::atomic<bool> interrupted = false;
  const Cancellation until = Cancellation::After(kNever_s, &interrupted);
  const auto work = [&](std::int64_t begin, std::int64_t) {
    const Cancellation own = until;
    if (begin > 0) interrupted = true;
    while (true) own.Check();
  };
  EXPECT_THROW(InParallel(2, 2, work), Cancelled);
}

TEST(Cancellation, RefusesALimitThatIsNone) {
  for (const double limit_s :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(Cancellation::After(limit_s), std::invalid_argument);
  }
}

}  // namespace
}  // namespace touchdown::core
