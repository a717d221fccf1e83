#include "touchdown/rig/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "touchdown/core/units.h"

namespace touchdown::rig {
namespace {

using testing::HasSubstr;

// F. J. Anscombe, Graphs in Statistical Analysis, The American Statistician 27
// (1973) 17-21: data sets 1 (scatter about a line) and 2 (a parabola).
constexpr std::array<double, 11> kX{10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5};
constexpr std::array<double, 11> kY1{8.04, 6.95, 7.58,  8.81, 8.33, 9.96,
                                     7.24, 4.26, 10.84, 4.82, 5.68};
constexpr std::array<double, 11> kY2{9.14, 8.14, 8.74, 8.77, 9.26, 8.10,
                                     6.13, 3.10, 9.13, 7.26, 4.74};

std::vector<ForcePoint> Anscombe(const std::array<double, 11>& y,
                                 double u = 0.0) {
  std::vector<ForcePoint> points;
  for (std::size_t i = 0; i < y.size(); ++i) {
    points.push_back({kX[i], {y[i], u, {}}});
  }
  return points;
}

Launch Known() {
  Launch launch;
  launch.stiffness_n_per_m = 7744.0;
  launch.mass_kg = 0.1;
  launch.spring_mass_kg = 0.03;
  launch.gravity_mps2 = 9.81;
  return launch;
}

// Speeds that `truth` gives, with noise of u_mps on each.
std::vector<SpeedPoint> Shots(const Launch& truth, double u_mps,
                              std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  std::vector<SpeedPoint> points;
  for (double x = 0.015; x < 0.0501; x += 0.005) {
    const double v = LaunchSpeed(truth, x)->speed_mps;
    points.push_back({x, {v + u_mps * normal(engine), u_mps, {}}});
  }
  return points;
}

TEST(FitStiffness, AnscombesFirstDataSet) {
  const auto fit = FitStiffness(Anscombe(kY1));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->stiffness_n_per_m.value, 0.5000909, 5e-8);
  EXPECT_NEAR(fit->stiffness_n_per_m.u, 0.1179055, 5e-8);
  EXPECT_NEAR(fit->force_at_zero_n.value, 3.0000909, 5e-8);
  EXPECT_NEAR(fit->force_at_zero_n.u, 1.1247468, 5e-8);
  EXPECT_NEAR(fit->residual_n, 1.236603, 5e-7);
  EXPECT_EQ(fit->dof, 9u);
  EXPECT_TRUE(fit->findings.empty());
  // t(9) = 2.262157.
  EXPECT_NEAR(fit->stiffness_n_per_m.interval95->high,
              0.5000909 + 2.262157 * 0.1179055, 1e-5);
  // cov/(u u) = -mean(x)/sqrt(mean(x^2)) = -9/sqrt(91).
  EXPECT_NEAR(fit->correlation, -9.0 / std::sqrt(91.0), 1e-12);
}

TEST(FitStiffness, AnscombesSecondDataSetIsCurved) {
  const auto fit = FitStiffness(Anscombe(kY2));
  ASSERT_TRUE(fit);
  ASSERT_EQ(fit->findings.size(), 1u);
  EXPECT_THAT(fit->findings[0].what, HasSubstr("the spring softens"));
}

TEST(FitStiffness, ExactLineIsRecovered) {
  std::vector<ForcePoint> points;
  for (int i = 0; i < 6; ++i) {
    const double x = 0.005 * i + 1.0;  // far from zero: no squared condition
    points.push_back({x, {7744.0 * x + 3.5, 0.2, {}}});
  }
  const auto fit = FitStiffness(points);
  EXPECT_NEAR(fit->stiffness_n_per_m.value, 7744.0, 1e-8);
  EXPECT_NEAR(fit->force_at_zero_n.value, 3.5, 1e-8);
  // u = sigma / sqrt(sum (x - mean)^2), sum = 0.005^2 17.5.
  EXPECT_NEAR(fit->stiffness_n_per_m.u, 0.2 / (0.005 * std::sqrt(17.5)), 1e-9);
}

TEST(FitStiffness, CompressionsUncertaintyEntersBySlope) {
  auto points = Anscombe(kY1);
  StiffnessFitOptions options;
  options.u_compression_m = 10.0;  // sigma = 5 N, above the scatter
  const auto fit = FitStiffness(points, options);
  EXPECT_NEAR(fit->stiffness_n_per_m.u, 0.5000909 * 10.0 / std::sqrt(110.0),
              1e-5);
}

TEST(FitStiffness, ScatterBeyondTheClaimEnlargesU) {
  const auto fit = FitStiffness(Anscombe(kY1, 0.1));
  EXPECT_NEAR(fit->stiffness_n_per_m.u, 0.1179055, 5e-8);  // as from scatter
  ASSERT_EQ(fit->findings.size(), 1u);
  EXPECT_THAT(fit->findings[0].what, HasSubstr("scatter 12 times"));
  // And below it the claim stands.
  EXPECT_NEAR(FitStiffness(Anscombe(kY1, 5.0))->stiffness_n_per_m.u,
              5.0 / std::sqrt(110.0), 1e-12);
}

TEST(FitStiffness, SaysNoWithAReason) {
  std::vector<ForcePoint> points{{0.01, {1.0, 0.0, {}}},
                                 {0.02, {2.0, 0.0, {}}}};
  EXPECT_THAT(FitStiffness(points).error().reason, HasSubstr("2 points"));
  points.assign(4, {0.01, {1.0, 0.0, {}}});
  EXPECT_THAT(FitStiffness(points).error().reason, HasSubstr("are equal"));
  points = {
      {1.0, {3.0, 0.0, {}}}, {2.0, {2.0, 0.0, {}}}, {3.0, {1.0, 0.0, {}}}};
  EXPECT_THAT(FitStiffness(points).error().reason, HasSubstr("do not grow"));
}

TEST(FitStiffness, ImpossibleInputIsRefused) {
  auto points = Anscombe(kY1);
  points[3].force_n.u = 0.1;
  EXPECT_THROW((void)FitStiffness(points), std::invalid_argument);
  points = Anscombe(kY1);
  points[3].force_n.value = std::nan("");
  EXPECT_THROW((void)FitStiffness(points), std::invalid_argument);
}

TEST(FitEfficiency, NistNoInt1) {
  // NIST StRD linear regression, data set NoInt1: y = 130..140 at x = 60..70
  // through the origin; certified slope 2.07438016528926, standard deviation
  // 0.0165289256198347, residual 3.56753034006338. Here x = X^2, y = v^2, with
  // eta H/M = slope.
  std::vector<SpeedPoint> points;
  for (int i = 0; i <= 10; ++i) {
    points.push_back({std::sqrt(60.0 + i), {std::sqrt(130.0 + i), 0.0, {}}});
  }
  Launch launch;
  launch.stiffness_n_per_m = 4.0;
  launch.mass_kg = 1.0;
  EfficiencyFitOptions options;
  options.losses = LossModel::kNone;
  const auto fit = FitEfficiency(points, launch, options);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope_per_s2, 2.07438016528926, 1e-13);
  EXPECT_NEAR(fit->residual_m2_per_s2, 3.56753034006338, 1e-12);
  EXPECT_NEAR(fit->effective_stiffness_n_per_m.u, 0.0165289256198347, 1e-14);
  EXPECT_NEAR(fit->efficiency.value, 2.07438016528926 / 4.0, 1e-14);
  EXPECT_EQ(fit->dof, 10u);
}

