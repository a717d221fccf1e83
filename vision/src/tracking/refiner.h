// Measures a track again with the ground line known: how Refine (tracker.h)
// does it. refine.cc has the order of things, refine_shape.cc what all frames
// share, refine_look.cc what the body looks like.
#pragma once

#include <optional>
#include <vector>

#include "outline/appearance.h"
#include "outline/outline_batch.h"
#include "outline/shared_fit.h"
#include "outline/track_shape.h"
#include "touchdown/vision/tracking/tracker.h"
#include "tracking/hidden_frames.h"

namespace touchdown::vision {

// Of a body in one frame interval.
struct Motion {
  double x_px = 0.0;
  double y_px = 0.0;
  double turn_rad = 0.0;
};

class Refiner {
 public:
  // The arguments but `refine` must outlive it.
  Refiner(Clip& clip, const Background& background, const Track& track,
          const RefineOptions& refine);

  // Whether the picture near the ground line is what the body alone makes of
  // it, so that the lower edge need not be left out.
  void LookNearGround(Track& refined);
  // The size once more, now that the ground is left out: a body that lies on it
  // had the ground's edge taken for its own. With it blur, exposure, shading.
  void LearnShape(Track& refined);
  void MeasurePoses(Track& refined);
  // The body as some frames show it.
  std::vector<Fitted> Sample(const BodyImage& body);

 private:
  // What the body looks like beyond its shading, where that is something;
  // `sized` are fits of a sample of frames, and are fitted again then.
  void LearnLook(Track& refined, std::vector<Fitted>& sized);
  bool LearnSpots(const BodyImage& body, std::vector<Fitted>& sized);
  std::vector<SeenOutline> Seen(const std::vector<Fitted>& fits) const;
  OutlineJob MakeJob(const BodyImage& body, std::size_t i) const;
  // Blur and exposure, from fits of each frame, which it returns.
  std::vector<Fitted> LearnBlur(Track& refined);
  // The mean of the sizes that frames show; or one size, blur and exposure for
  // all of them at once. They return the fits; few or none where it fails.
  std::vector<Fitted> SizeByFrames(BodyImage& body);
  std::vector<Fitted> SizeTogether(BodyImage& body);
  void Follow(const SharedStep& step, BodyImage& body);
  bool LookForHider(const std::vector<Fitted>& whole, const BodyImage& body);
  // Of every `step`-th pose.
  std::vector<std::optional<Fitted>> FitPoses(const BodyImage& body,
                                              std::size_t step);

  Clip& clip_;
  const Background& background_;
  const Track& track_;
  int threads_;
  HiddenFrames hidden_;
  OutlineOptions options_;
  std::vector<Motion> motion_;  // at each pose
  std::optional<Appearance> look_;
};

}  // namespace touchdown::vision
