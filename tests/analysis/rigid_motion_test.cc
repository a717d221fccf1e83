#include "touchdown/analysis/theory/rigid_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using namespace core::literals;  // NOLINT
constexpr double kG = core::kStandardGravity_mps2;
constexpr double kPi = std::numbers::pi;

RigidMotionProblem SphereProblem() {
  RigidMotionProblem p;
  p.body = core::Sphere({40.0_mm, 0.0});
  p.mu = 0.3;
  p.restitution = 0.5;
  p.start.centre = {0.0, 0.1};
  p.start.vx_mps = 1.5;
  return p;
}

RigidMotionProblem BlockProblem() {
  RigidMotionProblem p = SphereProblem();
  p.body = core::Rectangle({40.0_mm, 0.0}, {16.0_mm, 0.0});
  return p;
}

// Energy per unit mass, (v^2 + k^2 w^2)/2 + g y.
double EnergyPerMass(const RigidMotion& motion, const BodyState& state) {
  const double k = motion.gyration_radius_m;
  const double spin = k * state.omega_rad_per_s;
  return 0.5 * (state.vx_mps * state.vx_mps + state.vy_mps * state.vy_mps +
                spin * spin) +
         kG * state.centre.y_m;
}

TEST(RigidMotion, FreeFlightIsTheParabola) {
  RigidMotionProblem p = BlockProblem();
  p.start = {0.25, {1.0, 2.0}, 0.3, 1.5, 2.5, 7.0};
  p.end_s = 0.75;
  const RigidMotion motion = SimulateRigidMotion(p);
  ASSERT_EQ(motion.stretches.size(), 1u);
  EXPECT_TRUE(motion.events.empty());
  EXPECT_FALSE(FirstTouchdown(motion).has_value());
  for (const double t : {0.2, 0.25, 0.4, 0.75, 0.76}) {
    const double s = t - 0.25;
    const BodyState state = ComputeState(motion, t);
    EXPECT_NEAR(state.centre.x_m, 1.0 + 1.5 * s, 1e-15);
    EXPECT_NEAR(state.centre.y_m, 2.0 + 2.5 * s - 0.5 * kG * s * s, 1e-15);
    EXPECT_NEAR(state.angle_rad, 0.3 + 7.0 * s, 1e-15);
    EXPECT_NEAR(state.vy_mps, 2.5 - kG * s, 1e-15);
  }
}

TEST(RigidMotion, SphereFallsAndReboundsAsTheTextbookSays) {
  RigidMotionProblem p = SphereProblem();
  p.start.vx_mps = 0.0;
  const RigidMotion motion = SimulateRigidMotion(p);
  const auto touchdown = FirstTouchdown(motion);
  ASSERT_TRUE(touchdown.has_value());
  const double h = 0.1 - 0.02;
  const double fall = std::sqrt(2.0 * h / kG);
  EXPECT_NEAR(touchdown->time_s, fall, 1e-15);
  EXPECT_NEAR(touchdown->approach_angle_rad, 0.5 * kPi, 1e-15);
  EXPECT_FALSE(touchdown->radius_angle_rad.has_value());
  const GreatestGap gap = ComputeGreatestGap(motion, touchdown->time_s, 1.0);
  EXPECT_NEAR(gap.gap_m, 0.25 * h, 1e-12);
  // At rest after the geometric series, sqrt(2h/g) (1 + e) / (1 - e), but for
  // the rebounds below the rest speed, 2 v / g / (1 - e) of time.
  ASSERT_EQ(motion.stretches.back().kind, StretchKind::kRest);
  EXPECT_NEAR(motion.stretches.back().start.time_s, 3.0 * fall,
              2.0 * p.rest_speed_mps / kG / 0.5);
}

