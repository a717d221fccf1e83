#include "synthetic/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "touchdown/core/normal.h"

namespace touchdown::vision {
namespace {

constexpr double kPi = std::numbers::pi;  // under a short name

// The normal distribution function Phi and its antiderivative F(t) = t Phi(t) +
// phi(t), by cubic Hermite interpolation in a table: ten times faster than erf
// and exp, error below 2e-10.
class NormalIntegrals {
 public:
  NormalIntegrals() {
    for (int i = 0; i < kSize; ++i) {
      const double t = kFirst + i * kStep;
      const double density = core::NormalDensity(t);
      const double phi = core::NormalCdf(t);
      nodes_[static_cast<std::size_t>(i)] = {t * phi + density, phi, density};
    }
  }

  double Phi(double t) const {
    if (t <= kFirst) return 0.0;
    if (t >= -kFirst) return 1.0;
    const auto [i, u] = Locate(t);
    return Hermite(nodes_[i].phi, nodes_[i + 1].phi, nodes_[i].density,
                   nodes_[i + 1].density, u);
  }
  double Integral(double t) const {
    if (t <= kFirst) return 0.0;
    if (t >= -kFirst) return t;
    const auto [i, u] = Locate(t);
    return Hermite(nodes_[i].integral, nodes_[i + 1].integral, nodes_[i].phi,
                   nodes_[i + 1].phi, u);
  }

 private:
  // Nodes from -6 to 6 in steps of 1/64: beyond, Phi is 1e-9 off 0 or 1; a
  // cubic over a step errs by step^4/384 times the fourth derivative, below
  // 2e-10.
  static constexpr double kFirst = -6.0;
  static constexpr double kStep = 1.0 / 64.0;
  static constexpr int kSize = 12 * 64 + 1;
  struct Node {
    double integral, phi, density;
  };
  struct Place {
    std::size_t index;
    double fraction;
  };
  static Place Locate(double t) {
    const double at = (t - kFirst) / kStep;
    // Just below the end, `at` may round up to the last node.
    const double floor = std::min(std::floor(at), kSize - 2.0);
    return {static_cast<std::size_t>(floor), at - floor};
  }
  // Cubic with values f0, f1 and slopes d0, d1 at both ends of a step; u in
  // 0..1.
  static double Hermite(double f0, double f1, double d0, double d1, double u) {
    const double a = d0 * kStep - (f1 - f0);
    const double b = (f1 - f0) - d1 * kStep;
    return f0 + u * ((f1 - f0) + (1.0 - u) * (a * (1.0 - u) + b * u));
  }

