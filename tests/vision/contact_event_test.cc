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

// 20 frames, each the mean over its exposure, but for what gravity lowers any
// mean by.
PlaneTrack FilmHop(double exposure, double touchdown = 9.75) {
  constexpr int kSteps = 500;
  PlaneTrack track;
  track.half_long_px = track.half_short_px = kRadius_px;
  track.frame_interval_s = kDt;
  track.exposure = exposure;
  track.blur_px = 0.7;
  for (int i = 0; i < 20; ++i) {
    double sum = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const double at = exposure * ((k + 0.5) / kSteps - 0.5);
      sum += HeightAt((i - touchdown + at) * kDt);
    }
    PlaneSample s;
    s.frame = i;
    s.time_s = (i - touchdown) * kDt;
    s.gap_px = sum / kSteps;
    if (sum != 0.0) s.gap_px += kGravity * std::pow(exposure * kDt, 2) / 24.0;
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

// A frame that was exposed across touchdown shows neither motion. It counts for
// less, by what its exposure and the instant make of it, and others in full.
TEST(ContactEvent, AFrameExposedAcrossTouchdownIsKnownLess) {
  const auto measure = [](double exposure, double touchdown) {
    return MeasureHop(FilmHop(exposure, touchdown), {10, 12});
  };
  for (double touchdown = 9.05; touchdown < 10.0; touchdown += 0.1) {
    for (const double exposure : {0.05, 0.5, 1.0}) {
      const Event event = measure(exposure, touchdown);
      const double lands_s = 0.0;
      EXPECT_NEAR(event.time_s.value, lands_s, 2.0 * event.time_s.u)
          << touchdown << ' ' << exposure;
      const FlightState in = event.before->At(event.time_s.value);
      EXPECT_NEAR(in.v_n, kFall, 2.0 * in.u_v_n)
          << touchdown << ' ' << exposure;
    }
    const auto u = [&](double exposure) {
      const Event event = measure(exposure, touchdown);
      return event.before->At(event.time_s.value).u_v_n;
    };
    // Frame 9 counts in full where it ended before.
    if (touchdown > 9.3 && touchdown < 9.5) {
      EXPECT_LT(u(0.05), 0.8 * u(1.0)) << touchdown;
    }
  }
}

}  // namespace
}  // namespace touchdown::vision
