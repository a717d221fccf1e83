// The two-layer model against pictures made the long way (layered_scene.h),
// and against closed forms. Its derivatives: layer_model_test.cc.
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>
#include <random>

#include "tests/vision/layered_scene.h"
#include "touchdown/core/normal.h"
#include "vision/src/layers/align_pose.h"
#include "vision/src/layers/body_picture.h"
#include "vision/src/layers/columns.h"
#include "vision/src/layers/edge_product.h"
#include "vision/src/layers/fit_layers.h"
#include "vision/src/layers/layer_model.h"
#include "vision/src/layers/shape_cover.h"

namespace touchdown::vision::layers {
namespace {

TEST(EdgeProduct, OfEdgesThroughAPointIsSheppards) {
  // Sheppard (1899): Phi2(0, 0; rho) = 1/4 + asin(rho) / (2 pi).
  for (const float rho : {-0.99F, -0.5F, 0.0F, 0.3F, 0.9F, 0.999F}) {
    EXPECT_NEAR(EdgeProduct(0.0F, 0.0F, rho),
                0.5 * std::numbers::inv_pi * std::asin(rho), 1e-4)
        << rho;
  }
}

TEST(EdgeProduct, OfCoincidentEdgesIsThatOfOneEdge) {
  // rho = 1 and z1 = z2: min(Phi, Phi) - Phi^2.
  for (const double z : {-2.0, -0.7, 0.0, 0.4, 1.5}) {
    const auto at = static_cast<float>(z);
    EXPECT_NEAR(EdgeProduct(at, at, 1.0F),
                core::NormalCdf(z) * (1.0 - core::NormalCdf(z)), 4e-3)
        << z;
  }
}

TEST(EdgeProduct, AgreesWithIntegrationOverThePlane) {
  for (const auto& [z1, z2, rho] : {std::array{0.5, -0.3, 0.8},
                                    {1.2, 0.9, -0.6},
                                    {-0.8, 0.4, 0.95},
                                    {0.3, 0.25, 0.9985},
                                    {0.1, 0.1, 0.9999},
                                    {-0.2, 0.6, 0.9999},
                                    {0.4, -0.43, -0.9995}}) {
    // Phi2 = int_{-inf}^{z1} phi(t) Phi((z2 - rho t) / sqrt(1 - rho^2)) dt.
    double both = 0.0;
    constexpr double kStep = 1e-3;
    for (double t = -8.0 + 0.5 * kStep; t < z1; t += kStep) {
      both += kStep * std::exp(-0.5 * t * t) /
              std::sqrt(2.0 * std::numbers::pi) *
              core::NormalCdf((z2 - rho * t) / std::sqrt(1.0 - rho * rho));
    }
    EXPECT_NEAR(EdgeProduct(static_cast<float>(z1), static_cast<float>(z2),
                            static_cast<float>(rho)),
                both - core::NormalCdf(z1) * core::NormalCdf(z2), 1e-3);
  }
}

TEST(EdgeProduct, SlopeIsItsDerivative) {
  constexpr float kStep = 0.01F;
  for (const float rho : {-0.7F, 0.2F, 0.9F}) {
    for (const float z1 : {-1.0F, 0.1F, 1.4F}) {
      const float by = (EdgeProduct(z1 + kStep, 0.4F, rho) -
                        EdgeProduct(z1 - kStep, 0.4F, rho)) /
                       (2.0F * kStep);
      EXPECT_NEAR(EdgeProductSlope(z1, 0.4F, rho), by, 2e-3);
    }
  }
}

TEST(StillEdges, ReadContrastAndDistanceOffABlurredEdge) {
  constexpr std::int32_t kWidth = 5;
  constexpr double kBlur = 1.1;
  for (const double edge : {10.0, 10.3, 10.77}) {
    std::vector<float> still;
    for (int y = 0; y < 21; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        still.push_back(static_cast<float>(
            70.0 + 120.0 * core::NormalCdf((edge - y) / kBlur)));
      }
    }
    StillEdges edges(still.data(), kWidth, kBlur, 1.0);
    for (int y = 9; y <= 12; ++y) {
      const StillEdge at = edges.FindEdge(y * kWidth + 2);
      EXPECT_NEAR(at.contrast, 120.0, 1.0) << y;
      EXPECT_NEAR(at.z, (edge - y) / kBlur, 0.02) << y;
      EXPECT_NEAR(at.normal_y, -1.0, 1e-6);
    }
    EXPECT_EQ(edges.FindEdge(2 * kWidth + 2).contrast, 0.0F);
  }
}

TEST(ShapeCover, DerivativesAreThoseOfTheValue) {
  constexpr float kStep = 0.01F;
  for (const bool disc : {false, true}) {
    const Shape shape{disc, 9.0, disc ? 9.0 : 4.0};
    const ShapeCover cover(shape, 1.2);
    for (const auto& [x, y] : {std::array{8.6F, 1.0F},
                               {7.5F, 4.4F},
                               {-9.3F, -3.0F},
                               {2.0F, -4.1F}}) {
      const CoverAt at = cover.At(x, y);
      const auto difference = [&](const Shape& larger, const Shape& smaller,
                                  double blur, double other, float dx,
                                  float dy) {
        return (ShapeCover(larger, blur).At(x + dx, y + dy).value -
                ShapeCover(smaller, other).At(x - dx, y - dy).value) /
               (2.0F * kStep);
      };
      EXPECT_NEAR(at.by_x, difference(shape, shape, 1.2, 1.2, kStep, 0.0F),
                  2e-3);
      EXPECT_NEAR(at.by_y, difference(shape, shape, 1.2, 1.2, 0.0F, kStep),
                  2e-3);
      EXPECT_NEAR(at.by_blur, difference(shape, shape, 1.21, 1.19, 0.0F, 0.0F),
                  2e-3);
      Shape longer = shape;
      longer.half_long += 0.01;
      Shape shorter = shape;
      shorter.half_long -= 0.01;
      EXPECT_NEAR(at.by_long, difference(longer, shorter, 1.2, 1.2, 0.0F, 0.0F),
                  2e-3);
    }
  }
}

// A disc's coverage by integration of the Gaussian over it, strip by strip.
// All that is covered by 2e-4, and hardly anything else: at the corners of a
// rectangle both slabs see what their product does not.
TEST(ShapeCover, ARowsPartIsWhatIsCovered) {
  for (const Shape& shape : {Shape{true, 9.0, 9.0}, Shape{false, 20.0, 6.0},
                             Shape{false, 7.0, 7.0}}) {
    for (const double angle : {0.0, 0.3, 1.0, 1.5707963, 2.5, -0.7}) {
      const auto cosine = static_cast<float>(std::cos(angle));
      const auto sine = static_cast<float>(std::sin(angle));
      const ShapeCover cover(shape, 1.3);
      int seen = 0;
      int covered = 0;
      for (int down = -30; down <= 30; ++down) {
        const auto dy = static_cast<float>(down) + 0.25F;
        const RowPart part = cover.FindSeen(dy, cosine, sine);
        for (int across = -30; across <= 30; ++across) {
          const auto dx = static_cast<float>(across) - 0.1F;
          const bool is_seen = dx >= part.from && dx <= part.to;
          const bool is_covered =
              cover.At(cosine * dx + sine * dy, cosine * dy - sine * dx)
                  .value >= 2e-4F;
          seen += is_seen;
          covered += is_covered;
          ASSERT_TRUE(is_seen || !is_covered)
              << dx << " " << dy << " " << angle;
        }
      }
      EXPECT_GT(covered, 100);
      EXPECT_LT(seen, 1.1 * covered) << angle;
    }
  }
}

TEST(ShapeCover, OfADiscIsThatOfItsArea) {
  for (const double per_blur : {4.0, 6.0, 10.0}) {
    const double blur = 1.3;
    const double radius = per_blur * blur;
    const ShapeCover cover({true, radius, radius}, blur);
    for (double at = radius - 3.0 * blur; at < radius + 3.0 * blur;
         at += 0.25 * blur) {
      double inside = 0.0;
      constexpr double kStep = 0.01;
      for (double y = -radius + 0.5 * kStep; y < radius; y += kStep) {
        const double half = std::sqrt(radius * radius - y * y);
        inside += kStep / blur * std::exp(-0.5 * y * y / (blur * blur)) /
                  std::sqrt(2.0 * std::numbers::pi) *
                  (core::NormalCdf((half - at) / blur) -
                   core::NormalCdf((-half - at) / blur));
      }
      EXPECT_NEAR(cover.At(static_cast<float>(at), 0.0F).value, inside,
                  0.1 / (per_blur * per_blur))
          << per_blur << " " << at;
    }
  }
}

// Numbers from -1 to 1, one for each knot.
std::vector<float> RandomLevels(const PictureGrid& grid,
                                std::mt19937_64& engine) {
  std::uniform_real_distribution<float> level(-1.0F, 1.0F);
  std::vector<float> levels(grid.size());
  for (float& one : levels) one = level(engine);
  return levels;
}

TEST(PictureGrid, SpreadIsTheTransposeOfValueAt) {
  const PictureGrid grid(Shape{false, 6.0, 3.0}, 2.0);
  std::mt19937_64 engine(7);
  const std::vector<float> coefficients = RandomLevels(grid, engine);
  std::uniform_real_distribution<float> level(-1.0F, 1.0F);
  for (int i = 0; i < 20; ++i) {
    const SplinePlace place =
        grid.LocatePlace(6.0F * level(engine), 3.0F * level(engine));
    std::vector<float> spread(grid.size());
    grid.Spread(2.0F, place, spread.data());
    double sum = 0.0;
    for (std::size_t c = 0; c < spread.size(); ++c) {
      sum +=
          static_cast<double>(spread[c]) * static_cast<double>(coefficients[c]);
    }
    EXPECT_NEAR(2.0 * grid.EvaluateSpline(coefficients.data(), place), sum,
                1e-5);
  }
}

TEST(PictureGrid, TiltIsTheGradient) {
  const PictureGrid grid(Shape{false, 6.0, 3.0}, 2.0);
  std::mt19937_64 engine(9);
  std::uniform_real_distribution<float> level(0.0F, 100.0F);
  std::vector<float> coefficients(grid.size());
  for (float& c : coefficients) c = level(engine);
  constexpr float kStep = 0.02F;
  const auto value = [&](float x, float y) {
    return grid.EvaluateSpline(coefficients.data(), grid.LocatePlace(x, y));
  };
  const PictureGrid::Tilt tilt =
      grid.EvaluateTilt(coefficients.data(), grid.LocatePlace(1.3F, -0.6F));
  EXPECT_NEAR(tilt.value, value(1.3F, -0.6F), 1e-4);
  EXPECT_NEAR(tilt.by_x,
              (value(1.32F, -0.6F) - value(1.28F, -0.6F)) / (2.0F * kStep),
              0.05);
  EXPECT_NEAR(tilt.by_y,
              (value(1.3F, -0.58F) - value(1.3F, -0.62F)) / (2.0F * kStep),
              0.05);
}

TEST(PictureGrid, TransformedLevelsAreThoseOfTheSpline) {
  const PictureGrid grid(Shape{false, 6.0, 3.0}, 2.0);
  std::mt19937_64 engine(11);
  const std::vector<float> levels = RandomLevels(grid, engine);
  std::vector<float> coefficients = levels;
  grid.TransformLevels(coefficients.data());
  for (std::int32_t j = 1; j + 2 < grid.rows(); ++j) {
    for (std::int32_t i = 1; i + 2 < grid.columns(); ++i) {
      EXPECT_NEAR(
          grid.EvaluateSpline(coefficients.data(),
                              grid.LocatePlace(grid.x_of(i), grid.y_of(j))),
          levels[static_cast<std::size_t>(j * grid.columns() + i)], 1e-4)
          << i << ' ' << j;
    }
  }
  // Its own transpose.
  const std::vector<float> others = RandomLevels(grid, engine);
  std::vector<float> transformed = others;
  grid.TransformLevels(transformed.data());
  const auto dot = [](const std::vector<float>& a,
                      const std::vector<float>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  EXPECT_NEAR(dot(others, coefficients), dot(transformed, levels), 1e-3);
}

TEST(PictureGrid, AFlatBodyIsTheSameAsASpline) {
  Layers layers;
  layers.shape = Shape{false, 12.0, 6.0};
  layers.grid = PictureGrid(layers.shape, 4.0);
  layers.picture.assign(layers.grid.size(), 0.0F);
  layers.quadratic = {90.0, 4.0, -3.0, 12.0, 5.0, -8.0};
  LearnTexture(layers);
  EXPECT_FALSE(layers.flat);
  const double reach = layers.shape.Reach();
  for (const auto& [x, y] : {std::array{0.3F, 1.7F}, {-7.2F, 4.4F}}) {
    const double u = static_cast<double>(x) / reach;
    const double v = static_cast<double>(y) / reach;
    EXPECT_NEAR(
        layers.grid.EvaluateSpline(layers.picture.data(),
                                   layers.grid.LocatePlace(x, y)),
        90.0 + 4.0 * u - 3.0 * v + 12.0 * u * u + 5.0 * u * v - 8.0 * v * v,
        1e-3);
  }
}

FitLayersOptions OptionsOf(const LayeredScene& scene) {
  FitLayersOptions options;
  options.prior.value[kBlur] = 1.0;
  options.prior.u[kBlur] = 0.5;
  options.prior.value[kLong] = scene.shape.half_long;
  options.prior.value[kShort] = scene.shape.half_short;
  options.prior.u[kLong] = 0.1;
  options.prior.u[kShort] = scene.shape.disc ? 0.0 : 0.1;
  options.prior.u[kSlopeX] = 20.0;
  options.prior.u[kSlopeY] = 20.0;
  for (std::size_t k = 0; k < kTerms; ++k)
    options.prior.u[kQuadratic + k] = 1e4;
  options.turns = !scene.shape.disc;
  options.threads = 1;
  return options;
}

LayerFit FitFromTruth(const LayeredScene& scene, const PictureStack& stack) {
  return FitLayers(stack, scene.shape, scene.poses, Paint(scene, nullptr),
                   scene.noise_dn, OptionsOf(scene));
}

std::vector<LayerPose> Shaken(const std::vector<LayerPose>& poses, double px) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> off(0.0, px);
  std::vector<LayerPose> shaken = poses;
  for (LayerPose& pose : shaken) {
    pose.x += off(engine);
    pose.y += off(engine);
    pose.angle_rad += 0.02 * off(engine);
  }
  return shaken;
}

struct Errors {
  double worst_px = 0.0;
  double mean_y_px = 0.0;
  double z2 = 0.0;  // mean of (error / u)^2 in x and y
};
Errors ErrorsOf(const LayeredScene& scene, const PictureStack& stack,
                const LayerFit& fit, bool turns) {
  Errors errors;
  const std::vector<LayerPose> motions =
      EstimateMotions(fit.poses, stack.frames);
  for (std::size_t t = 0; t < fit.poses.size(); ++t) {
    const PoseFit at =
        AlignPose(stack, t, fit.layers, fit.poses[t], motions[t], turns);
    EXPECT_TRUE(at.found);
    const double dx = at.pose.x - scene.poses[t].x;
    const double dy = at.pose.y - scene.poses[t].y;
    errors.worst_px = std::max({errors.worst_px, std::abs(dx), std::abs(dy)});
    errors.mean_y_px += dy / static_cast<double>(fit.poses.size());
    errors.z2 +=
        0.5 * (dx * dx / at.covariance[0][0] + dy * dy / at.covariance[1][1]) /
        static_cast<double>(fit.poses.size());
  }
  return errors;
}

TEST(FitLayers, ABlockThatLiesOnTheGroundsEdge) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 11);
  const LayerFit fit =
      FitLayers(stack, scene.shape, Shaken(scene.poses, 0.4),
                Paint(scene, nullptr), scene.noise_dn, OptionsOf(scene));
  EXPECT_TRUE(fit.converged);
  EXPECT_TRUE(fit.layers.flat);
  EXPECT_NEAR(fit.layers.blur, std::hypot(0.9, std::sqrt(1.0 / 12.0)), 0.03);
  EXPECT_NEAR(fit.layers.noise_dn, 1.0, 0.1);
  const Errors errors = ErrorsOf(scene, stack, fit, true);
  EXPECT_LT(errors.worst_px, 0.03);
  // Without what the blur makes of both edges it is 0.04 px and more.
  EXPECT_LT(std::abs(errors.mean_y_px), 0.01);
  EXPECT_LT(errors.z2, 3.0);
}

