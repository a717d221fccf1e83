// Whether a clip was measured better with light in place of its levels: which
// of two answers of the same clip a camera's gamma explains.
#pragma once

namespace touchdown::pipeline {

struct LightEvidence {
  double explained = 0.0;    // vision::ExplainedChange::near
  double u_common_px = 0.0;  // vision::BodyImage: of a block of stated sides it
                             // holds how far its outlines lie beside them
};

// Neither witness may speak against light, and one must speak for it: it
// explains more of the clip while the outlines lie no farther beside the stated
// sides, or as much while they lie at least twice as near.
bool IsBetterInLight(const LightEvidence& light, const LightEvidence& levels);

}  // namespace touchdown::pipeline
