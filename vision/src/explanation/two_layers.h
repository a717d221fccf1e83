// A still picture B and a body's picture T, learned from sampled frames in
// which the body's place is known: I = (1 - M) B + M T (explained_change.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "explanation/change_samples.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// The pixels that the body covers, wholly or in part, in one sampled frame.
struct CoveredPoints {
  std::vector<std::int32_t> point;  // number of the lattice's pixel
  std::vector<float> cover;         // M
  // Place in the body's picture: its cell and the share of the next one.
  std::vector<std::int32_t> cell;
  std::vector<float> right;
  std::vector<float> below;
};

// Coverage from which on a pixel shows nothing but the body. Larger loses small
// blurred bodies; smaller mixes the background in. Not studied.
inline constexpr float kWhollyCovered = 0.95F;

// Of each sampled frame; empty where it has no pose.
std::vector<CoveredPoints> CoverPoints(const Track& track,
                                       const std::vector<SampledFrame>& frames,
                                       const LatticePoints& lattice,
                                       int threads);

class TwoLayers {
 public:
  // Learns B and T from all frames that have poses, by least squares in turns.
  // Frames without one that lie before or after the track tell B where no other
  // does. `covered` comes from the same track, frames and lattice.
  TwoLayers(const Track& track, const std::vector<SampledFrame>& frames,
            const LatticePoints& lattice, const LatticeLevels& levels,
            const std::vector<CoveredPoints>& covered);

  bool is_known(std::size_t point) const { return weight_[point] > kLeastSeen; }
  float still(std::size_t point) const { return still_[point]; }
  // Of the grid of T, row by row; its border lies outside the body.
  std::size_t cells() const { return picture_.size(); }
  std::size_t columns() const { return static_cast<std::size_t>(columns_); }
  // T at covered point `i`.
  float picture(const CoveredPoints& covered, std::size_t i) const;

 private:
  void LearnStill(const std::vector<SampledFrame>& frames,
                  const LatticeLevels& levels,
                  const std::vector<CoveredPoints>& covered);
  void LearnPicture(const LatticeLevels& levels,
                    const std::vector<CoveredPoints>& covered);

  // Sum of (1 - M)^2 below which a pixel was never seen uncovered. Larger
  // leaves more pixels to the mean over time; smaller divides by noise. Not
  // studied.
  static constexpr float kLeastSeen = 0.3F;

  std::size_t points_ = 0;
  std::int32_t columns_ = 0;  // of the body's picture
  std::vector<float> still_;
  std::vector<float> weight_;  // of still_: sum of (1 - M)^2
  std::vector<float> picture_;
  bool has_picture_ = false;
};

}  // namespace touchdown::vision
