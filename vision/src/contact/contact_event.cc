#include "contact/contact_event.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/track_noise.h"

namespace touchdown::vision {
namespace {

// The instant at which the gap of a flight crosses zero in [from_s, to_s], in
// the direction of `falling`; where it only grazes the ground, the instant
// nearest to it. A body that turns may cross more than once: touchdown is the
// first, release the last.
double CrossingTime(const PlaneTrack& track, const Flight& flight,
                    double from_s, double to_s, bool falling) {
  constexpr int kSteps = 64;
  const double step = (to_s - from_s) / kSteps;
  const auto gap = [&](double t) {
    const double g = GapOfFlight(track, flight, t).gap_px;
    return falling ? g : -g;
  };
  // From the end that is in flight.
  double nearest = falling ? from_s : to_s;
  double least = std::abs(gap(nearest));
  double previous = gap(from_s);
  std::optional<double> crossing;
  for (int i = 1; i <= kSteps; ++i) {
    const double t = from_s + i * step;
    const double here = gap(t);
    if (previous >= 0.0 && here < 0.0) {
      double low = t - step;
      double high = t;
      constexpr int kHalvings = 50;
      for (int k = 0; k < kHalvings; ++k) {
        const double middle = 0.5 * (low + high);
        (gap(middle) >= 0.0 ? low : high) = middle;
      }
      if (falling) return 0.5 * (low + high);
      crossing = 0.5 * (low + high);
    }
    if (std::abs(here) < least) {
      least = std::abs(here);
      nearest = t;
    }
    previous = here;
  }
  return crossing.value_or(nearest);
}

// Frames after touchdown and before release that the flights explain within
// their noise: they were in contact all the same.
void LeaveOutContact(const PlaneTrack& track, const FlightOptions& options,
                     double touchdown_s, double release_s, Event& event) {
  const auto& samples = track.samples;
  SampleRange before = event.before_frames;
  SampleRange after = event.after_frames;
  while (before.size() > LeastFrames(options) &&
         samples[before.end - 1].time_s > touchdown_s) {
    --before.end;
  }
  while (after.size() > LeastFrames(options) &&
         samples[after.begin].time_s < release_s) {
    ++after.begin;
  }
  event.before_frames = before;
  event.after_frames = after;
  event.before = FitFlight(SelectSamples(track, before), options);
  event.after = FitFlight(SelectSamples(track, after), options);
}

// A frame within half an interval of touchdown may have been exposed across
// it: left out where the others suffice.
void LeaveOutStraddling(const PlaneTrack& track, const FlightOptions& options,
                        double time_s, Event& event) {
  constexpr double kHalfAFrame = 0.5;
  const double reach = kHalfAFrame * track.frame_interval_s;
  const auto near = [&](std::size_t i) {
    return std::abs(track.samples[i].time_s - time_s) < reach;
  };
  SampleRange& before = event.before_frames;
  SampleRange& after = event.after_frames;
  const std::size_t spare = LeastFrames(options) + 1;
  if (before.size() > spare && near(before.end - 1)) --before.end;
  if (after.size() > spare && near(after.begin)) ++after.begin;
}

// Whether a sample lies more than 4 standard deviations off a flight.
bool LeavesFlight(const PlaneSample& s, const Flight& flight) {
  constexpr double kSigmas = 4.0;
  const FlightState at = flight.At(s.time_s);
  const auto off = [](double difference, double u1, double u2) {
    return std::abs(difference) > kSigmas * std::hypot(u1, u2);
  };
  return off(s.height_px - at.height_px, at.u_height_px, s.u_height_px) ||
         off(s.along_px - at.along_px, at.u_along_px, s.u_along_px) ||
         (s.u_face_rad > 0.0 &&
          off(s.face_rad - at.face_rad, at.u_face_rad, s.u_face_rad));
}

JointInput MakeJointInput(const PlaneTrack& track, const Event& event,
                          const FlightOptions& options) {
  JointInput input;
  input.before = SelectSamples(track, event.before_frames);
  if (event.after) input.after = SelectSamples(track, event.after_frames);
  input.u_slope_rad = track.ground.u_angle_rad;
  input.gravity_px_per_s2 = options.gravity_px_per_s2;
  input.ground_px = {0.0, std::max(track.ground.u_offset_px, 1e-6)};
  return input;
}

// A contact that lasts needs up to three numbers more, and must earn them
// (Schwarz's criterion): of a soft body, or of a block that strikes with one
// corner and then with the other before the next frame. Else it only widens the
// instant's u.
void TryLasting(const PlaneTrack& track, const JointInput& input,
                double start_s, double end_s, std::optional<JointFit>& instant,
                Event& event) {
  JointInput lasting = input;
  lasting.instant = false;
  lasting.touchdown_s = start_s;
  lasting.release_s = end_s;
  const std::optional<JointFit> soft = FitJointly(track, lasting);
  if (!soft) return;
  const core::Estimate lasts = soft->EstimateFunction(
      [](const JointVector& p) { return p[kT2] - p[kT]; });  // frames
  // No frame of either flight is in contact.
  if (instant && !input.after.empty() &&
      (lasts.value - lasts.u) * soft->interval_s >
          input.after.front().time_s - input.before.back().time_s) {
    return;
  }
  const double more = static_cast<double>(
      soft->active.count() - (instant ? instant->active.count() : 0));
  const double n = static_cast<double>(soft->degrees);
  // Where neither describes the frames to their noise, noise is what is left.
  const double excess = std::max(1.0, soft->chi2 / std::max(1.0, n));
  constexpr double kClear = 3.0;
  const bool clear = lasts.value > kClear * lasts.u;
  if (!instant ||
      (lasts.value > 0.0 && instant->chi2 - soft->chi2 >
                                excess * more * std::log(std::max(2.0, n)))) {
    instant = soft;
  } else if (clear) {
    event.unresolved_s = 0.5 * lasts.value * soft->interval_s;
  }
}

// It rebounds: one fit of both flights.
bool MeasureRebound(const PlaneTrack& track, const FlightOptions& options,
                    Event& event) {
  const auto& samples = track.samples;
  const double dt = track.frame_interval_s;
  const bool in_contact = event.after_frames.begin > event.before_frames.end;
  double t1 = 0.0;
  double t2 = 0.0;
  const auto cross = [&] {
    // A soft body deviates from flight for a while by less than its noise.
    constexpr double kBefore = 3.0;  // frames
    const double last = samples[event.before_frames.end - 1].time_s;
    const double first = samples[event.after_frames.begin].time_s;
    t1 = CrossingTime(track, *event.before, last - kBefore * dt, first + dt,
                      true);
    t2 = CrossingTime(track, *event.after, last - dt, first + kBefore * dt,
                      false);
  };
  cross();
  if (in_contact) {
    LeaveOutContact(track, options, t1, t2, event);
    cross();
  } else {
    LeaveOutStraddling(track, options, t1, event);
  }
  JointInput input = MakeJointInput(track, event, options);
  input.touchdown_s = input.release_s = 0.5 * (t1 + t2);

  // The flights alone, without the line: do they meet on it?
  constexpr double kUnknown_px = 1e3;
  JointInput without = input;
  const core::Estimate on_line = input.ground_px;
  without.ground_px.u = kUnknown_px;
  const double half_px = std::hypot(track.ground.u_offset_px, track.u_half_px);
  event.disagreement = 0.0;
  if (const auto free = FitJointly(track, without)) {
    const core::Estimate d = free->EstimateFunction(
        [&](const JointVector& p) { return free->GroundAtContact(p); });
    event.disagreement = d.value / std::hypot(d.u, half_px);
    const bool disagree = std::abs(event.disagreement) > kDisagree;
    // A flight of two frames, with gravity known, is told by nothing but them:
    // the line says that they are not of one flight.
    if (disagree && options.gravity_px_per_s2 &&
        event.after_frames.size() <= LeastFrames(options)) {
      return false;
    }
    if (disagree && !in_contact) {
      // No frame in contact: the flights know the ground better than the line.
      input.ground_px.u = std::abs(d.value);
    }
    input.touchdown_s = input.release_s = free->ToSeconds(free->p[kT]);
  }
  std::optional<JointFit> fit = FitJointly(track, input);
  input.ground_px.u = on_line.u;
  TryLasting(track, input, t1, t2, fit, event);
  event.fit = fit;
  if (fit && !in_contact && std::abs(event.disagreement) > kDisagree) {
    // The flights were cut a frame off, or there were two impacts between two
    // frames: nothing they tell is known better than the line is missed by.
    const double square = event.disagreement * event.disagreement;
    event.fit->covariance *= square;
    event.fit->information /= square;
  }
  return fit.has_value();
}

// What stays down may have left the ground by less than makes a flight of its
// own. No frame in contact is above those that follow: frames up to the last
// that clearly is are left out.
void LeaveOutHops(const PlaneTrack& track, std::size_t least,
                  SampleRange& down) {
  constexpr double kClear = 3.0;  // sigmas
  const std::size_t begin = down.begin;
  for (std::size_t i = begin; i + least < down.end; ++i) {
    const core::Estimate rest =
        MeanRestingGap(SelectSamples(track, {i + 1, down.end}));
    const PlaneSample& s = track.samples[i];
    if (s.gap_px - rest.value > kClear * std::hypot(s.u_gap_px, rest.u)) {
      down.begin = i + 1;
    }
  }
}

// It stays down: the frames in contact tell the ground's height.
bool MeasureStay(const PlaneTrack& track, const FlightOptions& options,
                 Event& event) {
  const auto& samples = track.samples;
  JointInput input = MakeJointInput(track, event, options);
  // What is known of the ground's height: the line, and the body's size.
  core::Estimate ground{
      0.0,
      std::max(std::hypot(track.ground.u_offset_px, track.u_half_px), 1e-6)};
  // Near the contact: what is far along it speaks of the line's direction.
  constexpr std::size_t kNear = 40;  // frames
  SampleRange down = event.down_frames;
  down.end = std::min(down.end, down.begin + kNear);
  // A few frames may still belong to a rebound.
  constexpr std::size_t kEnough = 6;
  LeaveOutHops(track, kEnough, down);
  if (down.size() >= kEnough) {
    const core::Estimate level = MeanRestingGap(SelectSamples(track, down));
    event.disagreement = level.value / std::hypot(ground.u, level.u);
    if (std::abs(event.disagreement) > kDisagree) {
      ground = core::Combined(ground, level);
    } else {
      const double w0 = 1.0 / (ground.u * ground.u);
      const double w1 = 1.0 / (level.u * level.u);
      ground = {level.value * w1 / (w0 + w1), 1.0 / std::sqrt(w0 + w1)};
    }
    input.ground_px = ground;
    input.reference_along_px = samples[down.begin].along_px;
  }
  const double dt = track.frame_interval_s;
  const double last = samples[event.before_frames.end - 1].time_s;
  const std::size_t next = event.before_frames.end;
  const double until =
      next < samples.size() ? samples[next].time_s + dt : last + 20.0 * dt;
  input.touchdown_s = input.release_s =
      CrossingTime(track, *event.before, last - 3.0 * dt, until, true);
  event.fit = FitJointly(track, input);
  return event.fit.has_value();
}

}  // namespace

core::Estimate MeanRestingGap(std::span<const PlaneSample> samples) {
  double sw = 0.0;
  double swx = 0.0;
  for (const PlaneSample& s : samples) {
    const double w = 1.0 / (s.u_gap_px * s.u_gap_px);
    sw += w;
    swx += w * s.gap_px;
  }
  const double mean = swx / sw;
  std::vector<double> off;
  for (const PlaneSample& s : samples) {
    off.push_back((s.gap_px - mean) / s.u_gap_px);
  }
  const int degrees = static_cast<int>(samples.size()) - 1;
  return {mean, ComputeInflation({off}, degrees) / std::sqrt(sw)};
}

FlightGap GapOfFlight(const PlaneTrack& track, const Flight& flight,
                      double time_s) {
  const FlightState s = flight.At(time_s);
  const double arm = LowestPointOffset(track, s.face_rad);
  FlightGap g;
  g.gap_px = s.height_px - SupportHeight(track, s.face_rad);
  g.rate = s.v_n + arm * s.omega;
  g.u_px = std::hypot(s.u_height_px, arm * s.u_face_rad);
  return g;
}

bool MeasureEvent(const PlaneTrack& track, const FlightOptions& options,
                  Event& event, std::string& reason) {
  const PlaneSample& last = track.samples[event.before_frames.end - 1];
  reason = fmt::format(
      "too few frames show the body before its impact at frame {}", last.frame);
  if (event.before_frames.size() < LeastFrames(options)) return false;
  event.before = FitFlight(SelectSamples(track, event.before_frames), options);
  bool flies = event.after_frames.size() >= LeastFrames(options);
  if (flies) {
    event.after = FitFlight(SelectSamples(track, event.after_frames), options);
  }
  // With none to spare only a rebound tells where and when the flight ended,
  // and an impact one frame earlier looks alike unless the last frame is
  // clearly not of the flight after it.
  if (event.before_frames.size() <= LeastFrames(options) &&
      !(flies && LeavesFlight(last, *event.after))) {
    return false;
  }
  if (flies && !MeasureRebound(track, options, event)) {
    // What follows does not leave the ground as a flight does.
    flies = false;
    event.after.reset();
    event.after_frames = {};
  }
  if (!flies && !MeasureStay(track, options, event)) {
    reason = fmt::format(
        "the frames beside the impact at frame {} do not determine it",
        last.frame);
    return false;
  }
  const JointFit& fit = *event.fit;
  const auto time_of = [&](JointParameter k) {
    const core::Estimate t =
        fit.EstimateFunction([k](const JointVector& p) { return p[k]; });
    return core::Estimate{fit.ToSeconds(t.value), t.u * fit.interval_s};
  };
  event.time_s = time_of(kT);
  event.time_s.u = std::hypot(event.time_s.u, event.unresolved_s);
  event.release_s = fit.instant ? event.time_s : time_of(kT2);
  event.ground_px = fit.EstimateFunction(
      [&](const JointVector& p) { return fit.GroundAtContact(p); });
  event.before = fit.IncomingFlight(SelectSamples(track, event.before_frames));
  if (flies)
    event.after = fit.OutgoingFlight(SelectSamples(track, event.after_frames));
  return true;
}

}  // namespace touchdown::vision
