#include "change_samples.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "body_cover.h"
#include "outline_pixels.h"
#include "read_apart.h"
#include "touchdown/vision/background.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

core::PixelRect RegionOf(const Clip& clip,
                         const ExplainedChangeOptions& options) {
  if (options.region.width > 0) return options.region;
  return {0, 0, clip.info().width_px, clip.info().height_px};
}

// Where the body would be at a steady pace beyond either end of the track. A
// blow or gravity soon bends the path: nothing is said beyond so many
// frames (a choice, not measured).
constexpr std::int64_t kFarthestFrames = 10;
constexpr std::size_t kPaceOver = 4;  // poses that the pace is of

bool Expect(const Track& track, SampledFrame& frame) {
  const std::vector<Pose>& poses = track.poses;
  if (const auto pose = PoseIn(track, frame.index)) {
    frame.pose = *pose;
    return true;
  }
  if (poses.size() < 2) return false;
  const std::size_t reach = std::min(kPaceOver, poses.size() - 1);
  if (frame.index < poses.front().frame) {
    if (poses.front().frame - frame.index > kFarthestFrames) return false;
    frame.pose = OnTheWay(poses.front(), poses[reach], frame.index);
  } else {
    if (frame.index - poses.back().frame > kFarthestFrames) return false;
    frame.pose =
        OnTheWay(poses[poses.size() - 1 - reach], poses.back(), frame.index);
  }
  return true;
}

// How far from the outline a pixel counts as near: half the body's size, so
// that what was followed at a wrong place still has the body near it, and what
// the blur adds.
double MarginOf(const BodyImage& body) {
  const double size = body.kind == core::BodyKind::kSphere
                          ? 2.0 * body.radius_px.value
                          : 2.0 * body.half_long_px.value;
  constexpr double kShare = 0.5;
  constexpr double kBlurs = 3.0;
  return kShare * size + kBlurs * body.blur_px;
}

core::PixelRect Intersection(const core::PixelRect& a,
                             const core::PixelRect& b) {
  core::PixelRect both;
  both.x = std::max(a.x, b.x);
  both.y = std::max(a.y, b.y);
  both.width = std::max(0, std::min(a.x + a.width, b.x + b.width) - both.x);
  both.height = std::max(0, std::min(a.y + a.height, b.y + b.height) - both.y);
  return both;
}

core::PixelRect OutlineBox(const Outline& outline, double margin) {
  const double reach = Extent(outline) + margin;
  core::PixelRect box;
  box.x = static_cast<std::int32_t>(std::floor(outline.centre.x_px - reach));
  box.y = static_cast<std::int32_t>(std::floor(outline.centre.y_px - reach));
  box.width =
      static_cast<std::int32_t>(std::ceil(outline.centre.x_px + reach)) -
      box.x + 1;
  box.height =
      static_cast<std::int32_t>(std::ceil(outline.centre.y_px + reach)) -
      box.y + 1;
  return box;
}

// Marks of the lattice: 1 where the body is near in any of the frames.
std::vector<std::uint8_t> MarkNear(const Track& track,
                                   const std::vector<SampledFrame>& frames,
                                   const LatticePoints& lattice) {
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(lattice.columns) *
                                  static_cast<std::size_t>(lattice.rows));
  const double margin = MarginOf(track.body);
  for (const SampledFrame& frame : frames) {
    if (!frame.is_expected) continue;
    const Outline outline = OutlineAt(track.body, frame.pose);
    const double cosine = std::cos(outline.angle_rad);
    const double sine = std::sin(outline.angle_rad);
    const core::PixelRect box =
        Intersection(OutlineBox(outline, margin), lattice.box);
    if (box.width == 0 || box.height == 0) continue;
    const auto first = [&](std::int32_t from, std::int32_t origin) {
      return (from - origin + lattice.step - 1) / lattice.step;
    };
    for (std::int32_t row = first(box.y, lattice.box.y); row < lattice.rows;
         ++row) {
      const std::int32_t y = lattice.box.y + row * lattice.step;
      if (y >= box.y + box.height) break;
      std::uint8_t* marked =
          marks.data() + static_cast<std::size_t>(row) *
                             static_cast<std::size_t>(lattice.columns);
      for (std::int32_t column = first(box.x, lattice.box.x);
           column < lattice.columns; ++column) {
        const std::int32_t x = lattice.box.x + column * lattice.step;
        if (x >= box.x + box.width) break;
        if (marked[column] != 0) continue;
        marked[column] =
            DepthInside(outline, x, y, cosine, sine) > -margin ? 1 : 0;
      }
    }
  }
  return marks;
}

