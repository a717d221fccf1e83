#include "throw_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "angles.h"
#include "infinity.h"
#include "touchdown/rig/launch.h"
#include "touchdown/rig/predict.h"

namespace touchdown::rig {
namespace {

using core::AngleKind;

constexpr int kGoldenSteps = 40;  // to 1e-8 of a cell

class Search {
 public:
  explicit Search(const SearchInput& input) : input_(input) {}

  std::vector<Candidate> Run(const std::vector<ThrowFamily>& families) {
    for (const ThrowFamily& family : families) Visit(family);
    return std::move(candidates_);
  }

 private:
  Slacks ComputeSlacks(const Throw& t) const;
  std::optional<Slacks> FindSlacks(const ThrowFamily& family,
                                   double time_s) const;
  void Visit(const ThrowFamily& family);
  void Root(const ThrowFamily& family, std::size_t limit, double from,
            double to);
  void Extremum(const ThrowFamily& family, std::size_t limit, double from,
                double to);
  void Add(const ThrowFamily& family, double time_s);
  Candidate MakeCandidate(const ThrowFamily& family, const Throw& t) const;
  double SpareHeight(const Throw& t) const;

  const SearchInput& input_;
  std::vector<Candidate> candidates_;
};

// How much higher than its start the body could begin: of its lowest corner.
double Search::SpareHeight(const Throw& t) const {
  const double face = t.elevation_rad + input_.rig.seat_angle_rad.value;
  return t.muzzle_height_m - CentreHeightAtTouchdown(input_.rig, face);
}

Slacks Search::ComputeSlacks(const Throw& t) const {
  Slacks s{};
  if (input_.wish.muzzle_height_m) {
    // Equality: its sign changes, and both are met there.
    s[kLowest] = t.muzzle_height_m - *input_.wish.muzzle_height_m;
    s[kHighest] = -s[kLowest];
  } else {
    s[kLowest] = t.muzzle_height_m - input_.rig.muzzle_height_min_m;
    s[kHighest] = input_.rig.muzzle_height_max_m - t.muzzle_height_m;
  }
  s[kFlattest] = t.elevation_rad - input_.rig.elevation_min_rad;
  s[kSteepest] = input_.rig.elevation_max_rad - t.elevation_rad;
  if (ThrowsRectangle(input_.rig) && input_.wish.corner) {
    const double c = std::cos(t.face_rad);
    const double n = std::sin(t.face_rad);
    s[kCornerTurns] = c * n *
                      (input_.rig.body->long_m->value * std::abs(c) -
                       input_.rig.body->short_m->value * std::abs(n));
  }
  s[kTravel] = input_.greatest_m == kInf
                   ? 1.0
                   : input_.greatest_m - RequiredCompression(input_.rig, t);
  s[kClear] = SpareHeight(t) - input_.clearance_m;
  return s;
}

std::optional<Slacks> Search::FindSlacks(const ThrowFamily& family,
                                         double time_s) const {
  const auto t = ComputeThrow(input_.rig, family, time_s);
  if (!t) return std::nullopt;
  return ComputeSlacks(*t);
}

Candidate Search::MakeCandidate(const ThrowFamily& family,
                                const Throw& t) const {
  Candidate c;
  c.t = t;
  c.slack = ComputeSlacks(t);
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
  if (const auto t = ComputeThrow(input_.rig, family, time_s)) {
    candidates_.push_back(MakeCandidate(family, *t));
  }
}

void Search::Root(const ThrowFamily& family, std::size_t limit, double from,
                  double to) {
  const auto first = FindSlacks(family, from);
  if (!first) return;
  const bool positive = (*first)[limit] > 0.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (from + to);
    const auto s = FindSlacks(family, middle);
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
  // Golden-section search: (sqrt(5) - 1) / 2.
  constexpr double kGolden = 0.6180339887498949;
  const auto first = FindSlacks(family, from);
  const auto last = FindSlacks(family, to);
  if (!first || !last) return;
  const bool negative = (*first)[limit] < 0.0;
  // Towards zero.
  const auto cost = [&](double time) {
    const auto s = FindSlacks(family, time);
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
    if (at(i) > 0.0) grid[k] = FindSlacks(family, at(i));
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
      const auto now = FindSlacks(family, half);
      const auto before = FindSlacks(family, time);
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
      (middle > 0.0 && ComputeThrow(input_.rig, family, middle) ? there
                                                                : absent) =
          middle;
    }
    Add(family, there);
    const double inner = grid[k] ? at(i) : at(i - 1);
    const auto edge = FindSlacks(family, there);
    const auto in = FindSlacks(family, inner);
    for (std::size_t limit = 0; edge && in && limit < kLimits; ++limit) {
      if (((*edge)[limit] > 0.0) != ((*in)[limit] > 0.0)) {
        Root(family, limit, there, inner);
      }
    }
  }
  if (family.kind == AngleKind::kApproach) {
    Add(family, family.speed_mps * std::sin(family.angle_rad) /
                    input_.rig.gravity_mps2.value);  // the level shot
  }
}

}  // namespace

double RequiredCompression(const Description& rig, const Throw& t) {
  const double elevation =
      std::clamp(t.elevation_rad, -kQuarterTurn, kQuarterTurn);
  return SolveCompression(MakeLaunch(rig, elevation), t.launch_speed_mps);
}

std::vector<Candidate> FindCandidates(
    const SearchInput& input, const std::vector<ThrowFamily>& families) {
  return Search(input).Run(families);
}

}  // namespace touchdown::rig
