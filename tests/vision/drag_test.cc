#include "contact/drag.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/statistics.h"
#include "tests/vision/bounce_in_air.h"
#include "touchdown/vision/contact/contact.h"

namespace touchdown::vision {
namespace {

using synthetic::Bounce;
using synthetic::kGravity;
using synthetic::kLight;

// Textbook: from rest, v = sqrt(g / k) tanh(sqrt(g k) t), fallen ln cosh(sqrt(g
// k) t) / k. Upward from v, until the apex, the same with tan and cos.
TEST(Drag, AVerticalFlightIsThatOfTheTextbook) {
  for (const double k : {1e-5, 1e-4, 5e-4}) {
    const double rate = std::sqrt(kGravity * k);
    for (const double t : {0.02, 0.1, 0.3}) {
      const DragOffset fall = ComputeDragOffset(0.0, 0.0, kGravity, k, t);
      const double height = -std::log(std::cosh(rate * t)) / k;
      const double speed = -std::sqrt(kGravity / k) * std::tanh(rate * t);
      const double off = height + 0.5 * kGravity * t * t;
      EXPECT_NEAR(fall.height_px, off, 1e-4 * off) << k << " " << t;
      EXPECT_NEAR(fall.v_n, speed + kGravity * t,
                  1e-4 * (speed + kGravity * t));
      EXPECT_EQ(fall.along_px, 0.0);
      // Backwards from the apex: where the body came from.
      const DragOffset rise = ComputeDragOffset(0.0, 0.0, kGravity, k, -t);
      const double came = std::log(std::cos(rate * t)) / k;
      EXPECT_NEAR(rise.height_px, came + 0.5 * kGravity * t * t,
                  1e-4 * std::abs(came + 0.5 * kGravity * t * t));
    }
  }
}

// Without gravity: ln(1 + k v t) / k.
TEST(Drag, AlongAStraightLineTheSpeedFallsByItsShare) {
  const double k = 1e-4;
  const DragOffset d = ComputeDragOffset(3000.0, 0.0, 0.0, k, 0.5);
  EXPECT_NEAR(d.along_px, std::log(1.0 + k * 1500.0) / k - 1500.0, 1e-3);
  EXPECT_NEAR(d.v_t, 3000.0 / (1.0 + k * 1500.0) - 3000.0, 1e-3);
  EXPECT_EQ(ComputeDragOffset(3000.0, 500.0, kGravity, 0.0, 0.5).along_px, 0.0);
}

TEST(Drag, AFlightInAirComesBack) {
  std::mt19937_64 engine(1);
  Bounce bounce;
  bounce.k = kLight;
  bounce.u_px = 1e-6;
  const PlaneTrack track = bounce.Film(engine);
  FlightOptions options;
  options.drag_per_px = kLight;
  const Flight flight = FitFlight(SelectSamples(track, {0, 60}), options);
  const FlightState at = flight.At(59.6 / bounce.fps);
  EXPECT_NEAR(at.height_px, 20.0, 1e-3);
  EXPECT_NEAR(at.v_n, -4000.0, 0.05);
  EXPECT_NEAR(at.v_t, 300.0, 0.05);
  EXPECT_NEAR(flight.height[2], kGravity, 0.5);
  EXPECT_LT(flight.rms_px, 1e-3);
}

// Errors over u are of the standard normal distribution, with drag and without.
TEST(Drag, FlightsTellItWithinU) {
  std::mt19937_64 engine(2);
  const std::vector<SampleRange> flights = {{0, 60}, {60, 120}};
  FlightOptions known;
  known.gravity_px_per_s2 = core::Estimate{kGravity, 1e-4 * kGravity};
  for (int i = 0; i < 4; ++i) {
    const FlightOptions options = i < 2 ? FlightOptions{} : known;
    const double k = i % 2 == 0 ? 0.0 : kLight;
    Bounce bounce;
    bounce.k = k;
    std::vector<double> pulls;
    constexpr int kTracks = 100;
    for (int n = 0; n < kTracks; ++n) {
      const auto seen = FitDrag(bounce.Film(engine), flights, options);
      ASSERT_TRUE(seen);
      if (k > 0.0) EXPECT_GT(seen->value, core::kBeyondDoubt * seen->u);
      if (k == 0.0) EXPECT_LT(seen->value, core::kBeyondDoubt * seen->u);
      pulls.push_back((seen->value - k) / seen->u);
    }
    EXPECT_GT(testing::Rms(pulls), 0.6) << k;  // u is never narrowed
    EXPECT_LT(testing::Rms(pulls), 1.25) << k;
  }
  // One flight that only falls: gravity that is known tells its drag.
  std::mt19937_64 engine_of_fall(3);
  const PlaneTrack fall = Bounce().Film(engine_of_fall);
  const std::vector<SampleRange> falls = {{20, 60}};
  EXPECT_LT(FitDrag(fall, falls, known)->u, 0.5 * FitDrag(fall, falls)->u);
}

TEST(Drag, ShortFlightsTellNothingOfIt) {
  std::mt19937_64 engine(3);
  EXPECT_FALSE(FitDrag(Bounce().Film(engine),
                       std::vector<SampleRange>{{0, 7}, {60, 67}}));
  EXPECT_FALSE(FitDrag(Bounce().Film(engine), {}));
}

// What a light ball loses to the air is found as drag, and under it the impact
// is right; without it the restitution is off by more than four u.
TEST(Drag, UnderItTheImpactIsRight) {
  std::mt19937_64 engine(4);
  Bounce bounce;
  bounce.k = kLight;
  const PlaneTrack track = bounce.Film(engine);
  const ContactResult without = FindContacts(track);
  ASSERT_TRUE(without.first.motion.restitution);
  ASSERT_TRUE(without.drag_per_px);
  EXPECT_GT(without.drag_per_px->value,
            core::kBeyondDoubt * without.drag_per_px->u);
  ContactOptions options;
  options.drag_per_px = without.drag_per_px->value;
  const ContactResult with = FindContacts(track, options);
  ASSERT_TRUE(with.first.motion.restitution);
  const core::Estimate& biased = *without.first.motion.restitution;
  const core::Estimate& right = *with.first.motion.restitution;
  EXPECT_GT(std::abs(biased.value - bounce.restitution), 4.0 * biased.u);
  EXPECT_LT(std::abs(right.value - bounce.restitution),
            0.3 * std::abs(biased.value - bounce.restitution));
  ASSERT_TRUE(with.first.contact.frame);
  EXPECT_NEAR(with.first.contact.frame->value, 59.6, 0.01);
}

}  // namespace
}  // namespace touchdown::vision