// Not only where it returns: a large body's fit takes minutes.
TEST(FitLayers, EndsWhereItIsCancelled) {
  const LayeredScene scene = BlockOnGround();
  FitLayersOptions options = OptionsOf(scene);
  options.until = core::Cancellation::After(1e-9);
  EXPECT_THROW(FitLayers(Film(scene, 11), scene.shape, scene.poses,
                         Paint(scene, nullptr), scene.noise_dn, options),
               core::Cancelled);
}

TEST(FitLayers, AShadedBodyIsNotDrawnToOneSide) {
  LayeredScene scene;
  scene.shape = Shape{true, 10.0, 10.0};
  scene.psf_px = 1.3;
  scene.body = [](double, double v) { return 90.0 + 3.0 * v; };
  for (int t = 0; t < 24; ++t) {
    scene.poses.push_back({18.0 + 2.3 * t, 20.0 + 0.02 * t * t, 0.0});
  }
  const PictureStack stack = Film(scene, 3);
  const LayerFit fit =
      FitLayers(stack, scene.shape, Shaken(scene.poses, 0.3),
                Paint(scene, nullptr), scene.noise_dn, OptionsOf(scene));
  const Errors errors = ErrorsOf(scene, stack, fit, false);
  // s^2 |grad T| / contrast = 0.06 px without it.
  EXPECT_LT(std::abs(errors.mean_y_px), 0.01);
  EXPECT_LT(errors.z2, 3.0);
}

