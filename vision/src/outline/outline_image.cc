#include "outline/outline_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "numbers/lanes.h"
#include "numbers/normal_lanes.h"

namespace touchdown::vision {
namespace {

// The body at one node of its motion blur, at rest there.
struct Place {
  // What tells where pixels lie from the edge; differences are short numbers.
  double x_px = 0.0;
  double y_px = 0.0;
  double long_px = 0.0;   // radius, or half the long side
  double short_px = 0.0;  // half the short side
  double cosine = 1.0;
  double sine = 0.0;
  // All others are good to 6e-8 of themselves.
  float per_long = 0.0F;
  float per_short = 0.0F;
  float weight = 1.0F;
  bool first = true;      // of discs: in the place of what was there
  float w_px = 1.0F;      // blur
  float d_open_x = 0.0F;  // of the place by the exposed share
  float d_open_y = 0.0F;
  float d_open_angle = 0.0F;
};

// The numbers of a disc at kWide pixels, and functions that add them from pixel
// i on.
struct WideOfDisc {
  Wide dx, dy;
  Wide outwards;  // minus the derivative by r, over r
  Wide value, d_radius, d_w;
};
TOUCHDOWN_INLINE void AddWide(bool first, const Wide& value, float* sum) {
  WideAt(sum) = first ? value : WideAt(sum) + value;
}
TOUCHDOWN_INLINE void AddDisc(const Place& place, const WideOfDisc& disc,
                              std::size_t i, CoverBlock& out) {
  const float weight = place.weight;
  const Wide d_x = weight * disc.outwards * disc.dx;
  const Wide d_y = weight * disc.outwards * disc.dy;
  AddWide(place.first, weight * disc.value, &out.value[i]);
  AddWide(place.first, d_x, &out.d_shape[0][i]);
  AddWide(place.first, d_y, &out.d_shape[1][i]);
  AddWide(place.first, weight * disc.d_radius, &out.d_shape[2][i]);
  AddWide(place.first, weight * disc.d_w, &out.d_blur[i]);
  AddWide(place.first, d_x * place.d_open_x + d_y * place.d_open_y,
          &out.d_open[i]);
  AddWide(place.first, disc.dx * (weight * place.per_long), &out.xi[i]);
  AddWide(place.first, disc.dy * (weight * place.per_long), &out.eta[i]);
}

// Distances of a block's pixels from the centre and from the edge. r - R is
// small beside r: as (r^2 - R^2)/(r + R), of which only the numerator needs
// many digits, it is good to 2e-7 of itself without a root in double precision.
struct alignas(64) Distances {
  BlockColumn dx;
  BlockColumn dy;
  BlockColumn r;
  BlockColumn outside;  // of a disc
};

TOUCHDOWN_INLINE void Measure(const Place& place, const double* x,
                              const double* y, Distances& at) {
  const double radius2 = place.long_px * place.long_px;
  const auto radius = static_cast<float>(place.long_px);
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double dx = x[i] - place.x_px;
    const double dy = y[i] - place.y_px;
    const double r2 = dx * dx + dy * dy;
    at.dx[i] = static_cast<float>(dx);
    at.dy[i] = static_cast<float>(dy);
    at.r[i] = std::sqrt(static_cast<float>(r2));
    at.outside[i] = static_cast<float>(r2 - radius2);
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    at.outside[i] /= at.r[i] + radius;
  }
}

// px, added to a radius before a division: at the centre there is no direction,
// and no edge whose derivative would need one.
constexpr float kAtCentre_px = 1e-12F;

// A pixel is a square, and its part of the blur no Gaussian of its variance
// 1/12: the next term of the series, -1/2880 (d^4/dx^4 + d^4/dy^4) of the
// image. Of an edge whose normal has the direction (c, s), z = depth/w:
//   (c^4 + s^4) / (2880 w^4) He_3(z) phi(z),  He_3 = z^3 - 3 z
// 2e-3 of the contrast at a lens's blur of 0.5 px, alike in all frames. No
// image is sharper than a pixel's.
float SquareTerm(float w_px) {
  const float variance = std::max(w_px * w_px, 1.0F / 12.0F);
  return 1.0F / (2880.0F * variance * variance);
}

// Adds `term` times He_3(z) phi(z) to the coverage, and its slope -He_4 phi to
// the density, whose place it takes.
TOUCHDOWN_INLINE void AddSquare(float term, const Wide& z, Wide& cdf, Wide& pdf,
                                Wide& added) {
  const Wide square = z * z;
  added = term * z * (square - 3.0F) * pdf;
  cdf += added;
  pdf *= 1.0F - term * (square * (square - 6.0F) + 3.0F);
}

// As a series in e = w/R, s = (r - R)/w, from the heat equation
// u_t = u_rr + u_r/r with 2 t = w^2:
//   Phi(-s) + phi(s) (-e/2 + 3/8 e^2 s - e^3 (1 + 5 s^2)/16) + O(e^4)
TOUCHDOWN_WIDEST
void AddLargeDisc(const Place& place, const double* x, const double* y,
                  CoverBlock& out) {
  Distances at;
  Measure(place, x, y, at);
  const float per_w = 1.0F / place.w_px;
  const float e = place.w_px * place.per_long;
  const float square_term = SquareTerm(place.w_px);
  for (std::size_t i = 0; i < kBlock; i += kWide) {
    const Wide r = WideAt(&at.r[i]);
    const Wide dx = WideAt(&at.dx[i]);
    const Wide dy = WideAt(&at.dy[i]);
    const Wide s = WideAt(&at.outside[i]) * per_w;
    Wide cdf;
    Wide pdf;
    NormalAt(-s, cdf, pdf);
    // The terms of the series and its derivatives by s and by e.
    const Wide third = 0.0625F * (1.0F + 5.0F * s * s);
    const Wide g = e * (-0.5F + e * (0.375F * s - e * third));
    const Wide g_s = e * e * (0.375F - 0.625F * e * s);
    const Wide g_e = -0.5F + e * (0.75F * s - 3.0F * e * third);
    // c^4 + s^4 = 1 - 2 c^2 s^2
    const Wide per_r = 1.0F / (r + kAtCentre_px);
    const Wide sine_cosine = (dx * per_r) * (dy * per_r);
    const Wide k =
        square_term * (1.0F - 2.0F * sine_cosine * sine_cosine) * pdf;
    const Wide s2 = s * s;
    const Wide square = k * s * (3.0F - s2);  // z is -s
    const Wide by_s =
        (pdf * (-1.0F - s * g + g_s) + k * (s2 * (s2 - 6.0F) + 3.0F)) * per_w;
    const Wide by_e = pdf * g_e * place.per_long;
    WideOfDisc disc;
    disc.dx = dx;
    disc.dy = dy;
    disc.outwards = -by_s * per_r;
    disc.value = cdf + pdf * g + square;
    disc.d_radius = -by_s - by_e * e;
    disc.d_w = by_e - by_s * s - 4.0F * per_w * square;
    AddDisc(place, disc, i, out);
  }
}

// Gauss-Legendre in ten nodes over a quarter of a circle.
struct QuarterCircle {
  std::array<double, 10> cosine;
  std::array<double, 10> sine;
  std::array<double, 10> weight;  // they add up to 1
};
// Nodes and weights on 0..1 (Abramowitz and Stegun, table 25.4), computed once.
const QuarterCircle& Nodes() {
  static const QuarterCircle nodes = [] {
    // Nodes and weights on 0..1.
    constexpr std::array<double, 10> kNode = {
        0.0130467357414141, 0.0674683166555077, 0.1602952158504878,
        0.2833023029353764, 0.4255628305091844, 0.5744371694908156,
        0.7166976970646236, 0.8397047841495122, 0.9325316833444923,
        0.9869532642585859};
    // They add up to 1.
    constexpr std::array<double, 10> kWeight = {
        0.0333356721543441, 0.0747256745752903, 0.1095431812579910,
        0.1346333596549982, 0.1477621123573764, 0.1477621123573764,
        0.1346333596549982, 0.1095431812579910, 0.0747256745752903,
        0.0333356721543441};
    QuarterCircle q;
    for (std::size_t i = 0; i < kNode.size(); ++i) {
      const double t = 0.5 * std::numbers::pi * kNode[i];
      q.cosine[i] = std::cos(t);
      q.sine[i] = std::sin(t);
      q.weight[i] = kWeight[i];
    }
    return q;
  }();
  return nodes;
}

// By quadrature over chords, for discs of a few w, where the series does not
// see the far side of the edge:
//   2 int_0^(pi/2) phi_w(R sin t) (Phi((r + h)/w) - Phi((r - h)/w)) h dt,
// h = R cos t; its derivative by R is the blurred circle itself; by w it
// follows from the others, as it depends on r/w and R/w alone. Of four
// distances r.
TOUCHDOWN_WIDEST
void SmallDisc(double radius, double w, const QuarterCircle& nodes,
               SmallDiscTable::Columns& table, std::size_t i) {
  constexpr Four kMost = {700.0, 700.0, 700.0, 700.0};  // for ExpOfMinus
  const double per_w = 1.0 / w;
  const Four r = FourAt(&table.r[i]);
  Four value = r - r;
  Four d_r = value;
  Four d_radius = value;
  for (std::size_t k = 0; k < nodes.cosine.size(); ++k) {
    const double h = radius * nodes.cosine[k];
    const double across = radius * nodes.sine[k] * per_w;
    const Four there = r - r + 0.5 * across * across;
    Four on_chord;
    ExpOfMinus(there < kMost ? there : kMost, on_chord);
    const Four weight = on_chord * (nodes.weight[k] * h * per_w *
                                    std::numbers::pi * kInverseSqrt2Pi);
    Four cdf_far, pdf_far, cdf_near, pdf_near;
    NormalAt((r + h) * per_w, cdf_far, pdf_far);
    NormalAt((r - h) * per_w, cdf_near, pdf_near);
    value += weight * (cdf_far - cdf_near);
    d_r += weight * (pdf_far - pdf_near) * per_w;
    const Four square = (r * r + radius * radius) * (0.5 * per_w * per_w);
    const Four product = r * (h * per_w * per_w);
    const Four nearest = square - product;
    const Four farthest = square + product;
    Four at_near, at_far;
    ExpOfMinus(nearest < kMost ? nearest : kMost, at_near);
    ExpOfMinus(farthest < kMost ? farthest : kMost, at_far);
    d_radius +=
        (at_near + at_far) * (nodes.weight[k] * 0.5 * radius * per_w * per_w);
  }
  FourAt(&table.value[i]) = value;
  FourAt(&table.d_r[i]) = d_r;
  FourAt(&table.d_radius[i]) = d_radius;
}

// Reads a small disc's profile from the table, in double precision.
void AddSmallDisc(const Place& place, const SmallDiscTable& table,
                  const double* x, const double* y, CoverBlock& out) {
  Distances at;
  Measure(place, x, y, at);
  for (std::size_t i = 0; i < kBlock; i += kWide) {
    WideOfDisc disc;
    for (std::size_t l = 0; l < kWide; ++l) {
      const auto r = static_cast<double>(at.r[i + l]);
      const SmallDiscTable::Profile p = table.At(r);
      disc.outwards[l] =
          static_cast<float>(-p.d_r / (r + static_cast<double>(kAtCentre_px)));
      disc.value[l] = static_cast<float>(p.value);
      disc.d_radius[l] = static_cast<float>(p.d_radius);
      disc.d_w[l] =
          static_cast<float>(-(r * p.d_r + place.long_px * p.d_radius) /
                             static_cast<double>(place.w_px));
    }
    disc.dx = WideAt(&at.dx[i]);
    disc.dy = WideAt(&at.dy[i]);
    AddDisc(place, disc, i, out);
  }
}

TOUCHDOWN_WIDEST
// Coverage of a rectangle: the product of two blurred slabs, (Phi(u + a) -
// Phi(u - a)) (Phi(v + b) - Phi(v - b)) in units of w, each edge with its
// square term.
void AddRectangle(const Place& place, const double* x, const double* y,
                  CoverBlock& out) {
  const float per_w = 1.0F / place.w_px;
  const auto c = static_cast<float>(place.cosine);
  const auto s = static_cast<float>(place.sine);
  const float k = (c * c * c * c + s * s * s * s) * SquareTerm(place.w_px);
  struct alignas(64) Sides {
    BlockColumn u, v;
    BlockColumn up, um, vp, vm;  // from each side, inwards and outwards
  };
  Sides at;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double dx = x[i] - place.x_px;
    const double dy = y[i] - place.y_px;
    const double u = dx * place.cosine + dy * place.sine;
    const double v = dy * place.cosine - dx * place.sine;
    at.u[i] = static_cast<float>(u);
    at.v[i] = static_cast<float>(v);
    at.up[i] = static_cast<float>(u + place.long_px);
    at.um[i] = static_cast<float>(u - place.long_px);
    at.vp[i] = static_cast<float>(v + place.short_px);
    at.vm[i] = static_cast<float>(v - place.short_px);
  }
  for (std::size_t i = 0; i < kBlock; i += kWide) {
    const Wide u = WideAt(&at.u[i]);
    const Wide v = WideAt(&at.v[i]);
    const Wide up = WideAt(&at.up[i]) * per_w;
    const Wide um = WideAt(&at.um[i]) * per_w;
    const Wide vp = WideAt(&at.vp[i]) * per_w;
    const Wide vm = WideAt(&at.vm[i]) * per_w;
    Wide above_u, below_u, above_v, below_v;  // the slab's two sides
    Wide pup, pum, pvp, pvm;
    NormalAt(up, above_u, pup);
    NormalAt(um, below_u, pum);
    NormalAt(vp, above_v, pvp);
    NormalAt(vm, below_v, pvm);
    Wide sup, sum, svp, svm;
    AddSquare(k, up, above_u, pup, sup);
    AddSquare(k, um, below_u, pum, sum);
    AddSquare(k, vp, above_v, pvp, svp);
    AddSquare(k, vm, below_v, pvm, svm);
    pup *= per_w;
    pum *= per_w;
    pvp *= per_w;
    pvm *= per_w;
    const float weight = place.weight;
    const Wide along = above_u - below_u;
    const Wide across = weight * (above_v - below_v);
    pvp *= weight;
    pvm *= weight;
    // By w at a fixed depth in w: the term goes with w^-4.
    const Wide fades_u = 4.0F * per_w * (sup - sum);
    const Wide fades_v = (4.0F * weight) * per_w * (svp - svm);
    const Wide d_u = (pup - pum) * across;
    const Wide d_v = (pvp - pvm) * along;
    const Wide d_x = d_v * s - d_u * c;
    const Wide d_y = -d_u * s - d_v * c;
    WideAt(&out.value[i]) += along * across;
    WideAt(&out.d_shape[0][i]) += d_x;
    WideAt(&out.d_shape[1][i]) += d_y;
    WideAt(&out.d_shape[2][i]) += (pup + pum) * across;
    WideAt(&out.d_shape[3][i]) += (pvp + pvm) * along;
    const Wide d_angle = d_u * v - d_v * u;
    WideAt(&out.d_shape[4][i]) += d_angle;
    WideAt(&out.d_blur[i]) -= (up * pup - um * pum + fades_u) * across +
                              (vp * pvp - vm * pvm + fades_v) * along;
    WideAt(&out.d_open[i]) += d_x * place.d_open_x + d_y * place.d_open_y +
                              d_angle * place.d_open_angle;
    WideAt(&out.xi[i]) += u * (weight * place.per_long);
    WideAt(&out.eta[i]) += v * (weight * place.per_short);
  }
}

}  // namespace

