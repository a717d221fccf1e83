#include "follow_in_layers.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "body_cover.h"
#include "layers/fit_layers.h"
#include "touchdown/core/parallel.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

using layers::AlignPose;
using layers::FitLayers;
using layers::FitLayersOptions;
using layers::LayerFit;
using layers::LayerPose;
using layers::PictureStack;
using layers::PoseFit;
using layers::Shape;

// Pictures of so many frames are learned from; more cost time and memory and
// tell little more.
constexpr std::size_t kMostLearned = 96;

// Standard uncertainty of the outline's place against a texture, in units of
// blur times the texture's share of the contrast: two clips with photographed
// faces were off by 0.3 and 0.5.
constexpr double kCommonShare = 0.4;

Shape ShapeOf(const BodyImage& body, const std::optional<BodySize>& size) {
  Shape shape;
  shape.disc = body.kind == core::BodyKind::kSphere;
  if (size) {
    shape.half_long = 0.5 * size->long_px.value;
    shape.half_short = 0.5 * size->short_px.value;
  } else if (shape.disc) {
    shape.half_long = body.radius_px.value;
    shape.half_short = body.radius_px.value;
  } else {
    shape.half_long = body.half_long_px.value;
    shape.half_short = body.half_short_px.value;
  }
  if (shape.disc) shape.half_short = shape.half_long;
  return shape;
}

