// The still background of a clip and the noise of its pixels, both from the
// clip itself.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/linear_clip.h"

namespace touchdown::vision {

struct BackgroundOptions {
  // Frames sampled evenly over the range. More of them lower the background's
  // own noise (1/sqrt) and cost reading time; below 8 a slow body leaves a
  // ghost. 33 keeps the background's variance under 5 % of a frame's.
  int samples = 33;

  // Not empty: samples are taken evenly from these frames, in order, where any
  // of them is in the range: those that a clip has at hand whole.
  std::vector<std::int64_t> among = {};

  int threads = 0;  // 0: one for each core; affects speed only
};

// The frames of [first, last) that are sampled.
std::vector<std::int64_t> BackgroundFrames(std::int64_t first,
                                           std::int64_t last, int samples);
std::vector<std::int64_t> BackgroundFrames(std::int64_t first,
                                           std::int64_t last,
                                           const BackgroundOptions& options);

// Frames are gray; levels in DN (the file's own numbers).
struct Background {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::vector<float> level;  // (height, width), row-major

  // 1 where the body was never away, so that the level is not known; empty:
  // known everywhere.
  std::vector<std::uint8_t> unknown;

  // Temporal noise of one sample at level L: variance = floor + slope * L, DN^2
  // (read noise and quantisation; shot noise).
  double noise_floor_dn2 = 1.0;
  double noise_slope_dn = 0.0;

  // Highest level that a sample can have; samples at it carry no information.
  double full_scale_dn = 255.0;

  double Variance(double level_dn) const {
    const double v = noise_floor_dn2 + noise_slope_dn * level_dn;
    return v > kVarianceFloor_dn2 ? v : kVarianceFloor_dn2;
  }
  // That of the picture's mean level, by a few places all over it.
  double UsualVariance() const;
  float at(std::int32_t x, std::int32_t y) const {
    return level[static_cast<std::size_t>(y) *
                     static_cast<std::size_t>(width_px) +
                 static_cast<std::size_t>(x)];
  }

  bool known_at(std::int32_t x, std::int32_t y) const {
    return unknown.empty() || unknown[static_cast<std::size_t>(y) *
                                          static_cast<std::size_t>(width_px) +
                                      static_cast<std::size_t>(x)] == 0;
  }

  // Variance of rounding to whole DN: no sample is known better.
  static constexpr double kVarianceFloor_dn2 = 1.0 / 12.0;
};

// The background of a clip's light (ViewInLight) from that of its levels. The
// noise is one for all levels: that of the picture's pixels, in the mean.
Background InLight(const Background& background, const LightScale& scale);

// Per pixel the mid-mean (mean of the middle half) of sampled frames of
// [first, last), which no body touches that covers a pixel less than a quarter
// of the time. (A median has 1.57 times the variance of a mean, the
// mid-mean 1.2.) The noise comes from differences of neighbouring samples,
// robustly, as a function of level. Throws what Clip::Read throws;
// std::invalid_argument if the range is empty or outside the clip.
Background EstimateBackground(Clip& clip, std::int64_t first, std::int64_t last,
                              const BackgroundOptions& options = {});

// The same of given frames, at least one.
Background EstimateBackgroundFromFrames(Clip& clip,
                                        std::span<const std::int64_t> frames,
                                        const BackgroundOptions& options = {});

// Where the body is in one frame.
struct Cover {
  // False: not known, or not known well enough: the frame is left out, and the
  // mask tells where the body may be.
  bool known = true;
  core::PixelRect box;             // within the picture; width 0: nowhere
  std::vector<std::uint8_t> mask;  // of the box, row by row; 1 = covered
};
using CoverFunction = std::function<Cover(std::int64_t frame)>;

// Where the body is in the frames that are sampled.
struct Covers {
  std::vector<std::int64_t> frames;  // where that is known
  std::vector<Cover> of;             // each of them
  // The box around all of these and of the others, and for each of its pixels
  // how many cover it.
  core::PixelRect box;
  std::vector<std::uint16_t> counts;
  // The largest share of `frames` in which any one pixel is covered.
  double most = 0.0;
};
Covers FindCovers(std::int64_t first, std::int64_t last,
                  const CoverFunction& covers,
                  const BackgroundOptions& options = {});

// The same from frames in which the body's place is known: what it covers is
// left out, so that a slow or large body leaves no ghost. Pixels that no
// frame's mask covers keep the level of `fallback`, the mid-mean of the same
// frames.
Background EstimateMaskedBackground(Clip& clip, const Covers& covers,
                                    Background fallback,
                                    const BackgroundOptions& options = {});

}  // namespace touchdown::vision
