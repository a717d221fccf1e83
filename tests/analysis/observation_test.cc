#include "touchdown/analysis/statistics/observation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::kDegree;
using ::testing::HasSubstr;
using ::testing::SizeIs;

core::Trial ATrial(double angle_deg, core::MotionState state) {
  core::Trial trial;
  trial.campaign = "c";
  trial.first.contact.approach_angle_rad =
      core::Estimate{angle_deg * kDegree, 0.1 * kDegree};
  trial.first.state.label = state;
  return trial;
}

TEST(Observe, DecidesByTheInterval) {
  EXPECT_EQ(Observe(0.1, 0.0, 1.0).outcome, Outcome::kBounce);
  EXPECT_EQ(Observe(0.1, 0.0, 0.98).outcome, Outcome::kBounce);
  EXPECT_EQ(Observe(0.1, 0.0, 0.97).outcome, Outcome::kUndecided);
  EXPECT_EQ(Observe(0.1, 0.0, 0.03).outcome, Outcome::kUndecided);
  EXPECT_EQ(Observe(0.1, 0.0, 0.02).outcome, Outcome::kNotBounce);
}

TEST(Observe, RefusesImpossibleNumbersByName) {
  const auto message = [](double angle, double u, double p) -> std::string {
    try {
      Observe(angle, u, p);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "nothing thrown";
  };
  EXPECT_THAT(message(-0.1, 0, 0), HasSubstr("angle_rad"));
  EXPECT_THAT(message(1.6, 0, 0), HasSubstr("angle_rad"));
  EXPECT_THAT(message(0.1, -1, 0), HasSubstr("u_rad"));
  EXPECT_THAT(message(0.1, 0, 1.5), HasSubstr("p_bounce"));
}

TEST(GroupTrials, NeverPoolsOriginsKindsBodiesOrCampaigns) {
  std::vector<core::Trial> trials(5, ATrial(10, core::MotionState::kBounce));
  trials[1].origin = core::Origin::kSimulated;
  trials[2].angle_kind = core::AngleKind::kRadius;
  trials[2].first.contact.radius_angle_rad = core::Estimate{0.2, 0.0};
  trials[3].body.kind = core::BodyKind::kRectangle;
  trials[4].campaign = "d";
  const auto groups = GroupTrials(trials);
  ASSERT_THAT(groups, SizeIs(5));
  for (const TrialGroup& group : groups) {
    EXPECT_THAT(group.observations, SizeIs(1));
  }
}

TEST(GroupTrials, LeavesOutWithAReason) {
  std::vector<core::Trial> trials(3, ATrial(10, core::MotionState::kSlide));
  trials[0].excluded = true;
  trials[0].exclusion_reason = "lamp failed";
  trials[1].first.contact.approach_angle_rad =
      core::AbsentBecause("two bodies");
  const auto groups = GroupTrials(trials);
  ASSERT_THAT(groups, SizeIs(1));
  ASSERT_THAT(groups[0].left_out, SizeIs(2));
  EXPECT_EQ(groups[0].left_out[0].reason, "excluded: lamp failed");
  EXPECT_EQ(groups[0].left_out[1].reason, "no approach angle: two bodies");
  ASSERT_THAT(groups[0].observations, SizeIs(1));
  EXPECT_EQ(groups[0].observations[0].trial, 2u);
}

TEST(GroupTrials, EveryNotBounceIsOneOutcome) {
  using core::MotionState;
  for (const MotionState state :
       {MotionState::kSlide, MotionState::kRollSlide, MotionState::kRoll,
        MotionState::kStick, MotionState::kStaysDown}) {
    const std::vector trials{ATrial(10, state)};
    const auto groups = GroupTrials(trials);
    EXPECT_EQ(groups[0].observations[0].outcome, Outcome::kNotBounce);
    EXPECT_EQ(groups[0].observations[0].p_bounce, 0.0);
  }
}

TEST(GroupTrials, ADecidedTrialKeepsAProbabilityThatAgrees) {
  std::vector trials(2, ATrial(10, core::MotionState::kBounce));
  trials[0].first.state.p_bounce = 0.999;
  trials[1].first.state.p_bounce = 0.4;  // the label was corrected by hand
  const auto groups = GroupTrials(trials);
  EXPECT_EQ(groups[0].observations[0].p_bounce, 0.999);
  EXPECT_EQ(groups[0].observations[1].p_bounce, 1.0);
}

TEST(GroupTrials, AnUndecidedTrialKeepsItsProbability) {
  std::vector trials(1, ATrial(10, core::MotionState::kUndecided));
  trials[0].first.state.p_bounce = 0.8;
  const auto groups = GroupTrials(trials);
  EXPECT_EQ(groups[0].observations[0].p_bounce, 0.8);
  EXPECT_EQ(groups[0].observations[0].outcome, Outcome::kUndecided);
}

// A film that ends while the body rises says nothing of the boundary, also
// where an earlier program computed P(bounce) from the gap filmed so far.
TEST(GroupTrials, AReboundThatWasNotFilmedToItsTopIsLeftOutWithItsReason) {
  std::vector trials(2, ATrial(10, core::MotionState::kUndecided));
  core::StateDecision& state = trials[0].first.state;
  state.reason = "the film ends while the body rises";
  state.extrapolated_gap_m = core::Estimate{2.1e-3, 0.3e-3};
  trials[1].first.state.p_bounce = 0.0;
  const auto groups = GroupTrials(trials);
  ASSERT_THAT(groups, SizeIs(1));
  EXPECT_THAT(groups[0].observations, SizeIs(0));
  ASSERT_THAT(groups[0].left_out, SizeIs(2));
  EXPECT_EQ(groups[0].left_out[0].reason,
            "undecided, without a P(bounce): the film ends while the body "
            "rises; the flight would reach 2.1 +- 0.3 mm");
  EXPECT_EQ(groups[0].left_out[1].reason, "undecided, without a P(bounce)");
}

TEST(GroupTrials, AFaceAngleEntersByItsMagnitude) {
  core::Trial trial = ATrial(10, core::MotionState::kBounce);
  trial.angle_kind = core::AngleKind::kFace;
  trial.first.contact.face_angle_rad = core::Estimate{-0.3, 0.01};
  const auto groups = GroupTrials(std::vector{trial});
  EXPECT_EQ(groups[0].observations[0].angle_rad, 0.3);
}

}  // namespace
}  // namespace touchdown::analysis
