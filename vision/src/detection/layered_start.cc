#include "detection/layered_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "detection/path_linking.h"
#include "detection/still_layer.h"
#include "numbers/robust.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// Cells of the reduced picture across the short side, at least: the shape's
// place is then known to a tenth of it. More cost time (their square). Not
// studied.
constexpr double kCellsAcross = 8.0;
// px of a cell's side, at most. Larger saves time and blurs the shape's edge.
// Not studied.
constexpr std::int32_t kMaxReduction = 4;
// Cells across the short side in the picture that the shape is sought in. Not
// studied.
constexpr double kSearchedAcross = 5.0;

// Marks the cells inside the shape, grown by `grow` cells.
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

// The searched part of the change, in cells that are means of by x by.
std::vector<float> Coarsen(const cv::Mat& change, const cv::Rect& searched,
                           std::int32_t by) {
  cv::Mat coarse;
  cv::resize(change(searched), coarse,
             {searched.width / by, searched.height / by}, 0.0, 0.0,
             cv::INTER_AREA);
  return {coarse.begin<float>(), coarse.end<float>()};
}

// The box of all cells that change in any picture, with `reach` to all sides.
// Sides and corner are multiples of `by`. Empty where nothing changes.
cv::Rect RegionOfChange(const ReducedFrames& sampled, const StillLayer& still,
                        const ChangeScale& scale, double reach,
                        std::int32_t by) {
  // Change, 0..1: half of what counts as clear. Not studied.
  constexpr double kChanged = 0.5;
  cv::Mat most(still.level.size(), CV_32F, cv::Scalar(0));
  for (const cv::Mat& picture : sampled.pictures) {
    cv::max(most, ComputeChange(still, picture, scale), most);
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

KnownShape ReducedShape(const KnownShape& shape, double by) {
  return {shape.kind, shape.long_side / by, shape.short_side / by};
}

double MedianScore(const std::vector<PlacedShape>& path) {
  std::vector<float> scores;
  scores.reserve(path.size());
  for (const PlacedShape& p : path)
    scores.push_back(static_cast<float>(p.score));
  return static_cast<double>(MedianInPlace(scores));
}

// Finds one path of the shape through all pictures: the best places of each by
// correlation, then the smoothest path through them (LinkPath).
std::vector<PlacedShape> FindPath(const ReducedFrames& sampled,
                                  const StillLayer& still,
                                  const ChangeScale& scale,
                                  const ShapeSearch& search,
                                  const KnownShape& shape,
                                  const cv::Rect& searched, std::int32_t by,
                                  std::size_t every, int threads) {
  // Places kept for each picture. More cost time (their cube); fewer lose the
  // body where brighter things change. Not studied.
  constexpr std::size_t kMaxima = 6;
  std::vector<std::vector<PlacedShape>> candidates(sampled.pictures.size());
  core::InParallel(
      static_cast<std::int64_t>(candidates.size()), threads,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto t = static_cast<std::size_t>(begin);
             t < static_cast<std::size_t>(end); ++t) {
          candidates[t] = search.FindMaxima(
              Coarsen(ComputeChange(still, sampled.pictures[t], scale),
                      searched, by),
              kMaxima, every);
          for (PlacedShape& candidate : candidates[t]) {
            const auto to_px = [by](double cell, int corner) {
              return corner + cell * by + 0.5 * (by - 1);
            };
            candidate.centre = {to_px(candidate.centre.x_px, searched.x),
                                to_px(candidate.centre.y_px, searched.y)};
          }
          if (candidates[t].empty()) {
            const cv::Size size = sampled.pictures[t].size();
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
  costs.scatter = by + kBendShare * 0.5 *
                           std::hypot(shape.long_side, shape.short_side) *
                           static_cast<double>(sampled.step);
  costs.period_rad =
      shape.kind == core::BodyKind::kSphere ? 0.0 : SymmetryPeriod(shape);
  const LinkedPath linked = LinkPath(candidates, costs);
  std::vector<PlacedShape> path;
  for (std::size_t t = 0; t < candidates.size(); ++t) {
    path.push_back(candidates[t][linked.chosen[t]]);
  }
  return path;
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

}  // namespace

core::Expected<std::vector<StartPose>> FindLayeredStart(
    Clip& clip, const LayeredStartOptions& options) {
  const KnownShape& shape = options.shape;
  if (!(shape.long_side > 0.0) || !(shape.short_side > 0.0)) {
    throw std::invalid_argument(fmt::format(
        "LayeredStartOptions::shape: sides of {} x {} px; they must be above 0",
        shape.long_side, shape.short_side));
  }
  const std::int64_t last = options.last < 0
                                ? clip.info().frames
                                : std::min(options.last, clip.info().frames);
  // Frames: a path of three has no residual.
  constexpr std::int64_t kMinFrames = 4;
  if (last - options.first < kMinFrames) {
    return core::AbsentBecause("fewer than four frames");
  }
  const auto reduction = static_cast<std::int32_t>(
      std::clamp(std::floor(shape.short_side / kCellsAcross), 1.0,
                 static_cast<double>(kMaxReduction)));
  const ReducedFrames sampled =
      SampleReducedFrames(clip, options.first, last, options.frames, reduction);
  const KnownShape reduced = ReducedShape(shape, reduction);
  const auto by = static_cast<std::int32_t>(
      std::max(1.0, std::round(reduced.short_side / kSearchedAcross)));
  const cv::Size size = sampled.pictures.front().size();
  StillLayer still = MedianStill(sampled, options.threads);
  const cv::Mat median = still.level;
  const double noise_dn = EstimateCellNoise(sampled, still);
  const ChangeScale scale = ScaleOfChange(noise_dn, sampled.full_scale_dn);
  // Margin of the masks, as a share of the short side and in cells: the body's
  // blur, and the path's error. Larger leaves less of the still layer
  // uncovered; smaller mixes the body into it. Not studied.
  constexpr double kGrowShare = 0.12;
  constexpr double kMinGrow = 2.5;
  const double grow = std::max(kMinGrow, kGrowShare * reduced.short_side);

  const cv::Rect searched = RegionOfChange(
      sampled, still, scale,
      0.5 * std::hypot(reduced.long_side, reduced.short_side), by);
  if (searched.empty()) {
    return core::AbsentBecause(
        "nothing of the stated size changes in these frames");
  }
  const ShapeSearch search(ReducedShape(reduced, by), searched.width / by,
                           searched.height / by);
  std::vector<PlacedShape> path;
  for (int round = 0; round < options.rounds; ++round) {
    if (!path.empty()) {
      std::vector<cv::Mat> masks;
      masks.reserve(path.size());
      for (const PlacedShape& at : path) {
        masks.push_back(MakeMask(at, reduced, grow, size));
      }
      still = LearnStill(sampled, masks, median, noise_dn, options.threads);
    }
    // At first half of the angles do: the median's ghost is in the way.
    const std::size_t every = round == 0 && search.angles() > 1 ? 2 : 1;
    const std::vector<PlacedShape> before =
        std::exchange(path, FindPath(sampled, still, scale, search, reduced,
                                     searched, by, every, options.threads));
    // Masks that differ by less than their margin leave the same still layer.
    if (!before.empty() && MeasureMove(before, path, reduced) < grow) break;
  }

  std::vector<StartPose> poses;
  const double usual = MedianScore(path);
  // Of the median score: with less the body is hidden or away. Not studied.
  constexpr double kMinScoreShare = 0.35;
  const double period =
      shape.kind == core::BodyKind::kSphere ? 0.0 : SymmetryPeriod(shape);
  double angle = path.front().angle_rad;
  for (std::size_t t = 0; t < path.size(); ++t) {
    StartPose pose;
    pose.frame = sampled.frames[t];
    const auto to_px = [reduction](double at) {
      return at * reduction + 0.5 * (reduction - 1);
    };
    pose.centre = {to_px(path[t].centre.x_px), to_px(path[t].centre.y_px)};
    if (period > 0.0) {
      angle += std::remainder(path[t].angle_rad - angle, period);
      pose.angle_rad = angle;
    }
    pose.score = path[t].score;
    pose.seen = path[t].score > kMinScoreShare * usual;
    poses.push_back(pose);
  }
  // Mean change under the shape, 0..1. Smaller takes noise for a body. Not
  // studied.
  constexpr double kMinScore = 0.1;
  if (usual < kMinScore) {
    return core::AbsentBecause(
        "nothing of the stated size changes in these frames");
  }
  double travel = 0.0;
  for (const StartPose& pose : poses) {
    travel = std::max(travel,
                      std::hypot(pose.centre.x_px - poses.front().centre.x_px,
                                 pose.centre.y_px - poses.front().centre.y_px));
  }
  // Of the short side: what moves by less is flicker. Not studied.
  constexpr double kMinTravel = 0.1;
  if (travel < kMinTravel * shape.short_side) {
    return core::AbsentBecause("nothing of the stated size moves");
  }
  return poses;
}

}  // namespace touchdown::vision
