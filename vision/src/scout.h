// A quick look at a frame: where could it differ from the still picture? Sums
// of eight samples on every fourth row tell, so that a quarter of the picture
// is read and nothing is copied. What it points at is looked at closely by
// detect.h.
#pragma once

#include <cstdint>
#include <vector>

#include "touchdown/vision/background.h"
#include "touchdown/vision/clip.h"

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
  Scout(const Background& still, const ScoutOptions& options = {});

  // `frame` is a whole picture. The strongest regions come first.
  Changes Look(const core::Frame& frame) const;

  // True if two still pictures differ anywhere, by as much and by more than
  // here and there, but for what is always among the regions.
  bool Differs(const Scout& other) const;

 private:
  struct Segment {
    float sum = 0.0F;         // of the still picture's eight samples
    float one_over_u = 0.0F;  // one over the standard deviation of a frame's
  };
  struct Noise {
    double typical = 1.0;  // Changes::noise
    double tail = 1.0;     // as many times as large are rare differences
  };
  Noise NoiseOf(std::vector<float> off, std::size_t step) const;
  template <class Sample>
  Changes LookAt(const core::Frame& frame) const;
  template <class Sample>
  float Off(const Sample* samples, const Segment& still) const;
  std::vector<core::PixelRect> Regions(std::vector<float> cells) const;

  ScoutOptions options_;
  std::int32_t width_px_;
  std::int32_t height_px_;
  std::int32_t columns_;  // of cells
  std::int32_t rows_;
  std::int32_t segments_;       // in a row of the picture
  std::vector<Segment> still_;  // (looked-at rows, segments_)
};

}  // namespace touchdown::vision
