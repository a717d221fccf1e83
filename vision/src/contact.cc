#include "touchdown/vision/contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact_event.h"
#include "contact_record.h"
#include "kinks.h"
#include "path_trend.h"
#include "touchdown/vision/state.h"
#include "track_noise.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

double MedianGap(std::span<const PlaneSample> samples) {
  std::vector<double> gaps;
  gaps.reserve(samples.size());
  for (const PlaneSample& s : samples) gaps.push_back(s.gap_px);
  return Median(std::move(gaps));
}

double UncertaintyOfLine(const PlaneTrack& track, const PlaneSample& s) {
  return std::hypot(track.ground.u_offset_px,
                    track.ground.u_angle_rad * s.along_px);
}

FlightOptions FlightFor(const ContactOptions& options) {
  FlightOptions flight;
  if (options.scale) {
    const core::Estimate& scale = options.scale->px_per_m;
    const core::Estimate& g = options.gravity_mps2;
    core::Estimate px;
    px.value = g.value * scale.value;
    px.u = std::max(std::hypot(g.u * scale.value, g.value * scale.u),
                    1e-9 * px.value);
    flight.gravity_px_per_s2 = px;
  }
  return flight;
}

// Kinks that can be contacts: near the line. Those far above refute it.
struct Blows {
  std::vector<Kink> kinks;
  std::string refuted;
};

Blows FindBlows(const PlaneTrack& track, const KinkOptions& kink_options) {
  const std::span<const PlaneSample> samples(track.samples);
  Blows blows;
  // No body sinks into the ground by more than what it yields and what the line
  // may be off.
  constexpr double kYield = 0.1;  // of half the body's size
  const auto lowest =
      std::min_element(samples.begin(), samples.end(),
                       [](const PlaneSample& a, const PlaneSample& b) {
                         return a.gap_px < b.gap_px;
                       });
  const double sunk = -lowest->gap_px;
  if (sunk > std::max({2.0, 4.0 * UncertaintyOfLine(track, *lowest),
                       kYield * track.half_short_px})) {
    blows.refuted = fmt::format(
        "the body passes {:.1f} px below the ground line at frame {}", sunk,
        lowest->frame);
  }
  for (const Kink& kink : FindKinks(samples, kink_options)) {
    const PlaneSample& a = samples[kink.after];
    const PlaneSample& b = samples[kink.after + 1];
    // Between two frames the body can come lower than in either by what the
    // blow's velocity covers.
    const double dip = std::abs(kink.jump) * (b.time_s - a.time_s);
    constexpr double kNear_px = 2.0;
    const double near = std::max({kNear_px, 4.0 * UncertaintyOfLine(track, a),
                                  0.05 * track.half_short_px});
    const double gap = std::min(a.gap_px, b.gap_px);
    if (gap > near + dip || gap < -near - dip) {
      constexpr double kClear = 15.0;
      if (kink.significance > kClear && !kink.of_gap && blows.refuted.empty()) {
        blows.refuted = fmt::format(
            "the body rebounds {:.1f} px {} the ground line at frame {}",
            std::abs(gap), gap > 0 ? "above" : "below", a.frame);
      }
      continue;
    }
    blows.kinks.push_back(kink);
  }
  return blows;
}

FlightOptions Straight() {
  FlightOptions options;
  options.gravity_px_per_s2 = core::Estimate{0.0, 1e-9, std::nullopt};
  return options;
}

// What speeds up or slows down along the ground ten times as much as across it
// is carried by the ground, or braked: flight would do so only along a wall.
bool IsCarried(std::span<const PlaneSample> samples) {
  std::vector<PlaneSample> turned(samples.begin(), samples.end());
  for (PlaneSample& s : turned) {
    s.height_px = s.along_px;
    s.u_height_px = s.u_along_px;
  }
  constexpr double kTimes = 10.0;
  constexpr double kClear = 5.0;
  const Flight along = FitFlight(turned);
  const double a = std::abs(along.height[2]);
  return a > kTimes * std::abs(FitFlight(samples).height[2]) &&
         a > kClear * std::sqrt(along.height_cov(2, 2));
}

constexpr std::size_t kLeastAtFirst = 5;  // frames that tell anything

// So it is at first: what stops it or turns it round on its way bends the whole
// of a path otherwise than its beginning.
bool IsCarriedAtFirst(std::span<const PlaneSample> samples) {
  for (std::size_t n = samples.size(); n >= kLeastAtFirst; n /= 2) {
    if (IsCarried(samples.first(n))) return true;
  }
  return false;
}

