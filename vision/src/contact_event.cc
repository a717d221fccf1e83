#include "contact_event.h"

#include <algorithm>
#include <cmath>

#include "flight_frames.h"

namespace touchdown::vision {
namespace {

// Where the gap of a flight is `level`, near `start_s` (Newton; the gap of a
// turning rectangle is not a parabola).
std::optional<double> TimeOfGap(const PlaneTrack& track, const Flight& flight,
                                double start_s, double level) {
  double t = start_s;
  constexpr int kIterations = 40;
  for (int i = 0; i < kIterations; ++i) {
    const FlightGap g = GapOf(track, flight, t);
    if (g.rate == 0.0 || !std::isfinite(g.gap_px)) return std::nullopt;
    double step = -(g.gap_px - level) / g.rate;
    const double limit = 20.0 * track.frame_interval_s;
    step = std::clamp(step, -limit, limit);
    t += step;
    if (std::abs(step) < 1e-9 * track.frame_interval_s) return t;
  }
  return std::nullopt;
}

// Weighted mean gap of samples in contact; nothing if they do not agree.
std::optional<core::Estimate> LevelOf(std::span<const PlaneSample> samples) {
  if (samples.size() < 2) return std::nullopt;
  double sw = 0.0;
  double swx = 0.0;
  for (const PlaneSample& s : samples) {
    const double w = 1.0 / (s.u_gap_px * s.u_gap_px);
    sw += w;
    swx += w * s.gap_px;
  }
  const double mean = swx / sw;
  double chi2 = 0.0;
  for (const PlaneSample& s : samples) {
    const double r = (s.gap_px - mean) / s.u_gap_px;
    chi2 += r * r;
  }
  const double widen =
      std::max(1.0, chi2 / static_cast<double>(samples.size() - 1));
  return core::Estimate{mean, std::sqrt(widen / sw), std::nullopt};
}

// The flight after a blow, if there is one: its greatest height must stand out
// of the ground, and its frames must follow free flight better than rest.
bool FindFlightAfter(const PlaneTrack& track, Event& event,
                     const EventOptions& options) {
  const std::span<const PlaneSample> samples(track.samples);
  std::size_t begin = event.first_after;
  std::size_t end = event.end;
  if (end - begin < Least(options)) return false;
  TrimAtBlow(samples, begin, end, false, options);
  if (end - begin < Least(options)) return false;
  const Flight flight = Grow(samples, begin, end, false, options);
  if (end - begin < Least(options)) return false;
  // Rest explains the same frames as well?
  const auto rest = LevelOf(samples.subspan(begin, end - begin));
  double chi2_rest = 0.0;
  double chi2_flight = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    const PlaneSample& s = samples[i];
    const double at_rest = (s.gap_px - rest->value) / s.u_gap_px;
    const double flying =
        (s.gap_px - GapOf(track, flight, s.time_s).gap_px) / s.u_gap_px;
    chi2_rest += at_rest * at_rest;
    chi2_flight += flying * flying;
  }
  // 2 more parameters; 16: odds of 3000 to 1 (e^8).
  constexpr double kFlightMustWinBy = 16.0;
  if (chi2_rest - chi2_flight < kFlightMustWinBy) return false;
  const double n = static_cast<double>(end - begin);
  // Sliding with gravity pulling and nothing falling fits no flight.
  constexpr double kTolerable = 9.0;
  if (flight.reduced_chi2 > kTolerable && chi2_flight / n > kTolerable) {
    return false;
  }
  event.after = flight;
  event.after_begin = begin;
  event.after_end = end;
  return true;
}

// The frames next to a soft contact deviate from flight by less than their
// noise, all to one side: those after touchdown or before release leave the
// fits. False where there are none, or too few would be left.
bool LeaveOutContact(std::span<const PlaneSample> samples, double touchdown_s,
                     double release_s, Event& event,
                     const EventOptions& options) {
  std::size_t before_end = event.before_end;
  std::size_t after_begin = event.after_begin;
  while (before_end > event.before_begin &&
         samples[before_end - 1].time_s > touchdown_s) {
    --before_end;
  }
  while (after_begin < event.after_end &&
         samples[after_begin].time_s < release_s) {
    ++after_begin;
  }
  if (before_end == event.before_end && after_begin == event.after_begin) {
    return false;
  }
  if (before_end - event.before_begin < Least(options) ||
      event.after_end - after_begin < Least(options)) {
    return false;
  }
  event.before_end = before_end;
  event.after_begin = after_begin;
  event.before = FitFlight(
      samples.subspan(event.before_begin, before_end - event.before_begin),
      options.flight);
  event.after =
      FitFlight(samples.subspan(after_begin, event.after_end - after_begin),
                options.flight);
  return true;
}

}  // namespace

