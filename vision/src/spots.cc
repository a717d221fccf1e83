#include "spots.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "robust.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

using Samples = std::span<const SpotSample>;

// A fall of the squares' sum by so much is no chance: six parameters, hundreds
// of places.
constexpr double kSureFall = 60.0;

// Whether each spot falls off in all directions, from a place on the body.
bool AreSpots(const SpotModel& model, double reach_px) {
  const SpotModel::Vector& k = model.parameters;
  for (int spot = 0; spot < model.spots; ++spot) {
    const int at = SpotModel::kShading + spot * SpotModel::kSpot;
    // The greatest and the least of S's eigenvalues: 1 / width^2.
    const double mean = 0.5 * (k[at + 3] + k[at + 5]);
    const double off = std::hypot(0.5 * (k[at + 3] - k[at + 5]), k[at + 4]);
    const double narrow = mean + off;
    const double wide = mean - off;
    constexpr double kLongest = 5.0;  // in widths
    if (!(wide * reach_px * reach_px > 1.0) ||
        !(wide * kLongest * kLongest > narrow) ||
        !(std::hypot(k[at + 1], k[at + 2]) < reach_px)) {
      return false;
    }
  }
  return k.allFinite();
}

// Over their noise.
std::vector<double> ResidualsOf(Samples samples, const SpotModel& model) {
  std::vector<double> residuals;
  residuals.reserve(samples.size());
  for (const SpotSample& s : samples) {
    residuals.push_back((s.level_dn - model.At(s.x_px, s.y_px, nullptr)) /
                        std::sqrt(s.variance_dn2));
  }
  return residuals;
}

// Where Huber's squares end.
double CutOf(const std::vector<double>& residuals) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (const double r : residuals) sizes.push_back(std::abs(r));
  constexpr double kSquares = 2.0;
  return kSquares * std::max(1.0, kSigmaPerMedian * Median(std::move(sizes)));
}

double HuberCost(const std::vector<double>& residuals, double cut) {
  double cost = 0.0;
  for (const double r : residuals) {
    const double size = std::abs(r);
    cost += size < cut ? 0.5 * r * r : cut * (size - 0.5 * cut);
  }
  return cost;
}

struct SpotEquations {
  SpotModel::Matrix normal;
  SpotModel::Vector gradient;
};

SpotEquations EquationsOf(Samples samples, const SpotModel& model,
                          const std::vector<double>& residuals, double cut,
                          bool curved) {
  const Eigen::Index n = model.parameters.size();
  SpotEquations sums = {SpotModel::Matrix::Zero(n, n),
                        SpotModel::Vector::Zero(n)};
  SpotModel::Vector by(n);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    model.At(samples[i].x_px, samples[i].y_px, &by);
    by /= std::sqrt(samples[i].variance_dn2);
    const double weight = std::min(1.0, cut / std::abs(residuals[i]));
    sums.normal.noalias() += weight * by * by.transpose();
    sums.gradient.noalias() += weight * residuals[i] * by;
  }
  constexpr int kLinear = 3;  // terms
  for (int i = curved ? SpotModel::kShading : kLinear; i < SpotModel::kShading;
       ++i) {
    sums.normal.row(i).setZero();
    sums.normal.col(i).setZero();
    sums.normal(i, i) = 1.0;
    sums.gradient[i] = 0.0;
  }
  return sums;
}

// By how much the squares' sum is less with `after` than with `before`, in
// units of what is left; what is in front of the body in some frames counts
// little.
double FallOf(Samples samples, const SpotModel& before,
              const SpotModel& after) {
  const std::vector<double> old = ResidualsOf(samples, before);
  const std::vector<double> now = ResidualsOf(samples, after);
  constexpr double kFarOut = 2.5;  // of Huber's cut: five standard deviations
  const double cut = kFarOut * CutOf(now);
  double fall = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    fall += std::min(old[i] * old[i], cut * cut) -
            std::min(now[i] * now[i], cut * cut);
  }
  return fall / std::max(1.0, after.chi2);
}

// Levenberg and Marquardt from `model`.
void FitSpots(Samples samples, const SpotOptions& options, SpotModel& model) {
  constexpr int kRounds = 40;
  constexpr double kMostDamping = 1e6;
  constexpr double kSettled = 1e-4;  // of the cost
  constexpr double kRidge = 1e-12;
  double damping = 1e-3;
  std::vector<double> residuals = ResidualsOf(samples, model);
  SpotEquations sums;
  for (int round = 0; round < kRounds; ++round) {
    const double cut = CutOf(residuals);
    const double cost = HuberCost(residuals, cut);
    sums = EquationsOf(samples, model, residuals, cut, options.curved);
    double gain = 0.0;
    while (gain <= 0.0 && damping < kMostDamping) {
      SpotModel::Matrix a = sums.normal;
      a.diagonal() *= 1.0 + damping;
      a.diagonal().array() += kRidge * a.diagonal().maxCoeff();
      SpotModel next = model;
      next.parameters += a.ldlt().solve(sums.gradient);
      if (AreSpots(next, options.reach_px)) {
        std::vector<double> again = ResidualsOf(samples, next);
        gain = cost - HuberCost(again, cut);
        if (gain > 0.0) {
          model.parameters = next.parameters;
          residuals = std::move(again);
        }
      }
      damping *= gain > 0.0 ? 0.2 : 5.0;
    }
    if (!(gain > kSettled * (1.0 + cost))) break;
  }
  const double cut = CutOf(residuals);
  double square = 0.0;
  for (const double r : residuals) square += std::min(r * r, cut * cut);
  model.chi2 = square / static_cast<double>(samples.size());
  SpotModel::Matrix a =
      EquationsOf(samples, model, residuals, cut, options.curved).normal;
  a.diagonal().array() += kRidge * a.diagonal().maxCoeff();
  const Eigen::Index n = model.parameters.size();
  model.covariance = std::max(1.0, model.chi2) *
                     a.ldlt().solve(SpotModel::Matrix::Identity(n, n));
}

