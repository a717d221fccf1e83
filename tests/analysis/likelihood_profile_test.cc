#include "touchdown/analysis/statistics/likelihood_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/analysis/reference_data.h"
#include "tests/support/shared_data.h"
#include "touchdown/analysis/statistics/paper_table1.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::BodyKind;
using core::kDegree;

ProfileOptions Wide(double low, double high, double scatter_low,
                    double scatter_high) {
  return {low, high, scatter_low, scatter_high};
}

// Neyer (1994) Table 1 (MIL-STD-331), inline so that something is tested
// without the reference data: 5.392185, 1.041225, -5.739762,
// [4.48706, 6.52965].
TEST(ProfileLikelihood, Neyer1994) {
  const double x[] = {1.0,  1.2,  1.4,  1.8,  2.6,  4.2,  3.4,
                      3.8,  4.0,  4.1,  4.28, 4.52, 5.55, 5.24,
                      6.37, 6.08, 7.38, 7.09, 6.89, 6.74};
  const bool y[] = {false, false, false, false, false, true, false,
                    false, false, false, false, false, true, false,
                    true,  false, true,  true,  true,  true};
  std::vector<Observation> trials;
  for (std::size_t i = 0; i < std::size(x); ++i) {
    trials.push_back(Raw(x[i], y[i]));
  }
  const auto p = ProfileLikelihood(trials, Wide(-10, 30, 1e-3, 1e3));
  EXPECT_TRUE(p.has_estimate);
  EXPECT_NEAR(p.estimate_rad, 5.392185, 2e-6);
  EXPECT_NEAR(p.scatter_rad, 1.041225, 2e-6);
  EXPECT_NEAR(p.interval95_rad.low, 4.48706, 1e-5);
  EXPECT_NEAR(p.interval95_rad.high, 6.52965, 1e-5);
  EXPECT_FALSE(p.open_low);
  EXPECT_FALSE(p.open_high);
}

TEST(ProfileLikelihood, EveryProbitFitOfTheReference) {
  const auto folder = testing::Shared("reference/data");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " not here";
  struct Set {
    const char* name;
    std::vector<Observation> trials;
    ProfileOptions options;
  };
  const auto same = [](double x) { return x; };
  const auto log10 = [](double x) { return std::log10(x); };
  const auto file = [&](const char* name) {
    return folder / (std::string(name) + ".csv");
  };
  const auto trials = [&](const char* name) { return ReadTrials(file(name)); };
  const std::vector<Set> sets{
      {"bliss1935_beetles", ReadGroups(file("bliss1935_beetles"), false, same),
       Wide(1, 3, 1e-4, 10)},
      {"hamada2019_drop25", ReadTrials(file("hamada2019_drop25"), log10),
       Wide(0, 3, 1e-3, 10)},
      {"neyer1994_table1", trials("neyer1994_table1"), Wide(-9, 30, .01, 100)},
      {"wu_tian2014_table1", trials("wu_tian2014_table1"),
       Wide(0, 30, 0.01, 100)},
      {"gonogo01_sentest8", trials("gonogo01_sentest8"),
       Wide(0, 40, 0.001, 1000)},
      {"gonogo04_neyer30", trials("gonogo04_neyer30"), Wide(0, 200, 0.1, 500)},
      {"gonogo11_dror_steinberg40", trials("gonogo11_dror_steinberg40"),
       Wide(10, 30, 0.01, 100)},
      {"gonogo12_eli73", trials("gonogo12_eli73"), Wide(0, 10, 0.01, 50)},
      {"gonogo13_neyer25", trials("gonogo13_neyer25"),
       Wide(700, 1300, 1, 5000)},
      {"finney1947_rotenone",
       ReadGroups(file("finney1947_rotenone"), false, log10),
       Wide(-1, 3, 1e-3, 10)},
      {"psignifit_yesno_norm",
       ReadGroups(file("psignifit_yesno_norm"), true, same),
       Wide(-1, 4, 1e-3, 10)},
      {"psignifit_yesno_logistic",
       ReadGroups(file("psignifit_yesno_logistic"), true, same),
       Wide(-1, 4, 1e-3, 10)},
      {"gorla2017_t9_951", trials("gorla2017_t9_951"), Wide(0, 90, 0.01, 900)},
      {"gorla2017_t6_751", trials("gorla2017_t6_751"), Wide(0, 90, 0.01, 900)},
      {"vanelstraete2008", trials("vanelstraete2008"), Wide(-50, 90, .1, 900)},
  };
  std::map<std::string, std::map<std::string, double>> reference;
  for (const auto& row : ReadCsv(folder / "reference_estimates_R.csv")) {
    if (row[1] == "MLE_probit" && row[3] != "NA") {
      reference[row[0]][row[2]] = std::stod(row[3]);
    }
  }
  for (const Set& set : sets) {
    SCOPED_TRACE(set.name);
    ASSERT_TRUE(reference.contains(set.name));
    auto& r = reference[set.name];
    const auto p = ProfileLikelihood(set.trials, set.options);
    EXPECT_TRUE(p.has_estimate);
    // The reference has nine digits from R's glm, which stops at a relative
    // change of the deviance of 1e-8.
    EXPECT_NEAR(p.estimate_rad / r["theta50"], 1.0, 2e-6);
    EXPECT_NEAR(p.scatter_rad / r["scale=1/beta1"], 1.0, 2e-5);
    if (r.contains("LR95_lo")) {
      EXPECT_NEAR(p.interval95_rad.low / r["LR95_lo"], 1.0, 1e-5);
    }
    if (r.contains("LR95_hi")) {
      EXPECT_NEAR(p.interval95_rad.high / r["LR95_hi"], 1.0, 1e-5);
    }
  }
}

