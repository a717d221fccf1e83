#include "throw_family.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "angles.h"
#include "touchdown/rig/predict.h"

namespace touchdown::rig {
namespace {

using core::AngleKind;

// Cells of a search over the time of flight: at least this many, and none in
// which the body turns by more than the angle. Finer cells find nothing more
// among 2000 random rigs (tests/rig/setpoints_test.cc), coarser ones miss
// throws between two turns.
constexpr int kLeastCells = 120;
constexpr double kTurnOfCell_rad = 0.05;

double LongestFlight(const Description& rig, double speed_mps) {
  // h >= 0 bounds it: V t - g t^2 / 2 >= -D.
  const double g = rig.gravity_mps2.value;
  const double reach =
      !rig.body ? 0.0
      : rig.body->kind == core::BodyKind::kSphere
          ? 0.5 * rig.body->diameter_m->value
          : 0.5 * std::hypot(rig.body->long_m->value, rig.body->short_m->value);
  return (speed_mps + std::sqrt(speed_mps * speed_mps + 2.0 * g * reach)) / g;
}

int CountCells(double spin_rad_per_s, double duration_s) {
  return kLeastCells + static_cast<int>(std::abs(spin_rad_per_s) * duration_s /
                                        kTurnOfCell_rad);
}

}  // namespace

std::optional<Throw> ComputeThrow(const Description& rig,
                                  const ThrowFamily& family, double time_s) {
  const double g = rig.gravity_mps2.value;
  const double seat = rig.seat_angle_rad.value;
  const double spin = rig.spin_rad_per_s.value;
  const double speed = family.speed_mps;
  Throw t;
  t.time_s = time_s;
  double down = 0.0;
  double along = 0.0;
  if (family.kind == AngleKind::kApproach) {
    down = speed * std::sin(family.angle_rad);
    along = std::fmax(0.0, speed * std::cos(family.angle_rad));
    double up = g * time_s - down;
    // A level shot, but for the rounding of the difference.
    if (std::abs(up) < 1e-9 * speed) up = 0.0;
    t.elevation_rad = std::atan2(up, along);
    t.face_rad = t.elevation_rad + seat + spin * time_s;
  } else {
    t.elevation_rad = family.angle_rad - seat - spin * time_s;
    t.face_rad = family.angle_rad;
    const double sine = g * time_s * std::cos(t.elevation_rad) / speed;
    if (!(std::abs(sine) <= 1.0)) return std::nullopt;
    const double sum =
        family.steep ? 2.0 * kQuarterTurn - std::asin(sine) : std::asin(sine);
    const double beta = sum - t.elevation_rad;
    // Rounding may put a flat approach below the ground by an ulp.
    if (!(beta >= -1e-12 && beta <= kQuarterTurn + 1e-12)) return std::nullopt;
    down = speed * std::fmax(0.0, std::sin(beta));
    along = std::fmax(0.0, speed * std::cos(beta));
  }
  if (std::abs(t.elevation_rad) > kQuarterTurn) return std::nullopt;
  t.centre_height_m = CentreHeightAtTouchdown(rig, t.face_rad);
  t.muzzle_height_m = t.centre_height_m + time_s * (down - 0.5 * g * time_s);
  t.launch_speed_mps = std::hypot(along, g * time_s - down);
  return t;
}

std::vector<ThrowFamily> ApproachFamilies(const Description& rig,
                                          const ContactWish& wish) {
  const double to = LongestFlight(rig, wish.speed_mps);
  const bool turns = rig.body && rig.body->kind == core::BodyKind::kRectangle;
  return {{AngleKind::kApproach, wish.angle_rad, false, wish.speed_mps, 0.0, to,
           CountCells(turns ? rig.spin_rad_per_s.value : 0.0, to)}};
}

std::vector<ThrowFamily> AttitudeFamilies(const Description& rig,
                                          const ContactWish& wish,
                                          double face_rad) {
  const double longest = LongestFlight(rig, wish.speed_mps);
  const double spin = rig.spin_rad_per_s.value;
  const double half_turn = 2.0 * kQuarterTurn;
  // Elevation theta = phi + k pi - seat - omega t within +-90 deg.
  const double offset = face_rad - rig.seat_angle_rad.value;
  const double ends[] = {0.0, spin * longest};
  const double least = std::min(ends[0], ends[1]) - kQuarterTurn - offset;
  const double most = std::max(ends[0], ends[1]) + kQuarterTurn - offset;
  std::vector<ThrowFamily> out;
  for (double k = std::ceil(least / half_turn - 1e-12);
       k <= std::floor(most / half_turn + 1e-12); k += 1.0) {
    const double angle = face_rad + k * half_turn;
    double from = 0.0;
    double to = longest;
    if (spin != 0.0) {
      const double one = (offset + k * half_turn - kQuarterTurn) / spin;
      const double other = (offset + k * half_turn + kQuarterTurn) / spin;
      from = std::max(from, std::min(one, other));
      to = std::min(to, std::max(one, other));
    }
    if (!(to > from)) continue;
    for (const bool steep : {false, true}) {
      out.push_back({AngleKind::kFace, angle, steep, wish.speed_mps, from, to,
                     CountCells(spin, to - from)});
    }
  }
  return out;
}

}  // namespace touchdown::rig
