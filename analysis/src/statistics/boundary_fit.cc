#include "touchdown/analysis/statistics/boundary_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "statistics/likelihood.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// Scatter levels with less than this of the posterior are left out when the
// scatter is known well enough for a finer grid.
constexpr double kNegligibleMass = 1e-7;
// Fewer levels than this with any mass to speak of, and the grid is refined.
constexpr int kEnoughLevels = 14;
// The last halving reaches steps with this share of the greatest allowed mass.
constexpr double kTailMass = 1.0 / 64;
// Enough to find the greatest likelihood.
constexpr double kCoarseCellMass = 1.0 / 16;
// Twice the fall of the log likelihood at the ends of an interval: 0.90 and
// 0.95 quantiles of chi^2 with one degree of freedom.
constexpr double kFall90 = 2.7055434540954;
constexpr double kFall95 = 3.8414588206941;
// Splitting stops at this many angles: far beyond what any posterior needed.
constexpr std::size_t kMaxAngles = 20000;

void CheckFitOptions(const BoundaryFitOptions& o) {
  core::Require(std::isfinite(o.low_rad), "low_rad", o.low_rad, "finite");
  core::Require(std::isfinite(o.high_rad) && o.high_rad > o.low_rad, "high_rad",
                o.high_rad, "finite and above low_rad");
  core::Require(o.scatter_low_rad > 0.0, "scatter_low_rad", o.scatter_low_rad,
                "positive");
  core::Require(o.scatter_high_rad > o.scatter_low_rad &&
                    std::isfinite(o.scatter_high_rad),
                "scatter_high_rad", o.scatter_high_rad,
                "finite and above scatter_low_rad");
  core::Require(o.scatter_levels >= 4, "scatter_levels", o.scatter_levels,
                "at least 4");
  core::Require(o.start_steps >= 4, "start_steps", o.start_steps, "at least 4");
  core::Require(o.max_cell_mass > 1e-4 && o.max_cell_mass <= 0.25,
                "max_cell_mass", o.max_cell_mass,
                "above 0.0001 and at most 0.25");
  core::Require(o.lapse > 0.0 && o.lapse < 0.5, "lapse", o.lapse,
                "between 0 and 0.5");
  core::Require(o.bin_width_rad > 0.0, "bin_width_rad", o.bin_width_rad,
                "positive");
  const auto check = [](const ScatterPrior& prior) {
    core::Require(prior.median_rad > 0.0, "scatter median_rad",
                  prior.median_rad, "positive");
    if (!prior.log_sd) return;
    core::Require(*prior.log_sd > 0.0, "scatter log_sd", *prior.log_sd,
                  "positive");
  };
  check(o.scatter);
  if (o.cautious_scatter) check(*o.cautious_scatter);
  if (o.sharp_scatter) check(*o.sharp_scatter);
  if (o.unlikely_fall) {
    core::Require(*o.unlikely_fall > 0.0, "unlikely_fall", *o.unlikely_fall,
                  "positive");
  }
  for (const ScatterPrior& prior : o.sensitivity) check(prior);
}

std::vector<double> ScatterLevels(double low, double high, int n) {
  std::vector<double> out(static_cast<std::size_t>(n));
  for (int j = 0; j < n; ++j) {
    out[static_cast<std::size_t>(j)] =
        low * std::pow(high / low, static_cast<double>(j) / (n - 1));
  }
  return out;
}

// The table l[angle][scatter], additive over trials, with what is made of it.
// `Likelihood` fills a row: At(angle, row).
template <class Likelihood>
class Table {
 public:
  Table(Likelihood likelihood, std::vector<double> scatter_rad)
      : scatter_rad_(std::move(scatter_rad)),
        likelihood_(std::move(likelihood)) {}

  void Fill(std::vector<double> angles) {
    angles_ = std::move(angles);
    rows_.clear();
    for (const double angle : angles_) rows_.push_back(Row(angle));
  }