std::size_t BeforeFirst(std::span<const PlaneSample> samples,
                        const std::vector<Kink>& blows) {
  return blows.empty() ? samples.size() / 2 : blows.front().after + 1;
}

// The first frames, up to the first blow, fall as free flight does, and not
// along a straight line as what lies on the ground.
bool FallsAtFirst(std::span<const PlaneSample> samples,
                  const std::vector<Kink>& blows,
                  const FlightOptions& options) {
  const std::size_t n = BeforeFirst(samples, blows);
  if (n < kLeastAtFirst) return false;
  const auto chi2 = [&](const Flight& flight) {
    double sum = 0.0;
    for (const PlaneSample& s : samples.first(n)) {
      const double r =
          (s.height_px - flight.At(s.time_s).height_px) / s.u_height_px;
      sum += r * r;
    }
    return sum;
  };
  if (IsCarriedAtFirst(samples.first(n))) return false;
  const FlightOptions straight = Straight();
  const Flight falling = FitFlight(samples.first(n), options);
  const double without = chi2(FitFlight(samples.first(n), straight));
  if (!(falling.height[2] > 0.0)) return false;
  constexpr double kMustWinBy = 12.0;  // odds of e^6
  return without - chi2(falling) > kMustWinBy;
}

// These samples come down along a line that is clearly steeper than what a
// ground line may be off.
bool Descends(std::span<const PlaneSample> samples) {
  if (samples.size() < 3) return false;
  const Flight line = FitFlight(samples, Straight());
  const double rate = line.height[1];
  const double u = std::sqrt(line.height_cov(1, 1));
  constexpr double kClear = 3.0;
  // All of its way, to and fro.
  double way = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    way += std::abs(samples[i].along_px - samples[i - 1].along_px);
  }
  const double duration = samples.back().time_s - samples.front().time_s;
  return rate < -kClear * u &&
         -rate * duration > std::tan(kMostInclined_rad) * way;
}

// So does the first half of the track, up to the first blow, or without a blow
// all of it.
bool Descends(std::span<const PlaneSample> samples,
              const std::vector<Kink>& blows) {
  std::size_t n = std::max<std::size_t>(3, samples.size() / 2);
  if (blows.empty()) return Descends(samples) || Descends(samples.first(n));
  return Descends(samples.first(std::min(n, blows.front().after + 1)));
}

// The body is on the ground in the first frames and does not come down to it.
bool OnGroundFromStart(const PlaneTrack& track, const std::vector<Kink>& blows,
                       const FlightOptions& flight) {
  const std::span<const PlaneSample> samples(track.samples);
  if (FallsAtFirst(samples, blows, flight)) return false;
  if (Descends(samples, blows)) return false;
  const std::size_t n = samples.size();
  const std::size_t m = std::min<std::size_t>(8, n);
  const double first = MedianGap(samples.first(m));
  constexpr double kNear_px = 2.0;
  const double near =
      std::max({kNear_px, 4.0 * UncertaintyOfLine(track, samples[0]),
                0.3 * track.half_short_px});
  if (std::abs(first) > near) return false;
  const double noise = samples[n / 2].u_gap_px;
  if (blows.empty()) {
    // No blow: it is down all the time, or never: it must also stay near.
    const double later = MedianGap(samples.subspan(n / 2));
    return first - later <
           std::max(0.5, 5.0 * noise) + 0.1 * track.half_short_px;
  }
  // Carried up to there, it only seems to drop: outlines wander by more than
  // they claim.
  const std::size_t before = BeforeFirst(samples, blows);
  if (IsCarriedAtFirst(samples.first(before))) return true;
  // It came down if the first frames are clearly higher than the first blow.
  const Kink& blow = blows.front();
  const double at_blow =
      std::min(samples[blow.after].gap_px, samples[blow.after + 1].gap_px);
  if (before < kLeastAtFirst) {
    // Too few to tell: what is carried from the blow on was down before it.
    const std::size_t to = blows.size() > 1 ? blows[1].after + 1 : n;
    if (to >= before + kLeastAtFirst &&
        IsCarried(samples.subspan(before, to - before))) {
      return true;
    }
  }
  if (blow.after < 3) return false;
  const double needed =
      std::max(0.1, 5.0 * noise / std::sqrt(static_cast<double>(m)));
  return first - at_blow < needed;
}

