#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "tracking/refiner.h"

namespace touchdown::vision {

// Learns what the face shows beyond its smooth shading (highlights), if the
// outlines then fit better; else the face stays smooth.
void Refiner::LearnLook(Track& refined, std::vector<Fitted>& sized) {
  if (!track_.known_background) return;
  if (!LearnSpots(refined.body, sized)) {
    options_.appearance = nullptr;
    return;
  }
  options_.appearance = &*look_;
  // A body that is well modelled now tells more of what is near it.
  LookNearGround(refined);
}

bool Refiner::LearnSpots(const BodyImage& body, std::vector<Fitted>& sized) {
  // Outlines and appearance in turns: the first outlines are drawn aside by
  // what they do not know. After the third round nothing changes any more.
  constexpr int kRounds = 3;
  // Share of the frames that must still have an outline. Not studied.
  constexpr double kMinKeptShare = 0.8;
  look_.reset();
  std::vector<Fitted> again = sized;
  for (int round = 0; round < kRounds; ++round) {
    auto look = LearnAppearance(clip_, background_, Seen(again), options_);
    if (!look) break;
    look_ = std::move(look);
    options_.appearance = &*look_;
    again = Sample(body);
  }
  if (!look_ ||
      static_cast<double>(again.size()) <

          kMinKeptShare * static_cast<double>(sized.size()) ||
      MedianMisfit(again) > std::max(kWellModelled, MedianMisfit(sized))) {
    return false;
  }
  sized = std::move(again);
  return true;
}

// The fits with the motion of the nearest pose at or after each.
std::vector<SeenOutline> Refiner::Seen(const std::vector<Fitted>& fits) const {
  std::vector<SeenOutline> seen;
  std::size_t i = 0;  // both are in the frames' order
  for (const Fitted& f : fits) {
    while (i + 1 < track_.poses.size() && track_.poses[i].frame < f.frame) ++i;
    const Motion& motion = motion_[i];
    seen.push_back({f.frame, f.fit, core::PixelPoint{motion.x_px, motion.y_px},
                    motion.turn_rad});
  }
  return seen;
}

}  // namespace touchdown::vision
