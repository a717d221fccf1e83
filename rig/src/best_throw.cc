// The search of a family for a throw that the rig can do.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "throw_family.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/launch.h"
#include "touchdown/rig/predict.h"
#include "touchdown/rig/turning_flight.h"

namespace touchdown::rig {
namespace {

using core::AbsentBecause;
using core::AngleKind;
using core::Expected;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kQuarterTurn = std::numbers::pi / 2.0;
constexpr double kAngleSlack_rad = 1e-9;  // rounding at limits given in degrees
constexpr double kLengthSlack_m = 1e-9;
constexpr double kSlowestLaunch_mps = 1e-6;  // slower is a drop from rest
// How many standard uncertainties of its height a muzzle keeps the body off
// the ground where it can: nearer, some shots begin in it.
constexpr double kClearance_u = 3.0;
constexpr int kBisections = 60;
constexpr int kGoldenSteps = 40;
// How far the played throw may miss the wish: 1e-7 rad and 1e-7 of the speed,
// a hundredth of the last digit that a plan prints. What misses by more does
// not end in this contact (it touches earlier).
constexpr double kMiss = 1e-7;

double Deg(double rad) { return rad / core::kDegree; }
double Mm(double m) { return m / core::kMillimetre; }

bool IsRectangle(const Description& rig) {
  return rig.body && rig.body->kind == core::BodyKind::kRectangle;
}

Landing LandingAt(const Description& rig, double face_rad) {
  return Land(rig.body->long_m->value, rig.body->short_m->value,
              std::remainder(face_rad, 2.0 * kQuarterTurn));
}

bool Bears(const Description& rig, double compression_m) {
  return Allowed(CheckCompression(rig, compression_m));
}

// The greatest compression that the springs and the trigger allow; each check
// is one of the compression's size, so that one bisection finds it.
double GreatestCompression(const Description& rig) {
  constexpr double kLongest_m = 10.0;
  if (Bears(rig, kLongest_m)) return kInf;
  double good = 0.0;
  double bad = kLongest_m;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (good + bad);
    (Bears(rig, middle) ? good : bad) = middle;
  }
  return good;
}

double CompressionOf(const Description& rig, const Throw& t) {
  const double elevation =
      std::clamp(t.elevation_rad, -kQuarterTurn, kQuarterTurn);
  return CompressionFor(LaunchOf(rig, elevation), t.launch_speed_mps);
}

// What a throw must satisfy, in the order in which a reason is looked for.
// Each is a smooth number that is >= 0 where it is satisfied.
enum Limit : std::size_t {
  kLowest,
  kHighest,
  kFlattest,
  kSteepest,
  kCornerTurns,  // a change of its sign is a change of the corner
  kTravel,
  kClear,
  kLimits
};
using Slacks = std::array<double, kLimits>;

class Search {
 public:
  Search(const Description& rig, const ContactWish& wish, double greatest_m,
         double clearance_m)
      : rig_(rig),
        wish_(wish),
        clearance_m_(clearance_m),
        greatest_m_(greatest_m) {}

  // Visits every family, the instants at which a limit is met among them.
  void Run(const std::vector<ThrowFamily>& families) {
    for (const ThrowFamily& family : families) Visit(family);
  }

  Expected<Setting> Best();

 private:
  struct Candidate {
    const ThrowFamily* family = nullptr;
    Throw t;
    Slacks slack{};
    double first_key = 0.0;
    double second_key = 0.0;
  };

  Slacks SlacksOf(const Throw& t) const;
  std::optional<Slacks> SlacksAt(const ThrowFamily& family,
                                 double time_s) const;
  void Visit(const ThrowFamily& family);
  void Root(const ThrowFamily& family, std::size_t limit, double from,
            double to);
  void Extremum(const ThrowFamily& family, std::size_t limit, double from,
                double to);
  void Add(const ThrowFamily& family, double time_s);
  Candidate CandidateAt(const ThrowFamily& family, const Throw& t) const;
  bool HeightIsRight(const Candidate& c) const;
  bool HeightIsInRange(const Candidate& c) const;
  bool ElevationIsInRange(const Candidate& c) const;
  bool CornerIsRight(const Candidate& c) const;
  bool SpringsCan(const Candidate& c) const;
  std::string SpringsReason(const Candidate& c) const;
  std::string Way(const Candidate& c) const;  // empty: free
  Expected<Setting> Nudged(Candidate c) const;
  std::string HeightReason() const;
  double SpareHeight(const Throw& t) const;