  // Halves every step that holds more than `max_mass` of the posterior, until
  // none does, and then once more wherever there is any to speak of. The
  // trapezoid of a steep tail is too large, never too small, so tails are split
  // rather than missed.
  void Refine(const ScatterPrior& prior, double max_mass) {
    while (Halve(prior, max_mass)) {
    }
    Halve(prior, max_mass * kTailMass);
  }

  double Max() const {
    double max = -std::numeric_limits<double>::infinity();
    for (const auto& row : rows_) {
      max = std::max(max, *std::max_element(row.begin(), row.end()));
    }
    return max;
  }

  // Joint posterior per angle and scatter level, not normalised: greatest 1.
  std::vector<double> Joint(const ScatterPrior& prior) const {
    std::vector<double> log_prior;
    for (const double s : scatter_rad_) {
      log_prior.push_back(LogDensity(prior, s));
    }
    // Trapezoid in ln s: the prior does not vanish at the ends of the grid.
    log_prior.front() -= std::log(2.0);
    log_prior.back() -= std::log(2.0);
    double max = -std::numeric_limits<double>::infinity();
    for (const auto& row : rows_) {
      for (std::size_t j = 0; j < row.size(); ++j) {
        max = std::max(max, row[j] + log_prior[j]);
      }
    }
    std::vector<double> out;
    out.reserve(rows_.size() * scatter_rad_.size());
    for (const auto& row : rows_) {
      for (std::size_t j = 0; j < row.size(); ++j) {
        out.push_back(std::exp(row[j] + log_prior[j] - max));
      }
    }
    return out;
  }

  // Marginal of the angle, not normalised.
  std::vector<double> Density(const ScatterPrior& prior) const {
    const std::vector<double> joint = Joint(prior);
    std::vector<double> out(angles_.size(), 0.0);
    for (std::size_t k = 0; k < joint.size(); ++k) {
      out[k / scatter_rad_.size()] += joint[k];
    }
    return out;
  }

  const std::vector<double>& angles() const { return angles_; }
  const std::vector<double>& scatter_rad() const { return scatter_rad_; }
  const std::vector<std::vector<double>>& rows() const { return rows_; }

 private:
  // True where a step was halved.
  bool Halve(const ScatterPrior& prior, double max_mass) {
    if (angles_.size() > kMaxAngles) return false;
    const std::vector<double> density = Density(prior);
    std::vector<double> mass(angles_.size() - 1);
    double total = 0.0;
    for (std::size_t i = 0; i + 1 < angles_.size(); ++i) {
      mass[i] =
          (density[i] + density[i + 1]) / 2 * (angles_[i + 1] - angles_[i]);
      total += mass[i];
    }
    std::vector<double> angles;
    std::vector<std::vector<double>> rows;
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      angles.push_back(angles_[i]);
      rows.push_back(std::move(rows_[i]));
      if (i + 1 == angles_.size() || mass[i] <= max_mass * total) continue;
      const double middle = (angles_[i] + angles_[i + 1]) / 2;
      if (middle <= angles_[i] || middle >= angles_[i + 1]) continue;
      angles.push_back(middle);
      rows.push_back(Row(middle));
    }
    const bool halved = angles.size() > angles_.size();
    angles_ = std::move(angles);
    rows_ = std::move(rows);
    return halved;
  }

  std::vector<double> Row(double angle) const {
    std::vector<double> row(scatter_rad_.size());
    likelihood_.At(angle, row);
    return row;
  }

  std::vector<double> scatter_rad_;
  Likelihood likelihood_;
  std::vector<double> angles_;
  std::vector<std::vector<double>> rows_;
};

// Trials that share one error, of standard uncertainty common_u_rad.
struct SetUpCells {
  double common_u_rad = 0.0;
  std::vector<Cell> cells;
};

// A common error reaches no further than this many of its u: 6e-5 is left out.
constexpr double kCommonReach = 4.0;
// No more steps than this over the angles before a common error is integrated.
constexpr int kMostCommonSteps = 2000;

