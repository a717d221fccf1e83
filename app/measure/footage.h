// The frames of a clip as an analysis looks at them.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "app/measure/analyze.h"
#include "app/measure/clip_calibration.h"
#include "touchdown/vision/background/steady_camera.h"
#include "touchdown/vision/detection/frame_store.h"

namespace touchdown::pipeline {

// Of clips that are mapped into memory: nothing is decoded.
inline constexpr const char* kRawFormat = "mraw";

struct Footage {
  vision::ClipInfo info;               // of the recording itself
  std::unique_ptr<vision::Clip> clip;  // under steady light, of a still camera
  std::optional<double> light_spread;  // relative, where it was taken out
  bool light_told = true;
  std::optional<core::Estimate> camera_moved_px;  // where it was taken out
  bool motion_unexplained = false;                // vision::CameraMotion's
  // Backgrounds are made of these; empty: of any.
  std::vector<std::int64_t> still_frames;
  std::chrono::steady_clock::time_point begun;  // from when time counts
};

// The clip without flicker and motion of the camera, of which nothing is kept
// yet. `motion` is the recording's; it is measured where it is not known.
Footage MakeSteady(std::unique_ptr<vision::Clip> clip,
                   const AnalyzeOptions& options,
                   std::optional<vision::CameraMotion>& motion);

// How frames are kept for these options, which fit `clip` (check_options.h).
vision::FrameStoreOptions MakeKeepOptions(const AnalyzeOptions& options,
                                          const vision::ClipInfo& clip);

// The analysis of frames that are ready to be looked at.
Analysis AnalyzeFootage(Footage footage, const ClipCalibration& camera,
                        const AnalyzeOptions& options);

}  // namespace touchdown::pipeline
