// The blurred coverage of a pixel by a disc or a rectangle, with its
// derivatives: the model that outline.cc fits. Inline: by far most of a fit's
// time is here.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "touchdown/vision/outline.h"

namespace touchdown::vision {

// The normal distribution and its density by linear interpolation, to 1e-7: two
// thirds of a fit's time went into erfc and exp.
class NormalTable {
 public:
  struct Value {
    double cdf = 0.0;
    double pdf = 0.0;
  };
  NormalTable() {
    constexpr double kInverseSqrt2Pi = 0.3989422804014327;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const double z = static_cast<double>(i) / kPerUnit - kReach;
      entries_[i] = {0.5 * std::erfc(-z / std::numbers::sqrt2),
                     kInverseSqrt2Pi * std::exp(-0.5 * z * z)};
    }
  }
  static const NormalTable& Shared() {
    static const NormalTable table;
    return table;
  }
  Value At(double z) const {
    const double at = (z + kReach) * kPerUnit;
    if (!(at > 0.0)) return {0.0, 0.0};
    if (at >= static_cast<double>(entries_.size() - 1)) return {1.0, 0.0};
    const auto i = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(i);
    const Value& a = entries_[i];
    const Value& b = entries_[i + 1];
    return {a.cdf + share * (b.cdf - a.cdf), a.pdf + share * (b.pdf - a.pdf)};
  }

 private:
  static constexpr double kReach = 6.0;  // the rest is 1e-9
  static constexpr double kPerUnit = 512.0;
  std::array<Value, 2 * 6 * 512 + 1> entries_;
};

// Coverage of one pixel and its derivatives by (x, y, size1, size2, angle, w).
struct Coverage {
  double value = 0.0;
  double d[6] = {0, 0, 0, 0, 0, 0};
  double d_open = 0.0;  // by the share of the frame interval that is exposed
  double xi = 0.0;      // position in the body, in units of its size
  double eta = 0.0;
};

// What the levels are polynomials of.
inline void Polynomial(double xi, double eta, std::array<double, 6>& f) {
  f = {1.0, xi, eta, xi * xi, xi * eta, eta * eta};
}

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
inline DiscProfile SmallDisc(const NormalTable& normal, double r, double radius,
                             double w) {
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
    const double h = radius * std::cos(t);
    const double y = radius * std::sin(t);
    const NormalTable::Value far = normal.At((r + h) / w);
    const NormalTable::Value near = normal.At((r - h) / w);
    const double weight =
        2.0 * kHalfPi * kWeight[i] * h * normal.At(y / w).pdf / w;
    p.value += weight * (far.cdf - near.cdf);
    p.d_r += weight * (far.pdf - near.pdf) / w;
    const auto on_circle = [&](double cosine) {
      const double apart2 = r * r + radius * radius - 2.0 * r * radius * cosine;
      return std::exp(-0.5 * apart2 / (w * w));
    };
    const double cosine = std::cos(t);
    p.d_radius += kWeight[i] * 0.5 * radius / (w * w) *
                  (on_circle(cosine) + on_circle(-cosine));
  }
  // It depends on r/w and R/w alone.
  p.d_w = -(r * p.d_r + radius * p.d_radius) / w;
  return p;
}

// The image of a body at rest, blurred by w. What is the same for all pixels is
// worked out once.
class StillImage {
 public:
  StillImage(const Outline& outline, double w, double cosine, double sine)
      : normal_(NormalTable::Shared()),
        sphere_(outline.kind == core::BodyKind::kSphere),
        centre_(outline.centre),
        a_(sphere_ ? outline.radius_px : outline.half_long_px),
        b_(outline.half_short_px),
        w_(w),
        cosine_(cosine),
        sine_(sine),
        per_w_(1.0 / w),
        per_a_(1.0 / a_),
        per_b_(1.0 / b_) {}

  Coverage At(double x_px, double y_px) const {
    return sphere_ ? Disc(x_px - centre_.x_px, y_px - centre_.y_px)
                   : Rectangle(x_px - centre_.x_px, y_px - centre_.y_px);
  }

