#include "detection/path_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "detection/path_linking.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// The box of all cells that change in any picture, with `reach` to all sides.
// Sides and corner are multiples of `by`. Empty where nothing changes.
cv::Rect RegionOfChange(const ReducedFrames& sampled, const StillLayer& still,
                        const ChangeScale& scale, double reach,
                        std::int32_t by) {
  // Change, 0..1: half of what counts as clear. Not studied.
  constexpr double kChanged = 0.5;
  const cv::Rect whole({0, 0}, still.level.size());
  cv::Mat most(whole.size(), CV_32F, cv::Scalar(0));
  for (const cv::Mat& picture : sampled.pictures) {
    cv::max(most, ComputeChange(still, picture, scale, whole), most);
  }
  const cv::Mat changed = most > kChanged;
  const cv::Rect box = cv::boundingRect(changed);
  if (box.width == 0) return {};
  const int grow = static_cast<int>(std::ceil(reach));
  const int left = std::max(0, box.x - grow) / by * by;
  const int top = std::max(0, box.y - grow) / by * by;
  const int right = std::min(most.cols, box.x + box.width + grow) / by * by;
  const int bottom = std::min(most.rows, box.y + box.height + grow) / by * by;
  return {left, top, std::max(0, right - left), std::max(0, bottom - top)};
}

// By how much a point of the shape moved between two paths, cells, at most.
double MeasureMove(const std::vector<PlacedShape>& before,
                   const std::vector<PlacedShape>& after,
                   const KnownShape& shape) {
  const bool disc = shape.kind == core::BodyKind::kSphere;
  double most = 0.0;
  for (std::size_t t = 0; t < after.size(); ++t) {
    const core::PixelPoint& a = before[t].centre;
    const core::PixelPoint& b = after[t].centre;
    const double turn =
        disc ? 0.0
             : std::remainder(after[t].angle_rad - before[t].angle_rad,
                              SymmetryPeriod(shape));
    most = std::max(most, std::hypot(b.x_px - a.x_px, b.y_px - a.y_px) +
                              0.5 * shape.long_side * std::abs(turn));
  }
  return most;
}

// Finds one path of the shape through all pictures: the best places of each by
// correlation, then the smoothest path through them (LinkPath).
FoundPath FindPath(const PathSearch& in, const StillLayer& still,
                   const PlaceFinder& finder, std::size_t every) {
  const std::vector<cv::Mat>& pictures = in.sampled.pictures;
  std::vector<std::vector<PlacedShape>> candidates(pictures.size());
  core::InParallel(
      static_cast<std::int64_t>(candidates.size()), in.threads,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto t = static_cast<std::size_t>(begin);
             t < static_cast<std::size_t>(end); ++t) {
          candidates[t] = finder.Find(
              ComputeChange(still, pictures[t], in.scale, finder.searched()),
              every);
          if (candidates[t].empty()) {
            const cv::Size size = pictures[t].size();
            candidates[t].push_back(
                {{0.5 * size.width, 0.5 * size.height}, 0.0, 0.0});
          }
        }
      });
  // Of half the diagonal, for each frame of the sampling step: a place is known
  // to about a cell, and a curved flight moves the body off a straight line by
  // some hundredths of its size. Not studied.
  constexpr double kBendShare = 0.02;
  PathCosts costs;
  costs.scatter =
      in.by + kBendShare * 0.5 *
                  std::hypot(in.shape.long_side, in.shape.short_side) *
                  static_cast<double>(in.sampled.step);
  costs.period_rad =
      in.shape.kind == core::BodyKind::kSphere ? 0.0 : SymmetryPeriod(in.shape);
  const LinkedPath linked = LinkPath(candidates, costs);
  FoundPath path;
  path.cost = linked.cost;
  for (std::size_t t = 0; t < candidates.size(); ++t) {
    path.places.push_back(candidates[t][linked.chosen[t]]);
  }
  return path;
}

}  // namespace

KnownShape ReducedShape(const KnownShape& shape, double by) {
  return {shape.kind, shape.long_side / by, shape.short_side / by};
}

PlaceFinder::PlaceFinder(const PathSearch& in, const ReducedFrames& pictures,
                         const StillLayer& still)
    : by_(in.by),
      searched_(RegionOfChange(
          pictures, still, in.scale,
          0.5 * std::hypot(in.shape.long_side, in.shape.short_side), in.by)),
      // Of an empty box nothing is asked.
      search_(ReducedShape(in.shape, in.by),
              std::max(1, searched_.width / in.by),
              std::max(1, searched_.height / in.by)) {}

