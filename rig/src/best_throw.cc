// The throw that the rig can do and that is to be preferred, or the reason why
// there is none.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "angles.h"
#include "infinity.h"
#include "throw_search.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/launch.h"
#include "touchdown/rig/predict.h"
#include "touchdown/rig/turning_flight.h"

namespace touchdown::rig {
namespace {

using core::AbsentBecause;
using core::AngleKind;
using core::Expected;

constexpr double kLengthSlack_m = 1e-9;      // rounding at limits of length
constexpr double kSlowestLaunch_mps = 1e-6;  // slower is a drop from rest
// How many standard uncertainties of its height a muzzle keeps the body off
// the ground where it can: nearer, some shots begin in it.
constexpr double kClearance_u = 3.0;
// How far the played throw may miss the wish: 1e-7 rad and 1e-7 of the speed,
// a hundredth of the last digit that a plan prints. What misses by more does
// not end in this contact (it touches earlier).
constexpr double kMiss = 1e-7;

double Mm(double m) { return m / core::kMillimetre; }

Landing ComputeLanding(const Description& rig, double face_rad) {
  return Land(rig.body->long_m->value, rig.body->short_m->value,
              std::remainder(face_rad, 2.0 * kQuarterTurn));
}

bool Bears(const Description& rig, double compression_m) {
  return Allowed(CheckCompression(rig, compression_m));
}

// The greatest compression that the springs and the trigger allow; each check
// is one of the compression's size, so that one bisection finds it.
double GreatestCompression(const Description& rig) {
  // m: springs that bear so much compression have no limit that a rig would
  // meet.
  constexpr double kUnlimited_m = 10.0;
  if (Bears(rig, kUnlimited_m)) return kInf;
  double good = 0.0;
  double bad = kUnlimited_m;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (good + bad);
    (Bears(rig, middle) ? good : bad) = middle;
  }
  return good;
}

class Choice {
 public:
  Choice(const SearchInput& input, std::vector<Candidate> candidates)
      : input_(input), candidates_(std::move(candidates)) {}

  Expected<Setting> Best() const;

 private:
  bool HeightIsRight(const Candidate& c) const;
  bool HeightIsInRange(const Candidate& c) const;
  bool ElevationIsInRange(const Candidate& c) const;
  bool CornerIsRight(const Candidate& c) const;
  bool SpringsCan(const Candidate& c) const;
  std::string SpringsReason(const Candidate& c) const;
  std::string Way(const Candidate& c) const;  // empty: free
  Setting MakeSetting(const Candidate& c) const;
  std::string HeightReason() const;

