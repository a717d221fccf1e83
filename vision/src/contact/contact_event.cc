#include "contact/contact_event.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
  // Steps over a handful of frames. A block whose gap dips below zero for less
  // than one step is missed. Not studied.
  constexpr int kSteps = 64;
  const double step = (to_s - from_s) / kSteps;
  const auto gap = [&](double t) {
    const double g = GapOfFlight(track, flight, t).gap_px;
    return falling ? g : -g;
  };
  // The search for the nearest instant starts at the end that is in flight.
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
      // Bisection to the last digit of a double.
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
  while (before.size() > MinFlightFrames(options) &&
         samples[before.end - 1].time_s > touchdown_s) {
    --before.end;
  }
  while (after.size() > MinFlightFrames(options) &&
         samples[after.begin].time_s < release_s) {
    ++after.begin;
  }
  event.before_frames = before;
  event.after_frames = after;
  event.before = FitFlight(SelectSamples(track, before), options);
  event.after = FitFlight(SelectSamples(track, after), options);
}

// The longest that a frame may have been exposed, of a frame interval. What
// moves by v is smeared by e v: its blur has the variance  b^2 + e^2 v^2 / 12
// along the motion, and e is known as well as that is told from b^2.
double LongestExposure(const PlaneTrack& track, const FlightState& in,
                       const FlightState& out) {
  // px. By so much a camera's blur differs between two directions, or from
  // Gauss's. More: good frames count less; less: a mixture of two motions
  // counts as a pose. In 66 raw clips of known exposure e^2 was off by at most
  // twice what this allows, rms 0.4 of it where the body moves by 2 px and
  // more.
  constexpr double kBlurU_px = 0.02;
  const double dt = track.frame_interval_s;
  const double v2 = 0.5 * dt * dt *
                    (in.v_t * in.v_t + in.v_n * in.v_n + out.v_t * out.v_t +
                     out.v_n * out.v_n);
  const double u_square = 24.0 * track.blur_px * kBlurU_px / std::max(v2, 1e-9);
  // Not known: predicted frames are blurred by their codec, too (in 22 clips of
  // crf 23 the exposure was off by up to 0.6).
  if (!(track.blur_px > 0.0) || track.is_predicted) return 1.0;
  return std::min(1.0,
                  std::sqrt(track.exposure * track.exposure + 2.0 * u_square));
}

// The frames beside touchdown may have been exposed across it, and then show a
// mean of two motions (MixtureOffset).
void WidenAtTouchdown(const core::Estimate& instant_s, const Event& event,
                      PlaneTrack& track) {
  // Standard deviations of the instant. Fewer: a mixture counts as a pose;
  // more: frames that tell most count less. Not studied.
  constexpr double kSigmas = 2.0;
  const double dt = track.frame_interval_s;
  const FlightState in = event.before->At(instant_s.value);
  const FlightState out = event.after->At(instant_s.value);
  const double exposure = LongestExposure(track, in, out);
  for (const std::size_t i :
       {event.before_frames.end - 1, event.after_frames.begin}) {
    PlaneSample& s = track.samples[i];
    const double d = std::max(
        0.0,
        (std::abs(s.time_s - instant_s.value) - kSigmas * instant_s.u) / dt);
    const double off_s =
        MixtureOffset(exposure, std::max(0.0, 0.5 * exposure - d)) * dt;
    const auto widen = [off_s](double v1, double v2, double& u_pose) {
      u_pose = std::hypot(u_pose, (v2 - v1) * off_s);
    };
    widen(in.v_t, out.v_t, s.u_along_px);
    widen(in.v_n, out.v_n, s.u_height_px);
    widen(in.omega, out.omega, s.u_face_rad);
  }
}

// The instant at which both flights cross the ground, weighted by what either
// tells of it.
core::Estimate MeanCrossing(const PlaneTrack& track, const Event& event,
                            double falls_s, double rises_s) {
  const auto weight = [&](const Flight& flight, double time_s) {
    const FlightGap gap = GapOfFlight(track, flight, time_s);
    // 1 / s^2, of an instant known to a second: never 0, where it glides.
    constexpr double kLeast = 1.0;
    return kLeast + gap.rate * gap.rate / std::max(gap.u_px * gap.u_px, 1e-12);
  };
  const double w1 = weight(*event.before, falls_s);
  const double w2 = weight(*event.after, rises_s);
  return {(w1 * falls_s + w2 * rises_s) / (w1 + w2), 1.0 / std::sqrt(w1 + w2)};
}