// What is held of a disc, its second side, must not hold up the rest.
TEST(FitLayers, ADiscThatIsSmallerThanStated) {
  LayeredScene scene;
  scene.shape = Shape{true, 10.0, 10.0};
  for (int t = 0; t < 24; ++t) {
    scene.poses.push_back({18.0 + 2.3 * t, 20.0 + 0.02 * t * t, 0.0});
  }
  const PictureStack stack = Film(scene, 3);
  FitLayersOptions options = OptionsOf(scene);
  const Shape stated{true, 10.4, 10.4};
  options.prior.value[kLong] = stated.half_long;
  options.prior.value[kShort] = stated.half_short;
  options.prior.u[kLong] = 0.5;
  const LayerFit fit =
      FitLayers(stack, stated, Shaken(scene.poses, 0.3), Paint(scene, nullptr),
                scene.noise_dn, options);
  EXPECT_TRUE(fit.converged);
  EXPECT_NEAR(fit.layers.shape.half_long, 10.0, 0.02);
  EXPECT_EQ(fit.layers.shape.half_short, fit.layers.shape.half_long);
}

// From either side, where the body goes some pixels in an exposure, and where
// it stands still in it.
TEST(FitLayers, AnExposureThatIsNotTheStatedOne) {
  for (const double exposure : {0.0, 0.8}) {
    LayeredScene scene;
    scene.shape = Shape{false, 9.0, 6.0};
    for (int t = 0; t < 16; ++t) {
      scene.poses.push_back({20.0 + 2.5 * t, 30.0, 0.3});
    }
    // Frames between two others, as many as an exposure takes.
    PictureStack stack = Film(scene, 7);
    if (exposure > 0.0) {
      constexpr int kParts = 8;
      LayeredScene part = scene;
      part.noise_dn = 0.0;
      stack.levels.assign(stack.levels.size(), 0.0F);
      for (int k = 0; k < kParts; ++k) {
        const double shift = 2.5 * exposure * ((k + 0.5) / kParts - 0.5);
        for (std::size_t t = 0; t < part.poses.size(); ++t) {
          part.poses[t].x = scene.poses[t].x + shift;
        }
        const PictureStack seen = Film(part, 7);
        for (std::size_t i = 0; i < stack.levels.size(); ++i) {
          stack.levels[i] += seen.levels[i] / static_cast<float>(kParts);
        }
      }
    }
    FitLayersOptions options = OptionsOf(scene);
    options.prior.value[kExposureSquare] = 0.3 * 0.3;
    options.prior.u[kExposureSquare] = 2.0 * 0.3 * 0.3;
    const LayerFit fit =
        FitLayers(stack, scene.shape, Shaken(scene.poses, 0.2),
                  Paint(scene, nullptr), scene.noise_dn, options);
    EXPECT_TRUE(fit.converged) << exposure;
    EXPECT_NEAR(fit.layers.exposure, exposure, exposure > 0.0 ? 0.05 : 0.15);
  }
}

