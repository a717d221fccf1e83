// Real recordings against the hand measurements of their README
// (shared/footage/README.md). Skipped where they are not at hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "app/pipeline/analyze.h"
#include "tests/support/shared_data.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using ::testing::HasSubstr;

std::filesystem::path Footage(const char* name) {
  return testing::Shared(std::filesystem::path("footage") / name);
}

// pyMRAW's sphere: 15 frames of 384 x 384, 12 bit packed; it does not arrive.
TEST(Footage, BallTwelveBitHasNoContact) {
  const auto path = Footage("ball_12bit.mraw");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const Analysis analysis = Analyze(path);
  EXPECT_EQ(analysis.clip.first_camera_frame, 52);
  EXPECT_DOUBLE_EQ(analysis.clip.time_base.fps, 30000.0);
  ASSERT_TRUE(analysis.body) << analysis.no_body_reason;
  EXPECT_EQ(analysis.body->kind, core::BodyKind::kSphere);
  EXPECT_FALSE(analysis.contacts.first.contact.found);
  EXPECT_EQ(analysis.contacts.first.state.label, core::MotionState::kUndecided);
  EXPECT_FALSE(analysis.contacts.first.state.p_bounce);
  const vision::Track& track = *analysis.track;
  EXPECT_NEAR(track.body.radius_px.value, 63.2, 3 * 0.1);
  ASSERT_EQ(track.poses.size(), 15u);
  // Of the first and last centre three times the path's 0.004 px rms, and the
  // last digit given.
  EXPECT_NEAR(track.poses.front().centre.x_px, 175.13, 0.02);
  EXPECT_NEAR(track.poses.back().centre.x_px, 175.31, 0.02);
  EXPECT_NEAR(track.poses.front().centre.y_px, 109.60, 0.02);
  EXPECT_NEAR(track.poses.back().centre.y_px, 146.67, 0.02);
  double n = 0, sf = 0, sy = 0, sff = 0, sfy = 0;
  for (const vision::Pose& pose : track.poses) {
    const auto f = static_cast<double>(pose.frame);
    n += 1;
    sf += f;
    sff += f * f;
    sy += pose.centre.y_px;
    sfy += f * pose.centre.y_px;
  }
  const double speed = (n * sfy - sf * sy) / (n * sff - sf * sf);
  EXPECT_NEAR(speed, 2.6476, 3 * 0.0005);
  double square = 0.0;
  for (const vision::Pose& pose : track.poses) {
    const double r = pose.centre.y_px - sy / n -
                     speed * (static_cast<double>(pose.frame) - sf / n);
    square += r * r;
  }
  EXPECT_LT(std::sqrt(square / n), 0.012);
}

// A ball off a table, whose clip ends as it meets the floor.
TEST(Footage, GalileosProjectileIsUndecided) {
  const auto path = Footage("galileo_projectile.mp4");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  AnalyzeOptions options;
  options.fps = 30.0;
  options.scale_px_per_m = core::Estimate{318.3, 1.0, std::nullopt};
  options.ground = calib::GroundThrough({0, 440}, {640, 440});
  options.first_frame = 18;
  options.last_frame = 33;
  const Analysis analysis = Analyze(path, options);
  const core::ContactRecord& first = analysis.contacts.first;
  ASSERT_TRUE(first.contact.found) << first.contact.reason;
  EXPECT_NEAR(first.contact.approach_angle_rad->value / core::kDegree, 72.4,
              1.0);
  EXPECT_NEAR(first.contact.frame->value, 32.15, 0.6);
  EXPECT_EQ(first.state.label, core::MotionState::kUndecided);
  EXPECT_FALSE(first.state.p_bounce);
  EXPECT_NEAR(first.motion.before_tangential_mps->value, 1.49, 0.03);
}

// A block that slides down and up an inclined track, turned back by a spring: a
// reversal along the surface is no bounce.
TEST(Footage, BouncingCartNeverBounces) {
  const auto path = Footage("bouncing_cart.mov");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  // The line on which the block slides: 9.31 deg in the image.
  AnalyzeOptions options;
  options.fps = 30.0;
  options.ground = calib::GroundThrough({0, 300}, {640, 405}, 1.0);
  const Analysis analysis = Analyze(path, options);
  const core::ContactRecord& first = analysis.contacts.first;
  EXPECT_NE(first.state.label, core::MotionState::kBounce)
      << first.state.reason;
  EXPECT_TRUE(core::IsNotBounce(first.state.label)) << first.state.reason;
  for (const core::ContactRecord& later : analysis.contacts.later) {
    EXPECT_NE(later.state.label, core::MotionState::kBounce);
  }
}

}  // namespace
}  // namespace touchdown::pipeline
