#include "app/measure/footage.h"

#include <memory>
#include <utility>

#include "touchdown/vision/background/steady_light.h"
#include "touchdown/vision/footage/decoded_once.h"

namespace touchdown::pipeline {

Footage MakeSteady(std::unique_ptr<vision::Clip> clip,
                   const AnalyzeOptions& options,
                   std::optional<vision::CameraMotion>& motion) {
  Footage footage;
  // To measure the light reads frames: it is part of the time of the track.
  footage.begun = std::chrono::steady_clock::now();
  footage.info = clip->info();
  const auto looks = std::make_shared<bool>(true);
  vision::DecodedOnceOptions once;
  once.looks = looks;
  clip = vision::DecodeOnce(std::move(clip), once);
  const std::int64_t last =
      options.last_frame < 0 ? footage.info.frames : options.last_frame;
  vision::SteadyLightOptions light_options;
  light_options.threads = options.decoder_threads;
  vision::SteadyLight light = vision::Deflicker(
      std::move(clip), options.first_frame, last, light_options);
  footage.light_told = light.told;
  // Absent where nothing was taken out: the scene model tells the two apart.
  if (light.corrected) footage.light_spread = light.spread;
  if (!motion) {
    motion =
        vision::MeasureCameraMotion(*light.clip, options.first_frame, last);
  }
  *looks = false;
  footage.clip = vision::PutBack(std::move(light.clip), *motion);
  footage.camera_moved_px = motion->most_moved_px;
  footage.motion_unexplained = motion->unexplained;
  return footage;
}

vision::FrameStoreOptions MakeKeepOptions(const AnalyzeOptions& options,
                                          const vision::ClipInfo& clip) {
  vision::FrameStoreOptions keep;
  keep.first = options.first_frame;
  keep.last = options.last_frame < 0 ? clip.frames : options.last_frame;
  keep.region = options.region;
  keep.threads = options.decoder_threads;
  keep.progress = options.progress;
  return keep;
}

}  // namespace touchdown::pipeline
