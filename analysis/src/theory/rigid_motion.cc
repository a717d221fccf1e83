#include "touchdown/analysis/theory/rigid_motion.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "theory/rigid_outline.h"
#include "touchdown/analysis/theory/impact.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

constexpr double kPi = std::numbers::pi;  // under a short name

// Contacts slower than this many rest speeds are hops: not listed as events.
constexpr double kHopSpeeds = 5.0;
// Near flush, within so many hops' speed and height, a rectangle is laid down.
constexpr double kFlushSpeeds = 10.0;
// Corners that reach the ground within this height of each other (about the
// rounding of a metre) and at the same speed strike it together.
constexpr double kTogether_m = 1e-12;

class Simulator {
 public:
  explicit Simulator(const RigidMotionProblem& problem)
      : p_(problem), outline_(problem.body), state_(problem.start) {
    motion_.body = problem.body;
    motion_.end_s = problem.end_s;
    motion_.gyration_radius_m = problem.gyration_radius_m > 0.0
                                    ? problem.gyration_radius_m
                                    : outline_.GyrationRadius();
    hop_height_m_ =
        0.5 * p_.rest_speed_mps * p_.rest_speed_mps / p_.gravity_mps2;
  }

  RigidMotion Run() {
    bool on_ground = outline_.Gap(state_) <= kTogether_m;
    for (;;) {
      if (on_ground && !Strike()) break;
      if (motion_.stretches.size() >= p_.max_stretches) {
        motion_.complete = false;
        break;
      }
      const bool lands = Fly();
      if (!lands) break;
      on_ground = true;
    }
    return std::move(motion_);
  }

 private:
  // Free flight to the next contact. False if it lasts until the end.
  bool Fly() {
    const Stretch flight{StretchKind::kFlight, state_, 0.0, -p_.gravity_mps2,
                         0.0};
    motion_.stretches.push_back(flight);
    const double limit = p_.end_s - state_.time_s;
    const double tau = outline_.TimeToContact(state_, p_.gravity_mps2, limit);
    if (!(tau <= limit)) return false;
    // Where two corners graze at no speed, time must still pass.
    const double least = 1e-4 * p_.rest_speed_mps / p_.gravity_mps2;
    state_ = Advance(flight, state_.time_s + std::max(tau, least));
    return true;
  }

  // What the ground does to a body that touches it. False if the motion is
  // known to the end.
  bool Strike() {
    return outline_.is_sphere() ? StrikeSphere() : StrikeRectangle();
  }

  bool StrikeSphere() {
    const core::PlanePoint offset{0.0, -outline_.radius_m()};
    if (state_.vy_mps >= p_.rest_speed_mps) return true;  // leaves at once
    const double incoming = std::max(0.0, -state_.vy_mps);
    const bool stays = p_.restitution * incoming <= p_.rest_speed_mps;
    if (incoming > 0.0) Collide(offset, stays ? 0.0 : p_.restitution);
    if (!stays) return true;
    state_.vy_mps = 0.0;
    state_.centre.y_m = outline_.radius_m();
    Settle(offset);
    const double r = outline_.radius_m();
    const double k = motion_.gyration_radius_m;
    const double slip = state_.vx_mps + state_.omega_rad_per_s * r;
    const double a = -std::copysign(p_.mu * p_.gravity_mps2, slip);
    // Rounding after an impact that stuck is no slip.
    const double rounding = 1e-14 * (std::abs(state_.vx_mps) +
                                     std::abs(state_.omega_rad_per_s) * r);
    if (std::abs(slip) > rounding) {
      if (!Slide(a, a * r / (k * k), slip, a * (1.0 + r * r / (k * k)))) {
        return false;
      }
    }
    state_.omega_rad_per_s = -state_.vx_mps / r;
    const bool moves = std::abs(state_.vx_mps) > 0.0;
    Event(EventKind::kRolls, state_, offset);
    Stay(moves ? StretchKind::kRoll : StretchKind::kRest);
    return false;
  }

