#include "touchdown/analysis/statistics/boundary_fit.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/analysis/reference_data.h"
#include "tests/support/shared_data.h"
#include "touchdown/analysis/statistics/likelihood_profile.h"
#include "touchdown/analysis/statistics/paper_table1.h"
#include "touchdown/analysis/statistics/set_angles.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::BodyKind;
using core::kDegree;

// Angles and uncertainties in degrees; outcome 1 bounce, 0 slide.
std::vector<Observation> Trials(const std::vector<double>& x,
                                const std::vector<int>& y, double u_deg) {
  std::vector<Observation> out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    out.push_back(Observe(x[i] * kDegree, u_deg * kDegree, y[i]));
  }
  return out;
}

// One prior and no lapses: what the reference numbers were computed with.
BoundaryFitOptions NoLapse(double median_deg = 2.0, double log_sd = 1.5) {
  BoundaryFitOptions options;
  options.lapse_gain = HUGE_VAL;
  options.cautious_scatter.reset();
  options.sharp_scatter.reset();
  options.unlikely_fall.reset();
  options.scatter = {median_deg * kDegree, log_sd};
  return options;
}

// The reference grid is four times finer in s and stepped 0.02 deg;
// statistics.md gives 0.004 deg for a grid like ours.
constexpr double kTolerance_deg = 0.02;

void ExpectPosterior(const BoundaryPosterior& p, double median_deg,
                     double low_deg, double high_deg,
                     double tolerance_deg = kTolerance_deg) {
  EXPECT_NEAR(p.median_rad / kDegree, median_deg, tolerance_deg);
  EXPECT_NEAR(p.interval95_rad.low / kDegree, low_deg, tolerance_deg);
  EXPECT_NEAR(p.interval95_rad.high / kDegree, high_deg, tolerance_deg);
}

TEST(FitBoundary, PaperTable1) {
  // statistics.md 1.4, last rows.
  const auto sphere =
      FitBoundary(PaperTable1(BodyKind::kSphere, 0.5 * kDegree), NoLapse());
  ExpectPosterior(sphere, 20.051, 10.970, 32.016);
  EXPECT_NEAR(sphere.sd_rad / kDegree, 5.767, kTolerance_deg);
  EXPECT_NEAR(CumulativeProbability(sphere, 11.8 * kDegree), 0.043, 0.002);
  EXPECT_NEAR(MarginProbability(sphere, 11.8 * kDegree, 0.5 * kDegree), 0.030,
              0.002);
  EXPECT_NEAR(SmallestPassingMargin(sphere, 11.8 * kDegree) / kDegree, 17.2,
              0.05);
  EXPECT_EQ(sphere.status, DataStatus::kSeparated);
  EXPECT_TRUE(sphere.few_trials);

  const auto rectangle =
      FitBoundary(PaperTable1(BodyKind::kRectangle, 0.5 * kDegree), NoLapse());
  ExpectPosterior(rectangle, 10.142, 4.701, 22.103);
  EXPECT_NEAR(rectangle.sd_rad / kDegree, 4.184, kTolerance_deg);
  EXPECT_NEAR(CumulativeProbability(rectangle, 7.8 * kDegree), 0.145, 0.002);
  EXPECT_NEAR(MarginProbability(rectangle, 7.8 * kDegree, 0.5 * kDegree), 0.100,
              0.002);
  EXPECT_NEAR(MarginProbability(rectangle, 7.8 * kDegree, 2 * kDegree), 0.397,
              0.002);
  EXPECT_NEAR(SmallestPassingMargin(rectangle, 7.8 * kDegree) / kDegree, 10.7,
              0.05);
}

// As reports print it: the posterior is the reference's, and so are its equal
// tails; the interval holds those under the second prior, too. Computed on a
// grid of 3600 angles and 90 scatters, with a program of its own.
TEST(FitBoundary, PaperTable1UnderBothPriors) {
  const auto sphere =
      FitBoundary(PaperTable1(BodyKind::kSphere, 0.5 * kDegree));
  ExpectPosterior(sphere, 20.051, 10.303, 34.488);
  EXPECT_NEAR(Quantile(sphere, 0.025) / kDegree, 10.970, kTolerance_deg);
  EXPECT_NEAR(Quantile(sphere, 0.975) / kDegree, 32.016, kTolerance_deg);
  ASSERT_TRUE(sphere.cautious_prior.has_value());
  EXPECT_FALSE(sphere.cautious_prior->log_sd.has_value());
  const auto rectangle =
      FitBoundary(PaperTable1(BodyKind::kRectangle, 0.5 * kDegree));
  ExpectPosterior(rectangle, 10.142, 3.840, 24.710);
  EXPECT_NEAR(Quantile(rectangle, 0.025) / kDegree, 4.701, kTolerance_deg);
  EXPECT_NEAR(Quantile(rectangle, 0.975) / kDegree, 22.103, kTolerance_deg);
}

