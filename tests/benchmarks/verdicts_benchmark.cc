// What a verdict is worth, as CSV on stdout:
//
//   touchdown_verdicts_benchmark errors   [CAMPAIGNS] [SEED] [DESIGN]
//   touchdown_verdicts_benchmark coverage [CAMPAIGNS] [SEED] [DESIGN] [SCATTER]
//
// errors    false verdicts at any of 60 looks, and the trial at which the right
//           one first stands, beside those of the rule before this one (90 % or
//           95 % interval of the posterior alone)
// coverage  of the boundary's 95 % interval after 20, 40 and 100 trials: of all
//           campaigns, of those whose outcomes overlap, and of the equal tails
//           under the first prior alone; of the likelihood's profile, where
//           outcomes overlap
//
// Every campaign: boundary U(2, 40) deg, margin 1 deg, ejector's sd 0.5 deg,
// own u 0.3 deg. CAMPAIGNS (400) is for each cell without common error; cells
// with one have half.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "touchdown/analysis/statistics/agreement_statistics.h"
#include "touchdown/analysis/statistics/boundary_fit.h"
#include "touchdown/analysis/statistics/classic_designs.h"
#include "touchdown/analysis/statistics/evidence.h"
#include "touchdown/analysis/statistics/likelihood_profile.h"
#include "touchdown/analysis/statistics/next_angle.h"
#include "touchdown/analysis/statistics/set_angles.h"
#include "touchdown/analysis/statistics/verdict.h"
#include "touchdown/core/units.h"