  const Description& rig_;
  const ContactWish& wish_;
  double clearance_m_;
  double greatest_m_;
  std::vector<Candidate> candidates_;
};

// How much higher than its start the body could begin: of its lowest corner.
double Search::SpareHeight(const Throw& t) const {
  const double face = t.elevation_rad + rig_.seat_angle_rad.value;
  return t.muzzle_height_m - CentreHeightAtTouchdown(rig_, face);
}

Slacks Search::SlacksOf(const Throw& t) const {
  Slacks s{};
  if (wish_.muzzle_height_m) {
    // Equality: its sign changes, and both are met there.
    s[kLowest] = t.muzzle_height_m - *wish_.muzzle_height_m;
    s[kHighest] = -s[kLowest];
  } else {
    s[kLowest] = t.muzzle_height_m - rig_.muzzle_height_min_m;
    s[kHighest] = rig_.muzzle_height_max_m - t.muzzle_height_m;
  }
  s[kFlattest] = t.elevation_rad - rig_.elevation_min_rad;
  s[kSteepest] = rig_.elevation_max_rad - t.elevation_rad;
  if (IsRectangle(rig_) && wish_.corner) {
    const double c = std::cos(t.face_rad);
    const double n = std::sin(t.face_rad);
    s[kCornerTurns] = c * n *
                      (rig_.body->long_m->value * std::abs(c) -
                       rig_.body->short_m->value * std::abs(n));
  }
  s[kTravel] = greatest_m_ == kInf ? 1.0 : greatest_m_ - CompressionOf(rig_, t);
  s[kClear] = SpareHeight(t) - clearance_m_;
  return s;
}

std::optional<Slacks> Search::SlacksAt(const ThrowFamily& family,
                                       double time_s) const {
  const auto t = ThrowAt(rig_, family, time_s);
  if (!t) return std::nullopt;
  return SlacksOf(*t);
}

Search::Candidate Search::CandidateAt(const ThrowFamily& family,
                                      const Throw& t) const {
  Candidate c;
  c.family = &family;
  c.t = t;
  c.slack = SlacksOf(t);
  // The level shot, where the elevation drops out to first order, then the
  // slower launch; attitudes: the shortest flight.
  constexpr double kSame = 1e-7;  // rad and m/s: alike to every digit printed
  if (family.kind == AngleKind::kApproach) {
    c.first_key = std::round(std::abs(t.elevation_rad) / kSame);
    c.second_key = std::round(t.launch_speed_mps / kSame);
  } else {
    c.first_key = t.time_s;
  }
  return c;
}

void Search::Add(const ThrowFamily& family, double time_s) {
  if (!(time_s > 0.0)) return;
  if (const auto t = ThrowAt(rig_, family, time_s)) {
    candidates_.push_back(CandidateAt(family, *t));
  }
}

void Search::Root(const ThrowFamily& family, std::size_t limit, double from,
                  double to) {
  const auto first = SlacksAt(family, from);
  if (!first) return;
  const bool positive = (*first)[limit] > 0.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (from + to);
    const auto s = SlacksAt(family, middle);
    if (!s) return;
    (((*s)[limit] > 0.0) == positive ? from : to) = middle;
  }
  Add(family, from);
  Add(family, to);
}

// A limit that is met or missed by a hair inside a cell: the throw at the
// extremum, and the roots on its sides.
void Search::Extremum(const ThrowFamily& family, std::size_t limit, double from,
                      double to) {
  constexpr double kGolden = 0.6180339887498949;
  const auto first = SlacksAt(family, from);
  const auto last = SlacksAt(family, to);
  if (!first || !last) return;
  const bool negative = (*first)[limit] < 0.0;
  // Towards zero.
  const auto cost = [&](double time) {
    const auto s = SlacksAt(family, time);
    return s ? (negative ? -(*s)[limit] : (*s)[limit]) : kInf;
  };
  double low = from;
  double high = to;
  for (int i = 0; i < kGoldenSteps; ++i) {
    const double left = high - kGolden * (high - low);
    const double right = low + kGolden * (high - low);
    (cost(left) < cost(right) ? high : low) =
        cost(left) < cost(right) ? right : left;
  }
  const double best = 0.5 * (low + high);
  Add(family, best);
  if (cost(best) < 0.0) {
    Root(family, limit, from, best);
    Root(family, limit, best, to);
  }
}

