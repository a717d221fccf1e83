// A quick look at a frame: where could it differ from the still picture? Sums
// of eight samples on every fourth row tell, so that a quarter of the picture
// is read and nothing is copied. What it points at is looked at closely by
// detect.h.
#pragma once

#include <cstdint>
#include <vector>

#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct ScoutOptions {
  core::PixelRect region;  // searched; width 0: the whole picture

  // A sum must differ by this many of its standard deviations. 5: of the 32 000
  // sums of a 1280 x 800 frame 0.02 do so by chance, and a region for nothing
  // costs little. A body of 8 px and of twice the noise is seen (5.7). Where
  // large differences are more frequent than those of normal noise
  // (compression), as many times more as they are larger.
  double threshold_sigmas = 5.0;

  // Cells of 16 px added around those that differ: at least 16 px of
  // surround, for a blob's rim.
  std::int32_t margin_cells = 1;

  // The strongest regions are kept; detect.h keeps as many blobs.
  std::size_t most_regions = 12;

  // Always among the regions.
  std::vector<core::PixelRect> always;
};

class Scout {
 public:
  // px of a cell's side, in which changes are marked: as many as a codec's
  // macroblock. Larger windows cost memory; smaller ones cost time to join. Not
  // studied.
  static constexpr std::int32_t kCell_px = 16;

  Scout(const Background& still, const ScoutOptions& options = {});

  // `frame` is a whole picture. The strongest regions come first.
  Changes Look(const core::Frame& frame) const;
  // The same of frame `index`, of which only the rows looked at are read.
  Changes Look(Clip& clip, std::int64_t index) const;

  // Whether anything differs on every sixteenth row, beginning with another one
  // for each `phase`, 0 to 3: four glimpses see what a look sees.
  bool Glimpse(Clip& clip, std::int64_t index, int phase) const;

  // True if two still pictures differ anywhere, by as much and by more than
  // here and there, but for what is always among the regions.
  bool Differs(const Scout& other) const;

 private:
  struct Noise {
    double typical = 1.0;  // Changes::noise
    double tail = 1.0;     // as many times as large are rare differences
  };
  // Rows first, first + step, ... of those looked at.
  struct Rows {
    std::size_t first = 0;
    std::size_t step = 1;
  };
  std::size_t rows_looked_at() const { return sum_.size() / At(segments_); }
  static std::size_t At(std::int32_t i) { return static_cast<std::size_t>(i); }
  Noise MeasureNoise(const std::vector<float>& off) const;
  Changes FindChanges(const std::vector<float>& off) const;
  template <class RowOf>
  std::vector<float> Off(const Rows& rows, const RowOf& row_of) const;
  std::vector<float> Off(const core::Frame& frame, const Rows& rows) const;
  std::vector<float> Off(Clip& clip, std::int64_t index,
                         const Rows& rows) const;
  std::vector<core::PixelRect> Regions(std::vector<float> cells) const;

  ScoutOptions options_;
  std::int32_t width_px_;
  std::int32_t height_px_;
  std::int32_t columns_;  // of cells
  std::int32_t rows_;
  std::int32_t segments_;  // in a row of the picture
  // (looked-at rows, segments_): of the still picture's eight samples, and one
  // over the standard deviation of a frame's.
  std::vector<float> sum_;
  std::vector<float> per_u_;
};

}  // namespace touchdown::vision
