#include "greatest_gap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchdown::vision {
namespace {

struct Finder {
  const PlaneTrack& track;
  std::size_t since;  // samples before say nothing
  const GroundLevel& ground;
  const FlightOptions& options;
  const Event* event;
  std::optional<GreatestGap> greatest = std::nullopt;

  void LookAt(const Stretch& stretch);
  void LookAtFlight(const SampleRange& range);
  void LookAtFrames(const SampleRange& range);
  void LookBetween(const PlaneSample& a, const PlaneSample& b);
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
      first ? *event->after : FitFlight(SamplesIn(track, range), options);
  // With its u: of the joint fit where ground and flight are one.
  const auto gap_at = [&](double t) {
    if (first) {
      const JointFit& fit = *event->fit;
      const double frames = (t - fit.origin_s) / fit.interval_s;
      return fit.Of(
          [&](const JointVector& p) { return fit.GapAfter(p, frames); });
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
  const auto seen = SamplesIn(track, range);
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
    if (i > since) LookBetween(track.samples[i - 1], track.samples[i]);
  }
}

// A block that falls from one corner onto another is lifted off the ground on
// the way, which no frame need show. Its poses in between are those of a steady
// motion; how much more they show than both frames is known to nothing better
// than that: a rectangular distribution of that half-width.
void Finder::LookBetween(const PlaneSample& a, const PlaneSample& b) {
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

void Finder::LookAt(const Stretch& stretch) {
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
  for (const Stretch& stretch : stretches) finder.LookAt(stretch);
  return finder.greatest;
}

}  // namespace touchdown::vision
