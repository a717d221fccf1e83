// A track with known truth, without a pixel: a sphere that the air slows.
#pragma once

#include <cmath>
#include <random>

#include "touchdown/calib/plane.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision::synthetic {

inline constexpr double kGravity = 9807.0;  // px/s^2, at 1000 px/m
inline constexpr double kLight = 1.3e-4;    // a table-tennis ball at 1000 px/m

// A sphere of 40 px that falls on the line, rebounds, and falls again, in air.
// The path is integrated by the midpoint rule in small steps, about the
// impacts.
struct Bounce {
  double k = 0.0;
  double fps = 240.0;
  double v_t = 300.0;
  double v_in = 4000.0;
  double restitution = 0.8;
  double u_px = 0.05;

  PlaneSample At(double t, double v_n) const {
    constexpr int kSteps = 2000;
    double x = 0.0, y = 0.0, vx = v_t, vy = v_n;
    const double h = t / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double by = -k * std::hypot(vx, vy);
      const double mx = vx + 0.5 * h * by * vx;
      const double my = vy + 0.5 * h * (by * vy - kGravity);
      const double mid = -k * std::hypot(mx, my);
      x += h * mx;
      y += h * my;
      vx += h * mid * mx;
      vy += h * (mid * my - kGravity);
    }
    PlaneSample s;
    s.along_px = x;
    s.height_px = 20.0 + y;
    s.gap_px = y;
    s.u_along_px = s.u_height_px = s.u_gap_px = u_px;
    return s;
  }

  // 60 frames before an impact between two frames, 60 after it.
  PlaneTrack Film(std::mt19937_64& engine) const {
    std::normal_distribution<double> noise(0.0, u_px);
    PlaneTrack track;
    track.half_long_px = track.half_short_px = 20.0;
    track.size_px = 40.0;
    track.u_half_px = 0.01;
    track.frame_interval_s = 1.0 / fps;
    track.last_frame = 120;
    track.ground = calib::MakeGroundLine({0, 0}, {1000, 0});
    track.ground.u_offset_px = 0.01;
    track.ground.u_angle_rad = 1e-4;
    for (int frame = 0; frame < 120; ++frame) {
      const double t = (frame - 59.6) / fps;
      PlaneSample s = At(t, t < 0.0 ? -v_in : restitution * v_in);
      s.frame = frame;
      s.time_s = frame / fps;
      s.along_px += noise(engine);
      const double off = noise(engine);
      s.height_px += off;
      s.gap_px += off;
      track.samples.push_back(s);
    }
    return track;
  }
};

}  // namespace touchdown::vision::synthetic
