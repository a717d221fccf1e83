#include "detection/layered_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <utility>

#include "detection/pair_of_places.h"
#include "detection/path_search.h"
#include "detection/still_layer.h"
#include "numbers/robust.h"

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

double MedianScore(const std::vector<PlacedShape>& path) {
  std::vector<float> scores;
  scores.reserve(path.size());
  for (const PlacedShape& p : path)
    scores.push_back(static_cast<float>(p.score));
  return static_cast<double>(MedianInPlace(scores));
}

// The first still layer is what the first and the last picture show without the
// body; which of its places is whose is tried both ways. Replaces `found` by
// what leaves less of the change unexplained.
void FindPathFromEnds(const PathSearch& in, int rounds, FoundPath& found) {
  ReducedFrames ends = in.sampled;
  ends.pictures = {in.sampled.pictures.front(), in.sampled.pictures.back()};
  const auto places = FindPairOfPlaces(in, ends);
  if (!places) return;
  const cv::Size size = ends.pictures.front().size();
  const double grow = MaskMargin(in.shape);
  std::vector<cv::Mat> masks = {MakeMask(places->first, in.shape, grow, size),
                                MakeMask(places->second, in.shape, grow, size)};
  double least = MeasureUnexplained(in, found);
  for (int way = 0; way < 2; ++way, std::swap(masks[0], masks[1])) {
    FoundPath other = FindPathFrom(
        in,
        LearnStill(ends, masks, ends.pictures.front(), in.noise_dn, in.threads),
        false, rounds);
    if (other.places.empty()) continue;
    const double unexplained = MeasureUnexplained(in, other);
    if (unexplained >= least) continue;
    least = unexplained;
    found = std::move(other);
  }
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
  StillLayer median = MedianStill(sampled, options.threads);
  const double noise_dn = EstimateCellNoise(sampled, median);
  const PathSearch search{
      sampled,  ScaleOfChange(noise_dn, sampled.full_scale_dn),
      noise_dn, reduced,
      by,       options.threads};
  FoundPath found =
      FindPathFrom(search, std::move(median), true, options.rounds);
  if (found.places.empty()) {
    return core::AbsentBecause(
        "nothing of the stated size changes in these frames");
  }
  // Of 48 clips, the paths that were right cost 0.03 to 2.3, in the median 0.2;
  // those that were wrong 2.2 to 4.2. Larger: bodies that go less than their
  // own length are followed in the mirror; smaller costs time.
  constexpr double kGoodCost = 1.0;
  if (found.cost > kGoodCost) {
    FindPathFromEnds(search, options.rounds, found);
  }
  const std::vector<PlacedShape>& path = found.places;

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
