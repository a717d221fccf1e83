// A lens from pictures of a board, as files.
#include "app/measure/board_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>

#include "tests/support/board_files.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"

namespace touchdown::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const calib::Board kBoard{calib::BoardKind::kChessboard, 7, 5, 0.02};

class BoardPicturesTest : public ::testing::Test {
 protected:
  BoardPicturesTest() {
    touchdown::testing::WriteBoardPictures(folder.path(), 6);
    folder.Write("notes.txt", "x");
  }
  touchdown::testing::TemporaryFolder folder;
};

TEST_F(BoardPicturesTest, TellTheLensTheyWereTakenWith) {
  const auto pictures = ListPictures(folder.path());
  ASSERT_EQ(pictures.size(), 6u);
  std::vector<double> shares;
  const BoardPictures found =
      FindBoards(pictures, kBoard, calib::SensorCorner{2, 4},
                 [&](double share) { shares.push_back(share); });
  EXPECT_EQ(found.views.size(), 6u);
  EXPECT_EQ(found.picture.width_px, 320);
  EXPECT_EQ(found.picture.corner, (calib::SensorCorner{2, 4}));
  ASSERT_EQ(shares.size(), 6u);
  EXPECT_DOUBLE_EQ(shares.back(), 1.0);
  const calib::LensCalibration lens = CalibrateBoardLens(found, kBoard);
  const core::Estimate focal = lens.Parameter(0);
  EXPECT_NEAR(focal.value, touchdown::testing::SmallLens().fx_px,
              4.0 * focal.u);
  const calib::LensRecord record = MakeLensRecord(lens, kBoard);
  EXPECT_EQ(record.board, "chessboard:7x5:20mm");
  EXPECT_EQ(record.views.size(), 6u);
  EXPECT_EQ(record.rms_px, lens.rms_px);
}

TEST_F(BoardPicturesTest, SayWhichShowNoBoard) {
  vision::Image blank;
  blank.width_px = 320;
  blank.height_px = 240;
  blank.bit_depth = 8;
  blank.pixels.assign(320 * 240, std::byte{128});
  vision::WritePng(folder / "blank.png", blank.View());
  const BoardPictures found = FindBoards(ListPictures(folder.path()), kBoard);
  EXPECT_THAT(found.without, ElementsAre("blank.png"));
  const std::vector<std::filesystem::path> only = {folder / "blank.png"};
  EXPECT_THAT([&] { CalibrateBoardLens(FindBoards(only, kBoard), kBoard); },
              ThrowsMessage<core::InputError>(
                  HasSubstr("no whole chessboard:7x5:20mm in 1 of 1 pictures, "
                            "blank.png first")));
}

TEST_F(BoardPicturesTest, AreOfOneSize) {
  vision::Image other;
  other.width_px = 64;
  other.height_px = 64;
  other.bit_depth = 8;
  other.pixels.assign(64 * 64, std::byte{128});
  vision::WritePng(folder / "z.png", other.View());
  EXPECT_THAT([&] { FindBoards(ListPictures(folder.path()), kBoard); },
              ThrowsMessage<core::InputError>(
                  HasSubstr("all pictures must be of one camera")));
  EXPECT_THROW(ListPictures(folder / "none"), core::InputError);
}

}  // namespace
}  // namespace touchdown::pipeline
