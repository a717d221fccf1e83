#include "outline/track_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "numbers/robust.h"
#include "track/image_size.h"

namespace touchdown::vision {
namespace {

// Turn after which the outline looks the same.
double Period(const BodyImage& body) {
  // Ratio of the sides below which a rectangle is a square: after a quarter
  // turn it cannot be told from itself. Not studied.
  constexpr double kSquareRatio = 1.05;
  return body.half_long_px.value < kSquareRatio * body.half_short_px.value
             ? 0.5 * std::numbers::pi
             : std::numbers::pi;
}

}  // namespace

double OutlineSize(const OutlineFit& fit) {
  return fit.outline.kind == core::BodyKind::kSphere ? fit.outline.radius_px
                                                     : fit.outline.half_long_px;
}

bool IsMeasured(const OutlineFit& fit) {
  return fit.u_x_px > 0.0 && fit.u_y_px > 0.0 &&
         (fit.outline.kind == core::BodyKind::kSphere || fit.u_angle_rad > 0.0);
}

double MedianMisfit(const std::vector<Fitted>& all) {
  std::vector<double> misfits;
  misfits.reserve(all.size());
  for (const Fitted& f : all) misfits.push_back(f.fit.misfit);
  return Median(std::move(misfits));
}

double MedianMisfit(const std::vector<Pose>& poses) {
  std::vector<double> misfits;
  misfits.reserve(poses.size());
  for (const Pose& pose : poses) misfits.push_back(pose.misfit);
  return Median(std::move(misfits));
}

core::Estimate RobustMean(const std::vector<double>& values,
                          const std::vector<double>& us) {
  const double centre = Median(values);
  std::vector<double> off;
  off.reserve(values.size());
  for (const double v : values) off.push_back(std::abs(v - centre));
  const double scatter = kSigmaPerMedian * Median(off);
  const double typical = Median(us);
  double sw = 0.0;
  double swx = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(values[i] - centre) > 4.0 * scatter + 1e-12) continue;
    // No value weighs more than the typical one.
    const double u = std::max(us[i], typical);
    const double w = 1.0 / (u * u + 1e-12);
    sw += w;
    swx += w * values[i];
    n += 1.0;
  }
  if (n < 1.0) return {centre, scatter};
  return {swx / sw, std::max(1.0 / std::sqrt(sw), scatter / std::sqrt(n))};
}

void DropStrangers(std::vector<Fitted>& all) {
  std::vector<double> sizes;
  std::vector<double> misfits;
  for (const Fitted& f : all) {
    sizes.push_back(OutlineSize(f.fit));
    misfits.push_back(f.fit.misfit);
  }
  const double size = Median(sizes);
  const double misfit = Median(misfits);
  // Ratio to the median size, and to the median misfit (at least 1). Larger
  // keeps outlines of other things; smaller loses free fits of noisy clips. Not
  // studied.
  constexpr double kMaxSizeRatio = 1.35;
  constexpr double kMaxMisfitRatio = 4.0;
  std::erase_if(all, [&](const Fitted& f) {
    return OutlineSize(f.fit) > kMaxSizeRatio * size ||
           OutlineSize(f.fit) * kMaxSizeRatio < size ||
           f.fit.misfit > kMaxMisfitRatio * std::max(1.0, misfit);
  });
  // Frames that must remain. Not studied.
  constexpr std::size_t kMinRemaining = 8;
  const auto is_hidden = [](const Fitted& f) {
    return f.fit.hidden > kMostHidden;
  };
  const auto hidden = static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), is_hidden));
  if (all.size() >= kMinRemaining + hidden && 2 * hidden <= all.size()) {
    std::erase_if(all, is_hidden);
  }
}

