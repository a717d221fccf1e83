// The truth beside a simulated clip, schema touchdown.truth/1. Names are those
// of touchdown.analysis/1 (analyze --json), so that the two compare field by
// field; numbers stand bare, without u: they are exact.
//
//   origin "simulated"; software; seed; clip {path, format, width_px, ...}
//   ground {x1_px, y1_px, x2_px, y2_px}; scale_px_per_m; body
//   contact, state, motion: of the first touchdown
//   events: every contact and change of motion, with velocities before/after
//   frames {columns, rows}: truth at the middle of each exposure, from the
//     first frame that shows the body
//   scene: touchdown.scene/1, from which the clip can be made again
#pragma once

#include <cstdint>
#include <string>

#include "app/simulate/simulate.h"

namespace touchdown::pipeline {

std::string TruthText(const Shot& shot, const ShotTruth& truth,
                      const std::string& clip_name, const std::string& format,
                      std::uint64_t seed);

}  // namespace touchdown::pipeline
