// The options of an analysis that decide its answer, each named once. What
// writes, reads or checks options goes through this list, so that none is
// forgotten: a new one is a member of AnalyzeOptions, a line here, and a flag
// (app/cli/analyze/analyze_flags.h); the options' hash takes it where it is set
// (options_hash.h).
#pragma once

#include <tuple>

#include "app/measure/analyze.h"

namespace touchdown::pipeline {

// What an option is of: what holds for a camera holds for its next clip.
enum class OptionScope { kCamera, kShot };

// Calls visit(name, member, scope) for each, in SI; `Options` is
// AnalyzeOptions, const or not.
template <class Options, class Visit>
void VisitOptions(Options& o, const Visit& visit) {
  using enum OptionScope;
  visit("fps", o.fps, kCamera);
  visit("gamma", o.gamma, kCamera);
  visit("scale_px_per_m", o.scale_px_per_m, kCamera);
  visit("body_kind", o.body_kind, kShot);
  visit("diameter_m", o.diameter_m, kShot);
  visit("long_m", o.long_m, kShot);
  visit("short_m", o.short_m, kShot);
  visit("ground", o.ground, kShot);
  visit("contact_frame", o.contact_frame, kShot);
  visit("frames", std::tie(o.first_frame, o.last_frame), kShot);
  visit("region", o.region, kShot);
  visit("angle_kind", o.angle_kind, kShot);
  visit("bounce_height_m", o.bounce_height_m, kShot);
  visit("calibration", o.calibration, kCamera);
  visit("crop", o.crop, kCamera);
  visit("stop_early", o.stop_early, kShot);
}

}  // namespace touchdown::pipeline
