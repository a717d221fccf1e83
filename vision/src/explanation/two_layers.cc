#include "explanation/two_layers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "outline/outline_image.h"
#include "outline/outline_pixels.h"
#include "outline/track_shape.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// Coverage below which a pixel shows nothing of the body: 0.1 % of any contrast
// is below the noise.
constexpr float kBarelyCovered = 1e-3F;

// The body's picture: a grid around its outline, in its own coordinates.
struct BodyGrid {
  double half_x_px = 0.0;  // of the body at relative size 1, with a rim
  double half_y_px = 0.0;
  double cell_px = 1.0;
  std::int32_t columns = 0;
  std::int32_t rows = 0;
};

// A grid over the body with a rim that holds the blurred edge. Cells are as
// wide as the lattice's step: each frame then fills each cell about once.
BodyGrid MakePictureGrid(const BodyImage& body, std::int32_t step) {
  // In units of blur_px: the edge's tail has ended there.
  constexpr double kRimBlurs = 4.0;
  BodyGrid grid;
  grid.cell_px = step;
  const double rim = kRimBlurs * body.blur_px + 2.0 * grid.cell_px;
  const bool is_sphere = body.kind == core::BodyKind::kSphere;
  grid.half_x_px =
      rim + (is_sphere ? body.radius_px.value : body.half_long_px.value);
  grid.half_y_px =
      rim + (is_sphere ? body.radius_px.value : body.half_short_px.value);
  grid.columns = static_cast<std::int32_t>(
                     std::ceil(2.0 * grid.half_x_px / grid.cell_px)) +
                 2;
  grid.rows = static_cast<std::int32_t>(
                  std::ceil(2.0 * grid.half_y_px / grid.cell_px)) +
              2;
  return grid;
}

// The body's motion in one frame interval at a frame, from the poses beside it.
struct FrameMotion {
  core::PixelPoint travel_px{0.0, 0.0};
  double turn_rad = 0.0;
};
FrameMotion MeasureFrameMotion(const Track& track, std::int64_t frame) {
  const auto& poses = track.poses;
  const auto at = std::lower_bound(
      poses.begin(), poses.end(), frame,
      [](const Pose& pose, std::int64_t f) { return pose.frame < f; });
  const auto after = at == poses.end()      ? at - 1
                     : at + 1 < poses.end() ? at + 1
                                            : at;
  const auto before = at == poses.begin() ? at : at - 1;
  FrameMotion step;
  if (after->frame == before->frame) return step;
  const double frames = static_cast<double>(after->frame - before->frame);
  step.travel_px = {(after->centre.x_px - before->centre.x_px) / frames,
                    (after->centre.y_px - before->centre.y_px) / frames};
  step.turn_rad = (after->angle_rad - before->angle_rad) / frames;
  return step;
}

