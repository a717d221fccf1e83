// Calibration boards, and finding them in a picture.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "touchdown/core/expected.h"
#include "touchdown/core/frame.h"
#include "touchdown/core/points.h"

namespace touchdown::calib {

enum class BoardKind {
  kChessboard,         // inner corners of squares
  kCircles,            // centres of filled circles in rows and columns
  kAsymmetricCircles,  // every second row is shifted by half a column
};
std::string_view Name(BoardKind kind);  // "chessboard", "circles", "acircles"

// Chessboard: `columns` by `rows` inner corners, `pitch_m` the side of a
// square. Circles: `columns` by `rows` centres, `pitch_m` between neighbours in
// a row; asymmetric ones `columns` in each row, rows pitch_m / 2 apart, pitch_m
// between neighbours in a row (OpenCV's acircles grid).
struct Board {
  BoardKind kind = BoardKind::kChessboard;
  int columns = 0;
  int rows = 0;
  double pitch_m = 0.0;
};

// "chessboard:9x6:25mm", "circles:7x5:20mm" or "acircles:4x11:20mm"; the length
// in mm, cm or m. Throws std::invalid_argument for anything else; ChArUco
// boards are refused by name: reading their markers needs OpenCV's contrib
// modules, which are not linked.
Board ParseBoard(std::string_view text);
std::string Text(const Board& board);  // as ParseBoard takes it

// The board's points in its own plane, row by row, as FindBoard lists them.
std::vector<core::PlanePoint> ListBoardPoints(const Board& board);

// The board's points in the picture, to sub-pixel: chessboard corners by the
// saddle of the levels around them, circles by the centroid of their image.
// Absent, with the reason, where the whole board is not seen. The picture must
// have at least 32 x 32 px.
core::Expected<std::vector<core::PixelPoint>> FindBoard(
    const core::Frame& picture, const Board& board);

}  // namespace touchdown::calib
