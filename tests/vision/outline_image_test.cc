#include "vision/src/outline/outline_image.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "touchdown/core/normal.h"

namespace touchdown::vision {
namespace {

struct Points {
  std::array<double, kBlock> x;
  std::array<double, kBlock> y;
};

// Places in and around a body at (30, 20).
Points Around(double reach_px) {
  Points points;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double r = reach_px * static_cast<double>(i + 1) / kBlock;
    const double phi = 2.4 * static_cast<double>(i);  // nowhere twice
    points.x[i] = 30.0 + r * std::cos(phi);
    points.y[i] = 20.0 + r * std::sin(phi);
  }
  return points;
}

struct Shape {
  std::string name;
  Outline outline;
  double blur_px = 1.0;
  double open = 0.0;
  core::PixelPoint travel_px{0.0, 0.0};
  double turn_rad = 0.0;
};

std::array<Shape, 8> Shapes() {
  Outline disc;
  disc.centre = {30.3, 19.8};
  disc.radius_px = 12.0;
  Outline small = disc;
  small.radius_px = 3.0;
  Outline block;
  block.kind = core::BodyKind::kRectangle;
  block.centre = disc.centre;
  block.half_long_px = 11.0;
  block.half_short_px = 6.0;
  block.angle_rad = 0.4;
  // Sharp: by a lens of 0.5 px.
  return {{{"disc", disc, 1.1, 0.0, {0.0, 0.0}, 0.0},
           {"sharp disc", disc, 0.577, 0.0, {0.0, 0.0}, 0.0},
           {"sharp block", block, 0.577, 0.0, {0.0, 0.0}, 0.0},
           {"moving disc", disc, 1.1, 0.5, {4.0, 2.0}, 0.0},
           {"small disc", small, 1.1, 0.0, {0.0, 0.0}, 0.0},
           {"small moving disc", small, 1.1, 0.5, {4.0, 2.0}, 0.0},
           {"block", block, 1.1, 0.0, {0.0, 0.0}, 0.0},
           {"turning block", block, 1.1, 0.5, {4.0, 2.0}, 0.5}}};
}

CoverBlock ComputeCover(const Shape& shape, const Points& points) {
  Smear smear(shape.travel_px, shape.turn_rad, 12.0);
  smear.Set(shape.blur_px, shape.open, shape.open > 0.0);
  CoverBlock cover;
  OutlineImage(shape.outline, smear)
      .Cover(points.x.data(), points.y.data(), cover);
  return cover;
}

// The blurred body at rest by a sum over strips of it, along each of which the
// blur is integrated in closed form.
double ByStrips(const Outline& o, double w, double x, double y) {
  const double c = std::cos(o.angle_rad), s = std::sin(o.angle_rad);
  const double dx = x - o.centre.x_px, dy = y - o.centre.y_px;
  const bool disc = o.kind == core::BodyKind::kSphere;
  const double u = disc ? dx : dx * c + dy * s;
  const double v = disc ? dy : dy * c - dx * s;
  const double half = disc ? o.radius_px : o.half_short_px;
  constexpr int kStrips = 1000;
  double sum = 0.0;
  for (int i = 0; i < kStrips; ++i) {
    const double at = half * (2.0 * (i + 0.5) / kStrips - 1.0);
    const double reach =
        disc ? std::sqrt(half * half - at * at) : o.half_long_px;
    const double z = (v - at) / w;
    sum += std::exp(-0.5 * z * z) * (core::NormalCdf((u + reach) / w) -
                                     core::NormalCdf((u - reach) / w));
  }
  return sum * 2.0 * half / kStrips / (w * std::sqrt(2.0 * std::numbers::pi));
}

// The mean over a pixel's square, whose variance of 1/12 is part of w.
double OverPixel(const Outline& o, double w, double x, double y) {
  constexpr std::array<double, 3> kNode = {-0.3872983346207417, 0.0,
                                           0.3872983346207417};
  constexpr std::array<double, 3> kWeight = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  const double lens = std::sqrt(w * w - 1.0 / 12.0);
  double mean = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      mean += kWeight[i] * kWeight[j] *
              ByStrips(o, lens, x + kNode[i], y + kNode[j]);
    }
  }
  return mean;
}

TEST(OutlineImage, IsTheMeanOfTheBlurredBodyOverThePixelAndAlongItsWay) {
  const Points points = Around(18.0);
  for (const Shape& shape : Shapes()) {
    const CoverBlock cover = ComputeCover(shape, points);
    for (std::size_t i = 0; i < kBlock; i += 3) {
      const int kPlaces = shape.open > 0.0 ? 40 : 1;
      double mean = 0.0;
      for (int k = 0; k < kPlaces; ++k) {
        const double s = shape.open * ((k + 0.5) / kPlaces - 0.5);
        Outline there = shape.outline;
        there.centre.x_px += s * shape.travel_px.x_px;
        there.centre.y_px += s * shape.travel_px.y_px;
        there.angle_rad += s * shape.turn_rad;
        mean +=
            OverPixel(there, shape.blur_px, points.x[i], points.y[i]) / kPlaces;
      }
      // 3e-4: the series of a disc; 1.5e-3: turning in steps of 0.7 w.
      EXPECT_NEAR(cover.value[i], mean, shape.turn_rad != 0.0 ? 1.5e-3 : 4e-4)
          << shape.name << " at " << points.x[i] << ", " << points.y[i];
    }
  }
}

TEST(OutlineImage, DerivativesAreThoseOfTheValue) {
  constexpr double kStep = 1e-4;
  const Points points = Around(18.0);
  for (const Shape& shape : Shapes()) {
    const CoverBlock cover = ComputeCover(shape, points);
    const auto expect = [&](const std::string& by, const BlockColumn& d,
                            double tolerance, const auto& change) {
      Shape less = shape;
      Shape more = shape;
      change(less, -kStep);
      change(more, kStep);
      const CoverBlock low = ComputeCover(less, points);
      const CoverBlock high = ComputeCover(more, points);
      for (std::size_t i = 0; i < kBlock; ++i) {
        EXPECT_NEAR(d[i], (high.value[i] - low.value[i]) / (2.0 * kStep),
                    tolerance)
            << shape.name << " by " << by << ", pixel " << i;
      }
    };
    // 1e-3: the table of small discs, and the normal distribution to 7.5e-8.
    expect("x", cover.d_shape[0], 2e-3,
           [](Shape& s, double step) { s.outline.centre.x_px += step; });
    expect("y", cover.d_shape[1], 2e-3,
           [](Shape& s, double step) { s.outline.centre.y_px += step; });
    expect("blur", cover.d_blur, 5e-3,
           [](Shape& s, double step) { s.blur_px += step; });
    if (shape.open > 0.0) {
      expect("open share", cover.d_open, 1e-2,
             [](Shape& s, double step) { s.open += step; });
    }
    if (shape.outline.kind == core::BodyKind::kSphere) {
      expect("radius", cover.d_shape[2], 4e-3,
             [](Shape& s, double step) { s.outline.radius_px += step; });
      continue;
    }
    expect("long side", cover.d_shape[2], 2e-3,
           [](Shape& s, double step) { s.outline.half_long_px += step; });
    expect("short side", cover.d_shape[3], 2e-3,
           [](Shape& s, double step) { s.outline.half_short_px += step; });
    expect("angle", cover.d_shape[4], 1e-2,
           [](Shape& s, double step) { s.outline.angle_rad += step; });
  }
}

}  // namespace
}  // namespace touchdown::vision