// All that the body passes, with room for its blur and for B's slopes.
core::PixelRect BoxOf(const Background& background, const Track& track,
                      const Shape& shape, double blur) {
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
  const double room = shape.Reach() + 4.0 * blur + 8.0;
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

std::vector<float> CropOf(const Background& background,
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

FitLayersOptions OptionsFor(const Track& track, const Shape& shape,
                            const std::optional<BodySize>& size) {
  FitLayersOptions options;
  auto& value = options.prior.value;
  auto& u = options.prior.u;
  constexpr double kLeastBlur = 0.7;
  value[layers::kBlur] = std::max(track.body.blur_px, kLeastBlur);
  u[layers::kBlur] = 0.5;
  constexpr double kUsualExposure = 0.3;
  value[layers::kExposure] = track.body.shutter_fraction > 0.0
                                 ? track.body.shutter_fraction
                                 : kUsualExposure;
  u[layers::kExposure] = 0.3;
  value[layers::kLong] = shape.half_long;
  value[layers::kShort] = shape.half_short;
  constexpr double kLeastU = 0.02;
  constexpr double kSeenU = 0.3;  // where only the outline tells
  u[layers::kLong] =
      size ? std::max(0.5 * size->long_px.u, kLeastU) : kSeenU;
  u[layers::kShort] =
      shape.disc ? 0.0 : size ? std::max(0.5 * size->short_px.u, kLeastU) : kSeenU;
  const double slope = shape.disc ? 0.0 : 20.0;  // DN
  u[layers::kSlopeX] = slope;
  u[layers::kSlopeY] = slope;
  constexpr double kAnyLevel_dn = 1e4;
  for (std::size_t k = 0; k < layers::kTerms; ++k) {
    u[layers::kQuadratic + k] = kAnyLevel_dn;
  }
  options.turns = !shape.disc;
  return options;
}

// Poses in the box's coordinates, and the frames they are of.
struct Start {
  std::vector<std::int64_t> frames;
  std::vector<LayerPose> poses;
};
Start StartOf(const Track& track, const core::PixelRect& box, bool turns) {
  Start start;
  for (std::int64_t f = track.poses.front().frame;
       f <= track.poses.back().frame; ++f) {
    const auto pose = PoseIn(track, f);
    if (!pose) continue;
    start.frames.push_back(f);
    start.poses.push_back({pose->centre.x_px - box.x, pose->centre.y_px - box.y,
                           turns ? pose->angle_rad : 0.0});
  }
  return start;
}

// So many of `count`, evenly spread, both ends among them.
std::vector<std::size_t> Spread(std::size_t count, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t taken = std::min(count, most);
  for (std::size_t i = 0; i < taken; ++i) {
    chosen.push_back(taken == count ? i : i * (count - 1) / (taken - 1));
  }
  return chosen;
}

Start Choose(const Start& all, const std::vector<std::size_t>& chosen) {
  Start some;
  for (const std::size_t i : chosen) {
    some.frames.push_back(all.frames[i]);
    some.poses.push_back(all.poses[i]);
  }
  return some;
}

PictureStack Choose(const PictureStack& all,
                    const std::vector<std::size_t>& chosen) {
  PictureStack some;
  some.width = all.width;
  some.height = all.height;
  for (const std::size_t i : chosen) {
    some.frames.push_back(all.frames[i]);
    some.times_s.push_back(all.times_s[i]);
    some.levels.insert(some.levels.end(), all.of(i), all.of(i) + all.pixels());
  }
  return some;
}

// As poses of a track, so that frames between can be asked for.
Track PathOf(const Track& like, const Start& start,
             const core::PixelRect& box) {
  Track path = like;
  path.poses.clear();
  for (std::size_t t = 0; t < start.frames.size(); ++t) {
    Pose pose;
    pose.frame = start.frames[t];
    pose.centre = {start.poses[t].x + box.x, start.poses[t].y + box.y};
    pose.angle_rad = start.poses[t].angle_rad;
    path.poses.push_back(pose);
  }
  return path;
}

// Poses at half the resolution and back.
LayerPose Halved(const LayerPose& pose) {
  return {0.5 * (pose.x - 0.5), 0.5 * (pose.y - 0.5), pose.angle_rad};
}
LayerPose Doubled(const LayerPose& pose) {
  return {2.0 * pose.x + 0.5, 2.0 * pose.y + 0.5, pose.angle_rad};
}

FitLayersOptions HalvedOptions(const FitLayersOptions& options) {
  FitLayersOptions half = options;
  constexpr double kHalvingsBlur = 0.3;  // of two pixels taken as one
  half.prior.value[layers::kBlur] =
      std::hypot(0.5 * options.prior.value[layers::kBlur], kHalvingsBlur);
  for (const std::size_t side : {layers::kLong, layers::kShort}) {
    half.prior.value[side] *= 0.5;
    half.prior.u[side] *= 0.5;
  }
  return half;
}

// The pictures of a clip, or, where it keeps only what changes, these parts
// before the background.
PictureStack PicturesOf(Clip& clip, const std::vector<float>& still,
                        const Start& start, const Shape& shape,
                        const core::PixelRect& box) {
  if (clip.ChangesIn(start.frames.front()) == nullptr) {
    return layers::ReadPictures(clip, start.frames, box);
  }
  PictureStack stack;
  stack.width = box.width;
  stack.height = box.height;
  stack.frames = start.frames;
  constexpr double kRoom = 12.0;  // px
  const double reach = shape.Reach() + kRoom;
  for (std::size_t t = 0; t < start.frames.size(); ++t) {
    const auto from = [reach](double at) {
      return std::max(0, static_cast<std::int32_t>(std::floor(at - reach)));
    };
    const auto to = [reach](double at, std::int32_t end) {
      return std::min(end, static_cast<std::int32_t>(std::ceil(at + reach)));
    };
    core::PixelRect window;
    window.x = std::min(from(start.poses[t].x), box.width - 1);
    window.y = std::min(from(start.poses[t].y), box.height - 1);
    window.width = to(start.poses[t].x, box.width) - window.x;
    window.height = to(start.poses[t].y, box.height) - window.y;
    stack.levels.insert(stack.levels.end(), still.begin(), still.end());
    window.width = std::max(window.width, 1);
    window.height = std::max(window.height, 1);
    const PictureStack part = layers::ReadPictures(
        clip, std::span(&start.frames[t], 1),
        {box.x + window.x, box.y + window.y, window.width, window.height});
    stack.times_s.push_back(part.times_s.front());
    float* const levels = stack.levels.data() + t * stack.pixels();
    for (std::int32_t y = 0; y < window.height; ++y) {
      std::copy_n(part.levels.data() + static_cast<std::ptrdiff_t>(y) * window.width,
                  window.width,
                  levels + static_cast<std::ptrdiff_t>(window.y + y) * box.width +
                      window.x);
    }
  }
  return stack;
}

// The frames before and after those of `start` that show the body, too: from
// pose to pose with the layers held, at half the resolution.
class Extension {
 public:
  Extension(Clip& clip, const core::PixelRect& box, const LayerFit& half,
            bool turns)
      : clip_(clip), box_(box), half_(half), turns_(turns) {}

  // Adds them at the end (by = 1, up to frame `end`) or at the beginning
  // (by = -1); poses are at half the resolution.
  void Extend(std::int64_t by, std::int64_t end, Start& start) const;

 private:
  PoseFit Align(std::int64_t frame, const LayerPose& from,
                const LayerPose& motion) const;

  Clip& clip_;
  const core::PixelRect& box_;
  const LayerFit& half_;
  bool turns_;
};

PoseFit Extension::Align(std::int64_t frame, const LayerPose& from,
                         const LayerPose& motion) const {
  const PictureStack picture = layers::Halve(
      layers::ReadPictures(clip_, std::span(&frame, 1), box_), 1);
  const auto next = [&](double share) {
    return LayerPose{from.x + share * motion.x, from.y + share * motion.y,
                     from.angle_rad + share * motion.angle_rad};
  };
  // Straight on, or stopped by a blow.
  PoseFit best = AlignPose(picture, 0, half_.layers, next(1.0), motion, turns_);
  const PoseFit stopped =
      AlignPose(picture, 0, half_.layers, from, motion, turns_);
  if (!best.found || (stopped.found && stopped.chi2 < best.chi2)) {
    best = stopped;
  }
  return best;
}

void Extension::Extend(std::int64_t by, std::int64_t end, Start& start) const {
  constexpr int kMostMissed = 2;    // frames in a row
  constexpr double kWorst = 4.0;    // mean squared residual over that of others
  constexpr double kLeastSeen = 0.35;  // of the body
  constexpr double kFarthest = 0.5;  // of the body's reach, beside the way
  std::vector<LayerPose> motions = MotionsOf(start.poses, start.frames);
  LayerPose from = by > 0 ? start.poses.back() : start.poses.front();
  LayerPose motion = by > 0 ? motions.back() : motions.front();
  const auto sign = static_cast<double>(by);
  motion = {sign * motion.x, sign * motion.y, sign * motion.angle_rad};
  std::int64_t last = by > 0 ? start.frames.back() : start.frames.front();
  int missed = 0;
  for (std::int64_t f = last + by; f != end && missed < kMostMissed; f += by) {
    const PoseFit fit = Align(f, from, motion);
    const auto gap = static_cast<double>(std::abs(f - last));
    const double off = std::hypot(fit.pose.x - from.x - motion.x,
                                  fit.pose.y - from.y - motion.y);
    if (!fit.found || fit.chi2 > kWorst || fit.seen < kLeastSeen ||
        off > kFarthest * half_.layers.shape.Reach() +
                  std::hypot(motion.x, motion.y)) {
      ++missed;
      from = {from.x + motion.x, from.y + motion.y,
              from.angle_rad + motion.angle_rad};
      continue;
    }
    missed = 0;
    const LayerPose& before =
        by > 0 ? start.poses.back() : start.poses.front();
    motion = {(fit.pose.x - before.x) / gap, (fit.pose.y - before.y) / gap,
              (fit.pose.angle_rad - before.angle_rad) / gap};
    from = fit.pose;
    last = f;
    const auto at = by > 0 ? start.frames.size() : 0;
    start.frames.insert(start.frames.begin() + static_cast<std::ptrdiff_t>(at),
                        f);
    start.poses.insert(start.poses.begin() + static_cast<std::ptrdiff_t>(at),
                       fit.pose);
  }
}

Pose PoseFrom(const PoseFit& at, const core::PixelRect& box,
              double noise_ratio) {
  Pose pose;
  pose.centre = {at.pose.x + box.x, at.pose.y + box.y};
  pose.angle_rad = at.pose.angle_rad;
  pose.u_x_px = std::sqrt(at.covariance[0][0]);
  pose.u_y_px = std::sqrt(at.covariance[1][1]);
  constexpr double kMost = 0.99;
  pose.correlation_xy = std::clamp(
      at.covariance[0][1] / (pose.u_x_px * pose.u_y_px), -kMost, kMost);
  pose.u_angle_rad = std::sqrt(std::max(at.covariance[2][2], 0.0));
  pose.misfit = std::sqrt(at.chi2) * noise_ratio;
  return pose;
}

// What a codec leaves out of a slow change along a whole edge no residual shows:
// the part of the noise that goes together from pixel to pixel, as a shift of
// the edge. On 30 clips in H.264 and MJPEG (crf 17 to 23) paths were off by 0.1
// to 1.3 times noise over steepness over tens of frames, 0.5 in the mean square.
double DriftOf(const PoseFit& at, double noise_dn) {
  constexpr double kOfNoise = 0.5;
  const double steep = std::max(at.steepness[0], at.steepness[1]);
  if (at.widened <= 1.0 || steep <= 0.0) return 0.0;
  return kOfNoise * noise_dn / steep *
         std::sqrt(1.0 - 1.0 / (at.widened * at.widened));
}

// Frames that are much worse explained than the others show something else: an
// occluder, or the body where it leaves the picture.
void DropUnexplained(std::vector<Pose>& poses) {
  constexpr double kUsual = 2.0;
  const double most = kUsual * MedianMisfit(poses);
  std::erase_if(poses, [most](const Pose& pose) { return pose.misfit > most; });
}

}  // namespace

bool NeedsLayers(const Track& track, double most_covered) {
  // Covered less, a pixel of the background is untouched by the body.
  constexpr double kUntouched = 0.2;
  // Outlines that are this near to the noise leave nothing to be explained.
  constexpr double kExplained = 1.2;
  return most_covered > kUntouched || !track.known_background ||
         MedianMisfit(track.poses) > kExplained;
}

core::Expected<Track> FollowInLayers(Clip& clip, const Background& background,
                                     const Track& track,
                                     const std::optional<BodySize>& size,
                                     int threads) {
  constexpr std::size_t kLeast = 5;
  if (track.poses.size() < kLeast) {
    return core::AbsentBecause("fewer than five poses");
  }
  if (!IsSteady(track)) {
    return core::AbsentBecause("the body's image does not keep its size");
  }
  clip.cancellation().Enter("the body's picture is learned");
  const Shape shape = ShapeOf(track.body, size);
  FitLayersOptions options = OptionsFor(track, shape, size);
  options.threads = threads;
  const core::PixelRect box =
      BoxOf(background, track, shape, options.prior.value[layers::kBlur]);
  const Start all = StartOf(track, box, options.turns);
  const double noise = std::sqrt(background.UsualVariance());
  std::vector<float> still = CropOf(background, box);
  // So many samples are kept: 256 MiB.
  constexpr std::size_t kMostSamples = std::size_t{1} << 26U;
  const std::size_t most = std::clamp<std::size_t>(
      kMostSamples / std::max<std::size_t>(still.size(), 1), kLeast,
      kMostLearned);
  const auto chosen_of = [&](const Start& start) {
    return Choose(start, Spread(start.frames.size(), most));
  };
  Start learned = chosen_of(all);
  PictureStack stack = PicturesOf(clip, still, learned, shape, box);
  clip.cancellation().Check();

  // First at half the resolution: from rough poses.
  {
    FitLayersOptions coarse = HalvedOptions(options);
    constexpr int kCoarseSteps = 6;
    coarse.steps = kCoarseSteps;
    const Shape half{shape.disc, 0.5 * shape.half_long, 0.5 * shape.half_short};
    for (LayerPose& pose : learned.poses) pose = Halved(pose);
    LayerFit fit = FitLayers(
        layers::Halve(stack, threads), half, learned.poses,
        layers::Halve(still, box.width, box.height), 0.5 * noise, coarse);
    learned.poses = fit.poses;
    const std::size_t found = learned.frames.size();
    if (clip.ChangesIn(learned.frames.front()) == nullptr) {
      const Extension extension(clip, box, fit, options.turns);
      extension.Extend(1, track.last_frame, learned);
      extension.Extend(-1, track.first_frame - 1, learned);
    }
    for (LayerPose& pose : learned.poses) pose = Doubled(pose);
    options.textured = !fit.layers.flat;
    if (learned.frames.size() > found) {
      learned = chosen_of(StartOf(PathOf(track, learned, box), box, options.turns));
      stack = PicturesOf(clip, still, learned, shape, box);
    }
  }
  if (options.textured) {
    // Pictures of so many frames tell a texture well enough.
    constexpr std::size_t kMostTextured = 40;
    const auto chosen = Spread(learned.frames.size(), kMostTextured);
    if (chosen.size() < learned.frames.size()) {
      learned = Choose(learned, chosen);
      stack = Choose(stack, chosen);
    }
    // Where a texture meets the outline, only what was stated tells the size.
    if (size) {
      options.prior.u[layers::kLong] = 0.0;
      options.prior.u[layers::kShort] = 0.0;
    }
  }
  clip.cancellation().Check();
  const LayerFit fit =
      FitLayers(stack, shape, learned.poses, still, noise, options);
  clip.cancellation().Check();

  Track out = track;
  out.poses.clear();
  out.step = 1;
  out.layered = true;
  out.patterned = false;
  out.outlined = true;
  out.known_background = true;
  out.near_ground_modelled = true;
  out.body.blur_px = fit.layers.blur;
  out.body.shutter_fraction = fit.layers.exposure;
  constexpr double kLeastSizeU_px = 0.02;
  const auto take = [](double value, core::Estimate& side) {
    side = {value, std::hypot(side.u, kLeastSizeU_px)};
  };
  if (shape.disc) {
    take(fit.layers.shape.half_long, out.body.radius_px);
  } else {
    take(fit.layers.shape.half_long, out.body.half_long_px);
    take(fit.layers.shape.half_short, out.body.half_short_px);
  }
  // What a texture hides of the outline's place, the same in all frames.
  const double contrast = std::max(std::abs(track.body.contrast_dn), 1.0);
  out.body.u_common_px = fit.layers.flat
                             ? 0.0
                             : kCommonShare * fit.layers.blur *
                                   std::min(1.0, fit.layers.texture_dn / contrast);
  out.body.u_common_angle_rad =
      shape.disc ? 0.0 : out.body.u_common_px / shape.half_long;
  // Each frame with the layers held; those between the learned ones from where
  // they are expected.
  learned.poses = fit.poses;
  const Track path = PathOf(out, learned, box);
  const Start whole = StartOf(path, box, options.turns);
  const std::vector<LayerPose> motions =
      layers::MotionsOf(whole.poses, whole.frames);
  const double noise_ratio = fit.layers.noise_dn / noise;
  std::vector<double> drifts;
  for (std::size_t from = 0; from < whole.frames.size(); from += most) {
    const std::size_t to = std::min(whole.frames.size(), from + most);
    Start part;
    part.frames.assign(whole.frames.begin() + static_cast<std::ptrdiff_t>(from),
                       whole.frames.begin() + static_cast<std::ptrdiff_t>(to));
    part.poses.assign(whole.poses.begin() + static_cast<std::ptrdiff_t>(from),
                      whole.poses.begin() + static_cast<std::ptrdiff_t>(to));
    const bool is_learned = part.frames == learned.frames;
    const PictureStack read =
        is_learned ? PictureStack{}
                   : PicturesOf(clip, still, part, shape, box);
    const PictureStack& pictures = is_learned ? stack : read;
    std::vector<PoseFit> aligned(part.frames.size());
    core::InParallel(
        static_cast<std::int64_t>(aligned.size()), threads,
        [&](std::int64_t begin, std::int64_t end) {
          for (auto t = static_cast<std::size_t>(begin);
               t < static_cast<std::size_t>(end); ++t) {
            aligned[t] = AlignPose(pictures, t, fit.layers, part.poses[t],
                                   motions[from + t], options.turns);
          }
        });
    for (std::size_t t = 0; t < aligned.size(); ++t) {
      if (!aligned[t].found) continue;
      drifts.push_back(DriftOf(aligned[t], fit.layers.noise_dn));
      Pose pose = PoseFrom(aligned[t], box, noise_ratio);
      pose.frame = part.frames[t];
      pose.time_s = pictures.times_s[t];
      out.poses.push_back(pose);
    }
  }
  if (!drifts.empty()) {
    out.body.u_common_px =
        std::hypot(out.body.u_common_px, Median(std::move(drifts)));
  }
  if (out.poses.size() < kLeast) {
    return core::AbsentBecause("too few frames show the body's picture");
  }
  DropUnexplained(out.poses);
  return out;
}

}  // namespace touchdown::vision