 private:
  // As a series in e = w/R, s = (r - R)/w, from the heat equation
  // u_t = u_rr + u_r/r with 2 t = w^2:
  //   Phi(-s) + phi(s) (-e/2 + 3/8 e^2 s - e^3 (1 + 5 s^2)/16) + O(e^4)
  DiscProfile DiscSeries(double r) const {
    const double s = (r - a_) * per_w_;
    const double e = w_ * per_a_;
    const NormalTable::Value normal = normal_.At(-s);
    const double square = 0.0625 * (1.0 + 5.0 * s * s);
    const double g = e * (-0.5 + e * (0.375 * s - e * square));
    const double g_s = e * e * (0.375 - 0.625 * e * s);
    const double g_e = -0.5 + e * (0.75 * s - 3.0 * e * square);
    const double by_s = normal.pdf * (-1.0 - s * g + g_s) * per_w_;
    const double by_e = normal.pdf * g_e * per_a_;
    DiscProfile p;
    p.value = normal.cdf + normal.pdf * g;
    p.d_r = by_s;
    p.d_radius = -by_s - by_e * e;
    p.d_w = -by_s * s + by_e;
    return p;
  }

  Coverage Disc(double dx, double dy) const {
    Coverage c;
    const double r = std::sqrt(dx * dx + dy * dy);
    constexpr double kSeriesFrom = 4.0;  // R/w; the series is good to 3e-4
    const DiscProfile p =
        a_ < kSeriesFrom * w_ ? SmallDisc(normal_, r, a_, w_) : DiscSeries(r);
    c.value = p.value;
    if (r > 1e-9) {
      const double outwards = -p.d_r / r;
      c.d[0] = outwards * dx;
      c.d[1] = outwards * dy;
    }
    c.d[2] = p.d_radius;
    c.d[5] = p.d_w;
    c.xi = dx * per_a_;
    c.eta = dy * per_a_;
    return c;
  }

  Coverage Rectangle(double dx, double dy) const {
    Coverage c;
    const double u = dx * cosine_ + dy * sine_;
    const double v = -dx * sine_ + dy * cosine_;
    const double up = (u + a_) * per_w_, um = (u - a_) * per_w_;
    const double vp = (v + b_) * per_w_, vm = (v - b_) * per_w_;
    const NormalTable::Value nup = normal_.At(up), num = normal_.At(um);
    const NormalTable::Value nvp = normal_.At(vp), nvm = normal_.At(vm);
    const double pup = nup.pdf * per_w_, pum = num.pdf * per_w_;
    const double pvp = nvp.pdf * per_w_, pvm = nvm.pdf * per_w_;
    const double along = nup.cdf - num.cdf;
    const double across = nvp.cdf - nvm.cdf;
    const double d_u = (pup - pum) * across;
    const double d_v = (pvp - pvm) * along;
    c.value = along * across;
    c.d[0] = -d_u * cosine_ + d_v * sine_;
    c.d[1] = -d_u * sine_ - d_v * cosine_;
    c.d[2] = (pup + pum) * across;
    c.d[3] = (pvp + pvm) * along;
    c.d[4] = d_u * v - d_v * u;
    c.d[5] = -((up * pup - um * pum) * across + (vp * pvp - vm * pvm) * along);
    c.xi = u * per_a_;
    c.eta = v * per_b_;
    return c;
  }

  const NormalTable& normal_;
  bool sphere_;
  core::PixelPoint centre_;
  double a_;  // radius, or half the long side
  double b_;  // half the short side
  double w_;
  double cosine_;
  double sine_;
  double per_w_;
  double per_a_;
  double per_b_;
};

// DepthInside of outline.h with the cosine and sine of the angle at hand.
inline double DepthInside(const Outline& outline, double x_px, double y_px,
                          double cosine, double sine) {
  const double dx = x_px - outline.centre.x_px;
  const double dy = y_px - outline.centre.y_px;
  if (outline.kind == core::BodyKind::kSphere) {
    return outline.radius_px - std::sqrt(dx * dx + dy * dy);
  }
  const double out_u = std::abs(dx * cosine + dy * sine) - outline.half_long_px;
  const double out_v =
      std::abs(-dx * sine + dy * cosine) - outline.half_short_px;
  return out_u > 0.0 && out_v > 0.0 ? -std::sqrt(out_u * out_u + out_v * out_v)
                                    : -std::max(out_u, out_v);
}

}  // namespace touchdown::vision
