// Whether a clip was measured better with light in place of its levels: which
// of two answers of the same clip a camera's gamma explains.
#pragma once

namespace touchdown::pipeline {

struct LightEvidence {
  double explained = 0.0;    // vision::ExplainedChange::near
  double u_common_px = 0.0;  // vision::BodyImage: of a block of stated sides it
                             // holds how far its outlines lie beside them
  // vision::ContactResult: the flights have another gravity than was told.
  bool gravity_refuted = false;
};

// No witness may speak against light, and one must speak for it: it explains
// more of the clip while the outlines lie no farther beside the stated sides,
// or as much while they lie at least twice as near. Flights whose gravity was
// right in levels and is not in light speak against it: a gamma that is not the
// camera's moves each edge by what lies behind it, and bends the path.
bool IsBetterInLight(const LightEvidence& light, const LightEvidence& levels);

}  // namespace touchdown::pipeline
