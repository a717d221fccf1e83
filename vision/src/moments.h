// Least squares of one coordinate over frames that are added one by one.
#pragma once

#include <algorithm>

namespace touchdown::vision {

// Weighted sums of one coordinate over some frames, with the time in frames and
// the value relative to the first of them: no digits cancel.
struct Moments {
  double w = 0, t = 0, tt = 0, ttt = 0, tttt = 0;
  double y = 0, ty = 0, tty = 0, yy = 0;

  void Add(double time, double value, double weight) {
    const double wt = weight * time;
    const double wtt = wt * time;
    w += weight;
    t += wt;
    tt += wtt;
    ttt += wtt * time;
    tttt += wtt * time * time;
    y += weight * value;
    ty += wt * value;
    tty += wtt * value;
    yy += weight * value * value;
  }
};

// Least squares in orthogonal polynomials: level, slope, bend, and the sums of
// squares left by polynomials of degree 1 and 2.
struct Polynomial {
  double middle = 0, level = 0, slope = 0, bend = 0;
  double offset = 0, tilt = 0;  // of the quadratic term's orthogonal polynomial
  double spread = 0, third = 0;  // precisions of slope and bend; 0: not told
  double rss1 = 0, rss2 = 0;

  Polynomial() = default;
  explicit Polynomial(const Moments& m) {
    if (!(m.w > 0.0)) return;
    middle = m.t / m.w;
    level = m.y / m.w;
    const double seen = m.tt - m.t * middle;
    const double lean = m.ty - middle * m.y;
    rss1 = m.yy - level * m.y;
    constexpr double kLeast = 1e-9;  // of the sum: one instant
    if (seen > kLeast * (m.tt + m.w)) {
      spread = seen;
      slope = lean / spread;
      rss1 -= slope * lean;
      offset = m.tt / m.w;
      tilt = (m.ttt - middle * m.tt) / spread;
      const double bowed =
          m.tttt - offset * m.tt - tilt * (m.ttt - middle * m.tt);
      const double bow = m.tty - offset * m.y - tilt * lean;
      if (bowed > kLeast * m.tttt) {
        third = bowed;
        bend = bow / third;
        rss2 = bend * bow;
      }
    }
    rss1 = std::max(0.0, rss1);
    rss2 = std::max(0.0, rss1 - rss2);
  }
  double Line(double t) const { return level + slope * (t - middle); }
  double Parabola(double t) const {
    return Line(t) + bend * (t * t - offset - tilt * (t - middle));
  }
};

}  // namespace touchdown::vision
