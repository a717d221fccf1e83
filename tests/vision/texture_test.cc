// The prior of the body's picture: a Gaussian Markov random field beside a
// quadratic.
#include "vision/src/layers/texture.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace touchdown::vision::layers {
namespace {

// (1 - Pi) Q (1 - Pi) as a whole.
Eigen::MatrixXd WholeMatrix(const PicturePrior& prior, std::size_t cells) {
  Eigen::MatrixXd whole(cells, cells);
  std::vector<float> out(cells);
  for (std::size_t c = 0; c < cells; ++c) {
    std::vector<float> unit(cells);
    unit[c] = 1.0F;
    prior.Multiply(unit.data(), out.data());
    whole.col(static_cast<Eigen::Index>(c)) =
        Eigen::Map<Eigen::VectorXf>(out.data(),
                                    static_cast<Eigen::Index>(cells))
            .cast<double>();
  }
  return whole;
}

TEST(PicturePrior, AQuadraticCostsNothing) {
  const PictureGrid grid(Shape{false, 9.0, 5.0}, 3.0);
  const PicturePrior prior(grid, {10.0, 0.4});
  const Eigen::MatrixXd whole = WholeMatrix(prior, grid.size());
  EXPECT_LT((whole - whole.transpose()).norm(), 1e-4 * whole.norm());
  Eigen::VectorXd quadratic(grid.size());
  for (std::size_t c = 0; c < grid.size(); ++c) {
    const auto cell = static_cast<std::int32_t>(c);
    const auto x = static_cast<double>(grid.x_of(cell % grid.columns()));
    const auto y = static_cast<double>(grid.y_of(cell / grid.columns()));
    quadratic[static_cast<Eigen::Index>(c)] =
        80.0 + 2.0 * x - y + 0.3 * x * x - 0.2 * x * y;
  }
  EXPECT_LT((whole * quadratic).norm(), 1e-4 * quadratic.norm());
  // Of what is no quadratic nothing is free.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(whole);
  constexpr Eigen::Index kFree = 6;
  EXPECT_GT(solver.eigenvalues()[kFree], 1e-6);
}

// In the middle of a wide grid the inverse of Q has the stated variance, and
// the autocorrelation of Matern's class, x K_1(x) at x = kappa d (Lindgren et
// al. 2011, eq. 1; nu = 1): 0.604 at x = 1 (Abramowitz and Stegun, table 9.8).
TEST(PicturePrior, IsATextureOfMaternsClass) {
  const PictureGrid grid(Shape{false, 40.0, 40.0}, 3.0);
  constexpr double kDeviation = 12.0;
  constexpr double kRate = 0.25;
  const PicturePrior prior(grid, {kDeviation, kRate});
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<float>> factor(
      prior.MakePrecision());
  const Eigen::Index middle =
      grid.columns() * (grid.rows() / 2) + grid.columns() / 2;
  const Eigen::VectorXf covariance = factor.solve(
      Eigen::VectorXf::Unit(static_cast<Eigen::Index>(grid.size()), middle)
          .eval());
  EXPECT_NEAR(covariance[middle], kDeviation * kDeviation,
              0.02 * kDeviation * kDeviation);
  constexpr Eigen::Index kFar = 4;  // px: kappa d = 1
  EXPECT_NEAR(covariance[middle + kFar] / covariance[middle], 0.604, 0.03);
}

// What is measured of a texture that was drawn from the prior.
TEST(MeasureTexture, FindsDeviationAndRate) {
  for (const double rate : {0.3, 0.8, 5.0}) {
    Layers layers;
    layers.flat = false;
    layers.blur = 0.8;
    layers.shape = Shape{false, 40.0, 30.0};
    layers.grid = PictureGrid(layers.shape, 6.0);
    layers.noise_dn = 1.0;
    constexpr double kDeviation = 15.0;
    layers.texture = {kDeviation, 1.0};
    const PicturePrior prior(layers.grid, {kDeviation, rate});
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<float>, Eigen::Lower,
                               Eigen::NaturalOrdering<int>>
        factor(prior.MakePrecision());
    std::mt19937_64 engine(5);
    std::normal_distribution<float> normal;
    Eigen::VectorXf white(static_cast<Eigen::Index>(layers.grid.size()));
    for (float& value : white) value = normal(engine);
    // x = L'^-1 z has the covariance Q^-1.
    const Eigen::VectorXf drawn = factor.matrixU().solve(white);
    for (const float value : drawn) layers.picture.push_back(100.0F + value);
    // Seen so often that no noise is left.
    const std::vector<float> weight(layers.grid.size(), 1e4F);
    const Texture found = MeasureTexture(layers, weight);
    EXPECT_NEAR(found.deviation_dn, kDeviation, 0.25 * kDeviation) << rate;
    EXPECT_NEAR(std::log(found.rate / rate), 0.0, rate < 1.0 ? 0.25 : 1.0)
        << rate;
  }
}

}  // namespace
}  // namespace touchdown::vision::layers
