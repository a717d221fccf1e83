// Draws the picture on a body's face (SceneFace): what it adds to the body's
// level, blurred together with the body's outline.
//
//   F(i, j) = integral m(x, y) T(R'(x - c)) K(x - i) K(y - j) dx dy
//
// with the body m, its picture T about its centre c, turned by R, and the
// kernel K of render.h. The product m T is sampled at the middles of kFine^2
// parts of each pixel, m as the exact share of the part. With K cut at 5.2
// sigma that is right to 3e-3 of T's standard deviation (sigma 0 or at least
// 0.4, correlation at least 2 px; tested).
#pragma once

#include <cstdint>
#include <vector>

#include "synthetic/coverage.h"
#include "touchdown/vision/synthetic/scene.h"

namespace touchdown::vision {

// T, of full scale, in the body's own frame.
class FacePicture {
 public:
  // Where the scene has a face: scene.look.face.
  explicit FacePicture(const Scene& scene);

  // At a point of the body, from its centre: px along the body's direction
  // (angle 0 is the direction of travel) and to its left (up).
  double At(double ahead_px, double up_px) const;

 private:
  double reach_px_ = 0.0;  // of the square that is known, from the centre
  int side_ = 0;           // points of that square's side
  std::vector<float> field_;
};

// F of the pixels of `window`. As CoverageMap: Add() any number of outlines,
// Finish() once, read.
class FaceMap {
 public:
  FaceMap(const SceneCamera& camera, core::PixelRect window);

  void Add(const FacePicture& picture, const ShapeOutline& outline,
           const ScenePose& pose, double weight);
  void Finish();

  const float* row(std::int32_t y) const;  // of window column 0

 private:
  SceneCamera camera_;
  core::PixelRect window_;
  core::PixelRect fine_window_;  // of the parts
  std::vector<float> fine_;
  std::vector<float> sum_;
};

}  // namespace touchdown::vision
