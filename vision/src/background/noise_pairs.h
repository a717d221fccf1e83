// The noise of pixels, from the differences of samples that neighbour in time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "background/frame_samples.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {

// Neighbouring samples' values at points of the picture, for the noise.
class NoisePairs {
 public:
  NoisePairs(std::int32_t width_px, std::int32_t height_px,
             const FrameSamples& samples);

  bool Has(std::int32_t y) const { return y % row_step_ == 0; }
  // Row `y` of the picture is row `row` of each sample's window.
  template <class Sample>
  void Take(const std::vector<core::Frame>& windows, std::int32_t row,
            std::int32_t y) {
    for (std::size_t k = 0; k < 2 * per_point_; ++k) {
      const Sample* const samples = windows[taken_[k]].row<Sample>(row);
      for (std::size_t column = 0; column < columns_.size(); ++column) {
        values_[Point(y / row_step_, column) + k] = samples[columns_[column]];
      }
    }
  }
  // Calls use(x, y, for_each_pair) for each point that has pairs. What it is
  // given calls its own argument with (one, other) for each of them, the one
  // nearer to the clip's end first.
  template <class Use>
  void ForEachPoint(const Use& use) const {
    if (per_point_ == 0) return;
    for (std::int32_t row = 0; row < rows_; ++row) {
      for (std::size_t column = 0; column < columns_.size(); ++column) {
        const std::uint16_t* const values = &values_[Point(row, column)];
        use(columns_[column], row * row_step_, [&](const auto& use_pair) {
          for (std::size_t k = 0; k < 2 * per_point_; k += 2) {
            const std::size_t late = k >= per_point_ ? 1 : 0;
            use_pair(int{values[k + late]}, int{values[k + 1 - late]});
          }
        });
      }
    }
  }

 private:
  std::size_t Point(std::int32_t row, std::size_t column) const {
    return (static_cast<std::size_t>(row) * columns_.size() + column) * 2 *
           per_point_;
  }

  // So many samples tell. Of more every second one: frames of compressed video
  // that follow each other share their noise.
  static constexpr std::size_t kEnoughSamples = 32;

  std::int32_t row_step_ = 1;
  std::size_t apart_;  // samples from one to the next that is taken
  std::size_t per_point_;
  std::vector<std::size_t> taken_;  // samples
  std::vector<std::int32_t> columns_;
  std::int32_t rows_ = 0;
  std::vector<std::uint16_t> values_;
};

// Sets floor and slope of the noise; its levels are known.
void EstimateNoise(const NoisePairs& pairs, Background& background);

}  // namespace touchdown::vision
