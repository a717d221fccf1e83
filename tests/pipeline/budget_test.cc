// The uncertainty budget: its lines against Monte Carlo (JCGM 101), and the
// yaw's line against the derivative.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "app/measure/clip_calibration.h"
#include "app/measure/judge.h"
#include "tests/accuracy/monte_carlo.h"
#include "tests/pipeline/filmed.h"
#include "touchdown/core/units.h"

namespace touchdown::accuracy {
namespace {

class EachTrial : public ::testing::TestWithParam<std::size_t> {};

// JCGM 101, 8: the ends of the first-order interval are those of the drawn one
// within half a unit of the first significant digit of u.
TEST_P(EachTrial, FirstOrderAgreesWithMonteCarlo) {
  const BudgetTrial trial = BudgetTrials().at(GetParam());
  std::mt19937_64 engine(20261121 + GetParam());
  DrawOptions options;
  options.batch = 500;  // some seconds
  options.most = 4;
  for (const Spread& s : DrawnSpreads(trial, options, engine)) {
    SCOPED_TRACE(trial.name + ": " + s.quantity);
    EXPECT_EQ(s.absent, 0u);
    EXPECT_GE(s.draws, 1500u);
    // What the draws themselves leave open: 4 standard deviations.
    EXPECT_LT(std::abs(s.first_order.u - s.u),
              s.Tolerance(1) + 4.0 * s.u_tolerance)
        << s.first_order.u << " stated, " << s.u << " drawn";
    EXPECT_LT(s.FarthestEnd(), s.Tolerance(1) + 4.0 * s.end_tolerance)
        << s.first_order.value << " stated, " << s.mean << " drawn, u " << s.u;
  }
}

// A careful set-up: sphere, block, and a sphere in a turned plane through a
// lens.
INSTANTIATE_TEST_SUITE_P(Budget, EachTrial,
                         ::testing::Range<std::size_t>(0, 3));

Spread ApproachOf(std::size_t index) {
  const BudgetTrial trial = BudgetTrials().at(index);
  std::mt19937_64 engine(index);
  DrawOptions options;
  options.batch = 500;
  options.most = 4;
  return DrawnSpreads(trial, options, engine).front();
}

// Near 0 the normal interval would reach below it; some draws touch down before
// the first frame. The stated interval ends at 0 and holds the drawn one.
TEST(Budget, AFlatThrowStatesAnIntervalThatEndsAtZero) {
  const Spread s = ApproachOf(3);
  ASSERT_TRUE(s.first_order.interval95);
  EXPECT_EQ(s.first_order.interval95->low, 0.0);
  EXPECT_LE(s.first_order.interval95->low, s.interval95.low);
  EXPECT_GE(s.first_order.interval95->high,
            s.interval95.high - 4.0 * s.end_tolerance);
  EXPECT_GT(s.absent, 0u);
}

// With few or coarse frames some draws place the blow a frame off: tails are
// heavier than first order says (`./dev bench budget`: u too small by 9 and 12
// %). No better is promised; this fails if it gets worse.
TEST(Budget, FewAndCoarseFramesAreSomewhatTooSure) {
  for (const std::size_t index : {4u, 5u}) {
    const Spread s = ApproachOf(index);
    SCOPED_TRACE(index);
    EXPECT_GT(s.first_order.u, 0.75 * s.u);
    EXPECT_LT(s.first_order.u, 1.05 * s.u);
    EXPECT_LT(s.FarthestEnd(), 1.0 * s.u);
  }
}

TEST(Budget, SquaresAddUpAndNameEverySource) {
  for (const BudgetTrial& trial : BudgetTrials()) {
    SCOPED_TRACE(trial.name);
    const core::Contact contact = FirstOrder(trial).contact;
    ASSERT_TRUE(contact.approach_angle_rad);
    double squares = 0.0;
    std::vector<std::string> names;
    for (const core::BudgetLine& line : contact.approach_budget) {
      squares += line.u * line.u;
      names.push_back(line.source);
    }
    EXPECT_NEAR(std::sqrt(squares), contact.approach_angle_rad->u,
                1e-6 * contact.approach_angle_rad->u);
    // `picture`: beside the ground's edge an outline is off by something else.
    std::vector<std::string> expected = {"localisation", "ground", "size",
                                         "scale", "picture"};
    if (trial.analysis.options.calibration) {
      expected.insert(expected.end(), {"lens", "yaw"});
    }
    EXPECT_EQ(names, expected);
  }
}

// The third trial is that of the first seen from the side: with the yaw it says
// the same, without it it is off by three u.
TEST(Budget, YawIsUndoneAndItsLineIsTheDerivative) {
  const auto trials = BudgetTrials();
  const BudgetTrial& straight = trials[0];
  BudgetTrial turned = trials[2];
  const auto angle = [](const BudgetTrial& trial) {
    return *FirstOrder(trial).contact.approach_angle_rad;
  };
  const core::Estimate with = angle(turned);
  EXPECT_NEAR(with.value, angle(straight).value, 2e-4);
  auto& yaw = turned.analysis.options.calibration->ground->yaw_rad;
  const core::Estimate calibrated = *yaw;
  const double step = 0.05 * core::kDegree;
  yaw = core::Estimate{calibrated.value + step, 0.0, std::nullopt};
  const double above = angle(turned).value;
  yaw = core::Estimate{calibrated.value - step, 0.0, std::nullopt};
  const double below = angle(turned).value;
  const double line = FirstOrder(trials[2]).contact.approach_budget.back().u;
  EXPECT_GT(line, 0.0);
  EXPECT_NEAR(line, std::abs(above - below) / (2.0 * step) * calibrated.u,
              0.02 * line);
  yaw.reset();
  // Left out, the angle is off by more than 2.5 of the u that it has with the
  // yaw. Flights that are seen askew miss the ground line, so that u grows.
  const core::Estimate without = angle(turned);
  const double off = std::abs(without.value - with.value);
  EXPECT_GT(off, 2.5 * with.u);
  EXPECT_GT(without.u, off);
}

TEST(Budget, SaysWhatIsLeftOut) {
  const auto trials = BudgetTrials();
  const auto straight = pipeline::Rejudge(trials[0].analysis, {});
  const auto& left_out = straight.scene_model.left_out;
  EXPECT_THAT(left_out.at("uncertainty of the frame rate"),
              ::testing::HasSubstr("1 % of all speeds"));
  EXPECT_THAT(left_out.at("uncertainty of the model"),
              ::testing::HasSubstr("widens u"));
  pipeline::SceneModel scene;
  pipeline::DescribeCalibration(std::nullopt, scene);
  EXPECT_EQ(scene.left_out.at("yaw"), "no calibration");
  scene = {};
  pipeline::DescribeCalibration(trials[2].analysis.options.calibration, scene);
  EXPECT_FALSE(scene.left_out.contains("yaw"));
  EXPECT_THAT(scene.used, ::testing::Contains(::testing::HasSubstr(
                              "yaw of the plane of travel, 4.00 +- 0.50 deg")));
}

// The whole chain on a rendered clip: a plane turned by 6 degrees, its scale as
// a rule on the ground shows it.
TEST(Budget, ATurnedPlaneIsMeasuredRightWithItsCalibration) {
  pipeline::filmed::Film film =
      pipeline::filmed::Default(core::BodyKind::kSphere);
  film.camera.lens =
      calib::Lens{600.0, 600.0, 119.5, 59.5, 0.0, 0.0, 0.0, 0.0, 0.0};
  film.camera.yaw_rad = 6.0 * core::kDegree;
  calib::Calibration calibration;
  calibration.camera = "rendered";
  calibration.date = "2026-01-31";
  calibration.expires = "2027-01-31";
  calibration.picture = {film.camera.width_px, film.camera.height_px,
                         calib::SensorCorner{0, 0}};
  calib::LensRecord lens;
  lens.lens = *film.camera.lens;
  calibration.lens = lens;
  calib::ScaleRecord scale;
  const double seen = film.camera.px_per_m * std::cos(film.camera.yaw_rad);
  scale.px_per_m = {seen, 1e-4 * seen, std::nullopt};
  scale.length_m = 0.1;
  calibration.scale = scale;
  calib::GroundRecord ground;
  ground.p1 = vision::ToImage(film.camera, {-0.05, 0.0});
  ground.p2 = vision::ToImage(film.camera, {0.05, 0.0});
  ground.u_point_px = 0.02;
  ground.yaw_rad = core::Estimate{film.camera.yaw_rad, 1e-3, std::nullopt};
  calibration.ground = ground;
  pipeline::AnalyzeOptions options;
  options.calibration = calibration;
  const auto analyze = [&] {
    return pipeline::AnalyzeClip(
        vision::OpenScene(pipeline::filmed::BuildScene(film), 4), options);
  };
  const pipeline::Analysis with = analyze();
  options.calibration->ground->yaw_rad.reset();
  const pipeline::Analysis without = analyze();
  const core::ContactRecord& first = with.contacts.first;
  ASSERT_TRUE(first.contact.found) << first.contact.reason;
  EXPECT_EQ(first.contact.approach_budget.back().source, "yaw");
  const auto off = [](const core::Measured& m, double truth) {
    return std::abs(m->value - truth) / m->u;
  };
  const auto& t = film.thrown;
  EXPECT_LT(off(first.contact.approach_angle_rad, t.ContactAngle()), 4.0);
  EXPECT_LT(off(first.contact.frame, film.contact_frame), 4.0);
  EXPECT_LT(off(first.motion.before_tangential_mps, t.before.vx), 4.0);
  EXPECT_LT(off(first.motion.before_normal_mps, t.before.vy), 4.0);
  // In the u of the right answer: the naive one's has grown where the bent path
  // was taken for drag.
  const core::ContactRecord& naive = without.contacts.first;
  const double wrong_angle =
      std::abs(naive.contact.approach_angle_rad->value - t.ContactAngle());
  const double wrong_speed =
      std::abs(naive.motion.before_normal_mps->value - t.before.vy);
  EXPECT_GT(std::max(wrong_angle / first.contact.approach_angle_rad->u,
                     wrong_speed / first.motion.before_normal_mps->u),
            4.0)
      << "the yaw does not matter here";
}

}  // namespace
}  // namespace touchdown::accuracy
