#include "touchdown/analysis/statistics/likelihood_profile.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "statistics/likelihood.h"
#include "touchdown/analysis/statistics/agreement.h"

namespace touchdown::analysis {
namespace {

// 0.95 quantile of chi^2 with one degree of freedom.
constexpr double kChiSquare95 = 3.841458820694124;
// Levels of ln s that are tried before the best is refined.
constexpr int kScatterStarts = 12;
// Where pl lies within this of its maximum its top is called flat.
constexpr double kFlat = 1e-6;
// More trials than this are binned, as in boundary_fit.h.
constexpr std::size_t kBinAbove = 2000;
constexpr double kBinWidth_rad = 0.05 * core::kDegree;

// Greatest value of f on [a, b], f having one maximum there; to `tolerance` in
// the argument.
template <class F>
std::pair<double, double> Maximize(const F& f, double a, double b,
                                   double tolerance) {
  // Golden-section search: (sqrt(5) - 1) / 2.
  constexpr double kGolden = 0.6180339887498949;
  double x1 = b - kGolden * (b - a);
  double x2 = a + kGolden * (b - a);
  double f1 = f(x1);
  double f2 = f(x2);
  while (b - a > tolerance) {
    if (f1 >= f2) {
      b = x2;
      x2 = x1;
      f2 = f1;
      x1 = b - kGolden * (b - a);
      f1 = f(x1);
    } else {
      a = x1;
      x1 = x2;
      f1 = f2;
      x2 = a + kGolden * (b - a);
      f2 = f(x2);
    }
  }
  return f1 >= f2 ? std::pair{x1, f1} : std::pair{x2, f2};
}

struct Best {
  double log_likelihood = 0.0;
  double scatter_rad = 0.0;
  bool at_high_end = false;
};

class Profile {
 public:
  Profile(std::span<const Cell> cells, const ProfileOptions& options)
      : cells_(cells),
        low_(std::log(options.scatter_low_rad)),
        high_(std::log(options.scatter_high_rad)) {}

  // Over s, at this theta. l is unimodal in ln s for exact angles; the start
  // grid is for the rest.
  Best At(double angle_rad) const {
    const auto l = [&](double log_s) {
      return LogLikelihood(cells_, angle_rad, std::exp(log_s), 0.0);
    };
    const double step = (high_ - low_) / (kScatterStarts - 1);
    int best = 0;
    double best_value = l(low_);
    for (int j = 1; j < kScatterStarts; ++j) {
      const double value = l(low_ + j * step);
      if (value > best_value) {
        best_value = value;
        best = j;
      }
    }
    const double a = std::max(low_, low_ + (best - 1) * step);
    const double b = std::min(high_, low_ + (best + 1) * step);
    auto [log_s, value] = Maximize(l, a, b, 1e-7);
    for (const double end : {low_, high_}) {
      if (const double at_end = l(end); at_end >= value) {
        value = at_end;
        log_s = end;
      }
    }
    return {value, std::exp(log_s), high_ - log_s < 1e-6};
  }

  double operator()(double angle_rad) const {
    return At(angle_rad).log_likelihood;
  }