// The lattice's points that the body covers in one frame: coverage, and the
// place in the body's picture for bilinear interpolation.
CoveredPoints CoverFrame(const Track& track, const SampledFrame& frame,
                         const LatticePoints& lattice, const BodyGrid& grid) {
  CoveredPoints covered;
  const Outline outline = PlaceOutline(track.body, frame.pose);
  // The same motion blur as in the fits.
  const FrameMotion step = MeasureFrameMotion(track, frame.index);
  const double extent = Extent(outline);
  const double blur = std::max(track.body.blur_px, 0.3);
  Smear smear(step.travel_px, step.turn_rad, extent);
  smear.Set(blur, track.body.shutter_fraction, false);
  const OutlineImage image(outline, smear);
  // In units of blur_px: beyond it coverage is below 1e-3 (kBarelyCovered).
  constexpr double kReachBlurs = 3.5;
  const double reach = extent + kReachBlurs * blur + 0.5 * smear.way_px();
  const auto from = [&](double centre, std::int32_t origin) {
    return std::max(0, static_cast<std::int32_t>(std::ceil(
                           (centre - reach - origin) / lattice.step)));
  };
  const auto to = [&](double centre, std::int32_t origin, std::int32_t count) {
    return std::min(count, static_cast<std::int32_t>(std::floor(
                               (centre + reach - origin) / lattice.step)) +
                               1);
  };
  const std::int32_t left = from(outline.centre.x_px, lattice.box.x);
  const std::int32_t right =
      to(outline.centre.x_px, lattice.box.x, lattice.columns);
  const std::int32_t top = from(outline.centre.y_px, lattice.box.y);
  const std::int32_t bottom =
      to(outline.centre.y_px, lattice.box.y, lattice.rows);
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  const double per_cell =
      1.0 / (grid.cell_px * std::max(frame.pose.relative_size, 1e-3));
  std::array<double, kBlock> xs{};
  std::array<double, kBlock> ys{};
  std::array<std::int32_t, kBlock> numbers{};
  std::size_t filled = 0;
  CoverBlock block;
  const auto flush = [&] {
    image.Cover(xs.data(), ys.data(), block);
    for (std::size_t i = 0; i < filled; ++i) {
      const float cover = block.value[i];
      // Most points of the box are not covered.
      if (!(cover > kBarelyCovered)) continue;
      const double dx = xs[i] - outline.centre.x_px;
      const double dy = ys[i] - outline.centre.y_px;
      // Place in the body's picture, in cells; clamped to its border cells.
      const double u = std::clamp(
          (cosine * dx + sine * dy) * per_cell + 0.5 * (grid.columns - 1), 0.0,
          grid.columns - 1.001);
      const double v = std::clamp(
          (cosine * dy - sine * dx) * per_cell + 0.5 * (grid.rows - 1), 0.0,
          grid.rows - 1.001);
      const auto column = static_cast<std::int32_t>(u);
      const auto row = static_cast<std::int32_t>(v);
      covered.point.push_back(numbers[i]);
      covered.cover.push_back(std::min(cover, 1.0F));
      covered.cell.push_back(row * grid.columns + column);
      covered.right.push_back(static_cast<float>(u - column));
      covered.below.push_back(static_cast<float>(v - row));
    }
    filled = 0;
  };
  for (std::int32_t row = top; row < bottom; ++row) {
    for (std::int32_t column = left; column < right; ++column) {
      const std::int32_t number =
          lattice.number[static_cast<std::size_t>(row) *
                             static_cast<std::size_t>(lattice.columns) +
                         static_cast<std::size_t>(column)];
      if (number < 0) continue;
      xs[filled] = lattice.box.x + column * lattice.step;
      ys[filled] = lattice.box.y + row * lattice.step;
      numbers[filled] = number;
      if (++filled == kBlock) flush();
    }
  }
  if (filled > 0) flush();
  return covered;
}

}  // namespace

std::vector<CoveredPoints> CoverPoints(const Track& track,
                                       const std::vector<SampledFrame>& frames,
                                       const LatticePoints& lattice,
                                       int threads) {
  const BodyGrid grid = MakePictureGrid(track.body, lattice.step);
  std::vector<CoveredPoints> covered(frames.size());
  core::InParallel(static_cast<std::int64_t>(frames.size()), threads,
                   [&](std::int64_t from, std::int64_t to) {
                     for (auto k = static_cast<std::size_t>(from);
                          k < static_cast<std::size_t>(to); ++k) {
                       if (!frames[k].has_pose) continue;
                       covered[k] = CoverFrame(track, frames[k], lattice, grid);
                     }
                   });
  return covered;
}

TwoLayers::TwoLayers(const Track& track,
                     const std::vector<SampledFrame>& frames,
                     const LatticePoints& lattice, const LatticeLevels& levels,
                     const std::vector<CoveredPoints>& covered)
    : points_(lattice.size()) {
  const BodyGrid grid = MakePictureGrid(track.body, lattice.step);
  columns_ = grid.columns;
  picture_.assign(static_cast<std::size_t>(grid.columns) *
                      static_cast<std::size_t>(grid.rows),
                  0.0F);
  // At first what is hardly touched tells B; then edges are shared out, too.
  LearnStill(frames, levels, covered);
  LearnPicture(levels, covered);
  LearnStill(frames, levels, covered);
  LearnPicture(levels, covered);
}

float TwoLayers::picture(const CoveredPoints& covered, std::size_t i) const {
  const float* cell = picture_.data() + covered.cell[i];
  const float* next = cell + columns_;
  const float right = covered.right[i];
  const float upper = cell[0] + right * (cell[1] - cell[0]);
  const float lower = next[0] + right * (next[1] - next[0]);
  return upper + covered.below[i] * (lower - upper);
}

