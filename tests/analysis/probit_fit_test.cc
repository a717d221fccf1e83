#include "touchdown/analysis/statistics/probit_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/analysis/reference_data.h"
#include "tests/support/shared_data.h"

namespace touchdown::analysis {
namespace {

using Trials = std::vector<Observation>;

// Flour beetles, Bliss (1935): log10 of the dose, exposed, killed.
Trials Beetles() {
  struct Group {
    double dose;
    int exposed;
    int killed;
  };
  Trials out;
  for (const Group& g :
       {Group{1.6907, 59, 6}, Group{1.7242, 60, 13}, Group{1.7552, 62, 18},
        Group{1.7842, 56, 28}, Group{1.8113, 63, 52}, Group{1.8369, 59, 53},
        Group{1.8610, 62, 61}, Group{1.8839, 60, 60}}) {
    for (int i = 0; i < g.exposed; ++i) {
      out.push_back(Raw(g.dose, i < g.killed));
    }
  }
  return out;
}

TEST(FitProbit, Beetles) {
  // Dobson, An Introduction to Generalized Linear Models.
  const auto fit = FitProbit(Beetles());
  ASSERT_TRUE(fit);
  EXPECT_NEAR(-fit->mean / fit->scatter, -34.93526, 1e-5);
  EXPECT_NEAR(1.0 / fit->scatter, 19.72793, 1e-5);
  EXPECT_NEAR(fit->mean, 1.770852, 1e-6);
}

TEST(FitProbit, WuAndTian2014) {
  const double x[] = {5.5, 16.5, 11,  13.8, 10.1, 14.7, 10.4, 11.7,
                      9.7, 7.3,  7.8, 8.1,  12.2, 8.5,  11.8};
  const bool y[] = {false, true,  false, true,  false, true,  true, true,
                    true,  false, false, false, true,  false, true};
  Trials trials;
  for (std::size_t i = 0; i < std::size(x); ++i) {
    trials.push_back(Raw(x[i], y[i]));
  }
  const auto fit = FitProbit(trials);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->mean, 10.223008, 1e-6);
  EXPECT_NEAR(fit->scatter, 1.161903, 1e-6);
}

// Every probit fit with one term that R made.
TEST(FitProbit, EveryFitOfTheReference) {
  const auto folder = testing::Shared("reference/data");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " not here";
  std::map<std::string, std::map<std::string, double>> reference;
  for (const auto& row : ReadCsv(folder / "reference_estimates_R.csv")) {
    if (row[1] == "MLE_probit" && row[3] != "NA") {
      reference[row[0]][row[2]] = std::stod(row[3]);
    }
  }
  const auto log10 = [](double x) { return std::log10(x); };
  for (const auto& [name, values] : reference) {
    SCOPED_TRACE(name);
    const auto path = folder / (name + ".csv");
    Trials trials;
    if (name.starts_with("bliss")) {
      trials = Beetles();
    } else if (name.starts_with("finney")) {
      trials = ReadGroups(path, false, log10);
    } else if (name.starts_with("psignifit")) {
      trials = ReadGroups(path, true, [](double x) { return x; });
    } else if (name.starts_with("hamada")) {
      trials = ReadTrials(path, log10);
    } else {
      trials = ReadTrials(path);
    }
    const auto fit = FitProbit(trials);
    ASSERT_TRUE(fit);
    // R's glm stops where the deviance changes by 1e-8 of itself.
    EXPECT_NEAR(fit->mean / values.at("theta50"), 1.0, 2e-6);
    EXPECT_NEAR(fit->scatter / values.at("scale=1/beta1"), 1.0, 2e-5);
  }
  EXPECT_EQ(reference.size(), 15u);
}

// Property: a fit does not know in what units its angles are.
TEST(FitProbit, FollowsShiftAndScale) {
  const auto plain = FitProbit(Beetles());
  ASSERT_TRUE(plain);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Trials trials = Beetles();
    for (auto& o : trials) o.angle_rad = scale * (o.angle_rad - 0.7);
    const auto fit = FitProbit(trials);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->mean / scale + 0.7, plain->mean, 1e-9);
    EXPECT_NEAR(fit->scatter / scale, plain->scatter, 1e-9);
  }
}

TEST(FitProbit, NothingWithoutAMaximumOrARise) {
  EXPECT_FALSE(FitProbit({}));
  EXPECT_FALSE(FitProbit(Trials{Raw(10, true)}));
  EXPECT_FALSE(FitProbit(Trials{Raw(10, true), Raw(10, false)}));
  EXPECT_FALSE(FitProbit(Trials{Raw(5, false), Raw(10, false)}));
  EXPECT_FALSE(FitProbit(Trials{Raw(5, false), Raw(10, true)}));
  // gonogo21: quasi-separated.
  EXPECT_FALSE(
      FitProbit(Trials{Raw(14, false), Raw(16, false), Raw(16, true)}));
  // The paper's rectangle: a bracket from 7.8 to 11.8 deg.
  Trials paper;
  for (const double x : {0.0, 3.9, 7.8, 11.8, 27.4, 43.0, 58.7, 74.4, 90.0}) {
    paper.push_back(Raw(x, x > 8.0));
  }
  EXPECT_FALSE(FitProbit(paper));
  EXPECT_FALSE(FitProbit(
      Trials{Raw(1, true), Raw(2, false), Raw(3, true), Raw(4, false)}));
}

}  // namespace
}  // namespace touchdown::analysis
