// A bound that is none.
#pragma once

#include <limits>

namespace touchdown::rig {

// A limit that is none.
inline constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace touchdown::rig
