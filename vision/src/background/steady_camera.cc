#include "touchdown/vision/background/steady_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "background/cubic.h"
#include "background/scene_motion.h"
#include "footage/kept_pixels.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// The clip's frames, put back to where frame `first` saw the scene.
class SteadyClip final : public Clip {
 public:
  // What all readers of the clip share.
  struct Motions {
    std::int64_t first = 0;
    std::vector<Similarity> of;
    std::vector<std::uint16_t> outside;  // frame `first`, as it is given out
  };

  SteadyClip(std::unique_ptr<Clip> clip, std::shared_ptr<const Motions> motions)
      : clip_(std::move(clip)),
        motions_(std::move(motions)),
        info_(clip_->info()) {
    set_cancellation(clip_->cancellation());
    info_.bit_depth = kBits;
  }

  static constexpr int kBits = 16;          // rounding to fewer would add noise
  static constexpr float kFull = 65535.0F;  // of these bits

  const ClipInfo& info() const override { return info_; }
  std::int64_t EntryFrame(std::int64_t index) const override {
    return clip_->EntryFrame(index);
  }
  std::unique_ptr<Clip> Another() const override {
    std::unique_ptr<Clip> another = clip_->Another();
    if (!another) return nullptr;
    return std::make_unique<SteadyClip>(std::move(another), motions_);
  }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    core::Frame frame = clip_->Read(index);
    samples_.resize(static_cast<std::size_t>(window.width) *
                    static_cast<std::size_t>(window.height));
    if (frame.is_16_bit()) {
      PutBack<std::uint16_t>(frame, MotionOf(index), window);
    } else {
      PutBack<std::uint8_t>(frame, MotionOf(index), window);
    }
    frame.data = reinterpret_cast<const std::byte*>(samples_.data());
    frame.stride_bytes = 2 * static_cast<std::ptrdiff_t>(window.width);
    frame.bit_depth = kBits;
    return frame;
  }

 private:
  Similarity MotionOf(std::int64_t index) const {
    const std::int64_t at = index - motions_->first;
    if (at < 0) return {};
    return motions_->of[static_cast<std::size_t>(
        std::min(at, static_cast<std::int64_t>(motions_->of.size()) - 1))];
  }

  template <class Sample>
  void PutBack(const core::Frame& frame, const Similarity& m,
               const core::PixelRect& window) {
    const double centre_x = 0.5 * (info_.width_px - 1);
    const double centre_y = 0.5 * (info_.height_px - 1);
    const float scale = kFull / static_cast<float>(frame.full_scale());
    std::size_t out = 0;
    for (std::int32_t y = window.y; y < window.y + window.height; ++y) {
      const double dy = y - centre_y;
      const std::uint16_t* const outside =
          motions_->outside.data() +
          static_cast<std::size_t>(y) *
              static_cast<std::size_t>(info_.width_px);
      for (std::int32_t x = window.x; x < window.x + window.width; ++x) {
        const double dx = x - centre_x;
        const auto level =
            InterpolateCubic(frame.width_px, frame.height_px,
                             x + m.shift_x_px + m.grow * dx - m.turn * dy,
                             y + m.shift_y_px + m.turn * dx + m.grow * dy,
                             [&frame](std::int32_t i, std::int32_t j) {
                               return frame.row<Sample>(j)[i];
                             });
        samples_[out++] = level ? static_cast<std::uint16_t>(std::clamp(
                                      scale * *level + 0.5F, 0.0F, kFull))
                                : outside[x];
      }
    }
  }

  std::unique_ptr<Clip> clip_;
  std::shared_ptr<const Motions> motions_;
  ClipInfo info_;
  std::vector<std::uint16_t> samples_;
};

// Frames to look at, in order, after `first`.
std::vector<std::int64_t> ChooseLooks(const Clip& clip, std::int64_t first,
                                      std::int64_t last,
                                      const SteadyCameraOptions& options) {
  std::vector<std::int64_t> frames;
  const auto add = [&](std::int64_t end, bool at_entries) {
    for (std::int64_t k = 1; k <= options.looks; ++k) {
      const std::int64_t at = first + k * (end - 1 - first) / options.looks;
      const std::int64_t frame = at_entries ? clip.EntryFrame(at) : at;
      if (frame > (frames.empty() ? first : frames.back())) {
        frames.push_back(frame);
      }
    }
  };
  add(last, true);
  if (frames.empty()) add(std::min(last, first + options.most_decoded), false);
  return frames;
}

// Whether it is the camera that moved.
bool IsOfTheCamera(const MotionSupport& support, const SceneMotion& seen,
                   const ClipInfo& info, const SteadyCameraOptions& options) {
  return support.of_all >= options.least_support &&
         support.of_third >= options.least_support_of_third &&
         seen.corner_px <=
             options.most_moved * std::min(info.width_px, info.height_px);
}

bool HasMoved(const SceneMotion& seen, const SteadyCameraOptions& options) {
  return seen.corner_px >= std::max(options.least_moved_px,
                                    options.least_sigmas * seen.u_corner_px);
}

