#include "track_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bracket.h"
#include "robust.h"

namespace touchdown::vision {
namespace {

double Period(const BodyImage& body) {
  constexpr double kSquare = 1.05;  // sides nearer than 5 %: a quarter turn
  return body.half_long_px.value < kSquare * body.half_short_px.value
             ? 0.5 * std::numbers::pi
             : std::numbers::pi;
}

constexpr const char* kGrows = "the body's image changes size";

// Leaves of many numbers those near their median, without a branch that nobody
// can foretell; returns how many of those left out are less.
std::size_t KeepNearMedian(std::vector<double>& values) {
  const auto [low, high] =
      BracketOfMedian(values.size(), [&](std::size_t i) { return values[i]; });
  std::vector<double> near(values.size());
  std::size_t below = 0;
  std::size_t kept = 0;
  for (const double value : values) {
    near[kept] = value;
    below += static_cast<std::size_t>(value < low);
    kept += static_cast<std::size_t>(value >= low) &
            static_cast<std::size_t>(value <= high);
  }
  const std::size_t middle = values.size() / 2;
  if (middle <= below || middle >= below + kept) return 0;
  near.resize(kept);
  values = std::move(near);
  return below;
}

}  // namespace

double SizeOf(const OutlineFit& fit) {
  return fit.outline.kind == core::BodyKind::kSphere ? fit.outline.radius_px
                                                     : fit.outline.half_long_px;
}

bool IsMeasured(const OutlineFit& fit) {
  return fit.u_x_px > 0.0 && fit.u_y_px > 0.0 &&
         (fit.outline.kind == core::BodyKind::kSphere || fit.u_angle_rad > 0.0);
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const bool odd = values.size() % 2 == 1;
  std::size_t place = values.size() / 2;
  if (values.size() >= kManyNumbers) place -= KeepNearMedian(values);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), middle, values.end());
  if (odd) return *middle;
  return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
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
    sizes.push_back(SizeOf(f.fit));
    misfits.push_back(f.fit.misfit);
  }
  const double size = Median(sizes);
  const double misfit = Median(misfits);
  constexpr double kSizeRatio = 1.35;
  constexpr double kMisfitRatio = 4.0;
  std::erase_if(all, [&](const Fitted& f) {
    return SizeOf(f.fit) > kSizeRatio * size ||
           SizeOf(f.fit) * kSizeRatio < size ||
           f.fit.misfit > kMisfitRatio * std::max(1.0, misfit);
  });
  constexpr std::size_t kLeast = 8;
  const auto is_hidden = [](const Fitted& f) {
    return f.fit.hidden > kMostHidden;
  };
  const auto hidden = static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), is_hidden));
  if (all.size() >= kLeast + hidden && 2 * hidden <= all.size()) {
    std::erase_if(all, is_hidden);
  }
}

std::vector<bool> FindHidden(const std::vector<Fitted>& all) {
  constexpr std::size_t kLeast = 8;  // that remain
  std::vector<bool> hidden(all.size(), false);
  if (all.size() < kLeast) return hidden;
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
  constexpr double kClearly = 5.0;  // standard uncertainties
  constexpr double kMatters = 0.01;
  constexpr double kProbably = 2.0;
  constexpr double kMayMatter = 0.003;
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
      hidden[i] = hidden[i] || lack > std::max(kClearly * u, kMatters * whole);
      probably[i] =
          probably[i] || lack > std::max(kProbably * u, kMayMatter * whole);
    }
  };
  compare(SizeOf, &OutlineFit::u_size_px);
  if (all.front().fit.outline.kind == core::BodyKind::kRectangle) {
    compare([](const OutlineFit& fit) { return fit.outline.half_short_px; },
            &OutlineFit::u_size_short_px);
  }
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (hidden[i - 1] && probably[i]) hidden[i] = true;
  }
  for (std::size_t i = all.size() - 1; i-- > 0;) {
    if (hidden[i + 1] && probably[i]) hidden[i] = true;
  }
  const auto count =
      static_cast<std::size_t>(std::count(hidden.begin(), hidden.end(), true));
  constexpr std::size_t kSeveral = 3;
  if (count < kSeveral || 2 * count > all.size() ||
      all.size() < count + kLeast) {
    hidden.assign(all.size(), false);
  }
  return hidden;
}

Pose PoseOf(const Fitted& f) {
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
  double sw = 0, st = 0, sr = 0, stt = 0, str = 0;
  for (const Fitted& f : all) {
    if (f.fit.visible < 0.98) continue;
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
  constexpr double kMatters = 0.01;
  const double noise = scatter / track.body.radius_px.value /
                       std::sqrt(static_cast<double>(all.size()) / 12.0);
  if (std::abs(change) < kMatters || std::abs(change) < 5.0 * noise) return;
  // A step is no growth: a blow changes the way that smears the image. Each
  // half must show a good part of the slope.
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
  constexpr double kGoodPart = 0.4;
  const std::size_t middle = all.size() / 2;
  if (half(0, middle) / slope < kGoodPart ||
      half(middle, all.size()) / slope < kGoodPart) {
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

bool IsSteady(const Track& track) {
  return std::all_of(
      track.poses.begin(), track.poses.end(),
      [](const Pose& pose) { return pose.relative_size == 1.0; });
}

void KeepSize(Track& track) {
  for (Pose& pose : track.poses) pose.relative_size = 1.0;
  std::erase_if(track.warnings, [](const std::string& warning) {
    return warning.starts_with(kGrows);
  });
}

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

Outline OutlineAt(const BodyImage& body, const Pose& pose) {
  Outline outline;
  outline.kind = body.kind;
  outline.centre = pose.centre;
  outline.angle_rad = pose.angle_rad;
  outline.radius_px = body.radius_px.value * pose.relative_size;
  outline.half_long_px = body.half_long_px.value * pose.relative_size;
  outline.half_short_px = body.half_short_px.value * pose.relative_size;
  return outline;
}

BodyImage ShapeOf(const std::vector<Fitted>& all, core::BodyKind kind) {
  std::vector<double> size, size_u, shorter, shorter_u, blur, contrast;
  // Only outlines that are wholly seen tell the size.
  for (const bool strict : {true, false}) {
    for (const Fitted& f : all) {
      if (strict && f.fit.visible < 0.98) continue;
      size.push_back(SizeOf(f.fit));
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
  constexpr std::size_t kLeast = 4;
  constexpr double kUnknown_px = 1e3;
  if (jumps.size() < kLeast) return kUnknown_px;
  // Two coordinates: the median of their length is 1.18 standard deviations.
  return Median(std::move(jumps)) / 1.18 / std::sqrt(20.0);
}

bool Moves(const std::vector<Fitted>& all) {
  constexpr double kStill_px = 1.0;
  // Not the farthest: a single outline may have slipped.
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
  track.body = ShapeOf(all, kind);
  track.poses.clear();
  for (const Fitted& f : all) track.poses.push_back(PoseOf(f));
  Unwrap(track);
  FollowSize(all, track);
}

}  // namespace touchdown::vision
