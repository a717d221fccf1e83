#include "outline_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "lanes.h"

namespace touchdown::vision {
namespace {

// exp(-y), 0 <= y <= 700, to 1e-9 of itself: 2^-n exp(-r), |r| <= ln(2)/2. The
// sum with 1.5 * 2^52 rounds to a whole number, whose bits are then at hand.
TOUCHDOWN_INLINE void ExpOfMinus(const Four& y, Four& result) {
  constexpr double kRound = 0x1.8p52;
  const Four shifted = y * std::numbers::log2e + kRound;
  const Four r = y - (shifted - kRound) * std::numbers::ln2;
  const Four series =
      1.0 +
      r * (-1.0 +
           r * (1.0 / 2 +
                r * (-1.0 / 6 +
                     r * (1.0 / 24 +
                          r * (-1.0 / 120 +
                               r * (1.0 / 720 +
                                    r * (-1.0 / 5040 + r * (1.0 / 40320))))))));
  constexpr std::uint64_t kOne = std::bit_cast<std::uint64_t>(1.0);
  const FourBits scale = kOne - (__builtin_bit_cast(FourBits, shifted) << 52);
  result = series * __builtin_bit_cast(Four, scale);
}

// The normal distribution to 7.5e-8 (Abramowitz and Stegun 26.2.17) and its
// density: two thirds of a fit's time went into erfc and exp.
TOUCHDOWN_INLINE void NormalAt(const Four& z, Four& cdf, Four& pdf) {
  constexpr double kInverseSqrt2Pi = 0.3989422804014327;
  constexpr Four kMost = {37.0, 37.0, 37.0, 37.0};  // the density is 1e-298
  const Four size = z < 0.0 ? -z : z;
  const Four near = size < kMost ? size : kMost;
  ExpOfMinus(0.5 * near * near, pdf);
  pdf = pdf * kInverseSqrt2Pi;
  const Four t = 1.0 / (1.0 + 0.2316419 * near);
  const Four tail =
      pdf * t *
      (0.319381530 +
       t * (-0.356563782 +
            t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  cdf = z > 0.0 ? 1.0 - tail : tail;
}

// A body at rest at one place of its way.
struct Place {
  double x_px = 0.0;
  double y_px = 0.0;
  double long_px = 0.0;   // radius, or half the long side
  double short_px = 0.0;  // half the short side
  double per_long = 0.0;
  double per_short = 0.0;
  double cosine = 1.0;
  double sine = 0.0;
  double w_px = 1.0;      // blur
  double d_open_x = 0.0;  // of the place by the exposed share
  double d_open_y = 0.0;
};

// A blurred disc's value at distance r from its centre, with its derivatives.
struct DiscProfile {
  double value = 0.0;
  double d_r = 0.0;
  double d_radius = 0.0;
  double d_w = 0.0;
};

// By quadrature over chords, for discs of a few w, where the series does not
// see the far side of the edge:
//   2 int_0^(pi/2) phi_w(R sin t) (Phi((r + h)/w) - Phi((r - h)/w)) h dt,
// h = R cos t; its derivative by R is the blurred circle itself.
DiscProfile SmallDisc(double r, double radius, double w) {
  // Gauss-Legendre, 10 nodes on [0, 1].
  constexpr double kNode[10] = {0.0130467357414141, 0.0674683166555077,
                                0.1602952158504878, 0.2833023029353764,
                                0.4255628305091844, 0.5744371694908156,
                                0.7166976970646236, 0.8397047841495122,
                                0.9325316833444923, 0.9869532642585859};
  constexpr double kWeight[10] = {0.0333356721543441, 0.0747256745752903,
                                  0.1095431812579910, 0.1346333596549982,
                                  0.1477621123573764, 0.1477621123573764,
                                  0.1346333596549982, 0.1095431812579910,
                                  0.0747256745752903, 0.0333356721543441};
  constexpr double kHalfPi = 0.5 * std::numbers::pi;
  DiscProfile p;
  for (int i = 0; i < 10; ++i) {
    const double t = kHalfPi * kNode[i];
    const double cosine = std::cos(t);
    const double h = radius * cosine;
    const double y = radius * std::sin(t);
    Four cdf;
    Four pdf;
    NormalAt(Four{(r + h) / w, (r - h) / w, y / w, 0.0}, cdf, pdf);
    const double weight = 2.0 * kHalfPi * kWeight[i] * h * pdf[2] / w;
    p.value += weight * (cdf[0] - cdf[1]);
    p.d_r += weight * (pdf[0] - pdf[1]) / w;
    const auto on_circle = [&](double c) {
      const double apart2 = r * r + radius * radius - 2.0 * r * radius * c;
      return std::exp(-0.5 * apart2 / (w * w));
    };
    p.d_radius += kWeight[i] * 0.5 * radius / (w * w) *
                  (on_circle(cosine) + on_circle(-cosine));
  }
  // It depends on r/w and R/w alone.
  p.d_w = -(r * p.d_r + radius * p.d_radius) / w;
  return p;
}

// Adds the numbers of a disc at four pixels from number i on.
struct FourOfDisc {
  Four dx, dy;
  Four outwards;  // minus the derivative by r, over r
  Four value, d_radius, d_w;
};
TOUCHDOWN_INLINE void AddDisc(const Place& place, const FourOfDisc& disc,
                              std::size_t i, CoverBlock& out) {
  const Four d_x = disc.outwards * disc.dx;
  const Four d_y = disc.outwards * disc.dy;
  FourAt(&out.value[i]) += disc.value;
  FourAt(&out.d_shape[0][i]) += d_x;
  FourAt(&out.d_shape[1][i]) += d_y;
  FourAt(&out.d_shape[2][i]) += disc.d_radius;
  FourAt(&out.d_blur[i]) += disc.d_w;
  FourAt(&out.d_open[i]) += d_x * place.d_open_x + d_y * place.d_open_y;
  FourAt(&out.xi[i]) += disc.dx * place.per_long;
  FourAt(&out.eta[i]) += disc.dy * place.per_long;
}

struct alignas(64) Distances {
  BlockColumn dx;
  BlockColumn dy;
  BlockColumn r;
};

constexpr double kAtCentre_px = 1e-12;  // no direction there, and no edge

// As a series in e = w/R, s = (r - R)/w, from the heat equation
// u_t = u_rr + u_r/r with 2 t = w^2:
//   Phi(-s) + phi(s) (-e/2 + 3/8 e^2 s - e^3 (1 + 5 s^2)/16) + O(e^4)
TOUCHDOWN_WIDEST
void AddLargeDisc(const Place& place, const double* x, const double* y,
                  CoverBlock& out) {
  Distances at;
  for (std::size_t i = 0; i < kBlock; ++i) {
    at.dx[i] = x[i] - place.x_px;
    at.dy[i] = y[i] - place.y_px;
    at.r[i] = std::sqrt(at.dx[i] * at.dx[i] + at.dy[i] * at.dy[i]);
  }
  const double per_w = 1.0 / place.w_px;
  const double e = place.w_px / place.long_px;
  for (std::size_t i = 0; i < kBlock; i += 4) {
    const Four r = FourAt(&at.r[i]);
    const Four s = (r - place.long_px) * per_w;
    Four cdf;
    Four pdf;
    NormalAt(-s, cdf, pdf);
    const Four square = 0.0625 * (1.0 + 5.0 * s * s);
    const Four g = e * (-0.5 + e * (0.375 * s - e * square));
    const Four g_s = e * e * (0.375 - 0.625 * e * s);
    const Four g_e = -0.5 + e * (0.75 * s - 3.0 * e * square);
    const Four by_s = pdf * (-1.0 - s * g + g_s) * per_w;
    const Four by_e = pdf * g_e * place.per_long;
    FourOfDisc disc;
    disc.dx = FourAt(&at.dx[i]);
    disc.dy = FourAt(&at.dy[i]);
    disc.outwards = -by_s / (r + kAtCentre_px);
    disc.value = cdf + pdf * g;
    disc.d_radius = -by_s - by_e * e;
    disc.d_w = by_e - by_s * s;
    AddDisc(place, disc, i, out);
  }
}

void AddSmallDisc(const Place& place, const double* x, const double* y,
                  CoverBlock& out) {
  for (std::size_t i = 0; i < kBlock; i += 4) {
    FourOfDisc disc;
    for (std::size_t l = 0; l < 4; ++l) {
      disc.dx[l] = x[i + l] - place.x_px;
      disc.dy[l] = y[i + l] - place.y_px;
      const double r =
          std::sqrt(disc.dx[l] * disc.dx[l] + disc.dy[l] * disc.dy[l]);
      const DiscProfile p = SmallDisc(r, place.long_px, place.w_px);
      disc.outwards[l] = -p.d_r / (r + kAtCentre_px);
      disc.value[l] = p.value;
      disc.d_radius[l] = p.d_radius;
      disc.d_w[l] = p.d_w;
    }
    AddDisc(place, disc, i, out);
  }
}

TOUCHDOWN_WIDEST
void AddRectangle(const Place& place, const double* x, const double* y,
                  CoverBlock& out) {
  const double per_w = 1.0 / place.w_px;
  Distances at;
  for (std::size_t i = 0; i < kBlock; ++i) {
    at.dx[i] = x[i] - place.x_px;
    at.dy[i] = y[i] - place.y_px;
  }
  for (std::size_t i = 0; i < kBlock; i += 4) {
    const Four dx = FourAt(&at.dx[i]);
    const Four dy = FourAt(&at.dy[i]);
    const Four u = dx * place.cosine + dy * place.sine;
    const Four v = dy * place.cosine - dx * place.sine;
    const Four up = (u + place.long_px) * per_w;
    const Four um = (u - place.long_px) * per_w;
    const Four vp = (v + place.short_px) * per_w;
    const Four vm = (v - place.short_px) * per_w;
    Four above_u, below_u, above_v, below_v;  // the slab's two sides
    Four pup, pum, pvp, pvm;
    NormalAt(up, above_u, pup);
    NormalAt(um, below_u, pum);
    NormalAt(vp, above_v, pvp);
    NormalAt(vm, below_v, pvm);
    pup *= per_w;
    pum *= per_w;
    pvp *= per_w;
    pvm *= per_w;
    const Four along = above_u - below_u;
    const Four across = above_v - below_v;
    const Four d_u = (pup - pum) * across;
    const Four d_v = (pvp - pvm) * along;
    const Four d_x = d_v * place.sine - d_u * place.cosine;
    const Four d_y = -d_u * place.sine - d_v * place.cosine;
    FourAt(&out.value[i]) += along * across;
    FourAt(&out.d_shape[0][i]) += d_x;
    FourAt(&out.d_shape[1][i]) += d_y;
    FourAt(&out.d_shape[2][i]) += (pup + pum) * across;
    FourAt(&out.d_shape[3][i]) += (pvp + pvm) * along;
    FourAt(&out.d_shape[4][i]) += d_u * v - d_v * u;
    FourAt(&out.d_blur[i]) -=
        (up * pup - um * pum) * across + (vp * pvp - vm * pvm) * along;
    FourAt(&out.d_open[i]) += d_x * place.d_open_x + d_y * place.d_open_y;
    FourAt(&out.xi[i]) += u * place.per_long;
    FourAt(&out.eta[i]) += v * place.per_short;
  }
}

void Scale(double factor, BlockColumn& column) {
  for (double& value : column) value *= factor;
}

}  // namespace

double Smear::way_px() const {
  return open_ * std::hypot(travel_px_.x_px, travel_px_.y_px);
}

void Smear::Set(double blur_px, double open, bool resolved) {
  constexpr double kStep = 0.7;         // of the blur
  constexpr double kNegligible = 0.15;  // of the blur: its square adds 0.2 %
  blur_px_ = blur_px;
  open_ = open;
  const double way = way_px();
  places_ = 1;
  if (way > kNegligible * blur_px || resolved) {
    constexpr int kMost = 96;
    places_ = std::clamp(static_cast<int>(std::ceil(way / (kStep * blur_px))),
                         2, kMost);
  }
  const double step = way / places_;
  place_blur_px_ = std::sqrt(blur_px * blur_px + step * step / 12.0);
}

OutlineImage::OutlineImage(const Outline& outline, const Smear& smear)
    : outline_(outline), smear_(smear) {}

void OutlineImage::Cover(const double* x, const double* y,
                         CoverBlock& out) const {
  out = {};
  const bool sphere = outline_.kind == core::BodyKind::kSphere;
  Place place;
  place.long_px = sphere ? outline_.radius_px : outline_.half_long_px;
  place.short_px = outline_.half_short_px;
  place.per_long = 1.0 / place.long_px;
  place.per_short = sphere ? 0.0 : 1.0 / place.short_px;
  place.cosine = std::cos(outline_.angle_rad);
  place.sine = std::sin(outline_.angle_rad);
  const int places = smear_.places_;
  const double share = 1.0 / places;
  place.w_px = smear_.place_blur_px_;
  constexpr double kSeriesFrom = 4.0;  // R/w; the series is good to 3e-4
  const bool small = sphere && place.long_px < kSeriesFrom * place.w_px;
  for (int i = 0; i < places; ++i) {
    const double s = places == 1 ? 0.0 : (i + 0.5) * share - 0.5;
    place.d_open_x = s * smear_.travel_px_.x_px;
    place.d_open_y = s * smear_.travel_px_.y_px;
    place.x_px = outline_.centre.x_px + smear_.open_ * place.d_open_x;
    place.y_px = outline_.centre.y_px + smear_.open_ * place.d_open_y;
    if (small) {
      AddSmallDisc(place, x, y, out);
    } else if (sphere) {
      AddLargeDisc(place, x, y, out);
    } else {
      AddRectangle(place, x, y, out);
    }
  }
  if (places == 1) return;
  Scale(share, out.value);
  for (BlockColumn& column : out.d_shape) Scale(share, column);
  Scale(share * smear_.blur_px_ / smear_.place_blur_px_, out.d_blur);
  Scale(share, out.d_open);
  Scale(share, out.xi);
  Scale(share, out.eta);
}

}  // namespace touchdown::vision
