// The declared design of the accuracy table: small rendered clips with exact
// truth, factor levels drawn evenly by seed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/pipeline/filmed.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/estimate.h"

namespace touchdown::accuracy {

// The regular part has what a careful set-up gives; each case of the hard part
// has one thing that a careful set-up avoids.
enum class Hardship {
  kNone,
  kSmall,         // 8 px
  kDim,           // contrast of 4 sigma of the noise
  kFewFrames,     // 3 to 5 frames on either side of the contact
  kFast,          // moves by 0.5 to 2 body lengths a frame
  kLongExposure,  // open for 0.9 of the frame interval
  kTexture,       // ground of 10 % texture
  kSlow,          // 0.2 to 0.4 px a frame
  kShaded,        // a shaded body with a highlight
  kShadow,        // its shadow touches it
  kFlicker,       // mains: 10 %
  kWavy,          // the ground's edge goes up and down by 1 px
  kSpecks,        // five specks fly about
  kObstacle,      // it comes out from behind something
  kPictured,      // a picture on its face; a ball spins
};
const char* Name(Hardship hardship);
inline constexpr Hardship kHardships[] = {
    Hardship::kSmall,    Hardship::kDim,          Hardship::kFewFrames,
    Hardship::kFast,     Hardship::kLongExposure, Hardship::kTexture,
    Hardship::kSlow,     Hardship::kShaded,       Hardship::kShadow,
    Hardship::kFlicker,  Hardship::kWavy,         Hardship::kSpecks,
    Hardship::kObstacle, Hardship::kPictured};

// Levels of one clip, as chosen; the table is broken down by them.
struct Levels {
  Hardship hardship = Hardship::kNone;
  core::BodyKind kind = core::BodyKind::kSphere;
  double size_px = 24.0;    // diameter, or the long side
  double contrast = 0.5;    // of full scale; < 0: body darker
  double noise = 0.004;     // of full scale
  double blur_px = 0.8;     // of the lens
  double speed_px = 2.0;    // a frame, at contact
  double angle_deg = 20.0;  // approach
  double open = 0.1;        // exposure over frame interval
  int frames_before = 20;
  int frames_after = 12;
  int bit_depth = 8;
  double hidden = 0.5;  // of the approach, behind kObstacle's obstacle
};

struct Case {
  std::uint64_t seed = 0;  // of the noise; also names the case
  Levels levels;
  pipeline::filmed::Film film;
  // What `analyze` is told: the true scale but for its uncertainty. Gravity is
  // standard gravity there, and in the film what it may be somewhere on earth.
  double told_px_per_m = 0.0;
  // Half the long side, or the radius, and half the short one: of a pictured
  // face, whose outline alone does not tell them.
  std::optional<core::Estimate> told_half_long_m;
  std::optional<core::Estimate> told_half_short_m;
  std::optional<double> rise_m;  // of a state's case: the greatest gap
};

// Relative u of what is told beside the pixels: the scale, local gravity
// (vision/contact.h), and where it is told the size (a calliper).
inline constexpr double kScaleRelativeU = 1e-4;
inline constexpr double kGravityRelativeU = 0.002;
inline constexpr double kSizeRelativeU = 0.001;

// Case `index` of the regular part, or of one hardship. The same index gives
// the same case, whatever else is drawn.
Case Draw(std::uint64_t index, Hardship hardship);

// Case `index` with these levels; what they leave open is drawn by the index.
// frames_after is the most: a block's film ends before its other corner comes
// down. Throws std::invalid_argument where that leaves less than two frames.
Case DrawAt(std::uint64_t index, const Levels& levels);

// Case `index` of the states: a sphere that stays down (one in four) or rises
// by 0.05 to 10 times the default bounce height, filmed until after its apex.
Case DrawRebound(std::uint64_t index);

}  // namespace touchdown::accuracy
