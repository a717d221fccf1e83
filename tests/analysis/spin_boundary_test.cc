#include "touchdown/analysis/theory/spin_boundary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/support/csv.h"
#include "tests/support/shared_data.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::kDegree;

void ExpectClose(double value, long double reference, double relative,
                 const std::string& what) {
  // Below the range of double the value is 0 or subnormal.
  EXPECT_NEAR(value, static_cast<double>(reference),
              relative * std::abs(static_cast<double>(reference)) +
                  std::numeric_limits<double>::denorm_min())
      << what;
}

void ExpectMatches(const testing::Row& row) {
  constexpr double kRelative = 4 * 0x1p-53;
  const std::string& id = row.Text("id");
  const SpinBoundary b =
      SolveSpinBoundary(row.Number("R"), row.Number("omega"), row.Number("g"));
  ExpectClose(b.w, row.Long("w=R*omega^2/g"), kRelative, id + " w");
  ExpectClose(b.w_minus_1, row.Long("w-1"), kRelative, id + " w-1");
  const std::string& status = row.Text("status");
  if (status.rfind("NONE", 0) == 0) {
    EXPECT_EQ(b.status, SpinBoundaryStatus::kNone) << id;
    return;
  }
  ASSERT_EQ(b.status, SpinBoundaryStatus::kExists) << id;
  ExpectClose(b.alpha_rad, row.Long("alpha_b_rad"), kRelative, id + " alpha");
  ExpectClose(b.d_omega, row.Long("dalpha_domega"), kRelative, id + " domega");
  ExpectClose(b.d_radius, row.Long("dalpha_dR"), kRelative, id + " dR");
  ExpectClose(b.d_gravity, row.Long("dalpha_dg"), kRelative, id + " dg");
  ExpectClose(b.d2_omega, row.Long("d2alpha_domega2"), kRelative, id + " d2");
  ExpectClose(b.condition, row.Long("rel_condition_wrt_omega"), kRelative,
              id + " condition");
}

TEST(SolveSpinBoundary, ReferenceCases) {
  const auto path = testing::Shared("reference/data/boundary_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto rows = testing::ReadCsv(path);
  ASSERT_FALSE(rows.empty());
  for (const auto& row : rows) ExpectMatches(row);
}

// R omega^2 / g = 1 + 1.8e-16, from 90 digits; arcsin would say 90 deg.
TEST(SolveSpinBoundary, OneUlpAboveTheThreshold) {
  const SpinBoundary b = SolveSpinBoundary(9.810000000000002, 1.0, 9.81);
  EXPECT_NEAR(b.w_minus_1, 1.810761304179663990432396e-16, 1e-31);
  EXPECT_NEAR(b.alpha_rad, 1.57079630776459812351842, 1e-15);
  EXPECT_NEAR(b.d_omega, -105095566.443718932933448, 1e-7);
  EXPECT_EQ(SolveSpinBoundary(9.81, 1.0, 9.81).status,
            SpinBoundaryStatus::kAt90);
  EXPECT_EQ(SolveSpinBoundary(9.809999999999999, 1.0, 9.81).status,
            SpinBoundaryStatus::kNone);
}

TEST(SolveSpinBoundary, NoneWithoutSpin) {
  EXPECT_EQ(SolveSpinBoundary(0.1, 0.0, 9.81).status,
            SpinBoundaryStatus::kNone);
  EXPECT_THROW(SolveSpinBoundary(0.0, 1.0, 9.81), std::invalid_argument);
  EXPECT_THROW(SolveSpinBoundary(0.1, 1.0, 0.0), std::invalid_argument);
}

TEST(SpinBoundaryOfUncertainOmega, ReferenceCases) {
  const auto path = testing::Shared("reference/data/boundary_uncertainty.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto rows = testing::ReadCsv(path);
  ASSERT_FALSE(rows.empty());
  constexpr double kRelative = 1e-9;
  for (const auto& row : rows) {
    const std::string& id = row.Text("id");
    const auto u =
        SpinBoundaryOfUncertainOmega(row.Number("R"), row.Number("omega"),
                                     row.Number("u_omega"), row.Number("g"));
    ExpectClose(u.p_none, row.Long("P_no_boundary"), 1e-9, id + " P");
    const auto compare = [&](const std::optional<double>& value,
                             const char* column) {
      ASSERT_EQ(value.has_value(), row.Has(column)) << id << ' ' << column;
      if (!value) return;
      ExpectClose(*value / kDegree, row.Long(column), kRelative,
                  id + ' ' + column);
    };
    compare(u.first_order_u_rad, "GUM_first_order_u_deg");
    compare(u.second_order_mean_rad, "second_order_mean_deg");
    compare(u.mean_rad, "cond_mean_deg");
    compare(u.u_rad, "cond_std_deg");
    compare(u.low_rad, "cond_q2.5_deg");
    compare(u.high_rad, "cond_q97.5_deg");
  }
}

// Against brute force near the threshold, where first order says 5.8 deg.
TEST(SpinBoundaryOfUncertainOmega, AgreesWithMonteCarlo) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> omega(10.0, 0.1);
  constexpr int kDraws = 200'000;
  int none = 0;
  double sum = 0.0;
  double square = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const SpinBoundary b = SolveSpinBoundary(0.1, omega(engine), 9.81);
    if (b.status == SpinBoundaryStatus::kNone) {
      ++none;
      continue;
    }
    sum += b.alpha_rad;
    square += b.alpha_rad * b.alpha_rad;
  }
  const auto u = SpinBoundaryOfUncertainOmega(0.1, 10.0, 0.1, 9.81);
  EXPECT_FALSE(u.first_order_is_valid);
  EXPECT_NEAR(u.p_none, static_cast<double>(none) / kDraws, 0.004);
  const double n = kDraws - none;
  EXPECT_NEAR(*u.mean_rad, sum / n, 0.001);
  EXPECT_NEAR(*u.u_rad, std::sqrt(square / n - sum * sum / n / n), 0.001);
}

TEST(SpinBoundaryOfUncertainOmega, FarFromTheThresholdFirstOrderHolds) {
  const auto u = SpinBoundaryOfUncertainOmega(0.1, 20.0, 0.2, 9.81);
  EXPECT_TRUE(u.first_order_is_valid);
  EXPECT_NEAR(*u.first_order_u_rad / *u.u_rad, 1.0, 2e-3);
}

}  // namespace
}  // namespace touchdown::analysis
