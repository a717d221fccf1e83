// The search of the families of a contact: throws on a grid of the time of
// flight, and those at which a limit of the rig is met.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "throw_family.h"

namespace touchdown::rig {

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

// Halvings of an interval: to the last bit of a double.
inline constexpr int kBisections = 60;

struct Candidate {
  Throw t;
  Slacks slack{};
  // The order in which candidates are to be preferred, then time of flight.
  double first_key = 0.0;
  double second_key = 0.0;
};

struct SearchInput {
  const Description& rig;
  const ContactWish& wish;
  double greatest_m = 0.0;   // compression that springs and trigger allow
  double clearance_m = 0.0;  // of the lowest corner at the muzzle
};

// The compression that launches the throw; the springs may not bear it.
double RequiredCompression(const Description& rig, const Throw& t);

std::vector<Candidate> FindCandidates(const SearchInput& input,
                                      const std::vector<ThrowFamily>& families);

}  // namespace touchdown::rig