TEST(FitLayers, ATexturedFace) {
  LayeredScene scene = BlockOnGround();
  scene.body = [](double u, double v) {
    return 60.0 + 20.0 * std::sin(0.9 * u + 0.3) * std::cos(0.7 * v) +
           10.0 * std::sin(0.5 * u * v);
  };
  const PictureStack stack = Film(scene, 17);
  FitLayersOptions options = OptionsOf(scene);
  options.prior.u[kLong] = 0.0;
  options.prior.u[kShort] = 0.0;
  const LayerFit fit =
      FitLayers(stack, scene.shape, Shaken(scene.poses, 0.3),
                Paint(scene, nullptr), scene.noise_dn, options);
  EXPECT_FALSE(fit.layers.flat);
  EXPECT_GT(fit.layers.texture.deviation_dn, 5.0);
  const Errors errors = ErrorsOf(scene, stack, fit, true);
  // A texture hides where the outline lies: a tenth of a pixel at most.
  EXPECT_LT(errors.worst_px, 0.12);
}

// Layers that are right but for a quarter of a pixel need few steps to be so
// again.
TEST(ImproveLayers, EndsWhereTheFitFromNothingEnds) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 11);
  FitLayersOptions options = OptionsOf(scene);
  const LayerFit fit =
      FitLayers(stack, scene.shape, Shaken(scene.poses, 0.4),
                Paint(scene, nullptr), scene.noise_dn, options);
  ASSERT_TRUE(fit.converged);
  LayerFit start = fit;
  start.poses = Shaken(fit.poses, 0.25);
  options.steps = 4;
  const LayerFit again = ImproveLayers(stack, start, options);
  EXPECT_TRUE(again.converged);
  EXPECT_NEAR(again.layers.blur, fit.layers.blur, 1e-3);
  for (std::size_t t = 0; t < fit.poses.size(); ++t) {
    EXPECT_NEAR(again.poses[t].x, fit.poses[t].x, 2e-3) << t;
    EXPECT_NEAR(again.poses[t].y, fit.poses[t].y, 2e-3) << t;
  }
}

