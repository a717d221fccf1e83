// Drawings of the contact theory, as SVG.
#pragma once

#include <string>
#include <vector>

#include "touchdown/analysis/theory/regime_map.h"

namespace touchdown::report {

// Regimes as coloured areas over angle and spin or friction.
std::string DrawRegimeMap(const analysis::RegimeMap& map,
                          const std::string& title);

// Fig. 2 of the paper: the four sign patterns of A and B as lines y = A f + B,
// with their solutions, the indeterminate and the inconsistent case named.
std::string DrawComplementarityCases();

// Figs. 6 and 7: the lines of a body at several contact angles; a filled dot is
// a solution.
std::string DrawComplementarityLines(
    const std::vector<analysis::ComplementarityLine>& lines,
    const std::string& title);

}  // namespace touchdown::report
