// The picture on a body's face against direct integration, and as it moves.
#include "vision/src/synthetic/render_face.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "touchdown/core/normal.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision {
namespace {

constexpr double kAmplitude = 0.1;

// A disc of 10 px before a wall; the ground is far below.
Scene PicturedDisc(double psf_px) {
  Scene scene;
  scene.body = core::Sphere({0.02, 0.0});
  scene.pose = [](double) { return ScenePose{{0.0, 0.09}, 0.4}; };
  scene.camera.width_px = 64;
  scene.camera.height_px = 60;
  scene.camera.ground_point = {31.7, 120.2};
  scene.camera.psf_sigma_px = psf_px;
  scene.camera.exposure_s = 0.0;
  scene.look.body_level = 0.5;
  scene.look.face = SceneFace{kAmplitude, 3.0, 7};
  return scene;
}

// What the face changes, of full scale.
double Change(const Scene& scene, std::int32_t x, std::int32_t y) {
  Scene plain = scene;
  plain.look.face.reset();
  return (static_cast<double>(RenderClean(scene, 0).at(x, y)) -
          static_cast<double>(RenderClean(plain, 0).at(x, y))) /
         255.0;
}

// The integral of render_face.h as a sum over points 1/20 px apart.
double Integral(const Scene& scene, std::int32_t x, std::int32_t y) {
  const FacePicture picture(scene);
  const double sigma = scene.camera.psf_sigma_px;
  const core::PixelPoint centre = ToImage(scene.camera, {0.0, 0.09});
  constexpr double kStep = 0.05;
  const auto kernel = [sigma](double d) {
    if (sigma == 0.0) return std::abs(d) < 0.5 ? 1.0 : 0.0;
    return core::NormalCdf((d + 0.5) / sigma) -
           core::NormalCdf((d - 0.5) / sigma);
  };
  const int reach = static_cast<int>((5.0 * sigma + 0.5) / kStep) + 1;
  double sum = 0.0;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      const double px = x + (i + 0.5) * kStep;
      const double py = y + (j + 0.5) * kStep;
      const double dx = px - centre.x_px;
      const double up = centre.y_px - py;
      if (std::hypot(dx, up) > 10.0) continue;
      sum += kernel(px - x) * kernel(py - y) *
             picture.At(dx * std::cos(0.4) + up * std::sin(0.4),
                        up * std::cos(0.4) - dx * std::sin(0.4));
    }
  }
  return sum * kStep * kStep;
}

TEST(RenderFace, IsTheIntegralOfOutlineAndPicture) {
  for (const double psf : {0.0, 0.5, 1.4}) {
    const Scene scene = PicturedDisc(psf);
    // Inside, at the rim and outside of it.
    for (const std::int32_t x : {31, 36, 41, 42, 44}) {
      // Without blur the sum's own steps at the rim count.
      EXPECT_NEAR(Change(scene, x, 31), Integral(scene, x, 31),
                  (psf == 0.0 ? 2e-2 : 3e-3) * kAmplitude)
          << psf << ' ' << x;
    }
  }
}

// A quarter turn about a pixel turns the frame.
TEST(RenderFace, TurnsWithTheBody) {
  Scene scene = PicturedDisc(0.8);
  scene.camera.ground_point = {31.0, 120.0};
  const auto at = [&](double angle) {
    scene.pose = [angle](double) { return ScenePose{{0.0, 0.09}, angle}; };
    return RenderClean(scene, 0);
  };
  const CleanImage before = at(0.0);
  const CleanImage after = at(0.5 * std::numbers::pi);
  for (std::int32_t right = -12; right <= 12; right += 3) {
    for (std::int32_t up = -12; up <= 12; up += 4) {
      EXPECT_NEAR(before.at(31 + right, 30 - up), after.at(31 - up, 30 - right),
                  1e-2)
          << right << ' ' << up;
    }
  }
}

// Seen from the other side it is its mirror image.
TEST(RenderFace, IsMirroredWithTheDirectionOfTravel) {
  Scene scene = PicturedDisc(0.8);
  scene.camera.ground_point = {31.0, 120.0};
  const CleanImage right = RenderClean(scene, 0);
  scene.camera.travels_left = true;
  const CleanImage left = RenderClean(scene, 0);
  for (std::int32_t x = -12; x <= 12; x += 3) {
    EXPECT_NEAR(right.at(31 + x, 28), left.at(31 - x, 28), 1e-2) << x;
  }
}

TEST(RenderFace, RefusedByName) {
  const auto refused = [](auto set) {
    Scene scene = PicturedDisc(0.8);
    set(scene);
    try {
      Validate(scene);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused([](Scene&) {}), "");
  EXPECT_NE(refused([](Scene& s) {
              s.look.face->correlation_px = 0.2;
            }).find("look.face.correlation_px"),
            std::string::npos);
  EXPECT_NE(refused([](Scene& s) {
              s.look.face->amplitude = 0.0;
            }).find("look.face.amplitude"),
            std::string::npos);
  EXPECT_NE(refused([](Scene& s) {
              s.camera.lens = calib::Lens{900.0, 900.0, 32.0, 30.0, -0.01,
                                          0.0,   0.0,   0.0,  0.0};
            }).find("absent where there is a lens"),
            std::string::npos);
}

}  // namespace
}  // namespace touchdown::vision