TEST(FitBoundary, SensitivityLinesAreFitsWithOtherPriors) {
  const auto trials = PaperTable1(BodyKind::kSphere, 0.5 * kDegree);
  const auto p = FitBoundary(trials, NoLapse());
  ASSERT_EQ(p.sensitivity.size(), 2u);
  EXPECT_NEAR(p.sensitivity[0].median_rad / kDegree, 19.719, kTolerance_deg);
  EXPECT_NEAR(p.sensitivity[0].interval95_rad.low / kDegree, 11.517,
              kTolerance_deg);
  EXPECT_NEAR(p.sensitivity[0].interval95_rad.high / kDegree, 28.213,
              kTolerance_deg);
  // LN(.5, 1): statistics.md 3 gives D95 = 15.0 for the sphere.
  const auto narrow = FitBoundary(trials, NoLapse(0.5, 1.0));
  EXPECT_NEAR(SmallestPassingMargin(narrow, 11.8 * kDegree) / kDegree, 15.0,
              0.05);
  const auto rectangle = FitBoundary(
      PaperTable1(BodyKind::kRectangle, 0.5 * kDegree), NoLapse(0.5, 1.0));
  EXPECT_NEAR(SmallestPassingMargin(rectangle, 7.8 * kDegree) / kDegree, 4.6,
              0.05);
}

