#include "outline/appearance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "footage/box_around.h"
#include "numbers/both_sides.h"
#include "numbers/robust.h"
#include "outline/outline_image.h"
#include "outline/outline_pixels.h"
#include "outline/outline_sums.h"

namespace touchdown::vision {
namespace {

// A pixel clear inside the body, of one frame.
struct InsidePixel {
  double x_px = 0.0;  // from the body's centre, along the image's axes
  double y_px = 0.0;
  double level_dn = 0.0;  // beyond the shading
  double variance_dn2 = 0.0;
  double cosine = 1.0;  // of the body's angle
  double sine = 0.0;
  std::size_t frame = 0;  // how many were added before
  std::size_t place = 0;  // columns and rows from the body's middle
};

// What the frames have in common: mean sizes and blur of their fits.
struct Common {
  double size_px = 0.0;    // half the smallest
  double extent_px = 0.0;  // to the farthest point
  double blur_px = 0.0;
  bool shaded = true;
};

Common ComputeCommon(std::span<const SeenOutline> frames) {
  Common common;
  const auto n = static_cast<double>(frames.size());
  for (const SeenOutline& seen : frames) {
    common.size_px += SmallestHalf(seen.fit.outline) / n;
    common.blur_px += seen.fit.blur_px / n;
    common.extent_px = std::max(common.extent_px, Extent(seen.fit.outline));
    common.shaded = common.shaded && seen.fit.shading;
  }
  return common;
}

// The quadratic shading of a fit at (xi, eta), in units of the half sides.
double EvaluateShading(const Shading& shading, double xi, double eta) {
  const auto& k = shading.level;
  return k[0] + xi * (k[1] + xi * k[3] + eta * k[4]) +
         eta * (k[2] + eta * k[5]);
}

// Steps along columns and rows from the body's middle: symmetric in a mirror.
std::size_t StepsFromMiddle(const core::PixelPoint& centre, double x_px,
                            double y_px) {
  return static_cast<std::size_t>(std::abs(x_px - std::round(centre.x_px)) +
                                  std::abs(y_px - std::round(centre.y_px)));
}

// Collects the pixels clear inside the body in some frames, with the level that
// the shading does not explain.
class Collection {
 public:
  // `inner_px`: the greatest depth that is looked at; `frames`: so many are
  // going to be added.
  Collection(Clip& clip, const Background& background,
             const OutlineOptions& options, double inner_px, std::size_t frames)
      : clip_(clip),
        background_(background),
        behind_(background, Height(), 0.0),
        usable_(Height(options.ground), options.ground_margin_px,
                options.hider),
        inner_px_(inner_px),
        expected_(frames) {}

  void Add(const SeenOutline& seen);

  const std::vector<InsidePixel>& all() const { return all_; }
  std::size_t frames() const { return frames_; }

 private:
  void Add(const SeenOutline& seen, const OutlineImage& image, double cosine,
           double sine);

