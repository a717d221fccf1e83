#include "touchdown/vision/synthetic/render.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "touchdown/core/units.h"

namespace touchdown::vision {
namespace {

using namespace core::literals;  // NOLINT
constexpr double kPi = std::numbers::pi;

// A scene without ground (it lies far below the picture), 1000 px a metre, so
// that millimetres are pixels; pose given in image pixels.
Scene PlainScene(int width, int height, core::Body body, double x_px,
                 double y_px, double angle_rad = 0.0) {
  Scene scene;
  scene.camera.width_px = width;
  scene.camera.height_px = height;
  scene.camera.ground_point = {0.0, 1e4};
  scene.camera.bit_depth = 12;
  scene.body = std::move(body);
  scene.pose = [=](double) {
    return ScenePose{{1e-3 * x_px, 1e-3 * (1e4 - y_px)}, angle_rad};
  };
  return scene;
}

core::Body Disc(double radius_px) {
  return core::Sphere({2e-3 * radius_px, 0.0});
}

// Zeroth and first moments of what the body changes, in units of its contrast.
struct Moments {
  double area = 0.0, x = 0.0, y = 0.0;
};
Moments BodyMoments(const SceneRenderer& renderer, std::int64_t index = 0) {
  const CleanImage image = renderer.RenderClean(index);
  const CleanImage& empty = renderer.background();
  const Scene& scene = renderer.scene();
  const double contrast = ((1 << scene.camera.bit_depth) - 1) *
                          (scene.look.body_level - scene.look.background_level);
  Moments m;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      const double covered =
          (static_cast<double>(image.at(x, y)) - empty.at(x, y)) / contrast;
      m.area += covered;
      m.x += covered * x;
      m.y += covered * y;
    }
  }
  m.x /= m.area;
  m.y /= m.area;
  return m;
}

TEST(Render, DiscHasItsCentroidAndArea) {
  for (const double sigma : {0.0, 0.1, 0.3, 0.5, 0.7, 1.5, 4.0}) {
    for (const double radius : {2.0, 4.3, 20.0, 60.0}) {
      for (const double shift : {0.0, 0.137, 0.5, 0.861}) {
        const int size = static_cast<int>(2.0 * (radius + 6.0 * sigma) + 12);
        const double x = 0.5 * size + shift;
        const double y = 0.5 * size - 0.37 * shift;
        Scene scene = PlainScene(size, size, Disc(radius), x, y);
        scene.camera.psf_sigma_px = sigma;
        const Moments m = BodyMoments(SceneRenderer(scene));
        const double area = kPi * radius * radius;
        EXPECT_NEAR(m.area / area, 1.0, 1e-4)
            << "sigma " << sigma << " radius " << radius;
        // The centroid of samples is that of the scene only where the blur
        // suppresses what the pixel grid cannot carry (sampling theorem).
        if (sigma < 0.5) continue;
        EXPECT_NEAR(m.x, x, 1e-4) << "sigma " << sigma << " radius " << radius;
        EXPECT_NEAR(m.y, y, 1e-4) << "sigma " << sigma << " radius " << radius;
      }
    }
  }
}

TEST(Render, RectangleHasItsCentroidAndArea) {
  for (const double sigma : {0.0, 0.1, 0.5, 0.7, 2.0}) {
    for (const double angle : {0.0, 7.8_deg, 45.0_deg, 90.0_deg, 131.0_deg}) {
      Scene scene =
          PlainScene(90, 90, core::Rectangle({40.0_mm, 0.0}, {13.0_mm, 0.0}),
                     44.29, 45.61, angle);
      scene.camera.psf_sigma_px = sigma;
      const Moments m = BodyMoments(SceneRenderer(scene));
      EXPECT_NEAR(m.area / (40.0 * 13.0), 1.0, 1e-4) << sigma << " " << angle;
      if (sigma < 0.5) continue;  // as above
      EXPECT_NEAR(m.x, 44.29, 1e-4) << sigma << " " << angle;
      EXPECT_NEAR(m.y, 45.61, 1e-4) << sigma << " " << angle;
    }
  }
}

