#include "touchdown/analysis/statistics/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "statistics/likelihood.h"
#include "touchdown/analysis/statistics/special_functions.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// Logarithm of no weight.
constexpr double kNone = -std::numeric_limits<double>::infinity();
// The fine part of the grid, in margins on either side of the theory: truths
// farther off are told apart from it long before their exact place matters.
constexpr int kFineMargins = 5;
// Beyond, each step is so much wider than the one before, up to the widest.
constexpr double kWiden = 1.25;
constexpr double kWidest_rad = 3.0 * core::kDegree;
// A common error reaches no further than this many of its u: 6e-5 is left out.
constexpr double kReach_u = 4.0;
// Angles closer than this are one.
constexpr double kTwin_rad = 1e-9;

std::vector<double> AngleGrid(double value, double margin, double far,
                              const EvidenceOptions& options) {
  std::vector<double> out{options.low_rad, options.high_rad, value - far,
                          value + far};
  const double step = margin / options.steps_per_margin;
  const int fine = kFineMargins * options.steps_per_margin;
  for (int i = -fine; i <= fine; ++i) out.push_back(value + step * i);
  for (const double way : {-1.0, 1.0}) {
    double wide = step;
    for (double at = value + way * step * fine;
         at >= options.low_rad && at <= options.high_rad; at += way * wide) {
      out.push_back(at);
      wide = std::max(step, std::min(wide * kWiden, kWidest_rad));
    }
  }
  std::erase_if(out, [&](double a) {
    return a < options.low_rad || a > options.high_rad;
  });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end(),
                        [](double a, double b) { return b - a <= kTwin_rad; }),
            out.end());
  return out;
}

// Top of the parabola through three points, if it has one between the outer
// two; else the middle's value.
double ParabolaTop(double x0, double y0, double x1, double y1, double x2,
                   double y2) {
  const double a = (y1 - y0) / (x1 - x0);
  const double b = (y2 - y1) / (x2 - x1);
  const double curvature = (b - a) / (x2 - x0);
  if (!(curvature < 0.0)) return y1;
  const double slope = a + curvature * (x1 - x0);  // at x1
  const double top = y1 - slope * slope / (4.0 * curvature);
  return std::isfinite(top) ? std::max(top, y1) : y1;
}

// Half of the steps on either side: each angle's share of the range.
double Share(const std::vector<double>& angles, std::size_t i) {
  const double below = i > 0 ? angles[i] - angles[i - 1] : 0.0;
  const double above = i + 1 < angles.size() ? angles[i + 1] - angles[i] : 0.0;
  return (below + above) / 2;
}

// log of the mean of exp(table) over theta + offset, offset ~ N(0, u^2).
std::vector<double> Smear(const std::vector<double>& table,
                          const std::vector<double>& angles, std::size_t m,
                          double u) {
  const double top = *std::max_element(table.begin(), table.end());
  std::vector<double> likelihood(table.size());
  for (std::size_t k = 0; k < table.size(); ++k) {
    likelihood[k] = std::exp(table[k] - top);
  }
  std::vector<double> out(table.size(), 0.0);
  const std::size_t n = angles.size();
  std::vector<double> edge(n + 1);
  edge.front() = angles.front();
  edge.back() = angles.back();
  for (std::size_t i = 1; i < n; ++i) edge[i] = (angles[i - 1] + angles[i]) / 2;
  for (std::size_t i = 0; i < n; ++i) {
    double* row = out.data() + i * m;
    double total = 0.0;
    auto k = static_cast<std::size_t>(
        std::lower_bound(edge.begin(), edge.end(), angles[i] - kReach_u * u) -
        edge.begin());
    k = std::min(k > 0 ? k - 1 : k, i);
    double before = FastNormalCdf((edge[k] - angles[i]) / u);
    for (; k < n && (k <= i || edge[k] < angles[i] + kReach_u * u); ++k) {
      const double after = FastNormalCdf((edge[k + 1] - angles[i]) / u);
      const double weight = after - before;
      before = after;
      total += weight;
      const double* from = likelihood.data() + k * m;
      for (std::size_t j = 0; j < m; ++j) row[j] += weight * from[j];
    }
    for (std::size_t j = 0; j < m; ++j) {
      // Below the smallest number the table itself says enough.
      row[j] = row[j] > 0.0 ? std::log(row[j] / total) + top : table[i * m + j];
    }
  }
  return out;
}

}  // namespace

