#include "touchdown/analysis/theory/boundary_models.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/support/csv.h"
#include "tests/support/shared_data.h"
#include "touchdown/analysis/theory/rigid_motion.h"
#include "touchdown/analysis/theory/spin_boundary.h"

namespace touchdown::analysis {
namespace {

using core::BodyKind;
using core::kDegree;
using ::testing::HasSubstr;

BoundaryInputs Sphere() {
  BoundaryInputs in;
  in.body = BodyKind::kSphere;
  in.kappa = {2.5, 0.0};
  return in;
}

TEST(BoundaryAngle, Published) {
  EXPECT_DOUBLE_EQ(*BoundaryAngle(BoundaryModel::kPublished, Sphere()),
                   11.8 * kDegree);
  EXPECT_DOUBLE_EQ(*BoundaryAngle(BoundaryModel::kPublished, {}),
                   7.8 * kDegree);
}

TEST(BoundaryAngle, PrintedEquationsSlideEverywhereWithoutSpin) {
  const auto none = BoundaryAngle(BoundaryModel::kPrintedEquations, {});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().reason, HasSubstr("slide at every angle"));
  BoundaryInputs in;
  in.radius_m = {0.1, 0.0};
  in.gravity_mps2 = {9.81, 0.0};
  in.omega_rad_per_s = {9.9, 0.0};
  EXPECT_FALSE(BoundaryAngle(BoundaryModel::kPrintedEquations, in));
  in.omega_rad_per_s = {20.0, 0.0};
  EXPECT_NEAR(*BoundaryAngle(BoundaryModel::kPrintedEquations, in),
              0.2477775596789878, 1e-15);
}

TEST(BoundaryAngle, PaperReplicationGivesBothDigits) {
  EXPECT_NEAR(
      *BoundaryAngle(BoundaryModel::kPaperReplication, Sphere()) / kDegree,
      11.778, 5e-4);
  EXPECT_NEAR(*BoundaryAngle(BoundaryModel::kPaperReplication, {}) / kDegree,
              7.784, 5e-4);
  std::mt19937_64 engine(1);
  const auto answer =
      EvaluateBoundary(BoundaryModel::kPaperReplication, {}, engine);
  ASSERT_EQ(answer.ranges.size(), 3u);
  EXPECT_NEAR(answer.ranges[1].to_rad / kDegree, 88.04, 5e-3);
}

TEST(BoundaryAngle, CorrectedLcpKnowsTheCorner) {
  BoundaryInputs in;
  in.mu = {1.5, 0.0};
  EXPECT_FALSE(BoundaryAngle(BoundaryModel::kCorrectedLcp, in));  // trailing
  in.slip = Slip::kLeading;
  const auto wedge = BoundaryAngle(BoundaryModel::kCorrectedLcp, in);
  ASSERT_TRUE(wedge);
  EXPECT_NEAR(*wedge, 0.8838626263729983, 1e-14);
  in.mu = {1.3, 0.0};  // below 4/3
  EXPECT_FALSE(BoundaryAngle(BoundaryModel::kCorrectedLcp, in));
}

TEST(BoundaryAngle, SpinningSphereIsAnswered) {
  BoundaryInputs in = Sphere();
  in.omega_rad_per_s = {200.0, 0.0};
  const auto never = BoundaryAngle(BoundaryModel::kCorrectedLcp, in);
  ASSERT_FALSE(never);
  EXPECT_THAT(never.error().reason, HasSubstr("below its centre"));
  std::mt19937_64 engine(1);
  const auto printed =
      EvaluateBoundary(BoundaryModel::kPrintedEquations, in, engine);
  EXPECT_TRUE(printed.boundary_rad);
  ASSERT_EQ(printed.notes.size(), 1u);
  EXPECT_THAT(printed.notes[0], HasSubstr("E16"));
}

// Of the thin plate and the sphere with mu = 0: Y = e^2 V^2/(2 g h_c) = 23.9128
// and X = (1+e)^2 V^2/(g R) = 394.298 give 11.8 and 7.8 deg; with mu = 0.6 on
// the trailing corner X = 379.26, on the leading one 412.40.
BoundaryInputs OfGroups(double y, double x, double mu, Slip slip) {
  BoundaryInputs in;
  in.slip = slip;
  in.mu = {mu, 0.0};
  in.gravity_mps2 = {10.0, 0.0};
  in.restitution = {0.5, 0.0};
  in.speed_mps = {6.0, 0.0};
  in.bounce_height_m = {0.25 * 36.0 / (20.0 * y), 0.0};
  in.radius_m = {2.25 * 36.0 / (10.0 * x), 0.0};
  return in;
}

TEST(BoundaryAngle, DetectableBounceOfTheTwoGroups) {
  for (const auto& in : {OfGroups(23.9128, 394.298, 0.0, Slip::kTrailing),
                         OfGroups(23.9128, 379.26, 0.6, Slip::kTrailing),
                         OfGroups(23.9128, 412.40, 0.6, Slip::kLeading)}) {
    EXPECT_NEAR(*BoundaryAngle(BoundaryModel::kDetectableBounce, in) / kDegree,
                7.8, 1e-3);
    BoundaryInputs sphere = in;
    sphere.body = BodyKind::kSphere;
    EXPECT_NEAR(
        *BoundaryAngle(BoundaryModel::kDetectableBounce, sphere) / kDegree,
        11.8, 1e-3);
  }
}

// All 18 entries of the paper's Table 1.
TEST(BounceRatio, ReproducesTableOne) {
  BoundaryInputs plate = OfGroups(23.9128, 394.298, 0.0, Slip::kTrailing);
  BoundaryInputs sphere = plate;
  sphere.body = BodyKind::kSphere;
  // At the boundary itself the table says slide; the groups have six digits.
  constexpr double kEdge = 1.0 + 1e-4;
  for (const double deg : {0.0, 3.9, 7.8, 11.8, 27.4, 43.0, 58.7, 74.4, 90.0}) {
    EXPECT_EQ(BounceRatio(sphere, deg * kDegree) > kEdge, deg > 11.8) << deg;
    EXPECT_EQ(BounceRatio(plate, deg * kDegree) > kEdge, deg > 7.8) << deg;
  }
}

// Without friction the corner rises with e V sin(approach), whatever its slip:
// held attitude, closed form.
TEST(BoundaryAngle, HeldAttitudeGivesTheApproach) {
  BoundaryInputs in;
  in.mu = {0.0, 0.0};
  in.kappa = {2.4, 0.0};
  in.restitution = {0.4, 0.0};
  in.speed_mps = {3.0, 0.0};
  in.bounce_height_m = {2e-3, 0.0};
  in.held_kind = core::AngleKind::kRadius;
  in.held_angle_rad = {40.0 * kDegree, 0.0};
  // v_N+ = e v; P = (1 + e) v / G_NN, G_NN = 1 + kappa cos^2; the spin is
  // kappa cos P / R and its lift R w^2 sin.
  const double c = std::cos(40.0 * kDegree);
  const double s = std::sin(40.0 * kDegree);
  const double w_per_v = 2.4 * c * 1.4 / (1.0 + 2.4 * c * c) / 0.05;
  const double g = in.gravity_mps2.value;
  const double v = std::sqrt(
      2.0 * g * 2e-3 / (0.16 + 2.0 * 2e-3 * 0.05 * w_per_v * w_per_v * s));
  const auto a = BoundaryAngle(BoundaryModel::kDetectableBounce, in);
  ASSERT_TRUE(a);
  EXPECT_NEAR(std::sin(*a), v / 3.0, 1e-9);
  std::mt19937_64 engine(5);
  const auto all =
      EvaluateBoundary(BoundaryModel::kDetectableBounce, in, engine);
  EXPECT_EQ(all.angle_kind, core::AngleKind::kApproach);
  EXPECT_TRUE(all.notes.empty());
  // The uncertainty of the held angle counts.
  in.held_angle_rad.u = 1.0 * kDegree;
  const auto wide =
      EvaluateBoundary(BoundaryModel::kDetectableBounce, in, engine);
  EXPECT_GT(wide.uncertainty.first_order_u_rad, 0.0);
}

TEST(BoundaryAngle, HeldApproachGivesTheRadiusAngleOrSaysThatThereIsNone) {
  BoundaryInputs in;
  in.mu = {0.0, 0.0};
  in.restitution = {0.4, 0.0};
  in.speed_mps = {3.0, 0.0};
  in.bounce_height_m = {2e-3, 0.0};
  in.held_kind = core::AngleKind::kApproach;
  in.held_angle_rad = {60.0 * kDegree, 0.0};
  const auto fast = BoundaryAngle(BoundaryModel::kDetectableBounce, in);
  ASSERT_FALSE(fast);
  EXPECT_NE(fast.error().reason.find("from the flattest radius angle"),
            std::string::npos);
  in.held_kind = core::AngleKind::kFace;
  EXPECT_THROW((void)BoundaryAngle(BoundaryModel::kDetectableBounce, in),
               std::invalid_argument);
}

// Blocks thrown at random, judged by the exact motion until the second contact:
// approach and radius angle as they are tell what bounces; forced to be equal
// they do not.
TEST(BounceRatio, TellsWhatBouncesWhereBothAnglesAreKept) {
  std::mt19937_64 engine(160);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  int wrong = 0;
  int wrong_equal = 0;
  int judged = 0;
  for (int i = 0; i < 160; ++i) {
    const double a = between(0.03, 0.12);
    const double b = a * between(0.2, 1.0);
    const double face = between(2.0, 60.0) * kDegree;
    RigidMotionProblem p;
    p.body = core::Rectangle({a, 0.0, {}}, {b, 0.0, {}});
    p.mu = between(0.0, 0.8);
    p.restitution = between(0.1, 0.8);
    const double speed = between(1.0, 6.0);
    const double down = between(2.0, 80.0) * kDegree;
    p.start = {0.0,
               {0.0, 0.5 * (a * std::sin(face) + b * std::cos(face)) + 1e-6},
               face,
               speed * std::cos(down),
               -speed * std::sin(down),
               0.0};
    p.end_s = 0.5;
    const RigidMotion motion = SimulateRigidMotion(p);
    const auto truth = FirstTouchdown(motion);
    ASSERT_TRUE(truth && truth->radius_angle_rad) << i;
    if (motion.events.empty() || !truth->corner) {
      continue;
    }
    const double next =
        motion.events.size() > 1 ? motion.events[1].before.time_s : p.end_s;
    const double gap = ComputeGreatestGap(motion, truth->time_s, next).gap_m;
    BoundaryInputs in;
    in.slip = truth->corner == core::Corner::kLeading ? Slip::kLeading
                                                      : Slip::kTrailing;
    in.radius_m = {0.5 * std::hypot(a, b), 0.0};
    in.kappa = {3.0, 0.0};
    in.mu = {p.mu, 0.0};
    in.restitution = {p.restitution, 0.0};
    in.speed_mps = {std::hypot(truth->before.vx_mps, truth->before.vy_mps),
                    0.0};
    in.bounce_height_m = {0.02 * a, 0.0};
    in.held_kind = core::AngleKind::kRadius;
    in.held_angle_rad = {*truth->radius_angle_rad, 0.0};
    ++judged;
    const bool bounced = gap > in.bounce_height_m.value;
    wrong += (BounceRatio(in, truth->approach_angle_rad) >= 1.0) != bounced;
    in.held_kind.reset();
    wrong_equal +=
        (BounceRatio(in, *truth->radius_angle_rad) >= 1.0) != bounced;
  }
  // What is left wrong is the second corner, which strikes before the first has
  // risen: the model is one impact.
  EXPECT_LE(wrong, 16);
  EXPECT_GT(wrong_equal, wrong);
  EXPECT_GT(judged, 150);
}

TEST(BoundaryAngle, TooSlowToBounce) {
  BoundaryInputs in = Sphere();
  in.speed_mps = {0.1, 0.0};
  in.bounce_height_m = {0.01, 0.0};
  EXPECT_FALSE(BoundaryAngle(BoundaryModel::kDetectableBounce, in));
  in.body = BodyKind::kRectangle;
  EXPECT_FALSE(BoundaryAngle(BoundaryModel::kDetectableBounce, in));
}

TEST(EvaluateBoundary, FirstOrderAgainstTheClosedDerivative) {
  BoundaryInputs in;
  in.radius_m = {0.1, 0.0};
  in.gravity_mps2 = {9.81, 0.0};
  in.omega_rad_per_s = {20.0, 0.2};
  std::mt19937_64 engine(2);
  const auto a = EvaluateBoundary(BoundaryModel::kPrintedEquations, in, engine);
  EXPECT_TRUE(a.uncertainty.first_order_is_valid);
  EXPECT_NEAR(a.uncertainty.first_order_u_rad / kDegree, 0.289889, 2e-4);
  EXPECT_NEAR(*a.uncertainty.u_rad / kDegree, 0.290155, 0.006);
  ASSERT_EQ(a.sensitivities.size(), 1u);
  EXPECT_NEAR(a.sensitivities[0].slope, -0.0252976, 1e-5);
}

TEST(EvaluateBoundary, NearTheThresholdItSaysHowOftenThereIsNone) {
  BoundaryInputs in;
  in.radius_m = {0.1, 0.0};
  in.gravity_mps2 = {9.81, 0.0};
  in.omega_rad_per_s = {10.0, 0.1};
  std::mt19937_64 engine(3);
  const auto a = EvaluateBoundary(BoundaryModel::kPrintedEquations, in, engine);
  EXPECT_FALSE(a.uncertainty.first_order_is_valid);
  EXPECT_NEAR(a.uncertainty.p_none, 0.169901, 0.01);
  EXPECT_NEAR(*a.uncertainty.low_rad / kDegree, 70.4237, 0.4);
  EXPECT_NEAR(*a.uncertainty.high_rad / kDegree, 86.7639, 0.4);
}

TEST(EvaluateBoundary, UncertainSphereBounce) {
  BoundaryInputs in = Sphere();
  in.restitution = {0.5, 0.01};
  in.speed_mps = {5.0, 0.05};
  in.bounce_height_m = {0.01, 0.0};
  std::mt19937_64 engine(4);
  const auto a = EvaluateBoundary(BoundaryModel::kDetectableBounce, in, engine);
  ASSERT_TRUE(a.boundary_rad);
  // u(sin)/sin = sqrt(0.02^2 + 0.01^2)
  EXPECT_NEAR(a.uncertainty.first_order_u_rad,
              std::tan(*a.boundary_rad) * std::sqrt(5e-4), 1e-6);
  EXPECT_TRUE(a.uncertainty.first_order_is_valid);
  EXPECT_NEAR(*a.uncertainty.u_rad / a.uncertainty.first_order_u_rad, 1.0,
              0.03);
}

TEST(EvaluateBoundary, SameSeedSameAnswer) {
  BoundaryInputs in;
  in.slip = Slip::kLeading;
  in.mu = {1.5, 0.1};
  std::mt19937_64 first(9);
  std::mt19937_64 second(9);
  const BoundaryOptions options{.n_draws = 2'000};
  const auto a =
      EvaluateBoundary(BoundaryModel::kCorrectedLcp, in, first, options);
  const auto b =
      EvaluateBoundary(BoundaryModel::kCorrectedLcp, in, second, options);
  EXPECT_EQ(a.uncertainty.p_none, b.uncertainty.p_none);
  EXPECT_EQ(a.uncertainty.mean_rad, b.uncertainty.mean_rad);
  EXPECT_GT(a.uncertainty.p_none, 0.02);  // mu below 4/3: no wedge
}

TEST(EvaluateBoundary, RangesCoverTheQuarterTurn) {
  std::mt19937_64 engine(5);
  for (const BoundaryModelCard& card : BoundaryModelCards()) {
    for (const auto body : {BodyKind::kSphere, BodyKind::kRectangle}) {
      for (const auto slip : {Slip::kLeading, Slip::kTrailing}) {
        BoundaryInputs in;
        in.body = body;
        in.slip = slip;
        in.mu = {1.6, 0.0};
        in.omega_rad_per_s = {30.0, 0.0};
        const auto a = EvaluateBoundary(card.model, in, engine);
        ASSERT_FALSE(a.ranges.empty()) << card.name;
        EXPECT_EQ(a.ranges.front().from_rad, 0.0) << card.name;
        EXPECT_NEAR(a.ranges.back().to_rad, 90 * kDegree, 1e-15) << card.name;
        for (std::size_t i = 1; i < a.ranges.size(); ++i) {
          EXPECT_EQ(a.ranges[i].from_rad, a.ranges[i - 1].to_rad) << card.name;
        }
      }
    }
  }
}

TEST(BoundaryAngle, RefusesWhatCannotBe) {
  BoundaryInputs in;
  in.slip = Slip::kNone;
  EXPECT_THROW(static_cast<void>(BoundaryAngle(BoundaryModel::kPublished, in)),
               std::invalid_argument);
  in = {};
  in.radius_m = {-1.0, 0.0};
  EXPECT_THROW(static_cast<void>(BoundaryAngle(BoundaryModel::kPublished, in)),
               std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
