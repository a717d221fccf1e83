// The half of an analysis that reads no pixel: from a track and a ground line
// to contacts. A track that was stored, or corrected by a person, is judged by
// the same code as one that was just measured.
#pragma once

#include "app/measure/analyze.h"
#include "app/measure/clip_calibration.h"
#include "touchdown/vision/contact/contact.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::pipeline {

// The track in the lens's ideal picture; itself without a lens.
vision::Track ToIdealPicture(const ClipCalibration& camera,
                             const vision::Track& track);

// The track from the ground, in the plane of travel where the calibration tells
// its yaw. `seen`: as ToIdealPicture gives it.
vision::PlaneTrack SeenInPlane(const ClipCalibration& camera,
                               const vision::Track& seen,
                               const calib::GroundLine& ground);

// Whether the body's very centre gets below the line: whatever its outline near
// the line is worth, that is not the ground.
bool PassesThroughGround(const vision::PlaneTrack& plane);

// Whether the contact lies where the track ends: no frame has seen it, and a
// line that the path happens to point at will have one.
bool IsAtTheEnd(const core::Contact& contact, const vision::Track& track);

// Of the samples of `plane`, of which `scale` is that of the ideal picture.
core::Estimate PxPerMetre(const vision::PlaneTrack& plane,
                          const calib::Scale& scale);

// FindContacts with `options` as of the ideal picture: a scale that was
// measured along the ground, or by the body, is that of the plane.
vision::ContactResult FindPlaneContacts(const vision::PlaneTrack& plane,
                                        const vision::ContactOptions& options);

// How contacts are found with these options and this scale.
vision::ContactOptions MakeContactOptions(
    const AnalyzeOptions& options, const ClipCalibration& camera,
    const core::Expected<calib::Scale>& scale);

// Adds what the lens's own uncertainty does to the contacts of `analysis`, of
// which track, plane and contacts are there.
void AddLens(Analysis& analysis, const ClipCalibration& camera,
             const vision::ContactOptions& contact_options);

// Adds what the uncertainty of the calibrated yaw does to the contacts, as the
// line `yaw` of the budgets. Of those of which track, plane and contacts are
// there.
void AddYaw(Analysis& analysis, const ClipCalibration& camera,
            const vision::ContactOptions& contact_options);

// Adds the change that the drag of the flights would make, by its probability,
// as the line `drag` of the budgets: the variance between two models. Nothing
// is corrected by it: lens, parallax and frames of uneven time bend a path
// alike.
void AddDrag(Analysis& analysis, const vision::ContactOptions& contact_options);

// Says in the scene model what the budgets leave out and why: the frame rate,
// with what an error of it would do, and the choice of the model.
void DescribeBudget(Analysis& analysis,
                    const vision::ContactOptions& contact_options);

// What a person changes in an analysis; what is not named stays.
struct Correction {
  std::optional<calib::GroundLine> ground;  // in the image as recorded
  // The body touches down between this frame and the next.
  std::optional<std::int64_t> contact_frame;
  // Outlines moved by hand, in the image, px.
  std::map<std::int64_t, core::PixelPoint> moved;
  std::vector<std::int64_t> left_out;  // frames whose outline is wrong

  bool empty() const {
    return !ground && !contact_frame && moved.empty() && left_out.empty();
  }
};

// How well a person places an outline or a line, px: a careful mouse click.
inline constexpr double kByHand_px = 0.5;

// `analysis` (as replay.h gives it) judged again with what the person changed.
// Its document says what that was. Throws std::invalid_argument naming the
// field where the correction is of frames that are not in the track, or leaves
// fewer than five of them.
Analysis Rejudge(Analysis analysis, const Correction& correction);

}  // namespace touchdown::pipeline