// Length of the way of the outline's farthest point during the exposure.
double Smear::way_px() const {
  return open_ * (std::hypot(travel_px_.x_px, travel_px_.y_px) +
                  std::abs(turn_rad_) * reach_px_);
}

// Motion blur is the mean of the still image over the exposure: by quadrature,
// with as few nodes as the length of the way allows.
void Smear::Set(double blur_px, double open, bool resolved) {
  // Lengths of the way, in units of the blur. Up to the first the body counts
  // as still: the way's variance, 1/12 of its square, adds 0.2 % to the blur's.
  constexpr double kStillWay = 0.15;
  // Up to here two nodes with the way's own variance are enough.
  constexpr double kTwoNodesWay = 0.9;
  // Longer ways are cut into panels of this length, with three Gauss nodes
  // each. Longer panels make ripples; shorter ones cost time. Not studied.
  constexpr double kPanelWay = 2.1;
  // A bound on time. Not studied.
  constexpr double kMaxPanels = 32.0;
  // Gauss-Legendre on -1/2..1/2: half the nodes' distance of two equal weights
  // that keep the variance, 1/sqrt(12), and of three nodes, sqrt(3/20).
  constexpr double kNodeOfTwo = 0.28867513459481287;
  constexpr double kNodeOfThree = 0.38729833462074170;
  blur_px_ = blur_px;
  open_ = open;
  nodes_.clear();
  const double way = way_px() / blur_px;
  if (way <= kStillWay && !resolved) {
    nodes_.push_back({0.0, 1.0});
    return;
  }
  if (way <= kTwoNodesWay) {
    nodes_ = {{-kNodeOfTwo, 0.5}, {kNodeOfTwo, 0.5}};
    return;
  }
  const auto panels =
      static_cast<int>(std::min(kMaxPanels, std::ceil(way / kPanelWay)));
  for (int i = 0; i < panels; ++i) {
    const double middle = (i + 0.5) / panels - 0.5;
    nodes_.push_back({middle - kNodeOfThree / panels, 5.0 / 18.0 / panels});
    nodes_.push_back({middle, 8.0 / 18.0 / panels});
    nodes_.push_back({middle + kNodeOfThree / panels, 5.0 / 18.0 / panels});
  }
}

