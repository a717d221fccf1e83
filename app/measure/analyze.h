// One clip to one trial: composes the modules.
//   Clip -> Frame -> Outline -> Pose(t) -> Trajectory -> Contact -> MotionState
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/measure/answer_check.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/body.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/trial.h"
#include "touchdown/vision/contact/contact.h"
#include "touchdown/vision/contact/plane_track.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::pipeline {

// Wall time after which one clip's analysis is given up where nobody says
// otherwise, in seconds. 120: no recording that we know takes half of it on an
// idle machine; a person or a batch that waits longer for one clip waits in
// vain mostly.
inline constexpr double kUsualLimit_s = 120.0;

struct AnalyzeOptions {
  std::optional<double> fps;
  // Of the camera (vision/linear_clip.h); nothing: 1, or what a block's
  // outlines say.
  std::optional<double> gamma;
  std::optional<core::Estimate> scale_px_per_m;
  std::optional<core::BodyKind> body_kind;     // nothing: whichever fits
  std::optional<core::Estimate> diameter_m;    // makes the kind sphere
  std::optional<core::Estimate> long_m;        // both make it rectangle
  std::optional<core::Estimate> short_m;       //
  std::optional<calib::GroundLine> ground;     // nothing: found
  std::optional<std::int64_t> contact_frame;   // nothing: found; else touchdown
                                               // is between it and the next
  std::int64_t first_frame = 0;                // [first, last) is looked at
  std::int64_t last_frame = -1;                // -1: to the end
  core::PixelRect region;                      // width 0: whole picture
  std::optional<core::AngleKind> angle_kind;   // nothing: the body's default
  std::optional<double> bounce_height_m;       // nothing: default convention
  std::function<void(double share)> progress;  // may be empty
  std::int32_t decoder_threads = 0;            // as in vision::ClipOptions
  // Wall time after which the analysis ends with Unfinished; nothing: never. It
  // decides no answer: the options' hash leaves it out.
  std::optional<double> limit_s;
  // True ends the analysis with core::Cancelled; must outlive it; may be null.
  const std::atomic<bool>* interrupted = nullptr;
  bool digest = true;  // clip.id, by which a logged trial knows its clip

  // Frames that come after the first contact's state is decided beyond doubt
  // (stop_early.h) are not looked at, nor decoded: contacts that follow are
  // then those seen so far. Does nothing for raw clips.
  bool stop_early = false;

  // Of the camera: its lens, and scale and ground where nothing else is given.
  // Its uncertainty enters every quantity. A clip that it does not fit is
  // refused.
  std::optional<calib::Calibration> calibration;
  // Where the clip lies on the sensor, for files that do not say.
  std::optional<calib::SensorCorner> crop;
  std::string today;  // YYYY-MM-DD, for the calibration's age; empty: not asked
};

// What was modelled, and what was left out and why.
struct SceneModel {
  std::vector<std::string> used;
  std::map<std::string, std::string> left_out;
};

struct Timing {
  double total_s = 0.0;
  double open_s = 0.0;
  double decode_s = 0.0;  // inside Clip::Read
  double track_s = 0.0;   // reading and fitting
  double contact_s = 0.0;
  double check_s = 0.0;   // comparing the clip with the answer
  double digest_s = 0.0;  // of clip_id, beside the rest
  double frames_per_s = 0.0;
};

// A size of the body that is seen otherwise than it was stated (body_size.h).
struct SizeConflict {
  std::string reason;
  double relative = 0.0;  // of the stated size
};

// The reason of all that an Analysis does not hold yet.
inline constexpr const char* kNotAnalysed = "the clip was not analysed";

struct Analysis {
  vision::ClipInfo clip;
  vision::Channel channel = vision::Channel::kLuma;  // what was looked at
  std::string clip_id;
  bool simulated = false;  // a truth file lies beside the clip
  core::Expected<calib::Scale> scale = core::AbsentBecause(kNotAnalysed);
  // In the ideal picture where there is a lens, as `plane` is.
  core::Expected<calib::GroundLine> ground = core::AbsentBecause(kNotAnalysed);
  core::Expected<core::Body> body = core::AbsentBecause(kNotAnalysed);
  core::AngleKind angle_kind = core::AngleKind::kApproach;
  vision::ContactResult contacts;
  // As it fits this clip (AdaptToPicture).
  std::optional<calib::Calibration> calibration;
  // In the image as it was recorded.
  core::Expected<vision::Track> track = core::AbsentBecause(kNotAnalysed);
  std::optional<vision::PlaneTrack> plane;
  // How much of what changes in the clip the track explains.
  core::Expected<vision::ExplainedChange> explained =
      core::AbsentBecause("no track was measured");
  bool outlines_corrected = false;  // by a person, since that was measured
  std::optional<SizeConflict> size_conflict;
  std::vector<AnswerCheck> checks;  // answer_check.h; with their consequences
  SceneModel scene_model;
  std::vector<std::string> warnings;
  // One past the last frame that was looked at, where that is not all.
  std::optional<std::int64_t> stopped_at;
  // How far the farthest corner of the picture went while it was filmed, where
  // the camera moved: pixels are those of the first frame (steady_camera.h).
  std::optional<core::Estimate> camera_moved_px;
  Timing timing;
  AnalyzeOptions options;  // that it was made with
  std::string options_hash;
  std::vector<std::string> corrections;  // by a person, one sentence each
};

// The analysis was ended by its limit (AnalyzeOptions::limit_s). what() is one
// line: which clip, how far it got, what to do.
class Unfinished : public core::InputError {
 public:
  Unfinished(const std::string& what, Analysis so_far);

  // What is true all the same: the clip. Body, ground and contact are absent,
  // with the limit as the reason. Not to be logged as a trial.
  const Analysis& so_far() const { return *so_far_; }

 private:
  std::shared_ptr<const Analysis> so_far_;
};

// Analyses the clip at `path`. Where a colour recording shows nothing, or
// several bodies, in luma (a shadow as dark as the body), its colour
// differences are tried. What science cannot say is in the result, with
// reasons; throws std::invalid_argument for impossible options and
// core::InputError for unreadable clips and for calibrations of other pictures,
// Unfinished at the limit.
Analysis Analyze(const std::filesystem::path& path,
                 const AnalyzeOptions& options = {});

// The same for a clip that is already open; says nothing of its digest.
Analysis AnalyzeClip(std::unique_ptr<vision::Clip> clip,
                     const AnalyzeOptions& options = {});

}  // namespace touchdown::pipeline
