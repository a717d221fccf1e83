// The body's pose over time, as measured in the image: what the tracker hands
// on. From here on no pixel is needed.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "touchdown/core/estimate.h"
#include "touchdown/core/points.h"
#include "touchdown/core/words.h"

namespace touchdown::vision {

// The body in one frame.
struct Pose {
  std::int64_t frame = 0;  // index in the file
  double time_s = 0.0;     // middle of the exposure
  core::PixelPoint centre;

  // Direction of the long side in the image, from +x towards +y (image y points
  // down), continuous over the track. Of a sphere how far its face has turned,
  // from anywhere; 0, and its u as well, where no mark shows it.
  double angle_rad = 0.0;

  // Standard uncertainties and correlation from the fit: the image noise
  // through the normal equations, widened where residuals exceed the noise.
  double u_x_px = 0.0;
  double u_y_px = 0.0;
  double correlation_xy = 0.0;
  double u_angle_rad = 0.0;

  // Size in this frame over BodyImage's: 1 unless the body moves towards or
  // away from the camera.
  double relative_size = 1.0;

  // Root mean square of the fit's residuals over the expected noise; about 1.
  double misfit = 0.0;
};

// The body's shape in the image, common to all frames.
struct BodyImage {
  core::BodyKind kind = core::BodyKind::kSphere;
  core::Estimate radius_px;      // sphere
  core::Estimate half_long_px;   // rectangle, half sides
  core::Estimate half_short_px;  //
  // What of the half sides (of a sphere the first is the radius) hangs on a
  // gamma that nobody stated and no stated size tells: standard uncertainties
  // of one cause, with its signs, beside the u of the sizes.
  double gamma_long_px = 0.0;
  double gamma_short_px = 0.0;
  // Where the body shows as several parts that move as one, the outline is that
  // of the strongest part, and this is the length of the whole; else 0.
  double whole_px = 0.0;
  double blur_px = 0.0;  // standard deviation of the edge's blur
  // Share of the frame interval in which the shutter is open; 0: not measured,
  // or too short to blur the edge. After Refine.
  double shutter_fraction = 0.0;
  // What outline and poses may be off together in all frames, along any
  // direction of the body, and in angle: a texture hides it.
  double u_common_px = 0.0;
  double u_common_angle_rad = 0.0;
  // The part of u_common_px that changes over an impact: a texture's, since a
  // body that turned has another one at the same side, before another
  // background; and that of outlines beside a stated size, since light or gamma
  // moves each edge by what lies behind it.
  double u_texture_px = 0.0;
  // Of the camera (linear_clip.h), where the outlines show one: poses are those
  // in light, and levels are light's. Absent: the clip's levels are taken.
  std::optional<double> gamma;
  double contrast_dn = 0.0;  // body minus background, median over frames
};

// The half sides, of a sphere the radius, with all of their u.
inline core::Estimate HalfLong(const BodyImage& body) {
  core::Estimate half =
      body.kind == core::BodyKind::kSphere ? body.radius_px : body.half_long_px;
  half.u = std::hypot(half.u, body.gamma_long_px);
  return half;
}
inline core::Estimate HalfShort(const BodyImage& body) {
  if (body.kind == core::BodyKind::kSphere) return HalfLong(body);
  core::Estimate half = body.half_short_px;
  half.u = std::hypot(half.u, body.gamma_short_px);
  return half;
}

struct Track {
  BodyImage body;
  std::vector<Pose> poses;  // by frame; frames without a good fit are missing
  std::int64_t first_frame = 0;  // range searched: [first, last)
  std::int64_t last_frame = 0;
  double frame_interval_s = 0.0;
  bool known_background = true;  // false: the body never left it uncovered
  // More than 1: between two poses that are so many frames apart the path is
  // smooth, and no outline has been fitted yet.
  std::int64_t step = 1;
  // Whether the picture near the ground line is what the body alone makes of
  // it. Else there is a shadow, a reflection or an uneven edge, and the
  // outline's lower part was left out there. After Refine.
  bool near_ground_modelled = false;
  // Whether poses are those of the body's picture, which moves with it: its
  // outlines alone were bad witnesses.
  bool patterned = false;
  // Whether poses are those of two layers (src/tracking/follow_in_layers.h),
  // which leave nothing to Refine.
  bool layered = false;
  // Of a layered track: whether the body's picture is a texture. Else it is
  // flat but for a smooth shading.
  bool textured = false;
  // Whether outlines fitted to the frames tell size and place. Else the body
  // has several parts, and they are those of what moves as one.
  bool outlined = true;
  bool is_predicted = false;    // ClipInfo's: poses may lag behind the body
  bool several_bodies = false;  // another one of like size and contrast moves
  std::vector<std::string> warnings;
};

}  // namespace touchdown::vision
