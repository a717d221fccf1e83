#include "vision/src/outline/hider.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "touchdown/vision/synthetic/render.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::vision {
namespace {

constexpr double kRadius_px = 12.0;
constexpr int kFrames = 70;
constexpr int kPost_px = 70;  // the post hides what is left of it
constexpr double kSpeed_px = 1.5;

core::PixelPoint CentreAt(double frame) {
  return {40.0 + kSpeed_px * frame, 40.0 + 0.1 * frame};
}

Scene Behind(bool post) {
  Scene scene;
  scene.camera.width_px = 200;
  scene.camera.height_px = 100;
  scene.camera.px_per_m = 1000.0;
  scene.camera.ground_point = {0.0, 90.0};
  scene.camera.fps = 1000.0;
  scene.camera.exposure_s = 1e-5;
  scene.body = core::Sphere({2e-3 * kRadius_px, 0.0});
  scene.frames = kFrames;
  scene.noise.read_dn = 2.0;
  scene.pose = [](double t) {
    const core::PixelPoint at = CentreAt(1000.0 * t);
    return ScenePose{{1e-3 * at.x_px, 1e-3 * (90.0 - at.y_px)}, 0.0};
  };
  if (post) {
    scene.trouble.obstacle = core::PixelRect{-10, -10, kPost_px + 10, 200};
    scene.trouble.obstacle_level = 0.5;
  }
  return scene;
}

// Where the body is, told.
std::vector<OutlineJob> Jobs(int first, int last) {
  std::vector<OutlineJob> jobs;
  for (int f = first; f <= last; ++f) {
    OutlineJob job;
    job.frame = f;
    job.start.radius_px = kRadius_px;
    job.start.centre = CentreAt(f);
    job.travel_px = {kSpeed_px, 0.1};
    jobs.push_back(job);
  }
  return jobs;
}

// The still picture, post and all.
Background StillOf(Scene scene) {
  scene.noise = {};
  scene.pose = [](double) { return ScenePose{{10.0, 10.0}, 0.0}; };
  Background background;
  background.width_px = scene.camera.width_px;
  background.height_px = scene.camera.height_px;
  std::mt19937_64 engine(1);
  const SensorImage still = RenderFrame(SceneRenderer(scene), 0, engine);
  for (int y = 0; y < scene.camera.height_px; ++y) {
    for (int x = 0; x < scene.camera.width_px; ++x) {
      background.level.push_back(static_cast<float>(still.view().at(x, y)));
    }
  }
  background.noise_floor_dn2 = 4.0;
  return background;
}

HiderOptions Options(const Scene& scene) {
  HiderOptions options;
  options.body_dn = 255.0 * scene.look.body_level;
  return options;
}

TEST(Hider, IsFoundWhereThePostIsAndNowhereElse) {
  const Scene scene = Behind(true);
  const auto clip = OpenScene(scene, 1);
  const auto hider =
      FindHider(*clip, StillOf(scene), Jobs(15, 60), Options(scene));
  ASSERT_TRUE(hider);
  // What the body should have covered of it, and the blurred edge beside.
  constexpr double kReach_px = 8.0;
  for (const double y : {36.0, 40.0, 44.0, 48.0}) {
    EXPECT_TRUE(hider->Hides(kPost_px - 4.0, y)) << y;
    EXPECT_FALSE(hider->Hides(kPost_px + kReach_px, y)) << y;
  }
  EXPECT_FALSE(hider->Hides(-5.0, 40.0));
  EXPECT_FALSE(hider->Hides(1e4, 1e4));
}

TEST(Hider, NothingIsFoundOfABodyInTheOpen) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = Behind(false);
    const auto clip = OpenScene(scene, seed);
    EXPECT_FALSE(FindHider(*clip, StillOf(scene), Jobs(0, 60), Options(scene)));
  }
}

// Where it is not in the picture at all, nothing need stand before it.
TEST(Hider, ABodyThatIsNotThereIsNotHidden) {
  Scene scene = Behind(false);
  const PoseFunction there = scene.pose;
  scene.pose = [there](double t) {
    return t < 0.0295 ? ScenePose{{10.0, 10.0}, 0.0} : there(t);
  };
  const auto clip = OpenScene(scene, 1);
  EXPECT_FALSE(FindHider(*clip, StillOf(scene), Jobs(10, 60), Options(scene)));
}

TEST(Hider, PredictContinuesAFlightAndKnowsWhereItCannot) {
  std::vector<Fitted> fits;
  for (int f = 20; f < 40; ++f) {
    Fitted fit;
    fit.frame = f;
    fit.fit.outline.radius_px = kRadius_px;
    fit.fit.outline.centre = {10.0 + 2.0 * f, 50.0 - 1.0 * f + 0.03 * f * f};
    fits.push_back(fit);
  }
  for (const int frame : {10, 19, 25, 45}) {
    const auto job = Predict(fits, frame, 0.0);
    ASSERT_TRUE(job) << frame;
    EXPECT_EQ(job->frame, frame);
    EXPECT_NEAR(job->start.centre.x_px, 10.0 + 2.0 * frame, 1e-9);
    EXPECT_NEAR(job->start.centre.y_px,
                50.0 - 1.0 * frame + 0.03 * frame * frame, 1e-8);
    EXPECT_NEAR(job->travel_px.x_px, 2.0, 1e-9);
    EXPECT_NEAR(job->travel_px.y_px, -1.0 + 0.06 * frame, 1e-9);
  }
  EXPECT_FALSE(Predict(fits, 400, 0.0));  // too far
  EXPECT_FALSE(Predict({fits.data(), 5}, 19, 0.0));
  // No flight: it jumps about.
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> jump(-8.0, 8.0);
  for (Fitted& fit : fits) fit.fit.outline.centre.x_px += jump(engine);
  EXPECT_FALSE(Predict(fits, 19, 0.0));
}

// The chain: frames in which the post hides a little of the body are neither
// taken for whole nor lost.
TEST(Hider, PosesBehindAPostAreMeasuredWithoutIt) {
  const Scene scene = Behind(true);
  const auto clip = OpenScene(scene, 1);
  const auto found = TrackBody(*clip);
  ASSERT_TRUE(found);
  RefineOptions options;
  options.ground = calib::MakeGroundLine({0.0, 90.0}, {200.0, 90.0});
  const Track track = Refine(*clip, found->background, found->track, options);
  // Clear of the post from (70 + 12 - 40) / 1.5 = 28 on; half of it shows from
  // 20 on.
  int partly = 0;
  for (const Pose& pose : track.poses) {
    const core::PixelPoint truth = CentreAt(static_cast<double>(pose.frame));
    EXPECT_LT(std::abs(pose.centre.x_px - truth.x_px), 5.0 * pose.u_x_px)
        << pose.frame;
    EXPECT_LT(std::abs(pose.centre.y_px - truth.y_px), 5.0 * pose.u_y_px)
        << pose.frame;
    partly += pose.frame < 28;
  }
  EXPECT_GE(partly, 4);
  EXPECT_NEAR(track.body.radius_px.value, kRadius_px,
              4.0 * track.body.radius_px.u);
}

}  // namespace
}  // namespace touchdown::vision
