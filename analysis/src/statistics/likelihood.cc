#include "statistics/likelihood.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "touchdown/analysis/statistics/special_functions.h"
#include "touchdown/core/normal.h"

namespace touchdown::analysis {
namespace {

// A probability closer to 1 than this adds nothing to a sum of logarithms that
// is known to 1e-14.
constexpr double kCertain_z = 8.3;
// Ends of the table with lapses: Phi is 0 or 1 to rounding beyond.
constexpr int kLapseEnd = 9;
// Probabilities are multiplied before the one logarithm is taken, as long as
// their product stays a normal number.
constexpr double kSmallestProduct = 1e-200;
constexpr double kSafeZ = -20.0;  // Phi(-20) = 3e-89

struct Key {
  double bin;
  double p_bounce;
  double u_bin;
  bool operator<(const Key& o) const {
    return std::tie(p_bounce, u_bin, bin) <
           std::tie(o.p_bounce, o.u_bin, o.bin);
  }
  bool operator==(const Key& o) const {
    return bin == o.bin && p_bounce == o.p_bounce && u_bin == o.u_bin;
  }
};

// log Phi: 0 above kCertain_z, the exact function below the table.
double FastLogNormalCdf(double z) {
  // Lower end of the table, in standard deviations: the exact function, which
  // takes longer, is rarely asked for below it.
  constexpr int kLow = -25;
  static const HermiteTable table(kLow, 9, LogNormalCdf, [](double x) {
    return std::exp(std::log(core::NormalDensity(x)) - LogNormalCdf(x));
  });
  if (z >= kCertain_z) return 0.0;
  return z < kLow ? LogNormalCdf(z) : table(z);
}

// log(lapse + (1 - 2 lapse) Phi(z)) over the range in which it changes.
HermiteTable LapseTable(double lapse) {
  const double span = 1.0 - 2.0 * lapse;
  return {-kLapseEnd, kLapseEnd,
          [=](double z) { return std::log(lapse + span * core::NormalCdf(z)); },
          [=](double z) {
            return span * core::NormalDensity(z) /
                   (lapse + span * core::NormalCdf(z));
          }};
}

// log(p P + (1 - p)(1 - P)) with P = lapse + (1 - 2 lapse) Phi(z). Near the
// ends of Phi, where a label of probability 1e-9 matters, Phi must be exact.
double LogSoft(double z, double p_bounce, double lapse) {
  // Standard deviations within which the table's absolute error is far below
  // the tails.
  constexpr double kEnds = 3.5;
  const double phi =
      std::abs(z) < kEnds ? FastNormalCdf(z) : core::NormalCdf(z);
  const double not_phi = std::abs(z) < kEnds ? 1.0 - phi : core::NormalCdf(-z);
  const double bounce = lapse + (1.0 - 2.0 * lapse) * phi;
  const double not_bounce = lapse + (1.0 - 2.0 * lapse) * not_phi;
  return std::log(p_bounce * bounce + (1.0 - p_bounce) * not_bounce);
}

}  // namespace

std::vector<Cell> MakeCells(std::span<const Observation> observations,
                            double bin_width_rad) {
  struct Member {
    Key key;
    double angle_rad;
    double u_rad;
  };
  std::vector<Member> members;
  members.reserve(observations.size());
  const bool binned = bin_width_rad > 0.0;
  for (const Observation& o : observations) {
    if (o.p_bounce == 0.5) continue;
    // Uncertainties within a factor sqrt(2) share a bin, and it has their mean
    // square.
    const double bin =
        binned ? std::floor(o.angle_rad / bin_width_rad) : o.angle_rad;
    const double u_bin =
        binned && o.u_rad > 0.0 ? std::round(2 * std::log2(o.u_rad)) : o.u_rad;
    members.push_back({{bin, o.p_bounce, u_bin}, o.angle_rad, o.u_rad});
  }
  std::sort(members.begin(), members.end(), [](const auto& a, const auto& b) {
    return std::tie(a.key, a.angle_rad, a.u_rad) <
           std::tie(b.key, b.angle_rad, b.u_rad);
  });
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < members.size();) {
    std::size_t end = i;
    double sum = 0.0;
    while (end < members.size() && members[end].key == members[i].key) {
      sum += members[end++].angle_rad;
    }
    const double n = static_cast<double>(end - i);
    Cell cell;
    cell.angle_rad = sum / n;
    cell.count = n;
    cell.p_bounce = members[i].key.p_bounce;
    double squares = 0.0;
    for (; i < end; ++i) {
      const double d = members[i].angle_rad - cell.angle_rad;
      squares += d * d + members[i].u_rad * members[i].u_rad;
    }
    cell.variance_rad2 = squares / n;
    cells.push_back(cell);
  }
  return cells;
}

