// The greatest gap after touchdown, of flights and of frames.
#include "vision/src/contact/greatest_gap.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "touchdown/core/units.h"
#include "touchdown/vision/contact/state.h"

namespace touchdown::vision {
namespace {

constexpr double kGravity = core::kStandardGravity_mps2 * 1000.0;  // px/s^2
constexpr double kRadius_px = 20.0;

PlaneTrack Gaps(const std::vector<double>& gaps, double u,
                double interval_s = 1e-3) {
  PlaneTrack track;
  track.half_long_px = track.half_short_px = kRadius_px;
  track.frame_interval_s = interval_s;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    PlaneSample s;
    s.frame = static_cast<std::int64_t>(i);
    s.time_s = static_cast<double>(i) * interval_s;
    s.gap_px = gaps[i];
    s.height_px = gaps[i] + kRadius_px;
    s.u_gap_px = s.u_height_px = s.u_along_px = u;
    track.samples.push_back(s);
  }
  return track;
}

FlightOptions KnownGravity() {
  FlightOptions options;
  options.gravity_px_per_s2 = core::Estimate{kGravity, 1e-6 * kGravity};
  return options;
}

std::optional<GreatestGap> Find(const PlaneTrack& track,
                                const std::vector<Stretch>& stretches,
                                const GroundLevel& ground = {}) {
  return FindGreatestGap(track, stretches, 0, ground, KnownGravity(), nullptr);
}

double Fall(double v, double t) { return v * t - 0.5 * kGravity * t * t; }

TEST(GreatestGap, OfAFlightIsItsTopBetweenFrames) {
  std::vector<double> gaps;
  for (int i = 0; i < 60; ++i) gaps.push_back(Fall(300.0, i * 1e-3));
  const PlaneTrack track = Gaps(gaps, 0.02);
  const auto found =
      Find(track, {{{0, gaps.size()}, StretchKind::kFlight, 0.0, 0}});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->gap_px.value, 300.0 * 300.0 / (2.0 * kGravity), 1e-3);
  EXPECT_NEAR(static_cast<double>(found->frame), 30.6, 1.0);
  EXPECT_FALSE(found->reaches_px);
  // Above a ground elsewhere, whose u it takes over.
  const auto shifted =
      Find(track, {{{0, gaps.size()}, StretchKind::kFlight, 0.0, 0}},
           {0.0, {1.5, 0.3}, 0.0});
  EXPECT_NEAR(shifted->gap_px.value, found->gap_px.value - 1.5, 1e-9);
  EXPECT_NEAR(shifted->gap_px.u, std::hypot(found->gap_px.u, 0.3), 1e-9);
}

// A hop of two frames, whose top lies between them.
TEST(GreatestGap, OfAHopOfTwoFrames) {
  const double dt = 2e-3;
  const double v = 1.5 * kGravity * dt;  // three frame intervals in the air
  const std::vector<double> gaps = {0.0, Fall(v, dt), Fall(v, 2.0 * dt), 0.0,
                                    0.0};
  const auto found =
      Find(Gaps(gaps, 1e-3, dt), {{{0, 1}, StretchKind::kSupported, 0.0, 0},
                                  {{1, 3}, StretchKind::kFlight, 0.0, 0},
                                  {{3, 5}, StretchKind::kSupported, 0.0, 0}});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->gap_px.value, v * v / (2.0 * kGravity), 1e-3);
}

TEST(GreatestGap, FilmThatEndsWhileTheBodyRisesTellsWhereItWouldReach) {
  std::vector<double> gaps;
  for (int i = 0; i < 12; ++i) gaps.push_back(Fall(300.0, i * 1e-3));
  const auto found = Find(Gaps(gaps, 0.02),
                          {{{0, gaps.size()}, StretchKind::kFlight, 0.0, 0}});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->gap_px.value, gaps.back(), 0.05);
  ASSERT_TRUE(found->reaches_px);
  EXPECT_NEAR(found->reaches_px->value, 300.0 * 300.0 / (2.0 * kGravity),
              4.0 * found->reaches_px->u);
}

// No parabola reaches across an impact.
TEST(GreatestGap, OfTwoHopsIsTheHigher) {
  std::vector<double> gaps;
  for (int i = 0; i < 20; ++i) gaps.push_back(0.1 * (20 - i));
  for (int i = 0; i < 24; ++i) gaps.push_back(Fall(110.0, i * 1e-3));
  const auto found =
      Find(Gaps(gaps, 0.02), {{{0, 20}, StretchKind::kOther, 0.0, 0},
                              {{20, 44}, StretchKind::kFlight, 0.0, 0}});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->gap_px.value, 2.0, 0.05);
}

