#include "touchdown/rig/driver/manual_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <stdexcept>
#include <vector>

namespace touchdown::rig {
namespace {

using core::literals::operator""_deg;
using core::literals::operator""_mm;
using ::testing::HasSubstr;

constexpr Setting kWanted{30.0_mm, 12.5_deg, 300.0_mm};

// A technician who answers what the test says, then walks away.
struct Technician {
  std::deque<std::string> answers;
  std::vector<std::string> asked;
  std::function<void()> before_answer;

  Question Ask() {
    return [this](const std::string& question) -> std::optional<std::string> {
      asked.push_back(question);
      if (before_answer) before_answer();
      if (answers.empty()) return std::nullopt;
      std::string answer = answers.front();
      answers.pop_front();
      return answer;
    };
  }
};

TEST(ManualDriver, TakesTheReadingOfTheProtractor) {
  Technician person{{"12.4", "", "30.5"}, {}, {}};
  ManualDriver driver(person.Ask());
  const auto read = driver.Set(kWanted);
  ASSERT_TRUE(read) << read.error().reason;
  EXPECT_DOUBLE_EQ(read->elevation_rad, 12.4_deg);
  EXPECT_DOUBLE_EQ(read->muzzle_height_m, 300.0_mm);
  EXPECT_DOUBLE_EQ(read->compression_m, 30.5_mm);
  EXPECT_THAT(person.asked[0], HasSubstr("12.50"));
}

TEST(ManualDriver, AsksAgainAndGivesUp) {
  Technician person{{"twelve", "14", "12.6", "", ""}, {}, {}};
  ManualDriver driver(person.Ask());
  ASSERT_TRUE(driver.Set(kWanted));
  EXPECT_THAT(person.asked[1], HasSubstr("'twelve' is no number"));
  EXPECT_THAT(person.asked[2], HasSubstr("14 is not within 0.5"));

  person.answers = {"14", "nan", "11"};
  const auto refused = driver.Set(kWanted);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().reason, HasSubstr("could not be set"));
  EXPECT_FALSE(driver.Status().setting);
  EXPECT_THAT(driver.Arm().error().reason, HasSubstr("nothing is set"));
}

TEST(ManualDriver, FiresOnlyWithEverybodyClear) {
  Technician person{{"", "", "", "yes", "yes", "yes", "yes"}, {}, {}};
  ManualDriver driver(person.Ask());
  ASSERT_TRUE(driver.Set(kWanted));
  const auto arming = driver.Arm();
  ASSERT_TRUE(arming);
  const auto shots = driver.Fire({"A. Lee", arming->number});
  ASSERT_TRUE(shots) << shots.error().reason;
  EXPECT_EQ(*shots, 1);
  // Used up.
  EXPECT_FALSE(driver.Fire({"A. Lee", arming->number}));

  person.answers = {"yes", "yes", "no", ""};  // armed; not clear; unlatched
  const auto second = driver.Arm();
  ASSERT_TRUE(second);
  EXPECT_THAT(driver.Fire({"A. Lee", second->number}).error().reason,
              HasSubstr("interlock is open"));
  EXPECT_TRUE(person.answers.empty());
  EXPECT_THROW(driver.Fire({"", 1}), std::invalid_argument);
}

TEST(ManualDriver, StopsInTheMiddleOfAQuestion) {
  Technician person{{"", "", ""}, {}, {}};
  ManualDriver driver(person.Ask());
  person.before_answer = [&] {
    if (person.asked.size() == 2) driver.Stop();
  };
  EXPECT_EQ(driver.Set(kWanted).error().reason, "stopped");
  EXPECT_EQ(person.asked.size(), 2u);
  EXPECT_THAT(driver.Set(kWanted).error().reason, HasSubstr("was stopped"));
  EXPECT_TRUE(driver.Reset("A. Lee"));
  person.answers = {"", "", ""};
  EXPECT_TRUE(driver.Set(kWanted));
  EXPECT_THROW(driver.Set({1.0, std::nan(""), 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