// The last frame of a rebound that meets the ground again before the frame's
// exposure ends, or may do so, is a mean of two motions. What follows the blow
// is another motion by as much as the flight's own; the blow lies in the
// exposure's middle at the earliest.
void WidenAtNextImpact(const Event& event, PlaneTrack& track) {
  const std::size_t last = event.after_frames.end - 1;
  if (event.after_frames.end >= track.samples.size()) return;  // the film ends
  PlaneSample& s = track.samples[last];
  const double exposure_s = track.exposure * track.frame_interval_s;
  const double ends_s = s.time_s + 0.5 * exposure_s;
  if (GapOfFlight(track, *event.after, ends_s).gap_px > 0.0) return;
  const FlightState at = event.after->At(s.time_s);
  const auto widen = [&](double rate, double& u) {
    u = std::hypot(u, rate * MixtureOffset(exposure_s, 0.5 * exposure_s));
  };
  widen(at.v_t, s.u_along_px);
  widen(GapOfFlight(track, *event.after, ends_s).rate, s.u_height_px);
  widen(at.omega, s.u_face_rad);
}

// Whether a sample lies clearly off a flight in any of its coordinates.
bool LeavesFlight(const PlaneSample& s, const Flight& flight) {
  // Standard deviations. Fewer: a frame of the flight after the impact passes
  // for one before it, and the contact is a frame too late; more: contacts of
  // few frames are absent. Not studied.
  constexpr double kOffFlightSigmas = 4.0;
  const FlightState at = flight.At(s.time_s);
  const auto off = [](double difference, double u1, double u2) {
    return std::abs(difference) > kOffFlightSigmas * std::hypot(u1, u2);
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
  input.drag_per_px = options.drag_per_px;
  // px: a line without u still needs a finite weight.
  input.ground_px = {0.0, std::max(track.ground.u_offset_px, 1e-6)};
  return input;
}

// Fits a contact that lasts: of a soft body, or of a block that strikes with
// one corner and then with the other before the next frame. It needs up to
// three parameters more than an instant one (T2, X2, FACE2) and replaces it
// only if it earns them by Schwarz's criterion, chi^2 falling by more than k ln
// n. If it does not, the duration that it found only widens the instant's u.
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
  // No frame of either flight is in contact: a longer duration contradicts the
  // flights that it is fitted to.
  if (instant && !input.after.empty() &&
      (lasts.value - lasts.u) * soft->interval_s >
          input.after.front().time_s - input.before.back().time_s) {
    return;
  }
  const double more = static_cast<double>(
      soft->active.count() - (instant ? instant->active.count() : 0));
  const double n = static_cast<double>(soft->degrees);
  // Where neither model describes the frames to their noise, the residuals are
  // taken for noise: the gain is judged in their unit.
  const double excess = std::max(1.0, soft->chi2 / std::max(1.0, n));
  // Standard deviations of the duration. Not studied.
  constexpr double kClearSigmas = 3.0;
  const bool clear = lasts.value > kClearSigmas * lasts.u;
  if (!instant ||
      (lasts.value > 0.0 && instant->chi2 - soft->chi2 >
                                excess * more * std::log(std::max(2.0, n)))) {
    instant = soft;
  } else if (clear) {
    event.unresolved_s = 0.5 * lasts.value * soft->interval_s;
  }
}

// Measures a rebound by one fit of both flights. Returns false if what follows
// cannot be a flight of this contact.
bool MeasureRebound(PlaneTrack& track, const FlightOptions& options,
                    Event& event) {
  const auto& samples = track.samples;
  const double dt = track.frame_interval_s;
  const bool in_contact = event.after_frames.begin > event.before_frames.end;
  double t1 = 0.0;
  double t2 = 0.0;
  const auto cross = [&] {
    // A soft body deviates from flight for a while by less than its noise.
    // The crossing is sought so many frames beyond it. Not studied.
    constexpr double kSoftFrames = 3.0;
    const double last = samples[event.before_frames.end - 1].time_s;
    const double first = samples[event.after_frames.begin].time_s;
    t1 = CrossingTime(track, *event.before, last - kSoftFrames * dt, first + dt,
                      true);
    t2 = CrossingTime(track, *event.after, last - dt, first + kSoftFrames * dt,
                      false);
  };
  cross();
  if (in_contact) {
    LeaveOutContact(track, options, t1, t2, event);
    cross();
  } else {
    // First as if touchdown were in the middle of both frames' exposures: then
    // neither draws the instant aside.
    const PlaneSample last = samples[event.before_frames.end - 1];
    const PlaneSample first = samples[event.after_frames.begin];
    core::Estimate instant_s{0.5 * (t1 + t2),
                             std::numeric_limits<double>::infinity()};
    for (int pass = 0; pass < 2; ++pass) {
      track.samples[event.before_frames.end - 1] = last;
      track.samples[event.after_frames.begin] = first;
      WidenAtTouchdown(instant_s, event, track);
      event.before =
          FitFlight(SelectSamples(track, event.before_frames), options);
      event.after =
          FitFlight(SelectSamples(track, event.after_frames), options);
      cross();
      instant_s = MeanCrossing(track, event, t1, t2);
    }
  }
  JointInput input = MakeJointInput(track, event, options);
  input.touchdown_s = input.release_s = 0.5 * (t1 + t2);

  // The flights alone, without the line: do they meet on it?
  // px: larger than any picture's error of a line, so that it weighs nothing.
  constexpr double kUnknownLine_px = 1e3;
  JointInput without = input;
  const core::Estimate on_line = input.ground_px;
  without.ground_px.u = kUnknownLine_px;
  // The gap is zero at touchdown within what line and size are known to.
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
        event.after_frames.size() <= MinFlightFrames(options)) {
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
  if (fit && !in_contact && !track.yaw &&
      std::abs(event.disagreement) > kDisagree) {
    // The flights were cut a frame off, or there were two impacts between two
    // frames: nothing they tell is known better than the line is missed by.
    // Where the plane is turned the line's place hangs on the yaw, whose u has
    // a budget of its own.
    const double square = event.disagreement * event.disagreement;
    event.fit->covariance *= square;
    event.fit->information /= square;
  }
  return fit.has_value();
}

