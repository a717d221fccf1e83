// A lens from views of a board: Z. Zhang, "A flexible new technique for camera
// calibration", PAMI 22 (2000); the minimum by OpenCV's calibrateCamera.
//
// The covariance is that of the normal equations with the boards' poses
// eliminated (Schur complement), times the residuals' variance, and widened
// where the residuals of one view go together (a board that is not flat, a
// print that is not to scale): by how much the sandwich estimate over views
// exceeds it on average, and by the quantile of Student's distribution where
// there are few views.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "touchdown/calib/board.h"
#include "touchdown/calib/lens.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"
#include "touchdown/core/points.h"

namespace touchdown::calib {

// One picture of the board.
struct BoardView {
  std::string name;                      // of the picture, for messages
  std::vector<core::PixelPoint> points;  // as ListBoardPoints(board) lists them
};

struct LensCalibrationOptions {
  // Below it nothing is said: nine numbers and a pose in each view leave too
  // little to check them by. 5: with 3 the fit is possible, but one bad picture
  // cannot be noticed. (Ten and more are wanted: a warning.)
  int least_views = 5;

  // A board seen at an angle is nearer at one side: its scale there is larger.
  // Where no view's scale changes by this share over the board, focal length
  // and distance cannot be told apart. 3 %: at 0.1 px of noise and ten views
  // the focal length would be unknown to 2 %.
  double least_keystone = 0.03;

  // Share of the picture's 8 x 6 cells in which corners were seen. Below a
  // third the distortion of the rest is extrapolated.
  double least_coverage = 1.0 / 3.0;

  // Largest relative standard uncertainty of the focal length. 2 %: its effect
  // on ideal points is second order, but what is worse has no meaning.
  double most_u_focal = 0.02;
};

inline constexpr int kCoverageColumns = 8;
inline constexpr int kCoverageRows = 6;

struct ViewResult {
  std::string name;
  double rms_px = 0.0;    // root mean square distance of its corners
  double most_px = 0.0;   // the largest
  double tilt_rad = 0.0;  // of the board to the picture's plane
};

struct LensCalibration {
  Lens lens;
  LensCovariance covariance = LensCovariance::Zero();
  double rms_px = 0.0;       // root mean square distance, all corners
  double u_corner_px = 0.0;  // of one coordinate of one corner
  std::int64_t degrees_of_freedom = 0;
  double widened = 1.0;  // of the standard uncertainties, for the reasons above
  std::vector<ViewResult> views;
  double coverage = 0.0;  // share of the cells
  // Corners in each cell, row by row.
  std::array<int, static_cast<std::size_t>(kCoverageColumns* kCoverageRows)>
      cells{};
  std::vector<std::string> warnings;  // one sentence each

  // One number of the lens, by its place in kLensNames.
  core::Estimate Parameter(int index) const;
};

// Absent where the set cannot determine a lens: the reason names what is wrong
// with it and what to do. Throws std::invalid_argument if a view has not as
// many points as the board or the picture's size is not positive.
core::Expected<LensCalibration> CalibrateLens(
    const std::vector<BoardView>& views, const Board& board,
    std::int32_t width_px, std::int32_t height_px,
    const LensCalibrationOptions& options = {});

}  // namespace touchdown::calib
