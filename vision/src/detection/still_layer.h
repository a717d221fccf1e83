// The still layer of a clip: what is behind its body, and what changes before
// it, in pictures of reduced size. OpenCV's matrices: for layered_start.cc.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// Frames first, first + step, ... of a clip. A cell of a picture is the mean of
// reduction x reduction pixels, DN, 32-bit floats.
struct ReducedFrames {
  std::vector<std::int64_t> frames;
  std::int64_t step = 1;
  std::vector<cv::Mat> pictures;
  double full_scale_dn = 255.0;
};

// About `count` frames of [first, last): 0.75 to 1.5 times as many.
ReducedFrames SampleReducedFrames(Clip& clip, std::int64_t first,
                                  std::int64_t last, int count,
                                  std::int32_t reduction);

// The still picture as it is known so far.
struct StillLayer {
  cv::Mat level;      // DN, floats
  cv::Mat uncovered;  // 16 bits: sampled frames that show each cell
};

// A picture that is known everywhere.
StillLayer WholeStill(cv::Mat level);

// The median over the frames, known everywhere.
StillLayer MedianStill(const ReducedFrames& sampled, int threads);

// Standard deviation of a cell, DN: from picture to picture or about the still
// one, whichever is larger, robustly; never below a thousandth of full scale,
// which rounding and a lamp leave.
double EstimateCellNoise(const ReducedFrames& sampled, const StillLayer& still);

// B of what no mask covers (1 = covered, bytes, one mask a frame): the mean,
// then twice with Cauchy's weights 1 / (1 + (off / 3 s)^2) about it, s being
// the cells' noise. Where all masks cover a cell it keeps the level of
// `fallback`.
StillLayer LearnStill(const ReducedFrames& sampled,
                      const std::vector<cv::Mat>& masks,
                      const cv::Mat& fallback, double noise_dn, int threads);

// E = clip((G * |picture - B| - from) / range, 0, 1), 0.5 where B is not known.
struct ChangeScale {
  double from_dn = 0.0;
  double range_dn = 1.0;
};
// 0.8 s: the mean magnitude of noise; 5 s + 1.2 % of full scale: what is clear,
// beyond what flicker, compression and an uneven exposure leave of a still
// picture.
ChangeScale ScaleOfChange(double noise_dn, double full_scale_dn);
// In a box of the picture.
cv::Mat ComputeChange(const StillLayer& still, const cv::Mat& picture,
                      const ChangeScale& scale, const cv::Rect& box);

}  // namespace touchdown::vision
