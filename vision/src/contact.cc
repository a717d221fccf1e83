#include "touchdown/vision/contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contact_event.h"
#include "contact_record.h"
#include "impacts.h"
#include "motion_segments.h"
#include "touchdown/vision/supported_path.h"
#include "track_noise.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

double UncertaintyOfLine(const PlaneTrack& track, const PlaneSample& s) {
  return std::hypot(track.ground.u_offset_px,
                    track.ground.u_angle_rad * s.along_px);
}

const PlaneSample& LowestOf(const PlaneTrack& track) {
  return *std::min_element(track.samples.begin(), track.samples.end(),
                           [](const PlaneSample& a, const PlaneSample& b) {
                             return a.gap_px < b.gap_px;
                           });
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

SegmentationOptions SegmentationFor(const PlaneTrack& track,
                                    const ContactOptions& options,
                                    const FlightOptions& flight) {
  SegmentationOptions out;
  if (flight.gravity_px_per_s2) {
    out.gravity_px_per_s2 = flight.gravity_px_per_s2->value;
  }
  if (options.contact_frame) {
    const auto next = std::find_if(
        track.samples.begin(), track.samples.end(),
        [&](const PlaneSample& s) { return s.frame > *options.contact_frame; });
    if (next != track.samples.begin() && next != track.samples.end()) {
      out.touchdown = static_cast<std::size_t>(next - track.samples.begin());
    }
  }
  return out;
}

// What all poses have in common no scatter shows. Of their excess noise it is
// this part, in place and attitude and in the body's size (as in
// kExcessVariance: 117 compressed clips).
constexpr double kCommonPlace = 0.45;
constexpr double kCommonSize = 0.3;
// No lens blurs as the model has it: sizes in clean clips of another renderer
// were off by 0.001 to 0.003 px.
constexpr double kOutline_px = 0.0015;

// A flight that ends as something stops it or throws it back, and what follows.
struct Touch {
  Event event;
  double gap_px = 0.0;  // of the flight, between its last frame and the next
};

std::vector<Touch> FindTouches(const PlaneTrack& track,
                               const std::vector<Stretch>& stretches,
                               const FlightOptions& flight) {
  std::vector<Touch> touches;
  const std::vector<PlaneSample>& samples = track.samples;
  for (std::size_t k = 0; k + 1 < stretches.size(); ++k) {
    if (stretches[k].kind != StretchKind::kFlight ||
        stretches[k + 1].kind == StretchKind::kOther) {
      continue;
    }
    Touch touch;
    touch.event.before_frames = stretches[k];
    std::size_t next = k + 1;
    while (next + 1 < stretches.size() &&
           stretches[next].kind == StretchKind::kContact) {
      ++next;
    }
    if (stretches[next].kind == StretchKind::kFlight) {
      touch.event.after_frames = stretches[next];
    } else if (stretches[next].kind == StretchKind::kSupported) {
      touch.event.down_frames = stretches[next];
    }
    const std::size_t last = stretches[k].end - 1;
    const Flight before = FitFlight(SamplesIn(track, stretches[k]), flight);
    const double at = samples[last].gap_px;
    const double then =
        GapOfFlight(track, before, samples[last + 1].time_s).gap_px;
    // Zero where the flight crosses the line between them.
    touch.gap_px = at > 0.0 && then < 0.0
                       ? 0.0
                       : (std::abs(at) < std::abs(then) ? at : then);
    touches.push_back(touch);
  }
  return touches;
}

// How far from the line what touches the ground may lie: what yields, and a
// line that is not quite that of contact, by a share of half the body's size.
double NearLine(const PlaneTrack& track, const PlaneSample& s, double share) {
  constexpr double kNear_px = 2.0;
  return std::max({kNear_px, 4.0 * UncertaintyOfLine(track, s),
                   share * track.half_short_px});
}
constexpr double kAtContact = 0.05;
constexpr double kSunk = 0.1;      // no body sinks into the ground by more
constexpr double kSeenEdge = 0.3;  // it may be off the contact

// Why the line is not the ground: the body passes through it, or is thrown back
// well above or below it. Empty where line and track agree.
std::string RefuteGround(const PlaneTrack& track,
                         const std::vector<Touch>& touches) {
  const PlaneSample& lowest = LowestOf(track);
  if (-lowest.gap_px > NearLine(track, lowest, kSunk)) {
    return fmt::format(
        "the body passes {:.1f} px below the ground line at frame {}",
        -lowest.gap_px, lowest.frame);
  }
  for (const Touch& touch : touches) {
    const PlaneSample& s = track.samples[touch.event.before_frames.end - 1];
    if (std::abs(touch.gap_px) > NearLine(track, s, kAtContact)) {
      return fmt::format(
          "the body rebounds {:.1f} px {} the ground line at frame {}",
          std::abs(touch.gap_px), touch.gap_px > 0 ? "above" : "below",
          s.frame);
    }
  }
  return {};
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
std::optional<Event> MeasureAtEnd(const PlaneTrack& track,
                                  const std::vector<Stretch>& stretches,
                                  const FlightOptions& options,
                                  std::string& reason) {
  const std::span<const PlaneSample> samples(track.samples);
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
  if (stretches.back().kind != StretchKind::kFlight) return std::nullopt;
  Event event;
  event.before_frames = stretches.back();
  std::string too_few;
  if (!MeasureEvent(track, options, event, too_few)) return std::nullopt;
  const double dt = track.frame_interval_s;
  const double late = event.time_s.value - samples.back().time_s;
  const FlightGap g = GapOfFlight(track, *event.before, event.time_s.value);
  constexpr double kOnLine = 4.0;  // sigmas
  if (g.rate >= 0.0 ||
      std::abs(g.gap_px) > std::max(1.0, kOnLine * event.ground_px.u)) {
    return std::nullopt;
  }
  constexpr double kFramesBeyond = 1.5;
  if (late > kFramesBeyond * dt) {
    reason += fmt::format(
        "; the path would meet the ground {:.1f} frames after the last",
        late / dt);
    return std::nullopt;
  }
  return event;
}

// A body that is down from the first frame, and the warnings that its path
// gives about the line.
core::ContactRecord MeasureFromStart(RecordContext& context,
                                     const Stretch& down, PlaneTrack& track,
                                     std::vector<std::string>& warnings) {
  const PathTrend trend = TakeOutTrend(track);
  if (trend.bend_px != 0.0) {
    warnings.push_back(
        fmt::format("the body's path is bent by {:.1f} px, as a lens without "
                    "calibration bends a line; its gap is taken from the path",
                    std::abs(trend.bend_px)));
  }
  constexpr double kNotable = 3.0;  // of the line's own uncertainty
  if (std::abs(trend.slope_rad) > kNotable * track.ground.u_angle_rad) {
    warnings.push_back(
        fmt::format("the body's path is inclined by {:.2f} deg to the ground "
                    "line; its gap is taken from the path",
                    trend.slope_rad / core::kDegree));
  }
  // Whatever is down from the start does not sink into what carries it.
  std::vector<double> gaps;
  for (const PlaneSample& s : track.samples) gaps.push_back(s.gap_px);
  const double level = Median(gaps);
  const double sunk = level - *std::min_element(gaps.begin(), gaps.end());
  if (sunk > NearLine(track, track.samples.front(), kSeenEdge)) {
    return NoContact(
        fmt::format("its path is neither a flight nor along the ground line: "
                    "it sinks {:.1f} px below where it is half of the time",
                    sunk));
  }
  return RecordFromStart(context, down, trend.slope_rad);
}

// The first flight that is seen rises from the ground: it touched down before,
// in frames that are too few to tell of a flight, or in none.
bool BeginsAtImpact(const PlaneTrack& track,
                    const std::vector<Stretch>& stretches,
                    const FlightOptions& options) {
  const bool unclear = stretches[0].kind == StretchKind::kOther;
  if (unclear && stretches.size() < 2) return false;
  const Stretch& first = stretches[unclear ? 1 : 0];
  if (first.kind != StretchKind::kFlight || first.size() < 2) {
    return false;
  }
  const Flight flight = FitFlight(SamplesIn(track, first), options);
  const PlaneSample& s = track.samples[first.begin];
  const FlightGap before =
      GapOfFlight(track, flight, s.time_s - track.frame_interval_s);
  constexpr double kEdgeBias_px = 0.05;
  constexpr double kSigmas = 3.0;
  return before.rate > 0.0 &&
         before.gap_px < kSigmas * std::hypot(before.u_px,
                                              UncertaintyOfLine(track, s),
                                              kEdgeBias_px);
}

// The stretch in which the body is down, where it is so from the start.
const Stretch* DownFromStart(const std::vector<Stretch>& stretches) {
  std::size_t first = 0;
  while (first + 1 < stretches.size() &&
         stretches[first].kind == StretchKind::kOther) {
    ++first;
  }
  return stretches[first].kind == StretchKind::kSupported ? &stretches[first]
                                                          : nullptr;
}

// How far a supported stretch lies above the line, where that is so far that
// something else carries the body; else 0.
double HeightAboveGround(const PlaneTrack& track, const Stretch& stretch) {
  double sum = 0.0;
  for (const PlaneSample& s : SamplesIn(track, stretch)) sum += s.gap_px;
  const double gap = sum / static_cast<double>(stretch.size());
  const double near = NearLine(track, track.samples[stretch.begin], kSeenEdge);
  return std::abs(gap) > near ? gap : 0.0;
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
  const ExcessNoise excess = WidenToScatter(track);
  const double u_common_px =
      std::hypot(kCommonPlace * excess.height_px, track.u_common_px);
  const double u_common_face =
      std::hypot(kCommonPlace * excess.face_rad, track.u_common_face_rad);
  track.u_half_px =
      std::hypot(track.u_half_px, kOutline_px, kCommonSize * excess.height_px);
  track.ground.u_offset_px = std::hypot(track.ground.u_offset_px, u_common_px);
  const FlightOptions flight = FlightFor(options);
  const SegmentationOptions segmentation =
      SegmentationFor(track, options, flight);
  std::vector<Stretch> stretches = SegmentMotion(track, segmentation);
  if (WidenToCorrelation(stretches, flight, track)) {
    stretches = SegmentMotion(track, segmentation);
  }
  RecordContext context{track,     options,     flight,
                        stretches, u_common_px, u_common_face};
  for (const Stretch& stretch : stretches) {
    result.path.push_back({stretch.kind, track.samples[stretch.begin].frame,
                           track.samples[stretch.end - 1].frame, stretch.chi2,
                           stretch.degrees});
  }
  const std::vector<Touch> touches = FindTouches(track, stretches, flight);

  // What carries it far from the line is not the ground: a rail, a hand.
  const Stretch* down = DownFromStart(stretches);
  const double above = down ? HeightAboveGround(track, *down) : 0.0;
  if (down && above == 0.0) {
    result.first = MeasureFromStart(context, *down, track, result.warnings);
    return result;
  }
  result.ground_refuted = RefuteGround(track, touches);
  std::optional<core::ContactRecord> first;
  if (BeginsAtImpact(track, stretches, flight)) {
    first = NoContact(fmt::format(
        "too few frames show the body before its impact at frame {}",
        track.samples[stretches.front().end - 1].frame));
  }
  std::string reason;
  const auto add = [&](const Event& event) {
    core::ContactRecord record = RecordOf(context, event, result.warnings);
    result.evidence.push_back(EvidenceOf(track, event));
    if (first) {
      result.later.push_back(std::move(record));
    } else {
      first = std::move(record);
    }
  };
  for (const Touch& touch : touches) {
    const PlaneSample& last = track.samples[touch.event.before_frames.end - 1];
    if (!options.contact_frame &&
        std::abs(touch.gap_px) > NearLine(track, last, kAtContact)) {
      continue;
    }
    Event event = touch.event;
    if (MeasureEvent(track, flight, event, reason)) {
      add(event);
    } else if (!first) {
      // What comes later is not the first contact.
      first = NoContact(reason);
    }
  }
  if (first) {
    // Told.
  } else if (const auto event =
                 MeasureAtEnd(track, stretches, flight, reason)) {
    add(*event);
  } else if (down && stretches.size() == 1) {
    result.ground_refuted =
        fmt::format("the body moves along a line {:.1f} px {} the ground line",
                    std::abs(above), above > 0.0 ? "above" : "below");
    first = NoContact(result.ground_refuted);
  } else {
    first = NoContact(reason);
  }
  result.first = std::move(*first);
  result.restitution = PoolRestitution(result);
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
  const auto level_at = [&](double y_px) {
    calib::GroundLine level =
        calib::GroundThrough({left, y_px}, {std::max(right, left + 1.0), y_px});
    level.u_angle_rad = u_level_rad;
    return level;
  };
  PlaneTrack plane = SeenFromGround(track, level_at(lowest));
  // Below it the body does not sink.
  const double deepest = lowest - LowestOf(plane).gap_px;
  plane = SeenFromGround(track, level_at(deepest));
  WidenToScatter(plane);
  constexpr double kUnknown_px = 1e3;  // nothing is known of the line yet
  plane.ground.u_offset_px = kUnknown_px;
  // The first contact below which the body does not sink by its own size: what
  // is met later lies elsewhere in perspective, and a body does not pass below
  // its ground.
  for (Touch& touch : FindTouches(plane, SegmentMotion(plane), {})) {
    std::string reason;
    if (!MeasureEvent(plane, {}, touch.event, reason)) continue;
    const ContactEvidence at = EvidenceOf(plane, touch.event);
    if (deepest - at.touching.y_px > plane.size_px) continue;
    calib::GroundLine ground = level_at(at.touching.y_px);
    ground.reference = at.touching;
    ground.u_offset_px = std::min(touch.event.ground_px.u, 5.0);
    ground.source = calib::GroundSource::kContactPoints;
    return ground;
  }
  return std::nullopt;
}

}  // namespace touchdown::vision