TEST(ProfileLikelihood, Psignifit) {
  // psignifit's estimate (its prior included): threshold 0.897274, width
  // 1.434103, which is 3.28971 scatters; tolerance 0.005.
  const auto path = testing::Shared("reference/data/psignifit_yesno_norm.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto p =
      ProfileLikelihood(ReadGroups(path, true, [](double x) { return x; }),
                        Wide(-1, 4, 1e-3, 10));
  EXPECT_NEAR(p.estimate_rad, 0.897274, 0.005);
  EXPECT_NEAR(p.scatter_rad, 1.434103 / 3.28971, 0.005);
}

TEST(ProfileLikelihood, PaperTable1) {
  // statistics.md 1.4: sphere [9.12, 36.82], rectangle [5.30, 19.04], on a grid
  // of 0.02 deg and with u = 0.5 deg.
  const auto sphere =
      ProfileLikelihood(PaperTable1(BodyKind::kSphere, 0.5 * kDegree));
  EXPECT_NEAR(sphere.interval95_rad.low / kDegree, 9.12, 0.02);
  EXPECT_NEAR(sphere.interval95_rad.high / kDegree, 36.82, 0.02);
  EXPECT_NEAR(sphere.estimate_rad / kDegree, 19.6, 0.01);  // middle of bracket
  EXPECT_EQ(sphere.scatter_rad, 0.0);
  const auto rectangle =
      ProfileLikelihood(PaperTable1(BodyKind::kRectangle, 0.5 * kDegree));
  EXPECT_NEAR(rectangle.interval95_rad.low / kDegree, 5.30, 0.02);
  EXPECT_NEAR(rectangle.interval95_rad.high / kDegree, 19.04, 0.02);
  EXPECT_NEAR(rectangle.estimate_rad / kDegree, 9.8, 0.01);
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

TEST(ProfileLikelihood, HardCases) {
  const auto path = testing::Shared("reference/data/reference_hard_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto rows = ReadCsv(path);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (std::stod(rows[i][4]) > 0.0) continue;  // no lapse in the profile
    SCOPED_TRACE(rows[i][0]);
    const auto x = List(rows[i][1]);
    const auto y = List(rows[i][2]);
    std::vector<Observation> trials;
    for (std::size_t k = 0; k < x.size(); ++k) {
      trials.push_back(
          Observe(x[k] * kDegree, std::stod(rows[i][3]) * kDegree, y[k]));
    }
    const auto p = ProfileLikelihood(trials);
    const double low = std::stod(rows[i][8]);
    const double high = std::stod(rows[i][9]);
    EXPECT_EQ(p.open_low, low == 0.0);
    EXPECT_EQ(p.open_high, high == 90.0);
    EXPECT_NEAR(p.interval95_rad.low / kDegree, low, 0.021);
    EXPECT_NEAR(p.interval95_rad.high / kDegree, high, 0.021);
    EXPECT_TRUE(std::isfinite(p.estimate_rad));
  }
}

TEST(ProfileLikelihood, OneOutcomeHasNoEstimate) {
  const std::vector<Observation> slides{Observe(5 * kDegree, 0.3 * kDegree, 0),
                                        Observe(9 * kDegree, 0.0, 0)};
  const auto p = ProfileLikelihood(slides);
  EXPECT_EQ(p.status, DataStatus::kOnlySlides);
  EXPECT_FALSE(p.has_estimate);
  EXPECT_TRUE(p.open_high);
  EXPECT_FALSE(ProfileLikelihood({}).has_estimate);
  EXPECT_TRUE(ProfileLikelihood({}).open_low);
}

TEST(ProfileLikelihood, ReversedOrderHasNoEstimate) {
  std::vector<Observation> trials{Observe(10 * kDegree, 0.3 * kDegree, 1),
                                  Observe(12 * kDegree, 0.3 * kDegree, 0)};
  const auto two = ProfileLikelihood(trials);
  EXPECT_EQ(two.status, DataStatus::kNoTrend);
  EXPECT_FALSE(two.has_estimate);
  for (int i = 0; i < 4; ++i) {
    trials.push_back(Observe((6 + i) * kDegree, 0.3 * kDegree, 1));
    trials.push_back(Observe((13 + i) * kDegree, 0.3 * kDegree, 0));
  }
  const auto ten = ProfileLikelihood(trials);
  EXPECT_EQ(ten.status, DataStatus::kReversed);
  EXPECT_FALSE(ten.has_estimate);
}

TEST(ProfileLikelihood, AnswersFollowShiftAndScale) {
  std::vector<Observation> trials;
  std::vector<Observation> moved;
  for (int i = 0; i < 12; ++i) {
    const double x = 3.0 + i;
    const bool bounced = i > 6 || i == 4;
    trials.push_back(Raw(x, bounced, 0.2));
    moved.push_back(Raw(1e6 + 1e3 * x, bounced, 200.0));
  }
  const auto a = ProfileLikelihood(trials, Wide(-10, 40, 0.01, 100));
  const auto b = ProfileLikelihood(moved, Wide(1e6 - 1e4, 1e6 + 4e4, 10, 1e5));
  EXPECT_NEAR((b.estimate_rad - 1e6) / 1e3, a.estimate_rad, 1e-5);
  EXPECT_NEAR(b.scatter_rad / 1e3, a.scatter_rad, 1e-5);
  EXPECT_NEAR((b.interval95_rad.low - 1e6) / 1e3, a.interval95_rad.low, 1e-5);
}

TEST(ProfileLikelihood, AStartThatIsAlsoATrialHidesNothing) {
  // Gorla et al. (2017), Table 9: the bracket's end, 36, is also a level of the
  // search. Reference (R glm): 36.529132, 2.111725.
  const double x[] = {36, 35, 36, 37, 38, 39, 38, 37,
                      38, 37, 36, 35, 36, 37, 36};
  const bool y[] = {true, false, false, false, false, true, true, false,
                    true, true,  true,  false, false, true, true};
  std::vector<Observation> trials;
  for (std::size_t i = 0; i < std::size(x); ++i) {
    trials.push_back(Raw(x[i], y[i]));
  }
  const auto p = ProfileLikelihood(trials, Wide(0, 90, 0.01, 900));
  EXPECT_NEAR(p.estimate_rad, 36.529132, 1e-4);
  EXPECT_NEAR(p.scatter_rad, 2.111725, 1e-4);
}

TEST(ProfileLikelihood, RefusesImpossibleRanges) {
  EXPECT_THROW(ProfileLikelihood({}, Wide(1, 0, 0.1, 1)),
               std::invalid_argument);
  EXPECT_THROW(ProfileLikelihood({}, Wide(0, 1, 0.0, 1)),
               std::invalid_argument);
}

// Without common errors the posterior's grid holds the same profile.
TEST(ProfileOfPosterior, IsTheProfile) {
  for (const auto body : {BodyKind::kSphere, BodyKind::kRectangle}) {
    const auto trials = PaperTable1(body, 0.5 * kDegree);
    const BoundaryPosterior posterior = FitBoundary(trials);
    const LikelihoodProfile grid = ProfileOfPosterior(posterior);
    const LikelihoodProfile exact = ProfileLikelihood(trials);
    const double close = 0.02 * posterior.sd_rad;
    EXPECT_NEAR(grid.interval95_rad.low, exact.interval95_rad.low, close);
    EXPECT_NEAR(grid.interval95_rad.high, exact.interval95_rad.high, close);
    EXPECT_EQ(grid.open_low, exact.open_low);
    EXPECT_EQ(grid.open_high, exact.open_high);
  }
  const std::vector<Observation> slides(5, Observe(0.2, 0.01, 0.0));
  const auto one_sided = ProfileOfPosterior(FitBoundary(slides));
  EXPECT_FALSE(one_sided.has_estimate);
  EXPECT_TRUE(one_sided.open_high);
}

}  // namespace
}  // namespace touchdown::analysis
