#include "detection/still_layer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "background/mid_mean.h"
#include "numbers/robust.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// Means of by x by pixels.
template <class Sample>
cv::Mat Reduce(const core::Frame& frame, std::int32_t by) {
  cv::Mat reduced(frame.height_px / by, frame.width_px / by, CV_32F,
                  cv::Scalar(0));
  const float scale = 1.0F / static_cast<float>(by * by);
  for (std::int32_t y = 0; y < reduced.rows * by; ++y) {
    const Sample* const row = frame.row<Sample>(y);
    float* const out = reduced.ptr<float>(y / by);
    for (std::int32_t x = 0; x < reduced.cols; ++x) {
      std::uint32_t sum = 0;
      for (std::int32_t k = 0; k < by; ++k) sum += row[x * by + k];
      out[x] += scale * static_cast<float>(sum);
    }
  }
  return reduced;
}

}  // namespace

ReducedFrames SampleReducedFrames(Clip& clip, std::int64_t first,
                                  std::int64_t last, int count,
                                  std::int32_t reduction) {
  ReducedFrames sampled;
  sampled.step = std::max<std::int64_t>(
      1, std::llround(static_cast<double>(last - first) / std::max(count, 3)));
  for (std::int64_t f = first; f < last; f += sampled.step) {
    const core::Frame frame = clip.Read(f);
    sampled.full_scale_dn = frame.full_scale();
    sampled.frames.push_back(f);
    sampled.pictures.push_back(frame.is_16_bit()
                                   ? Reduce<std::uint16_t>(frame, reduction)
                                   : Reduce<std::uint8_t>(frame, reduction));
  }
  return sampled;
}

StillLayer WholeStill(cv::Mat level) {
  cv::Mat seen(level.size(), CV_16U, cv::Scalar(1));
  return {std::move(level), std::move(seen)};
}

// Median over the pictures, for the first round: right wherever the body is in
// fewer than half of them.
StillLayer MedianStill(const ReducedFrames& sampled, int threads) {
  const std::size_t count = sampled.pictures.size();
  const SortingNetwork network(count, SortingNetwork::Order::kFull);
  cv::Mat median(sampled.pictures.front().size(), CV_32F);
  const auto width = static_cast<std::size_t>(median.cols);
  core::InParallel(median.rows, threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     std::vector<float> lanes(count * kLanes);
                     for (auto y = static_cast<int>(begin); y < end; ++y) {
                       for (std::size_t x = 0; x < width; x += kLanes) {
                         const std::size_t some = std::min(kLanes, width - x);
                         for (std::size_t t = 0; t < count; ++t) {
                           std::copy_n(sampled.pictures[t].ptr<float>(y) + x,
                                       some, lanes.data() + t * kLanes);
                         }
                         network.Sort(lanes.data());
                         std::copy_n(lanes.data() + count / 2 * kLanes, some,
                                     median.ptr<float>(y) + x);
                       }
                     }
                   });
  return WholeStill(std::move(median));
}

namespace {

// Median magnitude of the difference of two pictures of each cell: most cells
// do not change, and the median is blind to those that do.
template <class Before>
double MedianDifference(const ReducedFrames& sampled, const Before& before) {
  // Every third cell across and down is enough for a median. Not studied.
  constexpr int kCellStep = 3;
  std::vector<float> differences;
  for (std::size_t t = 1; t < sampled.pictures.size(); ++t) {
    const cv::Mat& a = before(t);
    const cv::Mat& b = sampled.pictures[t];
    for (int y = 0; y < a.rows; y += kCellStep) {
      for (int x = 0; x < a.cols; x += kCellStep) {
        differences.push_back(std::abs(a.at<float>(y, x) - b.at<float>(y, x)));
      }
    }
  }
  return static_cast<double>(MedianInPlace(differences));
}

}  // namespace

// The larger of what successive pictures show, and of what pictures show about
// the still one: a codec repeats its errors from picture to picture.
double EstimateCellNoise(const ReducedFrames& sampled,
                         const StillLayer& still) {
  // Of full scale, a quarter DN of 8 bits: a synthetic picture has no noise.
  constexpr double kMinNoiseShare = 1e-3;
  const double successive = MedianDifference(
      sampled,
      [&](std::size_t t) -> const cv::Mat& { return sampled.pictures[t - 1]; });
  const double about = MedianDifference(
      sampled, [&](std::size_t) -> const cv::Mat& { return still.level; });
  return std::max(
      kSigmaPerMedian * std::max(successive / std::numbers::sqrt2, about),
      kMinNoiseShare * sampled.full_scale_dn);
}

