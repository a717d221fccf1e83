#include "touchdown/analysis/statistics/boundary_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "touchdown/analysis/statistics/paper_table1.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::BodyKind;
using core::kDegree;
using core::Verdict;
using ::testing::HasSubstr;

StudyOptions Declared(double boundary_deg, double u_deg = 0.0) {
  StudyOptions options;
  options.declared =
      TheoryBoundary{"t", boundary_deg * kDegree, u_deg * kDegree};
  return options;
}

std::vector<Observation> Sharp(double boundary_deg, int n, double step_deg) {
  std::vector<Observation> out;
  for (int i = 0; i < n; ++i) {
    const double x = boundary_deg + step_deg * (i - n / 2 + 0.5);
    out.push_back(Observe(x * kDegree, 0.05 * kDegree, x > boundary_deg));
  }
  return out;
}

TEST(StudyBoundary, PaperTable1IsInconclusive) {
  StudyOptions options = Declared(11.8);
  options.fit.lapse_gain = HUGE_VAL;
  // The reference's figures are of one prior.
  options.fit.cautious_scatter.reset();
  options.fit.sharp_scatter.reset();
  options.origin = core::Origin::kManual;
  const auto trials = PaperTable1(BodyKind::kSphere, 0.5 * kDegree);
  const BoundaryStudy study = StudyBoundary(trials, options);
  const TheoryComparison& theory = study.theories.at(0);
  EXPECT_EQ(*theory.judgement.verdict, Verdict::kInconclusive);
  EXPECT_NEAR(theory.smallest_margin_rad / kDegree, 17.2, 0.05);
  EXPECT_NEAR(theory.p_below, 0.043, 0.002);
  // (20.051 - 11.8) / half of (32.016 - 10.970).
  EXPECT_NEAR(theory.e_n, 0.784, 0.003);
  // Eight decide and agree: statistics.md, 8/8 without the tie.
  EXPECT_EQ(theory.agreement.deciding.right(), 8);
  EXPECT_NEAR(theory.kappa->kappa, 1.0, 1e-12);
  EXPECT_NEAR(theory.clopper_pearson95->low, std::pow(0.025, 1.0 / 8), 1e-9);
}

TEST(StudyBoundary, SharpTrialsConfirmTheRightTheoryAndContradictAWrongOne) {
  const auto trials = Sharp(12.0, 40, 0.2);
  EXPECT_EQ(
      *StudyBoundary(trials, Declared(12.2)).theories[0].judgement.verdict,
      Verdict::kConfirmed);
  EXPECT_EQ(
      *StudyBoundary(trials, Declared(15.0)).theories[0].judgement.verdict,
      Verdict::kContradicted);
  // A vague theory is harder to contradict.
  EXPECT_EQ(
      *StudyBoundary(trials, Declared(15.0, 1.5)).theories[0].judgement.verdict,
      Verdict::kInconclusive);
}

TEST(StudyBoundary, OnlyTheDeclaredTheoryGetsAVerdict) {
  StudyOptions options = Declared(12.2);
  options.others = {{"other", 12.0 * kDegree, 0.0}};
  const auto study = StudyBoundary(Sharp(12.0, 40, 0.2), options);
  ASSERT_EQ(study.theories.size(), 2u);
  EXPECT_TRUE(study.theories[0].judgement.verdict.has_value());
  EXPECT_FALSE(study.theories[1].judgement.verdict.has_value());
  EXPECT_THAT(study.theories[1].judgement.reason, HasSubstr("declared"));
}

TEST(StudyBoundary, NoTrialsNoVerdictAndNoNaN) {
  const auto study = StudyBoundary({}, Declared(11.8));
  EXPECT_FALSE(study.theories[0].judgement.verdict.has_value());
  EXPECT_THAT(study.theories[0].judgement.reason, HasSubstr("no decided"));
  EXPECT_TRUE(std::isfinite(study.theories[0].e_n));
  EXPECT_FALSE(study.theories[0].kappa.has_value());
  EXPECT_FALSE(study.likelihood.has_estimate);
  EXPECT_TRUE(std::isfinite(study.next.angle_rad));
}

// Property: whatever the outcomes of four trials, every number is finite and
// every interval holds its median.
TEST(StudyBoundary, EveryPatternOfOutcomesIsFinite) {
  for (unsigned pattern = 0; pattern < 81; ++pattern) {
    std::vector<Observation> trials;
    unsigned rest = pattern;
    for (int i = 0; i < 4; ++i, rest /= 3) {
      trials.push_back(
          Observe((3.0 + 4.0 * i) * kDegree, 0.2 * kDegree, 0.5 * (rest % 3)));
    }
    const auto study = StudyBoundary(trials, Declared(11.8));
    const auto& p = study.posterior;
    ASSERT_TRUE(std::isfinite(p.median_rad)) << pattern;
    ASSERT_LE(p.interval95_rad.low, p.interval90_rad.low) << pattern;
    ASSERT_LE(p.interval90_rad.low, p.median_rad) << pattern;
    ASSERT_LE(p.median_rad, p.interval90_rad.high) << pattern;
    ASSERT_LE(p.interval90_rad.high, p.interval95_rad.high) << pattern;
    ASSERT_GT(p.sd_rad, 0.0) << pattern;
    ASSERT_TRUE(std::isfinite(study.likelihood.estimate_rad)) << pattern;
    ASSERT_LE(study.likelihood.interval95_rad.low,
              study.likelihood.estimate_rad)
        << pattern;
    ASSERT_TRUE(std::isfinite(study.next.expected_sd_rad)) << pattern;
    ASSERT_LE(study.next.expected_sd_rad, p.sd_rad * (1 + 1e-9)) << pattern;
  }
}

}  // namespace
}  // namespace touchdown::analysis