TEST(MeanLoss, IsThatOfTheResiduals) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 11);
  const LayerFit fit = FitFromTruth(scene, stack);
  const double loss = MeanLoss(stack, fit, [](float level, float model) {
    return static_cast<double>((level - model) * (level - model));
  });
  // Rounding, too.
  EXPECT_NEAR(std::sqrt(loss), std::sqrt(1.0 + 1.0 / 12.0), 0.05);
}

// An outline that settled on the ground's edge, a pixel below the body.
TEST(AlignPoses, FindsABodyThatLiesBesideItsPose) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 5);
  const LayerFit fit = FitFromTruth(scene, stack);
  std::vector<LayerPose> poses = fit.poses;
  poses[3].y += 4.0;
  poses[8].x -= 4.0;
  EXPECT_GE(AlignPoses(stack, fit.layers, true, 1, poses), 1U);
  for (const std::size_t t : {std::size_t{3}, std::size_t{8}}) {
    EXPECT_NEAR(poses[t].x, scene.poses[t].x, 0.3);
    EXPECT_NEAR(poses[t].y, scene.poses[t].y, 0.3);
  }
}

TEST(AlignPose, ExplainsTheChangeWhereTheBodyIsAlone) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 5);
  const LayerFit fit = FitFromTruth(scene, stack);
  const LayerPose& there = fit.poses[3];
  EXPECT_GT(AlignPose(stack, 3, fit.layers, there, {}, true).explained, 0.95);
  // Where it is in the last picture, and in the fourth is not yet.
  const PoseFit gone =
      AlignPose(stack, 3, fit.layers, fit.poses.back(), {}, true);
  EXPECT_TRUE(gone.found);
  EXPECT_LT(gone.explained, 0.0);
}

