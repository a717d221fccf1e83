// Pictures of a body before a still scene, made the long way: what is seen is
// painted sharp on a grid of sixth pixels, blurred there and averaged over each
// pixel. Nothing is shared with what is tested.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "vision/src/layers/layer_model.h"

namespace touchdown::vision::layers {

struct LayeredScene {
  std::int32_t width = 90;
  std::int32_t height = 64;
  Shape shape{false, 15.0, 7.0};
  double psf_px = 0.9;
  double noise_dn = 1.0;
  std::function<double(double x, double y)> still = [](double, double) {
    return 180.0;
  };
  // In the body's coordinates.
  std::function<double(double x, double y)> body = [](double, double) {
    return 60.0;
  };
  std::vector<LayerPose> poses;
};

inline bool Covers(const Shape& shape, double x, double y) {
  return shape.disc
             ? std::hypot(x, y) < shape.half_long
             : std::abs(x) < shape.half_long && std::abs(y) < shape.half_short;
}

inline std::vector<float> BlurRows(const std::vector<float>& from, int columns,
                                   int rows, double sigma) {
  const int reach = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += weights.back();
  }
  // Transposed, so that a second call blurs the other direction.
  std::vector<float> to(from.size());
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      double value = 0.0;
      for (int k = -reach; k <= reach; ++k) {
        const int at = std::min(columns - 1, std::max(0, x + k));
        value += weights[static_cast<std::size_t>(k + reach)] *
                 static_cast<double>(
                     from[static_cast<std::size_t>(y * columns + at)]);
      }
      to[static_cast<std::size_t>(x * rows + y)] =
          static_cast<float>(value / sum);
    }
  }
  return to;
}

// One picture; `pose` null: the still scene alone.
inline std::vector<float> Paint(const LayeredScene& scene,
                                const LayerPose* pose) {
  constexpr int kFine = 6;
  const int columns = scene.width * kFine;
  const int rows = scene.height * kFine;
  std::vector<float> fine(static_cast<std::size_t>(columns) *
                          static_cast<std::size_t>(rows));
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double x = (i + 0.5) / kFine - 0.5;
      const double y = (j + 0.5) / kFine - 0.5;
      double level = scene.still(x, y);
      if (pose != nullptr) {
        const double cosine = std::cos(pose->angle_rad);
        const double sine = std::sin(pose->angle_rad);
        const double dx = x - pose->x;
        const double dy = y - pose->y;
        const double u = cosine * dx + sine * dy;
        const double v = cosine * dy - sine * dx;
        if (Covers(scene.shape, u, v)) level = scene.body(u, v);
      }
      fine[static_cast<std::size_t>(j * columns + i)] =
          static_cast<float>(level);
    }
  }
  const double sigma = scene.psf_px * kFine;
  fine = BlurRows(BlurRows(fine, columns, rows, sigma), rows, columns, sigma);
  std::vector<float> picture;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      double sum = 0.0;
      for (int j = 0; j < kFine; ++j) {
        for (int i = 0; i < kFine; ++i) {
          sum += static_cast<double>(fine[static_cast<std::size_t>(
              (y * kFine + j) * columns + x * kFine + i)]);
        }
      }
      picture.push_back(static_cast<float>(sum / (kFine * kFine)));
    }
  }
  return picture;
}

inline PictureStack Film(const LayeredScene& scene, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<float> noise(0.0F,
                                        static_cast<float>(scene.noise_dn));
  PictureStack stack;
  stack.width = scene.width;
  stack.height = scene.height;
  for (std::size_t t = 0; t < scene.poses.size(); ++t) {
    float* to = stack.Add(static_cast<std::int64_t>(t),
                          {0, 0, scene.width, scene.height});
    stack.times_s.back() = 1e-3 * static_cast<double>(t);
    for (const float level : Paint(scene, &scene.poses[t])) {
      *to++ = level + noise(engine);
    }
  }
  return stack;
}

// A block that comes down on a dark ground, lies there and slides on. All is
// rolled a little: edges along the painter's rows would be rounded to them.
inline LayeredScene BlockOnGround() {
  constexpr double kRoll = 0.037;
  constexpr double kGround_px = 38.3;
  const double cosine = std::cos(kRoll);
  const double sine = std::sin(kRoll);
  LayeredScene scene;
  scene.still = [=](double x, double y) {
    return cosine * (y - kGround_px) - sine * x > 0.0 ? 110.0 : 190.0;
  };
  for (int t = 0; t < 36; ++t) {
    const double along = 20.0 + 1.37 * t;
    const double above =
        scene.shape.half_short + std::max(0.0, 0.73 * (18 - t));
    scene.poses.push_back({cosine * along + sine * above,
                           kGround_px + sine * along - cosine * above, kRoll});
  }
  return scene;
}

}  // namespace touchdown::vision::layers