double LogLikelihood(std::span<const Cell> cells, double angle_rad,
                     double scatter_rad, double lapse) {
  double sum = 0.0;
  double product = 1.0;
  for (const Cell& cell : cells) {
    const double z = (cell.angle_rad - angle_rad) /
                     std::sqrt(scatter_rad * scatter_rad + cell.variance_rad2);
    const bool hard = cell.p_bounce == 1.0 || cell.p_bounce == 0.0;
    if (!hard) {
      sum += cell.count * LogSoft(z, cell.p_bounce, lapse);
      continue;
    }
    const double toward = cell.p_bounce == 1.0 ? z : -z;
    if (lapse == 0.0) {
      if (toward > kCertain_z) continue;
      if (toward < kSafeZ || cell.count != 1.0) {
        sum += cell.count * LogNormalCdf(toward);
        continue;
      }
      product *= core::NormalCdf(toward);
    } else {
      const double right =
          lapse + (1.0 - 2.0 * lapse) * core::NormalCdf(toward);
      if (cell.count != 1.0) {
        sum += cell.count * std::log(right);
        continue;
      }
      product *= right;
    }
    if (product < kSmallestProduct) {
      sum += std::log(product);
      product = 1.0;
    }
  }
  return sum + std::log(product);
}

double FastNormalCdf(double z) {
  // Standard deviations: 1 - Phi(9) is 1e-19, below a double's last digit.
  constexpr int kEnd = 9;
  static const HermiteTable table(-kEnd, kEnd, core::NormalCdf,
                                  core::NormalDensity);
  if (z <= -kCertain_z) return 0.0;
  return z >= kCertain_z ? 1.0 : table(z);
}

GridLikelihood::GridLikelihood(std::span<const Cell> cells,
                               std::span<const double> scatter_rad,
                               double lapse)
    : cells_(cells), lapse_(lapse), levels_(scatter_rad.size()) {
  if (lapse > 0.0) with_lapse_.push_back(LapseTable(lapse));
  std::map<double, std::size_t> rows;
  row_.reserve(cells.size());
  for (const Cell& cell : cells) {
    const auto [row, is_new] = rows.emplace(cell.variance_rad2, rows.size());
    row_.push_back(row->second);
    if (!is_new) continue;
    for (const double s : scatter_rad) {
      inverse_.push_back(1.0 / std::sqrt(s * s + cell.variance_rad2));
    }
  }
}

void GridLikelihood::At(double angle_rad, std::span<double> out) const {
  std::fill(out.begin(), out.end(), 0.0);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell& cell = cells_[i];
    const double* inverse = inverse_.data() + row_[i] * levels_;
    const double distance = cell.angle_rad - angle_rad;
    const bool hard = cell.p_bounce == 1.0 || cell.p_bounce == 0.0;
    const double toward = cell.p_bounce == 1.0 ? distance : -distance;
    if (hard && lapse_ == 0.0) {
      for (std::size_t j = 0; j < levels_; ++j) {
        out[j] += cell.count * FastLogNormalCdf(toward * inverse[j]);
      }
    } else if (hard) {
      const HermiteTable& table = with_lapse_.front();
      // The table's end: beyond it nothing changes.
      constexpr double kEnd = kCertain_z;
      for (std::size_t j = 0; j < levels_; ++j) {
        out[j] +=
            cell.count * table(std::clamp(toward * inverse[j], -kEnd, kEnd));
      }
    } else {
      for (std::size_t j = 0; j < levels_; ++j) {
        out[j] +=
            cell.count * LogSoft(distance * inverse[j], cell.p_bounce, lapse_);
      }
    }
  }
}

}  // namespace touchdown::analysis
