#include "tracking/between_looks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "numbers/robust.h"
#include "outline/body_cover.h"

namespace touchdown::vision {
namespace {

// Lagrange's cubic through four values at -3, -1, 1 and 3 half steps, at `s`
// half steps.
double EvaluateCubic(const std::array<double, 4>& v, double s) {
  // Products of the distances between the nodes: 2 4 6 and 2 2 4.
  constexpr double kOuter = 48.0;
  constexpr double kInner = 16.0;
  return -(s + 1) * (s - 1) * (s - 3) / kOuter * v[0] +
         (s + 3) * (s - 1) * (s - 3) / kInner * v[1] -
         (s + 3) * (s + 1) * (s - 3) / kInner * v[2] +
         (s + 3) * (s + 1) * (s - 1) / kOuter * v[3];
}

// How far pose i lies off the cubic through its four neighbours, two on each
// side and all a step apart.
template <class Value>
double OffCubic(const std::vector<Pose>& poses, std::size_t i,
                const Value& value) {
  // Lagrange weights at 0 of nodes at -2, -1, 1, 2: -1/6, 4/6, 4/6, -1/6.
  constexpr double kNear = 4.0 / 6.0;
  constexpr double kFar = -1.0 / 6.0;
  return value(poses[i]) - kNear * (value(poses[i - 1]) + value(poses[i + 1])) -
         kFar * (value(poses[i - 2]) + value(poses[i + 2]));
}

bool IsOnCubic(const std::vector<Pose>& poses, std::size_t i, double reach_px) {
  // px (for the angle: at the outline). A fit that starts so far off converges.
  // Larger leaves out frames beside an impact; smaller fits frames for nothing.
  // Not studied.
  constexpr double kMaxOff_px = 0.1;
  // Standard deviations: noisy poses lie off the cubic by noise alone. Not
  // studied.
  constexpr double kNoiseSigmas = 5.0;
  const Pose& pose = poses[i];
  const auto is_near = [](double off, double u, double most) {
    return std::abs(off) < std::max(most, kNoiseSigmas * u);
  };
  return is_near(
             OffCubic(poses, i, [](const Pose& p) { return p.centre.x_px; }),
             pose.u_x_px, kMaxOff_px) &&
         is_near(
             OffCubic(poses, i, [](const Pose& p) { return p.centre.y_px; }),
             pose.u_y_px, kMaxOff_px) &&
         is_near(OffCubic(poses, i, [](const Pose& p) { return p.angle_rad; }),
                 pose.u_angle_rad, kMaxOff_px / reach_px);
}

}  // namespace

std::vector<bool> CanBeBridged(const std::vector<Fitted>& fits,
                               const std::vector<Pose>& poses,
                               std::int64_t step) {
  const std::size_t n = poses.size();
  std::vector<bool> bridged(n, false);
  // Poses: two on either side of the one that is tested.
  constexpr std::size_t kMinPoses = 5;
  if (n < kMinPoses || fits.size() != n) return bridged;
  // In a step, 29 deg: a rectangle looks the same after half a turn, which
  // would be hidden between two frames. A sixth of that. Not studied.
  constexpr double kMaxTurn_rad = 0.5;
  std::vector<double> misfits;
  misfits.reserve(n);
  for (const Pose& pose : poses) misfits.push_back(pose.misfit);
  // In units of the median misfit (at least 1, the noise): an outline that fits
  // twice as badly is of another thing. Not studied.
  constexpr double kMaxMisfitRatio = 2.0;
  const double most_misfit = kMaxMisfitRatio * std::max(1.0, Median(misfits));
  const auto is_good = [&](std::size_t i) {
    const OutlineFit& fit = fits[i].fit;
    return fit.visible >= kWhollySeen && fit.hidden == 0.0 &&
           fit.misfit <= most_misfit;
  };
  const auto is_step = [&](std::size_t i) {  // to the next
    return poses[i + 1].frame - poses[i].frame == step &&
           std::abs(poses[i + 1].angle_rad - poses[i].angle_rad) < kMaxTurn_rad;
  };
  // 1: on the cubic; 0: off it; -1: there are no two looks on either side.
  std::vector<int> on_cubic(n, -1);
  for (std::size_t i = 2; i + 2 < n; ++i) {
    if (!(is_step(i - 2) && is_step(i - 1) && is_step(i) && is_step(i + 1))) {
      continue;
    }
    const double reach_px = OutlineSize(fits[i].fit);
    on_cubic[i] = IsOnCubic(poses, i, reach_px) ? 1 : 0;
  }
  // A gap is bridged where neither end lies off its cubic and at least one lies
  // on it; its four nearest poses are a step apart and show the whole body
  // well.
  for (std::size_t i = 1; i + 2 < n; ++i) {
    bridged[i] = on_cubic[i] != 0 && on_cubic[i + 1] != 0 &&
                 on_cubic[i] + on_cubic[i + 1] >= 0 && is_step(i - 1) &&
                 is_step(i) && is_step(i + 1) && is_good(i - 1) && is_good(i) &&
                 is_good(i + 1) && is_good(i + 2);
  }
  return bridged;
}

bool MayChangeSize(const std::vector<Fitted>& fits) {
  // Relative change from the first third to the last. Smaller fits all frames
  // of steady bodies; larger misses a body that nears the camera. Not studied.
  constexpr double kMaxSizeChange = 0.005;
  const std::size_t third = fits.size() / 3;
  if (third == 0) return true;
  std::vector<double> early;
  std::vector<double> late;
  for (std::size_t i = 0; i < third; ++i) {
    early.push_back(OutlineSize(fits[i].fit));
    late.push_back(OutlineSize(fits[fits.size() - 1 - i].fit));
  }
  const double before = Median(std::move(early));
  return std::abs(Median(std::move(late)) - before) > kMaxSizeChange * before;
}

Track Bridged(const Track& track) {
  Track whole = track;
  if (track.step <= 1) return whole;
  whole.poses.clear();
  const auto& poses = track.poses;
  const auto at = [&](std::int64_t frame) {
    const auto found = std::lower_bound(
        poses.begin(), poses.end(), frame,
        [](const Pose& pose, std::int64_t f) { return pose.frame < f; });
    return found != poses.end() && found->frame == frame ? &*found : nullptr;
  };
  for (std::size_t i = 0; i < poses.size(); ++i) {
    whole.poses.push_back(poses[i]);
    if (i + 1 == poses.size() ||
        poses[i + 1].frame - poses[i].frame != track.step) {
      continue;
    }
    // The cubic needs both outer neighbours; else the path is straight.
    const Pose* const before = at(poses[i].frame - track.step);
    const Pose* const after = at(poses[i + 1].frame + track.step);
    for (std::int64_t k = 1; k < track.step; ++k) {
      const std::int64_t frame = poses[i].frame + k;
      Pose pose = OnTheWay(poses[i], poses[i + 1], frame);
      const double share =
          static_cast<double>(k) / static_cast<double>(track.step);
      pose.time_s = std::lerp(poses[i].time_s, poses[i + 1].time_s, share);
      if (before != nullptr && after != nullptr) {
        const auto on_cubic = [&](const auto& value) {
          return EvaluateCubic({value(*before), value(poses[i]),
                                value(poses[i + 1]), value(*after)},
                               2.0 * share - 1.0);
        };
        pose.centre.x_px =
            on_cubic([](const Pose& p) { return p.centre.x_px; });
        pose.centre.y_px =
            on_cubic([](const Pose& p) { return p.centre.y_px; });
        pose.angle_rad = on_cubic([](const Pose& p) { return p.angle_rad; });
      }
      whole.poses.push_back(pose);
    }
  }
  return whole;
}

}  // namespace touchdown::vision
