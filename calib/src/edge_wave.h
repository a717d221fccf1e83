// An edge that goes up and down evenly: tiles, a corrugated sheet. A straight
// line through it is drawn to the waves that the picture shows in part.
#pragma once

#include <vector>

namespace touchdown::calib {

struct EdgePoint {
  double x = 0.0;
  double y = 0.0;
  double strength = 0.0;  // step in DN, signed downwards
};

// y = offset + slope * (x - middle)
struct Line {
  double offset = 0.0;
  double slope = 0.0;
  double At(double x_from_middle) const {
    return offset + slope * x_from_middle;
  }
};

// Takes the one wave  a cos(k x) + b sin(k x)  out of the points that, fitted
// together with a straight line, explains the most of what is off `line`; at
// least two of it and at most one in eight pixels must be seen. Only where it
// explains three quarters of the squares: waves that do are no accident of
// noise, texture or one bump. Returns its amplitude, px; 0: no wave.
double TakeOutWave(const Line& line, double middle,
                   const std::vector<double>& weights,
                   std::vector<EdgePoint>& points);

}  // namespace touchdown::calib
