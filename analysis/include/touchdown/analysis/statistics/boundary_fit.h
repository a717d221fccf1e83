// The boundary angle from trials: a posterior on a grid.
//
// Trial i touched down at x_i, known to u_i, and bounced with probability
//   P_i = lapse + (1 - 2 lapse) Phi((x_i - theta) / sqrt(s^2 + u_i^2)),
// theta the boundary angle, s its intrinsic scatter from trial to trial. The
// Gaussian error of x_i goes into Phi exactly: that is why the link is probit.
// With p_i = P(bounce | what was filmed),
//   l(theta, s) = sum_i log(p_i P_i + (1 - p_i)(1 - P_i)).
// Trials of a set-up share an error b ~ N(0, common u^2) that moves all their
// angles; it is integrated, set-up by set-up (the root mean square where their
// common u differ):
//   L(theta, s) = prod_setups Int exp(l_setup(theta + b, s)) N(b; 0, u^2) db.
// Prior: theta uniform, ln s normal. The posterior exists whatever the outcomes
// are, separated or one-sided; that is why it comes first. Separated outcomes,
// and those at few angles, say nothing of the scatter but what the prior says;
// there the interval must hold under other priors, too.
#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

// Prior on the scatter, in degrees; it regularises nothing else.
//   with log_sd     ln s ~ N(ln median, log_sd^2). The default says: a few
//                   tenths of a degree to ten degrees.
//   without it      p(s) ~ 1 / (1 + (s / median)^2), the half-Cauchy
//                   distribution (@cite Gelman2006): flat below its median, so
//                   that scatters too small to be told from 0 get next to no
//                   weight
struct ScatterPrior {
  double median_rad = 2.0 * core::kDegree;
  std::optional<double> log_sd = 1.5;
};

// Logarithm of its density in ln s, up to a constant.
double LogDensity(const ScatterPrior& prior, double scatter_rad);

struct BoundaryFitOptions {
  double low_rad = 0.0;  // theta is uniform from low to high
  double high_rad = std::numbers::pi / 2;
  ScatterPrior scatter;
  // Where outcomes do not overlap, 95 % intervals hold the equal tails under
  // this prior. By chance that happens to boundaries that scatter: then
  // `scatter` alone takes them for sharp, and covers too few. With this median
  // of 4 deg at least 93 of 100 are covered after 20 and 40 trials at a scatter
  // of 3 deg and steps of 2 deg, overlapping or not (STATISTICS.md). Absent:
  // equal tails under `scatter` alone.
  std::optional<ScatterPrior> cautious_scatter =
      ScatterPrior{4.0 * core::kDegree, std::nullopt};
  // 95 % intervals hold the equal tails under this prior, too, whatever the
  // outcomes. Trials at one angle tell how many scatters it lies from the
  // boundary, not the scatter, and `scatter` has little room for small ones:
  // alone it covers 0.86 to 0.98 of the campaigns of `bench verdicts` at one
  // angle, up to 3 deg from the boundary; with this median, near the least that
  // the grid has, 0.95 or more. Larger covers fewer of them; other designs
  // hardly change (STATISTICS.md). Absent: without it.
  std::optional<ScatterPrior> sharp_scatter =
      ScatterPrior{0.1 * core::kDegree, 0.7};
  // Where outcomes overlap, the 95 % interval holds no angle at which twice the
  // log likelihood, whatever the scatter, lies this far below its greatest
  // value, unless the 90 % interval does. 0.99 quantile of chi^2 with one
  // degree of freedom. With twenty trials about a boundary that hardly
  // scatters, the prior makes the interval up to a fifth wider than that.
  // Absent: the tails alone.
  std::optional<double> unlikely_fall = 6.634896601021213;
  // The same posterior under other priors: how much of it is prior.
  std::vector<ScatterPrior> sensitivity = {{1.0 * core::kDegree, 1.0},
                                           {0.5 * core::kDegree, 1.0}};

  // Trials that went wrong are allowed for (P never below `lapse`: one trial in
  // fifty, on either side) where the greatest log likelihood gains more than
  // this by it: a Bayes factor of about ten. Infinite: never.
  double lapse = 0.02;
  double lapse_gain = 3.0;

  // Scatter grid: `scatter_levels` values, equally spaced in ln s. Below the
  // lowest no rig can tell a scatter from the error of the angle; the highest
  // is nearly half of all angles.
  double scatter_low_rad = 0.05 * core::kDegree;
  double scatter_high_rad = 40.5 * core::kDegree;
  int scatter_levels = 30;
  // Angle grid: begins with this many equal steps and halves every one that
  // holds more than `max_cell_mass` of the posterior. Smaller is slower and
  // finer: 1/128 leaves medians and limits right to 0.003 of the posterior's
  // sd.
  int start_steps = 90;
  double max_cell_mass = 1.0 / 128;