void Search::Visit(const ThrowFamily& family) {
  const double width = (family.to_s - family.from_s) / family.cells;
  const auto at = [&](int i) { return family.from_s + width * i; };
  std::vector<std::optional<Slacks>> grid(
      static_cast<std::size_t>(family.cells) + 1);
  for (int i = 0; i <= family.cells; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (at(i) > 0.0) grid[k] = SlacksAt(family, at(i));
    if (grid[k]) Add(family, at(i));
    if (k == 0 || !grid[k] || !grid[k - 1]) continue;
    for (std::size_t limit = 0; limit < kLimits; ++limit) {
      const double now = (*grid[k])[limit];
      const double before = (*grid[k - 1])[limit];
      if ((now > 0.0) != (before > 0.0)) {
        Root(family, limit, at(i - 1), at(i));
      } else if (k > 1 && grid[k - 2]) {
        // The sign stays, but the middle of three is nearest to zero.
        const double earlier = (*grid[k - 2])[limit];
        if ((earlier > 0.0) == (now > 0.0) &&
            std::abs(before) < std::abs(now) &&
            std::abs(before) < std::abs(earlier)) {
          Extremum(family, limit, at(i - 2), at(i));
        }
      }
    }
  }
  // Flights far shorter than a cell, from muzzles just above the ground; and
  // where a family begins or ends inside a cell.
  constexpr int kHalvings = 24;
  if (family.from_s == 0.0) {
    double time = width;
    for (int i = 0; i < kHalvings; ++i) {
      const double half = 0.5 * time;
      const auto now = SlacksAt(family, half);
      const auto before = SlacksAt(family, time);
      Add(family, half);
      for (std::size_t limit = 0; now && before && limit < kLimits; ++limit) {
        if (((*now)[limit] > 0.0) != ((*before)[limit] > 0.0)) {
          Root(family, limit, half, time);
        }
      }
      time = half;
    }
  }
  for (std::size_t k = 1; k < grid.size(); ++k) {
    if (grid[k].has_value() == grid[k - 1].has_value()) continue;
    const int i = static_cast<int>(k);
    double there = grid[k] ? at(i) : at(i - 1);
    double absent = grid[k] ? at(i - 1) : at(i);
    for (int step = 0; step < kBisections; ++step) {
      const double middle = 0.5 * (there + absent);
      (middle > 0.0 && ThrowAt(rig_, family, middle) ? there : absent) = middle;
    }
    Add(family, there);
    const double inner = grid[k] ? at(i) : at(i - 1);
    const auto edge = SlacksAt(family, there);
    const auto in = SlacksAt(family, inner);
    for (std::size_t limit = 0; edge && in && limit < kLimits; ++limit) {
      if (((*edge)[limit] > 0.0) != ((*in)[limit] > 0.0)) {
        Root(family, limit, there, inner);
      }
    }
  }
  if (family.kind == AngleKind::kApproach) {
    Add(family, family.speed_mps * std::sin(family.angle_rad) /
                    rig_.gravity_mps2.value);  // the level shot
  }
}

bool Search::HeightIsRight(const Candidate& c) const {
  return c.slack[kLowest] >= -kLengthSlack_m &&
         c.slack[kHighest] >= -kLengthSlack_m;
}

bool Search::HeightIsInRange(const Candidate& c) const {
  return c.t.muzzle_height_m >= rig_.muzzle_height_min_m - kLengthSlack_m &&
         c.t.muzzle_height_m <= rig_.muzzle_height_max_m + kLengthSlack_m;
}

bool Search::ElevationIsInRange(const Candidate& c) const {
  return c.slack[kFlattest] >= -kAngleSlack_rad &&
         c.slack[kSteepest] >= -kAngleSlack_rad;
}

bool Search::CornerIsRight(const Candidate& c) const {
  return !wish_.corner || LandingAt(rig_, c.t.face_rad).corner == *wish_.corner;
}

bool Search::SpringsCan(const Candidate& c) const {
  // At the limit itself rounding decides; the limit is allowed.
  constexpr double kRounding = 1e-12;
  if (!(c.t.launch_speed_mps >= kSlowestLaunch_mps)) return false;
  const double compression = CompressionOf(rig_, c.t);
  return compression <= greatest_m_ * (1.0 + kRounding) &&
         LaunchSpeed(LaunchOf(rig_, c.t.elevation_rad),
                     std::fmin(compression, greatest_m_));
}

std::string Search::SpringsReason(const Candidate& c) const {
  const double compression = CompressionOf(rig_, c.t);
  for (const Finding& f : CheckCompression(rig_, compression)) {
    if (f.severity != Severity::kRefusal) continue;
    return fmt::format("a launch at {:.3g} m/s: {}", c.t.launch_speed_mps,
                       f.what);
  }
  return "a launch at rest: the body does not leave the muzzle";
}

