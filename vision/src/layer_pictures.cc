#include "layer_pictures.h"

#include <algorithm>
#include <cmath>

#include "body_cover.h"

namespace touchdown::vision {

using layers::PictureStack;
using layers::Shape;

namespace {

template <class Sample>
void Copy(const core::Frame& frame, const core::PixelRect& box, float* out) {
  for (std::int32_t y = 0; y < box.height; ++y) {
    const Sample* const row = frame.row<Sample>(box.y + y) + box.x;
    for (std::int32_t x = 0; x < box.width; ++x) {
      *out++ = static_cast<float>(row[x]);
    }
  }
}

}  // namespace

core::PixelRect BoxAround(const Background& background, const Track& track,
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
    const auto pose = PoseIn(track, f);
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
  stack.frames.assign(frames.begin(), frames.end());
  stack.levels.resize(stack.pixels() * frames.size());
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const core::Frame frame = clip.Read(frames[t]);
    stack.times_s.push_back(frame.time_s);
    float* const out = stack.levels.data() + t * stack.pixels();
    if (frame.is_16_bit()) {
      Copy<std::uint16_t>(frame, box, out);
    } else {
      Copy<std::uint8_t>(frame, box, out);
    }
  }
  return stack;
}

void PathPictures::Put(std::size_t picture, const core::PixelRect& window,
                       const float* levels, std::int32_t row) {
  float* const out = stack_.levels.data() + picture * stack_.pixels();
  for (std::int32_t y = 0; y < window.height; ++y) {
    std::copy_n(levels + static_cast<std::ptrdiff_t>(y) * row, window.width,
                out + static_cast<std::ptrdiff_t>(window.y + y) * box_.width +
                    window.x);
  }
}

const PictureStack& PathPictures::Read(Clip& clip, const LayerPath& path,
                                       const Shape& shape) {
  if (clip.ChangesIn(path.frames.front()) == nullptr) {
    stack_ = ReadPictures(clip, path.frames, box_);
    written_.clear();
    return stack_;
  }
  stack_.width = box_.width;
  stack_.height = box_.height;
  stack_.frames = path.frames;
  stack_.times_s.clear();
  const std::size_t count = path.frames.size();
  if (written_.size() > count) written_.resize(count);
  stack_.levels.resize(written_.size() * stack_.pixels());
  stack_.levels.reserve(count * stack_.pixels());
  constexpr double kRoom = 12.0;  // px
  const double reach = shape.Reach() + kRoom;
  for (std::size_t t = 0; t < count; ++t) {
    const auto from = [reach](double at) {
      return std::max(0, static_cast<std::int32_t>(std::floor(at - reach)));
    };
    const auto to = [reach](double at, std::int32_t end) {
      return std::min(end, static_cast<std::int32_t>(std::ceil(at + reach)));
    };
    core::PixelRect window;
    window.x = std::min(from(path.poses[t].x), box_.width - 1);
    window.y = std::min(from(path.poses[t].y), box_.height - 1);
    window.width = std::max(to(path.poses[t].x, box_.width) - window.x, 1);
    window.height = std::max(to(path.poses[t].y, box_.height) - window.y, 1);
    if (t < written_.size()) {
      const core::PixelRect& old = written_[t];
      Put(t, old,
          still_.data() + static_cast<std::ptrdiff_t>(old.y) * box_.width +
              old.x,
          box_.width);
      written_[t] = window;
    } else {
      stack_.levels.insert(stack_.levels.end(), still_.begin(), still_.end());
      written_.push_back(window);
    }
    const PictureStack part = ReadPictures(
        clip, std::span(&path.frames[t], 1),
        {box_.x + window.x, box_.y + window.y, window.width, window.height});
    stack_.times_s.push_back(part.times_s.front());
    Put(t, window, part.levels.data(), window.width);
  }
  return stack_;
}

PictureStack ReadAlong(Clip& clip, const std::vector<float>& still,
                       const LayerPath& path, const Shape& shape,
                       const core::PixelRect& box) {
  PathPictures pictures(still, box);
  pictures.Read(clip, path, shape);
  return std::move(pictures).Take();
}

}  // namespace touchdown::vision
