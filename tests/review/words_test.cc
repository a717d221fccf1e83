#include "app/review/words.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "touchdown/core/quantities.h"
#include "touchdown/core/units.h"
#include "touchdown/db/register.h"

namespace touchdown::review {
namespace {

TEST(Words, EveryNumberOfAContactIsShownOnce) {
  const auto columns = ColumnsInOrder();
  ASSERT_EQ(columns.size(), core::kContactQuantities.size());
  for (const auto& quantity : core::kContactQuantities) {
    EXPECT_EQ(std::ranges::count(columns, quantity.name), 1) << quantity.name;
  }
}

TEST(Words, NoPersonReadsAFieldNameOrARadian) {
  const auto expect = [](std::string_view column) {
    const std::string label = Label(ShownAs(column));
    EXPECT_EQ(label.find('_'), std::string::npos) << label;
    EXPECT_FALSE(label.ends_with(" rad")) << label;
    EXPECT_EQ(label.find("rad/"), std::string::npos) << label;
  };
  for (const auto& quantity : core::kContactQuantities) expect(quantity.name);
  for (const auto& quantity : core::kBodyQuantities) expect(quantity.name);
  for (const auto& quantity : db::kConditionQuantities) expect(quantity.name);
  for (const auto& budget : core::kBudgets) {
    expect(std::string(budget.name) + "_budget");
  }
}

TEST(Words, AnglesAreInDegreesSpinIsInDegreesASecond) {
  const Shown angle = ShownAs("approach_angle_rad");
  EXPECT_EQ(angle.name, "approach_angle_deg");
  EXPECT_EQ(Label(angle), "approach angle, deg");
  EXPECT_DOUBLE_EQ(angle.factor, core::kDegree);
  const Shown spin = ShownAs("after_omega_rad_per_s");
  EXPECT_EQ(spin.name, "after_omega_deg_per_s");
  EXPECT_EQ(spin.unit, "deg/s");
  EXPECT_DOUBLE_EQ(spin.factor, core::kDegree);
}

TEST(Words, AColumnWithoutWordsIsToldByItsName) {
  EXPECT_EQ(Label(ShownAs("some_new_m")), "some new, mm");
}

}  // namespace
}  // namespace touchdown::review