// The likelihood of one set-up with its common error integrated:
//   M(theta, s) = Int L(theta + b, s) N(b; 0, u^2) db,
// from a table of L whose steps are no wider than u where L has any mass.
class SmearedLikelihood {
 public:
  SmearedLikelihood(const SetUpCells& setup,
                    const std::vector<double>& scatter_rad, double lapse,
                    const BoundaryFitOptions& options)
      : u_rad_(setup.common_u_rad), levels_(scatter_rad.size()) {
    Table<GridLikelihood> table(GridLikelihood(setup.cells, scatter_rad, lapse),
                                scatter_rad);
    const double low = options.low_rad - kCommonReach * u_rad_;
    const double high = options.high_rad + kCommonReach * u_rad_;
    const int steps =
        std::clamp(static_cast<int>(std::ceil((high - low) / u_rad_)),
                   options.start_steps, kMostCommonSteps);
    std::vector<double> angles;
    for (int i = 0; i <= steps; ++i) {
      angles.push_back(low + (high - low) * i / steps);
    }
    table.Fill(std::move(angles));
    table.Refine(options.scatter, options.max_cell_mass);
    top_ = table.Max();
    const auto& a = table.angles();
    edge_.push_back(a.front());
    for (std::size_t i = 1; i < a.size(); ++i) {
      edge_.push_back((a[i - 1] + a[i]) / 2);
    }
    edge_.push_back(a.back());
    for (const auto& row : table.rows()) {
      for (const double l : row) likelihood_.push_back(std::exp(l - top_));
    }
  }

  // Adds to `out`.
  void At(double angle_rad, std::span<double> out) const {
    std::vector<double> sum(levels_, 0.0);
    double total = 0.0;
    const auto z = [&](std::size_t k) {
      return (edge_[k] - angle_rad) / u_rad_;
    };
    auto k = static_cast<std::size_t>(
        std::upper_bound(edge_.begin(), edge_.end(),
                         angle_rad - kCommonReach * u_rad_) -
        edge_.begin());
    k = std::min(k > 0 ? k - 1 : k, edge_.size() - 2);
    double before = FastNormalCdf(z(k));
    for (; k + 1 < edge_.size(); ++k) {
      const double after = FastNormalCdf(z(k + 1));
      const double weight = after - before;
      total += weight;
      before = after;
      for (std::size_t j = 0; j < levels_; ++j) {
        sum[j] += weight * likelihood_[k * levels_ + j];
      }
      if (z(k + 1) > kCommonReach) break;
    }
    for (std::size_t j = 0; j < levels_; ++j) {
      // Where nothing is left of it the posterior has long been 0.
      constexpr double kLeast = 1e-300;
      out[j] +=
          std::log(std::max(sum[j] / std::max(total, kLeast), kLeast)) + top_;
    }
  }

 private:
  double u_rad_;
  std::size_t levels_;
  double top_ = 0.0;
  std::vector<double> edge_;        // of the steps that stand for each angle
  std::vector<double> likelihood_;  // [angle * levels + scatter], top 1
};

// All trials: those that share no error, and each set-up that does.
class JointLikelihood {
 public:
  JointLikelihood(std::span<const SetUpCells> setups,
                  const std::vector<double>& scatter_rad, double lapse,
                  const BoundaryFitOptions& options) {
    for (const SetUpCells& setup : setups) {
      if (setup.common_u_rad > 0.0) {
        smeared_.emplace_back(setup, scatter_rad, lapse, options);
      } else {
        plain_.emplace_back(setup.cells, scatter_rad, lapse);
      }
    }
  }

  void At(double angle_rad, std::span<double> out) const {
    if (plain_.empty()) {
      std::fill(out.begin(), out.end(), 0.0);
    } else {
      plain_.front().At(angle_rad, out);
    }
    for (const SmearedLikelihood& setup : smeared_) setup.At(angle_rad, out);
  }

 private:
  std::vector<GridLikelihood> plain_;  // at most one
  std::vector<SmearedLikelihood> smeared_;
};

