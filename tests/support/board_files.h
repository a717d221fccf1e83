// Pictures of a board as a lens of known distortion sees it, as files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>

#include "tests/calib/board_picture.h"
#include "touchdown/calib/board.h"
#include "touchdown/calib/lens.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::testing {

// The lens for pictures of half the size: casting rays takes time.
inline calib::Lens SmallLens() {
  calib::Lens lens = calib::board_picture::TestLens();
  lens.fx_px *= 0.5;
  lens.fy_px *= 0.5;
  lens.cx_px *= 0.5;
  lens.cy_px *= 0.5;
  return lens;
}

// `count` pictures of 320 x 240 of chessboard:7x5:20mm, board_0.png ...
inline void WriteBoardPictures(const std::filesystem::path& folder, int count) {
  const calib::Board board{calib::BoardKind::kChessboard, 7, 5, 0.02};
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> tilt(-0.6, 0.6);
  for (int i = 0; i < count; ++i) {
    const auto pose = calib::board_picture::PoseAt(
        board, SmallLens(), 0.5 + 0.18 * (i % 3 - 1),
        0.5 + 0.18 * (i / 3 % 3 - 1), tilt(engine), tilt(engine), 0.42, 320.0,
        240.0);
    vision::WritePng(
        folder / ("board_" + std::to_string(i) + ".png"),
        calib::board_picture::Picture(board, pose, SmallLens(), 320, 240, 1.0,
                                      static_cast<std::uint64_t>(i))
            .View());
  }
}

}  // namespace touchdown::testing
