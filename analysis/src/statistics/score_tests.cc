#include "touchdown/analysis/statistics/score_tests.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

#include "touchdown/analysis/statistics/special_functions.h"
#include "touchdown/core/normal.h"

namespace touchdown::analysis {
namespace {

// Outcomes that the model takes for certain tell nothing of a covariate, and
// their weight is 0 to rounding.
constexpr double kCertainVariance = 1e-9;
// What regression leaves of a covariate that does not vary, as a share of its
// square.
constexpr double kConstant = 1e-9;

struct Term {
  double residual = 0.0;
  double weight = 0.0;
  double z = 0.0;
  double covariate = 0.0;
};

// Takes the weighted regression on 1 and z off the covariates.
void Adjust(std::vector<Term>& terms) {
  const auto take_off = [&](auto base) {
    double square = 0.0;
    double product = 0.0;
    for (const Term& t : terms) {
      square += t.weight * base(t) * base(t);
      product += t.weight * base(t) * t.covariate;
    }
    if (!(square > 0.0)) return;
    for (Term& t : terms) t.covariate -= product / square * base(t);
  };
  double weights = 0.0;
  double mean = 0.0;
  for (const Term& t : terms) {
    weights += t.weight;
    mean += t.weight * t.z;
  }
  mean /= weights;
  take_off([](const Term&) { return 1.0; });
  take_off([mean](const Term& t) { return t.z - mean; });
}

}  // namespace

std::optional<ScoreTest> TestCovariate(
    std::span<const Observation> observations,
    std::span<const std::optional<double>> covariate,
    const BoundaryPosterior& posterior) {
  if (observations.size() != covariate.size()) {
    throw std::invalid_argument(
        fmt::format("covariate has {} values; it must have one for each of the "
                    "{} observations",
                    covariate.size(), observations.size()));
  }
  const double s = posterior.scatter_median_rad;
  std::vector<Term> terms;
  double square = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& o = observations[i];
    if (!covariate[i] || !std::isfinite(*covariate[i])) continue;
    const double sigma = std::hypot(s, o.u_rad);
    const double z = (o.angle_rad - posterior.median_rad) / sigma;
    const double p = core::NormalCdf(z);
    const double variance = p * core::NormalCdf(-z);
    if (variance < kCertainVariance) continue;
    const double density = core::NormalDensity(z) / sigma;
    terms.push_back({(o.p_bounce - p) * density / variance,
                     density * density / variance, z, *covariate[i]});
    square += terms.back().weight * *covariate[i] * *covariate[i];
  }
  if (terms.size() < static_cast<std::size_t>(kFewestToTest)) {
    return std::nullopt;
  }
  Adjust(terms);
  double score = 0.0;
  double information = 0.0;
  for (const Term& t : terms) {
    score -= t.residual * t.covariate;
    information += t.weight * t.covariate * t.covariate;
  }
  if (!(information > kConstant * square)) return std::nullopt;
  ScoreTest out;
  out.z = score / std::sqrt(information);
  out.p = 2.0 * core::NormalCdf(-std::abs(out.z));
  out.slope_rad = score / information;
  out.u_slope_rad = 1.0 / std::sqrt(information);
  out.trials = static_cast<int>(terms.size());
  return out;
}

std::optional<NamedScoreTest> TestNames(
    std::span<const Observation> observations,
    std::span<const std::string> names, const BoundaryPosterior& posterior) {
  if (observations.size() != names.size()) {
    throw std::invalid_argument(
        fmt::format("names has {} values; it must have one for each of the {} "
                    "observations",
                    names.size(), observations.size()));
  }
  std::set<std::string> different(names.begin(), names.end());
  different.erase("");
  if (different.size() < 2) return std::nullopt;
  std::optional<NamedScoreTest> best;
  int tested = 0;
  for (const std::string& name : different) {
    std::vector<std::optional<double>> covariate;
    for (const std::string& of_trial : names) {
      covariate.push_back(of_trial.empty()   ? std::optional<double>()
                          : of_trial == name ? 1.0
                                             : 0.0);
    }
    const auto test = TestCovariate(observations, covariate, posterior);
    if (!test) continue;
    ++tested;
    if (!best || test->p < best->test.p) best = NamedScoreTest{*test, name};
  }
  // Two names are one comparison.
  if (best && different.size() > 2) {
    best->test.p = std::min(best->test.p * tested, 1.0);
  }
  return best;
}

}  // namespace touchdown::analysis