EvidenceTable::EvidenceTable(const TheoryBoundary& theory, double margin_rad,
                             const EvidenceOptions& options)
    : options_(options) {
  core::RequireFinite("theory boundary_rad", theory.boundary_rad);
  core::RequireNotNegative("theory u_rad", theory.u_rad);
  core::RequirePositive("margin_rad", margin_rad);
  core::RequireFinite("low_rad", options.low_rad);
  core::RequireFinite("high_rad", options.high_rad);
  core::RequirePositive("high_rad - low_rad",
                        options.high_rad - options.low_rad);
  core::RequirePositive("scatter_low_rad", options.scatter_low_rad);
  core::RequirePositive("scatter_high_rad - scatter_low_rad",
                        options.scatter_high_rad - options.scatter_low_rad);
  core::RequireInRange("scatter_levels", options.scatter_levels, 4, 1000);
  core::RequireInRange("steps_per_margin", options.steps_per_margin, 2, 1000);
  core::RequireInRange("lapse", options.lapse, 0.0, 0.5);
  const double value = theory.boundary_rad;
  const double far = margin_rad + kTheoryCoverage * theory.u_rad;
  margin_low_rad_ = value - margin_rad;
  margin_high_rad_ = value + margin_rad;
  far_low_rad_ = value - far;
  far_high_rad_ = value + far;
  angle_rad_ = AngleGrid(value, margin_rad, far, options);
  for (int j = 0; j < options.scatter_levels; ++j) {
    scatter_rad_.push_back(
        options.scatter_low_rad *
        std::pow(options.scatter_high_rad / options.scatter_low_rad,
                 static_cast<double>(j) / (options.scatter_levels - 1)));
  }
}

void EvidenceTable::Add(std::span<const Observation> observations) {
  Count(observations, 1.0);
}

void EvidenceTable::Remove(std::span<const Observation> observations) {
  Count(observations, -1.0);
}

void EvidenceTable::Count(std::span<const Observation> observations,
                          double times) {
  std::map<int, std::vector<Observation>> by_setup;
  for (const Observation& o : observations) by_setup[o.setup].push_back(o);
  const std::size_t m = scatter_rad_.size();
  std::vector<double> row(m);
  for (const auto& [number, members] : by_setup) {
    SetUp& setup = setups_[number];
    setup.log_likelihood.resize(angle_rad_.size() * m, 0.0);
    for (const Observation& o : members) {
      setup.common_squares_rad2 += times * o.common_u_rad * o.common_u_rad;
    }
    setup.trials += times * static_cast<double>(members.size());
    const std::vector<Cell> cells = MakeCells(
        members,
        observations.size() > options_.bin_above ? options_.bin_width_rad : 0);
    const GridLikelihood likelihood(cells, scatter_rad_, options_.lapse);
    for (std::size_t i = 0; i < angle_rad_.size(); ++i) {
      likelihood.At(angle_rad_[i], row);
      double* to = setup.log_likelihood.data() + i * m;
      for (std::size_t j = 0; j < m; ++j) to[j] += times * row[j];
    }
  }
}

std::vector<double> EvidenceTable::Joint() const {
  const std::size_t m = scatter_rad_.size();
  std::vector<double> out(angle_rad_.size() * m, 0.0);
  for (const auto& [number, setup] : setups_) {
    if (setup.trials < 0.5) continue;  // all of them taken out again
    const double u =
        std::sqrt(std::max(setup.common_squares_rad2, 0.0) / setup.trials);
    const std::vector<double>& table =
        u > 0.0 ? Smear(setup.log_likelihood, angle_rad_, m, u)
                : setup.log_likelihood;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += table[k];
  }
  return out;
}

