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
  Eigen::ArrayXd x;  // from the middle
  Eigen::ArrayXd r;
  Eigen::ArrayXd w;
};

// cos(k x) and sin(k x) of all points.
struct Wave {
  Eigen::ArrayXd cosine;
  Eigen::ArrayXd sine;
};

Wave MakeWave(const Eigen::ArrayXd& x, double k) {
  return {(k * x).cos(), (k * x).sin()};
}

// The wave of the wavenumber that is larger by `step`'s.
void Add(const Wave& step, Wave& wave) {
  const Eigen::ArrayXd cosine =
      wave.cosine * step.cosine - wave.sine * step.sine;
  wave.sine = wave.sine * step.cosine + wave.cosine * step.sine;
  wave.cosine = cosine;
}

struct WaveFit {
  Eigen::Vector4d terms = Eigen::Vector4d::Zero();  // 1, x / span, cos, sin
  double squares = 0.0;                             // weighted, that remain
};

WaveFit FitWave(const Residuals& points, const Wave& wave, double span) {
  Eigen::Matrix<double, Eigen::Dynamic, 4> rows(points.x.size(), 4);
  rows.col(0).setOnes();
  rows.col(1) = points.x / span;
  rows.col(2) = wave.cosine;
  rows.col(3) = wave.sine;
  const auto weighted =
      (rows.array().colwise() * points.w).matrix().transpose().eval();
  const Eigen::Matrix4d a = weighted * rows;
  const Eigen::Vector4d b = weighted * points.r.matrix();
  WaveFit fit;
  fit.terms = a.ldlt().solve(b);
  fit.squares = (points.w * points.r.square()).sum() - fit.terms.dot(b);
  return fit;
}

}  // namespace

double TakeOutWave(const Line& line, double middle,
                   const std::vector<double>& weights,
                   std::vector<EdgePoint>& points) {
  std::vector<std::size_t> taken;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (weights[i] > 0.0) taken.push_back(i);
  }
  // Points: a wave has three parameters, and is sought at many wavelengths. Not
  // studied.
  constexpr std::size_t kMinPoints = 32;
  if (taken.size() < kMinPoints) return 0.0;
  const auto count = static_cast<Eigen::Index>(taken.size());
  Residuals off{Eigen::ArrayXd(count), Eigen::ArrayXd(count),
                Eigen::ArrayXd(count)};
  for (Eigen::Index n = 0; n < count; ++n) {
    const std::size_t i = taken[static_cast<std::size_t>(n)];
    off.x[n] = points[i].x - middle;
    off.r[n] = points[i].y - line.At(off.x[n]);
    off.w[n] = weights[i];
  }
  const double squares = (off.w * off.r.square()).sum();
  const double span = off.x[count - 1] - off.x[0];
  // px of a wave: shorter ones are the pixels' own pattern. Not studied.
  constexpr double kShortest_px = 8.0;
  constexpr double kLeastSeen = 2.0;  // waves in the span
  constexpr double kPerWidth = 6.0;   // tried within the width of a peak
  const double first = kLeastSeen / span;
  const double last = 1.0 / kShortest_px;
  double step = 1.0 / (kPerWidth * span);
  double best = 0.0;
  double least = squares;
  const auto look = [&](double per_px, const Wave& wave) {
    const double remains = FitWave(off, wave, span).squares;
    if (remains >= least) return;
    least = remains;
    best = per_px;
  };
  const auto wave_at = [&](double per_px) {
    return MakeWave(off.x, 2.0 * std::numbers::pi * per_px);
  };
  const int tried = static_cast<int>((last - first) / step);
  Wave wave = wave_at(first);
  const Wave one_step = wave_at(step);
  for (int i = 0; i <= tried; ++i, Add(one_step, wave)) {
    look(first + i * step, wave);
  }
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
    look(centre - step, wave_at(centre - step));
    look(centre + step, wave_at(centre + step));
  }
  const double k = 2.0 * std::numbers::pi * best;
  const WaveFit fit = FitWave(off, MakeWave(off.x, k), span);
  for (EdgePoint& p : points) {
    const double x = p.x - middle;
    p.y -= fit.terms[2] * std::cos(k * x) + fit.terms[3] * std::sin(k * x);
  }
  return std::hypot(fit.terms[2], fit.terms[3]);
}

}  // namespace touchdown::calib