TEST(FitLayers, DoesNotDependOnThreads) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 23);
  FitLayersOptions options = OptionsOf(scene);
  options.steps = 3;
  const std::vector<LayerPose> start = Shaken(scene.poses, 0.2);
  const std::vector<float> still = Paint(scene, nullptr);
  const LayerFit one =
      FitLayers(stack, scene.shape, start, still, 1.0, options);
  options.threads = 3;
  const LayerFit three =
      FitLayers(stack, scene.shape, start, still, 1.0, options);
  for (std::size_t t = 0; t < one.poses.size(); ++t) {
    EXPECT_EQ(one.poses[t].x, three.poses[t].x);
    EXPECT_EQ(one.poses[t].y, three.poses[t].y);
    EXPECT_EQ(one.poses[t].angle_rad, three.poses[t].angle_rad);
  }
}

// Windows of pictures that show `still` everywhere else, and the same pictures
// whole.
struct WindowedAndWhole {
  PictureStack windowed;
  PictureStack whole;
};
WindowedAndWhole FilmInWindows(const LayeredScene& scene,
                               const std::vector<float>& still) {
  const PictureStack seen = Film(scene, 31);
  WindowedAndWhole out;
  for (PictureStack* stack : {&out.windowed, &out.whole}) {
    stack->width = scene.width;
    stack->height = scene.height;
  }
  out.windowed.outside = still;
  const int room = 2 * static_cast<int>(0.5 * scene.shape.Reach()) + 12;
  for (std::size_t t = 0; t < seen.frames.size(); ++t) {
    const int left = static_cast<int>(scene.poses[t].x) / 2 * 2 - room;
    const int top = static_cast<int>(scene.poses[t].y) / 2 * 2 - room;
    core::PixelRect window;
    window.x = std::max(left, 0);
    window.y = std::max(top, 0);
    window.width = std::min(left + 2 * room, scene.width) - window.x;
    window.height = std::min(top + 2 * room, scene.height) - window.y;
    float* whole = out.whole.Add(seen.frames[t], seen.windows[t]);
    std::copy(still.begin(), still.end(), whole);
    float* windowed = out.windowed.Add(seen.frames[t], window);
    for (int y = window.y; y < window.y + window.height; ++y) {
      const float* const from = seen.WindowRow(t, y) + window.x;
      std::copy_n(from, window.width, whole + y * scene.width + window.x);
      windowed = std::copy_n(from, window.width, windowed);
    }
  }
  return out;
}