void SetLattice(const core::PixelRect& box, std::int32_t step,
                LatticePoints& lattice) {
  lattice.box = box;
  lattice.step = step;
  lattice.columns = (box.width + step - 1) / step;
  lattice.rows = (box.height + step - 1) / step;
}

// The places whose mark is `wanted`.
void TakePoints(const std::vector<std::uint8_t>& marks, std::uint8_t wanted,
                LatticePoints& lattice) {
  lattice.number.assign(marks.size(), -1);
  std::size_t i = 0;
  for (std::int32_t row = 0; row < lattice.rows; ++row) {
    for (std::int32_t column = 0; column < lattice.columns; ++column, ++i) {
      if (marks[i] != wanted) continue;
      lattice.number[i] = static_cast<std::int32_t>(lattice.x.size());
      lattice.x.push_back(lattice.box.x + column * lattice.step);
      lattice.y.push_back(lattice.box.y + row * lattice.step);
    }
  }
}

std::int32_t StepFor(double area, int points) {
  return std::max(
      1, static_cast<std::int32_t>(std::ceil(std::sqrt(area / points))));
}

template <class Sample>
void CopyLevels(const core::Frame& frame, const LatticePoints& points,
                std::size_t from, std::size_t to, float* levels) {
  const Sample* row = frame.row<Sample>(points.y[from] - frame.origin_y_px);
  for (std::size_t i = from; i < to; ++i) {
    levels[i] = static_cast<float>(row[points.x[i] - frame.origin_x_px]);
  }
}

}  // namespace

std::vector<SampledFrame> ChooseFrames(const Clip& clip, const Track& track,
                                       const ExplainedChangeOptions& options) {
  const std::int64_t first_pose = track.poses.front().frame;
  const std::int64_t last_pose = track.poses.back().frame;
  constexpr std::int64_t kLeastSpare = 8;  // frames
  const std::int64_t spare =
      std::max(kLeastSpare, (last_pose - first_pose) / 2);
  const std::int64_t from = std::max(track.first_frame, first_pose - spare);
  const std::int64_t to = std::min(track.last_frame, last_pose + spare + 1);
  std::set<std::int64_t> indices;
  if (clip.ChangesIn(track.first_frame) != nullptr) {
    BackgroundOptions background;
    background.among = options.still_frames;
    for (const std::int64_t index :
         BackgroundFrames(track.first_frame, track.last_frame, background)) {
      if (index >= from && index < to) indices.insert(index);
    }
  } else {
    for (int k = 0; k < options.frames; ++k) {
      indices.insert(from + (2 * k + 1) * (to - from) / (2 * options.frames));
    }
    constexpr std::int64_t kAround = 2;
    if (options.frame_of_interest) {
      const auto at =
          static_cast<std::int64_t>(std::floor(*options.frame_of_interest));
      for (std::int64_t index = std::max(from, at - kAround + 1);
           index < std::min(to, at + kAround + 1); ++index) {
        indices.insert(index);
      }
    }
  }
  std::vector<SampledFrame> frames;
  for (const std::int64_t index : indices) {
    SampledFrame frame;
    frame.index = index;
    frame.is_expected = Expect(track, frame);
    const auto pose = std::lower_bound(
        track.poses.begin(), track.poses.end(), index,
        [](const Pose& p, std::int64_t f) { return p.frame < f; });
    frame.has_pose = pose != track.poses.end() && pose->frame == index;
    // Between two poses that are `step` apart the path is known to be smooth.
    if (!frame.has_pose && pose != track.poses.end() &&
        pose != track.poses.begin() && track.step > 1) {
      frame.has_pose = pose->frame - (pose - 1)->frame <= track.step;
    }
    frame.is_within = index >= first_pose && index <= last_pose;
    frames.push_back(frame);
  }
  return frames;
}