TEST(FitBoundary, EveryPaperRowOfTheReference) {
  const auto path = testing::Shared("reference/data/reference_bayes.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  int checked = 0;
  for (const auto& row : ReadCsv(path)) {
    const std::string& name = row[0];
    const bool sphere = name.starts_with("sphere");
    if (!sphere && !name.starts_with("rect")) continue;
    const auto u = name.find("u=");
    const auto lapse = name.find("lapse=");
    const auto prior = name.find("LN(");
    const auto comma = name.find(',', prior);
    BoundaryFitOptions options = NoLapse(std::stod(name.substr(prior + 3)),
                                         std::stod(name.substr(comma + 1)));
    if (const double l = std::stod(name.substr(lapse + 6)); l > 0.0) {
      options.lapse_gain = -HUGE_VAL;
      options.lapse = l;
    }
    const auto p = FitBoundary(
        PaperTable1(sphere ? BodyKind::kSphere : BodyKind::kRectangle,
                    std::stod(name.substr(u + 2)) * kDegree),
        options);
    SCOPED_TRACE(name);
    ExpectPosterior(p, std::stod(row[1]), std::stod(row[4]), std::stod(row[5]));
    EXPECT_NEAR(p.mean_rad / kDegree, std::stod(row[2]), kTolerance_deg);
    EXPECT_NEAR(p.sd_rad / kDegree, std::stod(row[3]), kTolerance_deg);
    ++checked;
  }
  EXPECT_EQ(checked, 16);
}

TEST(FitBoundary, PublishedDropTest) {
  const auto path = testing::Shared("reference/data/hamada2019_drop25.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  BoundaryFitOptions options = NoLapse();
  options.low_rad = 0.5;
  options.high_rad = 2.5;
  options.scatter = {std::exp(-2.8), 1.0};
  options.scatter_low_rad = std::exp(-7.0);
  options.scatter_high_rad = std::exp(1.0);
  const auto p = FitBoundary(
      ReadTrials(path, [](double h) { return std::log10(h); }), options);
  // Published (OpenBUGS, Monte Carlo error 0.006): 1.535 [1.475, 1.649].
  EXPECT_NEAR(p.median_rad, 1.535, 0.006);
  EXPECT_NEAR(p.interval95_rad.low, 1.475, 0.006);
  EXPECT_NEAR(p.interval95_rad.high, 1.649, 0.006);
  // Computed on a fine grid.
  EXPECT_NEAR(p.median_rad, 1.53488, 0.0005);
  EXPECT_NEAR(p.interval95_rad.low, 1.47057, 0.0005);
  EXPECT_NEAR(p.interval95_rad.high, 1.64486, 0.0008);
  EXPECT_NEAR(p.sd_rad, 0.05124, 0.002);
}

TEST(FitBoundary, PublishedGoNoGoSets) {
  const auto folder = testing::Shared("reference/data");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " not here";
  const auto fit = [&](const char* file, double median, double log_sd,
                       double low, double scatter_high) {
    BoundaryFitOptions options = NoLapse();
    options.low_rad = low;
    options.high_rad = 30.0;
    options.scatter_low_rad = 0.05;
    options.scatter_high_rad = scatter_high;
    options.scatter = {median, log_sd};
    options.sensitivity.clear();
    return FitBoundary(ReadTrials(folder / file), options);
  };
  const auto expect = [](const BoundaryPosterior& p, double median, double low,
                         double high, double tolerance = 0.01) {
    EXPECT_NEAR(p.median_rad, median, tolerance);
    EXPECT_NEAR(p.interval95_rad.low, low, tolerance);
    EXPECT_NEAR(p.interval95_rad.high, high, tolerance);
  };
  expect(fit("neyer1994_table1.csv", 1, 1, 0, 40.5), 5.43745, 4.44517, 6.84850);
  // Its grid reached beyond 90 degrees of scatter; how far is not recorded.
  expect(fit("wu_tian2014_table1.csv", 2, 1.5, -20, 200), 10.21191, 7.70878,
         12.31469, 0.04);
  expect(fit("gonogo19_sep4.csv", 1, 1, 0, 40.5), 14.50026, 10.97482, 18.04849);
}

TEST(FitBoundary, BeetlesWithManyTrials) {
  const auto path = testing::Shared("reference/data/bliss1935_beetles.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  BoundaryFitOptions options = NoLapse();
  options.low_rad = 1.6;
  options.high_rad = 2.0;
  options.scatter = {0.05, 1.0};
  options.scatter_low_rad = 0.005;
  options.scatter_high_rad = 0.5;
  const auto p =
      FitBoundary(ReadGroups(path, false, [](double x) { return x; }), options);
  EXPECT_NEAR(p.median_rad, 1.77076, 1e-4);
  EXPECT_NEAR(p.interval95_rad.low, 1.76312, 1e-4);
  EXPECT_NEAR(p.interval95_rad.high, 1.77811, 1e-4);
  EXPECT_NEAR(p.sd_rad, 0.00382, 1e-4);
}

std::vector<double> List(const std::string& text) {
  std::vector<double> out;
  for (std::size_t at = 1; at < text.size();) {
    std::size_t used = 0;
    out.push_back(std::stod(text.substr(at), &used));
    at += used + 1;
  }
  return out;
}

TEST(FitBoundary, HardCases) {
  const auto path = testing::Shared("reference/data/reference_hard_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto rows = ReadCsv(path);
  ASSERT_EQ(rows.size(), 14u);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    SCOPED_TRACE(rows[i][0]);
    std::vector<int> y;
    for (const double v : List(rows[i][2])) y.push_back(v > 0.5);
    BoundaryFitOptions options = NoLapse();
    if (const double lapse = std::stod(rows[i][4]); lapse > 0.0) {
      options.lapse_gain = -HUGE_VAL;
      options.lapse = lapse;
    }
    auto p = FitBoundary(Trials(List(rows[i][1]), y, std::stod(rows[i][3])),
                         options);
    // The reference has equal tails for outcomes of one kind, too.
    p.interval95_rad = {Quantile(p, 0.025), Quantile(p, 0.975)};
    ExpectPosterior(p, std::stod(rows[i][5]), std::stod(rows[i][6]),
                    std::stod(rows[i][7]),
                    std::max(0.02, 0.01 * p.sd_rad / kDegree));
  }
}

// Twenty slides on the way up to 38 deg leave a boundary there possible with a
// scatter of 3 deg (probability 0.2); the prior's 52 degrees beyond them shall
// not exclude it. Mirrored, as much holds below.
TEST(FitBoundary, OutcomesOfOneKindLeaveTheIntervalOpen) {
  std::vector<double> x;
  for (int i = 0; i < 20; ++i) x.push_back(2.0 * i);
  const auto slides =
      FitBoundary(Trials(x, std::vector<int>(x.size(), 0), 0.3), NoLapse());
  EXPECT_GT(Quantile(slides, 0.025), 38.5 * kDegree);
  EXPECT_LT(slides.interval95_rad.low, 38.0 * kDegree);
  EXPECT_GT(slides.interval95_rad.low, 34.0 * kDegree);
  EXPECT_DOUBLE_EQ(slides.interval95_rad.high, 90.0 * kDegree);
  EXPECT_LE(slides.interval95_rad.low, slides.interval90_rad.low);
  EXPECT_NEAR(slides.interval95_rad.low,
              ProfileOfPosterior(slides).interval95_rad.low, 0.1 * kDegree);
  for (double& angle : x) angle = 90.0 - angle;
  const auto bounces =
      FitBoundary(Trials(x, std::vector<int>(x.size(), 1), 0.3), NoLapse());
  EXPECT_NEAR(bounces.interval95_rad.high / kDegree,
              90.0 - slides.interval95_rad.low / kDegree, 0.01);
  EXPECT_DOUBLE_EQ(bounces.interval95_rad.low, 0.0);
  // Both outcomes: the posterior's equal tails, as ever.
  const auto both = FitBoundary(Trials({10, 20}, {0, 1}, 0.3), NoLapse());
  EXPECT_DOUBLE_EQ(both.interval95_rad.low, Quantile(both, 0.025));
  EXPECT_DOUBLE_EQ(both.interval95_rad.high, Quantile(both, 0.975));
}

// The second prior has a say only where outcomes do not overlap, and then it
// can only widen.
TEST(FitBoundary, TheCautiousPriorIsForOutcomesThatDoNotOverlap) {
  const auto joins = [](const std::vector<double>& x,
                        const std::vector<int>& y) {
    const auto p = FitBoundary(Trials(x, y, 0.3));
    BoundaryFitOptions second;
    second.scatter = {4.0 * kDegree, std::nullopt};
    second.cautious_scatter.reset();
    second.sharp_scatter.reset();
    const auto other = FitBoundary(Trials(x, y, 0.3), second);
    const double low = Quantile(p, 0.025);
    const double high = Quantile(p, 0.975);
    if (!p.cautious_prior) {
      EXPECT_GE(p.interval95_rad.low, low);
      EXPECT_LE(p.interval95_rad.high, high);
      return false;
    }
    constexpr double kClose = 0.02 * kDegree;
    EXPECT_NEAR(p.interval95_rad.low, std::min(low, Quantile(other, 0.025)),
                kClose);
    EXPECT_NEAR(p.interval95_rad.high, std::max(high, Quantile(other, 0.975)),
                kClose);
    EXPECT_LE(p.interval95_rad.low, low);
    EXPECT_GE(p.interval95_rad.high, high);
    EXPECT_DOUBLE_EQ(p.interval90_rad.low, Quantile(p, 0.05));
    EXPECT_DOUBLE_EQ(p.interval90_rad.high, Quantile(p, 0.95));
    return true;
  };
  EXPECT_TRUE(joins({8, 10, 12, 14}, {0, 0, 1, 1}));
  EXPECT_TRUE(joins({8, 10, 10, 12}, {0, 0, 1, 1}));   // touching
  EXPECT_FALSE(joins({8, 10, 12, 14}, {0, 1, 0, 1}));  // overlap
}

// Trials at one angle do not tell a scatter of some tenths of a degree from one
// of some degrees: the boundary may be near.
TEST(FitBoundary, TrialsAtOneAngleHoldUnderTheSharpPriorToo) {
  std::vector<double> x;
  std::vector<int> y;
  for (int i = 0; i < 40; ++i) {
    x.push_back(10.0 + 0.5 * std::sin(i));
    y.push_back(i % 20 == 0);
  }
  BoundaryFitOptions alone;
  alone.sharp_scatter.reset();
  const auto without = FitBoundary(Trials(x, y, 0.3), alone);
  const auto with = FitBoundary(Trials(x, y, 0.3));
  ASSERT_TRUE(with.sharp_prior.has_value());
  EXPECT_FALSE(without.sharp_prior.has_value());
  BoundaryFitOptions sharp = alone;
  sharp.scatter = *with.sharp_prior;
  const auto other = FitBoundary(Trials(x, y, 0.3), sharp);
  // The grid is as fine as the first prior asks for.
  constexpr double kClose = 0.1 * kDegree;
  EXPECT_NEAR(with.interval95_rad.low, other.interval95_rad.low, kClose);
  EXPECT_LT(with.interval95_rad.low, without.interval95_rad.low - kClose);
  EXPECT_DOUBLE_EQ(with.interval95_rad.high, without.interval95_rad.high);
  EXPECT_DOUBLE_EQ(with.median_rad, without.median_rad);
}

// A small extract of `./dev bench verdicts`: all trials at one angle, 1 deg
// from a boundary of scatter 0.3 deg.
TEST(FitBoundary, CoversABoundaryBesideTheOneAngle) {
  std::mt19937_64 engine(25);
  std::normal_distribution<double> normal;
  constexpr int kCampaigns = 200;
  BoundaryFitOptions options;
  options.sensitivity.clear();
  options.max_cell_mass = 1.0 / 32;
  options.scatter_levels = 16;
  int hits = 0;
  int hits_one_prior = 0;
  for (int r = 0; r < kCampaigns; ++r) {
    const double theta =
        std::uniform_real_distribution<double>(5.0, 40.0)(engine);
    const double set = theta + (r % 2 == 0 ? 1.0 : -1.0);
    std::vector<Observation> trials;
    for (int i = 0; i < 40; ++i) {
      const double angle = set + 0.5 * normal(engine);
      const bool bounces = angle > theta + 0.3 * normal(engine);
      trials.push_back(Observe((angle + 0.3 * normal(engine)) * kDegree,
                               0.3 * kDegree, bounces ? 1.0 : 0.0));
      trials.back().set_angle_rad = set * kDegree;
    }
    const auto p = FitBoundary(UseSetAngles(trials).observations, options);
    const double truth = theta * kDegree;
    hits += p.interval95_rad.low <= truth && truth <= p.interval95_rad.high;
    hits_one_prior +=
        Quantile(p, 0.025) <= truth && truth <= Quantile(p, 0.975);
  }
  EXPECT_GE(hits, 0.93 * kCampaigns);
  EXPECT_GT(hits, hits_one_prior + 0.1 * kCampaigns);
}

// The greatest log likelihood at an angle over every scatter, by brute force.
double ProfileAt(std::span<const Observation> trials, double angle_rad) {
  double best = -std::numeric_limits<double>::infinity();
  for (int j = 0; j <= 400; ++j) {
    const double s = 0.05 * kDegree * std::pow(800.0, j / 400.0);
    double sum = 0.0;
    for (const Observation& o : trials) {
      const double z = (o.angle_rad - angle_rad) / std::hypot(s, o.u_rad);
      const double sign = o.outcome == Outcome::kBounce ? -1.0 : 1.0;
      sum += std::log(0.5 * std::erfc(sign * z / std::numbers::sqrt2));
    }
    best = std::max(best, sum);
  }
  return best;
}

// Outcomes that overlap next to a sharp boundary: the prior's scatters make the
// tails wide, and no scatter makes their ends likely.
TEST(FitBoundary, OverlapLeavesOutWhatTheLikelihoodIsAgainst) {
  const std::vector<double> x{2, 6, 8, 9.3, 9.9, 10.1, 10.7, 12, 14, 18};
  const std::vector<int> y{0, 0, 0, 0, 1, 0, 1, 1, 1, 1};
  const auto trials = Trials(x, y, 0.3);
  BoundaryFitOptions options;
  const auto p = FitBoundary(trials, options);
  options.unlikely_fall.reset();
  const auto tails = FitBoundary(trials, options);
  ASSERT_EQ(p.status, DataStatus::kOverlap);
  EXPECT_GT(p.interval95_rad.low, tails.interval95_rad.low);
  EXPECT_LT(p.interval95_rad.high, tails.interval95_rad.high);
  EXPECT_LT(p.interval95_rad.low, p.interval90_rad.low);
  EXPECT_GT(p.interval95_rad.high, p.interval90_rad.high);
  double greatest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 200; ++i) {
    greatest = std::max(greatest, ProfileAt(trials, (9 + 0.01 * i) * kDegree));
  }
  // 0.99 quantile of chi^2 with one degree of freedom.
  for (const double end : {p.interval95_rad.low, p.interval95_rad.high}) {
    EXPECT_NEAR(2.0 * (greatest - ProfileAt(trials, end)), 6.635, 0.05);
  }
}

// Twenty slides at 10 and twenty bounces at 20 deg agree with every boundary
// between, whatever a prior thinks of their scatter.
TEST(FitBoundary, SeparatedOutcomesKeepTheirBracket) {
  std::vector<double> x;
  std::vector<int> y;
  for (int i = 0; i < 40; ++i) {
    x.push_back(i < 20 ? 10.0 : 20.0);
    y.push_back(i >= 20);
  }
  const auto p = FitBoundary(Trials(x, y, 0.3));
  EXPECT_GT(Quantile(p, 0.025), 10.1 * kDegree);
  EXPECT_LE(p.interval95_rad.low, 10.0 * kDegree);
  EXPECT_GE(p.interval95_rad.high, 20.0 * kDegree);
}

// A small extract of `./dev bench verdicts`: ascending 2 deg steps, scatter 3
// deg. One prior alone takes outcomes that by chance do not overlap for a sharp
// boundary, and covers fewer of them. STATISTICS.md has the benchmark's 1600
// campaigns a cell.
TEST(FitBoundary, CoversABoundaryThatScatters) {
  std::mt19937_64 engine(24);
  std::normal_distribution<double> normal;
  constexpr int kCampaigns = 400;
  BoundaryFitOptions options;
  options.sensitivity.clear();
  // Coarser grids, for speed.
  options.max_cell_mass = 1.0 / 32;
  options.scatter_levels = 16;
  int hits = 0;
  int hits_one_prior = 0;
  for (int r = 0; r < kCampaigns; ++r) {
    const double theta =
        std::uniform_real_distribution<double>(2.0, 40.0)(engine);
    std::vector<double> x;
    std::vector<int> y;
    for (int i = 0; i < 40; ++i) {
      const double angle = (2 * i) % 60 + 0.5 * normal(engine);
      y.push_back(angle > theta + 3.0 * normal(engine));
      x.push_back(std::clamp(angle + 0.3 * normal(engine), 0.0, 90.0));
    }
    const auto p = FitBoundary(Trials(x, y, 0.3), options);
    const double truth = theta * kDegree;
    const double below = CumulativeProbability(p, truth);
    const bool hit =
        p.interval95_rad.low <= truth && truth <= p.interval95_rad.high;
    hits += hit ? 1 : 0;
    hits_one_prior += p.cautious_prior || p.sharp_prior
                          ? (0.025 <= below && below <= 0.975 ? 1 : 0)
                          : (hit ? 1 : 0);
  }
  EXPECT_GE(hits, 0.93 * kCampaigns);
  EXPECT_LE(hits, 0.98 * kCampaigns);
  EXPECT_GT(hits, hits_one_prior);
}

TEST(Classify, KnowsEveryKindOfData) {
  const auto status = [](std::vector<double> x, std::vector<int> y) {
    return Classify(Trials(x, y, 0.3));
  };
  EXPECT_EQ(Classify({}), DataStatus::kNoTrials);
  EXPECT_EQ(status({5, 10, 15}, {0, 0, 0}), DataStatus::kOnlySlides);
  EXPECT_EQ(status({5, 10, 15}, {1, 1, 1}), DataStatus::kOnlyBounces);
  EXPECT_EQ(status({10, 12}, {0, 1}), DataStatus::kSeparated);
  EXPECT_EQ(status({14, 16, 16}, {0, 0, 1}), DataStatus::kTouching);
  // Two trials in the wrong order are chance, and so are repeats at one angle
  // that scatter; eight in the wrong order are not.
  EXPECT_EQ(status({10, 12}, {1, 0}), DataStatus::kNoTrend);
  EXPECT_EQ(status({10, 10}, {1, 0}), DataStatus::kNoTrend);
  EXPECT_EQ(status({10, 10, 10, 10, 10, 10, 10, 10, 10, 10},
                   {0, 1, 0, 1, 0, 1, 0, 1, 0, 1}),
            DataStatus::kNoTrend);
  EXPECT_EQ(status({5, 6, 7, 8, 12, 13, 14, 15}, {1, 1, 1, 1, 0, 0, 0, 0}),
            DataStatus::kReversed);
  // gonogo06: means 10 and 10.33.
  EXPECT_EQ(status({10, 12, 11, 8}, {0, 1, 1, 1}), DataStatus::kOverlap);
}

TEST(Classify, ReferenceSets) {
  const auto folder = testing::Shared("reference/data");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " not here";
  const auto status = [&](const char* file) {
    return Classify(ReadTrials(folder / file));
  };
  EXPECT_EQ(status("gonogo03_nooverlap8.csv"), DataStatus::kSeparated);
  EXPECT_EQ(status("gonogo17_sep3.csv"), DataStatus::kSeparated);
  EXPECT_EQ(status("gonogo19_sep4.csv"), DataStatus::kSeparated);
  EXPECT_EQ(status("gonogo21_quasi3.csv"), DataStatus::kTouching);
  EXPECT_EQ(status("gonogo23_quasi4.csv"), DataStatus::kTouching);
  // Overlap, but the likelihood grows as the scatter does.
  EXPECT_EQ(status("gonogo06_infsigma.csv"), DataStatus::kOverlap);
  EXPECT_FALSE(ProfileLikelihood(ReadTrials(folder / "gonogo06_infsigma.csv"),
                                 {.low_rad = 0.0, .high_rad = 90.0})
                   .has_estimate);
}

TEST(FitBoundary, NoTrialsGiveThePrior) {
  const auto p = FitBoundary({});
  EXPECT_EQ(p.status, DataStatus::kNoTrials);
  ExpectPosterior(p, 45.0, 2.25, 87.75, 1e-6);
  // s: the median of its prior, up to the ends of the grid.
  EXPECT_NEAR(p.scatter_median_rad / kDegree, 2.0, 0.1);
}

TEST(FitBoundary, AnUndecidedTrialAtOneHalfChangesNothing) {
  auto trials = Trials({5, 10, 15, 20}, {0, 0, 1, 1}, 0.3);
  const auto before = FitBoundary(trials);
  trials.push_back(Observe(12 * kDegree, 0.0, 0.5));
  const auto after = FitBoundary(trials);
  EXPECT_DOUBLE_EQ(before.median_rad, after.median_rad);
}

TEST(FitBoundary, ASoftLabelLiesBetweenTheHardOnes) {
  auto trials = Trials({5, 10, 15, 20}, {0, 0, 1, 1}, 0.3);
  std::vector<double> medians;
  for (const double p : {0.0, 0.3, 0.5, 0.7, 1.0}) {
    auto with = trials;
    with.push_back(Observe(12 * kDegree, 0.3 * kDegree, p));
    medians.push_back(FitBoundary(with).median_rad);
  }
  for (std::size_t i = 1; i < medians.size(); ++i) {
    EXPECT_LT(medians[i], medians[i - 1]);
  }
}

TEST(FitBoundary, OrderOfTrialsDoesNotMatter) {
  auto trials = PaperTable1(BodyKind::kSphere, 0.5 * kDegree);
  const auto a = FitBoundary(trials);
  std::reverse(trials.begin(), trials.end());
  const auto b = FitBoundary(trials);
  EXPECT_EQ(a.median_rad, b.median_rad);
  EXPECT_EQ(a.cumulative, b.cumulative);
}

TEST(FitBoundary, LapsesEnterOnlyWhenTheDataAsk) {
  // One bounce at 2 deg among ten trials is not enough evidence of lapses.
  const std::vector<int> one{1, 0, 0, 0, 0, 1, 1, 1, 1, 1};
  const auto doubtful =
      FitBoundary(Trials({2, 4, 6, 8, 10, 12, 14, 16, 18, 20}, one, 0.3));
  EXPECT_EQ(doubtful.lapse, 0.0);
  // Forty sharp trials and one impossible one are.
  std::vector<double> x;
  std::vector<int> y;
  for (int i = 0; i < 40; ++i) {
    x.push_back(8.0 + 0.2 * i);
    y.push_back(x.back() > 12.0);
  }
  const auto clean = FitBoundary(Trials(x, y, 0.05));
  EXPECT_EQ(clean.lapse, 0.0);
  x.push_back(60.0);
  y.push_back(0);
  const auto spoiled = FitBoundary(Trials(x, y, 0.05));
  EXPECT_EQ(spoiled.lapse, 0.02);
  EXPECT_GT(spoiled.lapse_gain, 3.0);
  EXPECT_NEAR(spoiled.median_rad / kDegree, 12.0, 0.3);
}

TEST(FitBoundary, ManyTrialsGiveTheTruthAndBinningItsOwnErrorOnly) {
  std::mt19937_64 engine(20);
  std::uniform_real_distribution<double> angle(5, 20);
  std::normal_distribution<double> noise;
  std::vector<Observation> trials;
  for (int i = 0; i < 2200; ++i) {
    const double true_angle = angle(engine);
    const bool bounced = true_angle > 12.0 + 1.0 * noise(engine);
    trials.push_back(Observe((true_angle + 0.2 * noise(engine)) * kDegree,
                             0.2 * kDegree, bounced));
  }
  BoundaryFitOptions options;
  const auto binned = FitBoundary(trials, options);
  EXPECT_TRUE(binned.binned);
  EXPECT_NEAR(binned.median_rad / kDegree, 12.0, 4 * 0.04);
  EXPECT_NEAR(binned.scatter_median_rad / kDegree, 1.0, 0.2);
  options.bin_above = trials.size();
  const auto exact = FitBoundary(trials, options);
  EXPECT_FALSE(exact.binned);
  EXPECT_NEAR(binned.median_rad, exact.median_rad, 0.02 * exact.sd_rad);
  EXPECT_NEAR(binned.sd_rad, exact.sd_rad, 0.01 * exact.sd_rad);
}

TEST(FitBoundary, ANarrowPosteriorIsNotSteppedOver) {
  // A sharp boundary at an awkward angle between two starting steps.
  std::vector<double> x;
  std::vector<int> y;
  for (int i = -200; i <= 200; ++i) {
    x.push_back(33.3333 + 0.002 * (i + 0.5));
    y.push_back(i >= 0);
  }
  const auto p = FitBoundary(Trials(x, y, 0.0));
  EXPECT_NEAR(p.median_rad / kDegree, 33.3333, 0.01);
  EXPECT_LT(p.sd_rad / kDegree, 0.02);
  EXPECT_GT(p.sd_rad, 0.0);
}

TEST(FitBoundary, QuantileAndProbabilityAreInverse) {
  const auto p = FitBoundary(PaperTable1(BodyKind::kRectangle, 0.1 * kDegree));
  for (double q = 0.001; q < 1.0; q += 0.037) {
    EXPECT_NEAR(CumulativeProbability(p, Quantile(p, q)), q, 1e-9);
  }
  EXPECT_EQ(CumulativeProbability(p, -1.0), 0.0);
  EXPECT_EQ(CumulativeProbability(p, 2.0), 1.0);
}

TEST(FitBoundary, RefusesImpossibleOptionsByName) {
  BoundaryFitOptions options;
  options.cautious_scatter = ScatterPrior{0.0, std::nullopt};
  EXPECT_THROW(FitBoundary({}, options), std::invalid_argument);
  options = {};
  options.scatter_low_rad = 0.0;
  EXPECT_THROW(FitBoundary({}, options), std::invalid_argument);
  options = {};
  options.high_rad = options.low_rad;
  EXPECT_THROW(FitBoundary({}, options), std::invalid_argument);
  options = {};
  options.lapse = 0.5;
  EXPECT_THROW(FitBoundary({}, options), std::invalid_argument);
}

// One set-up: its common error is added to what the trials leave.
TEST(FitBoundary, ACommonErrorStaysHoweverManyTrials) {
  std::mt19937_64 engine(17);
  std::normal_distribution<double> normal;
  std::vector<Observation> trials;
  for (int i = 0; i < 400; ++i) {
    const double x = 8.0 + 0.02 * i;
    const bool bounced = x > 12.0 + 0.4 * normal(engine);
    trials.push_back(Observe(x * kDegree, 0.1 * kDegree, bounced));
  }
  const BoundaryPosterior alone = FitBoundary(trials);
  for (const double common_deg : {0.05, 0.3, 1.0}) {
    auto shared = trials;
    for (Observation& o : shared) o.common_u_rad = common_deg * kDegree;
    const BoundaryPosterior fit = FitBoundary(shared);
    const double expected = std::hypot(alone.sd_rad, common_deg * kDegree);
    EXPECT_NEAR(fit.sd_rad, expected, 0.02 * expected) << common_deg;
    EXPECT_NEAR(fit.median_rad, alone.median_rad, 0.02 * expected);
    EXPECT_NEAR(fit.scatter_median_rad, alone.scatter_median_rad,
                0.05 * alone.scatter_median_rad);
    EXPECT_NEAR(fit.common_u_rad, common_deg * kDegree, 1e-12);
  }
}

// The mean of two set-ups, weighted by what each leaves: three times the common
// u of the first is a tenth of its weight.
TEST(FitBoundary, SetUpsAreWeighedByTheirOwnErrors) {
  std::vector<Observation> trials;
  for (int i = 0; i < 400; ++i) {
    const double x = 8.0 + 0.02 * i;
    Observation first = Observe(x * kDegree, 0.05 * kDegree, x > 11.0);
    first.common_u_rad = 0.3 * kDegree;
    first.setup = 1;
    Observation second = Observe(x * kDegree, 0.05 * kDegree, x > 12.0);
    second.common_u_rad = 0.9 * kDegree;
    second.setup = 2;
    trials.push_back(first);
    trials.push_back(second);
  }
  const BoundaryPosterior fit = FitBoundary(trials);
  EXPECT_NEAR(fit.mean_rad / kDegree, 11.1, 0.02);
  EXPECT_NEAR(fit.sd_rad / kDegree, 0.9 / std::sqrt(10.0), 0.01);
  EXPECT_NEAR(fit.common_u_rad / kDegree, 0.9 / std::sqrt(10.0), 1e-6);
}

}  // namespace
}  // namespace touchdown::analysis
