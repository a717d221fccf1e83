#include "detection/layered_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "detection/pair_of_places.h"
#include "detection/path_search.h"
#include "detection/shape_along_path.h"
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

// Turns each angle to that of those that look alike which is next to the one
// before.
void MakeContinuous(const KnownShape& shape, std::vector<PlacedShape>& path) {
  if (shape.kind == core::BodyKind::kSphere) return;
  const double period = SymmetryPeriod(shape);
  double angle = path.front().angle_rad;
  for (PlacedShape& at : path) {
    angle += std::remainder(at.angle_rad - angle, period);
    at.angle_rad = angle;
  }
}

// The path's places in px. Absent where what is there is no body that moves.
core::Expected<std::vector<StartPose>> ToPoses(
    const ReducedFrames& sampled, const std::vector<PlacedShape>& path,
    const KnownShape& shape, std::int32_t reduction) {
  std::vector<StartPose> poses;
  const double usual = MedianScore(path);
  // Of the median score: with less the body is hidden or away. Not studied.
  constexpr double kMinScoreShare = 0.35;
  for (std::size_t t = 0; t < path.size(); ++t) {
    StartPose pose;
    pose.frame = sampled.frames[t];
    const auto to_px = [reduction](double at) {
      return at * reduction + 0.5 * (reduction - 1);
    };
    pose.centre = {to_px(path[t].centre.x_px), to_px(path[t].centre.y_px)};
    pose.angle_rad = path[t].angle_rad;
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

// The frames in [first, last) of the options.
core::Expected<ReducedFrames> SampleFrames(Clip& clip,
                                           const LayeredStartOptions& options,
                                           std::int32_t reduction) {
  const std::int64_t last = options.last < 0
                                ? clip.info().frames
                                : std::min(options.last, clip.info().frames);
  // Frames: a path of three has no residual.
  constexpr std::int64_t kMinFrames = 4;
  if (last - options.first < kMinFrames) {
    return core::AbsentBecause("fewer than four frames");
  }
  return SampleReducedFrames(clip, options.first, last, options.frames,
                             reduction);
}

// Cells of a searched cell's side.
std::int32_t SearchStep(const KnownShape& shape) {
  return static_cast<std::int32_t>(
      std::max(1.0, std::round(shape.short_side / kSearchedAcross)));
}

// Shapes to begin with, whose area is that of what differs from the median in
// the middle of all pictures.
std::vector<KnownShape> GuessShapes(core::BodyKind kind,
                                    const ReducedFrames& sampled,
                                    const StillLayer& median,
                                    const ChangeScale& scale) {
  constexpr double kChanged = 0.5;  // E, 0 to 1
  const cv::Rect whole({0, 0}, median.level.size());
  std::vector<float> areas;
  for (const cv::Mat& picture : sampled.pictures) {
    areas.push_back(static_cast<float>(cv::countNonZero(
        ComputeChange(median, picture, scale, whole) > kChanged)));
  }
  const auto area = static_cast<double>(MedianInPlace(areas));
  if (kind == core::BodyKind::kSphere) {
    const double diameter = std::sqrt(area * 4.0 / std::numbers::pi);
    return {{kind, diameter, diameter}};
  }
  // Long over short side. Of 13 photographed blocks of 1.7 to 3.2 each was
  // found from two of them at least.
  constexpr std::array kRatios = {1.0, 2.0, 4.0};
  std::vector<KnownShape> shapes;
  shapes.reserve(kRatios.size());
  for (const double ratio : kRatios) {
    shapes.push_back({kind, std::sqrt(area * ratio), std::sqrt(area / ratio)});
  }
  return shapes;
}

// px of a cell's side where the body's size is not known.
std::int32_t ReductionOfAny(const ClipInfo& info) {
  // Cells of a picture at the most: those of 640 x 400 px by the least
  // reduction. More cost time.
  constexpr double kCells = 64e3;
  // px: bodies of 16 px have the cells that a search needs then. Not studied.
  constexpr double kLeast = 2.0;
  const double pixels = static_cast<double>(info.width_px) * info.height_px;
  return static_cast<std::int32_t>(
      std::max(kLeast, std::ceil(std::sqrt(pixels / kCells))));
}

// E begins about a cell beyond the outline, which G and a clear contrast blur.
KnownShape WithoutBlur(KnownShape shape) {
  constexpr double kBoth = 2.0;  // cells, at two ends
  for (double* side : {&shape.long_side, &shape.short_side}) {
    *side = std::max(0.5 * *side, *side - kBoth);
  }
  return shape;
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
  const auto reduction = static_cast<std::int32_t>(
      std::clamp(std::floor(shape.short_side / kCellsAcross), 1.0,
                 static_cast<double>(kMaxReduction)));
  const auto taken = SampleFrames(clip, options, reduction);
  if (!taken) return tl::unexpected(taken.error());
  const ReducedFrames& sampled = *taken;
  const KnownShape reduced = ReducedShape(shape, reduction);
  StillLayer median = MedianStill(sampled, options.threads);
  const double noise_dn = EstimateCellNoise(sampled, median);
  const PathSearch search{sampled,
                          ScaleOfChange(noise_dn, sampled.full_scale_dn),
                          noise_dn,
                          reduced,
                          SearchStep(reduced),
                          options.threads};
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
  MakeContinuous(reduced, found.places);
  return ToPoses(sampled, found.places, shape, reduction);
}

core::Expected<SizedStart> FindSizedStart(Clip& clip,
                                          const LayeredStartOptions& options) {
  const std::int32_t reduction = ReductionOfAny(clip.info());
  const auto taken = SampleFrames(clip, options, reduction);
  if (!taken) return tl::unexpected(taken.error());
  const ReducedFrames& sampled = *taken;
  const StillLayer median = MedianStill(sampled, options.threads);
  const double noise_dn = EstimateCellNoise(sampled, median);
  const ChangeScale scale = ScaleOfChange(noise_dn, sampled.full_scale_dn);
  core::Expected<SizedStart> best = core::AbsentBecause("nothing changes");
  for (KnownShape shape :
       GuessShapes(options.shape.kind, sampled, median, scale)) {
    StillLayer still = median;
    // Of 13 blocks, those that were found took two to six.
    constexpr int kMostRounds = 8;
    constexpr double kLeastSide = 3.0;  // cells: smaller is noise
    for (int round = 0; round < kMostRounds && shape.short_side >= kLeastSide;
         ++round) {
      const PathSearch search{
          sampled, scale, noise_dn, shape, SearchStep(shape), options.threads};
      FoundPath found =
          FindPathFrom(search, std::move(still), round == 0, options.rounds);
      if (found.places.empty()) break;
      MakeContinuous(shape, found.places);
      const double unexplained = MeasureUnexplained(search, found);
      if (!best || unexplained < best->unexplained) {
        const KnownShape bare =
            ReducedShape(WithoutBlur(shape), 1.0 / reduction);
        auto poses = ToPoses(sampled, found.places, bare, reduction);
        if (poses) best = SizedStart{bare, std::move(*poses), unexplained};
      }
      const auto fitted = FitShapeAlongPath(search, found);
      if (!fitted) break;
      const bool is_at_rest = fitted->long_side == shape.long_side &&
                              fitted->short_side == shape.short_side;
      if (is_at_rest) break;
      shape = *fitted;
      still = std::move(found.still);
    }
  }
  return best;
}

}  // namespace touchdown::vision
