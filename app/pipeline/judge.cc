#include "app/pipeline/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "app/pipeline/lens_uncertainty.h"
#include "app/pipeline/options_hash.h"
#include "touchdown/vision/lens_track.h"

namespace touchdown::pipeline {
namespace {

std::vector<vision::Pose>::iterator PoseOf(vision::Track& track,
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

void MoveOutlines(const Correction& correction, Analysis& analysis) {
  vision::Track& track = *analysis.track;
  for (const auto& [frame, by] : correction.moved) {
    if (!std::isfinite(by.x_px) || !std::isfinite(by.y_px)) {
      throw std::invalid_argument(fmt::format(
          "moved.{} is not finite, must be two numbers of pixels", frame));
    }
    const auto pose = PoseOf(track, frame, "moved");
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
    track.poses.erase(PoseOf(track, frame, "left_out"));
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

vision::Track SeenThrough(const ClipCalibration& camera,
                          const vision::Track& track) {
  return camera.lens ? vision::Undistorted(track, *camera.lens) : track;
}

vision::ContactOptions ContactOptionsOf(
    const AnalyzeOptions& options, const ClipCalibration& camera,
    const std::optional<calib::Scale>& scale) {
  vision::ContactOptions out;
  out.gravity_mps2 = camera.gravity_mps2;
  out.scale = scale;
  out.bounce_height_m = options.bounce_height_m;
  out.contact_frame = options.contact_frame;
  return out;
}

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
  AddLensUncertainty(
      analysis.contacts, *camera.lens, analysis.calibration->lens->covariance,
      [&](const calib::Lens& lens) {
        const auto ground = ThroughPoints(seen, lens, ideal);
        if (!ground) return vision::ContactResult{};
        return vision::FindContacts(
            vision::SeenFromGround(vision::Undistorted(*analysis.track, lens),
                                   *ground),
            contact_options);
      });
}

Analysis Rejudge(Analysis analysis, const Correction& correction) {
  if (!analysis.track) {
    throw std::invalid_argument("the analysis has no track to be judged");
  }
  MoveOutlines(correction, analysis);
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
  const ClipCalibration camera = FitToClip(analysis.options, analysis.clip);
  analysis.calibration = camera.calibration;
  if (correction.ground || !analysis.ground) {
    if (!camera.ideal_ground) {
      throw std::invalid_argument("ground is missing, must be two points");
    }
    analysis.ground = camera.ideal_ground;
    analysis.no_ground_reason.clear();
  }
  const vision::ContactOptions contact_options =
      ContactOptionsOf(analysis.options, camera, analysis.scale);
  analysis.plane = vision::SeenFromGround(SeenThrough(camera, *analysis.track),
                                          *analysis.ground);
  analysis.contacts = vision::FindContacts(*analysis.plane, contact_options);
  AddLens(analysis, camera, contact_options);
  for (const std::string& warning : analysis.contacts.warnings) {
    if (std::find(analysis.warnings.begin(), analysis.warnings.end(),
                  warning) == analysis.warnings.end()) {
      analysis.warnings.push_back(warning);
    }
  }
  analysis.options_hash = OptionsHash(analysis.options);
  return analysis;
}

}  // namespace touchdown::pipeline
