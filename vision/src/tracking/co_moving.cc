#include "tracking/co_moving.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "numbers/both_sides.h"
#include "numbers/robust.h"
#include "outline/outline_pixels.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// A place that no frame shows.
constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();
// Frames in the stack. Fewer give no medians of both layers; more cost time and
// memory, and the medians gain only by their square root. Not studied.
constexpr std::size_t kMinStacked = 8;
constexpr std::size_t kMaxStacked = 80;

// The frames' pictures of the box around the path, as means of bin x bin
// pixels.
struct Stack {
  core::PixelRect rect;  // of the clip's picture
  int bin = 1;
  int width = 0;
  int height = 0;
  std::vector<std::vector<float>> frames;
  std::vector<Pose> poses;

  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  // From the stack's coordinates to the clip's, and back.
  core::PixelPoint Of(const core::PixelPoint& p) const {
    const double middle = 0.5 * (bin - 1);
    return {rect.x + middle + bin * p.x_px, rect.y + middle + bin * p.y_px};
  }
  core::PixelPoint ToStack(const core::PixelPoint& p) const {
    const double middle = 0.5 * (bin - 1);
    return {(p.x_px - rect.x - middle) / bin, (p.y_px - rect.y - middle) / bin};
  }
};

// Box around all centres, widened by the reach and clipped to the picture.
core::PixelRect PathBox(const std::vector<Pose>& poses, double reach_px,
                        const ClipInfo& info) {
  double left = poses.front().centre.x_px;
  double right = left;
  double top = poses.front().centre.y_px;
  double bottom = top;
  for (const Pose& pose : poses) {
    left = std::min(left, pose.centre.x_px);
    right = std::max(right, pose.centre.x_px);
    top = std::min(top, pose.centre.y_px);
    bottom = std::max(bottom, pose.centre.y_px);
  }
  const auto within = [](double at, std::int32_t end) {
    return static_cast<std::int32_t>(std::clamp(at, 0.0, end - 1.0));
  };
  core::PixelRect rect;
  rect.x = within(left - reach_px, info.width_px);
  rect.y = within(top - reach_px, info.height_px);
  rect.width = within(right + reach_px + 1.0, info.width_px) - rect.x + 1;
  rect.height = within(bottom + reach_px + 1.0, info.height_px) - rect.y + 1;
  return rect;
}

Stack ReadStack(Clip& clip, const Track& path, double reach_px) {
  // Samples in the stack: as floats 32 MB. Not studied beyond that.
  constexpr double kMaxSamples = 8e6;
  // Cells across the square: so many are labelled in about a second.
  constexpr double kMaxCellsAcross = 300.0;
  Stack stack;
  const std::size_t step = (path.poses.size() + kMaxStacked - 1) / kMaxStacked;
  for (const std::size_t i : FromBothSides(path.poses.size(), step)) {
    stack.poses.push_back(path.poses[i]);
  }
  stack.rect = PathBox(stack.poses, reach_px, clip.info());
  const double samples = static_cast<double>(stack.rect.width) *
                         static_cast<double>(stack.rect.height) *
                         static_cast<double>(stack.poses.size());
  // The coarsest of both bounds; 1 leaves the pixels as they are.
  stack.bin = static_cast<int>(
      std::ceil(std::max({1.0, std::sqrt(samples / kMaxSamples),
                          2.0 * reach_px / kMaxCellsAcross})));
  stack.width = stack.rect.width / stack.bin;
  stack.height = stack.rect.height / stack.bin;
  for (const Pose& pose : stack.poses) {
    const core::Frame frame = clip.Read(pose.frame, stack.rect);
    std::vector<float> values;
    values.reserve(stack.Index(0, stack.height));
    for (int y = 0; y < stack.height; ++y) {
      for (int x = 0; x < stack.width; ++x) {
        std::uint32_t sum = 0;
        for (int v = 0; v < stack.bin; ++v) {
          for (int u = 0; u < stack.bin; ++u) {
            sum += frame.at(x * stack.bin + u, y * stack.bin + v);
          }
        }
        values.push_back(static_cast<float>(sum) /
                         static_cast<float>(stack.bin * stack.bin));
      }
    }
    stack.frames.push_back(std::move(values));
  }
  return stack;
}

class MotionLayers {
 public:
  MotionLayers(Stack stack, const Background& noise,
               const CoMovingOptions& options, const core::Cancellation& until)
      : stack_(std::move(stack)),
        noise_(noise),
        until_(until),
        height_(options.ground),
        turns_(options.turns),
        threads_(options.threads) {
    places_.spacing_px = stack_.bin;
    places_.half = static_cast<int>(std::ceil(options.reach_px / stack_.bin));
    const auto n = static_cast<std::size_t>(places_.size());
    places_.says.assign(n * n, 0);
    for (const Pose& pose : stack_.poses) {
      cosine_.push_back(turns_ ? std::cos(pose.angle_rad) : 1.0);
      sine_.push_back(turns_ ? std::sin(pose.angle_rad) : 0.0);
    }
  }