TEST(RigidMotion, ElasticFrictionlessSphereNeverTires) {
  RigidMotionProblem p = SphereProblem();
  p.mu = 0.0;
  p.restitution = 1.0;
  p.start.omega_rad_per_s = 12.0;
  p.end_s = 100.0;
  const RigidMotion motion = SimulateRigidMotion(p);
  EXPECT_GT(motion.events.size(), 350u);
  const double energy = EnergyPerMass(motion, p.start);
  for (const double t : {0.1, 1.0, 10.0, 99.9}) {
    EXPECT_NEAR(EnergyPerMass(motion, ComputeState(motion, t)) / energy, 1.0,
                1e-12);
  }
  EXPECT_NEAR(ComputeGreatestGap(motion, 99.0, 100.0).gap_m, 0.08, 1e-11);
}

TEST(RigidMotion, SlidingSphereRollsAtFiveSevenths) {
  RigidMotionProblem p = SphereProblem();
  p.start.centre.y_m = 0.02;
  const RigidMotion motion = SimulateRigidMotion(p);
  const auto touchdown = FirstTouchdown(motion);
  ASSERT_TRUE(touchdown.has_value());
  EXPECT_TRUE(touchdown->from_start);
  EXPECT_EQ(touchdown->approach_angle_rad, 0.0);
  ASSERT_EQ(motion.stretches.size(), 2u);
  EXPECT_EQ(motion.stretches[0].kind, StretchKind::kSlide);
  EXPECT_EQ(motion.stretches[1].kind, StretchKind::kRoll);
  const BodyState rolls = motion.stretches[1].start;
  EXPECT_NEAR(rolls.vx_mps, 1.5 * 5.0 / 7.0, 1e-14);
  EXPECT_NEAR(rolls.omega_rad_per_s, -rolls.vx_mps / 0.02, 1e-12);
  EXPECT_NEAR(rolls.time_s, 2.0 * 1.5 / (7.0 * 0.3 * kG), 1e-14);
  EXPECT_EQ(ComputeGap(motion, 0.7), 0.0);
}

TEST(RigidMotion, FlushBlockLandsBouncesSlidesAndRests) {
  RigidMotionProblem p = BlockProblem();
  p.start.centre.y_m = 0.008 + 0.002;
  p.start.vx_mps = 1.0;
  const RigidMotion motion = SimulateRigidMotion(p);
  const auto touchdown = FirstTouchdown(motion);
  ASSERT_TRUE(touchdown.has_value());
  EXPECT_EQ(touchdown->corner, core::Corner::kFlush);
  EXPECT_NEAR(*touchdown->face_angle_rad, 0.0, 1e-15);
  EXPECT_NEAR(*touchdown->radius_angle_rad, std::atan(16.0 / 40.0), 1e-12);
  const double fall = std::sqrt(2.0 * 0.002 / kG);
  EXPECT_NEAR(touchdown->time_s, fall, 1e-15);
  EXPECT_NEAR(touchdown->approach_angle_rad, std::atan2(kG * fall, 1.0), 1e-14);
  // v_y' = -e v_y, friction mu (1 + e) |v_y|, no spin.
  EXPECT_NEAR(touchdown->after.vy_mps, 0.5 * kG * fall, 1e-14);
  EXPECT_NEAR(touchdown->after.vx_mps, 1.0 - 0.3 * 1.5 * kG * fall, 1e-14);
  EXPECT_EQ(touchdown->after.omega_rad_per_s, 0.0);
  EXPECT_NEAR(ComputeGreatestGap(motion, fall, 1.0).gap_m, 0.25 * 0.002, 1e-12);
  EXPECT_EQ(motion.stretches.back().kind, StretchKind::kRest);
  // All the tangential momentum is lost to mu times the normal impulse,
  // gravity's and the fall's together: x' = 1 - mu g t.
  EXPECT_NEAR(motion.stretches.back().start.time_s, 1.0 / (0.3 * kG), 1e-4);
}

