#include "vision/src/outline/shared_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "outline_shot.h"

namespace touchdown::vision {
namespace {

// Normal equations of a frame of `n` parameters, of random rows.
struct Equations {
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;
};

Equations Draw(int n, std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd rows(40, n);
  Eigen::VectorXd residuals(40);
  for (int i = 0; i < 40; ++i) {
    residuals[i] = normal(engine);
    for (int j = 0; j < n; ++j) rows(i, j) = normal(engine);
  }
  return {rows.transpose() * rows, rows.transpose() * residuals};
}

// Frames with parameters (own, own, size, other, blur, own, open).
constexpr std::array<int, 4> kAt = {2, 3, 4, 6};
constexpr int kOwn[] = {0, 1, 5};

Fitted FrameOf(const SharedTerms& terms) {
  Fitted fitted;
  fitted.fit.shared = terms;
  return fitted;
}

std::vector<Fitted> DrawFrames(int count, const std::array<int, 4>& at,
                               std::mt19937_64& engine) {
  std::vector<Fitted> frames;
  for (int f = 0; f < count; ++f) {
    const Equations e = Draw(7, engine);
    frames.push_back(FrameOf(WithoutOwn(e.normal, e.gradient, at)));
  }
  return frames;
}

TEST(SharedFit, IsTheSolutionOfAllFramesEquationsAtOnce) {
  std::mt19937_64 engine(1);
  constexpr int kFrames = 6;
  constexpr int kAll = 4 + 3 * kFrames;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(kAll, kAll);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(kAll);
  std::vector<Fitted> frames;
  for (int f = 0; f < kFrames; ++f) {
    const Equations e = Draw(7, engine);
    frames.push_back(FrameOf(WithoutOwn(e.normal, e.gradient, kAt)));
    std::array<int, 7> place{};
    for (std::size_t i = 0; i < 4; ++i) {
      place[static_cast<std::size_t>(kAt[i])] = static_cast<int>(i);
    }
    for (int i = 0; i < 3; ++i) {
      place[static_cast<std::size_t>(kOwn[i])] = 4 + 3 * f + i;
    }
    for (int i = 0; i < 7; ++i) {
      const int row = place[static_cast<std::size_t>(i)];
      gradient[row] += e.gradient[i];
      for (int j = 0; j < 7; ++j) {
        normal(row, place[static_cast<std::size_t>(j)]) += e.normal(i, j);
      }
    }
  }
  const auto step = StepTogether(frames);
  ASSERT_TRUE(step);
  const Eigen::VectorXd all = normal.ldlt().solve(gradient);
  const Eigen::MatrixXd covariance = normal.inverse();
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(step->step[k], all[k], 1e-12);
    EXPECT_GE(step->u[k], (1.0 - 1e-9) * std::sqrt(covariance(k, k)));
  }
}

TEST(SharedFit, WhatNoFrameTellsStaysAsItIs) {
  std::mt19937_64 engine(2);
  const auto step = StepTogether(DrawFrames(5, {2, -1, 4, -1}, engine));
  ASSERT_TRUE(step);
  EXPECT_NE(step->step[0], 0.0);
  EXPECT_EQ(step->step[1], 0.0);
  EXPECT_EQ(step->u[1], 0.0);
  EXPECT_EQ(step->step[3], 0.0);
}

TEST(SharedFit, AFrameFarOffAndOnesThatAreNotWholeAreLeftOut) {
  std::mt19937_64 engine(3);
  std::vector<Fitted> frames = DrawFrames(8, kAt, engine);
  const auto alone = StepTogether(frames);
  Equations far = Draw(7, engine);
  far.gradient[2] += 1e3;
  frames.push_back(FrameOf(WithoutOwn(far.normal, far.gradient, kAt)));
  const Equations part = Draw(7, engine);
  frames.push_back(FrameOf(WithoutOwn(part.normal, part.gradient, kAt)));
  frames.back().fit.visible = 0.6;
  frames.emplace_back();  // that says nothing
  const auto step = StepTogether(frames);
  ASSERT_TRUE(alone && step);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(step->step[k], alone->step[k]);
}

TEST(SharedFit, NothingFromFewerThanThreeFrames) {
  std::mt19937_64 engine(4);
  EXPECT_FALSE(StepTogether(DrawFrames(2, kAt, engine)));
  EXPECT_FALSE(StepTogether({}));
}

// Many noisy pictures of one disc: what they say together is within its own
// uncertainty of the truth, and the weighted mean of their own blurs is not.
TEST(SharedFit, HasNotTheBiasOfAWeightedMean) {
  constexpr double kRadius_px = 8.0;
  constexpr int kPictures = 5000;
  testing::ShotOptions shots;
  shots.half_long_px = kRadius_px;
  shots.size_px = 40;
  shots.background_level = 0.35;
  shots.bit_depth = 12;
  shots.noise = 0.03;  // contrast 6.7 of it
  const double blur_px = std::sqrt(shots.psf_px * shots.psf_px + 1.0 / 12.0);
  std::vector<Fitted> told;
  std::vector<double> blurs;
  std::vector<double> u_blurs;
  for (int i = 0; i < kPictures; ++i) {
    const testing::Shot shot =
        testing::Take(1000 + static_cast<std::uint64_t>(i), shots);
    OutlineOptions options;
    options.blur_px = blur_px;
    const auto free =
        FitOutline(shot.image.view(), shot.background, shot.truth, options);
    options.fit_size = options.fit_blur = false;
    options.tell_shared = true;
    const auto held =
        FitOutline(shot.image.view(), shot.background, shot.truth, options);
    ASSERT_TRUE(free && held);
    blurs.push_back(free->blur_px);
    u_blurs.push_back(free->u_blur_px);
    told.push_back({i, 0.0, *held});
  }
  const auto step = StepTogether(told);
  ASSERT_TRUE(step);
  EXPECT_LT(std::abs(step->step[0]), 2.5 * step->u[0]);
  EXPECT_LT(std::abs(step->step[2]), 2.5 * step->u[2]);
  const core::Estimate mean = RobustMean(blurs, u_blurs);
  EXPECT_LT(mean.value - blur_px, -3.0 * mean.u);
}

}  // namespace
}  // namespace touchdown::vision
