// The track seen from the ground line. Lengths in px along and above the line,
// so that no scale is needed yet; x' runs in the direction of travel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "touchdown/calib/plane.h"
#include "touchdown/core/words.h"
#include "touchdown/vision/contact/plane_yaw.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

struct PlaneSample {
  std::int64_t frame = 0;
  double time_s = 0.0;
  double along_px = 0.0;   // of the centre, in the direction of travel
  double height_px = 0.0;  // of the centre above the ground line
  double u_along_px = 0.0;
  double u_height_px = 0.0;

  // Inclination of the long side to the ground, positive with the leading end
  // up; continuous over the track. Of a sphere how far its face has turned in
  // that sense, from anywhere (ShowsTurn).
  double face_rad = 0.0;
  double u_face_rad = 0.0;

  // Height of the lowest outline point above the line, with the uncertainty of
  // the pose alone (that of the line is common to all frames: GroundLine).
  double gap_px = 0.0;
  double u_gap_px = 0.0;
};

struct PlaneTrack {
  core::BodyKind kind = core::BodyKind::kSphere;
  double half_long_px = 0.0;    // rectangle; for a sphere both are the radius
  double half_short_px = 0.0;   //
  double u_half_px = 0.0;       // of the size
  double gamma_long_px = 0.0;   // BodyImage's
  double gamma_short_px = 0.0;  //
  double u_common_px = 0.0;     // BodyImage's, of all poses together
  double u_common_face_rad = 0.0;
  double u_texture_px = 0.0;
  double blur_px = 0.0;
  bool is_predicted = false;  // ClipInfo's
  double size_px = 0.0;       // of the whole body: diameter or long side
  int direction = 1;          // +1: travels to the right in the image, -1: left
  double frame_interval_s = 0.0;
  double exposure = 1.0;  // of a frame interval; 1: all of it, or not measured
  std::int64_t last_frame = 0;  // one past the last frame of the range
  calib::GroundLine ground;
  std::vector<PlaneSample> samples;  // by time

  // Where the plane of travel is turned: px of the samples and sizes are those
  // of the plane at the ground's reference point (plane_yaw.h).
  std::optional<PlaneYaw> yaw;
  // px here over a px of the image: of a length along the ground at its
  // reference point, and of the body's size. 1 where there is no yaw.
  double along_stretch = 1.0;
  double size_stretch = 1.0;
};

// Whether face angles are measured: of a sphere only where marks show them.
inline bool ShowsTurn(const PlaneTrack& track) {
  return track.kind == core::BodyKind::kRectangle ||
         (!track.samples.empty() && track.samples.front().u_face_rad > 0.0);
}

// Seen from `ground`, in the plane of travel where its yaw is known. The
// direction of travel is that of the whole displacement; right where there is
// none. Throws as MakeYawedView does.
PlaneTrack SeenFromGround(const Track& track, const calib::GroundLine& ground,
                          const std::optional<PlaneYaw>& yaw = std::nullopt);

// Samples that follow each other.
struct SampleRange {
  std::size_t begin = 0;
  std::size_t end = 0;  // one past the last
  std::size_t size() const { return end - begin; }
};
inline std::span<const PlaneSample> SelectSamples(const PlaneTrack& track,
                                                  const SampleRange& range) {
  return std::span(track.samples).subspan(range.begin, range.size());
}

// A point of the plane, in the image.
core::PixelPoint ToImage(const PlaneTrack& track, double along_px,
                         double height_px);

// Height of a centre above the lowest point of its outline: the radius, or
// a |sin(face)| + b |cos(face)| for half sides a, b.
double SupportHeight(const PlaneTrack& track, double face_rad);

// The lowest point of a rectangle at `face_rad`, from the centre, along x'.
// (Its height is -SupportHeight.) 0 for a sphere and for a flush landing.
double LowestPointOffset(const PlaneTrack& track, double face_rad);

// Standard uncertainty of a corner's direction from the centre, of what a gamma
// does to both half sides a, b alike:  |a db - b da| / (a^2 + b^2).
double CornerTurnByGamma(const PlaneTrack& track);

}  // namespace touchdown::vision