  bool StrikeRectangle() {
    // Two corners may answer to each other several times at one instant; past
    // this many answers the rest is left to the next hop.
    constexpr int kMaxAnswers = 100;
    for (int answer = 0; answer < kMaxAnswers; ++answer) {
      std::array<CornerState, 4> low = outline_.Corners(state_);
      std::sort(low.begin(), low.end(),
                [](const auto& a, const auto& b) { return a.y_m < b.y_m; });
      // What the root finder left, some 1e-17 m, must not add up.
      state_.centre.y_m -= low[0].y_m;
      const double rise = low[1].y_m - low[0].y_m;
      const double v0 = low[0].vy_mps;
      const double v1 = low[1].vy_mps;
      const double slow = kFlushSpeeds * p_.rest_speed_mps;
      const bool nearly_at_rest =
          rise <= kFlushSpeeds * kFlushSpeeds * hop_height_m_ &&
          std::abs(v0) <= slow && std::abs(v1) <= slow;
      const bool together = rise <= kTogether_m &&
                            std::abs(v0 - v1) <= p_.rest_speed_mps && v0 < 0.0;
      if (nearly_at_rest || together) {
        if (const auto flies = StrikeFlush(low, nearly_at_rest)) return *flies;
      }
      const CornerState* struck = nullptr;
      for (const CornerState& corner : low) {
        if (corner.y_m > low[0].y_m + kTogether_m) break;
        if (corner.vy_mps < 0.0 &&
            (struck == nullptr || corner.vy_mps < struck->vy_mps)) {
          struck = &corner;
        }
      }
      if (struck == nullptr) break;
      // Rebounds that restitution makes slower than the rest speed are hops.
      Collide(struck->offset,
              std::max(p_.restitution,
                       std::min(1.0, p_.rest_speed_mps / -struck->vy_mps)));
      Lift(struck->offset);
    }
    return true;
  }

  // Both corners at once: does it fly on? Nothing if the friction would tip the
  // body over its front edge: then one corner alone is struck, by the caller.
  std::optional<bool> StrikeFlush(const std::array<CornerState, 4>& low,
                                  bool nearly_at_rest) {
    const double turn = std::round(state_.angle_rad / (0.5 * kPi));
    const bool on_long = std::abs(std::remainder(turn, 2.0)) < 0.5;
    const double half_side =
        on_long ? outline_.half_long_m() : outline_.half_short_m();
    const double half_height =
        on_long ? outline_.half_short_m() : outline_.half_long_m();
    const double vy = std::min(0.0, state_.vy_mps);
    const bool stays =
        nearly_at_rest || -p_.restitution * vy <= p_.rest_speed_mps;
    const double normal = stays ? -vy : -(1.0 + p_.restitution) * vy;
    const double friction = -std::copysign(
        std::min(p_.mu * normal, std::abs(state_.vx_mps)), state_.vx_mps);
    const bool tips = std::abs(friction) * half_height > normal * half_side;
    const bool slides_on = std::abs(state_.vx_mps) > std::abs(friction);
    if (!stays ? tips : slides_on && p_.mu * half_height > half_side) {
      return std::nullopt;
    }
    const core::PlanePoint middle{0.5 * (low[0].offset.x_m + low[1].offset.x_m),
                                  -half_height};
    const BodyState before = state_;
    state_.angle_rad = turn * 0.5 * kPi;
    state_.centre.y_m = half_height;
    state_.omega_rad_per_s = 0.0;
    state_.vx_mps += friction;
    state_.vy_mps = stays ? 0.0 : vy + normal;
    if (-vy > kHopSpeeds * p_.rest_speed_mps) {
      Event(EventKind::kFlushImpact, before, middle);
    }
    if (!stays) return true;
    Settle(middle);
    const double a = -std::copysign(p_.mu * p_.gravity_mps2, state_.vx_mps);
    if (state_.vx_mps != 0.0 && !Slide(a, 0.0, state_.vx_mps, a)) {
      return false;
    }
    state_.vx_mps = 0.0;
    Event(EventKind::kRests, state_, middle);
    Stay(StretchKind::kRest);
    return false;
  }

  // Impact of one point.
  void Collide(core::PlanePoint offset, double restitution) {
    const BodyState before = state_;
    const BodyImpactResult result = ImpactOfBody(
        {offset.x_m, offset.y_m, motion_.gyration_radius_m, p_.mu, restitution,
         state_.vx_mps, state_.vy_mps, state_.omega_rad_per_s});
    state_.vx_mps = result.velocity_x_mps;
    state_.vy_mps = result.velocity_y_mps;
    state_.omega_rad_per_s = result.omega_rad_per_s;
    const double incoming =
        -(before.vy_mps + before.omega_rad_per_s * offset.x_m);
    if (motion_.events.empty() || incoming > kHopSpeeds * p_.rest_speed_mps) {
      Event(EventKind::kImpact, before, offset);
    }
  }