PlaneTrack Block(const std::vector<std::array<double, 2>>& height_and_face) {
  PlaneTrack track = Gaps(std::vector<double>(height_and_face.size()), 0.02);
  track.kind = core::BodyKind::kRectangle;
  track.half_short_px = 10.0;
  for (std::size_t i = 0; i < height_and_face.size(); ++i) {
    PlaneSample& s = track.samples[i];
    s.height_px = height_and_face[i][0];
    s.face_rad = height_and_face[i][1];
    s.u_face_rad = 1e-3;
    s.gap_px = s.height_px - SupportHeight(track, s.face_rad);
  }
  return track;
}

// As it passes the upright a block's lowest corner changes: the gap has a cusp.
TEST(GreatestGap, OfATurningBlockIsAtTheCusp) {
  std::vector<std::array<double, 2>> poses;
  constexpr double kTurn = 0.21;  // rad a frame
  constexpr double kCusp = 7.37;  // frames
  for (int i = 0; i < 15; ++i) {
    const double t = 1e-3 * (i - kCusp);
    poses.push_back({60.0 - 0.5 * kGravity * t * t, kTurn * (i - kCusp)});
  }
  const auto found =
      Find(Block(poses), {{{0, poses.size()}, StretchKind::kFlight, 0.0, 0}});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->gap_px.value, 50.0, 0.01);
}

// From one corner onto the other between two frames, both of which show it on
// the ground.
TEST(GreatestGap, BetweenTwoFramesABlockFallsFromCornerToCorner) {
  constexpr double kTilt = 0.15;
  PlaneTrack track = Block({});
  track.kind = core::BodyKind::kRectangle;
  track.half_long_px = kRadius_px;
  track.half_short_px = 10.0;
  const double down = SupportHeight(track, kTilt);
  const auto found = Find(
      Block({{down, kTilt}, {down, kTilt}, {down, -kTilt}, {down, -kTilt}}),
      {{{0, 4}, StretchKind::kSupported, 0.0, 0}});
  ASSERT_TRUE(found);
  // Half way it is upright and as high as at the ends.
  const double lifted = down - 10.0;
  EXPECT_NEAR(found->gap_px.value, lifted, 1e-6);
  EXPECT_NEAR(found->gap_px.u, lifted / std::sqrt(3.0), 0.01);
}

// A block that meets the ground with one corner, turns about it until the other
// meets it between frames 10 and 11, and lies there: frames 0 to 9 fall, only
// frame 10 shows it between the two blows.
struct Chatter {
  static constexpr double kDt = 1e-3;
  static constexpr double kTouchdown = 9.62;  // frames
  static constexpr double kCusp_px = 1.0;     // the gap when it is upright
  static constexpr std::size_t kFirstAfter = 10;
  PlaneTrack track;
  Event event;

  Chatter() {
    track = Block({});
    track.kind = core::BodyKind::kRectangle;
    track.half_short_px = 10.0;
    track.half_long_px = kRadius_px;
    constexpr double kTilt = 0.15;
    constexpr double kUpright = 0.9;  // frames after touchdown
    const double down = SupportHeight(track, kTilt);
    const double upright = kUpright * kDt;
    const double v = (SupportHeight(track, 0.0) + kCusp_px - down +
                      0.5 * kGravity * upright * upright) /
                     upright;
    std::vector<std::array<double, 2>> poses;
    for (int i = 0; i < 16; ++i) {
      const double t = (i - kTouchdown) * kDt;
      if (t < 0.0) {
        poses.push_back({down + Fall(-1500.0, t), kTilt});
      } else if (i == static_cast<int>(kFirstAfter)) {
        poses.push_back({down + Fall(v, t), kTilt * (1.0 - t / upright)});
      } else {
        poses.push_back({SupportHeight(track, 0.0), 0.0});
      }
    }
    track = Block(poses);
    event.before_frames = {0, kFirstAfter};
    event.before =
        FitFlight(SelectSamples(track, event.before_frames), KnownGravity());
    event.time_s = {kTouchdown * kDt, 1e-6};
  }