  Clip& clip_;
  const Background& background_;
  Behind behind_;
  UsablePart usable_;
  double inner_px_;
  std::size_t expected_;  // frames
  OutlinePixels pixels_;
  std::vector<InsidePixel> all_;
  std::size_t frames_ = 0;
};

void Collection::Add(const SeenOutline& seen) {
  const Outline& outline = seen.fit.outline;
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  Smear smear(seen.travel_px, seen.turn_rad, Extent(outline));
  smear.Set(seen.fit.blur_px, seen.fit.open, false);
  PixelBand band;
  // In units of blur_px inside the edge: pixels are covered by 0.88 and more,
  // so that an outline's error shows by less than half of what it does at the
  // edge. Larger loses small faces. Not studied.
  constexpr double kClearBlurs = 1.2;
  band.margin_px = -(kClearBlurs * seen.fit.blur_px + 0.5 * smear.way_px());
  band.inner_px = inner_px_;
  band.known_background = true;
  band.every = true;
  const core::Frame frame = clip_.Read(
      seen.frame, ClippedBox(outline.centre, Extent(outline), clip_.info()));
  CollectOutlinePixels(frame, behind_, outline, cosine, sine, usable_, band,
                       pixels_);
  if (pixels_.size == 0) return;
  // Frames show about as many pixels each.
  if (all_.empty()) all_.reserve((expected_ + 1) * pixels_.size);
  const std::size_t begin = all_.size();
  Add(seen, OutlineImage(outline, smear), cosine, sine);
  ++frames_;
  if (seen.fit.shading) return;
  // A fit without shading has one level for the whole body.
  std::vector<double> levels;
  for (std::size_t i = begin; i < all_.size(); ++i) {
    levels.push_back(all_[i].level_dn);
  }
  const double level = Median(std::move(levels));
  for (std::size_t i = begin; i < all_.size(); ++i) all_[i].level_dn -= level;
}

void Collection::Add(const SeenOutline& seen, const OutlineImage& image,
                     double cosine, double sine) {
  const core::PixelPoint& centre = seen.fit.outline.centre;
  CoverBlock cover;
  for (std::size_t begin = 0; begin < pixels_.size; begin += kBlock) {
    image.Cover(&pixels_.x[begin], &pixels_.y[begin], cover);
    const std::size_t end = std::min(pixels_.size, begin + kBlock);
    for (std::size_t i = begin; i < end; ++i) {
      const double covered = cover.value[i - begin];
      const double out = pixels_.background[i];
      InsidePixel in;
      in.x_px = pixels_.x[i] - centre.x_px;
      in.y_px = pixels_.y[i] - centre.y_px;
      // The body's own level: the pixel with the background's share taken out.
      in.level_dn = out + (pixels_.value[i] - out) / covered;
      if (seen.fit.shading) {
        in.level_dn -= EvaluateShading(*seen.fit.shading, cover.xi[i - begin],
                                       cover.eta[i - begin]);
      }
      in.variance_dn2 =
          background_.Variance(pixels_.value[i]) / (covered * covered);
      in.cosine = cosine;
      in.sine = sine;
      in.frame = frames_;
      in.place = StepsFromMiddle(centre, pixels_.x[i], pixels_.y[i]);
      all_.push_back(in);
    }
  }
}

// A pixel in axes that turn with the body, or in the image's.
SpotSample MakeSample(const InsidePixel& in, bool turns) {
  return {turns ? in.x_px * in.cosine + in.y_px * in.sine : in.x_px,
          turns ? in.y_px * in.cosine - in.x_px * in.sine : in.y_px,
          in.level_dn, in.variance_dn2};
}

// Means of the samples in squares of this side, laid out symmetrically about
// the middle. Squares with fewer than two samples are left out.
std::vector<SpotSample> AverageCells(const std::vector<SpotSample>& samples,
                                     double side_px, double reach_px) {
  const double half = std::ceil(reach_px / side_px) + 1.0;
  const double first = -half * side_px;
  const auto count = static_cast<std::size_t>(2.0 * half);
  std::vector<SpotSample> sums(count * count, SpotSample{0.0, 0.0, 0.0, 0.0});
  std::vector<double> seen(count * count, 0.0);
  const auto place = [&](double at) {
    return std::min(count - 1, static_cast<std::size_t>(
                                   std::max(0.0, (at - first) / side_px)));
  };
  for (const SpotSample& s : samples) {
    const std::size_t i = place(s.y_px) * count + place(s.x_px);
    sums[i].x_px += s.x_px;
    sums[i].y_px += s.y_px;
    sums[i].level_dn += s.level_dn;
    sums[i].variance_dn2 += s.variance_dn2;
    seen[i] += 1.0;
  }
  std::vector<SpotSample> cells;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double n = seen[i];
    if (n < 2.0) continue;
    cells.push_back({sums[i].x_px / n, sums[i].y_px / n, sums[i].level_dn / n,
                     sums[i].variance_dn2 / (n * n)});
  }
  return cells;
}

// Whether most of the frames show the spots: what comes in front of the body in
// some frames, such as an obstacle, is none of its appearance.
bool IsSeenThroughout(const std::vector<InsidePixel>& all, std::size_t frames,
                      const Appearance& look) {
  std::vector<double> fall(frames, 0.0);
  for (const InsidePixel& in : all) {
    const double level = look.At(in.x_px, in.y_px, in.cosine, in.sine).level_dn;
    const double rest = in.level_dn - level;
    fall[in.frame] +=
        (in.level_dn * in.level_dn - rest * rest) / in.variance_dn2;
  }
  // Share of the frames whose residuals the spots reduce. A weak spot is
  // drowned by a frame's own shading now and then: of 60 shaded clips 0.70 of
  // the frames and more showed theirs; of 60 with an obstacle 0.62 and less
  // showed what was taken for one.
  constexpr double kMinSeenShare = 0.66;
  const auto seen =
      std::count_if(fall.begin(), fall.end(), [](double f) { return f > 0.0; });
  return static_cast<double>(seen) >
         kMinSeenShare * static_cast<double>(frames);
}

// Every `step`-th pixel, others in each frame. The choice is symmetric: it is
// the same in a mirror, and in a clip that is played backwards.
std::vector<InsidePixel> ThinnedPixels(const std::vector<InsidePixel>& all,
                                       std::size_t frames, std::size_t step) {
  std::vector<InsidePixel> some;
  some.reserve(all.size() / step);
  for (const InsidePixel& in : all) {
    const std::size_t last = frames - 1;
    const std::size_t from_middle =
        std::max(in.frame, last - in.frame) - last / 2;
    if ((in.place + from_middle) % step == 0) some.push_back(in);
  }
  return some;
}

// Finds spots in the pixels: first in cells, then in a part of the pixels
// themselves.
std::optional<Appearance> Described(const std::vector<InsidePixel>& all,
                                    bool turns, std::size_t frames,
                                    const Common& common) {
  std::vector<SpotSample> samples;
  samples.reserve(all.size());
  for (const InsidePixel& in : all) samples.push_back(MakeSample(in, turns));
  // Cells over the face, none smaller than half a pixel, with a few samples in
  // each. More cells cost time in proportion; fewer blur small spots. Not
  // studied.
  constexpr double kCells = 400.0;
  constexpr double kInCell = 5.0;
  constexpr double kMinSide_px = 0.5;
  const auto n = static_cast<double>(frames);
  const double per_frame = static_cast<double>(all.size()) / n;
  const double side = std::max(
      {kMinSide_px, std::sqrt(per_frame / kCells), std::sqrt(kInCell / n)});
  const std::vector<SpotSample> cells =
      AverageCells(samples, side, common.extent_px);
  // Pixels: enough for a spot's place to a hundredth of a pixel. More cost
  // time.
  constexpr std::size_t kMaxSamples = 12000;
  const std::size_t step = (samples.size() + kMaxSamples - 1) / kMaxSamples;
  double left_out = 1.0;  // how many there are for one that stays
  if (step > 1) {
    const std::vector<InsidePixel> some = ThinnedPixels(all, frames, step);
    left_out =
        static_cast<double>(all.size()) / static_cast<double>(some.size());
    samples.clear();
    for (const InsidePixel& in : some) samples.push_back(MakeSample(in, turns));
  }
  SpotOptions options;
  options.size_px = common.size_px;
  options.reach_px = common.extent_px;
  options.least_px = common.blur_px;
  options.curved = common.shaded;
  auto spots = FindSpots(cells, samples, options);
  if (!spots) return std::nullopt;
  spots->covariance /= left_out;
  Appearance look = {turns, common.shaded, std::move(*spots)};
  if (!IsSeenThroughout(all, frames, look)) return std::nullopt;
  return look;
}

}  // namespace

