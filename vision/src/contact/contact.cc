#include "touchdown/vision/contact/contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/contact_event.h"
#include "contact/contact_record.h"
#include "contact/drag.h"
#include "contact/impacts.h"
#include "contact/motion_segments.h"
#include "contact/track_noise.h"
#include "numbers/robust.h"
#include "touchdown/vision/contact/supported_path.h"

namespace touchdown::vision {
namespace {

// Of the ground line's height at a sample: its own, and its direction's times
// the distance from the line's reference point.
double UncertaintyOfLine(const PlaneTrack& track, const PlaneSample& s) {
  return std::hypot(track.ground.u_offset_px,
                    track.ground.u_angle_rad * s.along_px);
}

const PlaneSample& FindLowest(const PlaneTrack& track) {
  return *std::min_element(track.samples.begin(), track.samples.end(),
                           [](const PlaneSample& a, const PlaneSample& b) {
                             return a.gap_px < b.gap_px;
                           });
}

// Gravity in px/s^2 along the ground's normal; it is known only where a scale
// is.
FlightOptions MakeFlightOptions(const ContactOptions& options) {
  FlightOptions flight;
  if (options.scale) {
    const core::Estimate& scale = options.scale->px_per_m;
    const core::Estimate& g = options.gravity_mps2;
    core::Estimate px;
    px.value = g.value * scale.value;
    // Relative 1e-9: a scale and a gravity without u still need a finite
    // weight.
    px.u = std::max(std::hypot(g.u * scale.value, g.value * scale.u),
                    1e-9 * px.value);
    flight.gravity_px_per_s2 = px;
  }
  return flight;
}

// How far apart an error that all poses share in the body's own directions puts
// them, px: it goes round with the body, to the other side in half a turn.
double SpreadByTurning(const PlaneTrack& track, double u_common_px) {
  const auto [least, most] =
      std::minmax_element(track.samples.begin(), track.samples.end(),
                          [](const PlaneSample& a, const PlaneSample& b) {
                            return a.face_rad < b.face_rad;
                          });
  const double turned = most->face_rad - least->face_rad;
  return u_common_px * std::sin(0.5 * std::min(turned, std::numbers::pi));
}

SegmentationOptions MakeSegmentationOptions(const PlaneTrack& track,
                                            const ContactOptions& options,
                                            const FlightOptions& flight,
                                            double u_common_px) {
  SegmentationOptions out;
  out.floor_px = std::hypot(out.floor_px, SpreadByTurning(track, u_common_px));
  if (flight.gravity_px_per_s2) {
    out.gravity_px_per_s2 = flight.gravity_px_per_s2->value;
  }
  // The sample after the stated frame; a frame before the first sample or after
  // the last one states nothing that could be used.
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

// What all poses have in common no scatter shows. It is this share of their
// excess noise. Larger: u too wide in compressed clips; smaller: intervals that
// cover in less than 95 %. Measured on 117 compressed clips of known truth (as
// kExcessVariance).
constexpr double kCommonPlace = 0.45;
// The same share for the attitude: the errors of 126 face angles in H.264 (crf
// 23) are most likely with 0.2.
constexpr double kCommonFace = 0.2;
// The same share for the body's size, from the same clips.
constexpr double kCommonSize = 0.3;
// px: no lens blurs as the model has it. Sizes in clean clips of another
// renderer were off by 0.001 to 0.003 px. It keeps the u of a size from
// vanishing in long clean clips.
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
    // Stretches in contact belong to the impact; what follows them tells
    // whether the body rebounds or stays down.
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
    const Flight before = FitFlight(SelectSamples(track, stretches[k]), flight);
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

// How far from the line a body that touches the ground may lie: what yields,
// and a line that is not quite that of contact, by a share of half the body's
// size.
double NearLine(const PlaneTrack& track, const PlaneSample& s, double share) {
  // px. Bodies of a few px are outlined no better; larger lets a wrong line
  // pass for the ground, smaller refutes a right one. Not studied.
  constexpr double kMinNear_px = 2.0;
  // Four standard deviations of the line's own height always pass.
  return std::max({kMinNear_px, 4.0 * UncertaintyOfLine(track, s),
                   share * track.half_short_px});
}

// Shares of half the short side, for NearLine. Larger: a wrong line is taken
// for the ground; smaller: a right one is refuted. Not studied. At an impact
// the flight ends so near to the line.
constexpr double kImpactShare = 0.05;
// No body sinks deeper into the ground.
constexpr double kSinkShare = 0.1;
// An edge of the ground that is seen may be so far off the line of contact.
constexpr double kEdgeShare = 0.3;

std::string DescribeEnd(const Touch& touch, const PlaneSample& last) {
  return fmt::format(
      "the body's flight ends {:.1f} px {} the ground line at frame {}",
      std::abs(touch.gap_px), touch.gap_px > 0 ? "above" : "below", last.frame);
}

// Why the line is not the ground: the body passes through it, or is thrown back
// well above or below it. Empty where line and track agree.
std::string RefuteGround(const PlaneTrack& track,
                         const std::vector<Touch>& touches) {
  const PlaneSample& lowest = FindLowest(track);
  if (-lowest.gap_px > NearLine(track, lowest, kSinkShare)) {
    return fmt::format(
        "the body passes {:.1f} px below the ground line at frame {}",
        -lowest.gap_px, lowest.frame);
  }
  for (const Touch& touch : touches) {
    const PlaneSample& s = track.samples[touch.event.before_frames.end - 1];
    if (std::abs(touch.gap_px) > NearLine(track, s, kImpactShare)) {
      return DescribeEnd(touch, s);
    }
  }
  return {};
}

// Contacts that tell the ground together. A hand makes one or two, and so does
// a flight that was cut a frame off. Not studied.
constexpr std::ptrdiff_t kEnoughContacts = 3;

// Why the rebounds say that the line is not the ground: most of them, and
// enough, lie on the same side of it. Empty where they do not.
std::string RefuteByRebounds(const std::vector<double>& disagreements) {
  const auto count = [&](double sign) {
    return std::count_if(
        disagreements.begin(), disagreements.end(),
        [sign](double sigmas) { return sign * sigmas > core::kBeyondDoubt; });
  };
  for (const double sign : {1.0, -1.0}) {
    const std::ptrdiff_t off = count(sign);
    if (off < kEnoughContacts ||
        2 * off <= static_cast<std::ptrdiff_t>(disagreements.size())) {
      continue;
    }
    return fmt::format(
        "{} of {} rebounds are more than {:.0f} standard deviations {} the "
        "ground line",
        off, disagreements.size(), core::kBeyondDoubt,
        sign > 0.0 ? "above" : "below");
  }
  return {};
}

core::ContactRecord NoContact(const std::string& reason) {
  core::ContactRecord record;
  record.contact.reason = reason;
  record.state.reason = "no contact: " + reason;
  return record;
}

ContactEvidence MakeContactEvidence(const PlaneTrack& track,
                                    const Event& event) {
  ContactEvidence e;
  e.before = event.before;
  e.after = event.after;
  e.time_s = event.time_s.value;
  e.release_s = event.after ? event.release_s.value : event.time_s.value;
  e.ground_px = event.ground_px.value;
  e.u_ground_px = event.ground_px.u;
  const FlightState s = event.before->At(event.time_s.value);
  e.centre = ToImage(track, s.along_px, s.height_px);
  e.touching = ToImage(track, s.along_px + LowestPointOffset(track, s.face_rad),
                       s.height_px - SupportHeight(track, s.face_rad));
  return e;
}

// Measures a touchdown that the clip just misses: it ends with the body in the
// air, and the last flight is known well enough to say when it meets the
// ground, at most a frame and a half after the last.
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
  // Standard deviations (and at least 1 px): the fit must end on the line. Not
  // studied.
  constexpr double kOnLineSigmas = 4.0;
  if (g.rate >= 0.0 ||
      std::abs(g.gap_px) > std::max(1.0, kOnLineSigmas * event.ground_px.u)) {
    return std::nullopt;
  }
  // Frames after the last. A forecast's u grows as it reaches farther, and
  // anything may happen that was not filmed. Not studied.
  constexpr double kMaxFramesBeyond = 1.5;
  if (late > kMaxFramesBeyond * dt) {
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
  // Standard deviations of the line's direction; for a warning only. Not
  // studied.
  constexpr double kNotableSigmas = 3.0;
  if (std::abs(trend.slope_rad) > kNotableSigmas * track.ground.u_angle_rad) {
    warnings.push_back(
        fmt::format("the body's path is inclined by {:.2f} deg to the ground "
                    "line; its gap is taken from the path",
                    trend.slope_rad / core::kDegree));
  }
  // A body that is down from the start does not sink into what carries it: its
  // lowest place lies near the median of its heights.
  std::vector<double> gaps;
  for (const PlaneSample& s : track.samples) gaps.push_back(s.gap_px);
  const double level = Median(gaps);
  const double sunk = level - *std::min_element(gaps.begin(), gaps.end());
  if (sunk > NearLine(track, track.samples.front(), kEdgeShare)) {
    return NoContact(
        fmt::format("its path is neither a flight nor along the ground line: "
                    "it sinks {:.1f} px below where it is half of the time",
                    sunk));
  }
  // Nor does it come down later from where it was carried first.
  const double carried =
      Median({gaps.begin() + static_cast<std::ptrdiff_t>(down.begin),
              gaps.begin() + static_cast<std::ptrdiff_t>(down.end)});
  // One frame in so many may lie lower, as an outlier. More of them hide that a
  // body came down at last; fewer refuse one for an outlier. Not studied.
  constexpr std::size_t kOfAll = 20;
  const auto low =
      gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / kOfAll);
  std::nth_element(gaps.begin(), low, gaps.end());
  if (carried - *low > NearLine(track, track.samples.front(), kSinkShare)) {
    return NoContact(
        fmt::format("its path is neither a flight nor along the ground line: "
                    "it comes down by {:.1f} px from where it is at first; "
                    "check --ground, or give --frames",
                    carried - *low));
  }
  return RecordFromStart(context, down, trend.slope_rad);
}

// Whether the first flight that is seen rises from the ground. Then the body
// touched down before, in frames that are too few to tell of a flight or in
// none, and this touchdown must not be taken from a later contact.
bool BeginsAtImpact(const PlaneTrack& track,
                    const std::vector<Stretch>& stretches,
                    const FlightOptions& options) {
  const bool unclear = stretches[0].kind == StretchKind::kOther;
  if (unclear && stretches.size() < 2) return false;
  const Stretch& first = stretches[unclear ? 1 : 0];
  if (first.kind != StretchKind::kFlight || first.size() < 2) {
    return false;
  }
  const Flight flight = FitFlight(SelectSamples(track, first), options);
  const PlaneSample& s = track.samples[first.begin];
  const FlightGap before =
      GapOfFlight(track, flight, s.time_s - track.frame_interval_s);
  // px: common error of the outlines beside the ground's edge, up to 0.07 px in
  // clips of known truth.
  constexpr double kEdgeBias_px = 0.05;
  // Standard deviations by which the flight may start above the line. Not
  // studied.
  constexpr double kAboveLineSigmas = 3.0;
  return before.rate > 0.0 &&
         before.gap_px <
             kAboveLineSigmas * std::hypot(before.u_px,
                                           UncertaintyOfLine(track, s),
                                           kEdgeBias_px);
}

// The stretch in which the body is down, where it is so from the start (after
// any frames whose motion is not explained); else null.
const Stretch* DownFromStart(const std::vector<Stretch>& stretches) {
  std::size_t first = 0;
  while (first + 1 < stretches.size() &&
         stretches[first].kind == StretchKind::kOther) {
    ++first;
  }
  return stretches[first].kind == StretchKind::kSupported ? &stretches[first]
                                                          : nullptr;
}

// Mean height of a supported stretch above the line, where that is so far that
// something else than the ground carries the body (a rail, a hand); else 0.
double HeightAboveGround(const PlaneTrack& track, const Stretch& stretch) {
  double sum = 0.0;
  for (const PlaneSample& s : SelectSamples(track, stretch)) sum += s.gap_px;
  const double gap = sum / static_cast<double>(stretch.size());
  const double near = NearLine(track, track.samples[stretch.begin], kEdgeShare);
  return std::abs(gap) > near ? gap : 0.0;
}

// The stretches of a path of the same frames.
std::vector<Stretch> CutAs(const std::vector<PathStretch>& path,
                           const PlaneTrack& track) {
  std::vector<Stretch> stretches;
  std::size_t begin = 0;
  for (const PathStretch& given : path) {
    std::size_t end = begin;
    while (end < track.samples.size() &&
           track.samples[end].frame <= given.last_frame) {
      ++end;
    }
    if (end == begin) continue;
    stretches.push_back({{begin, end}, given.kind, given.chi2, given.degrees});
    begin = end;
  }
  return stretches;
}

std::vector<SampleRange> SelectFlights(const std::vector<Stretch>& stretches) {
  std::vector<SampleRange> flights;
  for (const Stretch& stretch : stretches) {
    if (stretch.kind == StretchKind::kFlight) flights.push_back(stretch);
  }
  return flights;
}

// The gravity of the flights as a share of the one that the scale tells, where
// they differ by more than core::kBeyondDoubt; else 1.
double GravityShare(const PlaneTrack& track,
                    const std::vector<Stretch>& stretches,
                    const core::Estimate& told) {
  const auto seen = FitGravity(track, SelectFlights(stretches));
  return seen && core::Disagreement(*seen, told) > core::kBeyondDoubt
             ? seen->value / told.value
             : 1.0;
}

// How the path is cut, and whether under the gravity that the scale tells.
struct Cut {
  std::vector<Stretch> stretches;
  bool gravity_refuted = false;
};

// Cuts the path. The gravity that the scale tells may be wrong, as the scale or
// the frame rate is. Where the flights have another, or frames are left whose
// motion is none of those known, the path is cut without it, too, and the
// likelier cut is taken.
Cut CutPath(const PlaneTrack& track, const SegmentationOptions& options,
            const std::optional<core::Estimate>& gravity_px_per_s2) {
  Segmentation best = SegmentMotion(track, options);
  if (!gravity_px_per_s2) return {std::move(best.stretches), false};
  const bool unknown = std::any_of(
      best.stretches.begin(), best.stretches.end(), [](const Stretch& s) {
        return s.kind == StretchKind::kOther && s.degrees > 0;
      });
  if (!unknown) {
    // About flights of a wrong gravity all residuals are correlated, which
    // would hide it.
    PlaneTrack freely_seen = track;
    WidenToCorrelation(best.stretches, {}, freely_seen);
    if (GravityShare(freely_seen, best.stretches, *gravity_px_per_s2) == 1.0) {
      return {std::move(best.stretches), false};
    }
  }
  SegmentationOptions without = options;
  without.gravity_px_per_s2.reset();
  Segmentation freely = SegmentMotion(track, without);
  // A share that no wrong scale explains is that of no flight: what stands or
  // moves evenly would pass for one. Not studied.
  constexpr double kMostOff = 2.0;
  const double share =
      GravityShare(track, freely.stretches, *gravity_px_per_s2);
  if (!(share > 1.0 / kMostOff && share < kMostOff) ||
      freely.stretches.empty() ||
      freely.cost + 0.5 * core::kBeyondDoubt * core::kBeyondDoubt > best.cost) {
    return {std::move(best.stretches), false};
  }
  return {std::move(freely.stretches), true};
}

// What an error that all poses share in the body's own directions makes of
// gravity: it goes round with the body, u omega^2, px/s^2. omega: in a tenth of
// the track it is larger.
double SpinAcceleration(const PlaneTrack& track, double u_common_px) {
  if (!ShowsTurn(track)) return 0.0;
  // Frames: over fewer, noise of the attitude is taken for spin.
  constexpr std::size_t kApart = 4;
  std::vector<double> rates{0.0};
  for (std::size_t i = kApart; i < track.samples.size(); ++i) {
    const PlaneSample& a = track.samples[i - kApart];
    const PlaneSample& b = track.samples[i];
    rates.push_back(
        std::abs((b.face_rad - a.face_rad) / (b.time_s - a.time_s)));
  }
  const auto high =
      rates.begin() + static_cast<std::ptrdiff_t>(9 * (rates.size() - 1) / 10);
  std::nth_element(rates.begin(), high, rates.end());
  return u_common_px * *high * *high;
}

}  // namespace

ContactResult FindContacts(const PlaneTrack& given,
                           const ContactOptions& options) {
  ContactResult result;
  // Frames: two for the flight, two for what follows, one to contradict them.
  constexpr std::size_t kMinSamples = 5;
  if (given.samples.size() < kMinSamples) {
    result.first = NoContact(
        fmt::format("the body is seen in {} frames only, {} are needed",
                    given.samples.size(), kMinSamples));
    return result;
  }
  PlaneTrack track = given;
  // First the poses' u as their scatter asks for, then what all poses share,
  // then the correlation of the flights' residuals, which needs the flights. If
  // that widens the poses, the path is cut once more under the new weights.
  const ExcessNoise excess = WidenToScatter(track);
  const double u_common_px =
      std::hypot(kCommonPlace * excess.height_px, track.u_common_px);
  const double u_common_face =
      std::hypot(kCommonFace * excess.face_rad, track.u_common_face_rad);
  track.u_half_px =
      std::hypot(track.u_half_px, kOutline_px, kCommonSize * excess.height_px);
  track.ground.u_offset_px = std::hypot(track.ground.u_offset_px, u_common_px);
  const FlightOptions told = MakeFlightOptions(options);
  SegmentationOptions segmentation =
      MakeSegmentationOptions(track, options, told, u_common_px);
  // What flights are asked to contradict.
  std::optional<core::Estimate> asked = told.gravity_px_per_s2;
  if (asked) {
    asked->u = std::hypot(asked->u, SpinAcceleration(track, u_common_px));
  }
  Cut cut = options.path.empty()
                ? CutPath(track, segmentation, asked)
                : Cut{CutAs(options.path, track), options.gravity_refuted};
  FlightOptions flight = told;
  if (cut.gravity_refuted) {
    flight.gravity_px_per_s2.reset();
    segmentation.gravity_px_per_s2.reset();
  }
  if (options.path.empty()) {
    result.drag_per_px = FitDrag(track, SelectFlights(cut.stretches), flight);
  }
  flight.drag_per_px = options.drag_per_px;
  PlaneTrack freely_seen = track;
  if (WidenToCorrelation(cut.stretches, flight, track) &&
      options.path.empty()) {
    cut.stretches = SegmentMotion(track, segmentation).stretches;
  }
  const std::vector<Stretch>& stretches = cut.stretches;
  // About flights of a wrong gravity all residuals are correlated: u would be
  // so large that it hid the gravity that the flights have.
  WidenToCorrelation(stretches, {std::nullopt, flight.drag_per_px},
                     freely_seen);
  result.gravity_refuted = cut.gravity_refuted;
  RecordContext context{track,     freely_seen, options,      flight,
                        stretches, u_common_px, u_common_face};
  if (asked) {
    const double share =
        GravityShare(track, stretches,
                     cut.gravity_refuted ? *told.gravity_px_per_s2 : *asked);
    context.scale_doubt = std::abs(share - 1.0);
    context.bend_px = context.scale_doubt * told.gravity_px_per_s2->value *
                      track.frame_interval_s * track.frame_interval_s;
    if (cut.gravity_refuted) {
      result.warnings.push_back(
          fmt::format("the flights have {:.2f} of the gravity that the scale "
                      "and the frame rate tell: gravity was fitted, and "
                      "lengths are as uncertain; check both",
                      share));
    }
  }
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
  // A refuted line is reported, and contacts are measured all the same: the
  // caller may try another line.
  result.ground_refuted = RefuteGround(track, touches);
  std::optional<core::ContactRecord> first;
  if (BeginsAtImpact(track, stretches, flight)) {
    first = NoContact(fmt::format(
        "too few frames show the body before its impact at frame {}",
        track.samples[stretches.front().end - 1].frame));
  }
  std::string reason;
  std::vector<double> disagreements;  // of rebounds
  const auto add = [&](const Event& event) {
    if (event.after) disagreements.push_back(event.disagreement);
    core::ContactRecord record = MakeRecord(context, event, result.warnings);
    result.evidence.push_back(MakeContactEvidence(track, event));
    if (first) {
      result.later.push_back(std::move(record));
    } else {
      first = std::move(record);
    }
  };
  for (const Touch& touch : touches) {
    const PlaneSample& last = track.samples[touch.event.before_frames.end - 1];
    if (!options.contact_frame &&
        std::abs(touch.gap_px) > NearLine(track, last, kImpactShare)) {
      // Before the first contact it is a hand that lets go.
      if (first && touch.gap_px > 0.0) {
        result.warnings.push_back(DescribeEnd(touch, last) +
                                  ": something struck it, or frames are "
                                  "missing or of uneven time");
      }
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
  if (result.ground_refuted.empty()) {
    result.ground_refuted = RefuteByRebounds(disagreements);
  }
  result.first = std::move(*first);
  result.restitution = PoolRestitution(result);
  return result;
}

std::optional<calib::GroundLine> GroundFromContacts(const Track& track,
                                                    double u_level_rad) {
  // Fewer frames do not hold a flight of four frames and what follows it.
  if (track.poses.size() < 6) return std::nullopt;
  // Start with a level line through the lowest centre of all: a flight that
  // rises by less than the body's radius comes down to it, too, and gaps vanish
  // near contacts.
  double lowest = track.poses.front().centre.y_px;
  double left = track.poses.front().centre.x_px;
  double right = left;
  for (const Pose& pose : track.poses) {
    lowest = std::max(lowest, pose.centre.y_px);
    left = std::min(left, pose.centre.x_px);
    right = std::max(right, pose.centre.x_px);
  }
  const auto level_at = [&](double y_px) {
    calib::GroundLine level = calib::MakeGroundLine(
        {left, y_px}, {std::max(right, left + 1.0), y_px});
    level.u_angle_rad = u_level_rad;
    return level;
  };
  PlaneTrack plane = SeenFromGround(track, level_at(lowest));
  // The level below which the body never sinks: the deepest outline point.
  const double deepest = lowest - FindLowest(plane).gap_px;
  plane = SeenFromGround(track, level_at(deepest));
  WidenToScatter(plane);
  // px: nothing is known of the line yet, so that flights may end at any level.
  constexpr double kUnknownLine_px = 1e3;
  plane.ground.u_offset_px = kUnknownLine_px;
  const auto line_at = [&](const ContactEvidence& at) {
    calib::GroundLine ground = level_at(at.touching.y_px);
    ground.reference = at.touching;
    // The body touched it between two frames that show it: the way from one to
    // the other, evenly spread, bounds what is not known. At least 5 px, so
    // that contacts which follow each other closely are told by one line. Not
    // studied.
    constexpr double kLeastBound_px = 5.0;
    const double unseen_s =
        plane.frame_interval_s *
        static_cast<double>(
            at.after ? at.after->first_frame - at.before->last_frame : 1);
    const double way_px = std::abs(at.before->At(at.time_s).v_n) * unseen_s;
    ground.u_offset_px = std::min(
        at.u_ground_px, std::max(kLeastBound_px, way_px / std::sqrt(12.0)));
    ground.source = calib::GroundSource::kContactPoints;
    return ground;
  };
  // The first contact below which the body does not sink by its own size: what
  // is met later lies elsewhere in perspective, and a body does not pass below
  // its ground.
  std::vector<ContactEvidence> met;
  for (Touch& touch : FindTouches(plane, SegmentMotion(plane).stretches, {})) {
    std::string reason;
    if (!MeasureEvent(plane, {}, touch.event, reason)) continue;
    met.push_back(MakeContactEvidence(plane, touch.event));
    if (deepest - met.back().touching.y_px <= plane.size_px) {
      return line_at(met.back());
    }
  }
  // Or the first of enough at one level, though the body rolls down towards the
  // camera later, or falls off an edge.
  for (auto first = met.begin(); first != met.end(); ++first) {
    const auto at_its_level =
        std::count_if(first, met.end(), [&](const ContactEvidence& later) {
          return std::abs(later.touching.y_px - first->touching.y_px) <
                 0.5 * plane.size_px;
        });
    if (at_its_level >= kEnoughContacts) return line_at(*first);
  }
  return std::nullopt;
}

}  // namespace touchdown::vision
