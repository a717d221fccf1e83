#include "touchdown/calib/board.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

namespace touchdown::calib {
namespace {

// How a board is written; part of every message about one that is not.
constexpr const char* kForm =
    "must be chessboard:COLUMNSxROWS:SQUARE as in chessboard:9x6:25mm (inner "
    "corners), circles:7x5:20mm or acircles:4x11:20mm (centres)";

[[noreturn]] void Refuse(std::string_view text) {
  throw std::invalid_argument(fmt::format("board is '{}', {}", text, kForm));
}

template <class T>
std::optional<T> ReadNumber(std::string_view text) {
  T value{};
  const auto end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

std::optional<double> ReadLength(std::string_view text) {
  double unit = 0.0;
  std::size_t letters = 2;
  if (text.ends_with("mm")) {
    unit = 1e-3;
  } else if (text.ends_with("cm")) {
    unit = 1e-2;
  } else if (text.ends_with("m")) {
    unit = 1.0;
    letters = 1;
  } else {
    return std::nullopt;
  }
  const auto number = ReadNumber<double>(text.substr(0, text.size() - letters));
  if (!number || !(*number > 0.0) || !std::isfinite(*number)) {
    return std::nullopt;
  }
  return *number * unit;
}

// Levels as floats, and as 8 bits stretched to the picture's own range.
struct Levels {
  cv::Mat exact;  // CV_32F
  cv::Mat eight;  // CV_8U
};

Levels MeasureLevels(const core::Frame& picture) {
  const cv::Mat view(picture.height_px, picture.width_px,
                     picture.is_16_bit() ? CV_16UC1 : CV_8UC1,
                     // OpenCV has no view of constant pixels; it only reads.
                     const_cast<std::byte*>(picture.data),
                     static_cast<std::size_t>(picture.stride_bytes));
  Levels levels;
  view.convertTo(levels.exact, CV_32F);
  cv::normalize(view, levels.eight, 0, 255, cv::NORM_MINMAX, CV_8U);
  return levels;
}

// Half the window around a corner: as large as its squares allow (more pixels,
// less noise), a third of the shortest distance between neighbours, 2 to 10.
int ChooseWindow(const std::vector<cv::Point2f>& corners, const Board& board) {
  double shortest = 1e9;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const auto i = static_cast<std::size_t>(row) *
                         static_cast<std::size_t>(board.columns) +
                     static_cast<std::size_t>(column);
      if (column + 1 < board.columns) {
        shortest = std::min(shortest, cv::norm(corners[i] - corners[i + 1]));
      }
      if (row + 1 < board.rows) {
        const auto below = i + static_cast<std::size_t>(board.columns);
        shortest = std::min(shortest, cv::norm(corners[i] - corners[below]));
      }
    }
  }
  return std::clamp(static_cast<int>(shortest / 3.0), 2, 10);
}

core::Expected<std::vector<cv::Point2f>> FindChessboard(const Levels& levels,
                                                        const Board& board) {
  const cv::Size size(board.columns, board.rows);
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCorners(
          levels.eight, size, corners,
          cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE) &&
      !cv::findChessboardCornersSB(
          levels.eight, size, corners,
          cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE)) {
    return core::AbsentBecause(
        fmt::format("no chessboard of {}x{} inner corners is seen whole",
                    board.columns, board.rows));
  }
  const int half = ChooseWindow(corners, board);
  cv::cornerSubPix(
      levels.exact, corners, cv::Size(half, half), cv::Size(-1, -1),
      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60,
                       1e-4));
  return corners;
}

// A blob of one sign against its surroundings.
struct Blob {
  cv::Point2f centre;
  double area_px = 0.0;
};

