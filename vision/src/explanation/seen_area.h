// Which part of a track's body is seen to be body (ExplainedChange::seen).
//
// Each cell of the body's picture T compares the two layers over the samples
// that it covers wholly and of which B is known:
//   r = SS(I - (1 - M) B - M T) / SS(I - B)
// A cell is seen where r < 0.75. r is 1 / 2 for a contrast as large as the
// noise, 1 - 1 / n for none (n samples; T is their mean), and larger where the
// background passes under T. What is not seen counts where it is reached from
// outside through cells that are not seen either: an outline that lies farther
// in leaves no more. A mark that T does not follow lies within.
#pragma once

#include <optional>
#include <vector>

#include "explanation/change_samples.h"
#include "explanation/two_layers.h"

namespace touchdown::vision {

// Share of the cells, 0 .. 1; absent where fewer than 20 tell. `covered` and
// `layers` come from the same track and samples.
std::optional<double> MeasureSeenArea(const std::vector<CoveredPoints>& covered,
                                      const TwoLayers& layers,
                                      const LatticeLevels& levels);

}  // namespace touchdown::vision
