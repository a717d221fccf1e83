#include "explanation/change_samples.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "footage/read_apart.h"
#include "outline/body_cover.h"
#include "outline/outline_pixels.h"
#include "outline/track_shape.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {
namespace {

// The stated region, or the whole picture.
core::PixelRect ChooseRegion(const Clip& clip,
                             const ExplainedChangeOptions& options) {
  if (options.region.width > 0) return options.region;
  return {0, 0, clip.info().width_px, clip.info().height_px};
}

// Frames beyond the ends of the track in which the body is expected at a steady
// pace: an impact or gravity soon bends the path. Larger takes another thing's
// change for the body's. Chosen, not measured.
constexpr std::int64_t kMaxExtrapolation = 10;
// Poses that the pace is measured over: more average noise, and see the impact.
// Not studied.
constexpr std::size_t kPacePoses = 4;

// Sets the pose that a frame is expected to show; false where none can be.
bool Expect(const Track& track, SampledFrame& frame) {
  const std::vector<Pose>& poses = track.poses;
  if (const auto pose = InterpolatePose(track, frame.index)) {
    frame.pose = *pose;
    return true;
  }
  if (poses.size() < 2) return false;
  const std::size_t reach = std::min(kPacePoses, poses.size() - 1);
  if (frame.index < poses.front().frame) {
    if (poses.front().frame - frame.index > kMaxExtrapolation) return false;
    frame.pose = OnTheWay(poses.front(), poses[reach], frame.index);
  } else {
    if (frame.index - poses.back().frame > kMaxExtrapolation) return false;
    frame.pose =
        OnTheWay(poses[poses.size() - 1 - reach], poses.back(), frame.index);
  }
  return true;
}

// How far from the outline a pixel counts as near.
double NearMargin(const BodyImage& body) {
  const double size = body.kind == core::BodyKind::kSphere
                          ? 2.0 * body.radius_px.value
                          : 2.0 * body.half_long_px.value;
  // Of the body's size: what was followed at a wrong place still has the body
  // near it. Plus what the blur adds. Not studied.
  constexpr double kMarginOfSize = 0.5;
  constexpr double kMarginBlurs = 3.0;
  return kMarginOfSize * size + kMarginBlurs * body.blur_px;
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

// Marks of the lattice: 1 where the body is near in any of the frames, else 0.
std::vector<std::uint8_t> MarkNearPoints(
    const Track& track, const std::vector<SampledFrame>& frames,
    const LatticePoints& lattice) {
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(lattice.columns) *
                                  static_cast<std::size_t>(lattice.rows));
  const double margin = NearMargin(track.body);
  for (const SampledFrame& frame : frames) {
    if (!frame.is_expected) continue;
    const Outline outline = PlaceOutline(track.body, frame.pose);
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
            SignedDepth(outline, x, y, cosine, sine) > -margin ? 1 : 0;
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

// Numbers the lattice's points whose mark is `wanted`.
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

// The lattice's step in px for about so many points.
std::int32_t ChooseStep(double area, int points) {
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
  // Frames before and after the track, besides half of its length: they show
  // the picture without the body. Not studied.
  constexpr std::int64_t kMinSpare = 8;
  const std::int64_t spare = std::max(kMinSpare, (last_pose - first_pose) / 2);
  const std::int64_t from = std::max(track.first_frame, first_pose - spare);
  const std::int64_t to = std::min(track.last_frame, last_pose + spare + 1);
  std::set<std::int64_t> indices;
  // Where decoding is dear, only frames that are kept whole are looked at.
  if (clip.KnownChanges(track.first_frame) != nullptr) {
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
    // Frames on either side of the frame of interest, all of which are looked
    // at. Not studied.
    constexpr std::int64_t kFramesBeside = 2;
    if (options.frame_of_interest) {
      const auto at =
          static_cast<std::int64_t>(std::floor(*options.frame_of_interest));
      for (std::int64_t index = std::max(from, at - kFramesBeside + 1);
           index < std::min(to, at + kFramesBeside + 1); ++index) {
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

LatticePoints FindNearPoints(const Clip& clip, const Track& track,
                             const std::vector<SampledFrame>& frames,
                             const ExplainedChangeOptions& options) {
  const core::PixelRect region = ChooseRegion(clip, options);
  const double margin = NearMargin(track.body);
  core::PixelRect box;
  for (const SampledFrame& frame : frames) {
    if (!frame.is_expected) continue;
    const core::PixelRect one = Intersection(
        OutlineBox(PlaceOutline(track.body, frame.pose), margin), region);
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
  // Points of a coarse lattice, which tells the area that is near. Not studied.
  constexpr int kCoarsePoints = 4000;
  SetLattice(
      box,
      ChooseStep(static_cast<double>(box.width) * box.height, kCoarsePoints),
      lattice);
  std::vector<std::uint8_t> marks = MarkNearPoints(track, frames, lattice);
  const auto marked = std::count(marks.begin(), marks.end(), 1);
  const double area = static_cast<double>(marked) * lattice.step * lattice.step;
  // The step that gives the wanted number of points on that area.
  const std::int32_t step = ChooseStep(area, options.points_near);
  if (step != lattice.step) {
    SetLattice(box, step, lattice);
    marks = MarkNearPoints(track, frames, lattice);
  }
  TakePoints(marks, 1, lattice);
  return lattice;
}

// Points that the body is never near, over the whole region.
LatticePoints PointsElsewhere(const Clip& clip, const Track& track,
                              const std::vector<SampledFrame>& frames,
                              const ExplainedChangeOptions& options) {
  const core::PixelRect region = ChooseRegion(clip, options);
  LatticePoints lattice;
  SetLattice(region,
             ChooseStep(static_cast<double>(region.width) * region.height,
                        options.points_elsewhere),
             lattice);
  TakePoints(MarkNearPoints(track, frames, lattice), 0, lattice);
  return lattice;
}

// Levels of all points in all frames; row by row, since a window of a row costs
// least.
LatticeLevels ReadLevels(Clip& clip, const std::vector<SampledFrame>& frames,
                         const LatticePoints& points, int threads) {
  LatticeLevels levels(frames.size(), points.size());
  if (points.size() == 0) return levels;
  const auto take = [&](Clip& reader, std::size_t k) {
    float* of = levels.of(k);
    // Rows alone where that is less than the whole window.
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
