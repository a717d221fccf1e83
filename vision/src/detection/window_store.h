// The frames of a clip that does not fit into memory: windows of what differs
// from the still picture, and some frames whole.
#pragma once

#include <memory>

#include "touchdown/vision/detection/frame_store.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// As GrowFrames, of a clip that is too large to be kept whole.
std::unique_ptr<GrowingClip> StoreWindows(std::unique_ptr<Clip> clip,
                                          const FrameStoreOptions& options);

}  // namespace touchdown::vision
