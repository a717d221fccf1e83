// Real recordings, where they are at hand: the results must agree with the hand
// measurements in their README.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "app/measure/analyze.h"
#include "tests/support/shared_data.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;

std::filesystem::path Clip(const char* name) {
  return testing::Shared("footage") / name;
}

#define SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << (path) << " is not here"

TEST(Footage, ABacklitSphereThatHasNotLandedHasNoContact) {
  const auto path = Clip("ball_12bit.mraw");
  SKIP_WITHOUT(path);
  const Analysis a = Analyze(path);
  EXPECT_FALSE(a.contacts.first.contact.found);
  EXPECT_NE(a.contacts.first.contact.reason.find("never reaches zero"),
            std::string::npos);
  ASSERT_TRUE(a.track);
  const auto& poses = a.track->poses;
  ASSERT_EQ(poses.size(), 15u);
  // By hand 63.2 +- 0.1. The surround is saturated, so that the outer half of
  // the edge is cut off and the fit reads 0.5 px more; the centre is not
  // touched.
  EXPECT_NEAR(a.track->body.radius_px.value, 63.2, 0.6);
  EXPECT_NEAR(poses.front().centre.x_px, 175.13, 0.03);
  EXPECT_NEAR(poses.front().centre.y_px, 109.60, 0.03);
  EXPECT_NEAR(poses.back().centre.x_px, 175.31, 0.05);
  EXPECT_NEAR(poses.back().centre.y_px, 146.67, 0.03);
  const double v =
      (poses.back().centre.y_px - poses.front().centre.y_px) / 14.0;
  EXPECT_NEAR(v, 2.6476, 0.001);
  ASSERT_TRUE(a.ground);
  EXPECT_NEAR(calib::ImageAngle(*a.ground) / kDegree, 0.30, 0.1);
}

// With the scale and the floor as they are known.
AnalyzeOptions OfProjectile() {
  AnalyzeOptions options;
  options.fps = 30.0;
  options.scale_px_per_m = core::Estimate{318.3, 0.3};
  options.ground = calib::MakeGroundLine({0, 440}, {640, 440});
  return options;
}

TEST(Footage, AProjectileWithoutAFilmedReboundIsUndecided) {
  const auto path = Clip("galileo_projectile.mp4");
  SKIP_WITHOUT(path);
  AnalyzeOptions options = OfProjectile();
  options.first_frame = 17;
  options.last_frame = 33;
  const Analysis a = Analyze(path, options);
  const core::ContactRecord& first = a.contacts.first;
  ASSERT_TRUE(first.contact.found) << first.contact.reason;
  ASSERT_TRUE(first.contact.approach_angle_rad);
  EXPECT_NEAR(first.contact.approach_angle_rad->value / kDegree, 72.4, 1.0);
  EXPECT_NEAR(first.contact.frame->value, 32.15, 0.25);
  EXPECT_EQ(first.state.label, core::MotionState::kUndecided);
  EXPECT_FALSE(first.state.p_bounce);
  ASSERT_TRUE(first.motion.before_tangential_mps);
  EXPECT_NEAR(first.motion.before_tangential_mps->value, 1.49, 0.02);
  // With its own u; by hand 9.84 +- 0.05.
  ASSERT_TRUE(first.motion.gravity_check_mps2);
  const core::Estimate& g = *first.motion.gravity_check_mps2;
  EXPECT_LT(g.u, 0.05);
  EXPECT_LT(std::abs(g.value - core::kStandardGravity_mps2), 2.0 * g.u);
}

// From the captions of frame 0, along the rail, to the floor.
TEST(Footage, AProjectileIsFollowedFromTheRailOn) {
  const auto path = Clip("galileo_projectile.mp4");
  SKIP_WITHOUT(path);
  const Analysis a = Analyze(path, OfProjectile());
  ASSERT_TRUE(a.body);
  EXPECT_EQ(a.body->kind, core::BodyKind::kSphere);
  const core::ContactRecord& first = a.contacts.first;
  ASSERT_TRUE(first.contact.approach_angle_rad) << first.contact.reason;
  EXPECT_NEAR(first.contact.approach_angle_rad->value / kDegree, 72.4, 0.6);
  EXPECT_NEAR(first.contact.frame->value, 32.15, 0.25);
  EXPECT_EQ(first.state.label, core::MotionState::kUndecided);
  ASSERT_TRUE(first.motion.gravity_check_mps2);
  const core::Estimate& g = *first.motion.gravity_check_mps2;
  EXPECT_LT(std::abs(g.value - core::kStandardGravity_mps2), 2.0 * g.u);
}