TEST(FitEfficiency, RecoversWhatMadeTheSpeeds) {
  std::mt19937_64 engine(1);
  for (const double elevation_deg : {-30.0, 0.0, 45.0}) {
    for (const double preload : {0.0, 0.01}) {
      Launch truth = Known();
      truth.elevation_rad = elevation_deg * core::kDegree;
      truth.preload_m = preload;
      truth.efficiency = 0.87;
      truth.loss_j = 0.15;
      EfficiencyFitOptions options;
      const auto shots = Shots(truth, 0.0, engine);
      Launch known = truth;
      known.efficiency = 1.0;
      known.loss_j = 0.0;
      const auto per_shot = FitEfficiency(shots, known, options);
      EXPECT_NEAR(per_shot->efficiency.value, 0.87, 1e-12);
      EXPECT_NEAR(per_shot->loss_j.value, 0.15, 1e-12);
      truth.loss_j = 0.0;
      truth.barrel_friction = 0.3;
      options.losses = LossModel::kFriction;
      const auto friction =
          FitEfficiency(Shots(truth, 0.0, engine), known, options);
      EXPECT_NEAR(friction->efficiency.value, 0.87, 1e-11);
      EXPECT_NEAR(friction->barrel_friction.value, 0.3, 1e-9);
      // eta H does not know H.
      known.stiffness_n_per_m *= 2.0;
      EXPECT_NEAR(
          FitEfficiency(shots, known)->effective_stiffness_n_per_m.value,
          0.87 * 7744.0, 1e-8);
    }
  }
}