std::vector<double> EvidenceTable::Profile(
    const std::vector<double>& joint) const {
  const std::size_t m = scatter_rad_.size();
  std::vector<double> out;
  out.reserve(angle_rad_.size());
  for (std::size_t i = 0; i < angle_rad_.size(); ++i) {
    const double* row = joint.data() + i * m;
    const auto j =
        static_cast<std::size_t>(std::max_element(row, row + m) - row);
    out.push_back(j == 0 || j + 1 == m ? row[j]
                                       : ParabolaTop(-1.0, row[j - 1], 0.0,
                                                     row[j], 1.0, row[j + 1]));
  }
  return out;
}

double EvidenceTable::Greatest(const std::vector<double>& profile,
                               double low_rad, double high_rad) const {
  double out = kNone;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const double a = angle_rad_[i];
    if (a < low_rad - kTwin_rad || a > high_rad + kTwin_rad) continue;
    out = std::max(out, profile[i]);
    // A top between grid points, where both neighbours are in the range too.
    if (i == 0 || i + 1 == profile.size() || profile[i] < profile[i - 1] ||
        profile[i] < profile[i + 1] ||
        angle_rad_[i - 1] < low_rad - kTwin_rad ||
        angle_rad_[i + 1] > high_rad + kTwin_rad) {
      continue;
    }
    out = std::max(out,
                   ParabolaTop(angle_rad_[i - 1], profile[i - 1], a, profile[i],
                               angle_rad_[i + 1], profile[i + 1]));
  }
  return out;
}

Evidence EvidenceTable::Weigh() const {
  const std::vector<double> profile = Profile(Joint());
  Evidence out;
  out.log_below = Greatest(profile, kNone, margin_low_rad_);
  out.log_within = Greatest(profile, margin_low_rad_, margin_high_rad_);
  out.log_above = Greatest(profile, margin_high_rad_, -kNone);
  out.log_far_below = Greatest(profile, kNone, far_low_rad_);
  out.log_near = Greatest(profile, far_low_rad_, far_high_rad_);
  out.log_far_above = Greatest(profile, far_high_rad_, -kNone);
  const double top =
      std::max({out.log_below, out.log_within, out.log_above, out.log_near});
  for (double* value :
       {&out.log_below, &out.log_within, &out.log_above, &out.log_far_below,
        &out.log_near, &out.log_far_above}) {
    *value -= top;
  }
  return out;
}

BoundaryGrid EvidenceTable::Posterior(const ScatterPrior& prior) const {
  BoundaryGrid out{angle_rad_, scatter_rad_, Joint()};
  const std::size_t m = scatter_rad_.size();
  std::vector<double> log_prior(m);
  for (std::size_t j = 0; j < m; ++j) {
    // Trapezoid in ln s.
    log_prior[j] = LogDensity(prior, scatter_rad_[j]) -
                   (j == 0 || j + 1 == m ? std::log(2.0) : 0.0);
  }
  double top = kNone;
  for (std::size_t k = 0; k < out.weight.size(); ++k) {
    top = std::max(top, out.weight[k] += log_prior[k % m]);
  }
  double total = 0.0;
  for (std::size_t i = 0; i < angle_rad_.size(); ++i) {
    const double share = Share(angle_rad_, i);
    for (std::size_t j = 0; j < m; ++j) {
      double& w = out.weight[i * m + j];
      total += w = std::exp(w - top) * share;
    }
  }
  for (double& w : out.weight) w /= total;
  return out;
}

Evidence WeighEvidence(std::span<const Observation> observations,
                       const TheoryBoundary& theory, double margin_rad,
                       const EvidenceOptions& options) {
  EvidenceTable table(theory, margin_rad, options);
  table.Add(observations);
  return table.Weigh();
}

}  // namespace touchdown::analysis
