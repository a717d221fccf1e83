#include "tracking/hidden_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "numbers/robust.h"
#include "outline/outline_pixels.h"
#include "touchdown/calib/plane.h"

namespace touchdown::vision {

bool HiddenFrames::Has(std::int64_t frame) const {
  return std::any_of(hidden_.begin(), hidden_.end(), [&](const Frames& f) {
    return f.first <= frame && frame <= f.last;
  });
}

// A hidden frame casts doubt on all frames up to its sampled neighbours: they
// were not looked at.
void HiddenFrames::LeaveOut(std::vector<Fitted>& sized) {
  const std::vector<bool> hidden = FindHidden(sized);
  std::vector<Fitted> whole;
  for (std::size_t i = 0; i < sized.size(); ++i) {
    if (!hidden[i]) {
      whole.push_back(sized[i]);
      continue;
    }
    // And the frames from the last one that was looked at to the next.
    const std::int64_t first = i > 0 ? sized[i - 1].frame + 1 : 0;
    const std::int64_t last = i + 1 < sized.size() ? sized[i + 1].frame - 1
                                                   : track_.poses.back().frame;
    hidden_.push_back({first, last});
  }
  sized = std::move(whole);
}

// Frames that may show the body in part: those found hidden, and up to `most`
// frames before and after the track where the body comes into view within the
// picture rather than at its border.
std::vector<std::int64_t> HiddenFrames::FindPartialFrames(
    const std::vector<Fitted>& whole, std::int64_t most) const {
  std::vector<std::int64_t> frames;
  for (const Pose& pose : track_.poses) {
    if (Has(pose.frame)) frames.push_back(pose.frame);
  }
  const ClipInfo& info = clip_.info();
  const auto is_inside = [&](const Outline& outline) {
    // In units of the body's greatest extent: nearer to the border the border
    // hides it, not an obstacle. Not studied.
    constexpr double kBorderReach = 1.5;
    const double reach = kBorderReach * Extent(outline);
    return outline.centre.x_px > reach && outline.centre.y_px > reach &&
           outline.centre.x_px < info.width_px - reach &&
           outline.centre.y_px < info.height_px - reach;
  };
  const std::int64_t first = track_.poses.front().frame;
  const std::int64_t last = track_.poses.back().frame;
  if (is_inside(whole.front().fit.outline)) {
    for (std::int64_t k = 1; k <= most && first - k >= track_.first_frame;
         ++k) {
      frames.push_back(first - k);
    }
  }
  if (is_inside(whole.back().fit.outline)) {
    for (std::int64_t k = 1; k <= most && last + k < track_.last_frame; ++k) {
      frames.push_back(last + k);
    }
  }
  return frames;
}

// The outline that the flight through nearby fits predicts, at the body's size;
// nothing outside the picture.
std::optional<OutlineJob> HiddenFrames::Expect(const BodyImage& body,
                                               std::span<const Fitted> fits,
                                               const OutlineOptions& options,
                                               std::int64_t frame) const {
  std::optional<OutlineJob> job = Predict(
      fits, frame, options.ground ? calib::ImageAngle(*options.ground) : 0.0);
  if (!job) return std::nullopt;
  Pose pose;
  pose.centre = job->start.centre;
  pose.angle_rad = job->start.angle_rad;
  job->start = PlaceOutline(body, pose);
  const ClipInfo& info = clip_.info();
  if (pose.centre.x_px < 0.0 || pose.centre.x_px > info.width_px - 1.0 ||
      pose.centre.y_px < 0.0 || pose.centre.y_px > info.height_px - 1.0) {
    return std::nullopt;
  }
  return job;
}

bool HiddenFrames::LookForHider(const std::vector<Fitted>& whole,
                                const BodyImage& body,
                                std::span<const std::optional<Fitted>> own,
                                const OutlineOptions& options) {
  if (!track_.known_background || whole.empty()) return false;
  // Frames beyond the track's ends: enough to see the obstacle's edge. A
  // prediction is worse the farther it reaches. Not studied.
  constexpr std::int64_t kMaxBeyond = 12;
  const std::vector<std::int64_t> beyond = FindPartialFrames(whole, kMaxBeyond);
  if (beyond.empty()) return false;  // it comes and goes by the border
  std::vector<OutlineJob> jobs;
  const auto expect = [&](std::int64_t frame) {
    const auto job = Expect(body, whole, options, frame);
    if (job) jobs.push_back(*job);
  };
  for (const Fitted& f : whole) expect(f.frame);
  for (const std::int64_t frame : beyond) expect(frame);
  // Where the path is drawn aside by frames that are hidden a little, a fit at
  // the body's size is nearer than the path.
  for (const auto& fit : own) {
    if (fit) jobs.push_back({fit->frame, fit->fit.outline, {}, 0.0});
  }
  // The median level of the body's face: what an obstacle shows instead is
  // another.
  std::vector<double> levels;
  for (const Fitted& f : whole) {
    if (f.fit.shading) levels.push_back(f.fit.shading->level[0]);
  }
  if (levels.empty()) return false;
  HiderOptions look;
  look.body_dn = Median(std::move(levels));
  look.blur_px = body.blur_px;
  look.open = options.open;
  auto found = FindHider(clip_, background_, jobs, look);
  if (!found) return false;
  hider_ = std::move(found);
  return true;
}

void HiddenFrames::AddFits(std::vector<Fitted>& fits, const BodyImage& body,
                           const OutlineOptions& options) const {
  if (fits.empty()) return;
  // Frames beyond the track's ends, nearest first, so that each prediction
  // starts from a fit beside it. A bound on time. Not studied.
  constexpr std::int64_t kMaxBeyond = 60;
  std::vector<std::int64_t> frames = FindPartialFrames(fits, kMaxBeyond);
  // Distance, in frames, to the nearest fit.
  const auto from_whole = [&](std::int64_t frame) {
    const auto next = std::lower_bound(
        fits.begin(), fits.end(), frame,
        [](const Fitted& f, std::int64_t at) { return f.frame < at; });
    std::int64_t apart = std::numeric_limits<std::int64_t>::max();
    if (next != fits.end()) apart = next->frame - frame;
    if (next != fits.begin()) {
      apart = std::min(apart, frame - (next - 1)->frame);
    }
    return apart;
  };
  std::vector<std::pair<std::int64_t, std::int64_t>> nearest_first;
  nearest_first.reserve(frames.size());
  for (const std::int64_t frame : frames) {
    nearest_first.emplace_back(from_whole(frame), frame);
  }
  std::sort(nearest_first.begin(), nearest_first.end());

  // In units of the median misfit: a fit that is worse is of the obstacle's
  // edge. Not studied.
  constexpr double kMaxMisfitRatio = 1.5;
  // px from the prediction. Too little of a body may hold it badly; larger
  // takes such fits, smaller loses frames beside an impact. Not studied.
  constexpr double kMaxOff_px = 1.0;
  const double usual = std::max(1.0, MedianMisfit(fits));
  for (const auto& [apart, frame] : nearest_first) {
    const auto job = Expect(body, fits, options, frame);
    if (!job) continue;
    const auto fit = FitOutlines(clip_, background_, {&*job, 1}, options, 1);
    if (!fit[0] || fit[0]->fit.misfit > kMaxMisfitRatio * usual) continue;
    const core::PixelPoint& centre = fit[0]->fit.outline.centre;
    if (std::hypot(centre.x_px - job->start.centre.x_px,
                   centre.y_px - job->start.centre.y_px) > kMaxOff_px) {
      continue;
    }
    const auto at = std::lower_bound(
        fits.begin(), fits.end(), frame,
        [](const Fitted& f, std::int64_t next) { return f.frame < next; });
    fits.insert(at, *fit[0]);
  }
}

}  // namespace touchdown::vision
