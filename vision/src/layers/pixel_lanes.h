// The model at some pixels of a row together, in vector instructions: each
// number is a column of lanes (numbers/lanes.h).
#pragma once

#include <array>
#include <cstddef>

#include "layers/layer_model.h"

namespace touchdown::vision::layers {

// One place of the body in an exposure.
struct Placed {
  float x = 0.0F;
  float y = 0.0F;
  float cosine = 1.0F;
  float sine = 0.0F;
  float weight = 1.0F;
  float tau = 0.0F;
};

// So many pixels of a row are taken together.
inline constexpr std::size_t kChunk = 32;
using Lanes = std::array<float, kChunk>;

// Below it a pixel shows nothing of the body.
inline constexpr float kLeastCover = 2e-4F;

// What does not change along a row, of one place of the exposure.
struct NodeNumbers {
  Placed at;
  float down = 0.0F;  // from the place to the row, px
  float blur2 = 0.0F;
  float twice_blur = 0.0F;
  float per_reach = 0.0F;
  float per_exposure = 0.0F;  // of d e by d e^2
  float slope_x = 0.0F;
  float slope_y = 0.0F;
  float v_x = 0.0F;
  float v_y = 0.0F;
  float v_turn = 0.0F;
  bool flat = true;
  std::array<float, kTerms> quadratic{};
};

// Pixels as one place of the exposure sees them, by columns. Pixels that it
// does not see have zeros.
struct alignas(64) NodeLanes {
  Lanes right, x, y;  // from the place, and in the body's coordinates
  Lanes cover, by_x, by_y, by_blur, by_long, by_short;  // CoverAt
  Lanes tilt, tilt_x, tilt_y;                           // PictureGrid::Tilt
  // The slope at the middle of the exposure less that here, where derivatives
  // by T are those at the middle: a pose and T that move together change
  // nothing, in these derivatives too.
  Lanes middle_x, middle_y;
  Lanes product, product_x, product_y;  // Product
  Lanes still_x, still_y;               // B's slope where it is smooth, else 0
};

// Pixels, by columns: sums over the places of the exposure.
struct alignas(64) PixelLanes {
  Lanes behind;   // B
  Lanes covered;  // sum of w M
  Lanes model;
  std::array<Lanes, kPose> by_pose;
  std::array<Lanes, kShared> by_shared;
  Lanes residual, weight;
};

// A flat T and its slope.
void EvaluateFlat(const NodeNumbers& node, NodeLanes& seen);

// Adds one place of the exposure: the model and its derivatives by the pose;
// with `all`, by the shared numbers, too.
void AddNode(const NodeNumbers& node, const NodeLanes& seen, bool all,
             PixelLanes& sums);

// What is left of the levels, once all places are added.
void FinishPixels(const Lanes& levels, float noise_dn, PixelLanes& sums);

}  // namespace touchdown::vision::layers
