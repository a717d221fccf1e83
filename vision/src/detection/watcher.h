// Coarse looks at single frames: which regions could be the body.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "detection/detect.h"
#include "detection/scout.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track_options.h"

namespace touchdown::vision {

// Whether short looks pay: where there is much to look at.
bool IsLong(const Clip& clip, const TrackOptions& options);

// What was seen in one frame.
struct Seen {
  double time_s = 0.0;  // where there are any blobs
  std::vector<Blob> blobs;
  // Than are kept (DetectOptions::most_blobs), and not mere specks.
  bool more = false;
};

// Looks at frames, each by itself.
class Watcher {
 public:
  // `background` must outlive it.
  Watcher(const Clip& clip, const Background& background,
          const TrackOptions& options, Detector detector);

  // Where a clip can be glimpsed at, whether frame `index` may show anything.
  bool CanGlimpse(const Clip& clip) const {
    return scout_ && clip.windows_are_cheap();
  }
  bool Glimpse(Clip& clip, std::int64_t index, int phase) const {
    return scout_->Glimpse(clip, index, phase);
  }

  Seen Look(Clip& clip, std::int64_t index) const;

 private:
  const Background& background_;
  DetectOptions detect_;
  std::optional<Scout> scout_;
};

}  // namespace touchdown::vision