  std::array<Node, kSize> nodes_{};
};

// Computed once, at the first use.
const NormalIntegrals& Integrals() {
  static const NormalIntegrals table;
  return table;
}

// Point of a piece at t in 0..1.
core::PixelPoint EvaluatePoint(const OutlinePiece& piece, double t) {
  if (!piece.is_arc) {
    return {piece.from.x_px + t * (piece.to.x_px - piece.from.x_px),
            piece.from.y_px + t * (piece.to.y_px - piece.from.y_px)};
  }
  const double angle = piece.begin_rad + t * (piece.end_rad - piece.begin_rad);
  return {piece.centre.x_px + piece.radius_px * std::cos(angle),
          piece.centre.y_px + piece.radius_px * std::sin(angle)};
}

// Values of t in (0, 1) where the piece crosses the line x (or y) = k + 1/2.
void Crossings(const OutlinePiece& piece, bool of_x, std::vector<double>& out) {
  const auto lines = [](double low, double high, auto&& visit) {
    for (double k = std::ceil(low - 0.5); k + 0.5 <= high; k += 1.0) {
      visit(k + 0.5);
    }
  };
  if (!piece.is_arc) {
    const double p = of_x ? piece.from.x_px : piece.from.y_px;
    const double q = of_x ? piece.to.x_px : piece.to.y_px;
    if (p == q) return;
    lines(std::min(p, q), std::max(p, q),
          [&](double line) { out.push_back((line - p) / (q - p)); });
    return;
  }
  const double c = of_x ? piece.centre.x_px : piece.centre.y_px;
  const double r = piece.radius_px;
  const double span = piece.end_rad - piece.begin_rad;
  lines(c - r, c + r, [&](double line) {
    const double ratio = std::clamp((line - c) / r, -1.0, 1.0);
    // Both angles at which the circle meets the line; those within the arc
    // count.
    const double first = of_x ? std::acos(ratio) : std::asin(ratio);
    const double second = of_x ? -first : kPi - first;
    for (const double angle : {first, second}) {
      const double turn = std::remainder(angle - piece.begin_rad, 2.0 * kPi);
      const double t = (turn < 0.0 ? turn + 2.0 * kPi : turn) / span;
      if (t > 0.0 && t < 1.0) out.push_back(t);
    }
  });
}

// Integral of x dy over the piece from t0 to t1.
double IntegralXdY(const OutlinePiece& piece, double t0, double t1) {
  const core::PixelPoint p = EvaluatePoint(piece, t0);
  const core::PixelPoint q = EvaluatePoint(piece, t1);
  // Exact for a straight piece: the trapezoid.
  if (!piece.is_arc) return 0.5 * (p.x_px + q.x_px) * (q.y_px - p.y_px);
  const double a = piece.begin_rad + t0 * (piece.end_rad - piece.begin_rad);
  const double b = piece.begin_rad + t1 * (piece.end_rad - piece.begin_rad);
  const double r = piece.radius_px;
  // Integral of r^2 cos^2 = r^2/2 [(b - a) + sin(b - a) cos(b + a)].
  return piece.centre.x_px * (q.y_px - p.y_px) +
         0.5 * r * r * ((b - a) + std::sin(b - a) * std::cos(b + a));
}

// Shoelace formula, relative to the first corner: a far origin costs no digits.
double SignedArea(const std::vector<core::PixelPoint>& corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& p = corners[i];
    const auto& q = corners[(i + 1) % corners.size()];
    twice += (p.x_px - corners[0].x_px) * (q.y_px - corners[0].y_px) -
             (q.x_px - corners[0].x_px) * (p.y_px - corners[0].y_px);
  }
  return 0.5 * twice;
}

// Positive on the side that the normal points to.
double SignedDistance(const HalfPlane& half, core::PixelPoint p) {
  return half.normal_x * (p.x_px - half.point.x_px) +
         half.normal_y * (p.y_px - half.point.y_px);
}

OutlinePiece Straight(core::PixelPoint from, core::PixelPoint to) {
  OutlinePiece piece;
  piece.from = from;
  piece.to = to;
  return piece;
}

OutlinePiece Arc(core::PixelPoint centre, double radius_px, double begin,
                 double end) {
  OutlinePiece piece;
  piece.is_arc = true;
  piece.centre = centre;
  piece.radius_px = radius_px;
  piece.begin_rad = begin;
  piece.end_rad = end;
  return piece;
}

}  // namespace

ShapeOutline CircleOutline(core::PixelPoint centre, double radius_px) {
  return {{Arc(centre, radius_px, 0.0, 2.0 * kPi)}, true};
}

ShapeOutline PolygonOutline(const std::vector<core::PixelPoint>& corners) {
  ShapeOutline outline;
  const std::size_t n = corners.size();
  if (n < 3) return outline;
  // All outlines run in one sense, so that what they enclose counts positive.
  const bool reverse = SignedArea(corners) < 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& p = corners[i];
    const auto& q = corners[(i + 1) % n];
    outline.pieces.push_back(reverse ? Straight(q, p) : Straight(p, q));
  }
  return outline;
}

std::vector<core::PixelPoint> ClipPolygon(
    const std::vector<core::PixelPoint>& corners, const HalfPlane& half) {
  std::vector<core::PixelPoint> kept;  // Sutherland-Hodgman
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const core::PixelPoint p = corners[i];
    const core::PixelPoint q = corners[(i + 1) % corners.size()];
    const double sp = SignedDistance(half, p);
    const double sq = SignedDistance(half, q);
    if (sp < 0.0) kept.push_back(p);
    if ((sp < 0.0) != (sq < 0.0)) {
      const double t = sp / (sp - sq);
      kept.push_back(
          {p.x_px + t * (q.x_px - p.x_px), p.y_px + t * (q.y_px - p.y_px)});
    }
  }
  return kept;
}

