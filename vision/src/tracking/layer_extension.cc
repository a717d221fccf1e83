#include "tracking/layer_extension.h"

#include <cmath>
#include <cstdlib>
#include <span>

namespace touchdown::vision {
namespace {

// Whether another thing than the body is there: residuals are larger than those
// of the other frames, and the body's picture leaves most of the change
// unexplained. A codec's residuals grow alone, from frame to frame.
bool ShowsSomethingElse(const layers::PoseFit& fit) {
  constexpr double kWorst = 4.0;  // mean squared residual over that of others
  constexpr double kLeastExplained = 0.5;  // of the change. Not studied.
  return fit.chi2 > kWorst && fit.explained < kLeastExplained;
}

}  // namespace

using layers::AlignPose;
using layers::LayerPose;
using layers::PictureStack;
using layers::PoseFit;

PoseFit LayerExtension::Align(std::int64_t frame, const LayerPose& from,
                              const LayerPose& motion) const {
  const PictureStack picture =
      layers::Halve(ReadPictures(clip_, std::span(&frame, 1), box_), 1);
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

void LayerExtension::Extend(std::int64_t by, std::int64_t end,
                            LayerPath& path) const {
  constexpr int kMostMissed = 2;       // frames in a row
  constexpr double kLeastSeen = 0.35;  // of the body
  constexpr double kFarthest = 0.5;    // of the body's reach, beside the way
  std::vector<LayerPose> motions =
      layers::EstimateMotions(path.poses, path.frames);
  LayerPose from = by > 0 ? path.poses.back() : path.poses.front();
  LayerPose motion = by > 0 ? motions.back() : motions.front();
  const auto sign = static_cast<double>(by);
  motion = {sign * motion.x, sign * motion.y, sign * motion.angle_rad};
  std::int64_t last = by > 0 ? path.frames.back() : path.frames.front();
  int missed = 0;
  for (std::int64_t f = last + by; f != end && missed < kMostMissed; f += by) {
    const PoseFit fit = Align(f, from, motion);
    const auto gap = static_cast<double>(std::abs(f - last));
    const double off = std::hypot(fit.pose.x - from.x - motion.x,
                                  fit.pose.y - from.y - motion.y);
    if (!fit.found || ShowsSomethingElse(fit) || fit.seen < kLeastSeen ||
        off > kFarthest * half_.layers.shape.Reach() +
                  std::hypot(motion.x, motion.y)) {
      ++missed;
      from = {from.x + motion.x, from.y + motion.y,
              from.angle_rad + motion.angle_rad};
      continue;
    }
    missed = 0;
    const LayerPose& before = by > 0 ? path.poses.back() : path.poses.front();
    motion = {(fit.pose.x - before.x) / gap, (fit.pose.y - before.y) / gap,
              (fit.pose.angle_rad - before.angle_rad) / gap};
    from = fit.pose;
    last = f;
    const auto at = by > 0 ? path.frames.size() : 0;
    path.frames.insert(path.frames.begin() + static_cast<std::ptrdiff_t>(at),
                       f);
    path.poses.insert(path.poses.begin() + static_cast<std::ptrdiff_t>(at),
                      fit.pose);
  }
}

}  // namespace touchdown::vision