TEST(FitLayers, WindowsTellWhatWholePicturesTell) {
  const LayeredScene scene = BlockOnGround();
  const std::vector<float> still = Paint(scene, nullptr);
  const auto [windowed, whole] = FilmInWindows(scene, still);
  ASSERT_LT(windowed.levels.size(), whole.levels.size() * 2 / 3);
  const FitLayersOptions options = OptionsOf(scene);
  const std::vector<LayerPose> start = Shaken(scene.poses, 0.2);
  const LayerFit a =
      FitLayers(windowed, scene.shape, start, still, 1.0, options);
  const LayerFit b = FitLayers(whole, scene.shape, start, still, 1.0, options);
  for (std::size_t t = 0; t < a.poses.size(); ++t) {
    EXPECT_NEAR(a.poses[t].x, b.poses[t].x, 1e-4);
    EXPECT_NEAR(a.poses[t].y, b.poses[t].y, 1e-4);
    EXPECT_NEAR(a.poses[t].angle_rad, b.poses[t].angle_rad, 1e-5);
  }
  for (std::size_t x = 0; x < a.layers.still.size(); ++x) {
    EXPECT_NEAR(a.layers.still_weight[x], b.layers.still_weight[x],
                1e-3F * b.layers.still_weight[x] + 1e-3F);
  }
}