// Filled ellipses darker than their surroundings: by local threshold, then the
// centroid of level differences over each one and its rim.
std::vector<Blob> Blobs(const Levels& levels, int block) {
  cv::Mat dark;
  // Of 256: a circle is darker than its surroundings by more than noise.
  constexpr double kLeastContrast = 10.0;
  cv::adaptiveThreshold(levels.eight, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C,
                        cv::THRESH_BINARY_INV, block, kLeastContrast);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(dark, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  std::vector<Blob> blobs;
  for (const auto& outline : outlines) {
    if (outline.size() < 12) continue;
    const double area = cv::contourArea(outline);
    if (area < 20.0) continue;
    // An ellipse fills pi/4 of its rotated box.
    const cv::RotatedRect box = cv::minAreaRect(outline);
    const double filled =
        area / std::max(1.0, static_cast<double>(box.size.area()));
    const double ratio =
        static_cast<double>(std::min(box.size.width, box.size.height)) /
        static_cast<double>(std::max(box.size.width, box.size.height));
    if (filled < 0.62 || filled > 0.90 || ratio < 0.3) continue;
    const cv::Rect inside(2, 2, levels.exact.cols - 4, levels.exact.rows - 4);
    const cv::Rect around = cv::boundingRect(outline);
    const cv::Rect wide(around.x - 2, around.y - 2, around.width + 4,
                        around.height + 4);
    if ((wide & inside) != wide) continue;
    // The rim's level is the surroundings'.
    const cv::Mat window = levels.exact(wide);
    cv::Mat mask = cv::Mat::zeros(window.size(), CV_8U);
    cv::drawContours(mask, std::vector<std::vector<cv::Point>>{outline}, 0,
                     cv::Scalar(255), cv::FILLED, cv::LINE_8, cv::noArray(), 0,
                     cv::Point(-wide.x, -wide.y));
    cv::Mat grown;
    cv::dilate(mask, grown, cv::Mat(), cv::Point(-1, -1), 2);
    const double light = cv::mean(window, ~grown)[0];
    const double level = cv::mean(window, mask)[0];
    if (!(light > level)) continue;
    double s = 0.0;
    double sx = 0.0;
    double sy = 0.0;
    for (int y = 0; y < window.rows; ++y) {
      for (int x = 0; x < window.cols; ++x) {
        if (grown.at<std::uint8_t>(y, x) == 0) continue;
        const double w = light - static_cast<double>(window.at<float>(y, x));
        s += w;
        sx += w * x;
        sy += w * y;
      }
    }
    if (!(s > 0.0)) continue;
    blobs.push_back({{static_cast<float>(wide.x + sx / s),
                      static_cast<float>(wide.y + sy / s)},
                     area});
  }
  return blobs;
}

core::Expected<std::vector<cv::Point2f>> FindCircles(const Levels& levels,
                                                     const Board& board) {
  const cv::Size size(board.columns, board.rows);
  const int flags = board.kind == BoardKind::kCircles
                        ? cv::CALIB_CB_SYMMETRIC_GRID
                        : cv::CALIB_CB_ASYMMETRIC_GRID;
  const auto wanted = static_cast<std::size_t>(board.columns) *
                      static_cast<std::size_t>(board.rows);
  const int side = std::min(levels.eight.cols, levels.eight.rows);
  for (const int part : {6, 12, 3}) {
    std::vector<Blob> blobs = Blobs(levels, std::max(5, side / part) | 1);
    if (blobs.size() < wanted) continue;
    // Circles of one board are alike: those near the median size.
    std::vector<double> areas;
    areas.reserve(blobs.size());
    for (const Blob& blob : blobs) areas.push_back(blob.area_px);
    const auto middle =
        areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
    std::nth_element(areas.begin(), middle, areas.end());
    const double median = *middle;
    std::vector<cv::Point2f> points;
    for (const Blob& blob : blobs) {
      if (blob.area_px > 0.25 * median && blob.area_px < 4.0 * median) {
        points.push_back(blob.centre);
      }
    }
    std::vector<cv::Point2f> centres;
    // Without a blob detector it takes our points.
    for (const int clustering :
         {0, static_cast<int>(cv::CALIB_CB_CLUSTERING)}) {
      if (points.size() >= wanted &&
          cv::findCirclesGrid(points, size, centres, flags | clustering,
                              cv::Ptr<cv::FeatureDetector>(),
                              cv::CirclesGridFinderParameters())) {
        return centres;
      }
    }
  }
  return core::AbsentBecause(
      fmt::format("no grid of {}x{} dark circles is seen whole", board.columns,
                  board.rows));
}

}  // namespace