// The blows, where a person says which is the first: at the last sample up to
// `frame`. What was found up to the sample after it is that one, or is none.
void BeginWith(std::int64_t frame, std::span<const PlaneSample> samples,
               Blows& blows) {
  const auto next = std::find_if(
      samples.begin(), samples.end(),
      [&](const PlaneSample& sample) { return sample.frame > frame; });
  if (next == samples.begin() || next == samples.end()) return;
  Kink first;
  first.after = static_cast<std::size_t>(next - samples.begin()) - 1;
  first.time_s = samples[first.after].time_s;
  std::erase_if(blows.kinks, [&](const Kink& kink) {
    return kink.after <= first.after + 1;
  });
  blows.kinks.insert(blows.kinks.begin(), first);
}

core::ContactRecord NoContact(const std::string& reason) {
  core::ContactRecord record;
  record.contact.reason = reason;
  record.state.reason = "no contact: " + reason;
  return record;
}

ContactEvidence EvidenceOf(const PlaneTrack& track, const Event& event) {
  ContactEvidence e;
  e.before = event.before;
  e.after = event.after;
  e.time_s = event.time_s.value;
  e.release_s = event.after ? event.release_s.value : event.time_s.value;
  e.ground_px = event.ground_px.value;
  e.u_ground_px = event.ground_px.u;
  const FlightState s = event.before->At(event.time_s.value);
  e.centre = ToImage(track, s.along_px, s.height_px);
  e.touching = ToImage(track, s.along_px + LowestPointAlong(track, s.face_rad),
                       s.height_px - SupportHeight(track, s.face_rad));
  return e;
}

// The clip ends with the body in the air, and it meets the ground within a
// frame and a half of the last: the flight is known well enough to say so.
std::optional<Event> ContactAtEnd(const PlaneTrack& track,
                                  const EventOptions& options,
                                  std::string& reason) {
  const std::span<const PlaneSample> samples(track.samples);
  Event event;
  event.begin = 0;
  event.end = samples.size();
  // The last frames may already be down: the flight before ends where the gap
  // first vanishes.
  std::size_t down = samples.size();
  while (down > 0 &&
         samples[down - 1].gap_px < 3.0 * samples[down - 1].u_gap_px) {
    --down;
  }
  constexpr std::size_t kFewFrames = 3;
  if (samples.size() - down > kFewFrames) down = samples.size();
  event.first_after = down;
  const auto [lowest, highest] =
      std::minmax_element(samples.begin(), samples.end(),
                          [](const PlaneSample& a, const PlaneSample& b) {
                            return a.gap_px < b.gap_px;
                          });
  reason =
      highest->gap_px < 0.0
          ? fmt::format(
                "the body is below the ground line in every frame: its "
                "greatest gap is {:.1f} px",
                highest->gap_px)
          : fmt::format("the gap never reaches zero: its least is {:.1f} px",
                        lowest->gap_px);
  if (!MeasureEvent(track, event, options)) return std::nullopt;
  const double dt = track.frame_interval_s;
  const double late = event.time_s.value - samples.back().time_s;
  const FlightGap g = GapOf(track, *event.before, event.time_s.value);
  if (g.rate >= 0.0) return std::nullopt;
  constexpr double kFramesBeyond = 1.5;
  if (late > kFramesBeyond * dt) {
    reason += fmt::format(
        "; the path would meet the ground {:.1f} frames after the last",
        late / dt);
    return std::nullopt;
  }
  return event;
}

}  // namespace