namespace {

using namespace touchdown::analysis;
using touchdown::core::kDegree;
using touchdown::core::Origin;
using touchdown::core::Verdict;
using Engine = std::mt19937_64;

constexpr int kLooks = 60;
constexpr double kMargin_deg = 1.0;
constexpr double kSetSd_deg = 0.5;
constexpr double kOwnU_deg = 0.3;
constexpr double kScatters_deg[] = {0.0, 0.3, 1.0, 3.0};
constexpr double kDistances[] = {0.0, 0.9, 1.1, 3.0};
constexpr double kCommon_deg[] = {0.0, 0.3, 0.5};
// A trial's angle may shift by this much, when the set angles are used afresh,
// before it is put into the table anew: a tenth of its u.
constexpr double kShift_deg = 0.03;

double Draw(double low, double high, Engine& engine) {
  return std::uniform_real_distribution<double>(low, high)(engine);
}

struct Cell {
  std::string design;
  double scatter_deg = 0.0;
  double distance = 0.0;  // of the truth from the theory, margins
  double common_deg = 0.0;
};

// One campaign's truth, and the angle it sets next.
struct Campaign {
  const Cell* cell = nullptr;
  double boundary_deg = 0.0;
  double theory_deg = 0.0;
  double common_error_deg = 0.0;
  double side = 1.0;  // of one-sided ones
};

// What the designs need to know of the trials so far.
double SetAngle_deg(const Campaign& campaign,
                    std::span<const Observation> trials,
                    const EvidenceTable& table, Engine& engine) {
  const std::string& design = campaign.cell->design;
  const int n = static_cast<int>(trials.size());
  if (design == "ascending") return (2 * n) % kLooks;
  if (design == "descending") return kLooks - 2 - (2 * n) % kLooks;
  if (design == "staircase") return NextUpDown(trials).angle_rad / kDegree;
  if (design == "table1") {
    constexpr double kAngles_deg[] = {0.0,  3.9,  7.8,  11.8, 27.4,
                                      43.0, 58.7, 74.4, 90.0};
    return kAngles_deg[static_cast<std::size_t>(n) % std::size(kAngles_deg)];
  }
  if (design == "same-angle") return campaign.theory_deg;
  if (design == "one-sided") {
    return std::max(
        campaign.theory_deg + campaign.side * Draw(1.0, 8.0, engine), 0.0);
  }
  // The program's own rule, on the table's posterior: as fine as FitBoundary's
  // where it matters, within five margins of the theory.
  BoundaryPosterior posterior;
  posterior.grid = table.Posterior(posterior.prior);
  const std::size_t m = posterior.grid.scatter_rad.size();
  double second = 0.0;
  for (std::size_t k = 0; k < posterior.grid.weight.size(); ++k) {
    const double theta = posterior.grid.angle_rad[k / m];
    posterior.mean_rad += posterior.grid.weight[k] * theta;
    second += posterior.grid.weight[k] * theta * theta;
  }
  posterior.sd_rad = std::sqrt(
      std::max(second - posterior.mean_rad * posterior.mean_rad, 0.0));
  NextAngleOptions options;
  options.forecast_futures = 0;
  return ChooseNextAngle(posterior, n, options).angle_rad / kDegree;
}

Observation Throw(const Campaign& campaign, double set_deg, Engine& engine) {
  std::normal_distribution<double> normal;
  const double true_deg = set_deg + kSetSd_deg * normal(engine);
  const bool bounced =
      true_deg >
      campaign.boundary_deg + campaign.cell->scatter_deg * normal(engine);
  const double seen_deg =
      true_deg + campaign.common_error_deg + kOwnU_deg * normal(engine);
  Observation out = Observe(std::clamp(seen_deg, 0.0, 90.0) * kDegree,
                            kOwnU_deg * kDegree, bounced ? 1.0 : 0.0);
  out.common_u_rad = campaign.cell->common_deg * kDegree;
  out.set_angle_rad = std::max(set_deg, 0.0) * kDegree;
  return out;
}

Campaign Begin(const Cell& cell, Engine& engine) {
  Campaign out;
  out.cell = &cell;
  out.boundary_deg = Draw(2.0, 40.0, engine);
  const double sign = Draw(0.0, 1.0, engine) < 0.5 ? -1.0 : 1.0;
  const double off_deg = cell.distance * kMargin_deg;
  // A theory below 1 deg has no margin below it.
  out.theory_deg =
      out.boundary_deg +
      (out.boundary_deg + sign * off_deg < 1.0 ? 1.0 : sign) * off_deg;
  std::normal_distribution<double> normal;
  out.common_error_deg = cell.common_deg * normal(engine);
  out.side = Draw(0.0, 1.0, engine) < 0.5 ? -1.0 : 1.0;
  return out;
}

// P(theta below, above) of a table's posterior; half of the edge's own share.
std::pair<double, double> Tails(const BoundaryGrid& grid, double low_rad,
                                double high_rad) {
  constexpr double kEdge_rad = 1e-9;
  const auto share = [&](double distance_rad) {
    return distance_rad > kEdge_rad ? 1.0 : distance_rad > -kEdge_rad ? 0.5 : 0;
  };
  const std::size_t m = grid.scatter_rad.size();
  double below = 0.0;
  double above = 0.0;
  for (std::size_t i = 0; i < grid.angle_rad.size(); ++i) {
    const double b = share(low_rad - grid.angle_rad[i]);
    const double a = share(grid.angle_rad[i] - high_rad);
    if (a == 0.0 && b == 0.0) continue;
    for (std::size_t j = 0; j < m; ++j) {
      below += b * grid.weight[i * m + j];
      above += a * grid.weight[i * m + j];
    }
  }
  return {below, above};
}

constexpr int kNever = kLooks + 1;

struct Rule {
  bool is_false = false;
  int right_after = kNever;
};

// What each rule ever said.
struct Run {
  Rule now;
  Rule before;
};

void Note(Rule& rule, Verdict verdict, bool truth_within, int look) {
  if (verdict == Verdict::kInconclusive) return;
  if ((verdict == Verdict::kConfirmed) == truth_within) {
    rule.right_after = std::min(rule.right_after, look);
  } else {
    rule.is_false = true;
  }
}

Run RunCampaign(const Cell& cell, Engine& engine) {
  const Campaign campaign = Begin(cell, engine);
  const TheoryBoundary theory{"t", campaign.theory_deg * kDegree, 0.0};
  const double margin = kMargin_deg * kDegree;
  EvidenceOptions coarse;
  coarse.scatter_levels = 16;  // twice as fast; log ratios right to 0.15
  EvidenceTable table(theory, margin, coarse);
  std::vector<Observation> trials;
  std::vector<Observation> in_table;
  Run out;
  for (int look = 1; look <= kLooks; ++look) {
    trials.push_back(
        Throw(campaign, SetAngle_deg(campaign, trials, table, engine), engine));
    const std::vector<Observation> used = UseSetAngles(trials).observations;
    // What a new trial at the same set angle moved is taken out and put back.
    for (std::size_t i = 0; i < in_table.size(); ++i) {
      const double shift = std::abs(used[i].angle_rad - in_table[i].angle_rad) +
                           std::abs(used[i].u_rad - in_table[i].u_rad);
      if (shift <= kShift_deg * kDegree) continue;
      table.Remove({&in_table[i], 1});
      table.Add({&used[i], 1});
      in_table[i] = used[i];
    }
    table.Add({&used.back(), 1});
    in_table.push_back(used.back());

    VerdictBasis basis;
    basis.counts = Count(trials);
    basis.status = Classify(trials);
    const auto [least, greatest] = std::minmax_element(
        trials.begin(), trials.end(),
        [](const auto& a, const auto& b) { return a.angle_rad < b.angle_rad; });
    basis.span_rad = greatest->angle_rad - least->angle_rad;
    const auto [below, above] =
        Tails(table.Posterior(), theory.boundary_rad - margin,
              theory.boundary_rad + margin);
    basis.p_below = basis.p_far_below = below;
    basis.p_above = basis.p_far_above = above;
    const bool within = cell.distance <= 1.0;
    const Verdict before = below <= 0.05 && above <= 0.05 ? Verdict::kConfirmed
                           : std::max(below, above) >= 1.0 - 0.025
                               ? Verdict::kContradicted
                               : Verdict::kInconclusive;
    Note(out.before, before, within, look);
    // The likelihood is asked where the posterior says something: the rule
    // needs both.
    if (before == Verdict::kInconclusive) continue;
    basis.evidence = table.Weigh();
    Note(out.now, *Judge(basis, theory, margin, Origin::kRecorded).verdict,
         within, look);
  }
  return out;
}

int Median(std::vector<int> values) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string OrNever(int median) {
  return median >= kNever ? "-" : fmt::format("{}", median);
}

constexpr const char* kDesigns[] = {"ascending", "descending", "staircase",
                                    "table1",    "next",       "same-angle",
                                    "one-sided"};
// 0.995 quantile of the normal distribution: a 99 % band.
constexpr double kNormal995 = 2.5758293035489004;

// Wilson's band of k of n at 99 %.
touchdown::core::Interval Band99(int k, int n) {
  const double z2 = kNormal995 * kNormal995;
  const double p = static_cast<double>(k) / n;
  const double middle = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kNormal995 / (1 + z2 / n) *
                      std::sqrt(p * (1 - p) / n + z2 / (4.0 * n * n));
  return {middle - half, middle + half};
}

void Errors(int campaigns, std::uint64_t seed, const std::string& only) {
  fmt::print(
      "design,common_deg,scatter_deg,distance_margins,campaigns,false,"
      "false_low99,false_high99,median_right,false_before,"
      "median_right_before\n");
  for (const char* design : kDesigns) {
    if (!only.empty() && only != design) continue;
    int all = 0;
    int all_false = 0;
    int all_false_before = 0;
    for (const double common : kCommon_deg) {
      for (const double scatter : kScatters_deg) {
        for (const double distance : kDistances) {
          const Cell cell{design, scatter, distance, common};
          // Each cell has its own numbers, whatever is run beside it.
          std::seed_seq sequence{
              static_cast<std::uint32_t>(seed),
              static_cast<std::uint32_t>(
                  std::find(std::begin(kDesigns), std::end(kDesigns), design) -
                  std::begin(kDesigns)),
              static_cast<std::uint32_t>(10 * scatter),
              static_cast<std::uint32_t>(10 * distance),
              static_cast<std::uint32_t>(10 * common)};
          Engine engine(sequence);
          const int n = common > 0.0 ? (campaigns + 1) / 2 : campaigns;
          int wrong = 0;
          int wrong_before = 0;
          std::vector<int> right;
          std::vector<int> right_before;
          for (int r = 0; r < n; ++r) {
            const Run run = RunCampaign(cell, engine);
            wrong += run.now.is_false ? 1 : 0;
            wrong_before += run.before.is_false ? 1 : 0;
            right.push_back(run.now.right_after);
            right_before.push_back(run.before.right_after);
          }
          all += n;
          all_false += wrong;
          all_false_before += wrong_before;
          const auto band = Band99(wrong, n);
          fmt::print("{},{},{},{},{},{:.4f},{:.4f},{:.4f},{},{:.4f},{}\n",
                     design, common, scatter, distance, n,
                     static_cast<double>(wrong) / n, band.low, band.high,
                     OrNever(Median(right)),
                     static_cast<double>(wrong_before) / n,
                     OrNever(Median(right_before)));
          std::fflush(stdout);
        }
      }
    }
    const auto band = Band99(all_false, all);
    fmt::print("{},all,all,all,{},{:.4f},{:.4f},{:.4f},,{:.4f},\n", design, all,
               static_cast<double>(all_false) / all, band.low, band.high,
               static_cast<double>(all_false_before) / all);
  }
}

// Coverage of the 95 % interval, of all campaigns and of those whose outcomes
// overlap, after so many trials.
constexpr int kCoverageAt[] = {20, 40, 100};
constexpr double kTail95 = 0.025;

// `only_scatter_deg`: of one scatter alone; negative for all.
void Coverage(int campaigns, std::uint64_t seed, const std::string& only,
              double only_scatter_deg) {
  fmt::print(
      "design,common_deg,scatter_deg,trials,campaigns,coverage,low99,high99,"
      "overlapping,coverage_overlapping,low99_overlapping,median_width_deg,"
      "coverage_one_prior,coverage_overlapping_profile\n");
  for (const char* design : kDesigns) {
    // The angles of one-sided campaigns follow the theory, which is no matter
    // of the interval.
    if (std::string(design) == "one-sided") continue;
    if (!only.empty() && only != design) continue;
    for (const double common : kCommon_deg) {
      for (const double scatter : kScatters_deg) {
        if (only_scatter_deg >= 0.0 && only_scatter_deg != scatter) continue;
        Cell cell{design, scatter, 0.0, common};
        std::seed_seq sequence{
            static_cast<std::uint32_t>(seed), 0xC0u,
            static_cast<std::uint32_t>(
                std::find(std::begin(kDesigns), std::end(kDesigns), design) -
                std::begin(kDesigns)),
            static_cast<std::uint32_t>(10 * scatter),
            static_cast<std::uint32_t>(10 * common)};
        Engine engine(sequence);
        const int n = common > 0.0 ? (campaigns + 1) / 2 : campaigns;
        struct At {
          int hits = 0;
          int overlapping = 0;
          int hits_overlapping = 0;
          int hits_one_prior = 0;
          int hits_overlapping_profile = 0;
          std::vector<int> width_millideg;
        };
        At at[std::size(kCoverageAt)];
        for (int r = 0; r < n; ++r) {
          // A theory that is the truth would give it away to the designs that
          // choose their angles by it.
          cell.distance =
              kDistances[static_cast<std::size_t>(r) % std::size(kDistances)];
          const Campaign campaign = Begin(cell, engine);
          const TheoryBoundary theory{"t", campaign.theory_deg * kDegree, 0.0};
          EvidenceOptions coarse;
          coarse.scatter_levels = 16;
          // Only the program's own angle needs the table.
          EvidenceTable table(theory, kMargin_deg * kDegree, coarse);
          const bool adaptive = cell.design == "next";
          std::vector<Observation> trials;
          for (std::size_t k = 0; k < std::size(kCoverageAt); ++k) {
            while (static_cast<int>(trials.size()) < kCoverageAt[k]) {
              trials.push_back(
                  Throw(campaign, SetAngle_deg(campaign, trials, table, engine),
                        engine));
              if (adaptive) table.Add({&trials.back(), 1});
            }
            BoundaryFitOptions fit;
            fit.sensitivity.clear();
            const auto posterior =
                FitBoundary(UseSetAngles(trials).observations, fit);
            const auto& interval = posterior.interval95_rad;
            const double truth = campaign.boundary_deg * kDegree;
            const bool hit = interval.low <= truth && truth <= interval.high;
            const double below = CumulativeProbability(posterior, truth);
            const bool hit_one_prior =
                posterior.cautious_prior || posterior.sharp_prior
                    ? kTail95 <= below && below <= 1.0 - kTail95
                    : hit;
            const bool overlap = Classify(trials) == DataStatus::kOverlap;
            at[k].hits += hit ? 1 : 0;
            at[k].overlapping += overlap ? 1 : 0;
            at[k].hits_overlapping += hit && overlap ? 1 : 0;
            at[k].hits_one_prior += hit_one_prior ? 1 : 0;
            if (overlap) {
              const auto profile = ProfileOfPosterior(posterior).interval95_rad;
              at[k].hits_overlapping_profile +=
                  profile.low <= truth && truth <= profile.high ? 1 : 0;
            }
            at[k].width_millideg.push_back(static_cast<int>(
                std::lround(1e3 * (interval.high - interval.low) / kDegree)));
          }
        }
        for (std::size_t k = 0; k < std::size(kCoverageAt); ++k) {
          const At& a = at[k];
          const auto band = Band99(a.hits, n);
          const std::string overlapping =
              a.overlapping > 0
                  ? fmt::format(
                        "{:.4f},{:.4f}",
                        static_cast<double>(a.hits_overlapping) / a.overlapping,
                        Band99(a.hits_overlapping, a.overlapping).low)
                  : "-,-";
          fmt::print(
              "{},{},{},{},{},{:.4f},{:.4f},{:.4f},{},{},{:.2f},{:.4f},{}\n",
              design, common, scatter, kCoverageAt[k], n,
              static_cast<double>(a.hits) / n, band.low, band.high,
              a.overlapping, overlapping, Median(a.width_millideg) / 1e3,
              static_cast<double>(a.hits_one_prior) / n,
              a.overlapping > 0
                  ? fmt::format("{:.4f}", static_cast<double>(
                                              a.hits_overlapping_profile) /
                                              a.overlapping)
                  : "-");
        }
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const auto number = [&](int i, int otherwise) {
    return argc > i ? std::atoi(argv[i]) : otherwise;
  };
  if (what == "errors") {
    Errors(number(2, 400), static_cast<std::uint64_t>(number(3, 1)),
           argc > 4 ? argv[4] : "");
  } else if (what == "coverage") {
    Coverage(number(2, 400), static_cast<std::uint64_t>(number(3, 1)),
             argc > 4 ? argv[4] : "", argc > 5 ? std::atof(argv[5]) : -1.0);
  } else {
    fmt::print(stderr, "expected errors or coverage\n");
    return 2;
  }
  return 0;
}