// It ends as it lands. Edges that its path points at are in the picture.
TEST(Footage, AProjectileDoesNotSayWhichLineIsTheGround) {
  const auto path = Clip("galileo_projectile.mp4");
  SKIP_WITHOUT(path);
  AnalyzeOptions options;
  options.fps = 30.0;
  options.first_frame = 12;
  options.last_frame = 33;
  const Analysis a = Analyze(path, options);
  ASSERT_TRUE(a.track);
  EXPECT_EQ(a.track->poses.back().frame, 32);
  if (!a.contacts.first.contact.found) return;
  // Not the wall's edge, which it passes by two diameters.
  EXPECT_GT(a.contacts.first.contact.frame->value, 31.5);
  EXPECT_THAT(a.warnings,
              ::testing::Contains(::testing::HasSubstr("give --ground")));
}

TEST(Footage, ACartOnItsTrackNeverBounces) {
  const auto path = Clip("bouncing_cart.mov");
  SKIP_WITHOUT(path);
  AnalyzeOptions options;
  options.fps = 30.0;
  options.ground = calib::MakeGroundLine({0, 336}, {640, 230.5});
  const Analysis a = Analyze(path, options);
  EXPECT_TRUE(a.contacts.first.contact.from_start);
  EXPECT_EQ(a.contacts.first.state.label, core::MotionState::kSlide)
      << a.contacts.first.state.reason;
}

TEST(Footage, ABallWithTwoShadowsBouncesOffAGroundThatNoEdgeShows) {
  const auto path = Clip("red_ball.mp4");
  SKIP_WITHOUT(path);
  AnalyzeOptions options;
  options.fps = 29.97;
  const Analysis a = Analyze(path, options);
  ASSERT_TRUE(a.ground);
  EXPECT_EQ(a.ground->source, calib::GroundSource::kContactPoints);
  EXPECT_EQ(a.contacts.first.state.label, core::MotionState::kBounce);
  // Contact frames, approach angles and restitution by hand.
  const double frame[] = {7.41, 20.64, 30.33, 37.58, 43.16, 47.56};
  const double angle_deg[] = {88.5, 87.9, 84.4, 83.6};
  const double restitution[] = {0.73, 0.72, 0.73, 0.765};
  ASSERT_GE(a.contacts.later.size(), 5u);
  for (std::size_t i = 0; i < 6; ++i) {
    const core::ContactRecord& record =
        i == 0 ? a.contacts.first : a.contacts.later[i - 1];
    ASSERT_TRUE(record.contact.frame);
    EXPECT_NEAR(record.contact.frame->value, frame[i],
                0.06 + 2.0 * record.contact.frame->u)
        << i;
    if (i >= 4) continue;
    EXPECT_NEAR(record.contact.approach_angle_rad->value / kDegree,
                angle_deg[i],
                0.6 + record.contact.approach_angle_rad->u / kDegree)
        << i;
    ASSERT_TRUE(record.motion.restitution);
    EXPECT_NEAR(record.motion.restitution->value, restitution[i],
                0.02 + 2.0 * record.motion.restitution->u)
        << i;
    EXPECT_LT(record.motion.restitution->u, 0.05) << i;
  }
}

// A hoop with a white face and a dark mark, its side gray behind it: before the
// wall the mark is all that stands out, before the tiles the face. Its picture
// is followed, its gaps wander by a fifth of a pixel.
TEST(Footage, AHoopOnASteepRampIsFollowedAndNotSaidToBounce) {
  const auto path = Clip("roll_slip_42.4");
  SKIP_WITHOUT(path);
  AnalyzeOptions options;
  options.fps = 29.97;
  const Analysis a = Analyze(path, options);
  ASSERT_TRUE(a.track);
  EXPECT_TRUE(a.track->patterned);
  EXPECT_EQ(a.track->poses.size(), 23u);  // all
  // By hand 45.0 deg, of which nothing finer is known than 0.4 deg.
  ASSERT_TRUE(a.ground);
  EXPECT_EQ(a.ground->source, calib::GroundSource::kContactPoints);
  EXPECT_NEAR(calib::ImageAngle(*a.ground) / kDegree, 45.0, 0.8);
  EXPECT_TRUE(a.contacts.first.contact.from_start);
  const core::StateDecision& state = a.contacts.first.state;
  EXPECT_EQ(state.label, core::MotionState::kStaysDown) << state.reason;
  ASSERT_TRUE(state.p_bounce);
  EXPECT_LT(*state.p_bounce, 0.01);
}

TEST(Footage, AHoopOnAFlatRampStaysDown) {
  const auto path = Clip("roll_slip_17.6");
  SKIP_WITHOUT(path);
  AnalyzeOptions options;
  options.fps = 29.97;
  const Analysis a = Analyze(path, options);
  ASSERT_TRUE(a.track);
  EXPECT_TRUE(a.track->patterned);
  EXPECT_EQ(a.track->poses.size(), 37u);  // all
  ASSERT_TRUE(a.ground);
  EXPECT_NEAR(calib::ImageAngle(*a.ground) / kDegree, 19.7, 0.8);
  EXPECT_TRUE(a.contacts.first.contact.from_start);
  const core::StateDecision& state = a.contacts.first.state;
  EXPECT_EQ(state.label, core::MotionState::kStaysDown) << state.reason;
  ASSERT_TRUE(state.p_bounce);
  EXPECT_LT(*state.p_bounce, 0.01);
}