std::string Search::Way(const Candidate& c) const {
  if (c.slack[kClear] < -kLengthSlack_m) {
    return fmt::format(
        "within the rig's range every throw that ends so begins with a corner "
        "at least {:.3g} mm in the ground",
        -Mm(c.slack[kClear]));
  }
  if (!IsRectangle(rig_)) return "";
  const auto flown =
      FlyTurning({.long_m = rig_.body->long_m->value,
                  .short_m = rig_.body->short_m->value,
                  .speed_mps = c.t.launch_speed_mps,
                  .elevation_rad = c.t.elevation_rad,
                  .height_m = c.t.muzzle_height_m,
                  .face_rad = c.t.elevation_rad + rig_.seat_angle_rad.value,
                  .spin_rad_per_s = rig_.spin_rad_per_s.value,
                  .gravity_mps2 = rig_.gravity_mps2.value});
  if (!flown) {
    return "within the rig's range no throw ends so: " + flown.error().reason;
  }
  if (std::abs(flown->face_rad - c.t.face_rad) > kMiss ||
      std::abs(flown->flight.impact_speed_mps - wish_.speed_mps) >
          kMiss * wish_.speed_mps) {
    return fmt::format(
        "within the rig's range every throw that would end so touches the "
        "ground before, the nearest {:.3g} ms",
        (c.t.time_s - flown->flight.time_s) * 1e3);
  }
  return "";
}

Expected<Setting> Search::Nudged(Candidate c) const {
  Setting out;
  out.elevation_rad =
      std::clamp(c.t.elevation_rad, -kQuarterTurn, kQuarterTurn);
  out.muzzle_height_m =
      wish_.muzzle_height_m
          ? *wish_.muzzle_height_m
          : std::clamp(c.t.muzzle_height_m, rig_.muzzle_height_min_m,
                       rig_.muzzle_height_max_m);
  out.compression_m = std::fmin(CompressionOf(rig_, c.t), greatest_m_);
  return out;
}

std::string Search::HeightReason() const {
  const auto less = [](const Candidate& a, const Candidate& b) {
    return a.t.muzzle_height_m < b.t.muzzle_height_m;
  };
  const auto [lowest, highest] =
      std::minmax_element(candidates_.begin(), candidates_.end(), less);
  const double wanted =
      wish_.muzzle_height_m.value_or(rig_.muzzle_height_min_m);
  const double ceiling =
      wish_.muzzle_height_m.value_or(rig_.muzzle_height_max_m);
  if (highest->t.muzzle_height_m < wanted) {
    const double drop = wanted - highest->t.centre_height_m;
    const double fall =
        std::sqrt(std::fmax(0.0, 2.0 * rig_.gravity_mps2.value * drop));
    if (fall >= wish_.speed_mps) {
      return fmt::format(
          "the fall of {:.1f} mm alone gives {:.3g} m/s, the wanted speed is "
          "{:.3g}: lower the muzzle",
          Mm(drop), fall, wish_.speed_mps);
    }
    if (wish_.kind == AngleKind::kApproach) {
      return fmt::format(
          "the fall of {:.1f} mm alone makes the approach at least {:.2f} deg "
          "at {:.3g} m/s: lower the muzzle to {:.1f} mm or raise the speed",
          Mm(drop), Deg(std::asin(fall / wish_.speed_mps)), wish_.speed_mps,
          Mm(highest->t.muzzle_height_m));
    }
    return fmt::format(
        "needs a muzzle height of at most {:.1f} mm, not {:.1f}: lower the "
        "muzzle or raise the speed",
        Mm(highest->t.muzzle_height_m), Mm(wanted));
  }
  if (wish_.muzzle_height_m && ceiling < lowest->t.centre_height_m) {
    return fmt::format(
        "the muzzle at {:.1f} mm is below the body's centre at touchdown, "
        "{:.1f} mm",
        Mm(ceiling), Mm(lowest->t.centre_height_m));
  }
  return fmt::format("needs a muzzle height of at least {:.1f} mm, not {:.1f}",
                     Mm(lowest->t.muzzle_height_m), Mm(ceiling));
}

Expected<Setting> Search::Best() {
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
        Mm(left.front()->t.muzzle_height_m), Mm(rig_.muzzle_height_min_m),
        Mm(rig_.muzzle_height_max_m)));
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
        Deg(nearest->t.elevation_rad), Deg(rig_.elevation_min_rad),
        Deg(rig_.elevation_max_rad)));
  }
  nearest = keep([&](const Candidate& c) { return CornerIsRight(c); },
                 [](const Candidate& c) { return c.t.time_s; });
  if (left.empty()) {
    const auto corner = LandingAt(rig_, nearest->t.face_rad).corner;
    return AbsentBecause(fmt::format(
        "at an elevation of {:.2f} deg the {} lands first, not the {} corner",
        Deg(nearest->t.elevation_rad),
        corner ? std::string(core::Name(*corner)) + " corner" : "middle",
        core::Name(*wish_.corner)));
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
    if (Way(*c).empty()) return Nudged(*c);
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
  Search careful(rig, wish, greatest_m, kClearance_u * rig.u_muzzle_height_m);
  careful.Run(families);
  const auto clear = careful.Best();
  if (clear || rig.u_muzzle_height_m == 0.0) return clear;
  Search any(rig, wish, greatest_m, 0.0);
  any.Run(families);
  return any.Best();
}

}  // namespace touchdown::rig
