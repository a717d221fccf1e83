#include "tracking/layer_pictures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "outline/body_cover.h"

namespace touchdown::vision {

using layers::LayerPose;
using layers::PictureStack;
using layers::Shape;

namespace {

template <class Sample>
void CopyRows(const core::Frame& window, const core::PixelRect& size,
              float* out) {
  for (std::int32_t y = 0; y < size.height; ++y, out += size.width) {
    std::copy_n(window.row<Sample>(y), size.width, out);
  }
}

// Adds what `window`, which lies within `box`, shows of a frame.
void AddPicture(Clip& clip, std::int64_t frame, const core::PixelRect& box,
                const core::PixelRect& window, PictureStack& stack) {
  const core::Frame seen = clip.Read(
      frame, {box.x + window.x, box.y + window.y, window.width, window.height});
  float* const levels = stack.Add(frame, window);
  if (seen.is_16_bit()) {
    CopyRows<std::uint16_t>(seen, window, levels);
  } else {
    CopyRows<std::uint8_t>(seen, window, levels);
  }
  stack.times_s.back() = seen.time_s;
}

double WindowReach(const Shape& shape) {
  // Around the body: what a rough pose may be off, and the blurred edge. More
  // takes memory and time.
  constexpr double kRoom_px = 12.0;
  return shape.Reach() + kRoom_px;
}

// Within `box`. Begins and ends at even pixels (Halve), as the box does.
core::PixelRect ClippedWindow(const LayerPose& pose, const core::PixelRect& box,
                              double reach_px) {
  const auto from = [&](double at, std::int32_t size) {
    const auto begin = static_cast<std::int32_t>(std::floor(at - reach_px));
    return std::clamp(begin, 0, size - 2) / 2 * 2;
  };
  const auto to = [&](double at, std::int32_t begin, std::int32_t size) {
    const auto end = static_cast<std::int32_t>(std::ceil(at + reach_px));
    return (std::clamp(end, begin + 2, size) + 1) / 2 * 2;
  };
  core::PixelRect window;
  window.x = from(pose.x, box.width);
  window.y = from(pose.y, box.height);
  window.width = to(pose.x, window.x, box.width) - window.x;
  window.height = to(pose.y, window.y, box.height) - window.y;
  return window;
}

}  // namespace

core::PixelRect SweptBox(const Background& background, const Track& track,
                         const Shape& shape, double blur_px) {
  double left = 1e9;
  double top = 1e9;
  double right = -1e9;
  double bottom = -1e9;
  const auto include = [&](const core::PixelPoint& at) {
    left = std::min(left, at.x_px);
    right = std::max(right, at.x_px);
    top = std::min(top, at.y_px);
    bottom = std::max(bottom, at.y_px);
  };
  for (const Pose& pose : track.poses) include(pose.centre);
  // Where it goes on from both ends; not far out of the picture.
  const auto& poses = track.poses;
  const auto beyond = [&](const Pose& end, const Pose& next,
                          std::int64_t frame) {
    const Pose there = OnTheWay(end, next, frame);
    include({std::clamp(there.centre.x_px, 0.0, background.width_px - 1.0),
             std::clamp(there.centre.y_px, 0.0, background.height_px - 1.0)});
  };
  beyond(poses[0], poses[1], track.first_frame);
  beyond(poses.back(), poses[poses.size() - 2], track.last_frame - 1);
  const double room = shape.Reach() + 4.0 * blur_px + 8.0;
  const auto from = [room](double at) {
    return std::max(0, static_cast<std::int32_t>(std::floor(at - room)));
  };
  const auto to = [room](double at, std::int32_t end) {
    return std::min(end, static_cast<std::int32_t>(std::ceil(at + room)) + 1);
  };
  core::PixelRect box;
  box.x = from(left);
  box.y = from(top);
  box.width = (to(right, background.width_px) - box.x) / 2 * 2;
  box.height = (to(bottom, background.height_px) - box.y) / 2 * 2;
  return box;
}

std::vector<float> CropBackground(const Background& background,
                                  const core::PixelRect& box) {
  std::vector<float> crop;
  crop.reserve(static_cast<std::size_t>(box.width) *
               static_cast<std::size_t>(box.height));
  for (std::int32_t y = 0; y < box.height; ++y) {
    for (std::int32_t x = 0; x < box.width; ++x) {
      crop.push_back(background.at(box.x + x, box.y + y));
    }
  }
  return crop;
}

LayerPath PathInBox(const Track& track, const core::PixelRect& box,
                    bool turns) {
  LayerPath path;
  for (std::int64_t f = track.poses.front().frame;
       f <= track.poses.back().frame; ++f) {
    const auto pose = InterpolatePose(track, f);
    if (!pose) continue;
    path.frames.push_back(f);
    path.poses.push_back({pose->centre.x_px - box.x, pose->centre.y_px - box.y,
                          turns ? pose->angle_rad : 0.0});
  }
  return path;
}

std::vector<std::size_t> SpreadEvenly(std::size_t count, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t taken = std::min(count, most);
  for (std::size_t i = 0; i < taken; ++i) {
    chosen.push_back(taken == count ? i : i * (count - 1) / (taken - 1));
  }
  return chosen;
}

LayerPath Choose(const LayerPath& all, const std::vector<std::size_t>& chosen) {
  LayerPath some;
  for (const std::size_t i : chosen) {
    some.frames.push_back(all.frames[i]);
    some.poses.push_back(all.poses[i]);
  }
  return some;
}

Track TrackInPicture(const Track& like, const LayerPath& path,
                     const core::PixelRect& box) {
  Track track = like;
  track.poses.clear();
  for (std::size_t t = 0; t < path.frames.size(); ++t) {
    Pose pose;
    pose.frame = path.frames[t];
    pose.centre = {path.poses[t].x + box.x, path.poses[t].y + box.y};
    pose.angle_rad = path.poses[t].angle_rad;
    track.poses.push_back(pose);
  }
  return track;
}

PictureStack ReadPictures(Clip& clip, std::span<const std::int64_t> frames,
                          const core::PixelRect& box) {
  PictureStack stack;
  stack.width = box.width;
  stack.height = box.height;
  stack.levels.reserve(stack.pixels() * frames.size());
  for (const std::int64_t frame : frames) {
    AddPicture(clip, frame, box, {0, 0, box.width, box.height}, stack);
  }
  return stack;
}

PictureReader::PictureReader(Clip& clip, const std::vector<float>& still,
                             const Shape& shape, const core::PixelRect& box)
    : clip_(clip), still_(still), box_(box), reach_px_(WindowReach(shape)) {}

void PictureReader::Read(const LayerPath& path, PictureStack& stack) const {
  stack.Clear();
  stack.width = box_.width;
  stack.height = box_.height;
  const bool keeps_changes = !path.frames.empty() &&
                             clip_.KnownChanges(path.frames.front()) != nullptr;
  if (keeps_changes) {
    stack.outside = still_;
  } else {
    stack.levels.reserve(stack.pixels() * path.frames.size());
  }
  for (std::size_t t = 0; t < path.frames.size(); ++t) {
    AddPicture(clip_, path.frames[t], box_,
               keeps_changes ? ClippedWindow(path.poses[t], box_, reach_px_)
                             : core::PixelRect{0, 0, box_.width, box_.height},
               stack);
  }
}

PictureStack ReadAround(Clip& clip, const LayerPath& path, const Shape& shape) {
  const core::PixelRect whole{0, 0, clip.info().width_px / 2 * 2,
                              clip.info().height_px / 2 * 2};
  PictureStack stack;
  stack.width = whole.width;
  stack.height = whole.height;
  for (std::size_t t = 0; t < path.frames.size(); ++t) {
    AddPicture(clip, path.frames[t], whole,
               ClippedWindow(path.poses[t], whole, WindowReach(shape)), stack);
  }
  return stack;
}

PictureStack ReadPath(Clip& clip, const std::vector<float>& still,
                      const LayerPath& path, const Shape& shape,
                      const core::PixelRect& box) {
  PictureStack stack;
  PictureReader(clip, still, shape, box).Read(path, stack);
  return stack;
}

}  // namespace touchdown::vision
