// Frames of a track in which something hides the body in part, and what that
// thing is: they neither tell its size nor, without the thing's place, where it
// is.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "outline/hider.h"
#include "outline/outline_batch.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

class HiddenFrames {
 public:
  // The arguments must outlive it.
  HiddenFrames(Clip& clip, const Background& background, const Track& track)
      : clip_(clip), background_(background), track_(track) {}

  bool Has(std::int64_t frame) const;
  // Takes the fits of a body that is hidden in part out (FindHidden), and all
  // frames up to the next fits beside them.
  void LeaveOut(std::vector<Fitted>& sized);

  // What stands before the body, from the fits of frames in which it is seen
  // whole: they say where it should be seen in the others, too. `own`: where
  // those are by themselves at the body's size. False where nothing new was
  // found; what was found once stays.
  bool LookForHider(const std::vector<Fitted>& whole, const BodyImage& body,
                    std::span<const std::optional<Fitted>> own,
                    const OutlineOptions& options);
  // Null: none was found.
  const Hider* hider() const { return hider_.get(); }

  // Fits, with the hider left out, frames that show the body in part: beside
  // the whole ones in `fits` (by frame), to which they are added, and as far
  // beyond the track as the body can be followed.
  void AddFits(std::vector<Fitted>& fits, const BodyImage& body,
               const OutlineOptions& options) const;

 private:
  std::vector<std::int64_t> FindPartialFrames(const std::vector<Fitted>& whole,
                                              std::int64_t most) const;
  std::optional<OutlineJob> Expect(const BodyImage& body,
                                   std::span<const Fitted> fits,
                                   const OutlineOptions& options,
                                   std::int64_t frame) const;

  Clip& clip_;
  const Background& background_;
  const Track& track_;
  struct Frames {
    std::int64_t first = 0;  // both included
    std::int64_t last = 0;
  };
  std::vector<Frames> hidden_;
  std::shared_ptr<const Hider> hider_;
};

}  // namespace touchdown::vision