FlightGap GapOf(const PlaneTrack& track, const Flight& flight, double time_s) {
  const FlightState s = flight.At(time_s);
  const double arm = LowestPointAlong(track, s.face_rad);
  FlightGap g;
  g.gap_px = s.height_px - SupportHeight(track, s.face_rad);
  g.rate = s.v_n + arm * s.omega;
  g.u_px = std::hypot(s.u_height_px, arm * s.u_face_rad);
  return g;
}

namespace {

std::span<const PlaneSample> BeforeOf(std::span<const PlaneSample> samples,
                                      const Event& event) {
  return samples.subspan(event.before_begin,
                         event.before_end - event.before_begin);
}

std::span<const PlaneSample> AfterOf(std::span<const PlaneSample> samples,
                                     const Event& event) {
  return samples.subspan(event.after_begin,
                         event.after_end - event.after_begin);
}

JointInput InputFor(const PlaneTrack& track, const Event& event,
                    const EventOptions& options) {
  JointInput input;
  input.before = BeforeOf(track.samples, event);
  if (event.after) input.after = AfterOf(track.samples, event);
  input.u_slope_rad = options.u_slope_rad;
  input.gravity_px_per_s2 = options.flight.gravity_px_per_s2;
  input.ground_px = {0.0, std::max(options.u_line_px, 1e-6), std::nullopt};
  return input;
}

// The frame nearest to touchdown may have been exposed across it: left out
// where the others suffice.
void LeaveOutStraddling(const PlaneTrack& track, Event& event, double time_s,
                        const EventOptions& options) {
  constexpr double kHalfAFrame = 0.5;
  const double reach = kHalfAFrame * track.frame_interval_s;
  const auto near = [&](std::size_t i) {
    return std::abs(track.samples[i].time_s - time_s) < reach;
  };
  if (near(event.before_end - 1) &&
      event.before_end - event.before_begin > Least(options)) {
    --event.before_end;
  }
  if (near(event.after_begin) &&
      event.after_end - event.after_begin > Least(options)) {
    ++event.after_begin;
  }
}

// It rebounds: one fit of both flights.
bool MeasureRebound(const PlaneTrack& track, Event& event,
                    const EventOptions& options) {
  const std::span<const PlaneSample> samples(track.samples);
  auto t1 = TimeOfGap(track, *event.before,
                      samples[event.before_end - 1].time_s, 0.0);
  auto t2 =
      TimeOfGap(track, *event.after, samples[event.after_begin].time_s, 0.0);
  if (!t1 || !t2) return false;
  const bool in_contact = event.before_end < event.first_after ||
                          event.after_begin > event.first_after;
  if (in_contact && LeaveOutContact(samples, *t1, *t2, event, options)) {
    t1 = TimeOfGap(track, *event.before, *t1, 0.0);
    t2 = TimeOfGap(track, *event.after, *t2, 0.0);
    if (!t1 || !t2) return false;
  }
  if (!in_contact) LeaveOutStraddling(track, event, *t1, options);
  JointInput input = InputFor(track, event, options);
  const double half_px = std::hypot(options.u_line_px, track.u_half_px);
  input.touchdown_s = *t1;
  input.release_s = *t2;

  // The flights alone, without the line: do they meet on it?
  constexpr double kUnknown_px = 1e3;
  JointInput without = input;
  without.touchdown_s = without.release_s = 0.5 * (*t1 + *t2);
  without.ground_px.u = kUnknown_px;
  std::optional<JointFit> free = FitJointly(track, without);
  constexpr double kDisagree = 3.0;
  event.disagreement = 0.0;
  if (free) {
    const core::Estimate d = free->Of(
        [&](const JointVector& p) { return free->GroundAtContact(p); });
    event.disagreement = d.value / std::hypot(d.u, half_px);
    if (std::abs(event.disagreement) > kDisagree && !in_contact) {
      // No frame in contact: the flights know the ground better than the line.
      input.ground_px.u = std::abs(d.value);
    }
    input.touchdown_s = input.release_s = free->TimeAt(free->p[kT]);
  }
  // A contact that lasts needs up to three numbers more, and must earn them.
  std::optional<JointFit> instant = FitJointly(track, input);
  if (in_contact || !instant) {
    JointInput lasting = input;
    lasting.instant = false;
    lasting.touchdown_s = *t1;
    lasting.release_s = *t2;
    lasting.ground_px.u = std::max(options.u_line_px, 1e-6);
    std::optional<JointFit> soft = FitJointly(track, lasting);
    if (soft) {
      const core::Estimate lasts = soft->Of(
          [](const JointVector& p) { return p[kT2] - p[kT]; });  // frames
      const double more = static_cast<double>(
          soft->active.count() - (instant ? instant->active.count() : 0));
      const double n = static_cast<double>(soft->degrees);
      // Where neither describes the frames to their noise, noise is what is
      // left.
      const double excess = std::max(1.0, soft->chi2 / std::max(1.0, n));
      constexpr double kClear = 3.0;
      const bool clear = lasts.value > kClear * lasts.u;
      // Shorter, no frame shows the contact: only what the flights miss of each
      // other speaks of it, as anything else would that bends them.
      constexpr double kResolved = 0.5;  // frames
      const bool resolved = clear && lasts.value > kResolved;
      if (!instant ||
          (resolved && instant->chi2 - soft->chi2 >
                           excess * more * std::log(std::max(2.0, n)))) {
        instant = soft;
      } else if (clear) {
        event.unresolved_s = 0.5 * lasts.value * soft->interval_s;
      }
    }
  }
  if (!instant) return false;
  event.fit = instant;
  return true;
}

// It stays down: the frames in contact tell the ground's height.
bool MeasureStay(const PlaneTrack& track, Event& event,
                 const EventOptions& options) {
  const std::span<const PlaneSample> samples(track.samples);
  JointInput input = InputFor(track, event, options);
  const std::size_t from = event.first_after;
  const std::size_t to = std::min(event.end, from + 40);
  // What is known of the ground's height: the line, and the body's size.
  core::Estimate ground{
      0.0, std::max(std::hypot(options.u_line_px, track.u_half_px), 1e-6),
      std::nullopt};
  std::optional<core::Estimate> level;
  // A few frames may still belong to the flight.
  constexpr std::size_t kEnoughAtRest = 6;
  if (to >= from + kEnoughAtRest) {
    level = LevelOf(samples.subspan(from, to - from));
    // Frames that do not agree on a height are not at rest.
    constexpr double kAtRest_px = 0.25;
    if (level && level->u > kAtRest_px) level = std::nullopt;
  }
  const double start_s = samples[event.before_end - 1].time_s;
  if (level) {
    event.disagreement = level->value / std::hypot(ground.u, level->u);
    constexpr double kDisagree = 3.0;
    if (std::abs(event.disagreement) > kDisagree) {
      ground = *level;
    } else {
      const double w0 = 1.0 / (ground.u * ground.u);
      const double w1 = 1.0 / (level->u * level->u);
      ground = {level->value * w1 / (w0 + w1), 1.0 / std::sqrt(w0 + w1),
                std::nullopt};
    }
    input.ground_px = ground;
    input.reference_along_px =
        samples[std::min(from, samples.size() - 1)].along_px;
  }
  const auto t = TimeOfGap(track, *event.before, start_s, ground.value);
  if (!t) return false;
  input.touchdown_s = input.release_s = *t;
  event.fit = FitJointly(track, input);
  return event.fit.has_value();
}

// The last of three frames may follow the blow, if none was left out there.
void DropFirstAfterBlow(std::span<const PlaneSample> samples, Event& event,
                        const EventOptions& options) {
  if (event.before->frames != static_cast<int>(Least(options)) ||
      Least(options) == LeastBefore(options) ||
      event.before_end != event.first_after) {
    return;
  }
  const std::size_t last = event.before_end - 1;
  const Flight two = FitFlight(
      samples.subspan(event.before_begin, kLeastBeforeRebound), options.flight);
  if (!BelongsAfter(samples, samples[last], two, event.first_after, event.end,
                    options)) {
    return;
  }
  event.first_after = event.before_end = last;
  event.before = two;
}

// Whether the last frame before the blow, with none to spare, is not of the
// flight after it: a blow one frame earlier looks alike.
bool CameBeforeRebound(std::span<const PlaneSample> samples, const Event& event,
                       const EventOptions& options) {
  return Deviates(samples[event.before_end - 1], *event.after,
                  options.flight_sigmas);
}

}  // namespace

