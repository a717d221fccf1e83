#include "touchdown/analysis/theory/lcp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/support/csv.h"
#include "tests/support/shared_data.h"

namespace touchdown::analysis {
namespace {

using ::testing::ElementsAre;

// All numbers in a cell like [["4/3", "2"], ["1", "0"]], in order.
std::vector<double> Numbers(const std::string& cell) {
  std::vector<double> out;
  std::size_t i = 0;
  while ((i = cell.find('"', i)) != std::string::npos) {
    const std::size_t end = cell.find('"', i + 1);
    const std::string text = cell.substr(i + 1, end - i - 1);
    const std::size_t slash = text.find('/');
    double value = std::stod(text);
    if (slash != std::string::npos) value /= std::stod(text.substr(slash + 1));
    out.push_back(value);
    i = end + 1;
  }
  return out;
}

TEST(SolveLcp, TextbookAnchors) {
  const auto path = testing::Shared("reference/data/lcp_anchor_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto rows = testing::ReadCsv(path);
  ASSERT_FALSE(rows.empty());
  for (const auto& row : rows) {
    const std::string& name = row.Text("name");
    const auto m = Numbers(row.Text("M"));
    const auto q = Numbers(row.Text("q"));
    const auto reference = Numbers(row.Text("basic_solutions"));
    const LcpResult r = SolveLcp(m, q);
    EXPECT_EQ(r.n_basic, static_cast<int>(row.Number("n_basic_solutions")))
        << name;
    EXPECT_EQ(r.n_singular_bases,
              static_cast<int>(row.Number("n_singular_bases")))
        << name;
    const std::size_t n = q.size();
    ASSERT_EQ(reference.size(), static_cast<std::size_t>(r.n_basic) * n)
        << name;
    for (std::size_t k = 0; k < static_cast<std::size_t>(r.n_basic); ++k) {
      // The same solutions in whatever order.
      const bool found = std::any_of(
          r.solutions.begin(), r.solutions.end(), [&](const LcpSolution& s) {
            for (std::size_t i = 0; i < n; ++i) {
              const double z = reference[k * n + i];
              if (std::abs(s.z[i] - z) > 1e-14 * (1 + std::abs(z)))
                return false;
            }
            return s.basic;
          });
      EXPECT_TRUE(found) << name << ", solution " << k;
    }
    for (const LcpSolution& s : r.solutions) {
      EXPECT_LE(s.residual, 1e-14) << name;
    }
  }
}

LcpResult One(double m, double q) {
  return SolveLcp(std::vector{m}, std::vector{q});
}

TEST(SolveLcp, EveryRegimeOfOneContact) {
  EXPECT_EQ(One(2, -1).status, LcpStatus::kUnique);
  EXPECT_THAT(One(2, -1).solutions[0].z, ElementsAre(0.5));
  EXPECT_EQ(One(2, 1).status, LcpStatus::kUnique);
  EXPECT_EQ(One(-1, 1).status, LcpStatus::kSeveral);
  EXPECT_EQ(One(-1, -1).status, LcpStatus::kNone);
  EXPECT_EQ(One(0, -1).status, LcpStatus::kNone);
  EXPECT_EQ(One(0, 0).status, LcpStatus::kContinuum);
  EXPECT_EQ(One(0, 0).n_singular_bases, 1);
}

// Kostreva (1979): least-index pivoting rules cycle on it.
TEST(SolveLcp, CyclingExample) {
  const std::vector<double> m{1, 2, 0, 0, 1, 2, 2, 0, 1};
  const LcpResult r = SolveLcp(m, std::vector<double>{-1, -1, -1});
  ASSERT_EQ(r.status, LcpStatus::kUnique);
  for (const double z : r.solutions[0].z) EXPECT_NEAR(z, 1.0 / 3.0, 1e-16);
}

// A bimatrix game with three equilibria, of which Lemke's method finds none
// (Floudas and Pardalos 1990, problem 10.2.4).
TEST(SolveLcp, BimatrixHasThreeSolutions) {
  const std::vector<double> m{0,  0,  10, 20, 0,  0,  30, 15,
                              10, 20, 0,  0,  30, 15, 0,  0};
  const LcpResult r = SolveLcp(m, std::vector<double>{-1, -1, -1, -1});
  EXPECT_EQ(r.status, LcpStatus::kSeveral);
  EXPECT_EQ(r.solutions.size(), 3u);
  EXPECT_EQ(r.n_singular_bases, 10);
}

TEST(SolveLcp, SegmentOfSolutions) {
  const LcpResult r =
      SolveLcp(std::vector<double>{1, 1, 1, 1}, std::vector<double>{-1, -1});
  EXPECT_EQ(r.status, LcpStatus::kContinuum);
  EXPECT_EQ(r.n_basic, 2);
}

// z = (1, 0) belongs to singular bases alone.
TEST(SolveLcp, CornerOfSingularBases) {
  const LcpResult r =
      SolveLcp(std::vector<double>{0, 0, 1, 5}, std::vector<double>{0, -1});
  EXPECT_EQ(r.status, LcpStatus::kContinuum);
  ASSERT_EQ(r.solutions.size(), 2u);
  EXPECT_EQ(r.n_basic, 1);
  EXPECT_THAT(r.solutions[1].z, ElementsAre(1.0, 0.0));
  EXPECT_FALSE(r.solutions[1].basic);
}

TEST(SolveLcp, ScalesOfRowsAndColumnsDoNotMatter) {
  // The 3-cycle with rows and columns in units that differ by 1e60.
  std::vector<double> m{1, 2, 0, 0, 1, 2, 2, 0, 1};
  std::vector<double> q{-1, -1, -1};
  const double row[] = {1e60, 1.0, 1e-60};
  const double column[] = {1e-30, 1e30, 1.0};
  for (std::size_t i = 0; i < 3; ++i) {
    q[i] *= row[i];
    for (std::size_t j = 0; j < 3; ++j) m[3 * i + j] *= row[i] * column[j];
  }
  const LcpResult r = SolveLcp(m, q);
  ASSERT_EQ(r.status, LcpStatus::kUnique);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(r.solutions[0].z[j] * column[j], 1.0 / 3.0, 1e-15);
  }
}

TEST(SolveLcp, RefusesWhatItCannot) {
  const std::vector<double> nine(81, 1.0);
  EXPECT_THROW(SolveLcp(nine, std::vector<double>(9, 1.0)),
               std::invalid_argument);
  EXPECT_THROW(SolveLcp(std::vector<double>{1, 2}, std::vector<double>{1}),
               std::invalid_argument);
  EXPECT_THROW(One(std::numeric_limits<double>::infinity(), 1.0),
               std::invalid_argument);
}

// P-matrices have exactly one solution for every q (Samelson, Thrall and Wesler
// 1958): here M = B B^T + I, nonsymmetric by a skew part.
TEST(SolveLcp, PositiveDefiniteHasExactlyOne) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2'000; ++i) {
    const std::size_t n = 1 + static_cast<std::size_t>(i) % 5;
    std::vector<double> b(n * n), m(n * n), q(n);
    for (double& x : b) x = normal(engine);
    for (double& x : q) x = normal(engine);
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t c = 0; c < n; ++c) {
        double sum = r == c ? 1.0 : (r < c ? 0.7 : -0.7);
        for (std::size_t k = 0; k < n; ++k) sum += b[r * n + k] * b[c * n + k];
        m[r * n + c] = sum;
      }
    }
    const LcpResult result = SolveLcp(m, q);
    ASSERT_EQ(result.status, LcpStatus::kUnique) << i;
    ASSERT_LE(result.solutions[0].residual, 1e-14) << i;
  }
}

}  // namespace
}  // namespace touchdown::analysis