// Without blur a pixel is the covered part of its square: by 1000 x 1000
// points.
TEST(Render, WithoutBlurAPixelIsItsCoveredArea) {
  const double radius = 3.3;
  const double cx = 6.21;
  const double cy = 5.83;
  Scene scene = PlainScene(13, 13, Disc(radius), cx, cy);
  scene.camera.psf_sigma_px = 0.0;
  const SceneRenderer renderer(scene);
  const CleanImage image = renderer.RenderClean(0);
  constexpr int kPoints = 1000;
  for (const auto& [x, y] : {std::pair{3, 5}, {4, 4}, {8, 8}, {6, 9}, {6, 6}}) {
    int inside = 0;
    for (int j = 0; j < kPoints; ++j) {
      for (int i = 0; i < kPoints; ++i) {
        const double u = x - 0.5 + (i + 0.5) / kPoints - cx;
        const double v = y - 0.5 + (j + 0.5) / kPoints - cy;
        inside += u * u + v * v < radius * radius;
      }
    }
    const double expected = inside / (1.0 * kPoints * kPoints);
    const double seen = (image.at(x, y) - renderer.background().at(x, y)) /
                        (4095.0 * (0.15 - 0.65));
    EXPECT_NEAR(seen, expected, 2e-5) << x << "," << y;
  }
}

// Integral of the normal distribution function: the profile of a straight edge
// blurred by sigma and averaged over a pixel is [F(t + 1/2) - F(t - 1/2)].
double F(double t, double sigma) {
  return t * 0.5 * std::erfc(-t / (sigma * std::sqrt(2.0))) +
         sigma / std::sqrt(2.0 * kPi) *
             std::exp(-0.5 * t * t / (sigma * sigma));
}

TEST(Render, EdgeProfileIsErfOverABox) {
  for (const double sigma : {0.1, 0.4, 0.7, 1.3}) {
    for (const double edge : {30.0, 30.25, 30.5, 30.83}) {
      // A rectangle of 40 x 60 px whose right side lies at x = edge.
      Scene scene =
          PlainScene(60, 80, core::Rectangle({60.0_mm, 0.0}, {40.0_mm, 0.0}),
                     edge - 20.0, 40.0, 90.0_deg);
      scene.camera.psf_sigma_px = sigma;
      const CleanImage image = SceneRenderer(scene).RenderClean(0);
      for (int x = 20; x < 45; ++x) {
        const double covered =
            (image.at(x, 40) / 4095.0 - 0.65) / (0.15 - 0.65);
        const double t = edge - x;
        EXPECT_NEAR(covered, F(t + 0.5, sigma) - F(t - 0.5, sigma), 1e-5)
            << "sigma " << sigma << " edge " << edge << " x " << x;
      }
    }
  }
}

// Along the normal of an oblique edge the profile is the erf of
// sqrt(sigma^2 + 1/12): the pixel's box has the variance 1/12 in any direction.
TEST(Render, ObliqueEdgeProfileIsNearlyErf) {
  const double sigma = 0.8;
  const double angle = 31.0_deg;
  Scene scene =
      PlainScene(120, 120, core::Rectangle({80.0_mm, 0.0}, {60.0_mm, 0.0}),
                 60.0, 60.0, angle);
  scene.camera.psf_sigma_px = sigma;
  const CleanImage image = SceneRenderer(scene).RenderClean(0);
  const double wide = std::sqrt(sigma * sigma + 1.0 / 12.0);
  double worst = 0.0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) {
      const double dx = x - 60.0;
      const double dy = -(y - 60.0);
      const double along = dx * std::cos(angle) + dy * std::sin(angle);
      const double across = -dx * std::sin(angle) + dy * std::cos(angle);
      if (std::abs(along) > 30.0 || across < 0.0) continue;
      const double covered = (image.at(x, y) / 4095.0 - 0.65) / (0.15 - 0.65);
      const double expected =
          0.5 * std::erfc((across - 30.0) / (wide * std::sqrt(2.0)));
      worst = std::max(worst, std::abs(covered - expected));
    }
  }
  EXPECT_LT(worst, 1e-3);
}