  const CoMoving& places() const { return places_; }

  // One round: the still picture without what covers it, then a label for each
  // cell.
  void Round(const std::vector<unsigned char>& covered, double least_share) {
    EstimateUncovered(covered);
    Judge(least_share);
  }

 private:
  // Place of a cell in frame k, in the stack's coordinates.
  core::PixelPoint At(std::size_t k, int column, int row) const {
    const core::PixelPoint c = stack_.ToStack(stack_.poses[k].centre);
    const double x = column - places_.half;
    const double y = row - places_.half;
    return {c.x_px + x * cosine_[k] - y * sine_[k],
            c.y_px + x * sine_[k] + y * cosine_[k]};
  }
  // Bilinear; kUnseen outside.
  float Interpolate(const std::vector<float>& picture,
                    const core::PixelPoint& p) const {
    const double left = std::floor(p.x_px);
    const double top = std::floor(p.y_px);
    if (!(left >= 0.0 && top >= 0.0 && left + 1.0 < stack_.width &&
          top + 1.0 < stack_.height)) {
      return kUnseen;
    }
    const std::size_t i =
        stack_.Index(static_cast<int>(left), static_cast<int>(top));
    const std::size_t below = i + static_cast<std::size_t>(stack_.width);
    const auto x = static_cast<float>(p.x_px - left);
    const auto y = static_cast<float>(p.y_px - top);
    return (1.0F - y) * ((1.0F - x) * picture[i] + x * picture[i + 1]) +
           y * ((1.0F - x) * picture[below] + x * picture[below + 1]);
  }

  // Whether a place lies below the ground line: what moves there is a shadow or
  // a reflection.
  bool IsBelow(const core::PixelPoint& p) const {
    const core::PixelPoint at = stack_.Of(p);
    return height_.Of(at.x_px, at.y_px) < 0.0;
  }

  bool IsCovered(const std::vector<unsigned char>& covered, std::size_t k,
                 int x, int y) const;
  void EstimateUncovered(const std::vector<unsigned char>& covered);
  void Judge(double least_share);
  signed char Say(std::size_t place, std::vector<float>& values,
                  double least_share, float& differs) const;
  void LeaveOutRim(const std::vector<float>& differs);

  Stack stack_;
  const Background& noise_;
  const core::Cancellation& until_;
  Height height_;
  bool turns_;
  int threads_;
  CoMoving places_;
  std::vector<double> cosine_, sine_;
  std::vector<float> still_;  // NaN where unknown
};

bool MotionLayers::IsCovered(const std::vector<unsigned char>& covered,
                             std::size_t k, int x, int y) const {
  const core::PixelPoint c = stack_.ToStack(stack_.poses[k].centre);
  const double dx = x - c.x_px;
  const double dy = y - c.y_px;
  const auto column = static_cast<int>(
      std::lround(dx * cosine_[k] + dy * sine_[k]) + places_.half);
  const auto row = static_cast<int>(
      std::lround(dy * cosine_[k] - dx * sine_[k]) + places_.half);
  const int n = places_.size();
  return column >= 0 && row >= 0 && column < n && row < n &&
         covered[static_cast<std::size_t>(row) * static_cast<std::size_t>(n) +
                 static_cast<std::size_t>(column)] != 0;
}

// Still layer: for each pixel the median of the frames in which it is not
// covered.
void MotionLayers::EstimateUncovered(
    const std::vector<unsigned char>& covered) {
  // Frames: the median of fewer is no better than one of them.
  constexpr std::size_t kMinSeen = 3;
  const std::size_t count = stack_.Index(0, stack_.height);
  still_.assign(count, kUnseen);
  core::InParallel(
      stack_.height, threads_, [&](std::int64_t begin, std::int64_t end) {
        std::vector<float> values;
        for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
          until_.Check();
          for (int x = 0; x < stack_.width; ++x) {
            const std::size_t i = stack_.Index(x, y);
            values.clear();
            for (std::size_t k = 0; k < stack_.frames.size(); ++k) {
              if (!IsCovered(covered, k, x, y)) {
                values.push_back(stack_.frames[k][i]);
              }
            }
            if (values.size() >= kMinSeen) still_[i] = MedianInPlace(values);
          }
        }
      });
}

