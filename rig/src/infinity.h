// A bound that is none.
#pragma once

#include <limits>

namespace touchdown::rig {

inline constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace touchdown::rig