  const SearchInput& input_;
  std::vector<Candidate> candidates_;
};

bool Choice::HeightIsRight(const Candidate& c) const {
  return c.slack[kLowest] >= -kLengthSlack_m &&
         c.slack[kHighest] >= -kLengthSlack_m;
}

bool Choice::HeightIsInRange(const Candidate& c) const {
  return c.t.muzzle_height_m >=
             input_.rig.muzzle_height_min_m - kLengthSlack_m &&
         c.t.muzzle_height_m <= input_.rig.muzzle_height_max_m + kLengthSlack_m;
}

bool Choice::ElevationIsInRange(const Candidate& c) const {
  return c.slack[kFlattest] >= -kAngleSlack_rad &&
         c.slack[kSteepest] >= -kAngleSlack_rad;
}

bool Choice::CornerIsRight(const Candidate& c) const {
  return !input_.wish.corner ||
         ComputeLanding(input_.rig, c.t.face_rad).corner == *input_.wish.corner;
}

bool Choice::SpringsCan(const Candidate& c) const {
  // At the limit itself rounding decides; the limit is allowed.
  constexpr double kRounding = 1e-12;
  if (!(c.t.launch_speed_mps >= kSlowestLaunch_mps)) return false;
  const double compression = RequiredCompression(input_.rig, c.t);
  return compression <= input_.greatest_m * (1.0 + kRounding) &&
         LaunchSpeed(MakeLaunch(input_.rig, c.t.elevation_rad),
                     std::fmin(compression, input_.greatest_m));
}

std::string Choice::SpringsReason(const Candidate& c) const {
  const double compression = RequiredCompression(input_.rig, c.t);
  for (const Finding& f : CheckCompression(input_.rig, compression)) {
    if (f.severity != Severity::kRefusal) continue;
    return fmt::format("a launch at {:.3g} m/s: {}", c.t.launch_speed_mps,
                       f.what);
  }
  return "a launch at rest: the body does not leave the muzzle";
}

std::string Choice::Way(const Candidate& c) const {
  if (c.slack[kClear] < -kLengthSlack_m) {
    return fmt::format(
        "within the rig's range every throw that ends so begins with a corner "
        "at least {:.3g} mm in the ground",
        -Mm(c.slack[kClear]));
  }
  if (!ThrowsRectangle(input_.rig)) return "";
  const auto flown = FlyTurning(
      {.long_m = input_.rig.body->long_m->value,
       .short_m = input_.rig.body->short_m->value,
       .speed_mps = c.t.launch_speed_mps,
       .elevation_rad = c.t.elevation_rad,
       .height_m = c.t.muzzle_height_m,
       .face_rad = c.t.elevation_rad + input_.rig.seat_angle_rad.value,
       .spin_rad_per_s = input_.rig.spin_rad_per_s.value,
       .gravity_mps2 = input_.rig.gravity_mps2.value});
  if (!flown) {
    return "within the rig's range no throw ends so: " + flown.error().reason;
  }
  if (std::abs(flown->face_rad - c.t.face_rad) > kMiss ||
      std::abs(flown->flight.impact_speed_mps - input_.wish.speed_mps) >
          kMiss * input_.wish.speed_mps) {
    return fmt::format(
        "within the rig's range every throw that would end so touches the "
        "ground before, the nearest {:.3g} ms",
        (c.t.time_s - flown->flight.time_s) * 1e3);
  }
  return "";
}

Setting Choice::MakeSetting(const Candidate& c) const {
  Setting out;
  out.elevation_rad =
      std::clamp(c.t.elevation_rad, -kQuarterTurn, kQuarterTurn);
  out.muzzle_height_m =
      input_.wish.muzzle_height_m
          ? *input_.wish.muzzle_height_m
          : std::clamp(c.t.muzzle_height_m, input_.rig.muzzle_height_min_m,
                       input_.rig.muzzle_height_max_m);
  out.compression_m =
      std::fmin(RequiredCompression(input_.rig, c.t), input_.greatest_m);
  return out;
}

std::string Choice::HeightReason() const {
  const auto less = [](const Candidate& a, const Candidate& b) {
    return a.t.muzzle_height_m < b.t.muzzle_height_m;
  };
  const auto [lowest, highest] =
      std::minmax_element(candidates_.begin(), candidates_.end(), less);
  const double wanted =
      input_.wish.muzzle_height_m.value_or(input_.rig.muzzle_height_min_m);
  const double ceiling =
      input_.wish.muzzle_height_m.value_or(input_.rig.muzzle_height_max_m);
  if (highest->t.muzzle_height_m < wanted) {
    const double drop = wanted - highest->t.centre_height_m;
    const double fall =
        std::sqrt(std::fmax(0.0, 2.0 * input_.rig.gravity_mps2.value * drop));
    if (fall >= input_.wish.speed_mps) {
      return fmt::format(
          "the fall of {:.1f} mm alone gives {:.3g} m/s, the wanted speed is "
          "{:.3g}: lower the muzzle",
          Mm(drop), fall, input_.wish.speed_mps);
    }
    if (input_.wish.kind == AngleKind::kApproach) {
      return fmt::format(
          "the fall of {:.1f} mm alone makes the approach at least {:.2f} deg "
          "at {:.3g} m/s: lower the muzzle to {:.1f} mm or raise the speed",
          Mm(drop), Deg(std::asin(fall / input_.wish.speed_mps)),
          input_.wish.speed_mps, Mm(highest->t.muzzle_height_m));
    }
    return fmt::format(
        "needs a muzzle height of at most {:.1f} mm, not {:.1f}: lower the "
        "muzzle or raise the speed",
        Mm(highest->t.muzzle_height_m), Mm(wanted));
  }
  if (input_.wish.muzzle_height_m && ceiling < lowest->t.centre_height_m) {
    return fmt::format(
        "the muzzle at {:.1f} mm is below the body's centre at touchdown, "
        "{:.1f} mm",
        Mm(ceiling), Mm(lowest->t.centre_height_m));
  }
  return fmt::format("needs a muzzle height of at least {:.1f} mm, not {:.1f}",
                     Mm(lowest->t.muzzle_height_m), Mm(ceiling));
}

Expected<Setting> Choice::Best() const {
  if (candidates_.empty()) {
    return AbsentBecause("no flight ends in this attitude");
  }
  std::vector<const Candidate*> left;
  for (const Candidate& c : candidates_) {
    if (HeightIsRight(c)) left.push_back(&c);
  }
  if (left.empty()) return AbsentBecause(HeightReason());
  if (!HeightIsInRange(*left.front())) {  // a held one: all are alike
    return AbsentBecause(fmt::format(
        "needs a muzzle height of {:.1f} mm, the rig's is {:g} .. {:g} mm",
        Mm(left.front()->t.muzzle_height_m), Mm(input_.rig.muzzle_height_min_m),
        Mm(input_.rig.muzzle_height_max_m)));
  }
  // Of those that are left the ones that pass; where none does, the one that
  // misses least gives the reason.
  const auto keep = [&](const auto& passes, const auto& miss) {
    std::vector<const Candidate*> passed;
    for (const Candidate* c : left) {
      if (passes(*c)) passed.push_back(c);
    }
    const Candidate* nearest = *std::min_element(
        left.begin(), left.end(), [&](const Candidate* a, const Candidate* b) {
          return miss(*a) < miss(*b);
        });
    left = std::move(passed);
    return nearest;
  };
  const Candidate* nearest =
      keep([&](const Candidate& c) { return ElevationIsInRange(c); },
           [](const Candidate& c) {
             return -std::fmin(c.slack[kFlattest], c.slack[kSteepest]);
           });
  if (left.empty()) {
    return AbsentBecause(fmt::format(
        "needs an elevation of {:.2f} deg, the rig's is {:g} .. {:g} deg",
        Deg(nearest->t.elevation_rad), Deg(input_.rig.elevation_min_rad),
        Deg(input_.rig.elevation_max_rad)));
  }
  nearest = keep([&](const Candidate& c) { return CornerIsRight(c); },
                 [](const Candidate& c) { return c.t.time_s; });
  if (left.empty()) {
    const auto corner = ComputeLanding(input_.rig, nearest->t.face_rad).corner;
    return AbsentBecause(fmt::format(
        "at an elevation of {:.2f} deg the {} lands first, not the {} corner",
        Deg(nearest->t.elevation_rad),
        corner ? std::string(core::Name(*corner)) + " corner" : "middle",
        core::Name(*input_.wish.corner)));
  }
  nearest = keep([&](const Candidate& c) { return SpringsCan(c); },
                 [](const Candidate& c) { return -c.slack[kTravel]; });
  if (left.empty()) return AbsentBecause(SpringsReason(*nearest));
  std::stable_sort(left.begin(), left.end(),
                   [](const Candidate* a, const Candidate* b) {
                     return std::pair(a->first_key, a->second_key) !=
                                    std::pair(b->first_key, b->second_key)
                                ? std::pair(a->first_key, a->second_key) <
                                      std::pair(b->first_key, b->second_key)
                                : a->t.time_s < b->t.time_s;
                   });
  for (const Candidate* c : left) {
    if (Way(*c).empty()) return MakeSetting(*c);
  }
  nearest = *std::max_element(left.begin(), left.end(),
                              [](const Candidate* a, const Candidate* b) {
                                return a->slack[kClear] < b->slack[kClear];
                              });
  return AbsentBecause(Way(*nearest));
}

}  // namespace

Expected<Setting> BestThrow(const Description& rig, const ContactWish& wish,
                            const std::vector<ThrowFamily>& families) {
  const double greatest_m = GreatestCompression(rig);
  const SearchInput careful{rig, wish, greatest_m,
                            kClearance_u * rig.u_muzzle_height_m};
  const auto clear = Choice(careful, FindCandidates(careful, families)).Best();
  if (clear || rig.u_muzzle_height_m == 0.0) return clear;
  const SearchInput any{rig, wish, greatest_m, 0.0};
  return Choice(any, FindCandidates(any, families)).Best();
}

}  // namespace touchdown::rig