// A golf ball on a plate, 30 000 frames/s. What its makers' velocities say;
// the plate's slope is the picture's horizontal within a degree.
struct GolfShot {
  const char* name;
  double approach_deg;
  double speed_mps;
  double restitution;
  bool may_be_absent = false;  // with a reason; but never wrong
};

class FootageOfGolf : public ::testing::TestWithParam<GolfShot> {};

TEST_P(FootageOfGolf, IsRightOrAbsent) {
  const GolfShot& shot = GetParam();
  const auto path = Clip("golf") / (std::string(shot.name) + ".wmv");
  SKIP_WITHOUT(path);
  AnalyzeOptions options;
  options.fps = 30000.0;
  options.diameter_m = core::Estimate{0.04267, 0.0};
  const Analysis a = Analyze(path, options);
  const core::ContactRecord& first = a.contacts.first;
  if (shot.may_be_absent && !first.contact.found) {
    EXPECT_FALSE(first.contact.reason.empty());
    EXPECT_EQ(first.state.label, core::MotionState::kUndecided);
    return;
  }
  ASSERT_TRUE(first.contact.found) << first.contact.reason;
  EXPECT_EQ(first.state.label, core::MotionState::kBounce);
  ASSERT_TRUE(first.contact.approach_angle_rad);
  EXPECT_NEAR(first.contact.approach_angle_rad->value / kDegree,
              shot.approach_deg, 1.5);
  ASSERT_TRUE(first.motion.before_speed_mps);
  EXPECT_NEAR(first.motion.before_speed_mps->value / shot.speed_mps, 1.0, 0.04);
  if (first.motion.restitution) {
    EXPECT_NEAR(first.motion.restitution->value, shot.restitution, 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shots, FootageOfGolf,
    ::testing::Values(GolfShot{"oblique_1", 30.9, 51.1, 0.846},
                      GolfShot{"oblique_2", 31.0, 44.9, 0.865},
                      GolfShot{"oblique_3", 31.1, 38.0, 0.876},
                      GolfShot{"shallow_1", 68.2, 39.7, 0.816, true},
                      GolfShot{"shallow_2", 68.5, 30.8, 0.837}),
    [](const auto& shot) { return std::string(shot.param.name); });

// Balls filmed in passing: hands, people, a camera in a hand, a soft net, a
// rolling shutter. Two of four are found; none may be found wrong.
struct EverydayClip {
  const char* name;
  double fps;
  double diameter_m;
  double contact_frame;
  double u_frame;
  bool found;                // else it may be absent
  const char* because = "";  // which its reason says
};

class EverydayFootage : public ::testing::TestWithParam<EverydayClip> {};

TEST_P(EverydayFootage, IsRightOrAbsent) {
  const EverydayClip& clip = GetParam();
  const auto path = Clip("everyday") / (std::string(clip.name) + ".mp4");
  SKIP_WITHOUT(path);
  AnalyzeOptions options;
  options.fps = clip.fps;
  options.diameter_m = core::Estimate{clip.diameter_m, 0.0};
  const Analysis a = Analyze(path, options);
  const core::Contact& contact = a.contacts.first.contact;
  if (!contact.found) {
    EXPECT_FALSE(clip.found) << contact.reason;
    EXPECT_FALSE(contact.reason.empty());
    EXPECT_THAT(contact.reason, ::testing::HasSubstr(clip.because));
    EXPECT_EQ(a.contacts.first.state.label, core::MotionState::kUndecided);
    return;
  }
  ASSERT_TRUE(contact.frame);
  EXPECT_NEAR(contact.frame->value, clip.contact_frame,
              3.0 * std::hypot(clip.u_frame, contact.frame->u));
  EXPECT_EQ(a.contacts.first.state.label, core::MotionState::kBounce);
}

INSTANTIATE_TEST_SUITE_P(
    Clips, EverydayFootage,
    ::testing::Values(
        EverydayClip{"tennis_table", 25.0, 0.066, 66.42, 0.02, true},
        EverydayClip{"table_tennis_door", 20.0, 0.04, 16.43, 0.03, true},
        EverydayClip{"spikeball_net", 240.0, 0.089, 9.0, 1.5, false,
                     "the scene moves in all parts of the picture"},
        EverydayClip{"tennis_portrait", 30.0, 0.066, 14.58, 0.1, false}),
    [](const auto& shot) { return std::string(shot.param.name); });

}  // namespace
}  // namespace touchdown::pipeline