  // Raises the rebound of a corner to the rest speed, lest hops dwindle and
  // time stand still: by a normal impulse, which brings in at most rest_speed^2
  // / 2 of energy (per mass) and little of it, since a hop lands as fast as it
  // left.
  void Lift(core::PlanePoint offset) {
    const double rebound = state_.vy_mps + state_.omega_rad_per_s * offset.x_m;
    const double k = motion_.gyration_radius_m;
    const double arm = offset.x_m / k;
    if (rebound >= p_.rest_speed_mps) return;
    const double impulse = (p_.rest_speed_mps - rebound) / (1.0 + arm * arm);
    state_.vy_mps += impulse;
    state_.omega_rad_per_s += impulse * arm / k;
  }

  void Settle(core::PlanePoint offset) {
    Event(EventKind::kSettles, state_, offset);
  }

  // Slides until `slip`, changing by `slip_rate`, is 0. False if it does so to
  // the end.
  bool Slide(double ax, double angular, double slip, double slip_rate) {
    const Stretch slide{StretchKind::kSlide, state_, ax, 0.0, angular};
    motion_.stretches.push_back(slide);
    const double lasts = slip_rate == 0.0
                             ? std::numeric_limits<double>::infinity()
                             : -slip / slip_rate;
    if (!(state_.time_s + lasts < p_.end_s)) return false;
    state_ = Advance(slide, state_.time_s + lasts);
    return true;
  }

  void Stay(StretchKind kind) {
    motion_.stretches.push_back({kind, state_, 0.0, 0.0, 0.0});
  }

  void Event(EventKind kind, const BodyState& before, core::PlanePoint offset) {
    MotionEvent event;
    event.kind = kind;
    event.before = before;
    event.after = state_;
    event.offset_x_m = offset.x_m;
    event.offset_y_m = offset.y_m;
    event.contact_vx_before_mps =
        before.vx_mps - before.omega_rad_per_s * offset.y_m;
    event.contact_vy_before_mps =
        before.vy_mps + before.omega_rad_per_s * offset.x_m;
    event.contact_vx_after_mps =
        state_.vx_mps - state_.omega_rad_per_s * offset.y_m;
    event.contact_vy_after_mps =
        state_.vy_mps + state_.omega_rad_per_s * offset.x_m;
    motion_.events.push_back(event);
  }

  const RigidMotionProblem& p_;
  RigidOutline outline_;
  BodyState state_;
  double hop_height_m_ = 0.0;
  RigidMotion motion_;
};

void CheckRigidMotionProblem(const RigidMotionProblem& p) {
  const RigidOutline outline(p.body);  // refuses an absent size
  core::RequireNotNegative("gyration radius", p.gyration_radius_m, "m");
  core::RequireNotNegative("mu", p.mu);
  core::RequireInRange("restitution", p.restitution, 0.0, 1.0);
  core::RequirePositive("gravity", p.gravity_mps2, "m/s^2");
  core::RequirePositive("rest speed", p.rest_speed_mps, "m/s");
  core::RequireFinite("start time", p.start.time_s, "s");
  core::RequireFinite("start centre x", p.start.centre.x_m, "m");
  core::RequireFinite("start centre y", p.start.centre.y_m, "m");
  core::RequireFinite("start angle", p.start.angle_rad, "rad");
  core::RequireFinite("start velocity x", p.start.vx_mps, "m/s");
  core::RequireFinite("start velocity y", p.start.vy_mps, "m/s");
  core::RequireFinite("start spin", p.start.omega_rad_per_s, "rad/s");
  if (!(p.end_s > p.start.time_s) || !std::isfinite(p.end_s)) {
    core::Refuse("end time", p.end_s, "after the start and finite", "s");
  }
  const double gap = outline.Gap(p.start);
  if (gap < -kTogether_m) {
    core::Refuse("start gap", gap, "at least 0: the body begins in the ground",
                 "m");
  }
}

const Stretch& FindStretch(const RigidMotion& motion, double time_s) {
  const auto after = std::upper_bound(
      motion.stretches.begin(), motion.stretches.end(), time_s,
      [](double t, const Stretch& s) { return t < s.start.time_s; });
  return after == motion.stretches.begin() ? *after : *(after - 1);
}

}  // namespace

