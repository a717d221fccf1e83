#include "app/measure/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "app/measure/answer_check.h"
#include "app/measure/body_size.h"
#include "app/measure/left_out.h"
#include "app/measure/lens_uncertainty.h"
#include "app/measure/options_hash.h"
#include "app/measure/shared_uncertainty.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/contact/lens_track.h"

namespace touchdown::pipeline {
namespace {

// The pose of `frame`; throws naming `field` of the correction where no outline
// was fitted in it.
std::vector<vision::Pose>::iterator ToPose(vision::Track& track,
                                           std::int64_t frame,
                                           const char* field) {
  const auto found = std::find_if(
      track.poses.begin(), track.poses.end(),
      [&](const vision::Pose& pose) { return pose.frame == frame; });
  if (found == track.poses.end()) {
    throw std::invalid_argument(fmt::format(
        "{} is {}, must be a frame that shows the body", field, frame));
  }
  return found;
}

// Applies what a person did to single outlines and records each as a sentence
// of the document, so that a report can show what was not measured by the
// program.
void MoveOutlines(const Correction& correction, Analysis& analysis) {
  vision::Track& track = *analysis.track;
  for (const auto& [frame, by] : correction.moved) {
    if (!std::isfinite(by.x_px) || !std::isfinite(by.y_px)) {
      throw std::invalid_argument(fmt::format(
          "moved.{} is not finite, must be two numbers of pixels", frame));
    }
    const auto pose = ToPose(track, frame, "moved");
    pose->centre.x_px += by.x_px;
    pose->centre.y_px += by.y_px;
    // The hand knows the place less well than the fit did.
    pose->u_x_px = std::max(pose->u_x_px, kByHand_px);
    pose->u_y_px = std::max(pose->u_y_px, kByHand_px);
    analysis.corrections.push_back(
        fmt::format("outline of frame {} moved by ({:g}, {:g}) px", frame,
                    by.x_px, by.y_px));
  }
  for (const std::int64_t frame : correction.left_out) {
    track.poses.erase(ToPose(track, frame, "left_out"));
    analysis.corrections.push_back(
        fmt::format("outline of frame {} left out", frame));
  }
  constexpr std::size_t kLeast = 5;  // what FindContacts needs
  if (track.poses.size() < kLeast) {
    throw std::invalid_argument(
        fmt::format("left_out leaves {} outlines, must leave {}",
                    track.poses.size(), kLeast));
  }
}

}  // namespace

vision::Track ToIdealPicture(const ClipCalibration& camera,
                             const vision::Track& track) {
  return camera.lens ? vision::Undistorted(track, *camera.lens) : track;
}

vision::PlaneTrack SeenInPlane(const ClipCalibration& camera,
                               const vision::Track& seen,
                               const calib::GroundLine& ground) {
  return vision::SeenFromGround(seen, ground, CalibratedYaw(camera));
}

bool PassesThroughGround(const vision::PlaneTrack& plane) {
  // px. Room for an outline that errs and a line that is tilted; smaller
  // refuses true grounds. Not studied.
  constexpr double kBelow_px = 2.0;
  return std::any_of(plane.samples.begin(), plane.samples.end(),
                     [](const vision::PlaneSample& sample) {
                       return sample.height_px < -kBelow_px;
                     });
}

bool IsAtTheEnd(const core::Contact& contact, const vision::Track& track) {
  return contact.time_s && !track.poses.empty() &&
         contact.time_s->value >
             track.poses.back().time_s - track.frame_interval_s;
}

core::Estimate PxPerMetre(const vision::PlaneTrack& plane,
                          const calib::Scale& scale) {
  return core::Scaled(scale.px_per_m,
                      scale.source == calib::ScaleSource::kBodySize
                          ? plane.size_stretch
                          : plane.along_stretch);
}

vision::ContactResult FindPlaneContacts(const vision::PlaneTrack& plane,
                                        const vision::ContactOptions& options) {
  vision::ContactOptions in_plane = options;
  if (in_plane.scale) {
    // The plane is turned by the yaw: its pixels are longer than the picture's.
    in_plane.scale->px_per_m = PxPerMetre(plane, *options.scale);
  }
  return vision::FindContacts(plane, in_plane);
}

vision::ContactOptions MakeContactOptions(
    const AnalyzeOptions& options, const ClipCalibration& camera,
    const core::Expected<calib::Scale>& scale) {
  vision::ContactOptions out;
  out.gravity_mps2 = camera.gravity_mps2;
  if (scale) out.scale = *scale;
  out.bounce_height_m = options.bounce_height_m;
  out.contact_frame = options.contact_frame;
  return out;
}

namespace {

// For a result that differs from the analysis' own by a number only.
vision::ContactOptions KeepPath(const Analysis& analysis,
                                vision::ContactOptions options) {
  options.path = analysis.contacts.path;
  options.gravity_refuted = analysis.contacts.gravity_refuted;
  return options;
}

}  // namespace

void AddLens(Analysis& analysis, const ClipCalibration& camera,
             const vision::ContactOptions& contact_options) {
  if (!camera.lens || !analysis.plane ||
      !analysis.contacts.first.contact.found) {
    return;
  }
  // The ground was seen in the image, too: at two points, or all along.
  const calib::GroundLine& ideal = analysis.plane->ground;
  const auto seen =
      SeenPoints(ideal, *camera.lens, camera.ideal_ground ? 2 : 33);
  // A lens moves poses by fractions of a pixel. Which stretch is flight and
  // which is contact does not depend on it, and a cut made anew would add its
  // own jumps to u.
  const vision::ContactOptions same_path = KeepPath(analysis, contact_options);
  AddLensUncertainty(
      analysis.contacts, *camera.lens, analysis.calibration->lens->covariance,
      [&](const calib::Lens& lens) {
        const auto ground = ThroughPoints(seen, lens, ideal);
        // A lens outside of its model tells nothing: all is absent, and
        // AddShared passes over it.
        if (!ground) return vision::ContactResult{};
        std::optional<vision::PlaneYaw> yaw;
        if (camera.yaw_rad) yaw = MakePlaneYaw(camera.yaw_rad->value, lens);
        return FindPlaneContacts(
            vision::SeenFromGround(
                WithStatedSize(vision::Undistorted(*analysis.track, lens),
                               analysis.options),
                *ground, yaw),
            same_path);
      });
}

void AddYaw(Analysis& analysis, const ClipCalibration& camera,
            const vision::ContactOptions& contact_options) {
  if (!camera.yaw_rad || !analysis.plane ||
      !analysis.contacts.first.contact.found) {
    return;
  }
  // The refined track without distortion, of the size that image and statement
  // tell together: what the contacts themselves were found in.
  const vision::Track seen =
      WithStatedSize(ToIdealPicture(camera, *analysis.track), analysis.options);
  std::vector<MovedContacts> moved;
  // On the axis the change is of second order: both sides count.
  for (const double side : {-1.0, 1.0}) {
    const double yaw_rad = camera.yaw_rad->value + side * camera.yaw_rad->u;
    constexpr double kHalf = 0.5;
    moved.push_back({FindPlaneContacts(vision::SeenFromGround(
                                           seen, analysis.plane->ground,
                                           MakePlaneYaw(yaw_rad, camera.lens)),
                                       KeepPath(analysis, contact_options)),
                     kHalf});
  }
  AddShared(analysis.contacts, "yaw", moved);
}

void AddDrag(Analysis& analysis,
             const vision::ContactOptions& contact_options) {
  // Below it u would grow by less than a tenth of the change.
  constexpr double kNegligible = 0.01;
  const double probability = ProbabilityOfDrag(analysis.contacts);
  if (probability < kNegligible || !analysis.plane) return;
  vision::ContactOptions options = KeepPath(analysis, contact_options);
  options.drag_per_px = analysis.contacts.drag_per_px->value;
  AddShared(analysis.contacts, "drag",
            {{FindPlaneContacts(*analysis.plane, options), probability}});
}

namespace {

// The frames at another rate: the same poses, closer in time.
vision::PlaneTrack AtRate(vision::PlaneTrack plane, double factor) {
  plane.frame_interval_s /= factor;
  for (vision::PlaneSample& s : plane.samples) s.time_s /= factor;
  return plane;
}

}  // namespace

void DescribeBudget(Analysis& analysis,
                    const vision::ContactOptions& contact_options) {
  auto& left_out = analysis.scene_model.left_out;
  left_out["uncertainty of the model"] =
      "no second model is fitted; what the flights do not explain widens u";
  const vision::TimeBase& time = analysis.clip.time_base;
  const auto& angle = analysis.contacts.first.contact.approach_angle_rad;
  // The time base has no stated u. What the reader can be told is how much an
  // error of it would do.
  std::string reason =
      time.trusted ? "the rate is the recording's own; its u is not stated"
                   : "the rate is not the recording's own; no u of it is known";
  // A body that is down from the start has no approach to be changed.
  if (analysis.plane && angle && !analysis.contacts.first.contact.from_start) {
    // All speeds follow the rate; the angle feels it through gravity alone.
    constexpr double kPerCent = 0.01;
    const auto faster =
        FindPlaneContacts(AtRate(*analysis.plane, 1.0 + kPerCent),
                          KeepPath(analysis, contact_options));
    const auto& other = faster.first.contact.approach_angle_rad;
    if (other) {
      reason += fmt::format(
          "; 1 % of it is 1 % of all speeds and {:.4f} deg of the approach "
          "angle",
          std::abs(other->value - angle->value) / core::kDegree);
    }
  }
  left_out["uncertainty of the frame rate"] = reason;
  DescribeLeftOut(analysis);
}

Analysis Rejudge(Analysis analysis, const Correction& correction) {
  if (!analysis.track) {
    throw std::invalid_argument("the analysis has no track to be judged");
  }
  MoveOutlines(correction, analysis);
  analysis.outlines_corrected |=
      !correction.moved.empty() || !correction.left_out.empty();
  if (correction.ground) {
    analysis.options.ground = correction.ground;
    const calib::GroundLine& line = *correction.ground;
    analysis.corrections.push_back(fmt::format(
        "ground line through ({:.2f}, {:.2f}) and ({:.2f}, {:.2f}) px",
        line.p1.x_px, line.p1.y_px, line.p2.x_px, line.p2.y_px));
  }
  if (correction.contact_frame) {
    const auto& poses = analysis.track->poses;
    const std::int64_t frame = *correction.contact_frame;
    if (frame < poses.front().frame || frame >= poses.back().frame) {
      throw std::invalid_argument(
          fmt::format("contact_frame is {}, must be in {} .. {}", frame,
                      poses.front().frame, poses.back().frame - 1));
    }
    analysis.options.contact_frame = frame;
    analysis.corrections.push_back(
        fmt::format("touchdown between frames {} and {}", frame, frame + 1));
  }
  // The same steps as of a fresh analysis from here on (analyze.cc), but for
  // the pixels: the stored track stands for them.
  const ClipCalibration camera = FitToClip(analysis.options, analysis.clip);
  analysis.calibration = camera.calibration;
  // Without a stored ground there is nothing to judge by, unless the person
  // gives one.
  if (correction.ground || !analysis.ground) {
    if (!camera.ideal_ground) {
      throw std::invalid_argument("ground is missing, must be two points");
    }
    analysis.ground = *camera.ideal_ground;
  }
  const vision::ContactOptions contact_options =
      MakeContactOptions(analysis.options, camera, analysis.scale);
  analysis.plane = SeenInPlane(
      camera,
      WithStatedSize(ToIdealPicture(camera, *analysis.track), analysis.options),
      *analysis.ground);
  analysis.contacts = FindPlaneContacts(*analysis.plane, contact_options);
  AddLens(analysis, camera, contact_options);
  AddYaw(analysis, camera, contact_options);
  AddDrag(analysis, contact_options);
  DescribeDrag(analysis);
  DescribeBudget(analysis, contact_options);
  // Stored warnings stay. One that the new contacts repeat is not said twice.
  for (const std::string& warning : analysis.contacts.warnings) {
    if (std::find(analysis.warnings.begin(), analysis.warnings.end(),
                  warning) == analysis.warnings.end()) {
      analysis.warnings.push_back(warning);
    }
  }
  analysis.size_conflict = FindSizeConflict(
      ToIdealPicture(camera, *analysis.track).body, analysis.options);
  CheckAnswer(analysis);
  analysis.options_hash = OptionsHash(analysis.options);
  return analysis;
}

}  // namespace touchdown::pipeline
