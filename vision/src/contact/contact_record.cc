#include "contact/contact_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "contact/greatest_gap.h"
#include "contact/impacts.h"
#include "contact/pixel_locking.h"
#include "touchdown/vision/contact/state.h"

namespace touchdown::vision {
namespace {

using core::AbsentBecause;
using core::Estimate;
using core::Measured;

const char kNoScale[] =
    "no scale: give a calibration, a scale or the body's size";

// px a frame. Slower motion cannot be told from rest; it keeps the quotients by
// a pace finite. Not studied.
constexpr double kMinPace_px = 0.01;

// By how much what all poses have in common drifts per frame, as body and
// surroundings change.
double CommonDrift(double u_common, const SampleRange& flight) {
  // Of the common part, over a whole flight. 0.25: in 51 clips with
  // photographed faces 92 % of the drifts then lie within 1.96 times this and
  // their own noise; without it 76 %. Larger widens every approach angle.
  constexpr double kDriftShare = 0.25;
  return kDriftShare * u_common / static_cast<double>(flight.size());
}

// By how much the path leans at touchdown, px a frame, where the places err by
// bend (t - t0)^2 / 2 and gravity is fitted: bend t0, with t0 anywhere in the
// flight alike (rms of a uniform distribution).
double BendAtEnd(double bend_px, const SampleRange& flight) {
  return bend_px * static_cast<double>(flight.size()) / std::numbers::sqrt3;
}

void MakeAbsent(std::initializer_list<Measured*> values, const char* reason) {
  for (Measured* value : values) *value = AbsentBecause(reason);
}

// Converts px (or px/s) to metres (or m/s); the scale's relative u is added in
// quadrature, and what the flights say against it.
Measured InMetres(const RecordContext& context, const Estimate& px) {
  if (!context.options.scale) return AbsentBecause(kNoScale);
  const Estimate& s = context.options.scale->px_per_m;
  const double value = px.value / s.value;
  return Estimate{value, std::hypot(px.u / s.value, value * s.u / s.value,
                                    value * context.scale_doubt)};
}

// Velocities along and normal to the true ground, px per frame. The ground is
// inclined to the line by the small angle kSlope: sin = kSlope, cos = 1.
double TangentialSpeed(const JointVector& p, JointParameter vx,
                       JointParameter vy) {
  return p[vx] + p[kSlope] * p[vy];
}
double NormalSpeed(const JointVector& p, JointParameter vx, JointParameter vy) {
  return p[vy] - p[kSlope] * p[vx];
}
double ApproachNormal(const JointVector& p) { return NormalSpeed(p, kVx, kVy); }
double ReboundNormal(const JointVector& p) {
  return NormalSpeed(p, kVx2, kVy2);
}
double ApproachTangential(const JointVector& p) {
  return TangentialSpeed(p, kVx, kVy);
}
double ReboundTangential(const JointVector& p) {
  return TangentialSpeed(p, kVx2, kVy2);
}

// Of the outline that tells the body's height, the part that lies within a blur
// of the ground where the body touches it; 1: a face.
double ShareBesideGround(const PlaneTrack& track, double face_rad) {
  const double pi = std::numbers::pi;
  const double blur = track.blur_px;
  if (track.kind == core::BodyKind::kSphere) {
    const double r = track.half_long_px;
    return std::min(1.0, 2.0 * std::sqrt(2.0 * blur * r) / (pi * r));
  }
  const bool lies = std::abs(std::remainder(face_rad, pi)) < 0.25 * pi;
  const double side = 2.0 * (lies ? track.half_long_px : track.half_short_px);
  const double rises =
      side * std::abs(std::sin(std::remainder(face_rad, 0.5 * pi)));
  return rises > blur ? blur / rises : 1.0;
}

// Beside the ground's edge the model of an outline is off by something else
// than in the air: a face by  kChange exp(-gap / blur),  whose slope of least
// squares is one of the flight, px a frame.
double LeanBesideGround(const PlaneTrack& track, const SampleRange& flight) {
  // px. A camera's edge is not Gauss's, and its blur and the ground's contrast
  // are known to a percent. Larger widens the approach of bodies that glide in
  // along the ground; smaller believes some that are 0.05 deg off. 0.015: of 97
  // clips of blocks that land flat 93 lie within 1.96 u with it, 90 without.
  constexpr double kChange_px = 0.015;
  if (!(track.blur_px > 0.0)) return 0.0;  // not known
  const std::span<const PlaneSample> samples = SelectSamples(track, flight);
  const double middle = 0.5 * static_cast<double>(samples.size() - 1);
  double rise = 0.0;
  double spread = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double at = static_cast<double>(i) - middle;
    rise += at * std::exp(-std::max(samples[i].gap_px, 0.0) / track.blur_px);
    spread += at * at;
  }
  return kChange_px * ShareBesideGround(track, samples.back().face_rad) *
         std::abs(rise) / spread;
}

// Place of the lowest point along x', from the centre, at touchdown.
double ContactArm(const PlaneTrack& track, const JointVector& p) {
  PlaneTrack sized;
  sized.kind = track.kind;
  sized.half_long_px = p[kHalfLong];
  sized.half_short_px = p[kHalfShort];
  return LowestPointOffset(sized, p[kFace] - p[kSlope]);
}

// Splits the variance of `f` by what it comes of: ground first, then what the
// size adds to it, then the scale (which the known gravity in px/s^2 stands
// for). The rest is localisation. The squares add up to u^2.
core::Budget ComputeBudget(const JointFit& fit, const JointFit::Function& f,
                           double u) {
  const double ground = fit.UncertaintyShare(f, {kGround, kSlope});
  const double with_size =
      fit.UncertaintyShare(f, {kGround, kSlope, kHalfLong, kHalfShort});
  const double with_scale = fit.UncertaintyShare(
      f, {kGround, kSlope, kHalfLong, kHalfShort, kGravity});
  const auto rest = [](double all, double part) {
    return std::sqrt(std::max(0.0, all * all - part * part));
  };
  return {{"localisation", rest(u, with_scale)},
          {"ground", ground},
          {"size", rest(with_size, ground)},
          {"scale", rest(with_scale, with_size)}};
}

// Writes the face angle and names the corner. Flush: the second lowest corner
// is as low as the lowest within what the attitude is known to (2 u), or within
// the resolution.
void FillAttitude(const PlaneTrack& track, const Estimate& measured,
                  double resolution_rad, core::Contact& contact) {
  const double pi = std::numbers::pi;
  // A rectangle turned by pi looks the same: the angle is taken to (-90, 90]
  // deg.
  double face = std::remainder(measured.value, pi);
  if (face <= -0.5 * pi) face += pi;
  contact.face_angle_rad = Estimate{face, measured.u};
  const double tilt = std::abs(std::remainder(face, 0.5 * pi));
  contact.corner =
      tilt < std::max(2.0 * measured.u, resolution_rad) ? core::Corner::kFlush
      : LowestPointOffset(track, face) > 0.0            ? core::Corner::kLeading
                                             : core::Corner::kTrailing;
}

void FillAngles(const RecordContext& context, const Event& event,
                core::Contact& contact) {
  const PlaneTrack& track = context.track;
  const JointFit& fit = *event.fit;
  const auto approach = [](const JointVector& p) {
    return std::atan2(-ApproachNormal(p), std::abs(ApproachTangential(p)));
  };
  Estimate angle = fit.EstimateFunction(approach);
  const double localised_approach = angle.u;
  // A common error in the body's own directions turns with the body, as if the
  // centre moved by u omega a frame; besides, it drifts. Divided by the pace,
  // either is an error of the direction of motion.
  const double paces =
      std::max(std::hypot(fit.EstimateFunction(ApproachNormal).value,
                          fit.EstimateFunction(ApproachTangential).value),
               kMinPace_px);
  const double picture =
      std::hypot(context.u_common_place_px * fit.p[kOmega],
                 CommonDrift(context.u_common_place_px, event.before_frames),
                 std::hypot(BendAtEnd(context.bend_px, event.before_frames),
                            LeanBesideGround(track, event.before_frames))) /
      paces;
  angle.u = std::hypot(angle.u, picture);
  contact.approach_angle_rad =
      Estimate{std::clamp(angle.value, 0.0, 0.5 * std::numbers::pi), angle.u};
  // No angle is negative: near 0 the normal interval promises what cannot be,
  // and an interval from 0 on is given instead.
  if (angle.value < core::kNormal975 * angle.u) {
    Estimate& flat = *contact.approach_angle_rad;
    flat.interval95 =
        core::Interval{0.0, flat.value + core::kNormal975 * angle.u};
  }
  contact.approach_budget = ComputeBudget(fit, approach, localised_approach);
  if (picture > 0.0) contact.approach_budget.push_back({"picture", picture});
  if (track.kind == core::BodyKind::kSphere) {
    contact.radius_angle_rad = AbsentBecause("sphere: 90 degrees always");
    contact.face_angle_rad = AbsentBecause("sphere");
    return;
  }
  const auto to_ground = [](const JointVector& p) {
    return p[kFace] - p[kSlope];
  };
  Estimate measured = fit.EstimateFunction(to_ground);
  const double localised = measured.u;
  measured.u = std::hypot(measured.u, context.u_common_face_rad);
  // px at a corner: lower than that the two lowest corners are not told apart.
  // Larger calls more impacts flush. Not studied.
  constexpr double kFlush_px = 0.05;
  FillAttitude(track, measured, kFlush_px / (2.0 * track.half_long_px),
               contact);
  contact.attitude_budget = ComputeBudget(fit, to_ground, localised);
  contact.attitude_budget.push_back({"picture", context.u_common_face_rad});
  // Paper, Fig. 1: the acute angle between the ground and the line from the
  // centre to the contact point, atan2(support height, |arm|).
  contact.radius_angle_rad = fit.EstimateFunction([&](const JointVector& p) {
    const double at = p[kFace] - p[kSlope];
    const double reach = p[kHalfLong] * std::abs(std::sin(at)) +
                         p[kHalfShort] * std::abs(std::cos(at));
    return std::atan2(reach, std::abs(ContactArm(track, p)));
  });
  Estimate& radius = *contact.radius_angle_rad;
  radius.u =
      std::hypot(radius.u, context.u_common_face_rad, CornerTurnByGamma(track));
}

void FillMotion(const RecordContext& context, const Event& event,
                core::ContactRecord& record) {
  const PlaneTrack& track = context.track;
  const JointFit& fit = *event.fit;
  core::Motion& m = record.motion;
  // A common error in the body's own directions goes round with the body, and
  // places that bend the path lean at touchdown: px a frame before and after.
  const double round_before =
      std::hypot(context.u_common_place_px * fit.p[kOmega],
                 BendAtEnd(context.bend_px, event.before_frames));
  const double round_after =
      std::hypot(context.u_common_place_px * fit.p[kOmega2],
                 BendAtEnd(context.bend_px, event.after_frames));
  const auto speed = [&](const JointFit::Function& f, double round) {
    Estimate pace = fit.EstimateFunction(f);
    pace.u = std::hypot(pace.u, round);
    return InMetres(context, core::Scaled(pace, 1.0 / fit.interval_s));
  };
  m.before_speed_mps =
      speed([](const JointVector& p) { return std::hypot(p[kVx], p[kVy]); },
            round_before);
  m.before_normal_mps = speed(ApproachNormal, round_before);
  m.before_tangential_mps = speed(ApproachTangential, round_before);
  const auto omega = [&](JointParameter k,
                         const SampleRange& flight) -> Measured {
    if (!ShowsTurn(track)) return AbsentBecause("no mark on the sphere");
    // face grows as the leading end rises: counter-clockwise with x' ahead.
    Estimate rate =
        fit.EstimateFunction([k](const JointVector& p) { return p[k]; });
    rate.u = std::hypot(rate.u, CommonDrift(context.u_common_face_rad, flight));
    return core::Scaled(rate, 1.0 / fit.interval_s);
  };
  m.before_omega_rad_per_s = omega(kOmega, event.before_frames);
  if (!event.after) {
    MakeAbsent(
        {&m.after_normal_mps, &m.after_tangential_mps, &m.after_omega_rad_per_s,
         &m.restitution, &m.centre_rebound_ratio, &m.impulse_ratio},
        "no release from the ground was seen");
  } else {
    m.after_normal_mps = speed(ReboundNormal, round_after);
    m.after_tangential_mps = speed(ReboundTangential, round_after);
    m.after_omega_rad_per_s = omega(kOmega2, event.after_frames);
    // Normal velocity of the contact point: the centre's and that of the lowest
    // point about it, omega times its arm along the ground.
    const auto point_before = [&](const JointVector& p) {
      return ApproachNormal(p) + p[kOmega] * ContactArm(track, p);
    };
    const auto point_after = [&](const JointVector& p) {
      return ReboundNormal(p) + p[kOmega2] * ContactArm(track, p);
    };
    // A quotient is given where its denominator stands clear of its own u: else
    // the first-order u of the quotient means nothing.
    const auto quotient = [&](const JointFit::Function& above,
                              const JointFit::Function& below,
                              const char* what) -> Measured {
      const Estimate denominator = fit.EstimateFunction(below);
      if (!(std::abs(denominator.value) > kMeasurable * denominator.u)) {
        return AbsentBecause(
            fmt::format("the {} is below five times its uncertainty", what));
      }
      Estimate ratio = fit.EstimateFunction(
          [&](const JointVector& p) { return above(p) / below(p); });
      ratio.u = std::hypot(ratio.u, round_after / denominator.value,
                           ratio.value * round_before / denominator.value);
      return ratio;
    };
    m.restitution =
        quotient([&](const JointVector& p) { return -point_after(p); },
                 point_before, "normal velocity before");
    if (std::string several = WhySeveralImpacts(track, fit); !several.empty()) {
      m.restitution = AbsentBecause(std::move(several));
      m.unresolved_impacts = 2;
    }
    m.centre_rebound_ratio =
        quotient([](const JointVector& p) { return -ReboundNormal(p); },
                 ApproachNormal, "normal velocity before");
    // Of the impulses per mass: |change of tangential velocity| over change of
    // normal velocity. It equals the coefficient of friction where the contact
    // slips throughout.
    m.impulse_ratio = quotient(
        [](const JointVector& p) {
          return std::abs(ReboundTangential(p) - ApproachTangential(p));
        },
        [](const JointVector& p) {
          return ReboundNormal(p) - ApproachNormal(p);
        },
        "change of normal velocity");
  }

  // Gravity is fitted freely, as a check of scale and frame rate: both flights'
  // values, weighted.
  m.gravity_check_mps2 = AbsentBecause(kNoScale);
  if (context.options.scale) {
    m.gravity_check_mps2 =
        AbsentBecause("uninformative: its uncertainty exceeds 10 %");
    std::vector<SampleRange> flights = {event.before_frames};
    if (event.after) flights.push_back(event.after_frames);
    if (auto gravity_px = FitGravity(context.freely_seen, flights,
                                     context.flight.drag_per_px)) {
      const double fastest =
          std::max(std::abs(fit.p[kOmega]), std::abs(fit.p[kOmega2])) /
          fit.interval_s;
      gravity_px->u = std::hypot(gravity_px->u,
                                 context.u_common_place_px * fastest * fastest);
      RecordContext stated = context;  // what is checked
      stated.scale_doubt = 0.0;
      const Measured g_si = InMetres(stated, *gravity_px);
      // Of the gravity that is known, not of the value: a value must not decide
      // whether it is told. Larger: numbers that tell nothing are in the
      // document; smaller: a frame rate that is 1.2 times too high (a gravity
      // 1.44 times too high) passes without a word. With this limit none of 76
      // clips of right statements (strangers, seeds 59 and 66) is doubted.
      constexpr double kMaxInformativeU = 0.1;
      if (g_si->u < kMaxInformativeU * context.options.gravity_mps2.value) {
        m.gravity_check_mps2 = g_si;
      }
    }
  }
}

// The bounce height in px, and in metres where there is a scale.
double BounceHeight(const RecordContext& context, core::StateDecision& state) {
  const PlaneTrack& track = context.track;
  const double size_px = track.size_px;
  if (!context.options.scale) {
    state.bounce_height_m = AbsentBecause(kNoScale);
    // The campaign's default without its floor in mm, which needs a scale.
    constexpr double kShareOfSize = 0.02;
    return kShareOfSize * size_px;
  }
  const double px_per_m = context.options.scale->px_per_m.value;
  const double height_m = context.options.bounce_height_m
                              ? *context.options.bounce_height_m
                              : core::DefaultBounceHeight(size_px / px_per_m);
  state.bounce_height_m = Estimate{height_m, 0.0};
  return height_m * px_per_m;
}

// In mm where there is a scale, else in px. Without u where there is none: a
// bounce height is a convention.
std::string LengthText(const RecordContext& context, double px, double u_px) {
  const double unit =
      context.options.scale ? 1e3 / context.options.scale->px_per_m.value : 1.0;
  const int decimals = context.options.scale ? 3 : 2;
  std::string text = fmt::format("{:.{}f} ", px * unit, decimals);
  if (u_px > 0.0) text += fmt::format("+- {:.{}f} ", u_px * unit, decimals);
  return text + (context.options.scale ? "mm" : "px");
}

// Fills the state from the greatest gap after sample `from`; `event`: the
// contact before it, or null.
void FillState(const RecordContext& context, std::size_t from,
               const GroundLevel& ground, const Event* event,
               core::StateDecision& state) {
  const PlaneTrack& track = context.track;
  const std::vector<PlaneSample>& samples = track.samples;
  const double height_px = BounceHeight(context, state);
  // Of one typical frame: the middle one stands neither at the edge of the
  // picture nor at the start.
  const double noise_px = samples[samples.size() / 2].u_gap_px;
  if (context.options.scale) {
    const double s = context.options.scale->px_per_m.value;
    state.detectable_gap_m =
        Estimate{DetectableGap(noise_px / s, 1.0 / track.frame_interval_s,
                               ground.height_px.u / s,
                               context.options.gravity_mps2.value),
                 0.0};
  } else {
    state.detectable_gap_m = AbsentBecause(kNoScale);
  }
  const auto greatest = FindGreatestGap(track, context.stretches, from, ground,
                                        context.flight, event);
  // Frames. With fewer no rebound can be judged and the state is undecided. Not
  // studied.
  constexpr std::size_t kMinFramesAfter = 3;
  if (!greatest || samples.size() - from < kMinFramesAfter) {
    state.label = core::MotionState::kUndecided;
    state.max_gap_m = AbsentBecause("no rebound was filmed");
    state.reason = fmt::format(
        "no rebound was filmed: {} frames after touchdown, {} are needed",
        samples.size() - from, kMinFramesAfter);
    return;
  }
  // A gap is a difference of two poses far from each other. Each has an error
  // that its neighbours share, so that the u of the common part counts sqrt(2)
  // times.
  Estimate gap = greatest->gap_px;
  gap.u = std::hypot(gap.u, std::numbers::sqrt2 * context.u_common_place_px);
  // A gap is not negative; what is below is noise of pose and ground.
  state.max_gap_m = InMetres(context, gap);
  const StateEvidence evidence = DecideBounce(gap, height_px);
  state.label = evidence.label;
  state.p_bounce = evidence.p_bounce;
  state.reason =
      fmt::format("greatest gap {} at frame {}, bounce height {}",
                  LengthText(context, gap.value, gap.u), greatest->frame,
                  LengthText(context, height_px, 0.0));
  // The rule of the motion state: where the film ends while the body rises
  // below the bounce height, the state is undecided, and the extrapolated
  // height is a field of its own.
  if (state.label != core::MotionState::kBounce && greatest->reaches_px) {
    Estimate reaches = *greatest->reaches_px;
    reaches.u =
        std::hypot(reaches.u, std::numbers::sqrt2 * context.u_common_place_px);
    state.label = core::MotionState::kUndecided;
    state.p_bounce.reset();
    state.extrapolated_gap_m = InMetres(context, reaches);
    state.reason += fmt::format(
        "; the clip ends while the body still rises, to {} by its flight",
        LengthText(context, reaches.value, reaches.u));
    return;
  }
  state.micro_bounce = state.label == core::MotionState::kStaysDown && event &&
                       event->after && gap.value > core::kNormal975 * gap.u;
}

// Standard deviations of a way or a turn on the ground. Fewer: noise of a body
// at rest is called a slide. Not studied.
constexpr double kClearSigmas = 3.0;
// A way that is no motion, whatever its u. Larger: short slides are called
// stuck. Not studied.
constexpr double kLeastWay_px = 1.0;

// Names what a ball with marks does from `a` to `b`, on the ground: the contact
// point goes by  along + R face,  which is nothing where it rolls (face is
// positive with the leading end up, so that rolling on turns it backward).
void NameBallThatStaysDown(const RecordContext& context, const PlaneSample& a,
                           const PlaneSample& b, core::StateDecision& state) {
  const double radius_px = context.track.half_long_px;
  const Estimate path{
      b.along_px - a.along_px,
      std::hypot(a.u_along_px, b.u_along_px,
                 std::numbers::sqrt2 * context.u_common_place_px)};
  const double angle = b.face_rad - a.face_rad;
  const double u_angle =
      std::hypot(a.u_face_rad, b.u_face_rad, context.u_common_face_rad);
  const Estimate turned{
      radius_px * angle,
      std::hypot(radius_px * u_angle, context.track.u_half_px * angle)};
  const Estimate slipped{path.value + turned.value,
                         std::hypot(path.u, turned.u)};
  const auto is_nothing = [&](const Estimate& way) {
    return std::abs(way.value) <= std::fmax(kLeastWay_px, kClearSigmas * way.u);
  };
  if (is_nothing(path) && is_nothing(turned)) {
    state.label = core::MotionState::kStick;
    state.reason += "; it stays where it touched down";
    return;
  }
  state.label = is_nothing(slipped)  ? core::MotionState::kRoll
                : is_nothing(turned) ? core::MotionState::kSlide
                                     : core::MotionState::kRollSlide;
  state.reason += fmt::format(
      "; it moves by {:.2f} px along the ground and its contact point slips by "
      "{:.2f} +- {:.2f} px",
      path.value, slipped.value, slipped.u);
}

// Names what stays down as slide, roll-slide or stick, where that can be seen.
void NameWhatStaysDown(const RecordContext& context, std::size_t from,
                       core::StateDecision& state) {
  if (state.label != core::MotionState::kStaysDown) return;
  const PlaneTrack& track = context.track;
  const std::span<const PlaneSample> samples(track.samples);
  const PlaneSample& a = samples[from];
  const PlaneSample& b = samples.back();
  if (track.kind == core::BodyKind::kSphere) {
    if (ShowsTurn(track)) {
      NameBallThatStaysDown(context, a, b, state);
    } else {
      state.reason += "; without a mark slip and roll look alike";
    }
    return;
  }
  double path = 0.0;
  for (std::size_t i = from; i < samples.size(); ++i) {
    path = std::max(path, std::abs(samples[i].along_px - a.along_px));
  }
  const double turned = std::abs(b.face_rad - a.face_rad);
  const double u_turned = std::hypot(a.u_face_rad, b.u_face_rad);
  // rad: 45 deg. Beyond it another face comes down; a rocking block turns back
  // before. From geometry (a square's).
  constexpr double kTurnsOver_rad = 0.25 * std::numbers::pi;
  const double u_path = std::hypot(a.u_along_px, b.u_along_px);
  if (turned > kTurnsOver_rad && turned > kClearSigmas * u_turned) {
    state.label = core::MotionState::kRollSlide;
    state.reason += "; it turns over along the ground";
  } else if (path > std::max(kLeastWay_px, kClearSigmas * u_path)) {
    state.label = core::MotionState::kSlide;
    state.reason += "; it moves along the ground without turning over";
  } else {
    state.label = core::MotionState::kStick;
    state.reason += "; it stays where it touched down";
  }
}

}  // namespace

