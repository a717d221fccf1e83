#include "touchdown/calib/board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "tests/calib/board_picture.h"

namespace touchdown::calib {
namespace {

using board_picture::Picture;
using board_picture::PoseAt;
using board_picture::Seen;
using board_picture::TestLens;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(ParseBoard, ReadsWhatTextWrites) {
  for (const char* text :
       {"chessboard:9x6:25mm", "circles:7x5:20mm", "acircles:4x11:20mm"}) {
    EXPECT_EQ(Text(ParseBoard(text)), text);
  }
  EXPECT_DOUBLE_EQ(ParseBoard("chessboard:9x6:2.5cm").pitch_m, 0.025);
  EXPECT_DOUBLE_EQ(ParseBoard("chessboard:9x6:0.025m").pitch_m, 0.025);
}

TEST(ParseBoard, RefusesInOneSentence) {
  for (const char* text :
       {"", "chessboard", "chessboard:9x6", "chessboard:9x6:25",
        "chessboard:9x6:-25mm", "chessboard:2x6:25mm", "chessboard:9x1000:25mm",
        "dots:9x6:25mm", "chessboard:9:6x25mm", "chessboard:axb:25mm"}) {
    EXPECT_THROW(ParseBoard(text), std::invalid_argument) << text;
  }
  EXPECT_THAT([] { ParseBoard("charuco:9x6:25mm:18mm"); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("ChArUco boards cannot be read")));
}

// The points found lie where the board was put, whichever corner they start
// from.
void ExpectFound(const std::string& text, double size, double tolerance_px) {
  const Board board = ParseBoard(text);
  const auto pose = PoseAt(board, TestLens(), 0.45, 0.52, 0.3, -0.35, size);
  const vision::Image image = Picture(board, pose, TestLens(), 640, 480, 1.5);
  const auto found = FindBoard(image.View(), board);
  ASSERT_TRUE(found) << text << ": " << found.error().reason;
  const auto truth = Seen(board, pose, TestLens());
  ASSERT_EQ(found->size(), truth.size());
  const auto rms = [&](bool reversed) {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const core::PixelPoint& p = (*found)[reversed ? truth.size() - 1 - i : i];
      sum += std::pow(p.x_px - truth[i].x_px, 2) +
             std::pow(p.y_px - truth[i].y_px, 2);
    }
    return std::sqrt(sum / static_cast<double>(truth.size()));
  };
  EXPECT_LT(std::min(rms(false), rms(true)), tolerance_px) << text;
}

TEST(FindBoard, ChessboardToSubPixel) {
  // The picture's rays are a quarter of a pixel apart: its own edges are good
  // to 0.07 px.
  ExpectFound("chessboard:9x6:25mm", 0.55, 0.1);
}

// The centre of a circle's image is not the image of its centre: perspective
// moves it by hundredths of a pixel.
TEST(FindBoard, CirclesToSubPixel) {
  ExpectFound("circles:7x5:20mm", 0.55, 0.15);
}
TEST(FindBoard, AsymmetricCirclesToSubPixel) {
  ExpectFound("acircles:4x11:40mm", 0.35, 0.15);
}

TEST(FindBoard, SaysWhatIsNotSeen) {
  const Board board = ParseBoard("chessboard:9x6:25mm");
  const auto pose = PoseAt(board, TestLens(), 0.95, 0.5, 0.0, 0.0, 0.5);
  const auto found = FindBoard(Picture(board, pose, TestLens()).View(), board);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().reason, HasSubstr("9x6 inner corners"));
  vision::Image tiny;
  tiny.width_px = tiny.height_px = 20;
  tiny.pixels.resize(400);
  EXPECT_FALSE(FindBoard(tiny.View(), board));
}

TEST(ListBoardPoints, AsymmetricRowsAreShifted) {
  const auto points = ListBoardPoints(ParseBoard("acircles:4x11:40mm"));
  ASSERT_EQ(points.size(), 44u);
  EXPECT_DOUBLE_EQ(points[4].x_m, 0.02);
  EXPECT_DOUBLE_EQ(points[4].y_m, 0.02);
}

}  // namespace
}  // namespace touchdown::calib