TEST(Render, ExposureBlurIsTheMeanOverTheExposure) {
  for (const double motion_px : {0.02, 0.3, 1.0, 3.7, 25.0}) {
    Scene scene = PlainScene(80, 40, Disc(8.0), 0.0, 0.0);
    const double speed = 1e-3 * motion_px / scene.camera.exposure_s;
    scene.pose = [=](double t) {
      return ScenePose{{0.0402 + speed * t, 1e-3 * (1e4 - 19.7)}, 0.0};
    };
    const CleanImage seen = SceneRenderer(scene).RenderClean(0);
    // 401 sharp pictures by the trapezoid rule.
    Scene sharp = scene;
    sharp.camera.exposure_s = 0.0;
    std::vector<double> mean(seen.dn.size());
    constexpr int kSteps = 400;
    const PoseFunction pose = scene.pose;
    double instant = 0.0;
    sharp.pose = [&](double) { return pose(instant); };
    const SceneRenderer renderer(sharp);
    for (int k = 0; k <= kSteps; ++k) {
      instant = scene.camera.exposure_s * (1.0 * k / kSteps - 0.5);
      const CleanImage one = renderer.RenderClean(0);
      const double weight = (k == 0 || k == kSteps ? 0.5 : 1.0) / kSteps;
      for (std::size_t i = 0; i < mean.size(); ++i) {
        mean[i] += weight * one.dn[i];
      }
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < mean.size(); ++i) {
      worst = std::max(worst, std::abs(mean[i] - seen.dn[i]));
    }
    EXPECT_LT(worst / (0.5 * 4095.0), 1e-4) << motion_px << " px";
  }
}

TEST(Render, RolledAndMirroredBodiesAreWhereTheTruthSays) {
  for (const bool left : {false, true}) {
    for (const double roll : {-4.0_deg, 9.0_deg}) {
      Scene scene;
      scene.camera.travels_left = left;
      scene.camera.roll_rad = roll;
      scene.camera.psf_sigma_px = 0.8;
      scene.camera.bit_depth = 12;
      scene.body = core::Sphere({40.0_mm, 0.0});
      scene.pose = [](double t) {
        return ScenePose{{-0.05 + 2.0 * t, 0.08 - 1.0 * t}, 0.0};
      };
      const SceneRenderer renderer(scene);
      for (const std::int64_t index : {0, 30}) {
        const SceneTruth truth = ComputeTruth(scene, index);
        const Moments m = BodyMoments(renderer, index);
        EXPECT_NEAR(m.x, truth.centre.x_px, 1e-4);
        EXPECT_NEAR(m.y, truth.centre.y_px, 1e-4);
        EXPECT_NEAR(m.area, kPi * truth.radius_px * truth.radius_px, 0.1);
      }
    }
  }
}

TEST(Render, GroundEdgeLiesOnTheLine) {
  for (const double sigma : {0.0, 0.7}) {
    for (const double roll : {0.0, 1.0_deg, -30.0_deg}) {
      Scene scene;
      scene.camera.roll_rad = roll;
      scene.camera.psf_sigma_px = sigma;
      scene.camera.bit_depth = 16;
      scene.camera.ground_point = {300.0, 200.3};
      scene.body = Disc(5.0);
      scene.pose = [](double) { return ScenePose{{0.0, 50.0}, 0.0}; };
      const CleanImage image = SceneRenderer(scene).RenderClean(0);
      const calib::GroundLine ground = TrueGroundLine(scene.camera);
      // A column's sum tells where the edge crosses it.
      for (const int x : {250, 300, 347}) {
        double covered = 0.0;
        for (int y = 0; y < image.height_px; ++y) {
          covered += (image.at(x, y) / 65535.0 - 0.65) / (0.40 - 0.65);
        }
        const double edge = image.height_px - 0.5 - covered;
        EXPECT_NEAR(calib::HeightAboveLine(ground, {1.0 * x, edge}), 0.0, 1e-4);
      }
    }
  }
}

