#include "path_trend.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "track_shape.h"

namespace touchdown::vision {
namespace {

// Robust polynomial (Tukey's weights) of v on x, which lies within -1 .. 1.
struct Polynomial {
  Eigen::Vector3d terms = Eigen::Vector3d::Zero();
  double square = 0.0;  // sum of the weighted squares
  bool good = false;
  double At(double x) const { return terms[0] + x * (terms[1] + x * terms[2]); }
};

Polynomial Fit(const std::vector<double>& x, const std::vector<double>& v,
               int degree) {
  constexpr int kRounds = 15;
  constexpr double kOfMedian = 1.4826;  // of |normal|
  constexpr double kTukey = 4.685;
  Polynomial fit;
  fit.terms[0] = Median(v);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> off;
    off.reserve(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) {
      off.push_back(std::abs(v[i] - fit.At(x[i])));
    }
    const double cut = kTukey * std::max(kOfMedian * Median(off), 1e-6);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    fit.square = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const double t = off[i] / cut;
      const double w = t < 1.0 ? (1.0 - t * t) * (1.0 - t * t) : 0.0;
      Eigen::Vector3d row(1.0, x[i], x[i] * x[i]);
      if (degree < 2) row[2] = 0.0;
      normal += w * row * row.transpose();
      right += w * v[i] * row;
      fit.square += std::min(1.0, t * t) * cut * cut;
    }
    if (degree < 2) normal(2, 2) = 1.0;
    const Eigen::LDLT<Eigen::Matrix3d> factor(normal);
    constexpr double kLeastPivot = 1e-9;
    fit.good =
        factor.vectorD().minCoeff() > kLeastPivot * factor.vectorD().maxCoeff();
    if (!fit.good) return fit;
    fit.terms = factor.solve(right);
  }
  return fit;
}

// The straight line and the bend apart: x^2 - 1 vanishes at both ends.
double BendOf(const Polynomial& fit) { return -fit.terms[2]; }

// Whether gravity is carried: the gaps' acceleration that the bend makes is
// small beside that along the ground.
bool FallsLittle(const PlaneTrack& track, double half_px,
                 const Polynomial& bent) {
  std::vector<double> t, s;
  const double begin = track.samples.front().time_s;
  const double half_s = 0.5 * (track.samples.back().time_s - begin);
  if (!(half_s > 0.0)) return false;
  for (const PlaneSample& sample : track.samples) {
    t.push_back((sample.time_s - begin) / half_s - 1.0);
    s.push_back(sample.along_px / half_px);
  }
  const Polynomial along = Fit(t, s, 2);
  if (!along.good) return false;
  // In half paths over the square of half the time: gap'' = 2 b (x')^2.
  const double across =
      std::abs(2.0 * bent.terms[2] / half_px * along.terms[1] * along.terms[1]);
  return across < kCarried * std::abs(2.0 * along.terms[2]);
}

bool AsksForBend(const PlaneTrack& track, double half_px,
                 const Polynomial& line, const Polynomial& bent) {
  if (track.ground.source != calib::GroundSource::kContactPoints &&
      track.ground.source != calib::GroundSource::kDetected) {
    return false;
  }
  // Barrel and pincushion of ordinary lenses bend a line by up to 1 %.
  constexpr double kMostBend = 0.01;
  if (!bent.good || std::abs(BendOf(bent)) > kMostBend * 2.0 * half_px) {
    return false;
  }
  // Positive evidence begins at 2, strong at 6 (Kass and Raftery 1995).
  constexpr double kStrong = 6.0;
  const auto n = static_cast<double>(track.samples.size());
  const double gain =
      n * std::log(line.square / std::max(bent.square, 1e-300)) - std::log(n);
  return gain > kStrong && FallsLittle(track, half_px, bent);
}

}  // namespace

PathTrend TakeOutTrend(PlaneTrack& track) {
  auto& samples = track.samples;
  const auto [least, most] =
      std::minmax_element(samples.begin(), samples.end(),
                          [](const PlaneSample& a, const PlaneSample& b) {
                            return a.along_px < b.along_px;
                          });
  const double middle = 0.5 * (least->along_px + most->along_px);
  const double half_px = 0.5 * (most->along_px - least->along_px);
  PathTrend trend;
  if (!(half_px > 0.0)) return trend;
  std::vector<double> x, gap;
  for (const PlaneSample& s : samples) {
    x.push_back((s.along_px - middle) / half_px);
    gap.push_back(s.gap_px);
  }
  Polynomial fit = Fit(x, gap, 1);
  if (!fit.good) return trend;
  if (const Polynomial bent = Fit(x, gap, 2);
      AsksForBend(track, half_px, fit, bent)) {
    fit = bent;
    trend.bend_px = BendOf(bent);
  }
  const double slope = fit.terms[1] / half_px;
  if (std::abs(slope) > kMostInclined_rad) return {};
  trend.slope_rad = slope;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double off = fit.At(x[i]) - fit.terms[0];
    samples[i].gap_px -= off;
    samples[i].height_px -= off;
  }
  return trend;
}

}  // namespace touchdown::vision
