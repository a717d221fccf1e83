#include "touchdown/analysis/statistics/classic_designs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/analysis/reference_data.h"

namespace touchdown::analysis {
namespace {

constexpr core::Interval kAnywhere{-1e9, 1e9};

TEST(NextNeyer, PublishedLevelsOfNeyer1994) {
  // Technometrics 36, Table 1; guesses 0.6, 1.4, 0.1; levels rounded to 0.01.
  const double levels[] = {1.00, 1.20, 1.40, 1.80, 2.60, 4.20, 3.40,
                           3.80, 4.00, 4.10, 4.28, 4.52, 5.55, 5.24,
                           6.37, 6.08, 7.38, 7.09, 6.89, 6.74};
  const int outcome[] = {0, 0, 0, 0, 0, 1, 0, 0, 0, 0,
                         0, 0, 1, 0, 1, 0, 1, 1, 1, 1};
  // Before rounding, from the 11th on (gonogo).
  const double exact[] = {4.280593, 4.522704, 5.546750, 5.243286, 6.371972,
                          6.080507, 7.384474, 7.094228, 6.893248, 6.736075};
  std::vector<Observation> trials;
  for (std::size_t i = 0; i < std::size(levels); ++i) {
    const NextAngle next = NextNeyer(trials, {0.6, 1.4, 0.1, kAnywhere});
    EXPECT_NEAR(std::round(next.angle_rad * 100) / 100, levels[i], 1e-9)
        << "level " << i + 1;
    if (i >= 10) {
      EXPECT_NEAR(next.angle_rad, exact[i - 10], 4e-6) << "level " << i + 1;
    }
    EXPECT_FALSE(next.clipped);
    trials.push_back(Raw(levels[i], outcome[i] == 1));
  }
}

TEST(NextNeyer, ClipsToWhatTheRigCanThrow) {
  const DesignGuess options{0.1, 0.3, 0.02, {0.0, 0.32}};
  std::vector<Observation> trials;
  for (const double x : {0.2, 0.25, 0.3}) trials.push_back(Raw(x, false));
  const NextAngle next = NextNeyer(trials, options);
  EXPECT_EQ(next.angle_rad, 0.32);
  EXPECT_TRUE(next.clipped);
}

TEST(ClassicDesigns, NeverLeaveTheFiniteWhateverTheOutcomes) {
  std::mt19937 engine(5);
  std::bernoulli_distribution coin(0.5);
  for (const auto rule : {NextNeyer, NextThreePhase}) {
    for (int run = 0; run < 20; ++run) {
      std::vector<Observation> trials;
      for (int i = 0; i < 30; ++i) {
        const NextAngle next = rule(trials, {0.05, 0.5, 0.02, {0.0, 1.57}});
        ASSERT_TRUE(std::isfinite(next.angle_rad));
        trials.push_back(Raw(next.angle_rad, coin(engine)));
      }
    }
  }
}

TEST(ClassicDesigns, RefuseImpossibleGuessesByName) {
  for (const auto rule : {NextNeyer, NextThreePhase}) {
    EXPECT_THROW(rule({}, {2, 1, 0.1, kAnywhere}), std::invalid_argument);
    EXPECT_THROW(rule({}, {1, 2, 0.0, kAnywhere}), std::invalid_argument);
    EXPECT_THROW(rule({}, {1, 2, 0.1, {3, 2}}), std::invalid_argument);
  }
}

// Wu and Tian (2014), Table 1: 0 to 22, guessed scatter 3.
const double kWuTian[] = {5.5, 16.5, 11,  13.8, 10.1, 14.7, 10.4, 11.7,
                          9.7, 7.3,  7.8, 8.1,  12.2, 8.5,  11.8};
const bool kWuTianBounced[] = {false, true,  false, true,  false,
                               true,  true,  true,  true,  false,
                               false, false, true,  false, true};

TEST(NextThreePhase, PublishedLevelsOfWuAndTian2014) {
  // Level by level with the article's rounded ones fed back (gonogo).
  const double expected[] = {5.5,    16.5,   11,      13.75,  10.1,
                             14.7,   10.4,   11.7,    9.7,    7.2651,
                             7.7543, 8.0843, 12.1643, 8.5167, 11.8254};
  std::vector<Observation> trials;
  for (std::size_t i = 0; i < std::size(kWuTian); ++i) {
    const NextAngle next = NextThreePhase(trials, {0, 22, 3, kAnywhere});
    EXPECT_NEAR(next.angle_rad, expected[i], 5.1e-5) << "level " << i + 1;
    trials.push_back(Raw(kWuTian[i], kWuTianBounced[i]));
  }
}

TEST(NextThreePhase, FedWithItsOwnLevels) {
  const double expected[] = {5.5,    16.5,   11,      13.75,  10.1,
                             14.65,  10.4,   11.7,    9.7,    7.2776,
                             7.7605, 8.0850, 12.1624, 8.5127, 11.8234};
  std::vector<Observation> trials;
  for (std::size_t i = 0; i < std::size(kWuTian); ++i) {
    const NextAngle next = NextThreePhase(trials, {0, 22, 3, kAnywhere});
    EXPECT_NEAR(next.angle_rad, expected[i], 1e-4) << "level " << i + 1;
    trials.push_back(Raw(next.angle_rad, kWuTianBounced[i]));
  }
}

TEST(NextThreePhase, LooksOutwardWhereOneOutcomeIsMissing) {
  const DesignGuess guess{10, 20, 1, kAnywhere};
  const auto levels = [&](bool bounced, std::size_t n) {
    std::vector<Observation> trials;
    while (trials.size() < n) {
      trials.push_back(Raw(NextThreePhase(trials, guess).angle_rad, bounced));
    }
    std::vector<double> out;
    for (const auto& o : trials) out.push_back(o.angle_rad);
    return out;
  };
  // +1.5, +3, then with a doubled scatter +9.
  EXPECT_EQ(levels(false, 5),
            (std::vector<double>{12.5, 17.5, 21.5, 24.5, 33.5}));
  EXPECT_EQ(levels(true, 5), (std::vector<double>{12.5, 17.5, 8.5, 5.5, -3.5}));
  // The wrong way round: three scatters beyond both ends.
  std::vector<Observation> trials{Raw(12.5, true), Raw(17.5, false)};
  EXPECT_EQ(NextThreePhase(trials, guess).angle_rad, 7.0);
  trials.push_back(Raw(7.0, false));
  EXPECT_EQ(NextThreePhase(trials, guess).angle_rad, 23.0);
}

TEST(NextUpDown, OneStepDownAfterABounceUpAfterASlide) {
  UpDownOptions options;
  EXPECT_EQ(NextUpDown({}, options).angle_rad, options.start_rad);
  std::vector<Observation> trials{Observe(0.35, 0.0, 1.0)};
  EXPECT_DOUBLE_EQ(NextUpDown(trials, options).angle_rad,
                   0.35 - options.step_rad);
  trials.push_back(Observe(0.30, 0.0, 0.0));
  EXPECT_DOUBLE_EQ(NextUpDown(trials, options).angle_rad,
                   0.30 + options.step_rad);
  trials.back().set_angle_rad = 0.29;
  EXPECT_DOUBLE_EQ(NextUpDown(trials, options).angle_rad,
                   0.29 + options.step_rad);
  trials.push_back(Observe(0.30, 0.0, 0.6));
  EXPECT_DOUBLE_EQ(NextUpDown(trials, options).angle_rad, 0.30);
}

}  // namespace
}  // namespace touchdown::analysis