  core::Estimate Find() const {
    const auto found =
        FindGreatestGap(track,
                        {{{{0, kFirstAfter}, StretchKind::kFlight, 0.0, 0},
                          {{kFirstAfter, track.samples.size()},
                           StretchKind::kSupported,
                           0.0,
                           0}}},
                        kFirstAfter, {}, KnownGravity(), &event);
    return found ? found->gap_px : core::Estimate{};
  }
};

TEST(GreatestGap, OfTheFirstHopIsWhereTheOtherCornerComesDown) {
  Chatter chatter;
  chatter.track.exposure = 0.2;
  EXPECT_NEAR(chatter.Find().value, Chatter::kCusp_px, 0.05);
  // Also where a later hop is long enough to be seen as a flight.
  chatter.event.after = chatter.event.before;
  chatter.event.after_frames = {13, 16};
  chatter.event.release_s = {12.5 * Chatter::kDt, 1e-6};
  EXPECT_NEAR(chatter.Find().value, Chatter::kCusp_px, 0.05);
}

// Then the blow itself may lie in the exposure of the frame after it: what the
// two frames show, and a motion between them that may have been another.
TEST(GreatestGap, OfAFrameExposedAcrossABlowIsKnownLess) {
  const Chatter chatter;  // an open shutter
  const core::Estimate found = chatter.Find();
  EXPECT_GT(found.u, 0.2);
  EXPECT_NEAR(found.value, Chatter::kCusp_px, 2.0 * found.u);
}

// A ball that falls until frame 9.98 and then lies there: of frame 10 a shutter
// that is open for 0.8 frames shows the fall for 0.38 of them.
TEST(GreatestGap, OfAFrameExposedAcrossTheTouchdownIsNoApproach) {
  constexpr double kTouchdown = 9.98;
  constexpr double kExposure = 0.8;
  constexpr double kSpeed_px = 2.0;  // a frame
  constexpr int kSteps = 400;
  std::vector<double> gaps;
  for (int i = 0; i < 20; ++i) {
    double sum = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const double t = i - kTouchdown + kExposure * ((k + 0.5) / kSteps - 0.5);
      sum += t < 0.0 ? Fall(-1e3 * kSpeed_px, 1e-3 * t) : 0.0;
    }
    gaps.push_back(sum / kSteps);
  }
  ASSERT_GT(gaps[10], 0.15);
  PlaneTrack track = Gaps(gaps, 0.01);
  track.exposure = kExposure;
  Event event;
  event.before_frames = {0, 9};
  event.before =
      FitFlight(SelectSamples(track, event.before_frames), KnownGravity());
  event.time_s = {kTouchdown * 1e-3, 1e-6};
  const auto find = [&] {
    return FindGreatestGap(track,
                           {{{{0, 10}, StretchKind::kFlight, 0.0, 0},
                             {{10, 20}, StretchKind::kSupported, 0.0, 0}}},
                           10, {}, KnownGravity(), &event)
        ->gap_px;
  };
  EXPECT_NEAR(find().value, 0.0, 0.01);
  EXPECT_LT(find().u, 0.02);
  // An exposure that was not measured may be of any length.
  track.exposure = 1.0;
  EXPECT_NEAR(find().value, 0.0, 2.0 * find().u);
}

TEST(GreatestGap, NothingFilmedIsAbsent) {
  EXPECT_FALSE(Find(PlaneTrack{}, {}));
  const auto one =
      Find(Gaps({1.25}, 0.1), {{{0, 1}, StretchKind::kSupported, 0.0, 0}});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->gap_px.value, 1.25);
  EXPECT_EQ(one->gap_px.u, 0.1);
}

// A body at rest whose height is noise: the greatest of many noisy values, at
// its face, would be a bounce.
TEST(GreatestGap, NoiseOfABodyAtRestIsNoBounce) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  int bounces = 0;
  constexpr int kClips = 300;
  for (int k = 0; k < kClips; ++k) {
    std::vector<double> gaps;
    for (int i = 0; i < 200; ++i) gaps.push_back(0.1 * normal(engine));
    const auto found =
        Find(Gaps(gaps, 0.1), {{{0, 200}, StretchKind::kSupported, 0.0, 0}});
    bounces +=
        DecideBounce(found->gap_px, 0.2).label == core::MotionState::kBounce;
  }
  EXPECT_EQ(bounces, 0);
}

}  // namespace
}  // namespace touchdown::vision
