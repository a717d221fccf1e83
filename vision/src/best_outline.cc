#include "best_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "outline_pixels.h"

namespace touchdown::vision {
namespace {

// A place that says something, in places from the middle.
struct TellingPlace {
  double x = 0.0;
  double y = 0.0;
  double says = 0.0;
};

// What says nothing: a pin's width of such places beside it is left out, a bar
// like the wall between two ends is taken in.
constexpr double kOfAll = 0.1;

std::vector<TellingPlace> ToldOf(const CoMoving& places) {
  std::vector<TellingPlace> told;
  const int n = places.size();
  const auto at = [&](int column, int row) {
    if (column < 0 || row < 0 || column >= n || row >= n) return 0;
    return static_cast<int>(places.says[static_cast<std::size_t>(row) *
                                            static_cast<std::size_t>(n) +
                                        static_cast<std::size_t>(column)]);
  };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const int says = at(column, row);
      if (says == 0) continue;
      // What none of its neighbours says is noise.
      constexpr int kLeastAlike = 3;
      int alike = 0;
      for (int v = -1; v <= 1; ++v) {
        for (int u = -1; u <= 1; ++u) {
          alike += at(column + u, row + v) == says;
        }
      }
      if (alike <= kLeastAlike) continue;
      told.push_back({static_cast<double>(column - places.half),
                      static_cast<double>(row - places.half),
                      static_cast<double>(says)});
    }
  }
  return told;
}

// Without the still places that no outline of what moves along would hold.
void LeaveOutFar(std::vector<TellingPlace>& told) {
  constexpr double kBeyond = 0.25;  // of the box around what moves along
  const double far = std::numeric_limits<double>::infinity();
  double left = far;
  double right = -far;
  double top = far;
  double bottom = -far;
  for (const TellingPlace& t : told) {
    if (t.says < 0.0) continue;
    left = std::min(left, t.x);
    right = std::max(right, t.x);
    top = std::min(top, t.y);
    bottom = std::max(bottom, t.y);
  }
  const double margin = kBeyond * std::max(right - left, bottom - top);
  std::erase_if(told, [&](const TellingPlace& t) {
    return t.x < left - margin || t.x > right + margin || t.y < top - margin ||
           t.y > bottom + margin;
  });
}

// How much of a place lies within an edge so deep.
double ShareInside(double depth) { return std::clamp(depth + 0.5, 0.0, 1.0); }

double MeritOf(const std::vector<TellingPlace>& told, const Outline& outline) {
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  double merit = -kOfAll * Area(outline);
  for (const TellingPlace& t : told) {
    const double depth = DepthInside(outline, t.x, t.y, cosine, sine);
    if (depth > -0.5) merit += ShareInside(depth) * t.says;
  }
  return merit;
}

// By the moments of what moves along.
std::optional<Outline> StartOf(const std::vector<TellingPlace>& told,
                               core::BodyKind kind) {
  constexpr double kLeast = 30.0;  // places
  double n = 0.0;
  double x = 0.0;
  double y = 0.0;
  for (const TellingPlace& t : told) {
    if (t.says < 0.0) continue;
    n += 1.0;
    x += t.x;
    y += t.y;
  }
  if (n < kLeast) return std::nullopt;
  x /= n;
  y /= n;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const TellingPlace& t : told) {
    if (t.says < 0.0) continue;
    xx += (t.x - x) * (t.x - x) / n;
    xy += (t.x - x) * (t.y - y) / n;
    yy += (t.y - y) * (t.y - y) / n;
  }
  const double middle = 0.5 * (xx + yy);
  const double apart = std::hypot(0.5 * (xx - yy), xy);
  Outline start;
  start.kind = kind;
  start.centre = {x, y};
  if (kind == core::BodyKind::kSphere) {
    start.radius_px = std::sqrt(2.0 * middle);  // of a disc: R^2/4 each way
    return start;
  }
  // Of a rectangle: a^2/3 along the half side a.
  start.half_long_px = std::sqrt(3.0 * (middle + apart));
  start.half_short_px = std::sqrt(std::max(1.0, 3.0 * (middle - apart)));
  start.angle_rad = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return start;
}

