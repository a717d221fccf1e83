#include "detection/shape_along_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace touchdown::vision {
namespace {

// E where nothing is known (still_layer.h).
constexpr double kUnknown = 0.5;

// Of the cell at this place. Nothing is known beyond the picture.
double ChangeAt(const cv::Mat& change, double x, double y) {
  const auto column = static_cast<int>(std::lround(x));
  const auto row = static_cast<int>(std::lround(y));
  if (column < 0 || row < 0 || column >= change.cols || row >= change.rows) {
    return kUnknown;
  }
  return static_cast<double>(change.at<float>(row, column));
}

// Half of the grid's cells along a side, as long as the side is: a part shows
// the whole in some rounds.
int GridReach(double side) {
  constexpr double kLeast = 4.0;  // of a small body's first guess
  return static_cast<int>(std::ceil(std::max(side, kLeast)));
}

// V on a grid of cells about the body's middle, doubles.
cv::Mat MeasureMeanChange(const PathSearch& in, const FoundPath& path) {
  const int reach_x = GridReach(in.shape.long_side);
  const int reach_y = GridReach(in.shape.short_side);
  cv::Mat above(2 * reach_y + 1, 2 * reach_x + 1, CV_64F, cv::Scalar(0.0));
  const cv::Rect whole({0, 0}, path.still.level.size());
  const double share = 1.0 / static_cast<double>(path.places.size());
  for (std::size_t t = 0; t < path.places.size(); ++t) {
    const cv::Mat change =
        ComputeChange(path.still, in.sampled.pictures[t], in.scale, whole);
    const PlacedShape& at = path.places[t];
    const double cosine = std::cos(at.angle_rad);
    const double sine = std::sin(at.angle_rad);
    for (int row = 0; row < above.rows; ++row) {
      auto* const of_row = above.ptr<double>(row);
      const double across = row - reach_y;
      for (int column = 0; column < above.cols; ++column) {
        const double along = column - reach_x;
        of_row[column] +=
            share *
            (ChangeAt(change, at.centre.x_px + cosine * along - sine * across,
                      at.centre.y_px + sine * along + cosine * across) -
             kUnknown);
      }
    }
  }
  return above;
}

// The rectangle of cells with the largest sum (Kadane's search over columns,
// for each pair of rows).
cv::Rect LargestSum(const cv::Mat& above) {
  cv::Rect best;
  double most = 0.0;
  std::vector<double> column_sum(static_cast<std::size_t>(above.cols));
  for (int top = 0; top < above.rows; ++top) {
    std::fill(column_sum.begin(), column_sum.end(), 0.0);
    for (int bottom = top; bottom < above.rows; ++bottom) {
      const auto* const row = above.ptr<double>(bottom);
      double sum = 0.0;
      int left = 0;
      for (int column = 0; column < above.cols; ++column) {
        double& of_column = column_sum[static_cast<std::size_t>(column)];
        of_column += row[column];
        if (sum <= 0.0) {
          sum = 0.0;
          left = column;
        }
        sum += of_column;
        if (sum > most) {
          most = sum;
          best = {left, top, column - left + 1, bottom - top + 1};
        }
      }
    }
  }
  return best;
}

std::optional<KnownShape> FitRectangle(const cv::Mat& above) {
  const cv::Size sides = LargestSum(above).size();
  if (sides.empty()) return std::nullopt;
  return KnownShape{core::BodyKind::kRectangle,
                    static_cast<double>(std::max(sides.width, sides.height)),
                    static_cast<double>(std::min(sides.width, sides.height))};
}

std::optional<KnownShape> FitDisc(const cv::Mat& above) {
  // V by the whole cells that its place is off the middle.
  const int middle_x = above.cols / 2;
  const int middle_y = above.rows / 2;
  const int reach = std::min(middle_x, middle_y);
  std::vector<double> at_radius(static_cast<std::size_t>(reach) + 1, 0.0);
  for (int y = 0; y < above.rows; ++y) {
    for (int x = 0; x < above.cols; ++x) {
      const auto radius = static_cast<std::size_t>(
          std::ceil(std::hypot(x - middle_x, y - middle_y)));
      if (radius < at_radius.size())
        at_radius[radius] += above.at<double>(y, x);
    }
  }
  double sum = at_radius.front();
  double most = 0.0;
  std::size_t best = 0;
  for (std::size_t radius = 1; radius < at_radius.size(); ++radius) {
    sum += at_radius[radius];
    if (sum <= most) continue;
    most = sum;
    best = radius;
  }
  if (best == 0) return std::nullopt;
  const double diameter = 2.0 * static_cast<double>(best) + 1.0;
  return KnownShape{core::BodyKind::kSphere, diameter, diameter};
}

}  // namespace

std::optional<KnownShape> FitShapeAlongPath(const PathSearch& in,
                                            const FoundPath& path) {
  const cv::Mat above = MeasureMeanChange(in, path);
  return in.shape.kind == core::BodyKind::kSphere ? FitDisc(above)
                                                  : FitRectangle(above);
}

}  // namespace touchdown::vision