  // More trials than this are put into bins of `bin_width_rad`, each with the
  // mean angle and the spread of its members. Measured with s = u = 0.1 deg,
  // the worst that a rig reaches: median off by 0.01 sd, sd by 0.1 %.
  std::size_t bin_above = 2000;
  double bin_width_rad = 0.05 * core::kDegree;
};

// What kind of data these are.
enum class DataStatus {
  kNoTrials,     // none decided: the posterior is the prior
  kOnlySlides,   // open above
  kOnlyBounces,  // open below
  kSeparated,    // a bracket; the scatter cannot be told from 0
  kTouching,     // separated but for a shared angle
  kOverlap,      // slides above bounces: scatter is seen
  kNoTrend,      // bounces lie no higher than slides, by no more than chance
  kReversed      // bounces lie lower than slides, beyond chance: inconsistent
};
std::string_view Name(DataStatus status);

// "Reversed" is a claim: the score test of a falling trend, one-sided at 5 %.
// Bounces that lie no higher than slides without that, such as five of each at
// one angle, show scatter and no trend.
DataStatus Classify(std::span<const Observation> observations);

// So few decided trials cannot be expected to find a boundary.
inline constexpr int kFewTrials = 10;

// One line of the sensitivity table.
struct SensitivityLine {
  ScatterPrior prior;
  double median_rad = 0.0;
  core::Interval interval95_rad;
};

// The joint posterior on its grid, for those who predict from it.
struct BoundaryGrid {
  std::vector<double> angle_rad;
  std::vector<double> scatter_rad;
  std::vector<double> weight;  // [angle * scatter_rad.size() + scatter], sum 1
};

struct BoundaryPosterior {
  DataStatus status = DataStatus::kNoTrials;
  bool few_trials = true;
  double median_rad = 0.0;
  double mean_rad = 0.0;
  double sd_rad = 0.0;
  // Equal tails. The 95 % interval also holds those under `sharp_scatter` and,
  // where outcomes are separated or touching, those under `cautious_scatter`
  // and the bracket, and where they overlap no angle that the likelihood is
  // against (`unlikely_fall`); the 90 % interval is what a confirmation is
  // judged by. Where all are of one kind, to the end
  // of the support on the side that they leave open, and on the other at least
  // to where the profile of the likelihood has fallen by 1.35 (90 %) or 1.92
  // (95 %), so that no prior on the angle excludes what the trials do not.
  // Equal tails of the posterior alone are Quantile()'s.
  core::Interval interval90_rad;
  core::Interval interval95_rad;
  double scatter_median_rad = 0.0;
  core::Interval scatter95_rad;
  double lapse = 0.0;       // used
  double lapse_gain = 0.0;  // of the greatest log likelihood, where looked at
  bool binned = false;
  ScatterPrior prior;  // that it was made with
  // The other priors of its 95 % interval: the cautious one where outcomes ask
  // for it, the sharp one where it widens the interval.
  std::optional<ScatterPrior> cautious_prior;
  std::optional<ScatterPrior> sharp_prior;
  // Root mean square of the trials' own u; absent without trials.
  std::optional<double> typical_u_rad;
  // What the errors that trials share leave uncertain of the boundary however
  // many trials there are: (sum of 1/u^2 over set-ups)^-1/2; 0 where some
  // trials share none.
  double common_u_rad = 0.0;
  std::vector<SensitivityLine> sensitivity;
  // Marginal of theta: density and distribution function at increasing angles.
  std::vector<double> angle_rad;
  std::vector<double> density_per_rad;
  std::vector<double> cumulative;
  BoundaryGrid grid;
};

// Throws std::invalid_argument naming the option that is out of its range.
BoundaryPosterior FitBoundary(std::span<const Observation> observations,
                              const BoundaryFitOptions& options = {});

// P(theta < angle) and the angle below which theta lies with probability p.
double CumulativeProbability(const BoundaryPosterior& posterior,
                             double angle_rad);
double Quantile(const BoundaryPosterior& posterior, double p);

// P(|theta - value| <= margin), and the least margin for which the equal-tail
// 90 % interval lies within value +- margin: the smallest one that would be
// confirmed. That number says how strong a validation is.
double MarginProbability(const BoundaryPosterior& posterior, double value_rad,
                         double margin_rad);
double SmallestPassingMargin(const BoundaryPosterior& posterior,
                             double value_rad);

}  // namespace touchdown::analysis