// Outlines next to one, a step away: each side, and turned.
std::vector<Outline> NextTo(const Outline& outline, double step) {
  std::vector<Outline> next;
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  const auto moved = [&](double along, double across) {
    Outline other = outline;
    other.centre.x_px += along * cosine - across * sine;
    other.centre.y_px += along * sine + across * cosine;
    return other;
  };
  for (const double s : {-step, step}) {
    next.push_back(moved(s, 0.0));
    next.push_back(moved(0.0, s));
    if (outline.kind == core::BodyKind::kSphere) {
      Outline other = outline;
      other.radius_px += s;
      next.push_back(other);
      continue;
    }
    for (const double side : {-0.5, 0.5}) {
      Outline other = moved(side * s, 0.0);
      other.half_long_px += 0.5 * s;
      next.push_back(other);
      other = moved(0.0, side * s);
      other.half_short_px += 0.5 * s;
      next.push_back(other);
    }
    Outline other = outline;
    other.angle_rad += s / outline.half_long_px;
    next.push_back(other);
  }
  std::erase_if(next, [](const Outline& o) { return SmallestHalf(o) < 1.0; });
  return next;
}

// To the best of the outlines next to it, as long as there is a better one;
// false where there still is one when the bound of turns is met.
bool Climb(const std::vector<TellingPlace>& told, double step,
           const core::Cancellation& until, Outline& outline) {
  constexpr int kMostTurns = 60;
  double best = MeritOf(told, outline);
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const double before = best;
    for (const Outline& other : NextTo(outline, step)) {
      until.Check();
      const double merit = MeritOf(told, other);
      if (merit > best) {
        best = merit;
        outline = other;
      }
    }
    if (!(best > before)) return true;
  }
  return false;
}

// Some of them, each standing for as many as make up all.
std::vector<TellingPlace> ThinnedPlaces(const std::vector<TellingPlace>& told,
                                        std::size_t most) {
  const std::size_t step = (told.size() + most - 1) / most;
  std::vector<TellingPlace> few;
  for (std::size_t i = 0; i < told.size(); i += step) {
    few.push_back(told[i]);
    few.back().says *= static_cast<double>(step);
  }
  return few;
}

}  // namespace

std::optional<BestOutline> FindBestOutline(const CoMoving& places,
                                           core::BodyKind kind, bool finely,
                                           const core::Cancellation& until) {
  std::vector<TellingPlace> told = ToldOf(places);
  LeaveOutFar(told);
  const auto start = StartOf(told, kind);
  if (!start) return std::nullopt;
  // Few places do to come near.
  constexpr std::size_t kFew = 4000;
  const std::vector<TellingPlace> few = ThinnedPlaces(told, kFew);
  // From two sides: what lies between two parts costs first, and gains later.
  constexpr double kLarger = 1.3;
  BestOutline best;
  best.merit = -std::numeric_limits<double>::infinity();
  for (const double times : {1.0 / kLarger, kLarger}) {
    Outline outline = *start;
    bool settled = true;
    outline.radius_px *= times;
    outline.half_long_px *= times;
    outline.half_short_px *= times;
    for (const double step : {16.0, 8.0, 4.0, 2.0, 1.0}) {
      settled = Climb(few, step, until, outline);
    }
    if (const double merit = MeritOf(few, outline); merit > best.merit) {
      best.merit = merit;
      best.outline = outline;
      best.settled = settled;
    }
  }
  if (finely) {
    for (const double step : {1.0, 0.5}) {
      best.settled = Climb(told, step, until, best.outline);
    }
  }
  best.merit = MeritOf(told, best.outline);
  const double cosine = std::cos(best.outline.angle_rad);
  const double sine = std::sin(best.outline.angle_rad);
  double moving = 0.0;
  double moving_within = 0.0;
  double within = 0.0;
  for (const TellingPlace& t : told) {
    const double share =
        ShareInside(DepthInside(best.outline, t.x, t.y, cosine, sine));
    within += share;
    if (t.says < 0.0) continue;
    moving += 1.0;
    moving_within += share;
  }
  best.holds = moving_within / std::max(moving, 1.0);
  best.pure = moving_within / std::max(within, 1.0);
  Outline& o = best.outline;
  if (o.half_short_px > o.half_long_px) {
    std::swap(o.half_short_px, o.half_long_px);
    o.angle_rad += 0.5 * std::numbers::pi;
  }
  o.angle_rad = std::remainder(o.angle_rad, std::numbers::pi);
  const double spacing = places.spacing_px;
  best.merit *= spacing * spacing;
  o.centre.x_px *= spacing;
  o.centre.y_px *= spacing;
  o.radius_px *= spacing;
  o.half_long_px *= spacing;
  o.half_short_px *= spacing;
  return best;
}

}  // namespace touchdown::vision