Appearance::Value Appearance::At(double x_px, double y_px, double cosine,
                                 double sine) const {
  const double x = turns ? x_px * cosine + y_px * sine : x_px;
  const double y = turns ? y_px * cosine - x_px * sine : y_px;
  NormalVector by(spots.parameters.size());
  Value value;
  value.level_dn = spots.At(x, y, &by);
  // A frame's own fit finds its shading again: these terms leave the level, and
  // the uncertainty.
  const int own = shaded ? SpotModel::kShading : 1;
  for (int i = 0; i < own; ++i) {
    value.level_dn -= spots.parameters[i] * by[i];
    by[i] = 0.0;
  }
  value.u_dn = std::sqrt(std::max(0.0, by.dot(spots.covariance * by)));
  return value;
}

std::optional<Appearance> LearnAppearance(Clip& clip,
                                          const Background& background,
                                          std::span<const SeenOutline> frames,
                                          const OutlineOptions& options) {
  // Frames: with fewer, what lies in front of the body in some is not told from
  // a spot. Not studied.
  constexpr std::size_t kMinFrames = 8;
  // Frames that are looked at, evenly spread. More cost time. Not studied.
  constexpr std::size_t kMaxFrames = 40;
  if (frames.size() < kMinFrames) return std::nullopt;
  const std::size_t step = (frames.size() + kMaxFrames - 1) / kMaxFrames;
  const std::vector<std::size_t> some = FromBothSides(frames.size(), step);
  const Common common = ComputeCommon(frames);
  // px that the fits saw inside the edge (outline.cc). There most bodies show
  // nothing to learn, and the work ends; else the whole face is looked at,
  // since a spot's middle tells more of it than its rim.
  const double fitted = std::max(12.0, 6.0 * common.blur_px);  // outline.cc
  std::optional<Appearance> best;
  for (const bool whole : {false, true}) {
    if (whole && (!best || common.size_px < fitted)) break;
    Collection collection(clip, background, options,
                          whole ? common.extent_px : fitted, some.size());
    for (const std::size_t i : some) {
      collection.Add(frames[i]);
    }
    best.reset();
    if (collection.all().empty()) break;
    for (const bool turns : {false, true}) {
      if (turns &&
          frames.front().fit.outline.kind != core::BodyKind::kRectangle) {
        continue;
      }
      auto found =
          Described(collection.all(), turns, collection.frames(), common);
      if (found && (!best || found->spots.chi2 < best->spots.chi2)) {
        best = std::move(found);
      }
    }
  }
  return best;
}

}  // namespace touchdown::vision