using JointTable = Table<JointLikelihood>;

// The set-ups; trials without a common error are one, the first.
std::vector<SetUpCells> MakeSetUps(std::span<const Observation> observations,
                                   double bin_width_rad) {
  std::map<int, std::vector<Observation>> shared;
  std::vector<Observation> alone;
  for (const Observation& o : observations) {
    if (o.common_u_rad > 0.0) {
      shared[o.setup].push_back(o);
    } else {
      alone.push_back(o);
    }
  }
  std::vector<SetUpCells> out;
  if (!alone.empty() || shared.empty()) {
    out.push_back({0.0, MakeCells(alone, bin_width_rad)});
  }
  for (const auto& [number, members] : shared) {
    double squares = 0.0;
    for (const Observation& o : members) {
      squares += o.common_u_rad * o.common_u_rad;
    }
    out.push_back({std::sqrt(squares / static_cast<double>(members.size())),
                   MakeCells(members, bin_width_rad)});
  }
  return out;
}

double CommonFloor(std::span<const SetUpCells> setups) {
  double weights = 0.0;
  for (const SetUpCells& setup : setups) {
    if (!(setup.common_u_rad > 0.0)) return 0.0;
    weights += 1.0 / (setup.common_u_rad * setup.common_u_rad);
  }
  return weights > 0.0 ? 1.0 / std::sqrt(weights) : 0.0;
}

// Where the search begins: equal steps, and the angles at which the outcome
// changes, so that a narrow posterior is not stepped over.
std::vector<double> StartAngles(std::span<const Observation> observations,
                                const BoundaryFitOptions& options) {
  std::vector<double> out;
  for (int i = 0; i <= options.start_steps; ++i) {
    out.push_back(options.low_rad + (options.high_rad - options.low_rad) * i /
                                        options.start_steps);
  }
  const Bracket bracket = FindBracket(observations);
  for (const auto& end : {bracket.low_rad, bracket.high_rad}) {
    if (end) out.push_back(*end);
  }
  if (bracket.low_rad && bracket.high_rad) {
    out.push_back((*bracket.low_rad + *bracket.high_rad) / 2);
  }
  std::erase_if(out, [&](double a) {
    return a < options.low_rad || a > options.high_rad;
  });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// A finer scatter grid over the levels that hold the posterior, where they are
// few: with many trials s is known better than the first grid's step.
std::vector<double> FinerScatter(const JointTable& table,
                                 const BoundaryFitOptions& options) {
  const std::vector<double>& s = table.scatter_rad();
  const std::vector<double> joint = table.Joint(options.scatter);
  std::vector<double> mass(s.size(), 0.0);
  for (std::size_t k = 0; k < joint.size(); ++k) mass[k % s.size()] += joint[k];
  const double max = *std::max_element(mass.begin(), mass.end());
  std::size_t first = s.size();
  std::size_t last = 0;
  for (std::size_t j = 0; j < s.size(); ++j) {
    if (mass[j] < kNegligibleMass * max) continue;
    first = std::min(first, j);
    last = std::max(last, j);
  }
  if (last - first + 1 >= static_cast<std::size_t>(kEnoughLevels)) return {};
  first = first > 0 ? first - 1 : first;
  last = std::min(last + 1, s.size() - 1);
  return ScatterLevels(s[first], s[last], options.scatter_levels);
}

// Distribution function at the angles, by the trapezoid; its last value is 1.
std::vector<double> Cumulate(const std::vector<double>& angles,
                             std::vector<double>& density) {
  std::vector<double> out(angles.size(), 0.0);
  for (std::size_t i = 1; i < angles.size(); ++i) {
    out[i] = out[i - 1] +
             (density[i - 1] + density[i]) / 2 * (angles[i] - angles[i - 1]);
  }
  const double total = out.back();
  for (double& c : out) c /= total;
  for (double& d : density) d /= total;
  return out;
}

// Angle at which the distribution function is p; the density is taken as linear
// within a step.
double Invert(const std::vector<double>& angles,
              const std::vector<double>& density,
              const std::vector<double>& cumulative, double p) {
  const auto above =
      std::lower_bound(cumulative.begin() + 1, cumulative.end(), p);
  if (above == cumulative.end()) return angles.back();
  const auto i = static_cast<std::size_t>(above - cumulative.begin());
  const double step = angles[i] - angles[i - 1];
  const double left = std::max(p - cumulative[i - 1], 0.0);
  const double f0 = density[i - 1];
  const double slope = (density[i] - f0) / step;
  // left = f0 t + slope t^2 / 2, solved so that no digits cancel.
  const double root = std::sqrt(std::max(f0 * f0 + 2 * slope * left, 0.0));
  const double t = f0 + root > 0.0 ? 2 * left / (f0 + root) : 0.0;
  return angles[i - 1] + std::clamp(t, 0.0, step);
}

void FillGrid(const JointTable& table, const ScatterPrior& prior,
              BoundaryGrid& grid) {
  grid.angle_rad = table.angles();
  grid.scatter_rad = table.scatter_rad();
  grid.weight = table.Joint(prior);
  const std::size_t m = grid.scatter_rad.size();
  const std::size_t n = grid.angle_rad.size();
  double total = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double below = i > 0 ? grid.angle_rad[i] - grid.angle_rad[i - 1] : 0;
    const double above =
        i + 1 < n ? grid.angle_rad[i + 1] - grid.angle_rad[i] : 0;
    for (std::size_t j = 0; j < m; ++j) {
      total += grid.weight[i * m + j] *= (below + above) / 2;
    }
  }
  for (double& w : grid.weight) w /= total;
}

