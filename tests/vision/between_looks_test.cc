#include "vision/src/tracking/between_looks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "tests/vision/long_clip.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::vision {
namespace {

constexpr std::int64_t kStep = 8;  // frames
constexpr double kSpeed_px = 2.0;  // a frame

// Looks at a body that flies, and rebounds after frame `blow`.
struct Looks {
  std::vector<Fitted> fits;
  std::vector<Pose> poses;
};
Pose PoseAt(std::int64_t frame, double blow) {
  const auto t = static_cast<double>(frame);
  Pose pose;
  pose.frame = frame;
  pose.time_s = 1e-3 * t;
  pose.centre = {10.0 + kSpeed_px * t,
                 50.0 + 0.5 * std::abs(t - blow) + 1e-3 * t * t};
  pose.angle_rad = 0.01 * t + 1e-5 * t * t;
  pose.u_x_px = pose.u_y_px = 0.005;
  pose.u_angle_rad = 1e-4;
  return pose;
}
Looks LooksAt(std::size_t count, double blow) {
  Looks looks;
  for (std::size_t i = 0; i < count; ++i) {
    looks.poses.push_back(PoseAt(static_cast<std::int64_t>(i) * kStep, blow));
    Fitted fitted;
    fitted.frame = looks.poses.back().frame;
    fitted.fit.outline.radius_px = 20.0;
    looks.fits.push_back(fitted);
  }
  return looks;
}

TEST(CanBeBridged, AllButTheEndsOfASmoothPath) {
  const Looks looks = LooksAt(10, -100.0);
  const std::vector<bool> bridged =
      CanBeBridged(looks.fits, looks.poses, kStep);
  for (std::size_t i = 0; i < bridged.size(); ++i) {
    EXPECT_EQ(bridged[i], i >= 1 && i + 2 < bridged.size()) << i;
  }
}

TEST(CanBeBridged, NotNearABlow) {
  const Looks looks = LooksAt(20, 83.0);  // between looks 10 and 11
  const std::vector<bool> bridged =
      CanBeBridged(looks.fits, looks.poses, kStep);
  for (std::size_t i = 1; i + 2 < bridged.size(); ++i) {
    EXPECT_EQ(bridged[i], i < 8 || i > 12) << i;
  }
}

TEST(CanBeBridged, NotWhereALookIsMissingOrSeesTooLittle) {
  Looks looks = LooksAt(20, -100.0);
  looks.fits[12].fit.visible = 0.9;
  looks.fits.erase(looks.fits.begin() + 6);
  looks.poses.erase(looks.poses.begin() + 6);
  const std::vector<bool> bridged =
      CanBeBridged(looks.fits, looks.poses, kStep);
  // Look 12 is number 11 now; of the gap's two sides nothing tells.
  for (const std::size_t i : {4U, 5U, 6U, 9U, 10U, 11U, 12U}) {
    EXPECT_FALSE(bridged[i]) << i;
  }
  EXPECT_TRUE(bridged[2]);
  EXPECT_TRUE(bridged[14]);
}

TEST(CanBeBridged, NotWhereAHalfTurnMayHide) {
  Looks looks = LooksAt(10, -100.0);
  for (Pose& pose : looks.poses) pose.angle_rad *= 10.0;
  EXPECT_THAT(CanBeBridged(looks.fits, looks.poses, kStep),
              ::testing::Each(false));
}

TEST(Bridged, IsOnTheCubic) {
  const Looks looks = LooksAt(10, -100.0);
  Track track;
  track.poses = looks.poses;
  track.step = kStep;
  const Track whole = Bridged(track);
  ASSERT_EQ(whole.poses.size(), 9 * kStep + 1);
  for (std::size_t i = 0; i < whole.poses.size(); ++i) {
    const Pose& pose = whole.poses[i];
    const Pose truth = PoseAt(static_cast<std::int64_t>(i), -100.0);
    ASSERT_EQ(pose.frame, truth.frame);
    EXPECT_NEAR(pose.time_s, truth.time_s, 1e-12);
    // Between the first two and the last two the way is straight.
    const bool inside = i > kStep && i < 8 * kStep;
    const double most_px = inside ? 1e-9 : 1e-3 * kStep * kStep / 4.0 + 1e-9;
    EXPECT_NEAR(pose.centre.x_px, truth.centre.x_px, 1e-9);
    EXPECT_NEAR(pose.centre.y_px, truth.centre.y_px, most_px) << i;
    EXPECT_NEAR(pose.angle_rad, truth.angle_rad, 0.01 * most_px + 1e-12);
  }
  track.step = 1;
  EXPECT_EQ(Bridged(track).poses.size(), looks.poses.size());
}

TEST(MayChangeSize, HalfAPerCent) {
  for (const double growth : {0.0, 0.004, -0.004, 0.006, -0.006}) {
    Looks looks = LooksAt(30, -100.0);
    for (std::size_t i = 20; i < 30; ++i) {
      looks.fits[i].fit.outline.radius_px *= 1.0 + growth;
    }
    EXPECT_EQ(MayChangeSize(looks.fits), std::abs(growth) > 0.005) << growth;
  }
}

// A rendered clip that is read as a raw one.
class Raw : public Clip {
 public:
  explicit Raw(std::unique_ptr<Clip> clip) : clip_(std::move(clip)) {}
  const ClipInfo& info() const override { return clip_->info(); }
  bool windows_are_cheap() const override { return true; }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    return clip_->Read(index, window);
  }
  std::unique_ptr<Clip> clip_;
};

// What Refine measures does not depend on whether a first fit was there: the
// numbers that README.md states.
TEST(BetweenLooks, OneFitAFrameMeasuresTheSame) {
  const Scene scene = testing::LongScene(800);
  Raw clip(OpenScene(scene, 3));
  TrackOptions options;
  options.background_samples = 33;
  options.first_looks = 100;
  options.seen_whole_px = 0.0;
  const RefineOptions refine{TrueGroundLine(scene.camera), std::nullopt};
  const auto twice = TrackBody(clip, options);
  options.every_frame = false;
  const auto once = TrackBody(clip, options);
  ASSERT_TRUE(twice && once);
  EXPECT_EQ(twice->track.step, 1);
  EXPECT_EQ(once->track.step, kStep);
  EXPECT_LT(2 * once->track.poses.size(), twice->track.poses.size());
  const Track a = Refine(clip, twice->background, twice->track, refine);
  const Track b = Refine(clip, once->background, once->track, refine);
  const Track c = FitEveryFrame(clip, once->background, once->track, options);
  EXPECT_EQ(b.step, 1);
  EXPECT_EQ(c.step, 1);
  EXPECT_EQ(c.poses.size(), twice->track.poses.size());
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    const Pose& pose = a.poses[i];
    ASSERT_EQ(b.poses[i].frame, pose.frame);
    EXPECT_NEAR(b.poses[i].centre.x_px, pose.centre.x_px, 0.2 * pose.u_x_px);
    EXPECT_NEAR(b.poses[i].centre.y_px, pose.centre.y_px, 0.2 * pose.u_y_px);
  }
  EXPECT_NEAR(b.body.radius_px.value, a.body.radius_px.value,
              0.2 * a.body.radius_px.u);
}

}  // namespace
}  // namespace touchdown::vision
