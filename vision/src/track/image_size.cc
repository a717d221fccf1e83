#include "track/image_size.h"

#include <algorithm>
#include <string>

namespace touchdown::vision {

// FollowSize sets relative sizes for all poses or for none.
bool IsSteady(const Track& track) {
  return std::all_of(
      track.poses.begin(), track.poses.end(),
      [](const Pose& pose) { return pose.relative_size == 1.0; });
}

void KeepSize(Track& track) {
  for (Pose& pose : track.poses) pose.relative_size = 1.0;
  std::erase_if(track.warnings, [](const std::string& warning) {
    return warning.starts_with(kGrows);
  });
}

}  // namespace touchdown::vision