void FillScatter(BoundaryPosterior& out) {
  const std::size_t m = out.grid.scatter_rad.size();
  std::vector<double> density(m, 0.0);
  for (std::size_t k = 0; k < out.grid.weight.size(); ++k) {
    density[k % m] += out.grid.weight[k];
  }
  std::vector<double> log_s;
  for (const double s : out.grid.scatter_rad) log_s.push_back(std::log(s));
  const std::vector<double> cumulative = Cumulate(log_s, density);
  const auto at = [&](double p) {
    return std::exp(Invert(log_s, density, cumulative, p));
  };
  out.scatter_median_rad = at(0.5);
  out.scatter95_rad = {at(0.025), at(0.975)};
}

// The greatest log likelihood at each angle, over every scatter.
std::vector<double> ProfileByAngle(const JointTable& table) {
  std::vector<double> out;
  for (const auto& row : table.rows()) {
    out.push_back(*std::max_element(row.begin(), row.end()));
  }
  return out;
}

// All angles between the outermost at which the log likelihood, whatever the
// scatter, has fallen by half of `fall`.
core::Interval LikelyAngles(const std::vector<double>& angles,
                            const std::vector<double>& profile, double fall) {
  const double level =
      *std::max_element(profile.begin(), profile.end()) - fall / 2;
  const auto crossing = [&](std::size_t out, std::size_t in) {
    const double share = (level - profile[out]) / (profile[in] - profile[out]);
    return angles[out] + share * (angles[in] - angles[out]);
  };
  std::size_t first = 0;
  while (profile[first] < level) ++first;
  std::size_t last = profile.size() - 1;
  while (profile[last] < level) --last;
  return {first > 0 ? crossing(first - 1, first) : angles.front(),
          last + 1 < angles.size() ? crossing(last + 1, last) : angles.back()};
}

// Outcomes of one kind bound the boundary on one side. The posterior is proper
// only because its support ends, and the more of it is open, the nearer to that
// end its equal tails lie: of 47 boundaries near the last of 20 ascending or
// staircase angles they held 3. There the interval goes to the end of the
// support, and as far on the other side as the likelihood is not against it.
core::Interval OpenInterval(DataStatus status,
                            const std::vector<double>& angles,
                            const core::Interval& likely,
                            core::Interval tails) {
  if (status == DataStatus::kOnlySlides) {
    return {std::min(tails.low, likely.low), angles.back()};
  }
  if (status == DataStatus::kOnlyBounces) {
    return {angles.front(), std::max(tails.high, likely.high)};
  }
  return tails;
}

