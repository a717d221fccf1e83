#include "tracking/best_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "outline/outline_pixels.h"

namespace touchdown::vision {
namespace {

// A labelled cell, in cells from the middle. says: 1 moves along, -1 is still.
struct TellingPlace {
  double x = 0.0;
  double y = 0.0;
  double says = 0.0;
};

// Cost per cell within the outline, whatever its label: it leaves out a thin
// strip of unlabelled cells beside the body, and takes in an unlabelled bar
// between its two ends (the wall seen between them). Larger splits such bodies;
// 0 lets the outline grow over what says nothing. Set with the recorded cart.
constexpr double kCostPerCell = 0.1;

// All cells that carry a label, isolated ones left out.
std::vector<TellingPlace> CollectTold(const CoMoving& places) {
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
      // Of the nine cells around and at a place, those of its own label: a
      // label that at most two neighbours share is noise. Not studied.
      constexpr int kMaxNoiseCells = 3;
      int alike = 0;
      for (int v = -1; v <= 1; ++v) {
        for (int u = -1; u <= 1; ++u) {
          alike += at(column + u, row + v) == says;
        }
      }
      if (alike <= kMaxNoiseCells) continue;
      told.push_back({static_cast<double>(column - places.half),
                      static_cast<double>(row - places.half),
                      static_cast<double>(says)});
    }
  }
  return told;
}

// Drops still cells so far from all moving ones that no outline of the body
// would hold them: they cost time and say nothing.
void LeaveOutFar(std::vector<TellingPlace>& told) {
  // Of the longer side of the box around the moving cells. Not studied.
  constexpr double kMarginShare = 0.25;
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
  const double margin = kMarginShare * std::max(right - left, bottom - top);
  std::erase_if(told, [&](const TellingPlace& t) {
    return t.x < left - margin || t.x > right + margin || t.y < top - margin ||
           t.y > bottom + margin;
  });
}

// Share of a cell inside an edge that lies `depth` cells beyond its centre:
// linear over one cell, so that the merit is continuous.
double InsideShare(double depth) { return std::clamp(depth + 0.5, 0.0, 1.0); }

// Merit = (moving cells inside) - (still cells inside) - kCostPerCell area.
double ComputeMerit(const std::vector<TellingPlace>& told,
                    const Outline& outline) {
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  double merit = -kCostPerCell * Area(outline);
  for (const TellingPlace& t : told) {
    const double depth = SignedDepth(outline, t.x, t.y, cosine, sine);
    if (depth > -0.5) merit += InsideShare(depth) * t.says;
  }
  return merit;
}

// Start of the search, from the first and second moments of the moving cells.
std::optional<Outline> EstimateStart(const std::vector<TellingPlace>& told,
                                     core::BodyKind kind) {
  // Cells: fewer give no second moments worth a start. Not studied.
  constexpr double kMinCells = 30.0;
  double n = 0.0;
  double x = 0.0;
  double y = 0.0;
  for (const TellingPlace& t : told) {
    if (t.says < 0.0) continue;
    n += 1.0;
    x += t.x;
    y += t.y;
  }
  if (n < kMinCells) return std::nullopt;
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
    // A disc's variance is R^2/4 in each direction.
    start.radius_px = std::sqrt(2.0 * middle);
    return start;
  }
  // A rectangle's variance is a^2/3 along the half side a.
  start.half_long_px = std::sqrt(3.0 * (middle + apart));
  start.half_short_px = std::sqrt(std::max(1.0, 3.0 * (middle - apart)));
  start.angle_rad = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return start;
}

// The outlines one step away: moved along each axis, each side alone moved, and
// turned by one step at the ends of the long side.
std::vector<Outline> Neighbours(const Outline& outline, double step) {
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

// Moves to the best of the outlines next to it for as long as one is better
// (pattern search). Returns false if there still was a better one at the bound.
bool Climb(const std::vector<TellingPlace>& told, double step,
           const core::Cancellation& until, Outline& outline) {
  // Turns of one step size: with 16 cells a step, across the whole square. A
  // bound on time; the result then says that it has not settled.
  constexpr int kMaxTurns = 60;
  double best = ComputeMerit(told, outline);
  for (int turn = 0; turn < kMaxTurns; ++turn) {
    const double before = best;
    for (const Outline& other : Neighbours(outline, step)) {
      until.Check();
      const double merit = ComputeMerit(told, other);
      if (merit > best) {
        best = merit;
        outline = other;
      }
    }
    if (!(best > before)) return true;
  }
  return false;
}

// Every n-th cell, with n-fold weight: a subset for the coarse search.
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
  std::vector<TellingPlace> told = CollectTold(places);
  LeaveOutFar(told);
  const auto start = EstimateStart(told, kind);
  if (!start) return std::nullopt;
  // Few places do to come near.
  // Cells of the coarse search. More cost time; the fine search takes all. Not
  // studied.
  constexpr std::size_t kCoarseCells = 4000;
  const std::vector<TellingPlace> few = ThinnedPlaces(told, kCoarseCells);
  // The search starts from a smaller and a larger outline than the moments':
  // what lies between two parts costs first and gains later, so that one start
  // may end in a part. Set with the recorded cart.
  constexpr double kStartFactor = 1.3;
  BestOutline best;
  best.merit = -std::numeric_limits<double>::infinity();
  for (const double times : {1.0 / kStartFactor, kStartFactor}) {
    Outline outline = *start;
    bool settled = true;
    outline.radius_px *= times;
    outline.half_long_px *= times;
    outline.half_short_px *= times;
    for (const double step : {16.0, 8.0, 4.0, 2.0, 1.0}) {
      settled = Climb(few, step, until, outline);
    }
    if (const double merit = ComputeMerit(few, outline); merit > best.merit) {
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
  best.merit = ComputeMerit(told, best.outline);
  const double cosine = std::cos(best.outline.angle_rad);
  const double sine = std::sin(best.outline.angle_rad);
  // holds: recall, the moving cells that lie within. pure: precision, the
  // labelled cells within that move.
  double moving = 0.0;
  double moving_within = 0.0;
  double within = 0.0;
  for (const TellingPlace& t : told) {
    const double share =
        InsideShare(SignedDepth(best.outline, t.x, t.y, cosine, sine));
    within += share;
    if (t.says < 0.0) continue;
    moving += 1.0;
    moving_within += share;
  }
  best.holds = moving_within / std::max(moving, 1.0);
  best.pure = moving_within / std::max(within, 1.0);
  Outline& o = best.outline;
  // The search may have exchanged the sides.
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
