// Least squares of one coordinate over frames that are added one by one.
#pragma once

#include <algorithm>

#include "numbers/lanes.h"

namespace touchdown::vision {

// Weighted sums of one coordinate over some frames, with the time in frames and
// the value relative to the first of them: no digits cancel.
// T: a number, or an array of them, one for each of several coordinates.
template <class T>
struct MomentsOf {
  T w = {}, t = {}, tt = {}, ttt = {}, tttt = {};
  T y = {}, ty = {}, tty = {}, yy = {};

  TOUCHDOWN_INLINE void Add(const T& time, const T& value, const T& weight) {
    const T wt = weight * time;
    const T wtt = wt * time;
    const T wy = weight * value;
    w += weight;
    t += wt;
    tt += wtt;
    ttt += wtt * time;
    tttt += wtt * time * time;
    y += wy;
    ty += wt * value;
    tty += wtt * value;
    yy += wy * value;
  }
  MomentsOf<double> SelectSeries(int k) const {
    return {w[k], t[k], tt[k], ttt[k], tttt[k], y[k], ty[k], tty[k], yy[k]};
  }
};
using Moments = MomentsOf<double>;

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
    // Of the sum of squares: below it all frames are of one instant, to
    // rounding.
    constexpr double kOneInstant = 1e-9;
    if (seen > kOneInstant * (m.tt + m.w)) {
      spread = seen;
      slope = lean / spread;
      rss1 -= slope * lean;
      offset = m.tt / m.w;
      tilt = (m.ttt - middle * m.tt) / spread;
      const double bowed =
          m.tttt - offset * m.tt - tilt * (m.ttt - middle * m.tt);
      const double bow = m.tty - offset * m.y - tilt * lean;
      if (bowed > kOneInstant * m.tttt) {
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