void FillMarginal(const JointTable& table, const ScatterPrior& prior,
                  DataStatus status, BoundaryPosterior& out) {
  out.angle_rad = table.angles();
  out.density_per_rad = table.Density(prior);
  out.cumulative = Cumulate(out.angle_rad, out.density_per_rad);
  out.median_rad = Quantile(out, 0.5);
  const std::vector<double> profile = ProfileByAngle(table);
  out.interval90_rad = OpenInterval(
      status, out.angle_rad, LikelyAngles(out.angle_rad, profile, kFall90),
      {Quantile(out, 0.05), Quantile(out, 0.95)});
  out.interval95_rad = OpenInterval(
      status, out.angle_rad, LikelyAngles(out.angle_rad, profile, kFall95),
      {Quantile(out, 0.025), Quantile(out, 0.975)});
}

// The 95 % interval together with that under another prior.
void HoldUnder(const JointTable& table, const ScatterPrior& prior,
               BoundaryPosterior& out) {
  BoundaryPosterior other;
  FillMarginal(table, prior, out.status, other);
  core::Interval& interval = out.interval95_rad;
  interval.low = std::min(interval.low, other.interval95_rad.low);
  interval.high = std::max(interval.high, other.interval95_rad.high);
}

void HoldUnderSharpPrior(const JointTable& table,
                         const std::optional<ScatterPrior>& prior,
                         BoundaryPosterior& out) {
  if (!prior || out.status == DataStatus::kNoTrials) return;
  // Of the interval: less is not worth a word.
  constexpr double kLeastGain = 0.01;
  const core::Interval alone = out.interval95_rad;
  HoldUnder(table, *prior, out);
  const core::Interval& both = out.interval95_rad;
  if (both.high - both.low > (1.0 + kLeastGain) * (alone.high - alone.low)) {
    out.sharp_prior = prior;
  }
}

// Where outcomes do not overlap also under the cautious prior, and with the
// bracket of separated ones. Where a few angles repeat, a bracket's ends are
// likely boundaries only if the scatter is small; any prior that allows for
// more has its tails inside.
void HoldUnlessScatterIsSeen(const JointTable& table, const Bracket& bracket,
                             const std::optional<ScatterPrior>& prior,
                             BoundaryPosterior& out) {
  const bool separated = out.status == DataStatus::kSeparated;
  if (!prior || (!separated && out.status != DataStatus::kTouching)) return;
  HoldUnder(table, *prior, out);
  if (separated) {
    core::Interval& interval = out.interval95_rad;
    interval.low =
        std::clamp(*bracket.low_rad, out.angle_rad.front(), interval.low);
    interval.high =
        std::clamp(*bracket.high_rad, interval.high, out.angle_rad.back());
  }
  out.cautious_prior = prior;
}

// Where outcomes overlap the likelihood itself tells the scatter: an angle that
// none makes likely is in the 95 % interval only because of the prior.
void LeaveOutUnlikelyAngles(const JointTable& table,
                            const std::optional<double>& fall,
                            BoundaryPosterior& out) {
  if (!fall || out.status != DataStatus::kOverlap) return;
  const core::Interval likely =
      LikelyAngles(out.angle_rad, ProfileByAngle(table), *fall);
  core::Interval& interval = out.interval95_rad;
  interval.low =
      std::min(std::max(interval.low, likely.low), out.interval90_rad.low);
  interval.high =
      std::max(std::min(interval.high, likely.high), out.interval90_rad.high);
}