TEST(RigidMotion, BlockFallingOnItsShortSideIsFlush) {
  RigidMotionProblem p = BlockProblem();
  p.start.angle_rad = 0.5 * kPi;
  p.start.vx_mps = 0.0;
  const RigidMotion motion = SimulateRigidMotion(p);
  const auto touchdown = FirstTouchdown(motion);
  ASSERT_TRUE(touchdown.has_value());
  EXPECT_EQ(touchdown->corner, core::Corner::kFlush);
  EXPECT_NEAR(*touchdown->face_angle_rad, 0.5 * kPi, 1e-15);
  EXPECT_NEAR(ComputeGreatestGap(motion, touchdown->time_s, 1.0).gap_m,
              0.25 * 0.08, 1e-12);
}

TEST(RigidMotion, CornerAndAnglesOfATiltedBlock) {
  for (const double tilt : {-20.0_deg, 5.0_deg, 60.0_deg}) {
    RigidMotionProblem p = BlockProblem();
    p.start.angle_rad = tilt;
    const RigidMotion motion = SimulateRigidMotion(p);
    const auto touchdown = FirstTouchdown(motion);
    ASSERT_TRUE(touchdown.has_value());
    EXPECT_NEAR(*touchdown->face_angle_rad, tilt, 1e-15);
    // The nose is up: the trailing corner strikes, but for a steep block, whose
    // short side comes first: then the one ahead.
    const double diagonal = std::atan(16.0 / 40.0);
    double alpha = std::abs(tilt) + diagonal;
    bool leading = tilt < 0.0;
    if (alpha > 0.5 * kPi) {
      alpha = kPi - alpha;
      leading = !leading;
    }
    EXPECT_NEAR(*touchdown->radius_angle_rad, alpha, 1e-12);
    EXPECT_EQ(touchdown->corner,
              leading ? core::Corner::kLeading : core::Corner::kTrailing);
    EXPECT_NEAR(ComputeGap(motion, touchdown->time_s), 0.0, 1e-15);
  }
}

TEST(RigidMotion, MirroredBlocksMoveMirrored) {
  RigidMotionProblem p = BlockProblem();
  p.start.angle_rad = 13.0_deg;
  p.start.vx_mps = 1.0;
  p.start.omega_rad_per_s = 2.0;
  RigidMotionProblem q = p;
  q.start.angle_rad = -p.start.angle_rad;
  q.start.vx_mps = -p.start.vx_mps;
  q.start.omega_rad_per_s = -p.start.omega_rad_per_s;
  const RigidMotion a = SimulateRigidMotion(p);
  const RigidMotion b = SimulateRigidMotion(q);
  for (double t = 0.0; t < 0.3; t += 0.01) {
    EXPECT_NEAR(ComputeState(a, t).centre.x_m, -ComputeState(b, t).centre.x_m,
                1e-12);
    EXPECT_NEAR(ComputeState(a, t).centre.y_m, ComputeState(b, t).centre.y_m,
                1e-12);
    EXPECT_NEAR(ComputeState(a, t).angle_rad, -ComputeState(b, t).angle_rad,
                1e-10);
  }
}