ContactResult FindContacts(const PlaneTrack& given,
                           const ContactOptions& options) {
  ContactResult result;
  constexpr std::size_t kLeastSamples = 5;
  if (given.samples.size() < kLeastSamples) {
    result.first = NoContact(
        fmt::format("the body is seen in {} frames only, {} are needed",
                    given.samples.size(), kLeastSamples));
    return result;
  }
  PlaneTrack track = given;
  WidenToScatter(track);
  const std::span<const PlaneSample> samples(track.samples);

  RecordContext context{track, options, FlightFor(options), {}};
  KinkOptions kink_options;
  if (context.flight.gravity_px_per_s2) {
    kink_options.gravity_px_per_s2 = context.flight.gravity_px_per_s2->value;
  }
  Blows blows = FindBlows(track, kink_options);
  if (options.contact_frame) BeginWith(*options.contact_frame, samples, blows);
  for (const Kink& kink : blows.kinks) context.breaks.push_back(kink.after + 1);

  const bool from_start = !options.contact_frame &&
                          OnGroundFromStart(track, blows.kinks, context.flight);
  result.ground_refuted = blows.refuted;
  if (from_start) {
    const PathTrend trend = TakeOutTrend(track);
    const double slope = trend.slope_rad;
    if (trend.bend_px != 0.0) {
      result.warnings.push_back(
          fmt::format("the body's path is bent by {:.1f} px, as a lens without "
                      "calibration bends a line; its gap is taken from the "
                      "path",
                      std::abs(trend.bend_px)));
    }
    constexpr double kNotable = 3.0;  // of the line's own uncertainty
    if (std::abs(slope) > kNotable * track.ground.u_angle_rad) {
      result.warnings.push_back(
          fmt::format("the body's path is inclined by {:.2f} deg to the ground "
                      "line; its gap is taken from the path",
                      slope / core::kDegree));
    }
    result.first = RecordFromStart(context, slope);
    result.ground_refuted.clear();
  }

  EventOptions event_options;
  event_options.flight = context.flight;
  event_options.flight_sigmas = options.flight_sigmas;
  event_options.u_line_px = track.ground.u_offset_px;
  event_options.u_slope_rad = track.ground.u_angle_rad;
  bool first_done = from_start;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < blows.kinks.size(); ++k) {
    Event event;
    event.begin = begin;
    event.first_after = blows.kinks[k].after + 1;
    event.end = k + 1 < blows.kinks.size() ? blows.kinks[k + 1].after + 1
                                           : samples.size();
    begin = event.first_after;
    if (!MeasureEvent(track, event, event_options)) {
      // What comes later is not the first contact.
      if (event.too_few && !first_done) {
        result.first = NoContact(fmt::format(
            "too few frames show the body before its blow at frame {}",
            samples[blows.kinks[k].after].frame));
        first_done = true;
      }
      continue;
    }
    if (GapOf(track, *event.before, event.time_s.value).rate >= 0.0) continue;
    if (from_start) continue;  // hops of a body that slides
    if (!first_done) {
      result.first = RecordOf(context, event, result.warnings);
      first_done = true;
    } else {
      result.later.push_back(RecordOf(context, event, result.warnings));
    }
    result.evidence.push_back(EvidenceOf(track, event));
  }
  if (!first_done) {
    std::string reason;
    if (const auto event = ContactAtEnd(track, event_options, reason)) {
      result.first = RecordOf(context, *event, result.warnings);
      result.evidence.push_back(EvidenceOf(track, *event));
    } else {
      result.first = NoContact(reason);
    }
  }
  return result;
}

std::optional<calib::GroundLine> GroundFromContacts(const Track& track,
                                                    double u_level_rad) {
  if (track.poses.size() < 6) return std::nullopt;
  // A level line through the lowest point of all: also a flight that rises by
  // less than the body's radius comes down to it, and gaps vanish near
  // contacts.
  double lowest = track.poses.front().centre.y_px;
  double left = track.poses.front().centre.x_px;
  double right = left;
  for (const Pose& pose : track.poses) {
    lowest = std::max(lowest, pose.centre.y_px);
    left = std::min(left, pose.centre.x_px);
    right = std::max(right, pose.centre.x_px);
  }
  const auto seen_from = [&](double y_px) {
    calib::GroundLine level =
        calib::GroundThrough({left, y_px}, {std::max(right, left + 1.0), y_px});
    level.u_angle_rad = u_level_rad;
    return SeenFromGround(track, level);
  };
  PlaneTrack plane = seen_from(lowest);
  double least = plane.samples.front().gap_px;
  for (const PlaneSample& s : plane.samples) {
    least = std::min(least, s.gap_px);
  }
  plane = seen_from(lowest - least);
  WidenToScatter(plane);
  const std::vector<Kink> kinks = FindKinks(plane.samples);
  EventOptions options;
  options.u_line_px = 1e3;  // nothing is known of the line yet
  options.u_slope_rad = u_level_rad;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < kinks.size(); ++k) {
    Event event;
    event.begin = begin;
    event.first_after = kinks[k].after + 1;
    event.end =
        k + 1 < kinks.size() ? kinks[k + 1].after + 1 : plane.samples.size();
    begin = event.first_after;
    if (!MeasureEvent(plane, event, options)) continue;
    const ContactEvidence at = EvidenceOf(plane, event);
    calib::GroundLine ground;
    ground.p1 = {left, at.touching.y_px};
    ground.p2 = {std::max(right, left + 1.0), at.touching.y_px};
    ground.reference = at.touching;
    ground.u_offset_px = std::min(event.ground_px.u, 5.0);
    ground.u_angle_rad = u_level_rad;
    ground.source = calib::GroundSource::kContactPoints;
    return ground;
  }
  return std::nullopt;
}

}  // namespace touchdown::vision