void FillMoments(BoundaryPosterior& out) {
  const BoundaryGrid& grid = out.grid;
  const std::size_t m = grid.scatter_rad.size();
  double mean = 0.0;
  for (std::size_t k = 0; k < grid.weight.size(); ++k) {
    mean += grid.weight[k] * grid.angle_rad[k / m];
  }
  double variance = 0.0;
  for (std::size_t k = 0; k < grid.weight.size(); ++k) {
    const double d = grid.angle_rad[k / m] - mean;
    variance += grid.weight[k] * d * d;
  }
  out.mean_rad = mean;
  out.sd_rad = std::sqrt(variance);
}

std::optional<double> TypicalU(std::span<const Observation> observations) {
  if (observations.empty()) return std::nullopt;
  double squares = 0.0;
  for (const Observation& o : observations) squares += o.u_rad * o.u_rad;
  return std::sqrt(squares / static_cast<double>(observations.size()));
}

JointTable MakeTable(std::span<const SetUpCells> setups,
                     const std::vector<double>& start,
                     const BoundaryFitOptions& options, double lapse,
                     double max_mass) {
  const std::vector<double> scatter =
      ScatterLevels(options.scatter_low_rad, options.scatter_high_rad,
                    options.scatter_levels);
  JointTable table(JointLikelihood(setups, scatter, lapse, options), scatter);
  table.Fill(start);
  table.Refine(options.scatter, max_mass);
  return table;
}

}  // namespace

double LogDensity(const ScatterPrior& prior, double scatter_rad) {
  const double ratio = scatter_rad / prior.median_rad;
  if (!prior.log_sd) return std::log(ratio) - std::log1p(ratio * ratio);
  const double z = std::log(ratio) / *prior.log_sd;
  return -0.5 * z * z;
}

std::string_view Name(DataStatus status) {
  switch (status) {
    case DataStatus::kNoTrials:
      return "no-trials";
    case DataStatus::kOnlySlides:
      return "only-slides";
    case DataStatus::kOnlyBounces:
      return "only-bounces";
    case DataStatus::kSeparated:
      return "separated";
    case DataStatus::kTouching:
      return "touching";
    case DataStatus::kOverlap:
      return "overlap";
    case DataStatus::kNoTrend:
      return "no-trend";
    case DataStatus::kReversed:
      return "reversed";
  }
  return "";
}

namespace {

// 0.95 quantile of the normal distribution.
constexpr double kReversedScore = 1.6448536269514722;

// Score of a trend of the outcome with the angle, standard normal without one
// (Cochran and Armitage): sum (x - x_mean)(y - y_mean) over its deviation when
// outcomes are dealt at random. 0 where all angles are the same.
double TrendScore(std::span<const Observation> observations,
                  const Counts& counts) {
  const double n = counts.decided();
  double mean = 0.0;
  for (const Observation& o : observations) {
    if (o.outcome != Outcome::kUndecided) mean += o.angle_rad / n;
  }
  const double share = counts.bounce / n;
  double sum = 0.0;
  double squares = 0.0;
  for (const Observation& o : observations) {
    if (o.outcome == Outcome::kUndecided) continue;
    const double d = o.angle_rad - mean;
    sum += d * ((o.outcome == Outcome::kBounce ? 1.0 : 0.0) - share);
    squares += d * d;
  }
  const double variance = share * (1.0 - share) * squares * n / (n - 1.0);
  // Rounding alone makes angles differ that are the same.
  if (!(squares > n * kSameAngle_rad * kSameAngle_rad)) return 0.0;
  return sum / std::sqrt(variance);
}

}  // namespace

DataStatus Classify(std::span<const Observation> observations) {
  const Counts counts = Count(observations);
  if (counts.decided() == 0) return DataStatus::kNoTrials;
  if (counts.bounce == 0) return DataStatus::kOnlySlides;
  if (counts.not_bounce == 0) return DataStatus::kOnlyBounces;
  const Bracket bracket = FindBracket(observations);
  if (*bracket.low_rad < *bracket.high_rad) return DataStatus::kSeparated;
  const double trend = TrendScore(observations, counts);
  if (trend <= 0.0) {
    return trend < -kReversedScore ? DataStatus::kReversed
                                   : DataStatus::kNoTrend;
  }
  return *bracket.low_rad == *bracket.high_rad ? DataStatus::kTouching
                                               : DataStatus::kOverlap;
}