// Grid of bodies, throws, friction and restitution: whatever happens, energy
// never grows, the ground is never entered, positions are continuous, and the
// impulse lies in the friction cone.
TEST(RigidMotion, LawsHoldOverAGridOfThrows) {
  std::mt19937_64 engine(20260101);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int settled = 0;
  constexpr int kThrows = 300;
  for (int n = 0; n < kThrows; ++n) {
    RigidMotionProblem p;
    const double a = 0.01 + 0.05 * unit(engine);
    p.body = n % 3 == 0 ? core::Sphere({a, 0.0})
                        : core::Rectangle({a, 0.0}, {a * unit(engine), 0.0});
    p.mu = n % 5 == 0 ? 0.0 : 1.2 * unit(engine);
    p.restitution = n % 7 == 0 ? 0.0 : 0.9 * unit(engine);
    p.start.centre = {0.0, a + 0.05 * unit(engine)};
    p.start.angle_rad = kPi * (2.0 * unit(engine) - 1.0);
    p.start.vx_mps = 4.0 * unit(engine) - 2.0;
    p.start.vy_mps = 2.0 * unit(engine) - 1.5;
    p.start.omega_rad_per_s = n % 2 == 0 ? 0.0 : 60.0 * (unit(engine) - 0.5);
    p.end_s = 1.5;
    const RigidMotion motion = SimulateRigidMotion(p);
    ASSERT_TRUE(motion.complete) << "throw " << n;
    // Hops may need rest_speed^2 / 2; together they gain nothing to speak of.
    const double hop = 0.5 * p.rest_speed_mps * p.rest_speed_mps;
    double energy = EnergyPerMass(motion, p.start);
    double gained = 0.0;
    for (std::size_t i = 0; i < motion.stretches.size(); ++i) {
      const Stretch& s = motion.stretches[i];
      const double now = EnergyPerMass(motion, s.start);
      ASSERT_LE(now, energy * (1.0 + 1e-12) + hop) << "throw " << n;
      gained += std::max(0.0, now - energy);
      energy = now;
      ASSERT_GT(ComputeGap(motion, s.start.time_s), -1e-12) << "throw " << n;
      if (i == 0) continue;
      Stretch before = motion.stretches[i - 1];
      const double dt = s.start.time_s - before.start.time_s;
      ASSERT_GE(dt, 0.0);
      const double y = before.start.centre.y_m +
                       dt * (before.start.vy_mps + 0.5 * dt * before.ay_mps2);
      ASSERT_NEAR(s.start.centre.y_m, y, 1e-6) << "throw " << n << " at " << i;
    }
    EXPECT_LT(gained, 1e-4 * EnergyPerMass(motion, p.start)) << "throw " << n;
    for (const MotionEvent& e : motion.events) {
      ASSERT_LE(EnergyPerMass(motion, e.after),
                EnergyPerMass(motion, e.before) * (1.0 + 1e-12))
          << "throw " << n;
      const double dx = e.after.vx_mps - e.before.vx_mps;
      const double dy = e.after.vy_mps - e.before.vy_mps;
      ASSERT_GE(dy, -1e-12) << "throw " << n;
      ASSERT_LE(std::abs(dx), p.mu * dy + 1e-9) << "throw " << n;
      if (e.kind != EventKind::kImpact) continue;
      // The impulse acts at the contact point: k^2 dw = x dy - y dx.
      const double k = motion.gyration_radius_m;
      const double turn =
          k * k * (e.after.omega_rad_per_s - e.before.omega_rad_per_s);
      ASSERT_NEAR(turn, e.offset_x_m * dy - e.offset_y_m * dx, 1e-12)
          << "throw " << n;
    }
    // Between any two instants too: nowhere below the ground.
    for (double t = 0.0; t <= p.end_s; t += 1e-3) {
      ASSERT_GT(ComputeGap(motion, t), -1e-8) << "throw " << n << " at " << t;
    }
    settled += motion.stretches.back().kind != StretchKind::kFlight;
  }
  EXPECT_GT(settled, kThrows * 9 / 10);
}

TEST(RigidMotion, TheRestSpeedDoesNotMatter) {
  // A block that falls on a corner, tilts down and slides to rest.
  RigidMotionProblem p = BlockProblem();
  p.restitution = 0.2;
  p.start.angle_rad = 9.0_deg;
  p.start.centre.y_m = 0.03;
  p.start.vx_mps = 0.8;
  RigidMotionProblem fine = p;
  fine.rest_speed_mps = p.rest_speed_mps / 8.0;
  const RigidMotion a = SimulateRigidMotion(p);
  const RigidMotion b = SimulateRigidMotion(fine);
  EXPECT_NEAR(ComputeState(a, 0.9).centre.x_m, ComputeState(b, 0.9).centre.x_m,
              2e-5);
  EXPECT_NEAR(ComputeGreatestGap(a, FirstTouchdown(a)->time_s, 0.9).gap_m,
              ComputeGreatestGap(b, FirstTouchdown(b)->time_s, 0.9).gap_m,
              1e-8);
}