std::vector<bool> FindHidden(const std::vector<Fitted>& all) {
  // Frames that must remain. Not studied.
  constexpr std::size_t kMinRemaining = 8;
  std::vector<bool> hidden(all.size(), false);
  if (all.size() < kMinRemaining) return hidden;
  // The upper quartile of the sizes is the whole body's: a hidden body looks
  // smaller, never larger.
  const auto quartile = [](std::vector<double> values) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(values.size() * 3 / 4);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  std::vector<double> misfits;
  misfits.reserve(all.size());
  for (const Fitted& f : all) misfits.push_back(f.fit.misfit);
  if (Median(std::move(misfits)) > kWellModelled) return hidden;
  // What the size must lack, in standard uncertainties and as a share of the
  // whole, both. Fewer: noise is called hidden; more: frames that are hidden a
  // little draw the path. Set with the obstacle part of the accuracy design,
  // whose RMSE of the approach angle fell from 430 to 4.7 times the bound.
  constexpr double kHiddenSigmas = 5.0;
  constexpr double kHiddenShare = 0.01;
  // The same beside a hidden frame.
  constexpr double kBesideSigmas = 2.0;
  constexpr double kBesideShare = 0.003;
  std::vector<bool> probably(all.size(), false);
  const auto compare = [&](const auto& size_of, double OutlineFit::*u_of) {
    std::vector<double> sizes;
    std::vector<double> us;
    for (const Fitted& f : all) {
      sizes.push_back(size_of(f.fit));
      us.push_back(f.fit.*u_of);
    }
    const double whole = quartile(sizes);
    const double usual = Median(us);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double lack = whole - sizes[i];
      const double u = std::hypot(us[i], usual);
      hidden[i] =
          hidden[i] || lack > std::max(kHiddenSigmas * u, kHiddenShare * whole);
      probably[i] = probably[i] ||
                    lack > std::max(kBesideSigmas * u, kBesideShare * whole);
    }
  };
  compare(OutlineSize, &OutlineFit::u_size_px);
  if (all.front().fit.outline.kind == core::BodyKind::kRectangle) {
    compare([](const OutlineFit& fit) { return fit.outline.half_short_px; },
            &OutlineFit::u_size_short_px);
  }
  // Spreads to neighbours, forwards and then backwards.
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (hidden[i - 1] && probably[i]) hidden[i] = true;
  }
  for (std::size_t i = all.size() - 1; i-- > 0;) {
    if (hidden[i + 1] && probably[i]) hidden[i] = true;
  }
  const auto count =
      static_cast<std::size_t>(std::count(hidden.begin(), hidden.end(), true));
  // Frames: one or two may be noise. Not studied.
  constexpr std::size_t kMinHidden = 3;
  if (count < kMinHidden || 2 * count > all.size() ||
      all.size() < count + kMinRemaining) {
    hidden.assign(all.size(), false);
  }
  return hidden;
}

Pose ToPose(const Fitted& f) {
  Pose pose;
  pose.frame = f.frame;
  pose.time_s = f.time_s;
  pose.centre = f.fit.outline.centre;
  pose.angle_rad = f.fit.outline.angle_rad;
  pose.u_x_px = f.fit.u_x_px;
  pose.u_y_px = f.fit.u_y_px;
  pose.correlation_xy = f.fit.correlation_xy;
  pose.u_angle_rad = f.fit.u_angle_rad;
  pose.misfit = f.fit.misfit;
  return pose;
}

void FollowSize(const std::vector<Fitted>& all, Track& track) {
  if (track.body.kind != core::BodyKind::kSphere || all.size() < 12) return;
  // Weighted straight line of the radius over time.
  double sw = 0, st = 0, sr = 0, stt = 0, str = 0;
  for (const Fitted& f : all) {
    if (f.fit.visible < kWhollySeen) continue;
    const double w = 1.0 / (f.fit.u_size_px * f.fit.u_size_px + 1e-6);
    sw += w;
    st += w * f.time_s;
    sr += w * f.fit.outline.radius_px;
    stt += w * f.time_s * f.time_s;
    str += w * f.time_s * f.fit.outline.radius_px;
  }
  const double determinant = sw * stt - st * st;
  if (!(determinant > 0.0)) return;
  const double slope = (sw * str - st * sr) / determinant;
  const double level = (sr - slope * st) / sw;
  const double span = all.back().time_s - all.front().time_s;
  const double change = slope * span / track.body.radius_px.value;
  double square = 0.0;
  for (const Fitted& f : all) {
    const double r = f.fit.outline.radius_px - level - slope * f.time_s;
    square += r * r;
  }
  const double scatter = std::sqrt(square / static_cast<double>(all.size()));
  // Of the radius over the clip: less changes no answer by its u. The change
  // must also be five times its noise. Not studied.
  constexpr double kMinSizeChange = 0.01;
  const double noise = scatter / track.body.radius_px.value /
                       std::sqrt(static_cast<double>(all.size()) / 12.0);
  if (std::abs(change) < kMinSizeChange || std::abs(change) < 5.0 * noise)
    return;
  // A step is no growth: an impact changes the motion that smears the image,
  // and with it the size. Each half of the clip must show a good part of the
  // slope.
  const auto half = [&](std::size_t begin, std::size_t end) {
    std::vector<double> early;
    std::vector<double> late;
    const std::size_t third = (end - begin) / 3;
    for (std::size_t i = 0; i < third; ++i) {
      early.push_back(all[begin + i].fit.outline.radius_px);
      late.push_back(all[end - 1 - i].fit.outline.radius_px);
    }
    const double apart =
        all[end - 1 - third / 2].time_s - all[begin + third / 2].time_s;
    return (Median(late) - Median(early)) / apart;
  };
  // Share of the slope: a step lies in one half, the other shows nothing. Not
  // studied.
  constexpr double kMinHalfSlope = 0.4;
  const std::size_t middle = all.size() / 2;
  if (half(0, middle) / slope < kMinHalfSlope ||
      half(middle, all.size()) / slope < kMinHalfSlope) {
    return;
  }
  for (Pose& pose : track.poses) {
    pose.relative_size =
        (level + slope * pose.time_s) / track.body.radius_px.value;
  }
  track.warnings.push_back(
      fmt::format("{} by {:.1f} % over the clip: it "
                  "moves towards "
                  "or away from the camera, and the scale with it",
                  kGrows, 100.0 * change));
}

