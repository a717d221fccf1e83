#include "app/review/changes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "touchdown/core/units.h"

namespace touchdown::review {
namespace {

using nlohmann::ordered_json;

core::Measured Angle(double deg) {
  return core::Estimate{deg * core::kDegree, 0.05 * core::kDegree,
                        std::nullopt};
}

TEST(ChangesJson, SaysEveryNumberInTheUnitsThatPeopleRead) {
  core::Trial before;
  before.later.resize(1);
  core::Trial after = before;
  after.set_angle_rad = 20 * core::kDegree;
  after.body.diameter_m = core::Estimate{0.04, 2e-5, std::nullopt};
  after.first.contact.face_angle_rad = Angle(-12.5);
  after.first.contact.approach_budget = {{"ground", 0.02 * core::kDegree}};
  after.first.motion.before_omega_rad_per_s =
      core::Estimate{180 * core::kDegree, core::kDegree, std::nullopt};
  after.later[0].contact.approach_angle_rad = Angle(8);
  after.conditions.emplace();
  after.conditions->elevation_rad = Angle(30);
  const ordered_json changes = ChangesJson(before, after);
  const auto to = [&](const std::string& words) {
    for (const auto& change : changes) {
      if (change["words"] == words) return change["to"].get<std::string>();
    }
    return "no " + words + " in " + changes.dump();
  };
  EXPECT_EQ(to("set angle, deg"), "20");
  EXPECT_EQ(to("diameter, mm"), "40.000 ± 0.020");
  EXPECT_EQ(to("face angle (+: leading end up), deg"), "-12.500 ± 0.050");
  EXPECT_EQ(to("uncertainty of the approach angle, from"), "ground 0.0200 deg");
  EXPECT_EQ(to("spin at touchdown, deg/s"), "180.0 ± 1.0");
  EXPECT_EQ(to("contact 2: approach angle, deg"), "8.000 ± 0.050");
  EXPECT_EQ(to("conditions: elevation, as set, deg"), "30.000 ± 0.050");
  EXPECT_EQ(changes.size(), 7u) << changes.dump(2);
}

TEST(ChangesJson, SpeaksOfTheDocumentWhereNothingElseChanged) {
  core::Trial before;
  core::Trial after;
  after.document_json = "{}";
  ASSERT_EQ(ChangesJson(before, after).size(), 1u);
  EXPECT_EQ(ChangesJson(before, after)[0]["field"], "document");
  after.first.state.label = core::MotionState::kSlide;
  ASSERT_EQ(ChangesJson(before, after).size(), 1u);
  EXPECT_EQ(ChangesJson(before, after)[0]["words"], "motion state");
}

}  // namespace
}  // namespace touchdown::review