// A frictionless rod (thin block) released on its corner: it tilts down as the
// rigid body pivots, energy conserved until the other corner slaps. Closed form
// for mu = 0: the centre falls straight, y = (L sin(phi) + H cos(phi)), and
// (y'^2 + k^2 w^2)/2 + g y is constant: spin when flat known exactly.
TEST(RigidMotion, SustainedCornerContactKeepsTheEnergy) {
  RigidMotionProblem p;
  p.body = core::Rectangle({100.0_mm, 0.0}, {2.0_mm, 0.0});
  p.mu = 0.0;
  p.restitution = 0.0;
  p.start.angle_rad = 30.0_deg;
  const double y0 = 0.05 * std::sin(30.0_deg) + 0.001 * std::cos(30.0_deg);
  p.start.centre = {0.0, y0};
  p.end_s = 0.5;
  const RigidMotion motion = SimulateRigidMotion(p);
  // The slap is the first listed event after the start.
  const MotionEvent* slap = nullptr;
  for (const MotionEvent& e : motion.events) {
    if (e.before.time_s > 0.01 && e.offset_x_m > 0.0) {
      slap = &e;
      break;
    }
  }
  ASSERT_NE(slap, nullptr);
  EXPECT_NEAR(slap->before.angle_rad, 0.0, 1e-6);
  // At phi = 0: y' = L w, so w^2 (L^2 + k^2) = 2 g (y0 - H).
  const double k = motion.gyration_radius_m;
  const double spin =
      -std::sqrt(2.0 * kG * (y0 - 0.001) / (0.05 * 0.05 + k * k));
  EXPECT_NEAR(slap->before.omega_rad_per_s, spin, 1e-3 * std::abs(spin));
  EXPECT_NEAR(slap->before.vx_mps, 0.0, 1e-12);
}

TEST(RigidMotion, ImpossibleProblemsAreRefusedByName) {
  const auto complaint = [](auto&& spoil) -> std::string {
    RigidMotionProblem p = SphereProblem();
    spoil(p);
    try {
      (void)SimulateRigidMotion(p);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  using testing::HasSubstr;
  EXPECT_EQ(complaint([](RigidMotionProblem&) {}), "accepted");
  EXPECT_THAT(complaint([](auto& p) { p.mu = -0.1; }), HasSubstr("mu is -0.1"));
  EXPECT_THAT(complaint([](auto& p) { p.restitution = 1.1; }),
              HasSubstr("restitution is 1.1"));
  EXPECT_THAT(complaint([](auto& p) { p.gravity_mps2 = 0.0; }),
              HasSubstr("gravity"));
  EXPECT_THAT(complaint([](auto& p) { p.start.centre.y_m = 0.01; }),
              HasSubstr("start gap"));
  EXPECT_THAT(complaint([](auto& p) { p.end_s = 0.0; }), HasSubstr("end time"));
  EXPECT_THAT(complaint([](auto& p) { p.body = core::Body{}; }),
              HasSubstr("diameter is absent"));
  EXPECT_THAT(complaint([](auto& p) { p.start.vx_mps = std::nan(""); }),
              HasSubstr("start velocity x"));
}

TEST(RigidMotion, AMotionThatIsCutShortSaysSo) {
  RigidMotionProblem p = SphereProblem();
  p.restitution = 1.0;
  p.end_s = 1e4;
  p.max_stretches = 20;
  EXPECT_FALSE(SimulateRigidMotion(p).complete);
}

}  // namespace
}  // namespace touchdown::analysis