void TwoLayers::LearnStill(const std::vector<SampledFrame>& frames,
                           const LatticeLevels& levels,
                           const std::vector<CoveredPoints>& covered) {
  // Least squares of B in I = (1 - M) B + M T for each point. Frames before and
  // after the track, in which the body is away, tell B where nothing else does.
  std::vector<float> sum(points_, 0.0F);
  weight_.assign(points_, 0.0F);
  std::vector<float> outside(points_, 0.0F);
  float outside_weight = 0.0F;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const float* level = levels.of(k);
    if (!frames[k].has_pose) {
      if (frames[k].is_within) continue;
      for (std::size_t p = 0; p < points_; ++p) outside[p] += level[p];
      outside_weight += 1.0F;
      continue;
    }
    for (std::size_t p = 0; p < points_; ++p) sum[p] += level[p];
    for (std::size_t p = 0; p < points_; ++p) weight_[p] += 1.0F;
    const CoveredPoints& here = covered[k];
    for (std::size_t i = 0; i < here.point.size(); ++i) {
      const auto p = static_cast<std::size_t>(here.point[i]);
      const float m = here.cover[i];
      const float open = 1.0F - m;
      sum[p] -= level[p];
      weight_[p] -= 1.0F;
      // (1 - M) (I - M T); without T only what is hardly covered.
      if (has_picture_) {
        sum[p] += open * (level[p] - m * picture(here, i));
        weight_[p] += open * open;
      } else if (m < 1.0F - kWhollyCovered) {
        sum[p] += open * open * level[p];
        weight_[p] += open * open;
      }
    }
  }
  still_.resize(points_);
  for (std::size_t p = 0; p < points_; ++p) {
    if (!is_known(p) && outside_weight > 0.0F) {
      still_[p] = outside[p] / outside_weight;
      weight_[p] = outside_weight;
    } else {
      still_[p] = is_known(p) ? sum[p] / weight_[p] : 0.0F;
    }
  }
}

// T += sum of b M (I - (1 - M) B - M T) / sum of b M^2, b being the bilinear
// share of a cell: the first round learns a picture a little blurred, the next
// one takes most of that back. Cells that hardly any pixel tells keep close to
// the body's mean.
void TwoLayers::LearnPicture(const LatticeLevels& levels,
                             const std::vector<CoveredPoints>& covered) {
  // Weight of the prior, in pixels that are wholly covered. Larger pulls the
  // rim to the mean; smaller lets single pixels set it. Not studied.
  constexpr float kPriorWeight = 0.05F;
  // Rounds: the second takes back most of the first one's blur. Not studied.
  constexpr int kRounds = 2;
  const auto columns = static_cast<std::size_t>(columns_);
  if (!has_picture_) {
    double sum = 0.0;
    double weight = 0.0;
    for (std::size_t k = 0; k < covered.size(); ++k) {
      const CoveredPoints& here = covered[k];
      const float* level = levels.of(k);
      for (std::size_t i = 0; i < here.point.size(); ++i) {
        if (here.cover[i] < kWhollyCovered) continue;
        sum += level[here.point[i]];
        weight += 1.0;
      }
    }
    const float mean = weight > 0.0 ? static_cast<float>(sum / weight) : 0.0F;
    std::fill(picture_.begin(), picture_.end(), mean);
    has_picture_ = true;
  }
  std::vector<float> over(picture_.size());
  std::vector<float> under(picture_.size());
  for (int round = 0; round < kRounds; ++round) {
    std::fill(over.begin(), over.end(), 0.0F);
    std::fill(under.begin(), under.end(), kPriorWeight);
    for (std::size_t k = 0; k < covered.size(); ++k) {
      const CoveredPoints& here = covered[k];
      const float* level = levels.of(k);
      for (std::size_t i = 0; i < here.point.size(); ++i) {
        const auto p = static_cast<std::size_t>(here.point[i]);
        const float m = here.cover[i];
        if (!is_known(p) && m < kWhollyCovered) continue;
        const float behind = is_known(p) ? still_[p] : 0.0F;
        const float off =
            m * (level[p] - (1.0F - m) * behind - m * picture(here, i));
        const auto cell = static_cast<std::size_t>(here.cell[i]);
        const float r = here.right[i];
        const float d = here.below[i];
        const std::array<float, 4> share = {
            (1.0F - r) * (1.0F - d), r * (1.0F - d), (1.0F - r) * d, r * d};
        const std::array<std::size_t, 4> at = {cell, cell + 1, cell + columns,
                                               cell + columns + 1};
        for (std::size_t j = 0; j < share.size(); ++j) {
          over[at[j]] += share[j] * off;
          under[at[j]] += share[j] * m * m;
        }
      }
    }
    // Each cell moves by the weighted mean of what its pixels lack.
    for (std::size_t c = 0; c < picture_.size(); ++c) {
      picture_[c] += over[c] / under[c];
    }
  }
}

}  // namespace touchdown::vision