std::string_view Name(BoardKind kind) {
  switch (kind) {
    case BoardKind::kChessboard:
      return "chessboard";
    case BoardKind::kCircles:
      return "circles";
    case BoardKind::kAsymmetricCircles:
      return "acircles";
  }
  return "?";
}

Board ParseBoard(std::string_view text) {
  const std::size_t first = text.find(':');
  if (first == std::string_view::npos) Refuse(text);
  const std::string_view kind = text.substr(0, first);
  if (kind == "charuco") {
    throw std::invalid_argument(fmt::format(
        "board is '{}': ChArUco boards cannot be read (their markers need "
        "OpenCV's contrib modules, which this program does not link); use a "
        "plain chessboard or circles",
        text));
  }
  Board board;
  if (kind == "chessboard") {
    board.kind = BoardKind::kChessboard;
  } else if (kind == "circles") {
    board.kind = BoardKind::kCircles;
  } else if (kind == "acircles") {
    board.kind = BoardKind::kAsymmetricCircles;
  } else {
    Refuse(text);
  }
  const std::string_view rest = text.substr(first + 1);
  const std::size_t second = rest.find(':');
  const std::size_t times = rest.find('x');
  if (second == std::string_view::npos || times == std::string_view::npos ||
      times > second) {
    Refuse(text);
  }
  const auto columns = ReadNumber<int>(rest.substr(0, times));
  const auto rows = ReadNumber<int>(rest.substr(times + 1, second - times - 1));
  const auto pitch = ReadLength(rest.substr(second + 1));
  if (!columns || !rows || !pitch) Refuse(text);
  // Columns and rows: more are a typing error. Not studied.
  constexpr int kMaxCount = 100;
  if (*columns < 3 || *rows < 3 || *columns > kMaxCount || *rows > kMaxCount) {
    throw std::invalid_argument(fmt::format(
        "board is '{}', columns and rows must be 3 to {}", text, kMaxCount));
  }
  board.columns = *columns;
  board.rows = *rows;
  board.pitch_m = *pitch;
  return board;
}

std::string Text(const Board& board) {
  return fmt::format("{}:{}x{}:{:.6g}mm", Name(board.kind), board.columns,
                     board.rows, board.pitch_m * 1e3);
}

std::vector<core::PlanePoint> ListBoardPoints(const Board& board) {
  std::vector<core::PlanePoint> points;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      if (board.kind == BoardKind::kAsymmetricCircles) {
        points.push_back({(column + 0.5 * (row % 2)) * board.pitch_m,
                          0.5 * row * board.pitch_m});
      } else {
        points.push_back({column * board.pitch_m, row * board.pitch_m});
      }
    }
  }
  return points;
}

core::Expected<std::vector<core::PixelPoint>> FindBoard(
    const core::Frame& picture, const Board& board) {
  // px: a smaller picture shows no board's corners. Not studied.
  constexpr std::int32_t kMinSide_px = 32;
  if (picture.width_px < kMinSide_px || picture.height_px < kMinSide_px) {
    return core::AbsentBecause("the picture is smaller than 32 x 32 px");
  }
  const Levels levels = MeasureLevels(picture);
  const auto found = board.kind == BoardKind::kChessboard
                         ? FindChessboard(levels, board)
                         : FindCircles(levels, board);
  if (!found) return tl::unexpected(found.error());
  std::vector<core::PixelPoint> points;
  points.reserve(found->size());
  for (const cv::Point2f& p : *found) {
    points.push_back({static_cast<double>(p.x) + picture.origin_x_px,
                      static_cast<double>(p.y) + picture.origin_y_px});
  }
  return points;
}

}  // namespace touchdown::calib