core::ContactRecord MakeRecord(const RecordContext& given, const Event& event,
                               std::vector<std::string>& warnings) {
  const PlaneTrack& track = given.track;
  const PlaneSample& near = track.samples[std::min(event.before_frames.end - 1,
                                                   track.samples.size() - 1)];
  const PixelLocking locking = EstimatePixelLocking(track, near.face_rad);
  RecordContext context = given;
  context.u_common_place_px =
      std::hypot(given.u_common_place_px, locking.place_px);
  context.u_common_face_rad =
      std::hypot(given.u_common_face_rad, locking.face_rad);
  core::ContactRecord record;
  core::Contact& contact = record.contact;
  contact.found = true;
  contact.time_s = event.time_s;
  // The frame number follows from the time: exact where frames are equally
  // spaced.
  const double dt = track.frame_interval_s;
  // px. A texture lies otherwise on the outline after the impact, and beside
  // another background. Larger widens u of the contact times of textured
  // bodies. 0.01: chosen on 40 photographed faces in raw clips, of which 30
  // contact times lay within 1.96 u without it.
  constexpr double kMostChange_px = 0.01;
  // px. What the model of an outline is off by (kModel_px in
  // follow_in_layers.cc) is another beside the ground than in the air. 0.001:
  // with it the likelihood of the errors of 118 raw clips of plain bodies is
  // greatest, of which 105 lay within 1.96 u without it (of 351 earlier ones,
  // of which 337 did, it is with 0.0002).
  constexpr double kModelChange_px = 0.001;
  // A codec that leaves out slow changes from frame to frame lags behind the
  // body: before an impact the body is seen above its place, after it below,
  // and the flights meet too late. Share of the common error of place. Chosen
  // on 79 clips in H.264 (crf 23), of which 61 of 76 lay within 1.96 u without
  // it; on 113 others 108 lie with it.
  constexpr double kLagShare = 0.5;
  const double pace = std::max(
      std::abs(event.fit->EstimateFunction(ApproachNormal).value), kMinPace_px);
  const double change_px =
      track.is_predicted
          ? kLagShare * given.u_common_place_px
          : std::hypot(kModelChange_px,
                       std::min(track.u_texture_px, kMostChange_px));
  // Edges beside the pixels' rows have another phase in each frame.
  contact.time_s->u = std::hypot(
      contact.time_s->u, std::hypot(change_px, locking.place_px) / pace * dt);
  contact.frame = Estimate{
      static_cast<double>(near.frame) + (event.time_s.value - near.time_s) / dt,
      contact.time_s->u / dt};
  FillAngles(context, event, contact);
  if (event.after) {
    contact.duration_s =
        Estimate{std::max(0.0, event.release_s.value - event.time_s.value),
                 std::hypot(event.time_s.u, event.release_s.u)};
  } else {
    contact.duration_s = AbsentBecause("no release from the ground was seen");
  }
  FillMotion(context, event, record);
  if (std::abs(event.disagreement) > kDisagree && !event.after) {
    warnings.push_back(
        fmt::format("the body comes to rest {:.2f} px {} the ground line",
                    std::abs(event.ground_px.value),
                    event.ground_px.value > 0 ? "above" : "below"));
  } else if (std::abs(event.disagreement) > kDisagree) {
    warnings.push_back(fmt::format(
        "touchdown lies {:.1f} standard deviations {} the ground line",
        std::abs(event.disagreement),
        event.disagreement > 0 ? "above" : "below"));
  }
  // Only what was filmed after touchdown speaks of a rebound.
  std::size_t from = event.before_frames.end;
  while (from < track.samples.size() &&
         track.samples[from].time_s <= event.time_s.value) {
    ++from;
  }
  const double along_px = event.before->At(event.time_s.value).along_px;
  FillState(context, from,
            {along_px, event.ground_px, track.ground.u_angle_rad}, &event,
            record.state);
  NameWhatStaysDown(context, from, record.state);
  return record;
}

