#include "outline/spots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "numbers/robust.h"

namespace touchdown::vision {
namespace {

using Samples = std::span<const SpotSample>;

// Fall of the sum of squares, in units of the residual variance, that is no
// chance: a spot has six parameters, and there are hundreds of places to try.
// Smaller learns noise; larger misses weak highlights. Not studied.
constexpr double kMinCostFall = 60.0;

// Whether each spot falls off in all directions, from a place on the body: a
// Gaussian that does not is a second shading.
bool AreSpots(const SpotModel& model, double reach_px) {
  const NormalVector& k = model.parameters;
  for (int spot = 0; spot < model.spots; ++spot) {
    const int at = SpotModel::kShading + spot * SpotModel::kSpot;
    // The greatest and the least of S's eigenvalues: 1 / width^2.
    const double mean = 0.5 * (k[at + 3] + k[at + 5]);
    const double off = std::hypot(0.5 * (k[at + 3] - k[at + 5]), k[at + 4]);
    const double narrow = mean + off;
    const double wide = mean - off;
    // Ratio of length and width: a longer spot is an edge. Not studied.
    constexpr double kMaxAspect = 5.0;
    if (!(wide * reach_px * reach_px > 1.0) ||
        !(wide * kMaxAspect * kMaxAspect > narrow) ||
        !(std::hypot(k[at + 1], k[at + 2]) < reach_px)) {
      return false;
    }
  }
  return k.allFinite();
}

// (measured - model) / noise of each sample.
std::vector<double> ComputeResiduals(Samples samples, const SpotModel& model) {
  std::vector<double> residuals;
  residuals.reserve(samples.size());
  for (const SpotSample& s : samples) {
    residuals.push_back((s.level_dn - model.At(s.x_px, s.y_px, nullptr)) /
                        std::sqrt(s.variance_dn2));
  }
  return residuals;
}

// Where Huber's cost changes from squares to a straight line.
double HuberCut(const std::vector<double>& residuals) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (const double r : residuals) sizes.push_back(std::abs(r));
  // Robust standard deviations. Smaller is more robust; larger loses less of
  // normal noise. Not studied.
  constexpr double kHuberSigmas = 2.0;
  return kHuberSigmas *
         std::max(1.0, kSigmaPerMedian * Median(std::move(sizes)));
}

// r^2 / 2 up to the cut, cut (|r| - cut/2) beyond it (Huber 1964).
double HuberCost(const std::vector<double>& residuals, double cut) {
  double cost = 0.0;
  for (const double r : residuals) {
    const double size = std::abs(r);
    cost += size < cut ? 0.5 * r * r : cut * (size - 0.5 * cut);
  }
  return cost;
}

struct SpotEquations {
  NormalMatrix normal;
  NormalVector gradient;
};

// Gauss-Newton equations with Huber's weights. Without curved shading its three
// quadratic terms are held.
SpotEquations MakeNormalEquations(Samples samples, const SpotModel& model,
                                  const std::vector<double>& residuals,
                                  double cut, bool curved) {
  const Eigen::Index n = model.parameters.size();
  SpotEquations sums = {NormalMatrix::Zero(n, n), NormalVector::Zero(n)};
  NormalVector by(n);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    model.At(samples[i].x_px, samples[i].y_px, &by);
    by /= std::sqrt(samples[i].variance_dn2);
    const double weight = std::min(1.0, cut / std::abs(residuals[i]));
    sums.normal.noalias() += weight * by * by.transpose();
    sums.gradient.noalias() += weight * residuals[i] * by;
  }
  // Level and two slopes.
  constexpr int kLinearTerms = 3;
  for (int i = curved ? SpotModel::kShading : kLinearTerms;
       i < SpotModel::kShading; ++i) {
    sums.normal.row(i).setZero();
    sums.normal.col(i).setZero();
    sums.normal(i, i) = 1.0;
    sums.gradient[i] = 0.0;
  }
  return sums;
}

// By how much the sum of squares is less with `after` than with `before`, in
// units of the residual variance. Squares are bounded: what lies in front of
// the body in some frames counts little.
double CostReduction(Samples samples, const SpotModel& before,
                     const SpotModel& after) {
  const std::vector<double> old = ComputeResiduals(samples, before);
  const std::vector<double> now = ComputeResiduals(samples, after);
  // Of Huber's cut: five standard deviations. Not studied.
  constexpr double kBoundCuts = 2.5;
  const double cut = kBoundCuts * HuberCut(now);
  double fall = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    fall += std::min(old[i] * old[i], cut * cut) -
            std::min(now[i] * now[i], cut * cut);
  }
  return fall / std::max(1.0, after.chi2);
}

