#include "touchdown/db/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/db/fixture.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::db {
namespace {

core::Campaign Asphalt() {
  core::Campaign campaign;
  campaign.name = "asphalt";
  campaign.body = core::Sphere({0.04, 2e-5, {}});
  campaign.bounce_height_m = 8e-4;
  return campaign;
}

core::Trial Typed(double angle_rad) {
  core::Trial trial;
  trial.campaign = "asphalt";
  trial.origin = core::Origin::kManual;
  trial.body = Asphalt().body;
  trial.author = "A. Tester";
  trial.first.contact.found = true;
  trial.first.contact.approach_angle_rad = core::Estimate{angle_rad, 0.01, {}};
  trial.first.state.label = core::MotionState::kSlide;
  return trial;
}

const Plan kPlan{"ascending 2 deg steps", "after 40 trials", "5 %"};

TEST(Plan, IsKeptWithWhatWasDeclaredWhenAndByWhom) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(Asphalt());
  EXPECT_TRUE(PlanEvents(store, "asphalt").empty());
  SetPlan(store, "asphalt", kPlan, "A. Tester", "");
  (void)store.LogTrial(Typed(0.2));
  Plan changed = kPlan;
  changed.stopping_rule = "after 60 trials";
  EXPECT_THROW(SetPlan(store, "asphalt", changed, "A. Tester", ""),
               std::invalid_argument);
  SetPlan(store, "asphalt", changed, "A. Tester", "the springs came late");
  const auto events = PlanEvents(store, "asphalt");
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].plan, kPlan);
  EXPECT_EQ(events[0].trials, 0);
  EXPECT_EQ(events[1].plan, changed);
  EXPECT_EQ(events[1].trials, 1);
  EXPECT_EQ(events[1].reason, "the springs came late");
  EXPECT_LT(events[0].at_utc, events[1].at_utc);
}

TEST(Plan, NeedsACampaignAndAnAuthor) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  EXPECT_THROW(SetPlan(store, "gravel", kPlan, "A. Tester", ""),
               core::StoreError);
  store.AddCampaign(Asphalt());
  EXPECT_THROW(SetPlan(store, "asphalt", kPlan, "", ""), std::invalid_argument);
  EXPECT_TRUE(PlanEvents(store).empty());
}

TEST(Look, TheSameTrialsAreLookedAtOnce) {
  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  store.AddCampaign(Asphalt());
  (void)store.LogTrial(Typed(0.2));
  EXPECT_TRUE(RecordLook(store, "asphalt", "report"));
  EXPECT_FALSE(RecordLook(store, "asphalt", "boundary"));
  (void)store.LogTrial(Typed(0.3));
  EXPECT_TRUE(RecordLook(store, "asphalt", "boundary"));
  EXPECT_FALSE(RecordLook(store, "no such campaign", "report"));
  const auto events = PlanEvents(store);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].trials, 1);
  EXPECT_EQ(events[1].trials, 2);
  EXPECT_EQ(events[1].author, "boundary");
}

TEST(Plan, GoesWithAMergeOnce) {
  Folder folder;
  Store there = OpenFixed(folder / "there.db");
  there.AddCampaign(Asphalt());
  SetPlan(there, "asphalt", kPlan, "A. Tester", "");
  Store here = OpenFixed(folder / "here.db", 2);
  for (int i = 0; i < 2; ++i) (void)Merge(here, there);
  const auto events = PlanEvents(here, "asphalt");
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].id, PlanEvents(there, "asphalt")[0].id);
  EXPECT_EQ(events[0].plan, kPlan);
}

}  // namespace
}  // namespace touchdown::db