TEST(Render, TheBodyHidesBackgroundAndGround) {
  Scene scene;
  scene.look.texture_amplitude = 0.1;
  scene.look.gradient_x = 0.2;
  scene.look.gradient_y = -0.3;
  scene.body = core::Rectangle({80.0_mm, 0.0}, {60.0_mm, 0.0});
  scene.pose = [](double) { return ScenePose{{0.0, 0.005}, 20.0_deg}; };
  const SceneRenderer renderer(scene);
  const CleanImage image = renderer.RenderClean(0);
  const auto light = [](int x, int y) {
    return 255.0 * (1.0 + 0.2 * (x / 639.0 - 0.5) - 0.3 * (y / 399.0 - 0.5));
  };
  // Near the body's centre, on both sides of the ground line (y = 330).
  for (int y = 310; y <= 340; ++y) {
    for (int x = 305; x <= 335; ++x) {
      EXPECT_NEAR(image.at(x, y), 0.15 * light(x, y), 1e-3) << x << "," << y;
    }
  }
  EXPECT_EQ(image.at(10, 390), renderer.background().at(10, 390));
}

TEST(Render, ABodyPartlyOutsideThePictureIsCutNotMoved) {
  for (const double sigma : {0.0, 0.7}) {
    Scene large = PlainScene(120, 120, Disc(25.0), 60.3, 59.2);
    large.camera.psf_sigma_px = sigma;
    const CleanImage whole = SceneRenderer(large).RenderClean(0);
    for (const auto& [left, top] :
         {std::pair{50, 40}, {20, 70}, {70, 20}, {80, 80}, {20, 20}}) {
      Scene crop = PlainScene(40, 40, Disc(25.0), 60.3 - left, 59.2 - top);
      crop.camera.psf_sigma_px = sigma;
      const CleanImage part = SceneRenderer(crop).RenderClean(0);
      double worst = 0.0;
      for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x) {
          worst = std::max<double>(
              worst, std::abs(part.at(x, y) - whole.at(x + left, y + top)));
        }
      }
      EXPECT_LT(worst / 4095.0, 1e-6) << left << "," << top;
    }
    for (const double far : {-1e5, -40.0, 160.0, 1e12}) {
      Scene gone = PlainScene(40, 40, Disc(25.0), far, 20.0);
      gone.camera.psf_sigma_px = sigma;
      const SceneRenderer renderer(gone);
      EXPECT_EQ(renderer.RenderClean(0).dn, renderer.background().dn) << far;
    }
  }
}

TEST(Render, TextureHasItsAmplitudeAndCorrelation) {
  Scene scene;
  scene.camera.ground_point = {0.0, -100.0};  // ground everywhere
  scene.look.texture_amplitude = 0.2;
  scene.look.texture_correlation_px = 3.0;
  scene.body = Disc(1.0);
  scene.pose = [](double) { return ScenePose{{0.0, 50.0}, 0.0}; };
  const SceneRenderer renderer(scene);
  const CleanImage& image = renderer.background();
  double squares = 0.0;
  double products = 0.0;
  int count = 0;
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x + 3 < 640; ++x) {
      const double a = image.at(x, y) / (255.0 * 0.40) - 1.0;
      const double b = image.at(x + 3, y) / (255.0 * 0.40) - 1.0;
      squares += a * a;
      products += a * b;
      ++count;
    }
  }
  // About 640 * 400 / (4 pi 3^2 / 2) = 4500 independent cells: 1 % of sd.
  EXPECT_NEAR(std::sqrt(squares / count), 0.2, 0.01);
  EXPECT_NEAR(products / squares, std::exp(-0.5), 0.03);
  Scene other = scene;
  other.look.texture_seed = 2;
  EXPECT_NE(SceneRenderer(other).background().dn, image.dn);
  EXPECT_EQ(SceneRenderer(scene).background().dn, image.dn);
}

TEST(AddSensorNoise, HasItsMeanVarianceAndTails) {
  CleanImage image{1000, 500, std::vector<float>(500000, 400.0f)};
  std::mt19937_64 engine(7);
  AddSensorNoise(image, {3.0, 0.04}, engine);
  const double sd = std::sqrt(9.0 + 0.04 * 400.0);  // 5 DN
  double mean = 0.0;
  for (const float v : image.dn) mean += v / 5e5;
  double m2 = 0.0;
  double m4 = 0.0;
  int beyond3 = 0;
  int beyond4 = 0;
  for (const float v : image.dn) {
    const double z = (v - mean) / sd;
    m2 += z * z / 5e5;
    m4 += z * z * z * z / 5e5;
    beyond3 += std::abs(z) > 3.0;
    beyond4 += std::abs(z) > 4.0;
  }
  EXPECT_NEAR(mean, 400.0, 5.0 * sd / std::sqrt(5e5));
  EXPECT_NEAR(m2, 1.0, 5.0 * std::sqrt(2.0 / 5e5));
  EXPECT_NEAR(m4, 3.0, 5.0 * std::sqrt(96.0 / 5e5));
  EXPECT_NEAR(beyond3, 0.0026998 * 5e5, 5.0 * std::sqrt(0.0027 * 5e5));
  EXPECT_NEAR(beyond4, 6.334e-5 * 5e5, 5.0 * std::sqrt(6.334e-5 * 5e5));
}

