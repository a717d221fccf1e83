// Numbers of more digits and a wider range than double has, for intermediate
// results.
#pragma once

namespace touchdown::analysis {

using Wide = long double;

inline double Narrow(Wide x) { return static_cast<double>(x); }

}  // namespace touchdown::analysis