bool MeasureEvent(const PlaneTrack& track, Event& event,
                  const EventOptions& options) {
  const std::span<const PlaneSample> samples(track.samples);
  event.before_begin = event.begin;
  event.before_end = event.first_after;
  const std::size_t least = LeastBefore(options);
  event.too_few = event.before_end - event.before_begin < least;
  if (event.too_few) return false;
  TrimAtBlow(samples, event.before_begin, event.before_end, true, options);
  event.before =
      Grow(samples, event.before_begin, event.before_end, true, options);
  if (event.before->frames < static_cast<int>(least)) return false;
  DropFirstAfterBlow(samples, event, options);
  // With few frames after it a blow is placed a frame or two early: what the
  // flight before still explains, above the ground, is of that flight.
  while (event.before_end == event.first_after &&
         event.first_after < event.end) {
    const PlaneSample& s = samples[event.first_after];
    const FlightGap g = GapOf(track, *event.before, s.time_s);
    if (!(g.gap_px > 0.0) ||
        Deviates(s, *event.before, options.flight_sigmas) ||
        (event.before->frames < static_cast<int>(Least(options)) &&
         BelongsAfter(samples, s, *event.before, event.first_after + 1,
                      event.end, options))) {
      break;
    }
    event.before_end = ++event.first_after;
    event.before = FitFlight(BeforeOf(samples, event), options.flight);
  }
  const bool flies = FindFlightAfter(track, event, options);
  const bool few = event.before_end - event.before_begin < Least(options);
  event.too_few = few && !(flies && CameBeforeRebound(samples, event, options));
  if (event.too_few) return false;

  if (!(flies ? MeasureRebound(track, event, options)
              : MeasureStay(track, event, options))) {
    return false;
  }
  // Two frames of which one is no outline of the body (it comes out from behind
  // something) seem to rebound, too: but not from the line.
  constexpr double kFarOff = 6.0;  // in u
  if (few && std::abs(event.disagreement) > kFarOff) return false;
  const JointFit& fit = *event.fit;
  const auto time_of = [&](JointParameter k) {
    const core::Estimate t = fit.Of([k](const JointVector& p) { return p[k]; });
    return core::Estimate{fit.TimeAt(t.value), t.u * fit.interval_s,
                          std::nullopt};
  };
  event.time_s = time_of(kT);
  event.time_s.u = std::hypot(event.time_s.u, event.unresolved_s);
  event.release_s = fit.instant ? event.time_s : time_of(kT2);
  event.ground_px =
      fit.Of([&](const JointVector& p) { return fit.GroundAtContact(p); });
  event.before = fit.Before(BeforeOf(samples, event));
  if (flies) event.after = fit.After(AfterOf(samples, event));
  return true;
}

}  // namespace touchdown::vision
