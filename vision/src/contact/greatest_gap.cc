#include "contact/greatest_gap.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace touchdown::vision {
namespace {

// Of a frame interval: what a measured exposure is off by. Less takes a mixture
// of two motions for a pose; more loses frames and widens gaps. Not studied.
constexpr double kExposureError = 0.1;

struct Finder {
  const PlaneTrack& track;
  std::size_t since;  // first sample after the contact
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
  core::Estimate GapAt(const Flight& flight, double time_s) const;
  double UncertaintyOfGround(double along_px) const {
    return std::hypot(ground.height_px.u,
                      ground.u_slope_rad * (along_px - ground.along_px));
  }
};

core::Estimate Finder::GapAt(const Flight& flight, double time_s) const {
  const FlightGap g = GapOfFlight(track, flight, time_s);
  return {g.gap_px - ground.height_px.value,
          std::hypot(g.u_px, UncertaintyOfGround(flight.At(time_s).along_px))};
}

// Keeps the gap with the greatest lower bound, gap - u: among many noisy
// heights the highest is no bounce.
void Finder::Offer(const core::Estimate& gap, std::int64_t frame) {
  if (greatest &&
      gap.value - gap.u <= greatest->gap_px.value - greatest->gap_px.u) {
    return;
  }
  greatest = GreatestGap{gap, frame, std::nullopt};
}

// The apex of a flight, also between two frames. The flight after the contact
// is that of the joint fit; others are fitted here.
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
    if (!first) return GapAt(flight, t);
    const JointFit& fit = *event->fit;
    const double frames = (t - fit.origin_s) / fit.interval_s;
    return fit.EstimateFunction(
        [&](const JointVector& p) { return fit.ReboundGap(p, frames); });
  };
  const auto height_at = [&](double t) {
    return GapOfFlight(track, flight, t).gap_px;
  };
  // The search reaches from the frame before the flight, where the body may
  // have left the ground, to the frame after it.
  const double last = samples[end - 1].time_s;
  const double start =
      begin > 0 ? samples[begin - 1].time_s : samples[begin].time_s;
  const double stop = end < samples.size() ? samples[end].time_s : last;
  // A block that turns has a cusp where its lowest corner changes, so that the
  // gap has several maxima: the best of equal steps, then the best beside it by
  // ternary search. More steps cost time only. Not studied.
  constexpr int kSteps = 256;
  // (2/3)^30: to 1e-5 of a step.
  constexpr int kThirds = 30;
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
  // Only where the film ends in this flight, and this flight is the greatest,
  // may the body still rise.
  if (end < samples.size() || (was && greatest->gap_px.value == before)) {
    return;
  }
  const FlightState state = flight.At(last);
  const FlightGap g = GapOfFlight(track, flight, last);
  if (!(g.rate > 0.0) || !(flight.height[2] > 0.0)) return;
  // The centre rises for v_n / g; the lowest point of a turning body may do so
  // for longer: twice that bounds the search.
  const double apex =
      last + 2.0 * std::max(state.v_n, g.rate) / flight.height[2];
  const core::Estimate reaches = gap_at(highest(last, apex));
  // By less than the gap's own u it is at its top.
  if (reaches.value - gap.value > gap.u) greatest->reaches_px = reaches;
}