LatticePoints PointsNear(const Clip& clip, const Track& track,
                         const std::vector<SampledFrame>& frames,
                         const ExplainedChangeOptions& options) {
  const core::PixelRect region = RegionOf(clip, options);
  const double margin = MarginOf(track.body);
  core::PixelRect box;
  for (const SampledFrame& frame : frames) {
    if (!frame.is_expected) continue;
    const core::PixelRect one = Intersection(
        OutlineBox(OutlineAt(track.body, frame.pose), margin), region);
    if (one.width == 0 || one.height == 0) continue;
    if (box.width == 0) {
      box = one;
      continue;
    }
    const std::int32_t right = std::max(box.x + box.width, one.x + one.width);
    const std::int32_t bottom =
        std::max(box.y + box.height, one.y + one.height);
    box.x = std::min(box.x, one.x);
    box.y = std::min(box.y, one.y);
    box.width = right - box.x;
    box.height = bottom - box.y;
  }
  LatticePoints lattice;
  if (box.width == 0) return lattice;
  // A coarse lattice first: it tells the area.
  constexpr int kCoarse = 4000;
  SetLattice(box, StepFor(static_cast<double>(box.width) * box.height, kCoarse),
             lattice);
  std::vector<std::uint8_t> marks = MarkNear(track, frames, lattice);
  const auto marked = std::count(marks.begin(), marks.end(), 1);
  const double area = static_cast<double>(marked) * lattice.step * lattice.step;
  const std::int32_t step = StepFor(area, options.points_near);
  if (step != lattice.step) {
    SetLattice(box, step, lattice);
    marks = MarkNear(track, frames, lattice);
  }
  TakePoints(marks, 1, lattice);
  return lattice;
}

LatticePoints PointsElsewhere(const Clip& clip, const Track& track,
                              const std::vector<SampledFrame>& frames,
                              const ExplainedChangeOptions& options) {
  const core::PixelRect region = RegionOf(clip, options);
  LatticePoints lattice;
  SetLattice(region,
             StepFor(static_cast<double>(region.width) * region.height,
                     options.points_elsewhere),
             lattice);
  TakePoints(MarkNear(track, frames, lattice), 0, lattice);
  return lattice;
}

LatticeLevels ReadLevels(Clip& clip, const std::vector<SampledFrame>& frames,
                         const LatticePoints& points, int threads) {
  LatticeLevels levels(frames.size(), points.size());
  if (points.size() == 0) return levels;
  const auto take = [&](Clip& reader, std::size_t k) {
    float* of = levels.of(k);
    const bool by_rows = reader.windows_are_cheap();
    core::Frame frame;
    if (!by_rows) frame = reader.Read(frames[k].index, points.box);
    for (std::size_t from = 0; from < points.size();) {
      std::size_t to = from;
      while (to < points.size() && points.y[to] == points.y[from]) ++to;
      if (by_rows) {
        const core::PixelRect row = {points.x[from], points.y[from],
                                     points.x[to - 1] - points.x[from] + 1, 1};
        frame = reader.Read(frames[k].index, row);
      }
      if (frame.is_16_bit()) {
        CopyLevels<std::uint16_t>(frame, points, from, to, of);
      } else {
        CopyLevels<std::uint8_t>(frame, points, from, to, of);
      }
      from = to;
    }
  };
  if (CanReadApart(clip)) {
    ReadApart(clip, frames.size(), threads, take);
  } else {
    for (std::size_t k = 0; k < frames.size(); ++k) take(clip, k);
  }
  return levels;
}

}  // namespace touchdown::vision
