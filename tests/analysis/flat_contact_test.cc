#include "touchdown/analysis/theory/flat_contact.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "tests/support/csv.h"
#include "tests/support/shared_data.h"
#include "touchdown/analysis/theory/lcp.h"

namespace touchdown::analysis {
namespace {

constexpr double kUlp = 0x1p-53;

void ExpectMatches(const testing::Row& row) {
  const std::string& id = row.Text("id");
  const FlatProblem p{
      .length_m = row.Number("a"),
      .height_m = row.Number("b"),
      .mu = row.Number("mu"),
      .slip = static_cast<Slip>(static_cast<int>(row.Number("slip_sign"))),
      .mass_kg = row.Number("m"),
      .gravity_mps2 = row.Number("g")};
  const FlatResult r = SolveFlatContact(p);
  const auto close = [&](double value, const char* column, double scale) {
    const double reference = static_cast<double>(row.Long(column));
    EXPECT_NEAR(value, reference, 4 * kUlp * (std::abs(reference) + scale))
        << id << ' ' << column;
  };
  close(r.m_rr, "M_rr", 1);
  close(r.m_rf, "M_rf", 1);
  close(r.m_fr, "M_fr", 1);
  close(r.m_ff, "M_ff", 1);
  close(r.determinant, "det", 0);
  close(r.tipping, "slip*mu*H/L", 0);
  ASSERT_EQ(r.solution.has_value(), row.Number("n_solutions") == 1.0) << id;
  if (!r.solution) return;
  EXPECT_EQ(Name(r.solution->feet), row.Text("s1_kind")) << id;
  const double weight = p.mass_kg * p.gravity_mps2;
  close(r.solution->rear_n, "s1_F_rear", weight);
  close(r.solution->front_n, "s1_F_front", weight);
  close(r.solution->rear_mps2, "s1_gdd_rear", p.gravity_mps2);
  close(r.solution->front_mps2, "s1_gdd_front", p.gravity_mps2);
}

TEST(SolveFlatContact, ReferenceCases) {
  const auto path = testing::Shared("reference/data/flat_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto rows = testing::ReadCsv(path);
  ASSERT_FALSE(rows.empty());
  for (const auto& row : rows) ExpectMatches(row);
}

TEST(SolveFlatContact, SquareTipsAboveUnitFriction) {
  FlatProblem p{
      .length_m = 0.1, .height_m = 0.1, .mu = 1.0, .gravity_mps2 = 10.0};
  FlatResult r = SolveFlatContact(p);
  ASSERT_TRUE(r.solution);
  EXPECT_EQ(r.solution->rear_n, 0.0);
  EXPECT_EQ(r.solution->front_n, 10.0);
  EXPECT_EQ(r.solution->tangential_n, -10.0);
  EXPECT_TRUE(r.within_tolerance);
  p.mu = 1.2;
  r = SolveFlatContact(p);
  ASSERT_TRUE(r.solution);
  EXPECT_EQ(r.solution->feet, Feet::kFront);
  EXPECT_GT(r.solution->rear_mps2, 0.0);
  p.mu = 5.0 / 3.0 + 1e-9;  // (4 a^2 + b^2)/(3 a b)
  EXPECT_FALSE(SolveFlatContact(p).solution);
}

TEST(SolveFlatContact, IsMirrored) {
  FlatProblem p{.length_m = 0.1, .height_m = 0.2, .mu = 0.8};
  const auto a = SolveFlatContact(p).solution;
  p.slip = Slip::kTrailing;
  const auto b = SolveFlatContact(p).solution;
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->front_n, b->rear_n);
  EXPECT_EQ(a->rear_mps2, b->front_mps2);
  EXPECT_EQ(a->tangential_n, -b->tangential_n);
}

// The closed form against the general solver.
TEST(SolveFlatContact, AgreesWithEnumeration) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 20'000; ++i) {
    const FlatProblem p{
        .length_m = 0.01 + unit(engine),
        .height_m = 0.01 + unit(engine),
        .mu = 4.0 * unit(engine),
        .slip = unit(engine) < 0.5 ? Slip::kLeading : Slip::kTrailing,
        .gravity_mps2 = 1.0};
    const FlatResult r = SolveFlatContact(p);
    const std::array m{r.m_rr, r.m_rf, r.m_fr, r.m_ff};
    const std::array q{-1.0, -1.0};
    const LcpResult lcp = SolveLcp(m, q);
    ASSERT_EQ(lcp.solutions.size(), r.solution ? 1u : 0u) << i;
    if (!r.solution) continue;
    const double size =
        1 + std::abs(r.solution->rear_n) + std::abs(r.solution->front_n);
    ASSERT_NEAR(lcp.solutions[0].z[0], r.solution->rear_n, 1e-12 * size) << i;
    ASSERT_NEAR(lcp.solutions[0].z[1], r.solution->front_n, 1e-12 * size) << i;
    ASSERT_NEAR(lcp.solutions[0].w[0], r.solution->rear_mps2, 1e-11 * size);
  }
}

TEST(SolveFlatContact, RefusesWhatCannotBe) {
  EXPECT_THROW(SolveFlatContact({.length_m = 0.0, .height_m = 0.1}),
               std::invalid_argument);
  EXPECT_THROW(
      SolveFlatContact({.length_m = 0.1, .height_m = 0.1, .gravity_mps2 = 0.0}),
      std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