// Each angle continues from the one before it, by less than half a period.
void Unwrap(Track& track) {
  if (track.body.kind != core::BodyKind::kRectangle || track.poses.empty()) {
    return;
  }
  const double period = Period(track.body);
  double last = std::remainder(track.poses.front().angle_rad, period);
  for (Pose& pose : track.poses) {
    pose.angle_rad = last + std::remainder(pose.angle_rad - last, period);
    last = pose.angle_rad;
  }
}

Outline PlaceOutline(const BodyImage& body, const Pose& pose) {
  Outline outline;
  outline.kind = body.kind;
  outline.centre = pose.centre;
  outline.angle_rad = pose.angle_rad;
  outline.radius_px = body.radius_px.value * pose.relative_size;
  outline.half_long_px = body.half_long_px.value * pose.relative_size;
  outline.half_short_px = body.half_short_px.value * pose.relative_size;
  return outline;
}

BodyImage EstimateShape(const std::vector<Fitted>& all, core::BodyKind kind) {
  std::vector<double> size, size_u, shorter, shorter_u, blur, contrast;
  // Only outlines that are wholly seen tell the size.
  for (const bool strict : {true, false}) {
    for (const Fitted& f : all) {
      if (strict && f.fit.visible < kWhollySeen) continue;
      size.push_back(OutlineSize(f.fit));
      size_u.push_back(f.fit.u_size_px);
      shorter.push_back(f.fit.outline.half_short_px);
      shorter_u.push_back(f.fit.u_size_short_px);
      blur.push_back(f.fit.blur_px);
      contrast.push_back(f.fit.contrast_dn);
    }
    if (size.size() >= 3) break;
  }
  BodyImage body;
  body.kind = kind;
  body.blur_px = Median(blur);
  body.contrast_dn = Median(contrast);
  if (kind == core::BodyKind::kSphere) {
    body.radius_px = RobustMean(size, size_u);
  } else {
    body.half_long_px = RobustMean(size, size_u);
    body.half_short_px = RobustMean(shorter, shorter_u);
    if (body.half_long_px.value < body.half_short_px.value) {
      std::swap(body.half_long_px, body.half_short_px);
    }
  }
  return body;
}

// Third differences of the centre, which no parabola changes: their variance is
// 20 times that of one position.
double Roughness(const std::vector<Fitted>& all) {
  std::vector<double> jumps;
  for (std::size_t i = 3; i < all.size(); ++i) {
    const std::int64_t gap = all[i].frame - all[i - 1].frame;
    if (all[i - 1].frame - all[i - 2].frame != gap ||
        all[i - 2].frame - all[i - 3].frame != gap) {
      continue;
    }
    const auto third = [&](double core::PixelPoint::*value) {
      const auto at = [&](std::size_t k) {
        return all[k].fit.outline.centre.*value;
      };
      return at(i) - 3.0 * at(i - 1) + 3.0 * at(i - 2) - at(i - 3);
    };
    jumps.push_back(std::hypot(third(&core::PixelPoint::x_px),
                               third(&core::PixelPoint::y_px)));
  }
  // Differences: fewer have no median worth the name. Not studied.
  constexpr std::size_t kMinJumps = 4;
  // px: rougher than any track.
  constexpr double kUnknown_px = 1e3;
  if (jumps.size() < kMinJumps) return kUnknown_px;
  // The length of a vector of two normal numbers has the median sqrt(2 ln 2) =
  // 1.18 standard deviations.
  return Median(std::move(jumps)) / 1.18 / std::sqrt(20.0);
}

bool Moves(const std::vector<Fitted>& all) {
  // px: what stays within it is a part of the scene. Set with the recorded
  // projectile, where a mark of the ruler was taken for a body.
  constexpr double kStill_px = 1.0;
  // The range of nine tenths, not the farthest: a single outline may have
  // slipped.
  std::vector<double> x, y;
  for (const Fitted& f : all) {
    x.push_back(f.fit.outline.centre.x_px);
    y.push_back(f.fit.outline.centre.y_px);
  }
  const auto range = [](std::vector<double>& v) {
    if (v.size() < 2) return 0.0;
    std::sort(v.begin(), v.end());
    const std::size_t cut = v.size() / 20;
    return v[v.size() - 1 - cut] - v[cut];
  };
  return std::hypot(range(x), range(y)) > kStill_px;
}

void FillTrack(const std::vector<Fitted>& all, core::BodyKind kind,
               Track& track) {
  track.body = EstimateShape(all, kind);
  track.poses.clear();
  for (const Fitted& f : all) track.poses.push_back(ToPose(f));
  Unwrap(track);
  FollowSize(all, track);
}

}  // namespace touchdown::vision
