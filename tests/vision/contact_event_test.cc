// One contact, measured from given frames.
#include "vision/src/contact/contact_event.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "touchdown/core/units.h"

namespace touchdown::vision {
namespace {

constexpr double kGravity = core::kStandardGravity_mps2 * 1000.0;  // px/s^2
constexpr double kRadius_px = 20.0;
constexpr double kDt = 5e-3;      // s
constexpr double kU_px = 0.001;   // of a pose
constexpr double kFall = -400.0;  // px/s, at touchdown
constexpr double kHop = 56.0;     // px/s: back after 2.3 frames

// The height of a ball that touches down at time 0, hops once and stays down.
double HeightAt(double t) {
  const double lands = 2.0 * kHop / kGravity;
  if (t < 0.0) return kFall * t - 0.5 * kGravity * t * t;
  if (t < lands) return kHop * t - 0.5 * kGravity * t * t;
  return 0.0;
}

// 20 frames, each the mean over its exposure; touchdown at frame 9.7.
PlaneTrack FilmHop(double exposure) {
  constexpr double kTouchdown = 9.7;
  constexpr int kSteps = 500;
  PlaneTrack track;
  track.half_long_px = track.half_short_px = kRadius_px;
  track.frame_interval_s = kDt;
  track.exposure = exposure;
  for (int i = 0; i < 20; ++i) {
    double sum = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const double at = exposure * ((k + 0.5) / kSteps - 0.5);
      sum += HeightAt((i - kTouchdown + at) * kDt);
    }
    PlaneSample s;
    s.frame = i;
    s.time_s = (i - kTouchdown) * kDt;
    s.gap_px = sum / kSteps;
    s.height_px = s.gap_px + kRadius_px;
    s.u_gap_px = s.u_height_px = s.u_along_px = kU_px;
    track.samples.push_back(s);
  }
  return track;
}

Event MeasureHop(const PlaneTrack& track, SampleRange after) {
  FlightOptions options;
  options.gravity_px_per_s2 = core::Estimate{kGravity, 1e-3 * kGravity};
  Event event;
  event.before_frames = {0, 10};
  event.after_frames = after;
  std::string reason;
  EXPECT_TRUE(MeasureEvent(track, options, event, reason)) << reason;
  return event;
}

// The hop ends at frame 12: a shutter that is open for 0.8 frames shows as much
// of the rest as of the hop.
TEST(ContactEvent, ALastFrameExposedAcrossTheNextImpactIsKnownLess) {
  const auto rebound = [](double exposure) {
    const Event event = MeasureHop(FilmHop(exposure), {10, 13});
    const FlightState at = event.after->At(event.release_s.value);
    return core::Estimate{at.v_n, at.u_v_n};
  };
  const core::Estimate brief = rebound(0.05);
  const core::Estimate open = rebound(0.8);
  EXPECT_NEAR(brief.value, kHop, 2.0 * brief.u);
  EXPECT_NEAR(open.value, kHop, 2.0 * open.u);
  EXPECT_GT(open.u, 1.5 * brief.u);
  EXPECT_LT(open.u, 0.1 * kHop);
}

}  // namespace
}  // namespace touchdown::vision
