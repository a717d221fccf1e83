#include "touchdown/analysis/statistics/agreement_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/analysis/reference_data.h"
#include "tests/support/shared_data.h"
#include "touchdown/analysis/statistics/special_functions.h"

namespace touchdown::analysis {
namespace {

constexpr double kTolerance = 2e-9;  // the reference has ten digits

TEST(WilsonInterval, Newcombe1998) {
  EXPECT_NEAR(WilsonInterval(81, 263).low, 0.2552885, 1e-7);
  EXPECT_NEAR(WilsonInterval(81, 263).high, 0.3662096, 1e-7);
  EXPECT_NEAR(WilsonInterval(1, 29).low, 0.0061132, 1e-7);
  EXPECT_EQ(WilsonInterval(0, 20).low, 0.0);
  EXPECT_NEAR(WilsonInterval(0, 20).high, 0.1611252, 1e-7);
  EXPECT_NEAR(WilsonInterval(9, 9).low, 0.7008550, 1e-7);
  EXPECT_EQ(WilsonInterval(9, 9).high, 1.0);
}

TEST(ClopperPearsonInterval, Newcombe1998) {
  EXPECT_NEAR(ClopperPearsonInterval(81, 263).low, 0.2527367, 1e-7);
  EXPECT_NEAR(ClopperPearsonInterval(81, 263).high, 0.3676219, 1e-7);
  EXPECT_NEAR(ClopperPearsonInterval(9, 9).low, 0.6637329, 1e-7);
}

TEST(ProportionIntervals, RefuseImpossibleCounts) {
  EXPECT_THROW(WilsonInterval(1, 0), std::invalid_argument);
  EXPECT_THROW(WilsonInterval(5, 4), std::invalid_argument);
  EXPECT_THROW(ClopperPearsonInterval(-1, 4), std::invalid_argument);
  EXPECT_THROW(ClopperPearsonInterval(1, 4, 1.0), std::invalid_argument);
}

// Property: Clopper-Pearson covers at least as widely as its level says.
TEST(ClopperPearsonInterval, TailsAreExact) {
  for (int n = 1; n < 30; ++n) {
    for (int x = 0; x <= n; ++x) {
      const auto i = ClopperPearsonInterval(x, n);
      EXPECT_LE(i.low, static_cast<double>(x) / n);
      EXPECT_GE(i.high, static_cast<double>(x) / n);
    }
  }
}

TEST(CohenKappa, ByHand) {
  const CohensKappa kappa = CohenKappa({20, 5, 10, 15});
  EXPECT_NEAR(kappa.kappa, 0.4, kTolerance);
  EXPECT_NEAR(kappa.ase, 0.1269960629, kTolerance);
  EXPECT_NEAR(kappa.ase0, 0.1385640646, kTolerance);
}

TEST(CohenKappa, OneCategoryIsUndefined) {
  EXPECT_TRUE(std::isnan(CohenKappa({7, 0, 0, 0}).kappa));
  EXPECT_TRUE(std::isnan(MatthewsCorrelation({7, 0, 0, 0})));
  EXPECT_THROW(CohenKappa({0, 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(CohenKappa({1, -1, 2, 3}), std::invalid_argument);
}

TEST(McNemarTest, SmallCounts) {
  EXPECT_EQ(McNemarTest(0, 0).p_exact, 1.0);
  EXPECT_NEAR(McNemarTest(1, 0).p_exact, 1.0, 1e-12);  // the paper's two shapes
  EXPECT_NEAR(McNemarTest(3, 3).p_exact, 1.0, 1e-12);
  EXPECT_THROW(McNemarTest(-1, 0), std::invalid_argument);
}

TEST(NormalizedError, CombinesBothUncertainties) {
  EXPECT_NEAR(NormalizedError(12.4, 0.8, 11.8, 0.6), 0.6, 1e-12);
  EXPECT_THROW(NormalizedError(1, 0, 2, 0), std::invalid_argument);
}

std::vector<int> Counts(const std::string& text) {
  std::vector<int> out;
  std::string number;
  for (const char c : text + " ") {
    if (c >= '0' && c <= '9') {
      number += c;
    } else if (!number.empty()) {
      out.push_back(std::stoi(number));
      number.clear();
    }
  }
  return out;
}

TEST(AgreementStatistics, EveryNumberOfTheReference) {
  const auto path = testing::Shared("reference/data/reference_agreement.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  int checked = 0;
  const auto rows = ReadCsv(path);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::string& statistic = rows[i][0];
    const std::string& input = rows[i][1];
    const std::string& quantity = rows[i][2];
    const double expected = std::stod(rows[i][3]);
    SCOPED_TRACE(statistic + " " + input + " " + quantity);
    std::vector<int> n = Counts(input);
    double value = 0.0;
    if (statistic == "wilson95") {
      const auto interval = WilsonInterval(n[0], n[1]);
      value = quantity == "lo" ? interval.low : interval.high;
    } else if (statistic == "clopper_pearson95") {
      const auto interval = ClopperPearsonInterval(n[0], n[1]);
      value = quantity == "lo" ? interval.low : interval.high;
    } else if (statistic == "jeffreys95") {
      if ((n[0] == 0 && quantity == "lo") ||
          (n[0] == n[1] && quantity == "hi")) {
        continue;  // set to the end by convention
      }
      value = BetaQuantile(n[0] + 0.5, n[1] - n[0] + 0.5,
                           quantity == "lo" ? 0.025 : 0.975);
    } else if (statistic == "cohen_kappa" && n.size() == 4) {
      const CohensKappa kappa = CohenKappa({n[0], n[1], n[2], n[3]});
      value = quantity == "kappa" ? kappa.kappa
              : quantity == "ASE" ? kappa.ase
                                  : kappa.ase0;
    } else if (statistic == "mcc") {
      value = MatthewsCorrelation({n[0], n[1], n[2], n[3]});
    } else if (statistic == "mcnemar_exact") {
      value = McNemarTest(n[0], n[1]).p_exact;
    } else if (statistic == "mcnemar_midp") {
      value = McNemarTest(n[0], n[1]).p_mid;
    } else {
      continue;  // of other headers
    }
    EXPECT_NEAR(value, expected, 2e-9 * std::max(1.0, std::abs(expected)));
    ++checked;
  }
  EXPECT_EQ(checked, 84);
}

}  // namespace
}  // namespace touchdown::analysis