// Profile of a small disc at equal steps of the radius: the quadrature costs
// too much for each pixel.
SmallDiscTable::SmallDiscTable(double radius_px, double w_px)
    : per_step_(kPerBlur / w_px) {
  for (std::size_t i = 0; i < kCount; ++i) {
    columns_.r[i] = static_cast<double>(i) / per_step_;
  }
  for (std::size_t i = 0; i < kCount; i += 4) {
    SmallDisc(radius_px, w_px, Nodes(), columns_, i);
  }
}

SmallDiscTable::Profile SmallDiscTable::At(double r_px) const {
  const double at = r_px * per_step_;
  if (!(at < static_cast<double>(kCount - 1))) return {};
  const auto i = static_cast<std::size_t>(at);
  const double t = at - static_cast<double>(i);
  const auto between = [&](const std::array<double, kCount>& column) {
    return column[i] + t * (column[i + 1] - column[i]);
  };
  // The value by cubic Hermite interpolation, with the slopes of both ends; the
  // derivatives linearly.
  const double low = columns_.value[i];
  const double rise = columns_.value[i + 1] - low;
  const double begin = columns_.d_r[i] / per_step_;
  const double end = columns_.d_r[i + 1] / per_step_;
  return {low + t * (begin + t * (3.0 * rise - 2.0 * begin - end +
                                  t * (begin + end - 2.0 * rise))),
          between(columns_.d_r), between(columns_.d_radius)};
}