// The part of a disc below a line: an arc and its chord.
ShapeOutline ClipCircle(core::PixelPoint centre, double radius_px,
                        const HalfPlane& half) {
  const double height = SignedDistance(half, centre);
  if (height >= radius_px) return {};
  if (height <= -radius_px) return CircleOutline(centre, radius_px);
  // The arc lies about the direction into the half plane.
  const double middle = std::atan2(-half.normal_y, -half.normal_x);
  const double spread = std::acos(height / radius_px);
  const OutlinePiece arc =
      Arc(centre, radius_px, middle - spread, middle + spread);
  return {{arc, Straight(EvaluatePoint(arc, 1.0), EvaluatePoint(arc, 0.0))},
          false};
}

CoverageMap::CoverageMap(core::PixelRect window, double psf_sigma_px)
    : window_(window),
      sigma_(psf_sigma_px),
      sum_(static_cast<std::size_t>(std::max(0, window.width)) *
           static_cast<std::size_t>(std::max(0, window.height))) {}

// Adds an outline: convolved with a Gaussian pixel by pixel, or its exact area
// in each pixel without blur.
void CoverageMap::Add(const ShapeOutline& outline, double weight) {
  if (sum_.empty()) return;
  for (const OutlinePiece& piece : outline.pieces) {
    if (sigma_ > 0.0) {
      AddSmooth(piece, outline.full_circle, weight);
    } else {
      AddExact(piece, weight);
    }
  }
}

// Sums each row from the right: the nodes left differences only.
void CoverageMap::Finish() {
  for (std::int32_t y = 0; y < window_.height; ++y) {
    double* row = mutable_row(window_.y + y);
    for (std::int32_t x = window_.width - 1; x-- > 0;) row[x] += row[x + 1];
  }
}

// Green's theorem turns the area integral of the blurred pixel into a line
// integral over the outline: coverage at a pixel = integral of K(x, y) dy. One
// quadrature node adds its share to all pixels within the kernel's reach.
void CoverageMap::AddNode(double x, double y, double weighted_dy) {
  const double reach = 0.5 + kKernelReach * sigma_;
  const std::int32_t last_x = window_.x + window_.width - 1;
  const std::int32_t last_y = window_.y + window_.height - 1;
  // Compare in floating point: far nodes would overflow an int.
  if (y + reach < window_.y || y - reach > last_y || x + reach < window_.x) {
    return;
  }
  const NormalIntegrals& normal = Integrals();
  const double scale = 1.0 / sigma_;
  const auto i0 = static_cast<std::int32_t>(std::max<double>(
      window_.x, std::min<double>(last_x, std::ceil(x - reach - 1.0))));
  const auto i1 = static_cast<std::int32_t>(
      std::min<double>(last_x, std::floor(x + reach)));
  // Column i holds Q(x - i) - Q(x - i - 1), the last one Q(x - i): summed from
  // the right they give Q(x - i) everywhere. Columns: 2 (reach + 1) at the
  // largest sigma that a scene may have, 10 px.
  constexpr int kMaxColumns = 128;
  std::array<double, kMaxColumns> step;
  const int columns = i1 - i0 + 1;
  double upper = normal.Integral((x - i0 + 0.5) * scale);
  double lower = normal.Integral((x - i0 - 0.5) * scale);
  double here = upper - lower;
  for (int k = 0; k < columns; ++k) {
    upper = lower;
    lower = normal.Integral((x - (i0 + k) - 1.5) * scale);
    const double next = upper - lower;
    step[static_cast<std::size_t>(k)] =
        (i0 + k == last_x ? here : here - next) * sigma_ * weighted_dy;
    here = next;
  }
  const auto j0 = static_cast<std::int32_t>(
      std::max<double>(window_.y, std::ceil(y - reach)));
  const auto j1 = static_cast<std::int32_t>(
      std::min<double>(last_y, std::floor(y + reach)));
  double above = normal.Phi((y - j0 + 0.5) * scale);
  // The kernel is a product: one share for each row, one step for each column.
  for (std::int32_t j = j0; j <= j1; ++j) {
    const double below = normal.Phi((y - j - 0.5) * scale);
    const double share = above - below;
    above = below;
    double* row = mutable_row(j) + (i0 - window_.x);
    for (int k = 0; k < columns; ++k) {
      row[k] += share * step[static_cast<std::size_t>(k)];
    }
  }
}

