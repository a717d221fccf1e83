// The order in which a person numbers files.
#pragma once

#include <string_view>

namespace touchdown::vision {

// Whether `a` comes before `b` when runs of digits count as numbers: img2
// before img10. Numbers of any length; equal ones with fewer leading zeros
// first (img1, img01); everything else by byte. A strict weak order, and total:
// names that differ never tie.
bool NaturalLess(std::string_view a, std::string_view b);

}  // namespace touchdown::vision
