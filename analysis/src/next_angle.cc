#include "touchdown/analysis/next_angle.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "design.h"
#include "likelihood.h"
#include "touchdown/analysis/agreement.h"
#include "touchdown/analysis/special_functions.h"

namespace touchdown::analysis {
namespace {

// Candidates lie within this many standard deviations of the mean, and at least
// this far on either side.
constexpr double kReach = 4.0;
constexpr double kLeastReach_rad = 3.0 * core::kDegree;
// Grid points with less weight than this are passed over: together they hold
// less than a ten-thousandth of the posterior.
constexpr double kNegligible = 1e-9;

// Levels are printed to two decimals: 4.2 - 4.1 is no more than 0.1.
constexpr double kSameGap = 1e-9;

void Require(bool ok, const char* field, double value, const char* range) {
  if (!ok) {
    throw std::invalid_argument(
        fmt::format("{} is {}; it must be {}", field, value, range));
  }
}

void CheckFeasible(const core::Interval& feasible) {
  Require(std::isfinite(feasible.low), "feasible_rad.low", feasible.low,
          "finite");
  Require(feasible.high >= feasible.low && std::isfinite(feasible.high),
          "feasible_rad.high", feasible.high,
          "finite and not below feasible_rad.low");
}

NextAngle Clipped(double angle_rad, const core::Interval& feasible) {
  NextAngle out;
  out.angle_rad = std::clamp(angle_rad, feasible.low, feasible.high);
  out.clipped = out.angle_rad != angle_rad;
  return out;
}

// Expected variance of theta after one trial at `angle`.
double ExpectedVariance(const BoundaryGrid& grid, double angle_rad,
                        const std::vector<double>& inverse_scatter, double mean,
                        double second) {
  const std::size_t m = grid.scatter_rad.size();
  double p = 0.0;
  double p_theta = 0.0;
  for (std::size_t i = 0; i < grid.angle_rad.size(); ++i) {
    const double theta = grid.angle_rad[i];
    double q = 0.0;
    for (std::size_t j = 0; j < m; ++j) {
      const double w = grid.weight[i * m + j];
      if (w < kNegligible) continue;
      q += w * FastNormalCdf((angle_rad - theta) * inverse_scatter[j]);
    }
    p += q;
    p_theta += q * (theta - mean);
  }
  // p v1 + (1 - p) v0, each v being E[theta^2] - E[theta]^2 given the outcome.
  double expected = second;
  if (p > 0.0) expected -= p_theta * p_theta / p;
  if (p < 1.0) expected -= p_theta * p_theta / (1.0 - p);
  return expected;
}

// The golden ratio's multiples fill an interval evenly, however many there are.
double Spread(int trial, double spread_rad) {
  const double turn = trial * (std::numbers::phi - 1.0);
  return spread_rad * (2.0 * (turn - std::floor(turn)) - 1.0);
}

double InformationWeight(double k) {
  const double density = NormalDensity(k);
  const double both = NormalCdf(k) * NormalCdf(-k);
  return both > 0.0 ? density * density / both : 0.0;
}

// Neyer's D-optimal level: the one that adds most to the determinant of the
// information on (mean, scatter).
double DOptimal(std::span<const double> levels, double mean, double scatter) {
  double b11 = 0.0;
  double b12 = 0.0;
  double b22 = 0.0;
  for (const double x : levels) {
    const double k = (x - mean) / scatter;
    const double w = InformationWeight(k);
    b11 += w;
    b12 += w * k;
    b22 += w * k * k;
  }
  const double side = b12 > 0.0 ? -1.0 : 1.0;
  const auto gain = [&](double k) {
    return InformationWeight(k) * (b11 * k * k - 2 * b12 * k + b22);
  };
  // A scan and a golden section around its best: beyond 8 nothing is gained.
  constexpr double kFar = 8.0;
  constexpr int kSteps = 400;
  int best = 0;
  double best_gain = gain(0.0);
  for (int i = 1; i <= kSteps; ++i) {
    const double g = gain(side * kFar * i / kSteps);
    if (g > best_gain) {
      best_gain = g;
      best = i;
    }
  }
  double low = kFar * std::max(best - 1, 0) / kSteps;
  double high = kFar * (best + 1) / kSteps;
  const double golden = (std::sqrt(5.0) - 1.0) / 2.0;
  while (high - low > 1e-9) {
    const double a = high - golden * (high - low);
    const double b = low + golden * (high - low);
    (gain(side * a) >= gain(side * b) ? high : low) =
        gain(side * a) >= gain(side * b) ? b : a;
  }
  return mean + side * (low + high) / 2 * scatter;
}

// Greatest likelihood of (mean, scatter) for exact levels that overlap, by
// Newton on (a, b) = (-mean / scatter, 1 / scatter) of standardised levels, in
// which the log likelihood is concave. Nothing where it has no maximum.
struct ProbitFit {
  double mean = 0.0;
  double scatter = 0.0;
};
std::optional<ProbitFit> FitProbit(std::span<const Observation> trials) {
  double centre = 0.0;
  double squares = 0.0;
  for (const Observation& o : trials) centre += o.angle_rad;
  centre /= static_cast<double>(trials.size());
  for (const Observation& o : trials) {
    squares += (o.angle_rad - centre) * (o.angle_rad - centre);
  }
  const double unit = std::sqrt(squares / static_cast<double>(trials.size()));
  if (!(unit > 0.0)) return std::nullopt;
  const auto log_likelihood = [&](double a, double b) {
    double sum = 0.0;
    for (const Observation& o : trials) {
      const double z = a + b * (o.angle_rad - centre) / unit;
      sum += LogNormalCdf(o.outcome == Outcome::kBounce ? z : -z);
    }
    return sum;
  };
  double a = 0.0;
  double b = 1.0;
  double value = log_likelihood(a, b);
  for (int iteration = 0; iteration < 100; ++iteration) {
    double ga = 0.0;
    double gb = 0.0;
    double haa = 0.0;
    double hab = 0.0;
    double hbb = 0.0;
    for (const Observation& o : trials) {
      const double x = (o.angle_rad - centre) / unit;
      const double sign = o.outcome == Outcome::kBounce ? 1.0 : -1.0;
      const double z = sign * (a + b * x);
      const double mills =
          std::exp(std::log(NormalDensity(z)) - LogNormalCdf(z));
      const double curvature = mills * (z + mills);
      ga += sign * mills;
      gb += sign * mills * x;
      haa += curvature;
      hab += curvature * x;
      hbb += curvature * x * x;
    }
    const double determinant = haa * hbb - hab * hab;
    if (!(determinant > 0.0)) return std::nullopt;
    const double da = (hbb * ga - hab * gb) / determinant;
    const double db = (haa * gb - hab * ga) / determinant;
    double step = 1.0;
    while (step > 1e-6 &&
           !(log_likelihood(a + step * da, b + step * db) >= value)) {
      step /= 2;
    }
    a += step * da;
    b += step * db;
    value = log_likelihood(a, b);
    if (std::abs(da) + std::abs(db) < 1e-12 * (1 + std::abs(a) + std::abs(b))) {
      break;
    }
  }
  if (!(b > 0.0)) return std::nullopt;
  return ProbitFit{centre - a / b * unit, unit / b};
}

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

// One step of Neyer's rules after `trials`; `guess` shrinks on the way.
double NeyerLevel(std::span<const Observation> trials,
                  const NeyerOptions& options, double& guess) {
  if (trials.empty()) {
    return (options.guess_low_rad + options.guess_high_rad) / 2;
  }
  Extent all;
  std::vector<double> levels;
  for (const Observation& o : trials) {
    levels.push_back(o.angle_rad);
    all.low = std::min(all.low, o.angle_rad);
    all.high = std::max(all.high, o.angle_rad);
  }
  const Counts counts = Count(trials);
  if (counts.bounce == 0) {
    return std::max({(options.guess_high_rad + all.high) / 2,
                     all.high + 2 * guess, 2 * all.high - all.low});
  }
  if (counts.not_bounce == 0) {
    return std::min({(options.guess_low_rad + all.low) / 2, all.low - 2 * guess,
                     2 * all.low - all.high});
  }
  const Bracket bracket = FindBracket(trials);
  const double gap = *bracket.high_rad - *bracket.low_rad;
  const double middle = (*bracket.high_rad + *bracket.low_rad) / 2;
  if (gap > guess * (1 + kSameGap)) return middle;
  if (gap >= 0.0) {
    const double scatter = std::min(guess, all.high - all.low);
    guess *= 0.8;
    return DOptimal(levels, middle, scatter);
  }
  const auto fit = FitProbit(trials);
  const double mean = fit ? fit->mean : middle;
  const double scatter = fit ? fit->scatter : all.high - all.low;
  return DOptimal(levels, std::clamp(mean, all.low, all.high),
                  std::min(scatter, all.high - all.low));
}

double HalfWidth(const BoundaryPosterior& posterior) {
  return (posterior.interval95_rad.high - posterior.interval95_rad.low) / 2;
}

}  // namespace

double ExpectedSd(const BoundaryPosterior& posterior, double angle_rad,
                  const NextAngleOptions& options) {
  std::vector<double> inverse_scatter;
  for (const double s : posterior.grid.scatter_rad) {
    inverse_scatter.push_back(1.0 / std::hypot(s, options.set_u_rad));
  }
  return std::sqrt(std::max(
      ExpectedVariance(posterior.grid, angle_rad, inverse_scatter,
                       posterior.mean_rad, posterior.sd_rad * posterior.sd_rad),
      0.0));
}

NextAngle ChooseNextAngle(const BoundaryPosterior& posterior, int trials_so_far,
                          const NextAngleOptions& options) {
  CheckFeasible(options.feasible_rad);
  Require(options.set_u_rad >= 0.0, "set_u_rad", options.set_u_rad,
          "not negative");
  Require(options.candidate_step_rad > 1e-5, "candidate_step_rad",
          options.candidate_step_rad, "above 0.00001 rad");
  Require(options.spread_rad >= 0.0, "spread_rad", options.spread_rad,
          "not negative");
  Require(options.target_half_width_rad > 0.0, "target_half_width_rad",
          options.target_half_width_rad, "positive");

  Require(options.design_scatter.median_rad > 0.0, "design_scatter median_rad",
          options.design_scatter.median_rad, "positive");
  Require(options.design_scatter.log_sd > 0.0, "design_scatter log_sd",
          options.design_scatter.log_sd, "positive");

  const Design design = Reweigh(posterior, options.design_scatter);
  std::vector<double> inverse_scatter;
  for (const double s : design.grid.scatter_rad) {
    inverse_scatter.push_back(1.0 / std::hypot(s, options.set_u_rad));
  }
  const double mean = design.mean_rad;
  const double reach = std::max(kReach * design.sd_rad, kLeastReach_rad);
  const double step = options.candidate_step_rad;
  const double variance = design.sd_rad * design.sd_rad;
  // Where the rig cannot reach what is believed, the nearer of its ends is all
  // that can be thrown: Clipped() sees to that.
  double best = mean;
  double best_variance = std::numeric_limits<double>::infinity();
  const auto last = std::llround(std::floor((mean + reach) / step));
  for (auto i = std::llround(std::ceil((mean - reach) / step)); i <= last;
       ++i) {
    const double c = static_cast<double>(i) * step;
    if (c < options.feasible_rad.low || c > options.feasible_rad.high) continue;
    const double expected =
        ExpectedVariance(design.grid, c, inverse_scatter, mean, variance);
    // A tie, to rounding, stays with the lower angle.
    if (expected < best_variance * (1.0 - 1e-12)) {
      best_variance = expected;
      best = c;
    }
  }
  NextAngle out = Clipped(best + Spread(trials_so_far, options.spread_rad),
                          options.feasible_rad);
  out.expected_sd_rad = ExpectedSd(posterior, out.angle_rad, options);
  out.half_width_rad = HalfWidth(posterior);
  if (out.half_width_rad <= options.target_half_width_rad) {
    out.stop = StopReason::kTargetReached;
  } else if (trials_so_far >= options.max_trials) {
    out.stop = StopReason::kMaxTrials;
  }
  if (options.forecast_futures > 0) {
    std::mt19937_64 engine(options.forecast_seed);
    out.trials_to_target =
        ForecastTrials(posterior,
                       {options.target_half_width_rad, options.set_u_rad,
                        options.forecast_futures, options.design_scatter},
                       engine);
  }
  return out;
}

NextAngle NextNeyer(std::span<const Observation> trials,
                    const NeyerOptions& options) {
  CheckFeasible(options.feasible_rad);
  Require(options.guess_high_rad > options.guess_low_rad, "guess_high_rad",
          options.guess_high_rad, "above guess_low_rad");
  Require(options.guess_scatter_rad > 0.0, "guess_scatter_rad",
          options.guess_scatter_rad, "positive");
  std::vector<Observation> decided;
  for (const Observation& o : trials) {
    if (o.outcome != Outcome::kUndecided) decided.push_back(o);
  }
  // The guess of the scatter shrinks along the way, so the test is replayed;
  // fits are needed only for the last level.
  double guess = options.guess_scatter_rad;
  const std::span<const Observation> all(decided);
  for (std::size_t n = 1; n < all.size(); ++n) {
    const auto before = all.first(n);
    const Counts counts = Count(before);
    if (counts.bounce == 0 || counts.not_bounce == 0) continue;
    const Bracket bracket = FindBracket(before);
    const double gap = *bracket.high_rad - *bracket.low_rad;
    if (gap >= 0.0 && gap <= guess * (1 + kSameGap)) guess *= 0.8;
  }
  return Clipped(NeyerLevel(all, options, guess), options.feasible_rad);
}

NextAngle NextUpDown(std::span<const Observation> trials,
                     const UpDownOptions& options) {
  CheckFeasible(options.feasible_rad);
  Require(options.step_rad > 0.0, "step_rad", options.step_rad, "positive");
  if (trials.empty()) return Clipped(options.start_rad, options.feasible_rad);
  const Observation& last = trials.back();
  // The set-point where it is known: measured angles would wander off the
  // steps.
  double angle = last.set_angle_rad.value_or(last.angle_rad);
  if (last.outcome == Outcome::kBounce) angle -= options.step_rad;
  if (last.outcome == Outcome::kNotBounce) angle += options.step_rad;
  return Clipped(angle, options.feasible_rad);
}

std::optional<DixonMood> EstimateDixonMood(std::span<const Observation> trials,
                                           double step_rad) {
  Require(step_rad > 0.0, "step_rad", step_rad, "positive");
  const Counts counts = Count(trials);
  if (counts.bounce == 0 || counts.not_bounce == 0) return std::nullopt;
  const Outcome rarer = counts.bounce <= counts.not_bounce
                            ? Outcome::kBounce
                            : Outcome::kNotBounce;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Observation& o : trials) {
    if (o.outcome == rarer) lowest = std::min(lowest, o.angle_rad);
  }
  DixonMood out;
  for (const Observation& o : trials) {
    if (o.outcome != rarer) continue;
    const int i =
        static_cast<int>(std::lround((o.angle_rad - lowest) / step_rad));
    ++out.n;
    out.a += i;
    out.b += i * i;
  }
  const double n = out.n;
  out.mean_rad = lowest + step_rad * (out.a / n +
                                      (rarer == Outcome::kBounce ? -0.5 : 0.5));
  out.m = (n * out.b - static_cast<double>(out.a) * out.a) / (n * n);
  if (out.m > 0.3) out.scatter_rad = 1.62 * step_rad * (out.m + 0.029);
  return out;
}

}  // namespace touchdown::analysis
