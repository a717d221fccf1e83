#include "touchdown/analysis/theory/contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "tests/support/csv.h"
#include "tests/support/shared_data.h"

namespace touchdown::analysis {
namespace {

constexpr double kUlp = 0x1p-53;

// 4.7 of the acceptance: F_n within 16 u times the condition number; the
// grain of a subnormal F_n is its own spacing.
void ExpectForce(double value, long double reference, double condition,
                 const std::string& what) {
  constexpr long double kLargest = std::numeric_limits<double>::max();
  if (std::abs(reference) > kLargest) {
    EXPECT_TRUE(std::isinf(value)) << what;
    return;
  }
  const long double tolerance = 16.0L * kUlp * condition * std::abs(reference) +
                                std::numeric_limits<double>::denorm_min();
  EXPECT_LE(std::abs(static_cast<long double>(value) - reference), tolerance)
      << what << " is " << value << ", reference "
      << static_cast<double>(reference);
}

ContactProblem MakeProblem(const testing::Row& row) {
  ContactProblem p;
  p.alpha = SinCosOfRadians(row.Number("alpha_rad"));
  p.mu = row.Number("mu");
  p.slip = static_cast<Slip>(static_cast<int>(row.Number("slip_sign")));
  p.mass_kg = row.Number("m");
  p.radius_m = row.Number("R");
  if (row.Has("kappa_in")) p.kappa = row.Number("kappa_in");
  if (row.Has("k_in")) p.gyration_radius_m = row.Number("k_in");
  p.omega_rad_per_s = row.Number("omega");
  p.gravity_mps2 = row.Number("g");
  return p;
}

void ExpectMatches(const testing::Row& row) {
  const std::string& id = row.Text("id");
  const ContactResult r = SolveContact(MakeProblem(row));
  const std::string& exact = row.Text("regime_exact");
  const std::string& tolerant = row.Text("regime_with_tolerance");
  EXPECT_EQ(Name(r.tolerant_regime), tolerant.substr(0, tolerant.find('(')))
      << id;
  EXPECT_EQ(r.within_tolerance, exact != tolerant) << id;
  if (Name(r.regime) != exact) {
    // Not even 64 bits can tell: then the answer says so.
    EXPECT_EQ(r.regime, r.tolerant_regime) << id;
    EXPECT_TRUE(r.within_tolerance) << id;
    return;
  }
  ASSERT_EQ(r.n_solutions, static_cast<int>(row.Number("n_solutions"))) << id;
  const double condition = std::max({r.a_hat_condition, r.b_condition, 1.0});
  for (int i = 0; i < r.n_solutions; ++i) {
    const std::string sol = "sol" + std::to_string(i + 1) + "_";
    const ContactSolution& s = r.solution[static_cast<std::size_t>(i)];
    EXPECT_EQ(Name(s.kind), row.Text(sol + "kind")) << id;
    ExpectForce(s.normal_n, row.Long(sol + "Fn"), condition, id + " Fn");
    ExpectForce(s.tangential_n, row.Long(sol + "Ft"), condition, id + " Ft");
    ExpectForce(s.normal_mps2, row.Long(sol + "gddN"), condition, id + " gddN");
    // Of g_T'' the conditions say nothing where its own terms cancel.
    const double force_part =
        std::abs(s.normal_n / row.Number("m")) * (1 + row.Number("mu"));
    const double gt = static_cast<double>(row.Long(sol + "gddT"));
    if (std::isfinite(gt) && std::isfinite(force_part)) {
      EXPECT_NEAR(
          s.tangential_mps2, gt,
          64 * kUlp * condition * (std::abs(gt) + force_part + row.Number("g")))
          << id;
    }
    EXPECT_LE(s.residual, 16 * kUlp) << id;
  }
  EXPECT_NEAR(r.b_condition, row.Number("cond_B"), 2e-3 * row.Number("cond_B"))
      << id;
  if (row.Has("cond_A")) {
    EXPECT_NEAR(r.a_hat_condition, row.Number("cond_A"),
                2e-3 * row.Number("cond_A"))
        << id;
  }
}

TEST(SolveContact, HardCases) {
  const auto path = testing::Shared("reference/data/lcp_hard_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto rows = testing::ReadCsv(path);
  ASSERT_FALSE(rows.empty());
  for (const auto& row : rows) ExpectMatches(row);
}

TEST(SolveSlidingContact, HardCases) {
  const auto path = testing::Shared("reference/data/lcp_hard_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  for (const auto& row : testing::ReadCsv(path)) {
    const std::string& id = row.Text("id");
    const ContactProblem p = MakeProblem(row);
    if (p.slip == Slip::kNone) continue;
    const QuickContact quick = SolveSlidingContact(p);
    const ContactResult full = SolveContact(p);
    EXPECT_EQ(quick.regime, full.tolerant_regime) << id;
    if (full.within_tolerance) continue;
    const auto solutions = full.Solutions();
    const double force =
        solutions.empty() ? 0.0 : solutions.back().normal_n / p.mass_kg;
    if (p.mass_kg < 1e-300 || p.mass_kg > 1e300) continue;
    EXPECT_NEAR(
        quick.normal_per_mass_mps2, force,
        16 * kUlp * std::max(full.a_hat_condition, full.b_condition) * force)
        << id;
  }
}

// Frozen from 90-digit arithmetic.
TEST(SolveContact, PlainPainleveHasNoSolution) {
  ContactProblem p{.alpha = SinCosOfRadians(1.0471975511965976),
                   .mu = 1.5,
                   .slip = Slip::kLeading,
                   .radius_m = 0.1,
                   .gravity_mps2 = 9.81};
  EXPECT_EQ(SolveContact(p).regime, Regime::kInconsistent);
  EXPECT_EQ(SolveContact(p).n_solutions, 0);
  p.omega_rad_per_s = 30.0;
  const ContactResult two = SolveContact(p);
  EXPECT_EQ(two.regime, Regime::kIndeterminate);
  ASSERT_EQ(two.n_solutions, 2);
  EXPECT_NEAR(two.solution[0].normal_mps2, 68.1322863405994768703819, 1e-12);
  EXPECT_NEAR(two.solution[1].normal_n, 343.136892420108405941546, 2e-11);
  EXPECT_NEAR(two.solution[1].tangential_mps2, -1272.04445183083547708, 1e-10);
}

TEST(SolveContact, CertifiesASignLostInTheNoiseOfDouble) {
  // mu = 4/3 rounded down and up at alpha = atan 2: A_hat = +8.9e-17, -1.8e-16.
  ContactProblem p{.alpha = SinCosOfRadians(0x1.1b6e192ebbe44p+0),
                   .mu = 0x1.5555555555555p+0,
                   .slip = Slip::kLeading,
                   .radius_m = 0.1,
                   .gravity_mps2 = 9.81};
  ContactResult r = SolveContact(p);
  EXPECT_EQ(r.regime, Regime::kSlide);
  EXPECT_EQ(r.tolerant_regime, Regime::kAZeroNone);
  EXPECT_TRUE(r.within_tolerance);
  EXPECT_NEAR(r.a_hat, 8.8817841970012579e-17, 1e-19);
  p.mu = 0x1.5555555555556p+0;
  EXPECT_EQ(SolveContact(p).regime, Regime::kInconsistent);
  // Sines and cosines that were rounded cannot certify anything.
  p.alpha.has_low = false;
  r = SolveContact(p);
  EXPECT_EQ(r.regime, Regime::kAZeroNone);
  EXPECT_EQ(r.n_solutions, 0);
}

TEST(SolveContact, RightAngleInDegreesIsExact) {
  // kappa = 1e16, where cos(fl(pi/2)) = 6e-17 would decide.
  ContactProblem p{.alpha = SinCosOfDegrees(90.0),
                   .mu = 2.0,
                   .slip = Slip::kLeading,
                   .radius_m = 1.0,
                   .gyration_radius_m = 1e-8};
  const ContactResult r = SolveContact(p);
  EXPECT_EQ(r.regime, Regime::kSlide);
  EXPECT_EQ(r.a_hat, 1.0);
}

TEST(SolveContact, RodAtRest) {
  // tan alpha = 2, kappa = 3: f_N = 17/20, f_T = -3/10, ratio 6/17.
  ContactProblem p{.alpha = SinCosOfRadians(std::atan(2.0)),
                   .mu = 2.0,
                   .slip = Slip::kNone,
                   .radius_m = 0.1,
                   .gravity_mps2 = 1.0};
  ContactResult r = SolveContact(p);
  EXPECT_EQ(r.regime, Regime::kStick);
  ASSERT_EQ(r.n_solutions, 1);
  EXPECT_NEAR(r.solution[0].normal_n, 17.0 / 20.0, 1e-15);
  EXPECT_NEAR(r.solution[0].tangential_n, -0.3, 1e-15);
  EXPECT_NEAR(r.margins.cone_mu, 2.0 - 6.0 / 17.0, 1e-15);
  p.mu = 0.25;
  r = SolveContact(p);
  EXPECT_EQ(r.regime, Regime::kSlipLeading);
  EXPECT_NEAR(r.solution[0].normal_n, 10.0 / 13.0, 1e-15);
}

TEST(SphereContact, CarriesItsWeightAndSlidesOrRolls) {
  for (const Slip slip : {Slip::kLeading, Slip::kTrailing}) {
    const ContactResult r =
        SolveContact(SphereContact(0.2, 0.02, 2.5, 0.4, slip, 10.0));
    EXPECT_EQ(r.regime, Regime::kSlide);
    ASSERT_EQ(r.n_solutions, 1);
    EXPECT_DOUBLE_EQ(r.solution[0].normal_n, 2.0);
    // The contact point is braked by (1 + kappa) mu g.
    EXPECT_DOUBLE_EQ(r.solution[0].tangential_mps2, -Sign(slip) * 14.0);
  }
  const ContactResult rest =
      SolveContact(SphereContact(0.2, 0.02, 2.5, 0.4, Slip::kNone, 10.0));
  EXPECT_EQ(rest.regime, Regime::kStick);
  EXPECT_EQ(rest.solution[0].tangential_n, 0.0);
}

TEST(SolveContact, NothingPushesWithoutGravityAndSpin) {
  const ContactProblem p{.alpha = SinCosOfDegrees(30.0),
                         .mu = 0.5,
                         .radius_m = 0.1,
                         .gravity_mps2 = 0.0};
  const ContactResult r = SolveContact(p);
  EXPECT_EQ(r.regime, Regime::kGraze);
  EXPECT_FALSE(r.within_tolerance);  // exactly zero, not a matter of rounding
}

TEST(SolveContact, RefusesWhatCannotBe) {
  ContactProblem p{.alpha = SinCosOfDegrees(30.0), .mu = 0.5, .radius_m = 0.1};
  p.mu = -0.1;
  EXPECT_THROW(SolveContact(p), std::invalid_argument);
  p.mu = 0.5;
  p.radius_m = 0.0;
  EXPECT_THROW(SolveContact(p), std::invalid_argument);
  p.radius_m = 0.1;
  p.mass_kg = std::numeric_limits<double>::infinity();
  EXPECT_THROW(SolveContact(p), std::invalid_argument);
}

TEST(SolveContact, MarginsReachTheSignChange) {
  const ContactProblem p{.alpha = SinCosOfDegrees(50.0),
                         .mu = 1.2,
                         .slip = Slip::kLeading,
                         .radius_m = 0.1,
                         .omega_rad_per_s = 8.0};
  const ContactMargins m = SolveContact(p).margins;
  ContactProblem q = p;
  q.mu += m.a_hat_mu;
  EXPECT_NEAR(SolveContact(q).a_hat, 0.0, 1e-14);
  q = p;
  q.kappa += m.a_hat_kappa;
  EXPECT_NEAR(SolveContact(q).a_hat, 0.0, 1e-13);
  q = p;
  q.radius_m += m.b_radius_m;
  EXPECT_NEAR(SolveContact(q).b_mps2, 0.0, 1e-13);
  q = p;
  q.gravity_mps2 += m.b_gravity_mps2;
  EXPECT_LE(q.gravity_mps2, p.gravity_mps2);
  EXPECT_NEAR(SolveContact(q).b_mps2, 0.0, 1e-13);
  // First order only: slopes against differences.
  constexpr double kStep = 1e-6;
  const ContactResult r = SolveContact(p);
  q = p;
  q.alpha = SinCosOfRadians(50.0 * core::kDegree + kStep);
  EXPECT_NEAR(-r.a_hat / m.a_hat_alpha_rad,
              (SolveContact(q).a_hat - r.a_hat) / kStep, 1e-4);
  EXPECT_NEAR(-r.b_mps2 / m.b_alpha_rad,
              (SolveContact(q).b_mps2 - r.b_mps2) / kStep, 1e-4);
  q = p;
  q.omega_rad_per_s += kStep;
  EXPECT_NEAR(-r.b_mps2 / m.b_omega_rad_per_s,
              (SolveContact(q).b_mps2 - r.b_mps2) / kStep, 1e-4);
}

TEST(PainleveWedge, TouchesAtTheCriticalFriction) {
  for (const auto& [kappa, critical] :
       {std::pair{3.0, 4.0 / 3.0}, std::pair{2.5, 1.49666295470957640},
        std::pair{1.0, 2.0 * std::sqrt(2.0)}}) {
    EXPECT_FALSE(PainleveWedge(kappa, critical - 1e-14).exists) << kappa;
    EXPECT_TRUE(PainleveWedge(kappa, critical + 1e-14).exists) << kappa;
  }
  const Wedge wedge = PainleveWedge(3.0, 1.5);
  ASSERT_TRUE(wedge.exists);
  for (const double edge : {wedge.low_rad, wedge.high_rad}) {
    EXPECT_NEAR(
        SlidingResponse(SinCosOfRadians(edge), 3.0, 1.5, Slip::kLeading), 0.0,
        1e-15);
  }
}

TEST(SinCosOfDegrees, IsExactWhereTheAngleIs) {
  for (const double turn : {-720.0, -360.0, 0.0, 360.0, 3600.0}) {
    EXPECT_EQ(SinCosOfDegrees(turn).sin, 0.0);
    EXPECT_EQ(SinCosOfDegrees(turn).cos, 1.0);
    EXPECT_EQ(SinCosOfDegrees(turn + 30.0).sin, 0.5);
    EXPECT_EQ(SinCosOfDegrees(turn + 60.0).cos, 0.5);
    EXPECT_EQ(SinCosOfDegrees(turn + 90.0).cos, 0.0);
    EXPECT_EQ(SinCosOfDegrees(turn + 90.0).sin, 1.0);
    EXPECT_EQ(SinCosOfDegrees(turn + 180.0).cos, -1.0);
    EXPECT_EQ(SinCosOfDegrees(turn + 270.0).sin, -1.0);
  }
  EXPECT_NEAR(SinCosOfDegrees(11.8).sin, std::sin(11.8 * core::kDegree), 1e-16);
  EXPECT_THROW(SinCosOfDegrees(std::numeric_limits<double>::infinity()),
               std::invalid_argument);
}

// --- properties over random problems -----------------------------------------

class RandomProblems {
 public:
  explicit RandomProblems(std::uint64_t seed) : engine_(seed) {}

  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double Log(double low, double high) {
    return std::exp(Between(std::log(low), std::log(high)));
  }
  // Bodies and speeds of the rig and far beyond.
  ContactProblem Next() {
    ContactProblem p;
    p.alpha = RoundedSinCosOfRadians(Between(-3.2, 3.2));
    p.mu = Between(0.0, 1.0) < 0.1 ? 0.0 : Log(1e-3, 1e2);
    p.slip = static_cast<Slip>(static_cast<int>(Between(-1.0, 2.0)));
    p.mass_kg = Log(1e-6, 1e6);
    p.radius_m = Log(1e-6, 1e6);
    p.kappa = Log(1e-3, 1e3);
    p.omega_rad_per_s = Between(-1.0, 1.0) * Log(1e-3, 1e4);
    p.gravity_mps2 = Log(1e-3, 1e3);
    return p;
  }

 private:
  std::mt19937_64 engine_;
};

bool IsFinite(const ContactSolution& s) {
  return std::isfinite(s.normal_n) && std::isfinite(s.tangential_n) &&
         std::isfinite(s.normal_mps2) && std::isfinite(s.tangential_mps2) &&
         std::isfinite(s.residual);
}

TEST(SolveContact, EverySolutionIsOne) {
  RandomProblems random(7);
  for (int i = 0; i < 400'000; ++i) {
    const ContactProblem p = random.Next();
    const ContactResult r = SolveContact(p);
    const double c = p.alpha.cos;
    const double s = p.alpha.sin;
    for (const ContactSolution& solution : r.Solutions()) {
      ASSERT_TRUE(IsFinite(solution)) << i;
      ASSERT_GE(solution.normal_n, 0.0) << i;
      ASSERT_GE(solution.normal_mps2, 0.0) << i;
      ASSERT_EQ(solution.normal_n * solution.normal_mps2, 0.0) << i;
      ASSERT_LE(solution.residual, 32 * kUlp) << i;
      // Coulomb's law, and the tangential equation of motion.
      const double fn = solution.normal_n / p.mass_kg;
      const double ft = solution.tangential_n / p.mass_kg;
      ASSERT_LE(std::abs(ft),
                p.mu * fn * (1 + 1e-12) + 1e-12 * std::abs(p.gravity_mps2))
          << i;
      const double centripetal =
          p.radius_m * p.omega_rad_per_s * p.omega_rad_per_s;
      const double size = std::abs(p.kappa * s * c * fn) +
                          (1 + p.kappa * s * s) * std::abs(ft) +
                          centripetal * std::abs(c) + p.gravity_mps2;
      const double gt =
          p.kappa * s * c * fn + (1 + p.kappa * s * s) * ft - centripetal * c;
      ASSERT_NEAR(gt, solution.tangential_mps2, 64 * kUlp * size) << i;
      if (solution.kind == SolutionKind::kSlipLeading) {
        ASSERT_GT(solution.tangential_mps2, 0.0) << i;
      }
      if (solution.kind == SolutionKind::kSlipTrailing) {
        ASSERT_LT(solution.tangential_mps2, 0.0) << i;
      }
    }
  }
}

// The problem seen in a mirror (x reversed) has the mirrored answer.
TEST(SolveContact, MirrorSymmetry) {
  RandomProblems random(11);
  for (int i = 0; i < 200'000; ++i) {
    const ContactProblem p = random.Next();
    ContactProblem mirrored = p;
    mirrored.alpha.cos = -p.alpha.cos;
    mirrored.slip = static_cast<Slip>(-Sign(p.slip));
    mirrored.omega_rad_per_s = -p.omega_rad_per_s;
    const ContactResult a = SolveContact(p);
    const ContactResult b = SolveContact(mirrored);
    ASSERT_EQ(a.n_solutions, b.n_solutions) << i;
    ASSERT_EQ(a.a_hat, b.a_hat) << i;
    for (const ContactSolution& s : a.Solutions()) {
      const auto twin =
          std::find_if(b.solution.begin(), b.solution.begin() + b.n_solutions,
                       [&](const ContactSolution& t) {
                         return t.normal_n == s.normal_n &&
                                t.tangential_n == -s.tangential_n &&
                                t.normal_mps2 == s.normal_mps2 &&
                                t.tangential_mps2 == -s.tangential_mps2;
                       });
      ASSERT_NE(twin, b.solution.begin() + b.n_solutions) << i;
    }
  }
}

// Powers of two as units leave every digit as it was.
TEST(SolveContact, InvariantUnderUnits) {
  RandomProblems random(13);
  for (int i = 0; i < 200'000; ++i) {
    const ContactProblem p = random.Next();
    const double metre = 0x1p20;
    const double second = 0x1p-9;
    const double kilogram = 0x1p33;
    ContactProblem q = p;
    q.radius_m *= metre;
    q.mass_kg *= kilogram;
    q.omega_rad_per_s /= second;
    q.gravity_mps2 *= metre / (second * second);
    const ContactResult a = SolveContact(p);
    const ContactResult b = SolveContact(q);
    ASSERT_EQ(a.regime, b.regime) << i;
    ASSERT_EQ(a.n_solutions, b.n_solutions) << i;
    for (int j = 0; j < a.n_solutions; ++j) {
      const auto& s = a.solution[static_cast<std::size_t>(j)];
      const auto& t = b.solution[static_cast<std::size_t>(j)];
      ASSERT_EQ(s.normal_n * kilogram * metre / (second * second), t.normal_n);
      ASSERT_EQ(s.tangential_mps2 * metre / (second * second),
                t.tangential_mps2);
    }
  }
}

// The quick answer is the full one.
TEST(SolveSlidingContact, AgreesWithTheFullResult) {
  RandomProblems random(17);
  for (int i = 0; i < 300'000; ++i) {
    ContactProblem p = random.Next();
    if (p.slip == Slip::kNone) p.slip = Slip::kLeading;
    const QuickContact quick = SolveSlidingContact(p);
    const ContactResult full = SolveContact(p);
    ASSERT_EQ(quick.regime, full.tolerant_regime) << i;
    double force = 0.0;
    for (const auto& s : full.Solutions()) {
      force = std::max(force, s.normal_n / p.mass_kg);
    }
    ASSERT_NEAR(
        quick.normal_per_mass_mps2, force,
        16 * kUlp * std::max(full.a_hat_condition, full.b_condition) * force)
        << i;
  }
}

// Anywhere in the range of double: no NaN, and nothing infinite unless the
// true value is.
TEST(SolveContact, ExtremesStayFinite) {
  RandomProblems random(19);
  for (int i = 0; i < 100'000; ++i) {
    ContactProblem p = random.Next();
    p.mass_kg = random.Log(1e-300, 1e300);
    p.radius_m = random.Log(1e-300, 1e300);
    p.omega_rad_per_s = random.Log(1e-300, 1e300);
    p.gravity_mps2 = random.Log(1e-300, 1e300);
    p.kappa = random.Log(1e-300, 1e300);
    p.mu = random.Log(1e-300, 1e300);
    const ContactResult r = SolveContact(p);
    const long double w = p.omega_rad_per_s;
    const long double b = static_cast<long double>(p.radius_m) * w * w *
                              static_cast<long double>(p.alpha.sin) -
                          static_cast<long double>(p.gravity_mps2);
    for (const ContactSolution& s : r.Solutions()) {
      ASSERT_FALSE(std::isnan(s.normal_n) || std::isnan(s.tangential_n) ||
                   std::isnan(s.normal_mps2) || std::isnan(s.tangential_mps2))
          << i;
      if (s.kind == SolutionKind::kDetach &&
          b < static_cast<long double>(std::numeric_limits<double>::max())) {
        ASSERT_TRUE(std::isfinite(s.normal_mps2)) << i;
      }
      if (s.kind != SolutionKind::kSlide) continue;
      const long double a =
          1 + static_cast<long double>(p.kappa) * p.alpha.cos *
                  (static_cast<long double>(p.alpha.cos) -
                   static_cast<long double>(Sign(p.slip)) * p.mu * p.alpha.sin);
      const long double force = -b / a * static_cast<long double>(p.mass_kg);
      ASSERT_EQ(
          std::isfinite(s.normal_n),
          force <= static_cast<long double>(std::numeric_limits<double>::max()))
          << i;
    }
  }
}

}  // namespace
}  // namespace touchdown::analysis