// Levenberg-Marquardt from `model`; writes parameters, chi^2 and covariance.
void FitSpots(Samples samples, const SpotOptions& options, SpotModel& model) {
  // Rounds: a bound on time. Not studied.
  constexpr int kMaxRounds = 40;
  // Steps are vanishingly short from here on: no gain is left.
  constexpr double kMaxDamping = 1e6;
  // Relative gain of a round that ends the fit: far below kMinCostFall.
  constexpr double kMinGain = 1e-4;
  // Of the largest diagonal: against rounding only.
  constexpr double kRidge = 1e-12;
  double damping = 1e-3;
  std::vector<double> residuals = ComputeResiduals(samples, model);
  SpotEquations sums;
  for (int round = 0; round < kMaxRounds; ++round) {
    const double cut = HuberCut(residuals);
    const double cost = HuberCost(residuals, cut);
    sums = MakeNormalEquations(samples, model, residuals, cut, options.curved);
    double gain = 0.0;
    while (gain <= 0.0 && damping < kMaxDamping) {
      NormalMatrix a = sums.normal;
      a.diagonal() *= 1.0 + damping;
      a.diagonal().array() += kRidge * a.diagonal().maxCoeff();
      SpotModel next = model;
      next.parameters += SymmetricFactor(a).Solve(sums.gradient);
      if (AreSpots(next, options.reach_px)) {
        std::vector<double> again = ComputeResiduals(samples, next);
        gain = cost - HuberCost(again, cut);
        if (gain > 0.0) {
          model.parameters = next.parameters;
          residuals = std::move(again);
        }
      }
      damping *= gain > 0.0 ? 0.2 : 5.0;
    }
    if (!(gain > kMinGain * (1.0 + cost))) break;
  }
  const double cut = HuberCut(residuals);
  double square = 0.0;
  for (const double r : residuals) square += std::min(r * r, cut * cut);
  model.chi2 = square / static_cast<double>(samples.size());
  NormalMatrix a =
      MakeNormalEquations(samples, model, residuals, cut, options.curved)
          .normal;
  a.diagonal().array() += kRidge * a.diagonal().maxCoeff();
  model.covariance = std::max(1.0, model.chi2) * SymmetricFactor(a).Inverse();
}

// A spot of given width that would explain the most of the residuals.
struct Patch {
  double gain = 0.0;  // fall of the squares' sum
  double level_dn = 0.0;
  double x_px = 0.0;
  double y_px = 0.0;
};

// Correlates the residuals with a round spot about each of the cells that stand
// out the most.
Patch FindPatch(Samples cells, const std::vector<double>& residuals,
                double sigma_px) {
  // Cells: more cost time; a spot's middle is among the first. Not studied.
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
      // Squared distance in widths: beyond it the shape is below 1.2 %.
      constexpr double kMaxSquare = 9.0;
      if (square > kMaxSquare) continue;
      const double shape =
          std::exp(-0.5 * square) / std::sqrt(cells[i].variance_dn2);
      sum += shape * residuals[i];
      weights += shape * shape;
    }
    // Matched filter: the fall of the sum of squares for the best level.
    const double gain = sum * sum / weights;
    if (gain > best.gain) {
      best = {gain, sum / weights, centre.x_px, centre.y_px};
    }
  }
  return best;
}

// `model` with one spot more, if that explains clearly more; else nothing.
std::optional<SpotModel> WithSpot(Samples cells, Samples samples,
                                  const SpotOptions& options,
                                  const SpotModel& model) {
  const std::vector<double> residuals = ComputeResiduals(cells, model);
  // Widths to start from, in units of the half size: a factor of two apart,
  // from which the fit finds its own. Not studied.
  constexpr std::array<double, 3> kWidths = {0.12, 0.25, 0.5};
  SpotModel best;
  best.chi2 = std::numeric_limits<double>::infinity();
  for (const double width : kWidths) {
    const double sigma = std::max(width * options.size_px, options.least_px);
    const Patch patch = FindPatch(cells, residuals, sigma);
    if (patch.gain < kMinCostFall) continue;
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
  if (!(CostReduction(samples, without, best) > kMinCostFall))
    return std::nullopt;
  return best;
}

}  // namespace

double SpotModel::At(double x_px, double y_px, NormalVector* by) const {
  const NormalVector& k = parameters;
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
    // level exp(-(d^T S d) / 2), with S = (k3 k4; k4 k5), and its derivatives.
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
  // Cells: twelve parameters of shading and one spot, and some to judge them.
  // Not studied.
  constexpr std::size_t kMinCells = 20;
  if (cells.size() < kMinCells) return std::nullopt;
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
