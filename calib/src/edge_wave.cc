#include "edge_wave.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace touchdown::calib {
namespace {

// What is off the line, with its weights.
struct Residuals {
  std::vector<double> x;  // from the middle
  std::vector<double> r;
  std::vector<double> w;
};

struct WaveFit {
  Eigen::Vector4d terms = Eigen::Vector4d::Zero();  // 1, x / span, cos, sin
  double squares = 0.0;                             // weighted, that remain
};

WaveFit FitWave(const Residuals& points, double k, double span) {
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  double all = 0.0;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    const Eigen::Vector4d row(1.0, points.x[i] / span,
                              std::cos(k * points.x[i]),
                              std::sin(k * points.x[i]));
    a.noalias() += points.w[i] * row * row.transpose();
    b.noalias() += points.w[i] * points.r[i] * row;
    all += points.w[i] * points.r[i] * points.r[i];
  }
  WaveFit fit;
  fit.terms = a.ldlt().solve(b);
  fit.squares = all - fit.terms.dot(b);
  return fit;
}

}  // namespace

double TakeOutWave(const Line& line, double middle,
                   const std::vector<double>& weights,
                   std::vector<EdgePoint>& points) {
  Residuals off;
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    const double x = points[i].x - middle;
    off.x.push_back(x);
    off.r.push_back(points[i].y - line.offset - line.slope * x);
    off.w.push_back(weights[i]);
    squares += weights[i] * off.r.back() * off.r.back();
  }

  // Points: a wave has three parameters, and is sought at many wavelengths. Not
  // studied.
  constexpr std::size_t kMinPoints = 32;
  if (off.x.size() < kMinPoints) return 0.0;
  const double span = off.x.back() - off.x.front();
  // px of a wave: shorter ones are the pixels' own pattern. Not studied.
  constexpr double kShortest_px = 8.0;
  constexpr double kLeastSeen = 2.0;  // waves in the span
  constexpr double kPerWidth = 6.0;   // tried within the width of a peak
  const double first = kLeastSeen / span;
  const double last = 1.0 / kShortest_px;
  double step = 1.0 / (kPerWidth * span);
  double best = 0.0;
  double least = squares;
  const auto look = [&](double per_px) {
    const double remains =
        FitWave(off, 2.0 * std::numbers::pi * per_px, span).squares;
    if (remains >= least) return;
    least = remains;
    best = per_px;
  };
  const int tried = static_cast<int>((last - first) / step);
  for (int i = 0; i <= tried; ++i) look(first + i * step);
  // Share of the squares that one wave may leave: it must explain three
  // quarters of them. Larger takes noise for a wave; smaller leaves a wavy edge
  // to a straight line. Chosen with the wavy edges of the accuracy design.
  constexpr double kMaxRemaining = 0.25;
  if (!(least < kMaxRemaining * squares)) return 0.0;
  // Finer about the best one.
  constexpr int kHalvings = 12;
  for (int i = 0; i < kHalvings; ++i) {
    step *= 0.5;
    const double centre = best;
    look(centre - step);
    look(centre + step);
  }
  const double k = 2.0 * std::numbers::pi * best;
  const WaveFit fit = FitWave(off, k, span);
  for (EdgePoint& p : points) {
    const double x = p.x - middle;
    p.y -= fit.terms[2] * std::cos(k * x) + fit.terms[3] * std::sin(k * x);
  }
  return std::hypot(fit.terms[2], fit.terms[3]);
}

}  // namespace touchdown::calib