namespace {

// Whether a body turns over while it is down: by more than its path and the
// ground line can be inclined to each other, and more than its attitude is
// known.
bool TurnsWhileDown(std::span<const PlaneSample> down) {
  // Standard deviations of one frame: the range of a hundred normal values is
  // about five, of a thousand six and a half. Fewer: noise is called a turn.
  constexpr double kRangeSigmas = 8.0;
  const auto [least, most] = std::minmax_element(
      down.begin(), down.end(), [](const PlaneSample& a, const PlaneSample& b) {
        return a.face_rad < b.face_rad;
      });
  return most->face_rad - least->face_rad >
         std::max(kMaxEdgeTilt_rad,
                  kRangeSigmas * std::max(least->u_face_rad, most->u_face_rad));
}

}  // namespace

core::ContactRecord RecordFromStart(const RecordContext& context,
                                    const Stretch& down, double slope_rad) {
  const PlaneTrack& track = context.track;
  const std::span<const PlaneSample> samples(track.samples);
  core::ContactRecord record;
  core::Contact& contact = record.contact;
  contact.found = true;
  contact.from_start = true;
  const char reason[] = "on the ground from the start";
  MakeAbsent({&contact.time_s, &contact.frame, &contact.duration_s}, reason);
  // It does not approach; that its path and the visible line are inclined to
  // each other is all that could be taken for it.
  const double u_angle = std::hypot(track.ground.u_angle_rad, slope_rad);
  contact.approach_angle_rad = Estimate{0.0, u_angle};
  contact.approach_budget = {{"ground", track.ground.u_angle_rad},
                             {"path", std::abs(slope_rad)}};

  core::Motion& m = record.motion;
  m = core::Motion{};
  MakeAbsent(
      {&m.before_normal_mps, &m.before_omega_rad_per_s, &m.after_normal_mps,
       &m.after_tangential_mps, &m.after_omega_rad_per_s, &m.restitution,
       &m.centre_rebound_ratio, &m.impulse_ratio, &m.gravity_check_mps2},
      reason);
  // Frames that give the first velocity: more average its noise, but the body
  // slows down meanwhile. Not studied.
  constexpr std::size_t kStartFrames = 12;
  const std::size_t n = std::min<std::size_t>(samples.size(), kStartFrames);
  const Flight start = FitFlight(samples.first(n), context.flight);
  const Estimate vt{start.along[1], std::sqrt(start.along_cov(1, 1))};
  m.before_tangential_mps = InMetres(context, vt);
  m.before_speed_mps = InMetres(context, vt);
  if (track.kind == core::BodyKind::kRectangle &&
      TurnsWhileDown(SelectSamples(track, down))) {
    // What changes while it is down was another at its touchdown.
    const char turns[] =
        "on the ground from the start, where it turns: its touchdown was not "
        "filmed";
    MakeAbsent({&contact.approach_angle_rad, &contact.radius_angle_rad,
                &contact.face_angle_rad, &m.before_speed_mps,
                &m.before_tangential_mps},
               turns);
    contact.approach_budget.clear();
  } else if (track.kind == core::BodyKind::kSphere) {
    contact.radius_angle_rad = AbsentBecause("sphere: 90 degrees always");
    contact.face_angle_rad = AbsentBecause("sphere");
  } else {
    const PlaneSample& s = samples.front();
    const double u_face = start.At(s.time_s).u_face_rad;
    const Estimate face{s.face_rad,
                        std::hypot(u_face, track.ground.u_angle_rad)};
    // rad: a block that lies on a face from the start is flush, although the
    // ground line may be inclined to it. Larger hides a tilt. Not studied.
    constexpr double kResolution_rad = 0.05;
    FillAttitude(track, face, kResolution_rad, contact);
    contact.attitude_budget = {{"localisation", u_face},
                               {"ground", track.ground.u_angle_rad}};
    contact.radius_angle_rad =
        Estimate{std::atan2(SupportHeight(track, face.value),
                            std::abs(LowestPointOffset(track, face.value))),
                 std::hypot(face.u, CornerTurnByGamma(track))};
  }
  // Its own path is the line: its direction has no u of its own here.
  FillState(context, 0,
            {samples.front().along_px,
             MeanRestingGap(SelectSamples(track, down)), 0.0},
            nullptr, record.state);
  record.state.reason = "on the ground from the start; " + record.state.reason;
  NameWhatStaysDown(context, 0, record.state);
  return record;
}

}  // namespace touchdown::vision
