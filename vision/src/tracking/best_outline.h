// The outline that divides what moves along a path from what does not.
#pragma once

#include <optional>

#include "touchdown/core/cancellation.h"
#include "touchdown/core/words.h"
#include "touchdown/vision/outline/outline.h"
#include "tracking/co_moving.h"

namespace touchdown::vision {

struct BestOutline {
  Outline outline;     // centre from that of the places
  double merit = 0.0;  // px^2
  // Of the places that move along, the share within; and of those within that
  // say anything, the share that moves along.
  double holds = 0.0;
  double pure = 0.0;
  // False: the search ended at its bound of turns, still climbing.
  bool settled = true;
};

// The outline of most merit: places within that move along, less those that
// are still, less a little of all, so that what says nothing is left out where
// it can be. From the places' moments, by turns along each parameter in ever
// smaller steps; `finely`: to half a place. Nothing where too few move along.
// Throws core::Cancelled where `until` says so.
std::optional<BestOutline> FindBestOutline(
    const CoMoving& places, core::BodyKind kind, bool finely,
    const core::Cancellation& until = {});

}  // namespace touchdown::vision