// Still layer of what the masks leave uncovered: a mean, then weighted means
// with Cauchy's weights 1 / (1 + r^2), which take out shadows and flicker.
// Cells that are always covered keep the fallback.
StillLayer LearnStill(const ReducedFrames& sampled,
                      const std::vector<cv::Mat>& masks,
                      const cv::Mat& fallback, double noise_dn, int threads) {
  // Reweightings after the plain mean. Not studied.
  constexpr int kRobustPasses = 2;
  // In units of the noise: the scale of Cauchy's weights. Not studied.
  constexpr float kCauchyNoises = 3.0F;
  StillLayer still;
  still.level = fallback.clone();
  still.uncovered = cv::Mat(fallback.size(), CV_16U, cv::Scalar(0));
  const float per_cut = 1.0F / (kCauchyNoises * static_cast<float>(noise_dn));
  core::InParallel(
      fallback.rows, threads, [&](std::int64_t begin, std::int64_t end) {
        const auto width = static_cast<std::size_t>(fallback.cols);
        std::vector<float> sum(width);
        std::vector<float> weight(width);
        for (auto y = static_cast<int>(begin); y < end; ++y) {
          float* const level = still.level.ptr<float>(y);
          auto* const uncovered = still.uncovered.ptr<std::uint16_t>(y);
          for (int pass = 0; pass <= kRobustPasses; ++pass) {
            std::fill(sum.begin(), sum.end(), 0.0F);
            std::fill(weight.begin(), weight.end(), 0.0F);
            for (std::size_t t = 0; t < masks.size(); ++t) {
              const float* const value = sampled.pictures[t].ptr<float>(y);
              const auto* const mask = masks[t].ptr<std::uint8_t>(y);
              for (std::size_t x = 0; x < width; ++x) {
                const float off = (value[x] - level[x]) * per_cut;
                const float robust =
                    pass == 0 ? 1.0F : 1.0F / (1.0F + off * off);
                const float own = mask[x] != 0 ? 0.0F : robust;
                sum[x] += own * value[x];
                weight[x] += own;
              }
            }
            for (std::size_t x = 0; x < width; ++x) {
              if (pass == 0) {
                uncovered[x] = static_cast<std::uint16_t>(weight[x]);
              }
              if (weight[x] > 0.0F) level[x] = sum[x] / weight[x];
            }
          }
        }
      });
  return still;
}

// Change is 0 at the mean magnitude of noise and 1 where it is clear.
ChangeScale ScaleOfChange(double noise_dn, double full_scale_dn) {
  // Mean of |normal|, sqrt(2/pi).
  constexpr double kMeanMagnitude = 0.8;
  // In units of the noise, and of full scale: the latter for flicker and for
  // compression, which noise does not tell. Larger misses faint bodies. Not
  // studied.
  constexpr double kClearNoises = 5.0;
  constexpr double kClearShare = 0.012;
  return {kMeanMagnitude * noise_dn,
          kClearNoises * noise_dn + kClearShare * full_scale_dn};
}

// |picture - still|, smoothed over a cell and scaled to 0..1.
cv::Mat ComputeChange(const StillLayer& still, const cv::Mat& picture,
                      const ChangeScale& scale, const cv::Rect& box) {
  // Change of a cell that was never uncovered: neither for the body nor against
  // it.
  constexpr float kUnknownChange = 0.5F;
  // Cells that smoothing reaches to each side.
  constexpr int kReach = 2;
  const cv::Rect around =
      cv::Rect(box.x - kReach, box.y - kReach, box.width + 2 * kReach,
               box.height + 2 * kReach) &
      cv::Rect({0, 0}, picture.size());
  cv::Mat difference;
  cv::absdiff(picture(around), still.level(around), difference);
  cv::GaussianBlur(difference, difference, {2 * kReach + 1, 2 * kReach + 1},
                   1.0);
  cv::Mat change = difference(box - around.tl());
  for (int y = 0; y < change.rows; ++y) {
    float* const row = change.ptr<float>(y);
    const auto* const uncovered =
        still.uncovered.ptr<std::uint16_t>(box.y + y) + box.x;
    for (int x = 0; x < change.cols; ++x) {
      const float value = (row[x] - static_cast<float>(scale.from_dn)) /
                          static_cast<float>(scale.range_dn);
      row[x] =
          uncovered[x] == 0 ? kUnknownChange : std::clamp(value, 0.0F, 1.0F);
    }
  }
  return change;
}

}  // namespace touchdown::vision
