#include "contact/greatest_gap.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace touchdown::vision {
namespace {

struct Finder {
  const PlaneTrack& track;
  std::size_t since;  // samples before say nothing
  const GroundLevel& ground;
  const FlightOptions& options;
  const Event* event;
  std::optional<GreatestGap> greatest = std::nullopt;

  void SearchStretch(const Stretch& stretch);
  void LookAtFlight(const SampleRange& range);
  void LookAtFrames(const SampleRange& range);
  void SearchInterval(const PlaneSample& a, const PlaneSample& b);
  void LookAfterTouchdown();
  void Offer(const core::Estimate& gap, std::int64_t frame);
  double UncertaintyOfGround(double along_px) const {
    return std::hypot(ground.height_px.u,
                      ground.u_slope_rad * (along_px - ground.along_px));
  }
};

// Among noisy heights the highest is no bounce: a value counts by what it
// surely reaches.
void Finder::Offer(const core::Estimate& gap, std::int64_t frame) {
  if (greatest &&
      gap.value - gap.u <= greatest->gap_px.value - greatest->gap_px.u) {
    return;
  }
  greatest = GreatestGap{gap, frame, std::nullopt};
}

void Finder::LookAtFlight(const SampleRange& range) {
  const auto& samples = track.samples;
  const auto [begin, end] = range;
  const bool first = event && event->after &&
                     event->after_frames.begin >= begin &&
                     event->after_frames.end == end;
  const Flight flight =
      first ? *event->after : FitFlight(SelectSamples(track, range), options);
  // With its u: of the joint fit where ground and flight are one.
  const auto gap_at = [&](double t) {
    if (first) {
      const JointFit& fit = *event->fit;
      const double frames = (t - fit.origin_s) / fit.interval_s;
      return fit.EstimateFunction(
          [&](const JointVector& p) { return fit.ReboundGap(p, frames); });
    }
    const FlightGap g = GapOfFlight(track, flight, t);
    return core::Estimate{
        g.gap_px - ground.height_px.value,
        std::hypot(g.u_px, UncertaintyOfGround(flight.At(t).along_px))};
  };
  const auto height_at = [&](double t) {
    return GapOfFlight(track, flight, t).gap_px;
  };
  // From where it may have left the ground to where it may have met it again.
  const double last = samples[end - 1].time_s;
  const double start =
      begin > 0 ? samples[begin - 1].time_s : samples[begin].time_s;
  const double stop = end < samples.size() ? samples[end].time_s : last;
  // A block that turns has a cusp where its lowest corner changes: the best of
  // some steps, then the best beside it, by thirds.
  constexpr int kSteps = 256;
  constexpr int kThirds = 30;  // to 1e-5 of a step
  const auto highest = [&](double t0, double t1) {
    double best = t0;
    for (int i = 1; i <= kSteps; ++i) {
      const double t = t0 + (t1 - t0) * i / kSteps;
      if (height_at(t) > height_at(best)) best = t;
    }
    double low = std::max(t0, best - (t1 - t0) / kSteps);
    double high = std::min(t1, best + (t1 - t0) / kSteps);
    for (int i = 0; i < kThirds; ++i) {
      const double third = (high - low) / 3.0;
      if (height_at(low + third) < height_at(high - third)) {
        low += third;
      } else {
        high -= third;
      }
    }
    return 0.5 * (low + high);
  };
  const double at =
      highest(std::max(start, first ? event->release_s.value : start), stop);
  const auto seen = SelectSamples(track, range);
  const auto near = std::min_element(
      seen.begin(), seen.end(),
      [&](const PlaneSample& a, const PlaneSample& b) {
        return std::abs(a.time_s - at) < std::abs(b.time_s - at);
      });
  const core::Estimate gap = gap_at(at);
  const bool was = greatest.has_value();
  const double before = was ? greatest->gap_px.value : 0.0;
  Offer(gap, near->frame);
  // Does the film end while it rises?
  if (end < samples.size() || (was && greatest->gap_px.value == before)) {
    return;
  }
  const FlightState state = flight.At(last);
  const FlightGap g = GapOfFlight(track, flight, last);
  if (!(g.rate > 0.0) || !(flight.height[2] > 0.0)) return;
  const double apex =
      last + 2.0 * std::max(state.v_n, g.rate) / flight.height[2];
  const core::Estimate reaches = gap_at(highest(last, apex));
  // By less than the gap's own u it is at its top.
  if (reaches.value - gap.value > gap.u) greatest->reaches_px = reaches;
}

// Frames of no flight: of parabolas through a few neighbours, so that a hop too
// small to be told from rest counts with what it shows.
void Finder::LookAtFrames(const SampleRange& range) {
  const auto [begin, end] = range;
  // 7: the noise of the middle falls to 0.58, and a hop of as many frames is
  // followed exactly.
  constexpr std::size_t kWindow = 7;
  constexpr std::size_t kLeastFrames = 4;
  const std::size_t window = std::min(kWindow, end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t half = window / 2;
    const std::size_t from =
        std::min(i > begin + half ? i - half : begin, end - window);
    const PlaneSample& s = track.samples[i];
    FlightGap local{s.gap_px, 0.0, s.u_gap_px};
    if (window >= kLeastFrames) {
      const Flight flight =
          FitFlight(std::span(track.samples).subspan(from, window));
      local = GapOfFlight(track, flight, s.time_s);
    }
    Offer({local.gap_px - ground.height_px.value,
           std::hypot(local.u_px, UncertaintyOfGround(s.along_px))},
          s.frame);
    if (i > since) SearchInterval(track.samples[i - 1], track.samples[i]);
  }
}

// A block that falls from one corner onto another is lifted off the ground on
// the way, which no frame need show. Its poses in between are those of a steady
// motion; how much more they show than both frames is known to nothing better
// than that: a rectangular distribution of that half-width.
void Finder::SearchInterval(const PlaneSample& a, const PlaneSample& b) {
  if (track.kind != core::BodyKind::kRectangle) return;
  constexpr int kSteps = 16;  // misses a 32nd of what the motion shows
  double most = 0.0;
  const double seen = std::max(a.gap_px, b.gap_px);
  for (int i = 1; i < kSteps; ++i) {
    const double part = static_cast<double>(i) / kSteps;
    const double face = std::lerp(a.face_rad, b.face_rad, part);
    const double height = std::lerp(a.height_px, b.height_px, part);
    most = std::max(most, height - SupportHeight(track, face) - seen);
  }
  const double u_seen = std::max(a.u_gap_px, b.u_gap_px);
  constexpr double kClear = 2.0;  // less is noise of the attitude
  if (most < kClear * u_seen) return;
  Offer({seen + most - ground.height_px.value,
         std::hypot(most / std::numbers::sqrt3, u_seen,
                    UncertaintyOfGround(a.along_px))},
        b.frame);
}

// A body that left the ground flies until it meets it again, be that between
// two frames: from touchdown, where its pose is known best, through the frames
// of one flight, and on to where that flight ends.
void Finder::LookAfterTouchdown() {
  constexpr double kHalfAFrame = 0.5;  // nearer, the exposure spans the impact
  const double dt = track.frame_interval_s;
  const FlightState at = event->before->At(event->time_s.value);
  PlaneSample touchdown;
  touchdown.time_s = event->time_s.value;
  touchdown.along_px = at.along_px;
  touchdown.face_rad = at.face_rad;
  touchdown.height_px =
      ground.height_px.value + SupportHeight(track, at.face_rad);
  constexpr double kLeastU_px = 1e-3;
  const double arm = LowestPointOffset(track, at.face_rad);
  touchdown.u_along_px = std::max(at.u_along_px, kLeastU_px);
  touchdown.u_face_rad = at.u_face_rad;
  touchdown.u_height_px = std::hypot(arm * at.u_face_rad, kLeastU_px);
  const std::vector<PlaneSample>& samples = track.samples;
  const auto first = static_cast<std::size_t>(
      std::find_if(samples.begin(), samples.end(),
                   [&](const PlaneSample& s) {
                     return s.time_s > touchdown.time_s + kHalfAFrame * dt;
                   }) -
      samples.begin());
  // It still stands on the corner that it landed on, so that no other impact
  // lies between.
  if (first == samples.size() ||
      arm * LowestPointOffset(track, samples[first].face_rad) < 0.0) {
    return;
  }
  struct Hop {
    core::Estimate most;
    std::int64_t frame = 0;
    double end_s = 0.0;  // it meets the ground there
  };
  std::optional<Hop> hop;
  std::size_t i = first;
  for (std::vector<PlaneSample> flown{touchdown}; i < samples.size(); ++i) {
    flown.push_back(samples[i]);
    if (flown.size() < LeastFrames(options)) continue;
    const Flight flight = FitFlight(flown, options);
    constexpr double kMostChi2 = 4.0;  // a degree: frames of two motions
    if (flight.reduced_chi2 > kMostChi2) break;
    const auto gap_at = [&](double t) {
      const FlightGap g = GapOfFlight(track, flight, t);
      return core::Estimate{
          g.gap_px - ground.height_px.value,
          std::hypot(g.u_px, UncertaintyOfGround(flight.At(t).along_px))};
    };
    constexpr double kStepsAFrame = 128.0;
    Hop seen{gap_at(samples[i].time_s), samples[i].frame};
    double t = touchdown.time_s;
    for (; t < samples.back().time_s; t += dt / kStepsAFrame) {
      const core::Estimate gap = gap_at(t);
      if (t > samples[i].time_s && gap.value <= 0.0) break;
      if (gap.value > seen.most.value) seen.most = gap;
    }
    seen.end_s = t;
    // A frame that was exposed across the next impact says less.
    if (t - samples[i].time_s > kHalfAFrame * dt) hop = seen;
  }
  // Frames before its end that are not of it refute it.
  if (hop && hop->end_s < samples.back().time_s && i < samples.size() &&
      samples[i].time_s > hop->end_s - kHalfAFrame * dt) {
    Offer(hop->most, hop->frame);
  }
}

void Finder::SearchStretch(const Stretch& stretch) {
  const SampleRange range{std::max(stretch.begin, since), stretch.end};
  if (range.begin >= range.end) return;
  if (stretch.kind == StretchKind::kFlight &&
      range.size() >= LeastFrames(options)) {
    LookAtFlight(range);
  } else {
    LookAtFrames(range);
  }
}

}  // namespace

std::optional<GreatestGap> FindGreatestGap(const PlaneTrack& track,
                                           std::span<const Stretch> stretches,
                                           std::size_t from,
                                           const GroundLevel& ground,
                                           const FlightOptions& options,
                                           const Event* event) {
  Finder finder{track, from, ground, options, event};
  for (const Stretch& stretch : stretches) finder.SearchStretch(stretch);
  if (event && !event->after) finder.LookAfterTouchdown();
  return finder.greatest;
}

}  // namespace touchdown::vision
