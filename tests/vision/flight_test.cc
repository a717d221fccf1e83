#include "touchdown/vision/contact/flight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/support/statistics.h"

namespace touchdown::vision {
namespace {

using touchdown::testing::Rms;
using touchdown::testing::RmsBand9999;

struct Path {
  double s0 = 12.0, v_t = 1400.0;            // px, px/s
  double h0 = 80.0, v_n = -300.0, g = 9807;  // px, px/s, px/s^2
  double f0 = 0.3, omega = 12.0;             // rad, rad/s
  double at_s = 0.01;                        // where these hold

  PlaneSample At(double t, double u, bool turns) const {
    PlaneSample s;
    const double d = t - at_s;
    s.time_s = t;
    s.along_px = s0 + v_t * d;
    s.height_px = h0 + v_n * d - 0.5 * g * d * d;
    s.u_along_px = s.u_height_px = u;
    if (turns) {
      s.face_rad = f0 + omega * d;
      s.u_face_rad = 1e-3;
    }
    return s;
  }
};

std::vector<PlaneSample> Film(const Path& path, int frames, double fps,
                              double start_s = 0.0, bool turns = true,
                              double u = 0.05) {
  std::vector<PlaneSample> samples;
  for (int i = 0; i < frames; ++i) {
    samples.push_back(path.At(start_s + i / fps, u, turns));
    samples.back().frame = i;
  }
  return samples;
}

TEST(Flight, ExactParabolaComesBack) {
  const Path path;
  for (const int frames : {3, 4, 5, 10, 40, 400}) {
    const auto samples = Film(path, frames, 2000.0);
    const Flight flight = FitFlight(samples);
    EXPECT_EQ(flight.frames, frames);
    for (const double t : {-0.01, 0.0, 0.01, 0.03}) {
      const double d = t - path.at_s;
      const FlightState s = flight.At(t);
      EXPECT_NEAR(s.along_px, path.s0 + path.v_t * d, 1e-8) << frames;
      EXPECT_NEAR(s.height_px, path.h0 + path.v_n * d - 0.5 * path.g * d * d,
                  1e-7)
          << frames;
      EXPECT_NEAR(s.v_t, path.v_t, 1e-5) << frames;
      EXPECT_NEAR(s.v_n, path.v_n - path.g * d, 1e-4) << frames;
      EXPECT_NEAR(s.face_rad, path.f0 + path.omega * d, 1e-10) << frames;
      EXPECT_NEAR(s.omega, path.omega, 1e-8) << frames;
    }
    EXPECT_NEAR(flight.height[2] / path.g, 1.0, 1e-8) << frames;
    EXPECT_LT(flight.rms_px, 1e-9);
  }
}

TEST(Flight, GravityOfSeveralFlightsIsPooled) {
  PlaneTrack track;
  Path rebound;
  rebound.v_n = 250.0;
  const std::vector<SampleRange> flights = {{0, 20}, {20, 50}};
  track.samples = Film(Path{}, 20, 2000.0);
  for (const PlaneSample& s : Film(rebound, 30, 2000.0, 0.01)) {
    track.samples.push_back(s);
  }
  const auto pooled = FitGravity(track, flights);
  ASSERT_TRUE(pooled);
  EXPECT_NEAR(pooled->value / rebound.g, 1.0, 1e-8);
  double precision = 0.0;
  for (const SampleRange& range : flights) {
    precision += 1.0 / FitFlight(SelectSamples(track, range)).height_cov(2, 2);
  }
  EXPECT_NEAR(pooled->u * pooled->u * precision, 1.0, 1e-12);
  // Five frames do not judge it, and six do.
  EXPECT_FALSE(FitGravity(track, std::vector<SampleRange>{{0, 5}, {20, 25}}));
  EXPECT_TRUE(FitGravity(track, std::vector<SampleRange>{{0, 5}, {20, 26}}));
  EXPECT_FALSE(FitGravity(track, {}));
}

TEST(Flight, WithGravityKnownTwoFramesSuffice) {
  const Path path;
  FlightOptions known;
  known.gravity_px_per_s2 = core::Estimate{path.g, 1e-3, std::nullopt};
  const Flight flight = FitFlight(Film(path, 2, 2000.0), known);
  EXPECT_NEAR(flight.At(path.at_s).height_px, path.h0, 1e-6);
  EXPECT_NEAR(flight.At(path.at_s).v_n, path.v_n, 1e-4);
}

TEST(Flight, TooFewFramesAreRefused) {
  const Path path;
  FlightOptions known;
  known.gravity_px_per_s2 = core::Estimate{path.g, 1.0, std::nullopt};
  EXPECT_THROW(FitFlight(Film(path, 2, 2000.0)), std::invalid_argument);
  EXPECT_THROW(FitFlight(Film(path, 1, 2000.0), known), std::invalid_argument);
  EXPECT_THROW(FitFlight({}), std::invalid_argument);
}

// statistics.md 4.2: the slope of a straight line through N frames is known to
// sp sqrt(12 / (N (N^2 - 1))) per frame.
TEST(Flight, UncertaintyOfVelocityByClosedForm) {
  const Path path;
  const double fps = 1000.0;
  const double u = 0.05;
  for (const int n : {3, 5, 8, 12, 20}) {
    const Flight flight = FitFlight(Film(path, n, fps, 0.0, true, u));
    const double expected = u * fps * std::sqrt(12.0 / (n * (n * n - 1.0)));
    EXPECT_NEAR(flight.At(0.0).u_v_t / expected, 1.0, 1e-9) << n;
    EXPECT_NEAR(flight.At(0.0).u_omega / (expected / u * 1e-3), 1.0, 1e-9) << n;
  }
}

// The same table, with gravity fitted: slope half a frame after the last.
TEST(Flight, PriorOnGravityIsWorthWhatTheTableSays) {
  const Path path;
  const double fps = 1000.0;
  const double u = 0.05;
  const struct {
    int n;
    double known;
    double fitted;
  } rows[] = {{5, .3162, 1.3732},
              {8, .1543, .6362},
              {12, .0836, .3390},
              {20, .0388, .1559}};
  for (const auto& row : rows) {
    const auto samples = Film(path, row.n, fps, 0.0, true, u);
    const double contact_s = (row.n - 0.5) / fps;
    const Flight fitted = FitFlight(samples);
    EXPECT_NEAR(fitted.At(contact_s).u_v_n / (u * fps), row.fitted, 6e-5);
    FlightOptions known;
    known.gravity_px_per_s2 = core::Estimate{path.g, 1e-6, std::nullopt};
    const Flight prior = FitFlight(samples, known);
    EXPECT_NEAR(prior.At(contact_s).u_v_n / (u * fps), row.known, 6e-5);
  }
}

TEST(Flight, WeakPriorIsNoPriorAndStrongOneHolds) {
  Path path;
  const auto samples = Film(path, 20, 2000.0);
  FlightOptions weak;
  weak.gravity_px_per_s2 = core::Estimate{0.0, 1e9, std::nullopt};
  const Flight with_weak = FitFlight(samples, weak);
  const Flight free = FitFlight(samples);
  EXPECT_NEAR(with_weak.height[2], free.height[2], 1e-3 * path.g);
  EXPECT_NEAR(with_weak.At(0.0).u_v_n / free.At(0.0).u_v_n, 1.0, 1e-4);
  FlightOptions strong;
  strong.gravity_px_per_s2 = core::Estimate{1.3 * path.g, 1e-3, std::nullopt};
  const Flight wrong = FitFlight(samples, strong);
  EXPECT_NEAR(wrong.height[2] / path.g, 1.3, 1e-3);
}

TEST(Flight, ErrorsAreWhatTheCovarianceSays) {
  const Path path;
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  std::vector<double> z_vn, z_vt, z_h, z_w, z_f;
  constexpr int kTrials = 400;
  const double at = 0.0125;
  for (int k = 0; k < kTrials; ++k) {
    auto samples = Film(path, 20, 2000.0);
    for (PlaneSample& s : samples) {
      s.along_px += s.u_along_px * normal(engine);
      s.height_px += s.u_height_px * normal(engine);
      s.face_rad += s.u_face_rad * normal(engine);
    }
    // The prior is itself a measurement, off by its uncertainty.
    FlightOptions options;
    options.gravity_px_per_s2 = core::Estimate{
        path.g + 0.003 * path.g * normal(engine), 0.003 * path.g, std::nullopt};
    const FlightState s = FitFlight(samples, options).At(at);
    const PlaneSample truth = path.At(at, 1.0, true);
    z_h.push_back((s.height_px - truth.height_px) / s.u_height_px);
    z_vn.push_back((s.v_n - path.v_n + path.g * (at - path.at_s)) / s.u_v_n);
    z_vt.push_back((s.v_t - path.v_t) / s.u_v_t);
    z_f.push_back((s.face_rad - truth.face_rad) / s.u_face_rad);
    z_w.push_back((s.omega - path.omega) / s.u_omega);
  }
  const auto band = RmsBand9999(kTrials);
  // Widening by reduced chi2 where it is above 1 (never below) makes u larger
  // by a few per cent on the mean of 20 frames: the lower side gives way.
  for (const auto& z : {z_h, z_vn, z_vt, z_f, z_w}) {
    EXPECT_GT(Rms(z), band.low - 0.08);
    EXPECT_LT(Rms(z), band.high);
  }
}

TEST(Flight, ScatterBeyondTheStatedNoiseWidens) {
  const Path path;
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  auto samples = Film(path, 60, 2000.0);
  const double before = FitFlight(samples).At(0.0).u_v_n;
  for (PlaneSample& s : samples) s.height_px += 0.5 * normal(engine);
  const Flight flight = FitFlight(samples);
  EXPECT_NEAR(flight.At(0.0).u_v_n / before, 10.0, 3.0);
  EXPECT_GT(flight.reduced_chi2, 20.0);
}

TEST(Flight, OriginFarAwayAndAnyClockGiveTheSame) {
  const Path path;
  const auto near = Film(path, 24, 2000.0);
  const Flight reference = FitFlight(near);
  for (const double far : {1e3, 1e6}) {
    auto moved = near;
    for (PlaneSample& s : moved) {
      s.along_px -= far;
      s.height_px += far;
    }
    const FlightState a = reference.At(0.004);
    const FlightState b = FitFlight(moved).At(0.004);
    EXPECT_NEAR(a.v_n, b.v_n, 1e-3 * a.u_v_n);
    EXPECT_NEAR(a.v_t, b.v_t, 1e-3 * a.u_v_t);
    EXPECT_NEAR(a.height_px, b.height_px - far, 1e-3 * a.u_height_px);
    EXPECT_NEAR(a.u_v_n, b.u_v_n, 1e-6 * a.u_v_n);
  }
  // Hours into a recording: 1e4 s.
  auto late = near;
  for (PlaneSample& s : late) s.time_s += 1e4;
  const FlightState a = reference.At(0.004);
  const FlightState b = FitFlight(late).At(1e4 + 0.004);
  EXPECT_NEAR(a.v_n, b.v_n, 1e-3 * a.u_v_n);
  EXPECT_NEAR(a.height_px, b.height_px, 1e-3 * a.u_height_px);
}

TEST(Flight, TimeAndLengthMayHaveAnyUnit) {
  const Path path;
  const auto samples = Film(path, 24, 2000.0);
  const FlightState a = FitFlight(samples).At(0.004);
  for (const double time : {1e-6, 1e-3, 1e3, 1e6}) {
    for (const double length : {1e-6, 1.0, 1e6}) {
      auto scaled = samples;
      for (PlaneSample& s : scaled) {
        s.time_s *= time;
        s.along_px *= length;
        s.height_px *= length;
        s.u_along_px *= length;
        s.u_height_px *= length;
      }
      const FlightState b = FitFlight(scaled).At(0.004 * time);
      const double speed = length / time;
      EXPECT_NEAR(b.v_n / speed, a.v_n, 1e-3 * a.u_v_n) << time << length;
      EXPECT_NEAR(b.v_t / speed, a.v_t, 1e-3 * a.u_v_t) << time << length;
      EXPECT_NEAR(b.u_v_n / speed / a.u_v_n, 1.0, 1e-6) << time << length;
      EXPECT_NEAR(b.omega * time, a.omega, 1e-3 * a.u_omega) << time << length;
    }
  }
}

TEST(Flight, MirroredAndReversed) {
  const Path path;
  const auto samples = Film(path, 24, 2000.0);
  const FlightState a = FitFlight(samples).At(0.004);
  auto mirrored = samples;
  for (PlaneSample& s : mirrored) s.along_px = -s.along_px;
  const FlightState b = FitFlight(mirrored).At(0.004);
  EXPECT_NEAR(a.v_t, -b.v_t, 1e-3 * a.u_v_t);
  EXPECT_EQ(a.v_n, b.v_n);
  // Backwards in time: the same parabola.
  std::vector<PlaneSample> reversed(samples.rbegin(), samples.rend());
  for (PlaneSample& s : reversed) s.time_s = -s.time_s;
  const FlightState c = FitFlight(reversed).At(-0.004);
  EXPECT_NEAR(a.v_n, -c.v_n, 1e-3 * a.u_v_n);
  EXPECT_NEAR(a.u_v_n, c.u_v_n, 1e-6 * a.u_v_n);
}

// The order of the frames does not matter to a least-squares fit.
TEST(Flight, OrderOfFramesInTheMiddleDoesNotMatter) {
  const Path path;
  auto samples = Film(path, 24, 2000.0);
  const FlightState a = FitFlight(samples).At(0.004);
  std::mt19937_64 engine(2);
  std::shuffle(samples.begin() + 1, samples.end() - 1, engine);
  const FlightState b = FitFlight(samples).At(0.004);
  EXPECT_NEAR(a.v_n, b.v_n, 1e-3 * a.u_v_n);
  EXPECT_NEAR(a.height_px, b.height_px, 1e-3 * a.u_height_px);
}

}  // namespace
}  // namespace touchdown::vision