// The spot of a width that would explain the most of the residuals.
struct Patch {
  double gain = 0.0;  // fall of the squares' sum
  double level_dn = 0.0;
  double x_px = 0.0;
  double y_px = 0.0;
};

// About one of the cells that stand out the most.
Patch PatchOf(Samples cells, const std::vector<double>& residuals,
              double sigma_px) {
  constexpr std::size_t kTried = 24;
  std::vector<std::size_t> order(cells.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const std::size_t tried = std::min(kTried, order.size());
  std::partial_sort(order.begin(),
                    order.begin() + static_cast<std::ptrdiff_t>(tried),
                    order.end(), [&](std::size_t a, std::size_t b) {
                      return std::abs(residuals[a]) > std::abs(residuals[b]);
                    });
  Patch best;
  for (std::size_t k = 0; k < tried; ++k) {
    const SpotSample& centre = cells[order[k]];
    double sum = 0.0;
    double weights = 0.0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double dx = (cells[i].x_px - centre.x_px) / sigma_px;
      const double dy = (cells[i].y_px - centre.y_px) / sigma_px;
      const double square = dx * dx + dy * dy;
      constexpr double kReach = 9.0;  // beyond, the shape is below 1 %
      if (square > kReach) continue;
      const double shape =
          std::exp(-0.5 * square) / std::sqrt(cells[i].variance_dn2);
      sum += shape * residuals[i];
      weights += shape * shape;
    }
    const double gain = sum * sum / weights;
    if (gain > best.gain) {
      best = {gain, sum / weights, centre.x_px, centre.y_px};
    }
  }
  return best;
}

// `model` with one spot more, or nothing.
std::optional<SpotModel> WithSpot(Samples cells, Samples samples,
                                  const SpotOptions& options,
                                  const SpotModel& model) {
  const std::vector<double> residuals = ResidualsOf(cells, model);
  constexpr std::array<double, 3> kWidths = {0.12, 0.25, 0.5};  // of the size
  SpotModel best;
  best.chi2 = std::numeric_limits<double>::infinity();
  for (const double width : kWidths) {
    const double sigma = std::max(width * options.size_px, options.least_px);
    const Patch patch = PatchOf(cells, residuals, sigma);
    if (patch.gain < kSureFall) continue;
    SpotModel tried = model;
    ++tried.spots;
    tried.parameters.resize(model.parameters.size() + SpotModel::kSpot);
    const double s = 1.0 / (sigma * sigma);
    tried.parameters << model.parameters, patch.level_dn, patch.x_px,
        patch.y_px, s, 0.0, s;
    if (!AreSpots(tried, options.reach_px)) continue;
    FitSpots(cells, options, tried);
    if (tried.chi2 < best.chi2) best = tried;
  }
  if (best.spots == 0) return std::nullopt;
  FitSpots(samples, options, best);
  SpotModel without = model;
  FitSpots(samples, options, without);
  if (!(FallOf(samples, without, best) > kSureFall)) return std::nullopt;
  return best;
}

}  // namespace

double SpotModel::At(double x_px, double y_px, Vector* by) const {
  const Vector& k = parameters;
  const double xi = x_px / size_px;
  const double eta = y_px / size_px;
  const std::array<double, kShading> terms = {1.0,     xi,       eta,
                                              xi * xi, xi * eta, eta * eta};
  double value = 0.0;
  for (int i = 0; i < kShading; ++i) {
    const double term = terms[static_cast<std::size_t>(i)];
    value += k[i] * term;
    if (by != nullptr) (*by)[i] = term;
  }
  for (int spot = 0; spot < spots; ++spot) {
    const int at = kShading + spot * kSpot;
    const double dx = x_px - k[at + 1];
    const double dy = y_px - k[at + 2];
    const double along_x = k[at + 3] * dx + k[at + 4] * dy;
    const double along_y = k[at + 4] * dx + k[at + 5] * dy;
    const double shape = std::exp(-0.5 * (along_x * dx + along_y * dy));
    const double level = k[at] * shape;
    value += level;
    if (by == nullptr) continue;
    (*by)[at] = shape;
    (*by)[at + 1] = level * along_x;
    (*by)[at + 2] = level * along_y;
    (*by)[at + 3] = -0.5 * level * dx * dx;
    (*by)[at + 4] = -level * dx * dy;
    (*by)[at + 5] = -0.5 * level * dy * dy;
  }
  return value;
}

std::optional<SpotModel> FindSpots(std::span<const SpotSample> cells,
                                   std::span<const SpotSample> samples,
                                   const SpotOptions& options) {
  constexpr std::size_t kLeastCells = 20;
  if (cells.size() < kLeastCells) return std::nullopt;
  SpotModel model;
  model.size_px = options.size_px;
  FitSpots(cells, options, model);
  while (model.spots < SpotModel::kMostSpots) {
    auto more = WithSpot(cells, samples, options, model);
    if (!more) break;
    model = std::move(*more);
  }
  if (model.spots == 0) return std::nullopt;
  return model;
}

}  // namespace touchdown::vision
