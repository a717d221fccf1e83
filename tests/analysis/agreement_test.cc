#include "touchdown/analysis/statistics/agreement.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "touchdown/analysis/statistics/paper_table1.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::BodyKind;
using core::kDegree;

Observation At(double angle_deg, double u_deg, double p) {
  return Observe(angle_deg * kDegree, u_deg * kDegree, p);
}

TEST(FindBracket, PaperTable1SupportsOnlyTheBrackets) {
  // theory.md E19: [11.8, 27.4) for the sphere, [7.8, 11.8) for the rectangle.
  const Bracket sphere = FindBracket(PaperTable1(BodyKind::kSphere, 0.0));
  EXPECT_TRUE(sphere.closed());
  EXPECT_NEAR(*sphere.low_rad / kDegree, 11.8, 1e-12);
  EXPECT_NEAR(*sphere.high_rad / kDegree, 27.4, 1e-12);
  const Bracket rectangle = FindBracket(PaperTable1(BodyKind::kRectangle, 0.0));
  EXPECT_NEAR(*rectangle.low_rad / kDegree, 7.8, 1e-12);
  EXPECT_NEAR(*rectangle.high_rad / kDegree, 11.8, 1e-12);
}

TEST(FindBracket, OneOutcomeLeavesAnEndOpen) {
  const std::vector<Observation> slides{At(5, 0.1, 0), At(9, 0.1, 0)};
  const Bracket bracket = FindBracket(slides);
  EXPECT_FALSE(bracket.closed());
  EXPECT_NEAR(*bracket.low_rad / kDegree, 9, 1e-12);
  EXPECT_FALSE(bracket.high_rad.has_value());
}

TEST(FindBracket, OverlapAndEqualAnglesAreNoBracket) {
  EXPECT_TRUE(FindBracket(std::vector{At(9, 0, 0), At(8, 0, 1)}).overlap);
  EXPECT_TRUE(FindBracket(std::vector{At(9, 0, 0), At(9, 0, 1)}).overlap);
  EXPECT_FALSE(FindBracket(std::vector{At(8, 0, 0), At(9, 0, 1)}).overlap);
}

TEST(FindBracket, UndecidedTrialsDoNotEnter) {
  const Bracket bracket =
      FindBracket(std::vector{At(5, 0, 0), At(9, 0, 0.6), At(12, 0, 1)});
  EXPECT_NEAR(*bracket.low_rad / kDegree, 5, 1e-12);
  EXPECT_NEAR(*bracket.high_rad / kDegree, 12, 1e-12);
}

TEST(CompareWithTheory, AtTheBoundaryItSlides) {
  // statistics.md 0.2: "slide if alpha <= theta" gives 9/9.
  for (const BodyKind body : {BodyKind::kSphere, BodyKind::kRectangle}) {
    const auto trials = PaperTable1(body, 0.5 * kDegree);
    const TheoryBoundary theory = PaperTable1Boundary(body);
    const Agreement slides = CompareWithTheory(trials, theory);
    EXPECT_EQ(slides.all.right(), 9);
    EXPECT_EQ(slides.all.total(), 9);
    EXPECT_EQ(slides.decides_nothing, 1);
    EXPECT_EQ(slides.deciding.right(), 8);
    EXPECT_EQ(slides.deciding.total(), 8);
  }
}

TEST(CompareWithTheory, EveryBoundaryInTheBracketAgreesAsWell) {
  const Agreement sphere =
      CompareWithTheory(PaperTable1(BodyKind::kSphere, 0.0),
                        PaperTable1Boundary(BodyKind::kSphere));
  EXPECT_NEAR(*sphere.same_low_rad / kDegree, 11.8, 1e-12);
  EXPECT_NEAR(*sphere.same_high_rad / kDegree, 27.4, 1e-12);
}

TEST(CompareWithTheory, SameAgreementHasNoEndWhereNoTrialBoundsIt) {
  const std::vector<Observation> slides{At(5, 0, 0), At(9, 0, 0)};
  const Agreement agreement =
      CompareWithTheory(slides, {"t", 12 * kDegree, 0.0});
  EXPECT_NEAR(*agreement.same_low_rad / kDegree, 9, 1e-12);
  EXPECT_FALSE(agreement.same_high_rad.has_value());
  EXPECT_FALSE(CompareWithTheory({}, {"t", 0.2, 0.0}).same_low_rad.has_value());
}

// Property: agreement at any boundary inside [same_low, same_high) is that of
// the theory, whatever the pattern of outcomes.
TEST(CompareWithTheory, SameAgreementHoldsOverAllPatternsOfFiveTrials) {
  for (unsigned pattern = 0; pattern < 32; ++pattern) {
    std::vector<Observation> trials;
    for (unsigned i = 0; i < 5; ++i) {
      trials.push_back(At(2.0 + 4.0 * i, 0.0, (pattern >> i) & 1u));
    }
    for (double boundary = 0.5; boundary < 22.0; boundary += 1.0) {
      const Agreement a = CompareWithTheory(trials, {"t", boundary * kDegree});
      for (double other = 0.5; other < 22.0; other += 1.0) {
        const bool inside =
            (!a.same_low_rad || other * kDegree >= *a.same_low_rad) &&
            (!a.same_high_rad || other * kDegree < *a.same_high_rad);
        if (!inside) continue;
        EXPECT_EQ(CompareWithTheory(trials, {"t", other * kDegree}).all.right(),
                  a.all.right())
            << pattern << " " << boundary << " " << other;
      }
    }
  }
}

TEST(CompareWithTheory, TrialsWithinTwoUDecideNothing) {
  const std::vector<Observation> trials{At(10.7, 0.5, 0), At(10.9, 0.5, 0),
                                        At(12.8, 0.5, 1), At(12.9, 0.5, 1)};
  const Agreement agreement =
      CompareWithTheory(trials, {"t", 11.8 * kDegree, 0.0});
  EXPECT_EQ(agreement.decides_nothing, 2);
  EXPECT_EQ(agreement.deciding.total(), 2);
}

TEST(CompareWithTheory, RefusesAnImpossibleTheory) {
  EXPECT_THROW(
      CompareWithTheory({}, {"t", std::numeric_limits<double>::quiet_NaN()}),
      std::invalid_argument);
  EXPECT_THROW(CompareWithTheory({}, {"t", 0.1, -1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
