#include "touchdown/analysis/agreement_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/analysis/reference_data.h"
#include "tests/support/shared_data.h"
#include "touchdown/analysis/special_functions.h"

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
  EXPECT_NEAR(ClopperPearsonLowerLimit(9, 9), 0.7168712, 1e-7);
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

TEST(CohenKappa, SexualFunOfAgresti) {
  // Agresti (1990); vcd prints 0.1293 (0.0686) and 0.2374 (0.0783).
  const int counts[] = {7, 7, 2, 3, 2, 8, 3, 7, 1, 5, 4, 9, 2, 8, 9, 14};
  const CohensKappa plain = CohenKappa(counts, 4);
  EXPECT_NEAR(plain.kappa, 0.129330254, kTolerance);
  EXPECT_NEAR(plain.ase, 0.06859853248, kTolerance);
  const CohensKappa linear = CohenKappa(counts, 4, KappaWeights::kLinear);
  EXPECT_NEAR(linear.kappa, 0.2373806276, kTolerance);
  EXPECT_NEAR(linear.ase, 0.07831633478, kTolerance);
}

TEST(CohenKappa, OneCategoryIsUndefined) {
  const int counts[] = {7, 0, 0, 0};
  EXPECT_TRUE(std::isnan(CohenKappa(counts, 2).kappa));
  EXPECT_TRUE(std::isnan(MatthewsCorrelation({7, 0, 0, 0})));
  const int none[] = {0, 0, 0, 0};
  EXPECT_THROW(CohenKappa(none, 2), std::invalid_argument);
  EXPECT_THROW(CohenKappa(counts, 3), std::invalid_argument);
}

TEST(McNemarTest, ApprovalRatingsAndSmallCounts) {
  const McNemar approval = McNemarTest(150, 86);
  EXPECT_NEAR(approval.chi_square, 17.3559322, 1e-7);
  EXPECT_NEAR(approval.chi_square_corrected, 16.81779661, 1e-8);
  EXPECT_NEAR(approval.p_corrected, 4.114562281e-05, 1e-13);
  EXPECT_EQ(McNemarTest(0, 0).p_exact, 1.0);
  EXPECT_NEAR(McNemarTest(1, 0).p_exact, 1.0, 1e-12);  // the paper's two shapes
  EXPECT_NEAR(McNemarTest(3, 3).p_exact, 1.0, 1e-12);
  EXPECT_THROW(McNemarTest(-1, 0), std::invalid_argument);
}

TEST(FisherExactTest, TheLadyTastingTea) {
  const Fisher tea = FisherExactTest({3, 1, 1, 3});
  EXPECT_NEAR(tea.p_greater, 0.2428571429, kTolerance);
  EXPECT_NEAR(tea.p_two_sided, 0.4857142857, kTolerance);
}

TEST(FisherExactTest, TheSameForAnyThresholdInTheBracket) {
  // statistics.md 0.4: sphere 1/126, rectangle 1/84.
  EXPECT_NEAR(FisherExactTest({4, 0, 0, 5}).p_two_sided, 1.0 / 126, 1e-12);
  EXPECT_NEAR(FisherExactTest({3, 0, 0, 6}).p_two_sided, 1.0 / 84, 1e-12);
}

TEST(NormalizedError, CombinesBothUncertainties) {
  EXPECT_NEAR(NormalizedError(12.4, 0.8, 11.8, 0.6), 0.6, 1e-12);
  EXPECT_THROW(NormalizedError(1, 0, 2, 0), std::invalid_argument);
}

TEST(Equivalence, PassesExactlyWhenTheIntervalLiesInside) {
  for (double value = 10.5; value < 13.2; value += 0.1) {
    for (const double se : {0.1, 0.3, 0.6}) {
      const double z95 = 1.6448536269514722;
      const bool inside =
          value - z95 * se > 11.8 - 1.0 && value + z95 * se < 11.8 + 1.0;
      EXPECT_EQ(EquivalenceZ(value, se, 11.8, 1.0).equivalent, inside);
      const double least = SmallestEquivalenceMargin(value, se, 11.8);
      EXPECT_TRUE(EquivalenceZ(value, se, 11.8, least * 1.0001).equivalent);
      EXPECT_FALSE(EquivalenceZ(value, se, 11.8, least * 0.9999).equivalent);
    }
  }
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
    } else if (statistic == "clopper_pearson_onesided95") {
      // The upper limit is that of the other outcome.
      value = quantity == "lo"
                  ? ClopperPearsonLowerLimit(n[0], n[1])
                  : 1.0 - ClopperPearsonLowerLimit(n[1] - n[0], n[1]);
    } else if (statistic == "jeffreys95") {
      if ((n[0] == 0 && quantity == "lo") ||
          (n[0] == n[1] && quantity == "hi")) {
        continue;  // set to the end by convention
      }
      value = BetaQuantile(n[0] + 0.5, n[1] - n[0] + 0.5,
                           quantity == "lo" ? 0.025 : 0.975);
    } else if (statistic == "youden_J") {
      value = n[0] / (n[0] + 1.0 * n[1]) - n[2] / (n[2] + 1.0 * n[3]);
    } else if (statistic.starts_with("mcnemar_") && n.size() == 4) {
      const McNemar test = McNemarTest(n[1], n[2]);
      value = quantity == "p"               ? test.p_corrected
              : statistic == "mcnemar_nocc" ? test.chi_square
                                            : test.chi_square_corrected;
    } else if (statistic == "cohen_kappa" && n.size() == 4) {
      const CohensKappa kappa = CohenKappa(n, 2);
      value = quantity == "kappa" ? kappa.kappa
              : quantity == "ASE" ? kappa.ase
                                  : kappa.ase0;
    } else if (statistic == "mcc") {
      value = MatthewsCorrelation({n[0], n[1], n[2], n[3]});
    } else if (statistic.starts_with("fisher_exact")) {
      const Fisher fisher = FisherExactTest({n[0], n[1], n[2], n[3]});
      value = statistic == "fisher_exact_greater" ? fisher.p_greater
                                                  : fisher.p_two_sided;
    } else if (statistic == "mcnemar_exact") {
      value = McNemarTest(n[0], n[1]).p_exact;
    } else if (statistic == "mcnemar_midp") {
      value = McNemarTest(n[0], n[1]).p_mid;
    } else if (statistic.starts_with("tost")) {
      const Equivalence e =
          statistic == "tost_z"       ? EquivalenceZ(11.6, 0.2, 11.8, 0.5)
          : input.starts_with("m.54") ? EquivalenceT(0.54, 1.2, 100, 0.5, 0.5)
                                      : EquivalenceT(11.95, 0.30, 6, 11.8, 0.5);
      value = quantity == "p_lower"         ? e.p_lower
              : quantity == "p_upper"       ? e.p_upper
              : quantity.ends_with("lower") ? e.statistic_lower
                                            : e.statistic_upper;
    } else {
      continue;  // of other headers
    }
    EXPECT_NEAR(value, expected, 2e-9 * std::max(1.0, std::abs(expected)));
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

}  // namespace
}  // namespace touchdown::analysis