 private:
  std::span<const Cell> cells_;
  double low_;
  double high_;
};

void CheckProfileOptions(const ProfileOptions& o) {
  if (!(o.high_rad > o.low_rad) || !std::isfinite(o.high_rad - o.low_rad)) {
    throw std::invalid_argument(fmt::format(
        "low_rad is {} and high_rad is {}; both must be finite, low below high",
        o.low_rad, o.high_rad));
  }
  if (!(o.scatter_low_rad > 0.0) || !(o.scatter_high_rad > o.scatter_low_rad) ||
      !std::isfinite(o.scatter_high_rad)) {
    throw std::invalid_argument(
        fmt::format("scatter_low_rad is {} and scatter_high_rad is {}; they "
                    "must be positive and finite, low below high",
                    o.scatter_low_rad, o.scatter_high_rad));
  }
}

// The theta between `in` (where pl > level) and `out` (where pl < level) at
// which pl crosses the level.
double Cross(const Profile& pl, double in, double out, double level,
             double tolerance) {
  while (std::abs(out - in) > tolerance) {
    const double middle = (in + out) / 2;
    (pl(middle) >= level ? in : out) = middle;
  }
  return (in + out) / 2;
}

// The greatest pl: from the best of a coarse grid and the ends of the bracket.
double FindTop(const Profile& pl, std::span<const Observation> observations,
               const ProfileOptions& options, double tolerance) {
  // Steps of the coarse grid: 2 deg on a range of 90 deg. Not studied.
  constexpr int kSteps = 45;
  std::vector<double> starts;
  for (int i = 0; i <= kSteps; ++i) {
    starts.push_back(options.low_rad +
                     (options.high_rad - options.low_rad) * i / kSteps);
  }
  const Bracket bracket = FindBracket(observations);
  if (bracket.low_rad && bracket.high_rad) {
    starts.push_back((*bracket.low_rad + *bracket.high_rad) / 2);
    starts.push_back(*bracket.low_rad);
    starts.push_back(*bracket.high_rad);
  }
  std::erase_if(starts, [&](double a) {
    return a < options.low_rad || a > options.high_rad;
  });
  std::sort(starts.begin(), starts.end());
  // The neighbours of the best must bracket the top, so none may be a twin.
  const double twin = 1e-7 * (options.high_rad - options.low_rad);
  starts.erase(
      std::unique(starts.begin(), starts.end(),
                  [twin](double a, double b) { return b - a <= twin; }),
      starts.end());
  std::size_t best = 0;
  double best_value = pl(starts[0]);
  for (std::size_t i = 1; i < starts.size(); ++i) {
    const double value = pl(starts[i]);
    if (value > best_value) {
      best_value = value;
      best = i;
    }
  }
  const double a = starts[best > 0 ? best - 1 : 0];
  const double b = starts[std::min(best + 1, starts.size() - 1)];
  const auto [top, value] = Maximize(pl, a, b, tolerance);
  return value >= best_value ? top : starts[best];
}

}  // namespace

LikelihoodProfile ProfileOfPosterior(const BoundaryPosterior& posterior) {
  const BoundaryGrid& grid = posterior.grid;
  const std::vector<double>& angles = grid.angle_rad;
  const std::size_t n = angles.size();
  const std::size_t m = grid.scatter_rad.size();
  LikelihoodProfile out;
  out.status = posterior.status;
  out.interval95_rad = {angles.front(), angles.back()};
  out.estimate_rad = (angles.front() + angles.back()) / 2;
  if (out.status == DataStatus::kNoTrials) return out;

  // Weight over prior and step is the likelihood, but for a factor.
  std::vector<double> pl(n);
  std::vector<std::size_t> best_level(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double below = i > 0 ? angles[i] - angles[i - 1] : 0.0;
    const double above = i + 1 < n ? angles[i + 1] - angles[i] : 0.0;
    double best = -std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < m; ++j) {
      const double end = j == 0 || j + 1 == m ? std::log(2.0) : 0.0;
      const double l = std::log(grid.weight[i * m + j]) + end -
                       LogDensity(posterior.prior, grid.scatter_rad[j]);
      if (l > best) {
        best = l;
        best_level[i] = j;
      }
    }
    pl[i] = best - std::log((below + above) / 2);
  }
  const auto top = static_cast<std::size_t>(
      std::max_element(pl.begin(), pl.end()) - pl.begin());
  const double level = pl[top] - kChiSquare95 / 2;
  // Where pl crosses `at` outwards from the top; between points it is linear.
  const auto cross = [&](double at, int way) -> std::optional<double> {
    for (std::size_t i = top;; i += static_cast<std::size_t>(way)) {
      if (way < 0 ? i == 0 : i + 1 == n) return std::nullopt;
      const std::size_t next = i + static_cast<std::size_t>(way);
      if (pl[next] >= at) continue;
      const double fall = pl[i] - pl[next];
      const double t = std::isfinite(fall) ? (pl[i] - at) / fall : 1.0;
      return angles[i] + t * (angles[next] - angles[i]);
    }
  };
  const auto low = cross(level, -1);
  const auto high = cross(level, 1);
  out.open_low = !low;
  out.open_high = !high;
  out.interval95_rad = {low.value_or(angles.front()),
                        high.value_or(angles.back())};
  out.estimate_rad = angles[top];
  out.has_estimate = out.status == DataStatus::kSeparated ||
                     out.status == DataStatus::kTouching ||
                     out.status == DataStatus::kOverlap;
  const bool bottom = best_level[top] == 0;
  out.scatter_rad = bottom ? 0.0 : grid.scatter_rad[best_level[top]];
  return out;
}

LikelihoodProfile ProfileLikelihood(std::span<const Observation> observations,
                                    const ProfileOptions& options) {
  CheckProfileOptions(options);
  LikelihoodProfile out;
  out.status = Classify(observations);
  out.interval95_rad = {options.low_rad, options.high_rad};
  out.estimate_rad = (options.low_rad + options.high_rad) / 2;
  if (out.status == DataStatus::kNoTrials) return out;

  const std::vector<Cell> cells = MakeCells(
      observations, observations.size() > kBinAbove ? kBinWidth_rad : 0.0);
  const Profile pl(cells, options);
  const double tolerance = 1e-9 * (options.high_rad - options.low_rad);
  double top = FindTop(pl, observations, options, tolerance);
  const Best best = pl.At(top);

  const double level = best.log_likelihood - kChiSquare95 / 2;
  out.open_low = pl(options.low_rad) >= level;
  out.open_high = pl(options.high_rad) >= level;
  if (!out.open_low) {
    out.interval95_rad.low = Cross(pl, top, options.low_rad, level, tolerance);
  }
  if (!out.open_high) {
    out.interval95_rad.high =
        Cross(pl, top, options.high_rad, level, tolerance);
  }

  // Separated or one-sided: the top is flat, and its middle is the estimate.
  const double flat = best.log_likelihood - kFlat;
  double flat_low = options.low_rad;
  double flat_high = options.high_rad;
  if (pl(flat_low) < flat) flat_low = Cross(pl, top, flat_low, flat, tolerance);
  if (pl(flat_high) < flat) {
    flat_high = Cross(pl, top, flat_high, flat, tolerance);
  }
  switch (out.status) {
    case DataStatus::kSeparated:
    case DataStatus::kTouching:
      top = (flat_low + flat_high) / 2;
      out.has_estimate = true;
      break;
    case DataStatus::kOverlap:
      out.has_estimate = !best.at_high_end;
      out.scatter_rad = best.scatter_rad;
      break;
    case DataStatus::kNoTrend:
    case DataStatus::kReversed:
      out.scatter_rad = best.scatter_rad;
      break;
    case DataStatus::kOnlySlides:
    case DataStatus::kOnlyBounces:
    case DataStatus::kNoTrials:
      top = (flat_low + flat_high) / 2;
      break;
  }
  out.estimate_rad = top;
  return out;
}

}  // namespace touchdown::analysis
