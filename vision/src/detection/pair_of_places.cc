#include "detection/pair_of_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace touchdown::vision {
namespace {

// A place's mask, and the cells of it that are beyond the picture.
struct PlacedMask {
  cv::Mat mask;
  double beyond = 0.0;
};

PlacedMask PlaceMask(const cv::Mat& change, const KnownShape& shape,
                     const PlacedShape& at) {
  const double area =
      (shape.kind == core::BodyKind::kSphere ? 0.25 * std::numbers::pi : 1.0) *
      shape.long_side * shape.short_side;
  const cv::Mat mask = MakeMask(at, shape, 0.0, change.size());
  return {mask, std::max(0.0, area - cv::countNonZero(mask))};
}

// The sum of the header. Beyond the picture nothing changes.
double MeasureMisfit(const cv::Mat& change, const PlacedMask& one,
                     const PlacedMask& other) {
  double sum = one.beyond + other.beyond;
  for (int y = 0; y < change.rows; ++y) {
    const float* const own = change.ptr<float>(y);
    const auto* const a = one.mask.ptr<std::uint8_t>(y);
    const auto* const b = other.mask.ptr<std::uint8_t>(y);
    float row = 0.0F;
    for (int x = 0; x < change.cols; ++x) {
      row += std::abs(own[x] - static_cast<float>(a[x] ^ b[x]));
    }
    sum += static_cast<double>(row);
  }
  return sum;
}

double MeasureMisfit(const cv::Mat& change, const KnownShape& shape,
                     const std::array<PlacedShape, 2>& pair) {
  return MeasureMisfit(change, PlaceMask(change, shape, pair[0]),
                       PlaceMask(change, shape, pair[1]));
}

// Each place, and the shape moved along each of its sides: a strip is narrower
// than the shape, which covers it as well from any of them.
std::vector<PlacedShape> MoveAlongSides(const std::vector<PlacedShape>& places,
                                        const KnownShape& shape) {
  // Of the side. Closer ones cost time (their number's square); with none a
  // block of 60 px that goes 20 px is lost, because the search ends elsewhere.
  constexpr std::array kShares = {-0.5, -0.25, 0.25, 0.5};
  std::vector<PlacedShape> moved = places;
  for (const PlacedShape& place : places) {
    for (const double share : kShares) {
      const double along = share * shape.long_side;
      const double across = share * shape.short_side;
      const double cosine = std::cos(place.angle_rad);
      const double sine = std::sin(place.angle_rad);
      PlacedShape at = place;
      at.centre = {place.centre.x_px + along * cosine,
                   place.centre.y_px + along * sine};
      moved.push_back(at);
      at.centre = {place.centre.x_px - across * sine,
                   place.centre.y_px + across * cosine};
      moved.push_back(at);
    }
  }
  return moved;
}

// Pattern search (Hooke and Jeeves 1961) over both places.
void Descend(const cv::Mat& change, const KnownShape& shape, double least,
             std::array<PlacedShape, 2>& pair) {
  // Steps in cells, by halves. The first: places that lie anywhere on a strip
  // are drawn to its end. The last: a place is known to a cell. Not studied.
  constexpr double kFirstStep = 4.0;
  constexpr double kLastStep = 0.5;
  for (double step = kFirstStep; step >= kLastStep;) {
    const double turn = step / (0.5 * shape.long_side);
    bool is_better = false;
    for (PlacedShape& place : pair) {
      for (const double sign : {-1.0, 1.0}) {
        for (double* const along :
             {&place.centre.x_px, &place.centre.y_px, &place.angle_rad}) {
          const double before = *along;
          *along += sign * (along == &place.angle_rad ? turn : step);
          const double misfit = MeasureMisfit(change, shape, pair);
          if (misfit < least) {
            least = misfit;
            is_better = true;
          } else {
            *along = before;
          }
        }
      }
    }
    if (!is_better) step *= 0.5;
  }
}

}  // namespace

std::optional<std::pair<PlacedShape, PlacedShape>> FindPairOfPlaces(
    const PathSearch& in, const ReducedFrames& two) {
  const StillLayer still = WholeStill(two.pictures.front());
  const PlaceFinder finder(in, two, still);
  const cv::Rect& searched = finder.searched();
  if (searched.empty()) return std::nullopt;
  const cv::Mat change =
      ComputeChange(still, two.pictures.back(), in.scale, searched);
  std::vector<PlacedShape> places = finder.Find(change, 1);
  for (PlacedShape& place : places) {
    place.centre.x_px -= searched.x;
    place.centre.y_px -= searched.y;
  }
  // The best pair of those places, then from there.
  places = MoveAlongSides(places, in.shape);
  std::vector<PlacedMask> masks;
  masks.reserve(places.size());
  for (const PlacedShape& at : places) {
    masks.push_back(PlaceMask(change, in.shape, at));
  }
  std::array<PlacedShape, 2> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double misfit = MeasureMisfit(change, masks[i], masks[j]);
      if (misfit >= least) continue;
      least = misfit;
      best = {places[i], places[j]};
    }
  }
  if (!std::isfinite(least)) return std::nullopt;
  Descend(change, in.shape, least, best);
  for (PlacedShape& place : best) {
    place.centre.x_px += searched.x;
    place.centre.y_px += searched.y;
  }
  return std::pair{best[0], best[1]};
}

}  // namespace touchdown::vision
