#include "touchdown/vision/contact/supported_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

namespace touchdown::vision {
namespace {

constexpr double kNoise_px = 0.1;
constexpr double kInterval_s = 0.01;
constexpr std::size_t kFrames = 60;

// A body that slides along the ground and is slowed down, 600 px in all; its
// gaps are `gap` of the place, from -1 at one end of the path to 1 at the
// other, with noise.
PlaneTrack Sliding(std::uint64_t seed, calib::GroundSource source,
                   const std::function<double(double)>& gap) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0.0, kNoise_px);
  PlaneTrack track;
  track.frame_interval_s = kInterval_s;
  track.ground.source = source;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double t = static_cast<double>(i) / (kFrames - 1.0);
    const double place = 2.0 * t * (1.5 - 0.5 * t) - 1.0;
    PlaneSample s;
    s.frame = static_cast<std::int64_t>(i);
    s.time_s = kInterval_s * static_cast<double>(i);
    s.along_px = 300.0 * place;
    s.gap_px = gap(place) + noise(engine);
    s.height_px = s.gap_px + 20.0;
    s.u_along_px = s.u_height_px = s.u_gap_px = kNoise_px;
    track.samples.push_back(s);
  }
  return track;
}

double GreatestOff(const PlaneTrack& track) {
  double most = 0.0;
  for (const PlaneSample& s : track.samples) {
    most = std::max(most, std::abs(s.gap_px));
    EXPECT_NEAR(s.height_px, s.gap_px + 20.0, 1e-9);
  }
  return most;
}

using calib::GroundSource;

TEST(PathTrend, AnInclinedPathHasASlopeAndNoBend) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PlaneTrack track = Sliding(seed, GroundSource::kDetected,
                               [](double x) { return 1.5 * x; });
    const PathTrend trend = TakeOutTrend(track);
    EXPECT_NEAR(trend.slope_rad, 0.005, 4.0 * 0.1 / 300.0 / std::sqrt(20.0));
    EXPECT_EQ(trend.bend_px, 0.0) << seed;
    EXPECT_LT(GreatestOff(track), 5.0 * kNoise_px);
  }
}

// 0.5 % of the path, as an uncalibrated lens bends a line, either way.
TEST(PathTrend, ALensBendsALineThatWasFound) {
  for (const double bend : {3.0, -3.0}) {
    for (const GroundSource source :
         {GroundSource::kDetected, GroundSource::kContactPoints}) {
      for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        PlaneTrack track = Sliding(seed, source, [bend](double x) {
          return 0.3 * x + bend * (1.0 - x * x);
        });
        const PathTrend trend = TakeOutTrend(track);
        EXPECT_NEAR(trend.bend_px, bend, 0.15) << seed;
        EXPECT_NEAR(trend.slope_rad, 0.001, 4.0 * 0.1 / 300.0 / std::sqrt(20.0))
            << seed;
      }
    }
  }
}

// What a person gave, or a calibration, says how straight the ground is seen.
TEST(PathTrend, AGivenLineIsStraight) {
  for (const GroundSource source :
       {GroundSource::kUser, GroundSource::kCalibration}) {
    PlaneTrack track =
        Sliding(1, source, [](double x) { return 3.0 * (1.0 - x * x); });
    EXPECT_EQ(TakeOutTrend(track).bend_px, 0.0);
  }
}

// 5 % of the path is no lens; a bend within the noise is not asked for.
TEST(PathTrend, ABendIsOfALensAndAskedFor) {
  for (const double bend : {30.0, 0.02}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      PlaneTrack track =
          Sliding(seed, GroundSource::kDetected,
                  [bend](double x) { return bend * (1.0 - x * x); });
      EXPECT_EQ(TakeOutTrend(track).bend_px, 0.0) << bend << ", " << seed;
    }
  }
}

// One long hop at a steady pace: nothing shows that its weight is carried.
TEST(PathTrend, AFlightIsNoBend) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PlaneTrack track =
        Sliding(seed, GroundSource::kDetected, [](double) { return 0.0; });
    for (PlaneSample& s : track.samples) {
      const double x = 2.0 * static_cast<double>(s.frame) / (kFrames - 1) - 1.0;
      s.along_px = 300.0 * x;
      s.gap_px += 3.0 * (1.0 - x * x);
    }
    EXPECT_EQ(TakeOutTrend(track).bend_px, 0.0) << seed;
  }
}

TEST(PathTrend, ABodyThatStaysWhereItIsHasNone) {
  PlaneTrack track =
      Sliding(1, GroundSource::kDetected, [](double) { return 0.0; });
  for (PlaneSample& s : track.samples) s.along_px = 10.0;
  const PathTrend trend = TakeOutTrend(track);
  EXPECT_EQ(trend.slope_rad, 0.0);
  EXPECT_EQ(trend.bend_px, 0.0);
}

}  // namespace
}  // namespace touchdown::vision