OutlineImage::OutlineImage(const Outline& outline, const Smear& smear)
    : outline_(outline), smear_(smear) {
  // R/w. From here on the series in w/R is good to 3e-4 of the contrast; below
  // it the quadrature takes over, at the cost of a table a fit.
  constexpr double kSeriesFrom = 4.0;
  if (outline.kind == core::BodyKind::kSphere &&
      outline.radius_px < kSeriesFrom * smear.blur_px_) {
    small_.emplace(outline.radius_px, smear.blur_px_);
  }
}

// Coverage of a block of pixels with its derivatives: the weighted sum over the
// nodes of the motion.
void OutlineImage::Cover(const double* x, const double* y,
                         CoverBlock& out) const {
  const bool sphere = outline_.kind == core::BodyKind::kSphere;
  if (!sphere) out = {};
  Place place;
  place.long_px = sphere ? outline_.radius_px : outline_.half_long_px;
  place.short_px = outline_.half_short_px;
  place.per_long = static_cast<float>(1.0 / place.long_px);
  place.per_short =
      sphere ? 0.0F : static_cast<float>(1.0 / outline_.half_short_px);
  place.w_px = static_cast<float>(smear_.blur_px_);
  for (const auto& [s, weight] : smear_.nodes_) {
    place.weight = static_cast<float>(weight);
    const double x_way = s * smear_.travel_px_.x_px;
    const double y_way = s * smear_.travel_px_.y_px;
    const double turn = s * smear_.turn_rad_;
    place.d_open_x = static_cast<float>(x_way);
    place.d_open_y = static_cast<float>(y_way);
    place.d_open_angle = static_cast<float>(turn);
    place.x_px = outline_.centre.x_px + smear_.open_ * x_way;
    place.y_px = outline_.centre.y_px + smear_.open_ * y_way;
    const double angle = outline_.angle_rad + smear_.open_ * turn;
    place.cosine = std::cos(angle);
    place.sine = std::sin(angle);
    if (small_) {
      AddSmallDisc(place, *small_, x, y, out);
    } else if (sphere) {
      AddLargeDisc(place, x, y, out);
    } else {
      AddRectangle(place, x, y, out);
    }
    place.first = false;
  }
}

}  // namespace touchdown::vision