// The label of one cell: the moving layer is the median of the frames along the
// path; each frame in which both layers differ clearly votes for the nearer
// one. `differs`: mean difference of the layers there.
signed char MotionLayers::Say(std::size_t place, std::vector<float>& values,
                              double least_share, float& differs) const {
  // Share of the frames that must show a cell; also: a cell below the ground in
  // more of them is the ground's. Not studied.
  constexpr double kMinSeenShare = 0.5;

  // Standard deviations of a sample. Fewer: noise votes; more: faint bodies
  // have no votes. Not studied.
  constexpr double kClearSigmas = 4.0;
  differs = 0.0F;
  const auto n = static_cast<std::size_t>(places_.size());
  const auto column = static_cast<int>(place % n);
  const auto row = static_cast<int>(place / n);
  values.clear();
  double below = 0.0;
  for (std::size_t k = 0; k < stack_.frames.size(); ++k) {
    const core::PixelPoint p = At(k, column, row);
    if (IsBelow(p)) {
      below += 1.0;
    } else if (const float v = Interpolate(stack_.frames[k], p);
               std::isfinite(v)) {
      values.push_back(v);
    }
  }
  const auto frames = static_cast<double>(stack_.frames.size());
  if (below > kMinSeenShare * frames) return -1;
  if (static_cast<double>(values.size()) < kMinSeenShare * frames) return 0;
  const float moving = MedianInPlace(values);
  const double noise = std::sqrt(noise_.Variance(static_cast<double>(moving)));
  double moves = 0.0;
  double told = 0.0;
  for (std::size_t k = 0; k < stack_.frames.size(); ++k) {
    const core::PixelPoint p = At(k, column, row);
    if (IsBelow(p)) continue;
    const float value = Interpolate(stack_.frames[k], p);
    const float still = Interpolate(still_, p);
    if (!std::isfinite(value) || !std::isfinite(still)) continue;
    if (std::abs(static_cast<double>(moving - still)) < kClearSigmas * noise)
      continue;
    told += 1.0;
    differs += std::abs(moving - still);
    moves += std::abs(value - moving) < std::abs(value - still) ? 1.0 : 0.0;
  }
  // At least three votes.
  if (told < std::max(3.0, least_share * frames)) return 0;
  differs /= static_cast<float>(told);
  // Majority of the votes; in between the cell stays without a label. Not
  // studied.
  constexpr double kMajority = 0.7;
  return moves > kMajority * told           ? 1
         : moves < (1.0 - kMajority) * told ? -1
                                            : 0;
}

void MotionLayers::Judge(double least_share) {
  std::vector<float> differs(places_.says.size(), 0.0F);
  core::InParallel(
      places_.size(), threads_, [&](std::int64_t begin, std::int64_t end) {
        std::vector<float> values;
        const auto n = static_cast<std::size_t>(places_.size());
        for (auto i = static_cast<std::size_t>(begin) * n;
             i < static_cast<std::size_t>(end) * n; ++i) {
          if (i % n == 0) until_.Check();
          places_.says[i] = Say(i, values, least_share, differs[i]);
        }
      });
  LeaveOutRim(differs);
}

// Takes the label from moving cells at a blurred rim: there the layers differ
// clearly long before the cell is half body, and the outline would be too
// large.
void MotionLayers::LeaveOutRim(const std::vector<float>& differs) {
  // px over which a usual edge goes from nothing to all. Not studied.
  constexpr double kEdgeWidth_px = 2.0;
  // Of the greatest difference near it: the middle of the edge.
  constexpr float kHalf = 0.5F;
  const int reach = std::max(
      1, static_cast<int>(std::lround(kEdgeWidth_px / places_.spacing_px)));
  const int n = places_.size();
  const std::vector<signed char> says = places_.says;
  for (int row = reach; row < n - reach; ++row) {
    for (int column = reach; column < n - reach; ++column) {
      const auto i = static_cast<std::size_t>(row * n + column);
      if (says[i] <= 0) continue;
      float most = 0.0F;
      for (int v = -reach; v <= reach; ++v) {
        for (int u = -reach; u <= reach; ++u) {
          const auto j = static_cast<std::size_t>((row + v) * n + column + u);
          if (says[j] > 0) most = std::max(most, differs[j]);
        }
      }
      if (differs[i] < kHalf * most) places_.says[i] = 0;
    }
  }
}

}  // namespace

CoMoving FindCoMoving(Clip& clip, const Background& noise, const Track& path,
                      const CoverOfPlaces& cover,
                      const CoMovingOptions& options) {
  if (path.poses.size() < kMinStacked) return {};
  MotionLayers layers(ReadStack(clip, path, options.reach_px), noise, options,
                      clip.cancellation());
  // Labels and still layer in turns. Not studied.
  constexpr int kRounds = 4;
  // Share of the frames that must vote on a cell. It is smaller in the first
  // rounds, while much of the still layer is not known. Not studied.
  constexpr double kFirstVoteShare = 0.1;
  constexpr double kLastVoteShare = 0.2;
  for (int round = 0; round < kRounds; ++round) {
    layers.Round(cover(layers.places()),
                 round + 1 < kRounds ? kFirstVoteShare : kLastVoteShare);
  }
  return layers.places();
}

}  // namespace touchdown::vision