TEST(FitEfficiency, IntervalsCover) {
  // 1000 calibrations of 8 shots: 95 % intervals, with claimed and with unknown
  // uncertainty; the 99.9 % band of a binomial (1000, 0.95) is 926 .. 972, and
  // with claimed u Student's interval covers a little more.
  std::mt19937_64 engine(20240601);
  Launch truth = Known();
  truth.efficiency = 0.9;
  truth.loss_j = 0.1;
  int known_u = 0;
  int unknown_u = 0;
  for (int i = 0; i < 1000; ++i) {
    auto shots = Shots(truth, 0.02, engine);
    const auto covers = [&](const core::Estimate& e, double value) {
      return core::Interval95(e).low <= value &&
             value <= core::Interval95(e).high;
    };
    known_u += covers(FitEfficiency(shots, Known())->efficiency, 0.9);
    for (SpeedPoint& shot : shots) shot.speed_mps.u = 0.0;
    unknown_u += covers(FitEfficiency(shots, Known())->efficiency, 0.9);
  }
  EXPECT_GE(known_u, 926);
  EXPECT_GE(unknown_u, 926);
  EXPECT_LE(unknown_u, 972);
}

TEST(FitEfficiency, UncertaintyOfStiffnessAndMassEnters) {
  std::mt19937_64 engine(1);
  Launch truth = Known();
  truth.efficiency = 0.9;
  const auto shots = Shots(truth, 0.001, engine);
  EfficiencyFitOptions options;
  options.losses = LossModel::kNone;
  options.u_stiffness_rel = 0.03;
  options.u_mass_rel = 0.004;
  const auto fit = FitEfficiency(shots, Known(), options);
  EXPECT_NEAR(fit->efficiency.u / fit->efficiency.value,
              std::hypot(0.03, 0.004), 1e-4);
  EXPECT_NEAR(fit->effective_stiffness_n_per_m.u /
                  fit->effective_stiffness_n_per_m.value,
              0.004, 1e-4);
}

TEST(FitEfficiency, WarnsAboveOneAndOfNegativeLoss) {
  std::mt19937_64 engine(1);
  Launch truth = Known();
  truth.efficiency = 1.2;  // e.g. the stiffness was computed with D_outer
  const auto fit = FitEfficiency(Shots(truth, 0.0, engine), Known());
  ASSERT_GE(fit->findings.size(), 1u);
  EXPECT_THAT(fit->findings[0].what, HasSubstr("is above 1"));
  std::vector<SpeedPoint> points;
  for (const double x : {0.02, 0.03, 0.04, 0.05}) {
    const double v2 = LaunchSpeed(Known(), x)->speed_mps *
                          LaunchSpeed(Known(), x)->speed_mps * 0.8 +
                      1.0;
    points.push_back({x, {std::sqrt(v2), 0.0, {}}});
  }
  const auto negative = FitEfficiency(points, Known());
  ASSERT_EQ(negative->findings.size(), 1u);
  EXPECT_THAT(negative->findings[0].what, HasSubstr("fitted loss is negative"));
}

TEST(FitEfficiency, SaysNoWithAReason) {
  std::vector<SpeedPoint> points{{0.02, {5.0, 0.0, {}}},
                                 {0.03, {7.0, 0.0, {}}}};
  EXPECT_THAT(FitEfficiency(points, Known()).error().reason,
              HasSubstr("2 points, 2 unknowns"));
  points.assign(4, {0.02, {5.0, 0.0, {}}});
  EXPECT_THAT(FitEfficiency(points, Known()).error().reason,
              HasSubstr("too much alike"));
  points = {
      {0.02, {7.0, 0.0, {}}}, {0.03, {6.0, 0.0, {}}}, {0.04, {5.0, 0.0, {}}}};
  EXPECT_THAT(FitEfficiency(points, Known()).error().reason,
              HasSubstr("v^2 falls"));
}

TEST(FitEfficiency, ImpossibleInputIsRefused) {
  std::vector<SpeedPoint> points{
      {0.02, {5.0, 0.0, {}}}, {0.03, {-7.0, 0.0, {}}}, {0.04, {8.0, 0.0, {}}}};
  EXPECT_THROW((void)FitEfficiency(points, Known()), std::invalid_argument);
  points[1] = {0.0, {7.0, 0.0, {}}};
  EXPECT_THROW((void)FitEfficiency(points, Known()), std::invalid_argument);
  Launch bad = Known();
  bad.mass_kg = 0.0;
  points[1] = {0.03, {7.0, 0.0, {}}};
  EXPECT_THROW((void)FitEfficiency(points, bad), std::invalid_argument);
}

TEST(StudentT, Table) {
  // Any statistics text, two-sided 95 %.
  const std::array<std::pair<std::size_t, double>, 9> table{{{1, 12.706205},
                                                             {2, 4.302653},
                                                             {3, 3.182446},
                                                             {4, 2.776445},
                                                             {5, 2.570582},
                                                             {9, 2.262157},
                                                             {10, 2.228139},
                                                             {30, 2.042272},
                                                             {1000, 1.962339}}};
  for (const auto& [dof, t] : table) {
    EXPECT_NEAR(StudentT975(dof), t, 1e-4 * t) << dof;
  }
  EXPECT_THROW((void)StudentT975(0), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
