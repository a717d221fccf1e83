// A lens from pictures of a board: what `touchdown calibrate lens` and the
// review page do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "touchdown/calib/board.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/calib/lens_calibration.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::pipeline {

// One picture: a still image, or frame `frame` of a clip.
struct StillPicture {
  vision::Image image;
  std::optional<calib::SensorCorner> corner;  // where the file says it
};
// Throws core::InputError; std::invalid_argument for a frame that is not there.
StillPicture ReadPicture(const std::filesystem::path& path, std::int64_t frame);

// The pictures of a folder, by their names.
std::vector<std::filesystem::path> ListPictures(
    const std::filesystem::path& folder);

struct BoardPictures {
  calib::Picture picture;
  std::vector<calib::BoardView> views;
  std::vector<std::string> without;  // names of those that show no whole board
};

// Looks for the board in each of `images` (at least one). `corner`: of the
// pictures on the sensor, where it is known better than the files say.
// `progress` may be empty. Throws core::InputError for a picture that cannot be
// read or is of another size than the first.
BoardPictures FindBoards(
    std::span<const std::filesystem::path> images, const calib::Board& board,
    const std::optional<calib::SensorCorner>& corner = {},
    const std::function<void(double share)>& progress = {});

// The lens that these pictures tell. Throws core::InputError with the reason
// where they tell none.
calib::LensCalibration CalibrateBoardLens(const BoardPictures& pictures,
                                          const calib::Board& board);

// As a calibration file keeps it.
calib::LensRecord MakeLensRecord(const calib::LensCalibration& lens,
                                 const calib::Board& board);

}  // namespace touchdown::pipeline