void CoverageMap::AddSmooth(const OutlinePiece& piece, bool periodic,
                            double weight) {
  if (periodic) {
    // The trapezoid rule on a smooth closed curve converges like the kernel's
    // spectrum, exp(-2 pi^2 (sigma / h)^2): 1e-6 at h = 1.2 sigma.
    const double circumference = 2.0 * kPi * piece.radius_px;
    const int n = std::max(
        24, static_cast<int>(std::ceil(circumference / (1.2 * sigma_))));
    const double turn = 2.0 * kPi / n;
    for (int k = 0; k < n; ++k) {
      const double c = std::cos(k * turn);
      const double s = std::sin(k * turn);
      AddNode(piece.centre.x_px + piece.radius_px * c,
              piece.centre.y_px + piece.radius_px * s,
              weight * piece.radius_px * c * turn);
    }
    return;
  }
  // Gauss-Legendre, four nodes to a panel of at most 1.5 sigma (and, on an arc,
  // 15 degrees): nodes and weights on 0..1.
  constexpr std::array<double, 4> kNode{
      0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
      0.93056815579702629};
  constexpr std::array<double, 4> kWeight{
      0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
      0.17392742256872693};
  const double dx = piece.to.x_px - piece.from.x_px;
  const double dy = piece.to.y_px - piece.from.y_px;
  const double span = piece.end_rad - piece.begin_rad;
  const double length =
      piece.is_arc ? std::abs(span) * piece.radius_px : std::hypot(dx, dy);
  int panels =
      std::max(1, static_cast<int>(std::ceil(length / (1.5 * sigma_))));
  if (piece.is_arc) {
    panels = std::max(panels,
                      static_cast<int>(std::ceil(std::abs(span) * 12.0 / kPi)));
  }
  const double width = 1.0 / panels;
  for (int panel = 0; panel < panels; ++panel) {
    for (std::size_t k = 0; k < kNode.size(); ++k) {
      const double t = (panel + kNode[k]) * width;
      const core::PixelPoint p = EvaluatePoint(piece, t);
      // dy/dt of the piece at the node.
      const double slope =
          piece.is_arc ? span * (p.x_px - piece.centre.x_px) : dy;
      AddNode(p.x_px, p.y_px, weight * kWeight[k] * width * slope);
    }
  }
}

// Cuts the piece at all pixel borders; each part lies in one pixel, whose share
// is an integral of x dy.
void CoverageMap::AddExact(const OutlinePiece& piece, double weight) {
  std::vector<double> cuts{0.0, 1.0};
  Crossings(piece, true, cuts);
  Crossings(piece, false, cuts);
  std::sort(cuts.begin(), cuts.end());
  const std::int32_t last_x = window_.x + window_.width - 1;
  const std::int32_t last_y = window_.y + window_.height - 1;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const core::PixelPoint middle =
        EvaluatePoint(piece, 0.5 * (cuts[k] + cuts[k + 1]));
    const double column = std::floor(middle.x_px + 0.5);
    const double line = std::floor(middle.y_px + 0.5);
    if (line < window_.y || line > last_y || column < window_.x) continue;
    const double dy = EvaluatePoint(piece, cuts[k + 1]).y_px -
                      EvaluatePoint(piece, cuts[k]).y_px;
    double* row = mutable_row(static_cast<std::int32_t>(line));
    // Right of the window: the whole row is covered to its end.
    if (column > last_x) {
      row[window_.width - 1] += weight * dy;
      continue;
    }
    // Covered to the left of the outline: part of this pixel, all before it.
    const double part =
        IntegralXdY(piece, cuts[k], cuts[k + 1]) - (column - 0.5) * dy;
    const auto i = static_cast<std::int32_t>(column) - window_.x;
    row[i] += weight * part;
    if (i > 0) row[i - 1] += weight * (dy - part);
  }
}

}  // namespace touchdown::vision
