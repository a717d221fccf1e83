// Frames of a scene: the tracker's inverse.
//
// A pixel is the integral of the scene over its square (centre at integers)
// after a Gaussian blur, i.e. every edge is convolved with box * Gaussian:
//   I(i, j) = integral S(x, y) K(x - i) K(y - j) dx dy,
//   K(t) = Phi((t + 1/2) / sigma) - Phi((t - 1/2) / sigma)
// which Green's theorem turns into a line integral around the outline,
//   I(i, j) = contour integral Q(x - i) K(y - j) dy,   Q' = K.
// It is evaluated by quadrature to 2e-6 of the contrast (sigma >= 0.1) or, for
// sigma = 0, in closed form: the exact area of disc or polygon in each pixel.
// The body is opaque: ground and background behind it are hidden.
//
// Exposure blur is the mean over sub-exposures (composite Gauss-Legendre nodes,
// panels of at most 2 sigma of motion): error below 1e-4 of the contrast where
// the motion is smooth within the exposure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "touchdown/core/frame.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/synthetic/scene.h"

namespace touchdown::vision {

// A picture before quantisation: row-major, in DN.
struct CleanImage {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::vector<float> dn;

  float at(std::int32_t x, std::int32_t y) const {
    return dn[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
              static_cast<std::size_t>(x)];
  }
};

// A picture as recorded; owns its samples (1 byte each where bit_depth <= 8,
// else 2 in host order).
struct SensorImage {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int32_t bit_depth = 8;
  std::int64_t index = 0;
  double time_s = 0.0;
  std::vector<std::byte> samples;

  core::Frame view() const;  // valid as long as this
};

class FacePicture;      // src/synthetic/render_face.h
class TroubleRenderer;  // src/synthetic/render_trouble.h

// Renders the frames of one scene over a background that is drawn once. Safe
// to use from several threads if scene.pose is.
class SceneRenderer {
 public:
  // Throws as Validate does.
  explicit SceneRenderer(Scene scene);

  const Scene& scene() const { return scene_; }

  // Frame `index` without noise, not rounded, not clipped to full scale; any
  // index is allowed (the pose is a function of time).
  CleanImage RenderClean(std::int64_t index) const;

  // What the picture is without the body.
  const CleanImage& background() const { return background_; }

 private:
  struct Covers;
  void DrawBody(const Covers& covers, bool dips, CleanImage& image) const;

  Scene scene_;
  CleanImage background_;            // in DN
  std::vector<float> ground_;        // ground minus background, in DN, textured
  std::vector<float> light_;         // illumination times full scale, in DN
  std::vector<float> ground_share_;  // of each pixel, where trouble needs it
  std::shared_ptr<const FacePicture> face_;         // or nothing
  std::shared_ptr<const TroubleRenderer> trouble_;  // or nothing
};

// One frame of a scene. To render many, keep a SceneRenderer.
CleanImage RenderClean(const Scene& scene, std::int64_t index);

// Adds Gaussian noise of variance read^2 + shot * max(v, 0) to each sample.
void AddSensorNoise(CleanImage& image, const SensorNoise& noise,
                    std::mt19937_64& engine);

// Rounds to the nearest of 0 .. 2^bit_depth - 1.
SensorImage Quantize(const CleanImage& image, std::int32_t bit_depth);

// Frame `index` as the camera records it: clean, noise, quantised.
SensorImage RenderFrame(const SceneRenderer& renderer, std::int64_t index,
                        std::mt19937_64& engine);

// The scene as a clip, rendered frame by frame as it is read, with no file
// behind it. Frame i's noise depends on (seed, i) alone, so that reading order
// does not matter. Format "scene"; the frame rate is trusted.
std::unique_ptr<Clip> OpenScene(Scene scene, std::uint64_t seed);

}  // namespace touchdown::vision