TEST(AddSensorNoise, NeighboursAreIndependent) {
  CleanImage image{1000, 200, std::vector<float>(200000, 0.0f)};
  std::mt19937_64 engine(8);
  AddSensorNoise(image, {1.0, 0.0}, engine);
  double next = 0.0;
  double next_size = 0.0;
  for (std::size_t i = 0; i + 1 < image.dn.size(); ++i) {
    const double a = image.dn[i];
    const double b = image.dn[i + 1];
    next += a * b;
    next_size += (std::abs(a) - 0.7979) * (std::abs(b) - 0.7979);
  }
  EXPECT_NEAR(next / 2e5, 0.0, 5.0 / std::sqrt(2e5));
  EXPECT_NEAR(next_size / 2e5, 0.0, 5.0 * 0.3634 / std::sqrt(2e5));
}

TEST(Quantize, RoundsAndClips) {
  const CleanImage image{6, 1, {-3.0f, 0.49f, 0.51f, 254.6f, 255.4f, 9999.0f}};
  const SensorImage eight = Quantize(image, 8);
  const std::vector<std::uint32_t> expected{0, 0, 1, 255, 255, 255};
  for (int x = 0; x < 6; ++x) {
    EXPECT_EQ(eight.view().at(x, 0), expected[static_cast<std::size_t>(x)]);
  }
  const SensorImage twelve = Quantize(image, 12);
  EXPECT_TRUE(twelve.view().is_16_bit());
  EXPECT_EQ(twelve.view().at(3, 0), 255u);
  EXPECT_EQ(twelve.view().at(5, 0), 4095u);
  EXPECT_THROW(Quantize(image, 0), std::invalid_argument);
}

TEST(OpenScene, IsAClipWhoseFramesDoNotDependOnReadingOrder) {
  Scene scene = PlainScene(64, 48, Disc(9.0), 20.0, 20.0);
  scene.frames = 5;
  scene.noise.read_dn = 20.0;
  scene.pose = [](double t) {
    return ScenePose{{0.020 + 4.0 * t, 1e-3 * (1e4 - 20.0)}, 0.0};
  };
  const auto forward = OpenScene(scene, 11);
  const auto random = OpenScene(scene, 11);
  const auto other = OpenScene(scene, 12);
  EXPECT_EQ(forward->info().frames, 5);
  EXPECT_EQ(forward->info().bit_depth, 12);
  EXPECT_TRUE(forward->info().time_base.trusted);
  int same = 0;
  for (const std::int64_t i : {0, 1, 2, 3, 4}) {
    const core::Frame a = forward->Read(i);
    const std::uint32_t value = a.at(30, 20);
    EXPECT_EQ(a.index, i);
    EXPECT_DOUBLE_EQ(a.time_s, static_cast<double>(i) / 2000.0);
    EXPECT_EQ(random->Read(4 - i).index, 4 - i);
    const core::Frame window = random->Read(i, {25, 18, 10, 10});
    EXPECT_EQ(window.at(5, 2), value);
    EXPECT_EQ(window.origin_x_px, 25);
    same += other->Read(i).at(30, 20) == value;
  }
  EXPECT_LT(same, 5);
  EXPECT_THROW(forward->Read(5), std::invalid_argument);
}

TEST(Render, APoseThatIsNotFiniteIsRefused) {
  Scene scene = PlainScene(20, 20, Disc(3.0), 10.0, 10.0);
  scene.pose = [](double) { return ScenePose{{std::nan(""), 0.0}, 0.0}; };
  EXPECT_THROW(SceneRenderer(scene).RenderClean(0), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::vision