// A frame's samples as SteadyClip gives them out.
std::vector<std::uint16_t> SamplesOf(const core::Frame& frame) {
  std::vector<std::uint16_t> samples;
  const double scale = static_cast<double>(SteadyClip::kFull) /
                       static_cast<double>(frame.full_scale());
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    for (std::int32_t x = 0; x < frame.width_px; ++x) {
      samples.push_back(
          static_cast<std::uint16_t>(std::lround(scale * frame.at(x, y))));
    }
  }
  return samples;
}

// What the looks say: whether anything moved that could be the camera, and the
// noise of a residual between neighbouring frames.
struct FirstLooks {
  bool may_have_moved = false;
  double noise_dn = 0.0;
};

FirstLooks LookForMotion(Clip& clip, std::int64_t first, std::int64_t last,
                         const SteadyCameraOptions& options) {
  FirstLooks out;
  const core::PixelRect whole = Whole(clip.info());
  clip.WillReadOnce(first, whole);
  const SceneReference reference(clip.Read(first), options.points_looked_at);
  if (reference.is_empty()) return out;
  // To tell motion from none needs no more: a fraction of the least motion.
  constexpr double kShare = 0.2;
  const auto look = [&](std::int64_t index) {
    clip.WillReadOnce(index, whole);
    return reference.AlignShift(clip.Read(index),
                                kShare * options.least_moved_px);
  };
  try {
    out.noise_dn = look(std::min(first + 1, last - 1)).sigma_dn;
    for (const std::int64_t index : ChooseLooks(clip, first, last, options)) {
      out.may_have_moved = HasMoved(look(index), options);
      if (out.may_have_moved) break;
    }
  } catch (const core::InputError&) {
    // It is for whoever needs that frame.
  }
  return out;
}

}  // namespace

CameraMotion MeasureCameraMotion(Clip& clip, std::int64_t first,
                                 std::int64_t last,
                                 const SteadyCameraOptions& options) {
  const ClipInfo& info = clip.info();
  if (first < 0 || last > info.frames || first >= last) {
    throw std::invalid_argument(
        fmt::format("frames is {}:{}, must be a range within 0:{}", first, last,
                    info.frames));
  }
  CameraMotion out;
  out.first = first;
  const FirstLooks looks = LookForMotion(clip, first, last, options);
  if (!looks.may_have_moved) return out;
  const SceneReference reference(clip.Read(first), options.points);
  // Each frame, from where the one before was.
  Similarity last_known;
  double most_px = 0.0;
  double u_px = 0.0;
  double moved = 0.0;  // frames
  double of_the_camera = 0.0;
  double all_move = 0.0;
  // Frames, after which it is given up where most of them say that it is not
  // the camera. Not studied.
  constexpr double kEnough = 16.0;
  // Frames that a motion of the camera explains, from which on the rest of a
  // restless scene is its parallax: the near and the far part ways as the
  // camera goes on. A flickering scene has none. One could be chance.
  constexpr double kFewExplained = 2.0;
  const auto is_refuted = [&](double least) {
    return of_the_camera < least * moved;
  };
  for (std::int64_t index = first; index < last; ++index) {
    if (moved >= kEnough && is_refuted(0.5)) break;
    try {
      const core::Frame frame = clip.Read(index);
      const SceneMotion seen = reference.Align(frame, last_known);
      const bool has_moved = HasMoved(seen, options);
      MotionSupport support;
      if (has_moved) {
        support = reference.CountSupport(frame, seen, looks.noise_dn);
        moved += 1.0;
        all_move +=
            support.restless >= options.least_support_of_third ? 1.0 : 0.0;
      }
      const bool is_of_the_camera =
          !has_moved || IsOfTheCamera(support, seen, info, options);
      if (is_of_the_camera) {
        last_known = seen.motion;
        of_the_camera += has_moved ? 1.0 : 0.0;
        most_px = std::max(most_px, seen.corner_px);
        u_px = std::max(u_px, seen.u_corner_px);
      }
    } catch (const core::InputError&) {
      // The place of the frame before.
    }
    out.of.push_back(last_known);
  }
  if (of_the_camera == 0.0 || is_refuted(options.least_frames)) {
    out.of.clear();
    out.unexplained = of_the_camera >= kFewExplained &&
                      all_move >= options.least_frames * moved;
    return out;
  }
  out.most_moved_px = core::Estimate{most_px, u_px};
  return out;
}

std::unique_ptr<Clip> PutBack(std::unique_ptr<Clip> clip,
                              const CameraMotion& motion) {
  if (motion.of.empty()) return clip;
  auto motions = std::make_shared<SteadyClip::Motions>();
  motions->first = motion.first;
  motions->of = motion.of;
  motions->outside = SamplesOf(clip->Read(motion.first));
  return std::make_unique<SteadyClip>(std::move(clip), std::move(motions));
}

}  // namespace touchdown::vision