// A body that stays down may have left the ground by less than makes a flight
// of its own. A frame in contact does not lie above those that follow it: all
// frames up to the last that clearly does are left out.
void LeaveOutHops(const PlaneTrack& track, std::size_t least,
                  SampleRange& down) {
  // Standard deviations. Fewer: noise takes frames away from the level; more: a
  // small hop raises it. Not studied.
  constexpr double kAboveRestSigmas = 3.0;
  const std::size_t begin = down.begin;
  for (std::size_t i = begin; i + least < down.end; ++i) {
    const core::Estimate rest =
        MeanRestingGap(SelectSamples(track, {i + 1, down.end}));
    const PlaneSample& s = track.samples[i];
    if (s.gap_px - rest.value >
        kAboveRestSigmas * std::hypot(s.u_gap_px, rest.u)) {
      down.begin = i + 1;
    }
  }
}

// Measures the contact of a body that stays down: the frames in contact tell
// the ground's height.
bool MeasureStay(const PlaneTrack& track, const FlightOptions& options,
                 Event& event) {
  const auto& samples = track.samples;
  JointInput input = MakeJointInput(track, event, options);
  // What is known of the ground's height: the line, and the body's size.
  core::Estimate ground{
      0.0,
      std::max(std::hypot(track.ground.u_offset_px, track.u_half_px), 1e-6)};
  // Frames after touchdown that tell the level. More tell it better, but frames
  // far along the line speak of its direction. Not studied.
  constexpr std::size_t kMaxRestFrames = 40;
  SampleRange down = event.down_frames;
  down.end = std::min(down.end, down.begin + kMaxRestFrames);
  // Frames. Fewer may still belong to a rebound, and tell no level. Not
  // studied.
  constexpr std::size_t kMinRestFrames = 6;
  LeaveOutHops(track, kMinRestFrames, down);
  if (down.size() >= kMinRestFrames) {
    // Level of rest and line are two measurements of one height: their weighted
    // mean, unless they contradict each other.
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
  // Weighted mean, whose u = 1/sqrt(sum of weights) holds for independent
  // poses; the inflation corrects it for scatter and correlation.
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
  // The support height changes with attitude by the lowest point's place along
  // the ground: d(support)/d(face) = -arm.
  const double arm = LowestPointOffset(track, s.face_rad);
  FlightGap g;
  g.gap_px = s.height_px - SupportHeight(track, s.face_rad);
  g.rate = s.v_n + arm * s.omega;
  g.u_px = std::hypot(s.u_height_px, arm * s.u_face_rad);
  return g;
}

bool MeasureEvent(const PlaneTrack& seen, const FlightOptions& options,
                  Event& event, std::string& reason) {
  PlaneTrack track = seen;
  const PlaneSample& last = track.samples[event.before_frames.end - 1];
  reason = fmt::format(
      "too few frames show the body before its impact at frame {}", last.frame);
  if (event.before_frames.size() < MinFlightFrames(options)) return false;
  event.before = FitFlight(SelectSamples(track, event.before_frames), options);
  bool flies = event.after_frames.size() >= MinFlightFrames(options);
  if (flies) {
    event.after = FitFlight(SelectSamples(track, event.after_frames), options);
    WidenAtNextImpact(event, track);
  }
  // With no frame to spare only a rebound tells where and when the flight
  // ended. An impact one frame earlier looks alike, unless the last frame is
  // clearly not of the flight after it.
  if (event.before_frames.size() <= MinFlightFrames(options) &&
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