BoundaryPosterior FitBoundary(std::span<const Observation> observations,
                              const BoundaryFitOptions& options) {
  CheckFitOptions(options);
  BoundaryPosterior out;
  out.status = Classify(observations);
  out.few_trials = Count(observations).decided() < kFewTrials;
  out.binned = observations.size() > options.bin_above;
  out.prior = options.scatter;
  out.typical_u_rad = TypicalU(observations);
  const std::vector<SetUpCells> setups =
      MakeSetUps(observations, out.binned ? options.bin_width_rad : 0.0);
  out.common_u_rad = CommonFloor(setups);
  const std::vector<double> start = StartAngles(observations, options);

  JointTable table =
      MakeTable(setups, start, options, 0.0, options.max_cell_mass);
  // Without lapses the data cannot gain more than -Max(): most never ask. A
  // coarse table tells the gain.
  if (-table.Max() > options.lapse_gain) {
    JointTable with =
        MakeTable(setups, start, options, options.lapse, kCoarseCellMass);
    out.lapse_gain = with.Max() - table.Max();
    if (out.lapse_gain > options.lapse_gain) {
      with.Refine(options.scatter, options.max_cell_mass);
      table = std::move(with);
      out.lapse = options.lapse;
    }
  }
  if (std::vector<double> finer = FinerScatter(table, options);
      !finer.empty()) {
    JointTable again(JointLikelihood(setups, finer, out.lapse, options), finer);
    again.Fill(table.angles());
    again.Refine(options.scatter, options.max_cell_mass);
    table = std::move(again);
  }
  FillMarginal(table, options.scatter, out.status, out);
  HoldUnderSharpPrior(table, options.sharp_scatter, out);
  HoldUnlessScatterIsSeen(table, FindBracket(observations),
                          options.cautious_scatter, out);
  LeaveOutUnlikelyAngles(table, options.unlikely_fall, out);
  FillGrid(table, options.scatter, out.grid);
  FillMoments(out);
  FillScatter(out);
  for (const ScatterPrior& prior : options.sensitivity) {
    BoundaryPosterior other;
    FillMarginal(table, prior, out.status, other);
    out.sensitivity.push_back({prior, other.median_rad, other.interval95_rad});
  }
  return out;
}

double Quantile(const BoundaryPosterior& posterior, double p) {
  core::Require(p >= 0.0 && p <= 1.0, "p", p, "from 0 to 1");
  return Invert(posterior.angle_rad, posterior.density_per_rad,
                posterior.cumulative, p);
}

double CumulativeProbability(const BoundaryPosterior& posterior,
                             double angle_rad) {
  const auto& angles = posterior.angle_rad;
  if (angle_rad <= angles.front()) return 0.0;
  if (angle_rad >= angles.back()) return 1.0;
  const auto above = std::upper_bound(angles.begin(), angles.end(), angle_rad);
  const auto i = static_cast<std::size_t>(above - angles.begin());
  const double step = angles[i] - angles[i - 1];
  const double t = angle_rad - angles[i - 1];
  const double f0 = posterior.density_per_rad[i - 1];
  const double slope = (posterior.density_per_rad[i] - f0) / step;
  return posterior.cumulative[i - 1] + t * (f0 + slope * t / 2);
}

double MarginProbability(const BoundaryPosterior& posterior, double value_rad,
                         double margin_rad) {
  return CumulativeProbability(posterior, value_rad + margin_rad) -
         CumulativeProbability(posterior, value_rad - margin_rad);
}

double SmallestPassingMargin(const BoundaryPosterior& posterior,
                             double value_rad) {
  return std::max(std::abs(posterior.interval90_rad.high - value_rad),
                  std::abs(posterior.interval90_rad.low - value_rad));
}

}  // namespace touchdown::analysis