TEST(PictureStack, HalvedWindowsAreWindowsOfHalvedPictures) {
  const LayeredScene scene = BlockOnGround();
  const auto [windowed, whole] = FilmInWindows(scene, Paint(scene, nullptr));
  const PictureStack small = Halve(windowed, 1);
  const PictureStack large = Halve(whole, 1);
  ASSERT_EQ(small.width, large.width);
  for (std::size_t t = 0; t < small.frames.size(); ++t) {
    const core::PixelRect& window = small.windows[t];
    for (int y = window.y; y < window.y + window.height; ++y) {
      for (int x = 0; x < window.width; ++x) {
        EXPECT_EQ(small.WindowRow(t, y)[x],
                  large.WindowRow(t, y)[window.x + x]);
      }
    }
  }
}

TEST(Columns, SumsAreThoseOfALoop) {
  std::mt19937_64 engine(41);
  std::uniform_real_distribution<float> draw(-1.0F, 1.0F);
  for (const std::size_t rows :
       {std::size_t{0}, std::size_t{5}, std::size_t{8}, std::size_t{67}}) {
    constexpr std::size_t kCount = 6;
    std::vector<std::vector<float>> data(kCount);
    ColumnList columns{};
    std::array<float, kMostColumns> factors{};
    for (std::size_t c = 0; c < kCount; ++c) {
      for (std::size_t i = 0; i < rows; ++i) data[c].push_back(draw(engine));
      columns[c] = data[c].data();
      factors[c] = draw(engine);
    }
    std::vector<float> other;
    for (std::size_t i = 0; i < rows; ++i) other.push_back(draw(engine));
    std::array<double, kMostColumns> sums{};
    SumProducts(columns, kCount, other.data(), rows, sums);
    std::vector<float> added = other;
    AddColumns(columns, kCount, factors, rows, added.data());
    for (std::size_t c = 0; c < kCount; ++c) {
      double sum = 0.0;
      for (std::size_t i = 0; i < rows; ++i) {
        sum += static_cast<double>(data[c][i]) * static_cast<double>(other[i]);
      }
      EXPECT_NEAR(sums[c], sum, 1e-5);
    }
    for (std::size_t i = 0; i < rows; ++i) {
      float sum = other[i];
      for (std::size_t c = 0; c < kCount; ++c) sum += factors[c] * data[c][i];
      EXPECT_NEAR(added[i], sum, 1e-6F);
    }
  }
}

}  // namespace
}  // namespace touchdown::vision::layers