RigidMotion SimulateRigidMotion(const RigidMotionProblem& problem) {
  CheckRigidMotionProblem(problem);
  return Simulator(problem).Run();
}

BodyState ComputeState(const RigidMotion& motion, double time_s) {
  return Advance(FindStretch(motion, time_s), time_s);
}

double ComputeGap(const RigidMotion& motion, double time_s) {
  return RigidOutline(motion.body).Gap(ComputeState(motion, time_s));
}

GreatestGap ComputeGreatestGap(const RigidMotion& motion, double from_s,
                               double to_s) {
  if (!(to_s >= from_s)) {
    throw std::invalid_argument(fmt::format(
        "interval of the greatest gap ends at {} s, before it begins ({} s)",
        to_s, from_s));
  }
  const RigidOutline outline(motion.body);
  GreatestGap best{ComputeGap(motion, from_s), from_s};
  const auto consider = [&](const Stretch& s, double t) {
    const double gap = outline.Gap(Advance(s, t));
    if (gap > best.gap_m) best = {gap, t};
    return gap;
  };
  const auto& all = motion.stretches;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Stretch& s = all[i];
    const double begin = i == 0 ? from_s : std::max(from_s, s.start.time_s);
    const double end =
        i + 1 < all.size() ? std::min(to_s, all[i + 1].start.time_s) : to_s;
    if (!(end >= begin)) continue;
    // The lower envelope of four corners' heights: sampled at least 24 times a
    // turn, then refined around the best sample.
    const int n =
        4 + static_cast<int>(std::min(
                1e5, std::abs(s.start.omega_rad_per_s) * (end - begin) * 4.0));
    int top = 0;
    double top_gap = -std::numeric_limits<double>::infinity();
    const double step = (end - begin) / n;
    for (int k = 0; k <= n; ++k) {
      const double gap = consider(s, begin + k * step);
      if (gap > top_gap) {
        top_gap = gap;
        top = k;
      }
    }
    double low = begin + std::max(0, top - 1) * step;
    double high = begin + std::min(n, top + 1) * step;
    // Golden-section search: (sqrt(5) - 1) / 2.
    constexpr double kGolden = 0.6180339887498949;
    while (high - low > 1e-9) {
      const double a = high - kGolden * (high - low);
      const double b = low + kGolden * (high - low);
      if (consider(s, a) < consider(s, b)) {
        low = a;
      } else {
        high = b;
      }
    }
  }
  return best;
}

std::optional<TouchdownTruth> FirstTouchdown(const RigidMotion& motion) {
  if (motion.events.empty()) return std::nullopt;
  const MotionEvent& event = motion.events.front();
  TouchdownTruth truth;
  truth.time_s = event.before.time_s;
  truth.from_start = event.kind == EventKind::kSettles &&
                     truth.time_s <= motion.stretches.front().start.time_s;
  truth.before = event.before;
  truth.after = event.after;
  truth.approach_angle_rad = std::atan2(std::max(0.0, -event.before.vy_mps),
                                        std::abs(event.before.vx_mps));
  truth.contact_vx_before_mps = event.contact_vx_before_mps;
  truth.contact_vy_before_mps = event.contact_vy_before_mps;
  truth.contact_vx_after_mps = event.contact_vx_after_mps;
  truth.contact_vy_after_mps = event.contact_vy_after_mps;
  if (motion.body.kind != core::BodyKind::kRectangle) return truth;
  // The long side has no ends that differ: its angle is known modulo pi.
  double face = std::remainder(event.before.angle_rad, kPi);
  if (face <= -0.5 * kPi) face += kPi;
  truth.face_angle_rad = face;
  const bool flush = event.kind != EventKind::kImpact;
  if (flush) {
    truth.corner = core::Corner::kFlush;
    // Of either corner of the side that lies on the ground.
    const RigidOutline outline(motion.body);
    const double diagonal =
        std::hypot(outline.half_long_m(), outline.half_short_m());
    truth.radius_angle_rad =
        std::asin(std::min(1.0, -event.offset_y_m / diagonal));
  } else {
    truth.corner = event.offset_x_m > 0.0 ? core::Corner::kLeading
                                          : core::Corner::kTrailing;
    truth.radius_angle_rad =
        std::atan2(-event.offset_y_m, std::abs(event.offset_x_m));
  }
  return truth;
}

}  // namespace touchdown::analysis
