// Which frames of a compressed clip serve for what: those that can be read
// without others, and those that backgrounds are made of.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "touchdown/vision/detection/frame_store.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// Whether each frame of [first, last) can be read without others.
bool AreStoredAlone(const Clip& clip, std::int64_t first, std::int64_t last);

// Frames of [first, last) that can be read without others, near those that its
// background is made of; ascending, at least `first`.
std::vector<std::int64_t> ChooseKeyFrames(const Clip& clip, std::int64_t first,
                                          std::int64_t last);

// Those of the backgrounds that first_look.h may ask for: of the whole range,
// and, where three fifths of options.most_bytes are enough, of its first and
// last eighth. options.last is set.
std::set<std::int64_t> FramesKeptWhole(const ClipInfo& info,
                                       const FrameStoreOptions& options);

}  // namespace touchdown::vision