std::vector<PlacedShape> PlaceFinder::Find(const cv::Mat& change,
                                           std::size_t every) const {
  // Places kept for each picture. More cost time (their cube); fewer lose the
  // body where brighter things change. Not studied.
  constexpr std::size_t kMaxima = 6;
  cv::Mat coarse;
  cv::resize(change, coarse, {searched_.width / by_, searched_.height / by_},
             0.0, 0.0, cv::INTER_AREA);
  std::vector<PlacedShape> places = search_.FindMaxima(
      {coarse.begin<float>(), coarse.end<float>()}, kMaxima, every);
  const auto to_cells = [this](double at, int corner) {
    return corner + at * by_ + 0.5 * (by_ - 1);
  };
  for (PlacedShape& place : places) {
    place.centre = {to_cells(place.centre.x_px, searched_.x),
                    to_cells(place.centre.y_px, searched_.y)};
  }
  return places;
}

cv::Mat MakeMask(const PlacedShape& at, const KnownShape& shape, double grow,
                 const cv::Size& size) {
  cv::Mat mask(size, CV_8U, cv::Scalar(0));
  const double half_long = 0.5 * shape.long_side + grow;
  const double half_short = 0.5 * shape.short_side + grow;
  const bool disc = shape.kind == core::BodyKind::kSphere;
  const double reach = disc ? half_long : std::hypot(half_long, half_short);
  const double cosine = std::cos(at.angle_rad);
  const double sine = std::sin(at.angle_rad);
  const auto from = [&](double centre) {
    return std::max(0, static_cast<int>(std::ceil(centre - reach)));
  };
  const auto to = [&](double centre, int end) {
    return std::min(end - 1, static_cast<int>(std::floor(centre + reach)));
  };
  for (int y = from(at.centre.y_px); y <= to(at.centre.y_px, size.height);
       ++y) {
    for (int x = from(at.centre.x_px); x <= to(at.centre.x_px, size.width);
         ++x) {
      const double dx = x - at.centre.x_px;
      const double dy = y - at.centre.y_px;
      const bool inside =
          disc ? std::hypot(dx, dy) <= half_long
               : std::abs(cosine * dx + sine * dy) <= half_long &&
                     std::abs(-sine * dx + cosine * dy) <= half_short;
      if (inside) mask.at<std::uint8_t>(y, x) = 1;
    }
  }
  return mask;
}

double MaskMargin(const KnownShape& shape) {
  // As a share of the short side, and in cells. Larger leaves less of the still
  // layer uncovered; smaller mixes the body into it. Not studied.
  constexpr double kGrowShare = 0.12;
  constexpr double kMinGrow = 2.5;
  return std::max(kMinGrow, kGrowShare * shape.short_side);
}

namespace {

// Whether the masks leave a median of the pictures right: each cell is covered
// in clearly less than half of them.
bool IsMedianClear(const std::vector<cv::Mat>& masks) {
  // Of the pictures. Smaller costs time: with 0, which never holds, 79 clips in
  // H.264 (crf 23) took 7 to 8 % more of it for the same answers.
  constexpr double kMostCovered = 0.45;
  cv::Mat covered(masks.front().size(), CV_16U, cv::Scalar(0));
  for (const cv::Mat& mask : masks) {
    cv::add(covered, mask, covered, cv::noArray(), CV_16U);
  }
  double most = 0.0;
  cv::minMaxLoc(covered, nullptr, &most);
  return most < kMostCovered * static_cast<double>(masks.size());
}

}  // namespace

FoundPath FindPathFrom(const PathSearch& in, StillLayer still, bool is_median,
                       int rounds) {
  const KnownShape& shape = in.shape;
  const double grow = MaskMargin(shape);
  FoundPath path;
  const PlaceFinder finder(in, in.sampled, still);
  if (finder.searched().empty()) return path;
  const cv::Mat first = still.level;
  for (int round = 0; round < rounds; ++round) {
    if (!path.places.empty()) {
      std::vector<cv::Mat> masks;
      masks.reserve(path.places.size());
      for (const PlacedShape& at : path.places) {
        masks.push_back(MakeMask(at, shape, grow, first.size()));
      }
      if (round == 1 && is_median && IsMedianClear(masks)) break;
      still = LearnStill(in.sampled, masks, first, in.noise_dn, in.threads);
    }
    // At first half of the angles do: the first layer's ghost is in the way.
    const std::size_t every = round == 0 && finder.has_many_angles() ? 2 : 1;
    const FoundPath before =
        std::exchange(path, FindPath(in, still, finder, every));
    // Masks that differ by less than their margin leave the same still layer.
    if (round > 0 && MeasureMove(before.places, path.places, shape) < grow) {
      break;
    }
  }
  path.still = std::move(still);
  return path;
}

double MeasureUnexplained(const PathSearch& in, const FoundPath& path) {
  const cv::Rect whole({0, 0}, path.still.level.size());
  double sum = 0.0;
  for (std::size_t t = 0; t < path.places.size(); ++t) {
    const cv::Mat change =
        ComputeChange(path.still, in.sampled.pictures[t], in.scale, whole);
    const cv::Mat mask = MakeMask(path.places[t], in.shape, 0.0, change.size());
    sum += cv::norm(change, cv::Mat_<float>(mask), cv::NORM_L1);
  }
  return sum;
}

}  // namespace touchdown::vision