// Frames of no flight: parabolas through a few neighbours give their gap, so
// that a hop too small to be told from rest counts with what it shows.
void Finder::LookAtFrames(const SampleRange& range) {
  const auto [begin, end] = range;
  // Frames. At 7 the noise of the middle one falls to 0.58 (a parabola's), and
  // a hop of as many frames is followed exactly. More flattens short hops;
  // fewer offers noise as a gap. Not studied.
  constexpr std::size_t kWindow = 7;
  // Three frames pass through any parabola; a frame then speaks for itself.
  constexpr std::size_t kMinWindow = 4;
  const std::size_t window = std::min(kWindow, end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t half = window / 2;
    const std::size_t from =
        std::min(i > begin + half ? i - half : begin, end - window);
    const PlaneSample& s = track.samples[i];
    FlightGap local{s.gap_px, 0.0, s.u_gap_px};
    if (window >= kMinWindow) {
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
// the way, which no frame need show. Its poses between the frames are those of
// a steady motion. Nothing tells better how much higher it was than either
// frame shows: the excess has a rectangular distribution of that half-width (u
// = half-width / sqrt 3, GUM 4.3.7).
void Finder::SearchInterval(const PlaneSample& a, const PlaneSample& b) {
  if (track.kind != core::BodyKind::kRectangle) return;
  // Steps between two frames: the highest of them misses at most a 32nd of the
  // excess.
  constexpr int kSteps = 16;
  double most = 0.0;
  const double seen = std::max(a.gap_px, b.gap_px);
  for (int i = 1; i < kSteps; ++i) {
    const double part = static_cast<double>(i) / kSteps;
    const double face = std::lerp(a.face_rad, b.face_rad, part);
    const double height = std::lerp(a.height_px, b.height_px, part);
    most = std::max(most, height - SupportHeight(track, face) - seen);
  }
  const double u_seen = std::max(a.u_gap_px, b.u_gap_px);
  // Standard deviations of a frame's gap: a smaller excess is noise of the
  // attitude. Not studied.
  constexpr double kClearSigmas = 2.0;
  if (most < kClearSigmas * u_seen) return;
  Offer({seen + most - ground.height_px.value,
         std::hypot(most / std::numbers::sqrt3, u_seen,
                    UncertaintyOfGround(a.along_px))},
        b.frame);
}

// Looks for a hop that begins at touchdown and ends between two frames: a body
// that left the ground flies until it meets it again. Its path starts where the
// pose is known best, at touchdown, goes through the frames of one flight, and
// on to where that flight ends.
void Finder::LookAfterTouchdown() {
  // Nearer to an impact the exposure may span it.
  const double dt = track.frame_interval_s;
  const double spans_s =
      std::min(0.5, 0.5 * track.exposure + kExposureError) * dt;
  const FlightState at = event->before->At(event->time_s.value);
  PlaneSample touchdown;
  touchdown.time_s = event->time_s.value;
  touchdown.along_px = at.along_px;
  touchdown.face_rad = at.face_rad;
  touchdown.height_px =
      ground.height_px.value + SupportHeight(track, at.face_rad);
  // px: the constructed pose must not outweigh what was seen, nor divide by
  // zero.
  constexpr double kMinU_px = 1e-3;
  const double arm = LowestPointOffset(track, at.face_rad);
  touchdown.u_along_px = std::max(at.u_along_px, kMinU_px);
  touchdown.u_face_rad = at.u_face_rad;
  touchdown.u_height_px = std::hypot(arm * at.u_face_rad, kMinU_px);
  const std::vector<PlaneSample>& samples = track.samples;
  const auto first = static_cast<std::size_t>(
      std::find_if(samples.begin(), samples.end(),
                   [&](const PlaneSample& s) {
                     return s.time_s > touchdown.time_s + spans_s;
                   }) -
      samples.begin());
  // If the lowest corner is another than at touchdown, a second impact lies
  // between, and the path is no flight.
  if (first == samples.size() ||
      arm * LowestPointOffset(track, samples[first].face_rad) < 0.0) {
    return;
  }
  struct Hop {
    Flight flight;
    const PlaneSample* last = nullptr;
    double end_s = 0.0;  // it meets the ground there
  };
  // Steps a frame: the apex is missed by g dt^2 / (8 * 128^2) at most.
  constexpr double kStepsPerFrame = 128.0;
  const double step_s = dt / kStepsPerFrame;
  const double film_ends_s = samples.back().time_s;
  std::optional<Hop> hop;
  std::size_t i = first;
  for (std::vector<PlaneSample> flown{touchdown}; i < samples.size(); ++i) {
    flown.push_back(samples[i]);
    if (flown.size() < MinFlightFrames(options)) continue;
    const Flight flight = FitFlight(flown, options);
    // Per degree of freedom. Above it the frames are of two motions and the hop
    // has ended. Not studied.
    constexpr double kMaxReducedChi2 = 4.0;
    if (flight.reduced_chi2 > kMaxReducedChi2) break;
    double end_s = samples[i].time_s + step_s;
    while (end_s < film_ends_s &&
           GapOfFlight(track, flight, end_s).gap_px > ground.height_px.value) {
      end_s += step_s;
    }
    end_s = std::min(end_s, film_ends_s);
    // A frame that was exposed across the next impact says less.
    if (end_s - samples[i].time_s > spans_s) {
      hop = Hop{flight, &samples[i], end_s};
    }
  }
  if (!hop) return;
  // A frame that the flight claims but does not explain refutes the hop.
  if (hop->end_s >= film_ends_s || i >= samples.size() ||
      samples[i].time_s <= hop->end_s - spans_s) {
    return;
  }
  const auto height_at = [&](double t) {
    return GapOfFlight(track, hop->flight, t).gap_px;
  };
  double top_s = hop->last->time_s;
  const auto steps = static_cast<int>((hop->end_s - touchdown.time_s) / step_s);
  for (int k = 0; k < steps; ++k) {
    const double t = touchdown.time_s + k * step_s;
    if (height_at(t) > height_at(top_s)) top_s = t;
  }
  Offer(GapAt(hop->flight, top_s), hop->last->frame);
}

void Finder::SearchStretch(const Stretch& stretch) {
  const SampleRange range{std::max(stretch.begin, since), stretch.end};
  if (range.begin >= range.end) return;
  if (stretch.kind == StretchKind::kFlight &&
      range.size() >= MinFlightFrames(options)) {
    LookAtFlight(range);
  } else {
    LookAtFrames(range);
  }
}

// A frame that was exposed across the touchdown shows the mean of two motions:
// of a body that rests from then on, a part of the approach. With b, the part
// of the exposure before it, and the approach's rate r, all in frames, by
//   r MixtureOffset(exposure, b).
// The samples since the contact are put down by it.
PlaneTrack TakeOutApproach(const PlaneTrack& track, std::size_t from,
                           const Event& event) {
  PlaneTrack out = track;
  const double dt = track.frame_interval_s;
  const double rate =
      -GapOfFlight(track, *event.before, event.time_s.value).rate * dt;
  const auto shift_of = [&](const PlaneSample& s, double exposure) {
    const double before = std::clamp(
        0.5 * exposure - (s.time_s - event.time_s.value) / dt, 0.0, exposure);
    return std::max(rate, 0.0) * MixtureOffset(exposure, before);
  };
  for (std::size_t i = from; i < out.samples.size(); ++i) {
    PlaneSample& s = out.samples[i];
    if (s.time_s - event.time_s.value >
        0.5 * (track.exposure + kExposureError) * dt) {
      break;
    }
    double shift = shift_of(s, track.exposure);
    double u =
        shift_of(s, std::min(1.0, track.exposure + kExposureError)) - shift;
    if (track.exposure >= 1.0) {  // of any length
      u = 0.5 * shift / std::numbers::sqrt3;
      shift *= 0.5;
    }
    s.gap_px -= shift;
    s.height_px -= shift;
    s.u_gap_px = std::hypot(s.u_gap_px, u);
    s.u_height_px = std::hypot(s.u_height_px, u);
  }
  return out;
}

}  // namespace

std::optional<GreatestGap> FindGreatestGap(const PlaneTrack& track,
                                           std::span<const Stretch> stretches,
                                           std::size_t from,
                                           const GroundLevel& ground,
                                           const FlightOptions& options,
                                           const Event* event) {
  const PlaneTrack at_rest =
      event ? TakeOutApproach(track, from, *event) : track;
  Finder finder{at_rest, from, ground, options, event};
  for (const Stretch& stretch : stretches) finder.SearchStretch(stretch);
  // Frames of no flight that follow the touchdown at once.
  if (event && (!event->after || event->after_frames.begin > from)) {
    finder.LookAfterTouchdown();
  }
  return finder.greatest;
}

}  // namespace touchdown::vision
