// The samples of a clip that the check by synthesis looks at: some frames, and
// of each the pixels of a lattice, the same ones in every frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "touchdown/vision/explanation/explained_change.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// A sampled frame and where the track says that the body is.
struct SampledFrame {
  std::int64_t index = 0;
  bool has_pose = false;
  bool is_within = false;    // between the first and the last pose
  Pose pose;                 // measured; else expected, by a straight way
  bool is_expected = false;  // whether `pose` says anything
};

std::vector<SampledFrame> ChooseFrames(const Clip& clip, const Track& track,
                                       const ExplainedChangeOptions& options);

// Pixels of a lattice: every `step`-th column of every `step`-th row, those
// that were chosen.
struct LatticePoints {
  std::int32_t step = 1;
  core::PixelRect box;          // of the lattice
  std::int32_t columns = 0;     // of the lattice in the box
  std::int32_t rows = 0;        //
  std::vector<std::int32_t> x;  // of the chosen pixels, row by row
  std::vector<std::int32_t> y;
  // At each place of the lattice the number of its pixel; -1: not chosen.
  std::vector<std::int32_t> number;

  std::size_t size() const { return x.size(); }
};

// The pixels within half the body's size of its outline in any of the frames.
LatticePoints FindNearPoints(const Clip& clip, const Track& track,
                             const std::vector<SampledFrame>& frames,
                             const ExplainedChangeOptions& options);

// Those of the rest of the picture.
LatticePoints PointsElsewhere(const Clip& clip, const Track& track,
                              const std::vector<SampledFrame>& frames,
                              const ExplainedChangeOptions& options);

// The levels of the points in each frame, DN: frame by frame.
class LatticeLevels {
 public:
  LatticeLevels(std::size_t frames, std::size_t points)
      : points_(points), levels_(frames * points) {}
  float* of(std::size_t frame) { return levels_.data() + frame * points_; }
  const float* of(std::size_t frame) const {
    return levels_.data() + frame * points_;
  }

 private:
  std::size_t points_;
  std::vector<float> levels_;
};

LatticeLevels ReadLevels(Clip& clip, const std::vector<SampledFrame>& frames,
                         const LatticePoints& points, int threads);

}  // namespace touchdown::vision
