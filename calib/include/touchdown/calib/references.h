// Scale, slope and attitude of the plane of travel from things of known length
// or direction in a picture: a rule, a plumb line, a board on the ground.
// Points are as seen in the picture; where a lens is given they are undistorted
// first, and the results are those of its ideal picture.
#pragma once

#include <optional>
#include <vector>

#include "touchdown/calib/board.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/calib/lens.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"
#include "touchdown/core/points.h"

namespace touchdown::calib {

// Two points that a person or a detector has marked, each coordinate good to
// u_point_px.
struct MarkedPair {
  core::PixelPoint p1;
  core::PixelPoint p2;
  double u_point_px = 0.5;  // a careful mouse click
};

// px_per_m = |p2 - p1| / length, with u of the points and of the length.
// Throws std::invalid_argument if the points coincide, the length is not
// positive or the lens has no ideal point for one of them.
ScaleRecord MeasureScale(const MarkedPair& pair, const core::Estimate& length_m,
                         const std::optional<Lens>& lens = std::nullopt);

// What `scale` makes of another known length: measured minus known, with u of
// everything. Compatible with 0 where the calibration is right. Throws as
// MeasureScale.
core::Estimate CheckError(const ScaleRecord& scale, const MarkedPair& pair,
                          const core::Estimate& length_m,
                          const std::optional<Lens>& lens = std::nullopt);

// Slope of the ground to the level: positive where it rises to the right in
// the picture. `plumb` is a line that hangs freely, top and bottom in either
// order. Throws as MeasureScale.
core::Estimate MeasureSlope(const MarkedPair& ground, const MarkedPair& plumb,
                            const std::optional<Lens>& lens = std::nullopt);

// A board that lies flat on the ground, its rows along the direction of
// travel, its middle row under the body's path.
struct BoardOnGround {
  GroundRecord ground;       // with the yaw
  core::Estimate px_per_m;   // along the middle row, in the ideal picture
  core::Estimate pitch_rad;  // camera's axis to the ground; positive downwards
  double rms_px = 0.0;       // of the board's points about the pose found
};

// The board's pose by least squares (OpenCV's solvePnP), u from its residuals.
// The yaw is the angle of the rows to the picture's plane, positive where their
// right end is farther away: seen lengths along the ground are shorter by its
// cosine. Absent, with the reason, where the board is seen edge-on or the fit
// fails.
core::Expected<BoardOnGround> LocateBoard(
    const std::vector<core::PixelPoint>& points, const Board& board,
    const Lens& lens);

}  // namespace touchdown::calib
