#include "touchdown/analysis/theory/impact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/support/csv.h"
#include "tests/support/shared_data.h"

namespace touchdown::analysis {
namespace {

constexpr double kUlp = 0x1p-53;

std::string Text(const ImpactResult& result) {
  std::string out;
  for (const ImpactPhase& phase : result.Phases()) {
    if (!out.empty()) out += '>';
    switch (phase.slip) {
      case Slip::kLeading:
        out += "slip+1";
        break;
      case Slip::kTrailing:
        out += "slip-1";
        break;
      case Slip::kNone:
        out += "stick";
    }
  }
  return out;
}

// `scale`: the size of the terms whose difference the value is.
void ExpectClose(double value, long double reference, double scale,
                 const std::string& what) {
  EXPECT_NEAR(value, static_cast<double>(reference),
              64 * kUlp * (std::abs(static_cast<double>(reference)) + scale))
      << what;
}

ImpactProblem MakeProblem(const testing::Row& row) {
  ImpactProblem p;
  p.alpha = SinCosOfRadians(row.Number("alpha"));
  p.mu = row.Number("mu");
  p.kappa = row.Number("kappa");
  p.radius_m = row.Number("R");
  p.tangential_mps = row.Number("vT0");
  p.normal_mps = row.Number("vN0");
  p.alpha_rate_rad_per_s = row.Number("alphadot0");
  p.restitution = row.Number("e");
  return p;
}

void ExpectMatches(const testing::Row& row) {
  const std::string& id = row.Text("id");
  const ImpactResult r = Impact(MakeProblem(row));
  const double speed =
      std::abs(row.Number("vT0")) + std::abs(row.Number("vN0"));
  ExpectClose(r.compression_impulse_mps, row.Long("P_compress_per_m"), speed,
              id + " P_compress");
  ExpectClose(r.normal_impulse_mps, row.Long("P_total_per_m"), speed,
              id + " P_total");
  ExpectClose(r.tangential_impulse_mps, row.Long("T_total_per_m"), speed,
              id + " T_total");
  ExpectClose(r.normal_mps, row.Long("vN1"), speed, id + " vN1");
  ExpectClose(r.tangential_mps, row.Long("vT1"), speed, id + " vT1");
  ExpectClose(r.alpha_rate_rad_per_s, row.Long("alphadot1"),
              speed * row.Number("kappa") / row.Number("R"), id + " alphadot1");
  EXPECT_EQ(Text(r), row.Text("phases")) << id;
}

TEST(Impact, ReferenceCases) {
  const auto path = testing::Shared("reference/data/impact_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto rows = testing::ReadCsv(path);
  ASSERT_FALSE(rows.empty());
  for (const auto& row : rows) ExpectMatches(row);
}

// Computed with 90 digits: impact without collision with e = 1/2, and a plate
// that lands on its trailing corner at 11.8 deg.
TEST(Impact, HighPrecisionCases) {
  const auto rows = testing::ParseCsv(
      "id,alpha,mu,kappa,R,vT0,vN0,alphadot0,e,P_compress_per_m,P_total_per_m,"
      "T_total_per_m,vN1,vT1,alphadot1,phases\n"
      "I02,1.0471975511965979,1.5,3.0,0.1,1.0,0.0,0.0,0.5,"
      "0.3247595264191644523333,0.4871392896287466785,-0."
      "5024038461538460625806,"
      "0.1998520162579473381541,0.0,5.745745467415987554892,slip+1>stick>"
      "stick\n"
      "I05,0.2059488517353309,0.5,3.0,0.05,-5.0,-1.0,0.0,0.5,"
      "0.2395320959670809637837,0.3592981439506214456755,"
      "0.1796490719753107228377,0.5,-4.58204589450447273852,"
      "-23.30656571351144844987,slip-1>slip-1\n");
  ASSERT_EQ(rows.size(), 2u);
  for (const auto& row : rows) ExpectMatches(row);
}

// A sphere bounces with e times its normal speed whatever its spin, and a
// sticking one leaves with the spin of rolling: Garwin (1969), with his
// tangential restitution zero.
TEST(Impact, SolidSphereStopsItsSlip) {
  BodyImpact ball;
  ball.offset_y_m = -0.02;
  ball.gyration_radius_m = 0.02 * std::sqrt(0.4);
  ball.mu = 1.0;
  ball.restitution = 0.6;
  ball.velocity_x_mps = 2.0;
  ball.velocity_y_mps = -3.0;
  ball.omega_rad_per_s = 40.0;
  const BodyImpactResult after = ImpactOfBody(ball);
  EXPECT_NEAR(after.velocity_y_mps, 1.8, 1e-14);
  // Slip of P before: 2 + 0.02 * 40 = 2.8 m/s; 2/7 of it goes into the centre.
  EXPECT_NEAR(after.velocity_x_mps, 2.0 - 2.8 * 2.0 / 7.0, 1e-14);
  EXPECT_NEAR(after.omega_rad_per_s, -after.velocity_x_mps / 0.02, 1e-11);
  EXPECT_EQ(Text(after.impact), "slip+1>stick>stick");
}

TEST(Impact, FrictionlessSphereKeepsItsSpin) {
  BodyImpact ball{.offset_y_m = -0.05,
                  .gyration_radius_m = 0.03,
                  .restitution = 1.0,
                  .velocity_x_mps = 4.0,
                  .velocity_y_mps = -1.0,
                  .omega_rad_per_s = 7.0};
  const BodyImpactResult after = ImpactOfBody(ball);
  EXPECT_EQ(after.velocity_x_mps, 4.0);
  EXPECT_EQ(after.velocity_y_mps, 1.0);
  EXPECT_EQ(after.omega_rad_per_s, 7.0);
}

// Slip reverses when friction is too weak to hold: v_T of P ends with the sign
// of G_NT.
TEST(Impact, SlipReversesUnderWeakFriction) {
  ImpactProblem p{.alpha = SinCosOfDegrees(150.0),  // P behind C, slides to +x
                  .radius_m = 0.1,
                  .kappa = 3.0,
                  .mu = 0.2,
                  .restitution = 0.5,
                  .tangential_mps = 0.1,
                  .normal_mps = -2.0};
  const ImpactResult r = Impact(p);
  EXPECT_EQ(Text(r), "slip+1>slip-1>slip-1");
  EXPECT_LT(r.tangential_mps, 0.0);
}

TEST(Impact, NothingHappensWithoutApproach) {
  ImpactProblem p{.alpha = SinCosOfDegrees(30.0),
                  .radius_m = 0.1,
                  .tangential_mps = 1.0,
                  .normal_mps = 0.25};
  EXPECT_EQ(Impact(p).status, ImpactStatus::kNone);
  EXPECT_EQ(Impact(p).normal_mps, 0.25);
  p.normal_mps = 0.0;  // A_hat > 0: the contact can be sustained
  EXPECT_EQ(Impact(p).status, ImpactStatus::kNone);
}

TEST(Impact, RefusesWhatCannotBe) {
  ImpactProblem p{
      .alpha = SinCosOfDegrees(30.0), .radius_m = 0.1, .normal_mps = -1.0};
  p.restitution = 1.5;
  EXPECT_THROW(Impact(p), std::invalid_argument);
  p.restitution = 0.5;
  p.radius_m = 0.0;
  EXPECT_THROW(Impact(p), std::invalid_argument);
  p.radius_m = 0.1;
  p.mu = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Impact(p), std::invalid_argument);
}

double Energy(const BodyImpact& b, double vx, double vy, double omega) {
  const double k = b.gyration_radius_m;
  return 0.5 * (vx * vx + vy * vy + k * k * omega * omega);
}

// Over random bodies: no energy is made, friction stays in its cone, P leaves
// the ground, the velocities agree with the impulses, and the mirrored problem
// has the mirrored answer.
TEST(Impact, PropertiesOverRandomBodies) {
  std::mt19937_64 engine(20240611);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  constexpr int kCases = 200'000;
  for (int i = 0; i < kCases; ++i) {
    BodyImpact b;
    b.offset_x_m = 0.2 * (unit(engine) - 0.5);
    b.offset_y_m = -0.1 * unit(engine) - 1e-4;
    b.gyration_radius_m = 0.01 + 0.1 * unit(engine);
    b.mu = 3.0 * unit(engine);
    b.restitution = unit(engine);
    b.velocity_x_mps = 10.0 * (unit(engine) - 0.5);
    b.velocity_y_mps = -5.0 * unit(engine);
    b.omega_rad_per_s = 100.0 * (unit(engine) - 0.5);
    const BodyImpactResult a = ImpactOfBody(b);
    const double before =
        Energy(b, b.velocity_x_mps, b.velocity_y_mps, b.omega_rad_per_s);
    const double after =
        Energy(b, a.velocity_x_mps, a.velocity_y_mps, a.omega_rad_per_s);
    ASSERT_LE(after, before * (1 + 1e-12)) << i;
    ASSERT_GE(a.impact.normal_impulse_mps, 0.0) << i;
    ASSERT_LE(std::abs(a.impact.tangential_impulse_mps),
              b.mu * a.impact.normal_impulse_mps * (1 + 1e-12))
        << i;
    ASSERT_GE(a.impact.normal_mps, 0.0) << i;
    const double scale = 10.0 + std::abs(a.omega_rad_per_s) * 0.15;
    ASSERT_NEAR(a.velocity_y_mps + a.omega_rad_per_s * b.offset_x_m,
                a.impact.normal_mps, 1e-12 * scale)
        << i;
    ASSERT_NEAR(a.velocity_x_mps - a.omega_rad_per_s * b.offset_y_m,
                a.impact.tangential_mps, 1e-12 * scale)
        << i;
    BodyImpact mirrored = b;
    mirrored.offset_x_m = -b.offset_x_m;
    mirrored.velocity_x_mps = -b.velocity_x_mps;
    mirrored.omega_rad_per_s = -b.omega_rad_per_s;
    const BodyImpactResult m = ImpactOfBody(mirrored);
    ASSERT_EQ(m.velocity_x_mps, -a.velocity_x_mps) << i;
    ASSERT_EQ(m.velocity_y_mps, a.velocity_y_mps) << i;
    ASSERT_EQ(m.omega_rad_per_s, -a.omega_rad_per_s) << i;
  }
}

}  // namespace
}  // namespace touchdown::analysis
