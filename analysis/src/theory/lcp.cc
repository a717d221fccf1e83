#include "touchdown/analysis/theory/lcp.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "theory/wide.h"

namespace touchdown::analysis {
namespace {

using Vector = std::array<Wide, kLcpMaxSize>;
using Matrix = std::array<Vector, kLcpMaxSize>;
using Subset = unsigned;  // bit i: index i belongs to it

// 64 units in the last place of a double: matrices come in doubles, and what is
// below that share of their terms may be zero.
constexpr Wide kRoundOff = 64 * 0x1p-53L;

bool Has(Subset set, std::size_t i) { return (set >> i & 1U) != 0; }

// The rows and columns of a matrix that two subsets name, reduced by
// Gauss-Jordan elimination with full pivoting: `left` times the matrix is the
// identity on the pivots.
struct Reduction {
  Matrix a{};     // reduced
  Matrix left{};  // what it was multiplied with
  Subset columns = 0;
  Subset free_columns = 0;  // without a pivot: dependent
  std::array<std::size_t, kLcpMaxSize> pivot_row{};  // of each pivot column
};

Reduction Reduce(const Matrix& m, Subset rows, Subset columns, std::size_t n) {
  Reduction out;
  out.a = m;
  out.columns = columns;
  out.free_columns = columns;
  for (std::size_t i = 0; i < n; ++i) out.left[i][i] = 1;
  Subset free_rows = rows;
  Wide largest = 0;
  while (out.free_columns != 0 && free_rows != 0) {
    std::size_t row = 0;
    std::size_t column = 0;
    Wide pivot = 0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n && Has(free_rows, i); ++j) {
        if (!Has(out.free_columns, j) ||
            std::abs(out.a[i][j]) <= std::abs(pivot)) {
          continue;
        }
        row = i;
        column = j;
        pivot = out.a[i][j];
      }
    }
    largest = std::max(largest, std::abs(pivot));
    if (std::abs(pivot) <= kRoundOff * largest) break;
    for (std::size_t j = 0; j < n; ++j) {
      out.a[row][j] /= pivot;
      out.left[row][j] /= pivot;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (i == row || !Has(rows, i)) continue;
      const Wide factor = out.a[i][column];
      if (factor == 0) continue;
      for (std::size_t j = 0; j < n; ++j) {
        out.a[i][j] -= factor * out.a[row][j];
        out.left[i][j] -= factor * out.left[row][j];
      }
      out.a[i][column] = 0;
    }
    out.pivot_row[column] = row;
    out.free_columns &= ~(Subset{1} << column);
    free_rows &= ~(Subset{1} << row);
  }
  return out;
}

struct Candidate {
  Vector z{};
  Vector error{};  // what rounding of the inputs leaves open in z
  bool basic = true;
};

class Enumeration {
 public:
  Enumeration(std::span<const double> m, std::span<const double> q)
      : n_(q.size()), all_((Subset{1} << n_) - 1) {
    for (std::size_t i = 0; i < n_; ++i) {
      q_[i] = static_cast<Wide>(q[i]);
      for (std::size_t j = 0; j < n_; ++j) {
        m_[i][j] = static_cast<Wide>(m[i * n_ + j]);
      }
    }
    Equilibrate();
  }

  LcpResult Run() {
    for (Subset basis = 0; basis <= all_; ++basis) {
      if (!TryBasis(basis)) singular_.push_back(basis);
    }
    result_.n_singular_bases = static_cast<int>(singular_.size());
    result_.n_basic = static_cast<int>(found_.size());
    for (const Subset basis : singular_) TryCorners(basis);
    for (const Candidate& c : found_) result_.solutions.push_back(Report(c));
    if (found_.empty()) {
      result_.status = LcpStatus::kNone;
    } else if (IsContinuum()) {
      result_.status = LcpStatus::kContinuum;
    } else {
      result_.status =
          found_.size() == 1 ? LcpStatus::kUnique : LcpStatus::kSeveral;
    }
    return std::move(result_);
  }

 private:
  // Powers of two for rows and columns that bring the entries as near to 1 as
  // they go, in the mean square of their logarithms (@cite CurtisReid1972):
  // unlike scaling by the largest entry it undoes any change of units. Means of
  // rows and columns are removed in turn until they rest.
  void Equilibrate() {
    Matrix exponent{};
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t j = 0; j < n_; ++j) {
        if (m_[i][j] != 0) exponent[i][j] = std::log2(std::abs(m_[i][j]));
      }
    }
    Vector row{};
    Vector column{};
    // A bound on time. Not studied.
    constexpr int kMaxPasses = 100;
    constexpr Wide kRest = 0.25L;  // of a power of two
    Wide change = 2 * kRest;
    for (int pass = 0; pass < kMaxPasses && change > kRest; ++pass) {
      change = 0;
      for (const bool by_row : {true, false}) {
        for (std::size_t k = 0; k < n_; ++k) {
          Wide sum = 0;
          int count = 0;
          for (std::size_t l = 0; l < n_; ++l) {
            const std::size_t i = by_row ? k : l;
            const std::size_t j = by_row ? l : k;
            if (m_[i][j] == 0) continue;
            sum += exponent[i][j] + row[i] + column[j];
            ++count;
          }
          if (count == 0) continue;
          (by_row ? row : column)[k] -= sum / count;
          change = std::max(change, std::abs(sum / count));
        }
      }
    }
    for (std::size_t i = 0; i < n_; ++i) {
      row_scale_[i] = std::ldexp(Wide(1), static_cast<int>(row[i]));
      column_scale_[i] = std::ldexp(Wide(1), static_cast<int>(column[i]));
      q_[i] *= row_scale_[i];
    }
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t j = 0; j < n_; ++j) {
        m_[i][j] *= row_scale_[i] * column_scale_[j];
      }
    }
  }

  // Solves M[rows, columns] z = -q[rows] on as many independent rows as there
  // are columns. Nothing where the columns are dependent.
  std::optional<Candidate> Solve(Subset rows, Subset columns) const {
    const Reduction reduced = Reduce(m_, rows, columns, n_);
    if (reduced.free_columns != 0) return std::nullopt;
    Candidate out;
    out.basic = rows == columns;
    for (std::size_t j = 0; j < n_; ++j) {
      if (!Has(columns, j)) continue;
      const Vector& left = reduced.left[reduced.pivot_row[j]];
      for (std::size_t i = 0; i < n_; ++i) out.z[j] -= left[i] * q_[i];
    }
    // |M^-1| (|M| |z| + |q|), componentwise.
    for (std::size_t j = 0; j < n_; ++j) {
      if (!Has(columns, j)) continue;
      const Vector& left = reduced.left[reduced.pivot_row[j]];
      for (std::size_t i = 0; i < n_; ++i) {
        out.error[j] += kRoundOff * std::abs(left[i]) * RowSize(out.z, i);
      }
    }
    return out;
  }

  Wide RowSize(const Vector& z, std::size_t i) const {
    Wide size = std::abs(q_[i]);
    for (std::size_t j = 0; j < n_; ++j) size += std::abs(m_[i][j] * z[j]);
    return size;
  }

  Wide W(const Vector& z, std::size_t i) const {
    Wide w = q_[i];
    for (std::size_t j = 0; j < n_; ++j) w += m_[i][j] * z[j];
    return w;
  }

  // z >= 0, w >= 0, z w = 0, each within its tolerance.
  bool IsSolution(const Candidate& c) const {
    for (std::size_t i = 0; i < n_; ++i) {
      Wide w_error = kRoundOff * RowSize(c.z, i);
      for (std::size_t j = 0; j < n_; ++j) {
        w_error += std::abs(m_[i][j]) * c.error[j];
      }
      const Wide w = W(c.z, i);
      if (c.z[i] < -c.error[i] || w < -w_error) return false;
      if (c.z[i] > c.error[i] && w > w_error) return false;
    }
    return true;
  }

  void Keep(Candidate c) {
    for (std::size_t i = 0; i < n_; ++i) {
      if (std::abs(c.z[i]) <= c.error[i]) c.z[i] = 0;
    }
    for (const Candidate& other : found_) {
      bool same = true;
      for (std::size_t i = 0; i < n_; ++i) {
        same = same &&
               std::abs(c.z[i] - other.z[i]) <= c.error[i] + other.error[i];
      }
      if (same) return;
    }
    found_.push_back(c);
  }

  // False where the basis is singular.
  bool TryBasis(Subset basis) {
    const auto candidate = Solve(basis, basis);
    if (candidate && IsSolution(*candidate)) Keep(*candidate);
    return candidate.has_value();
  }

  // A solution that no nonsingular basis gives is the corner of the polyhedron
  // of a singular one: more w vanish there than unknowns are in it.
  void TryCorners(Subset basis) {
    const Subset rest = all_ & ~basis;
    for (Subset extra = rest; extra != 0; extra = (extra - 1) & rest) {
      const auto candidate = Solve(basis | extra, basis);
      if (candidate && IsSolution(*candidate)) Keep(*candidate);
    }
  }

  bool StepSolves(Candidate from, const Vector& step, Wide factor) const {
    for (std::size_t i = 0; i < n_; ++i) {
      from.z[i] += factor * step[i];
      from.error[i] += kRoundOff * std::abs(factor * step[i]);
    }
    return IsSolution(from);
  }

  // Solutions between two that were found, or on a ray from one along the null
  // space of a singular basis.
  bool IsContinuum() const {
    for (std::size_t k = 0; k < found_.size(); ++k) {
      for (std::size_t l = 0; l < k; ++l) {
        Vector step{};
        for (std::size_t i = 0; i < n_; ++i) {
          step[i] = found_[l].z[i] - found_[k].z[i];
        }
        if (StepSolves(found_[k], step, 0.5L)) return true;
      }
    }
    for (const Subset basis : singular_) {
      const Reduction reduced = Reduce(m_, basis, basis, n_);
      for (std::size_t k = 0; k < n_; ++k) {
        if (!Has(reduced.free_columns, k)) continue;
        Vector direction{};
        direction[k] = 1;
        Wide length = 1;
        for (std::size_t j = 0; j < n_; ++j) {
          if (!Has(basis & ~reduced.free_columns, j)) continue;
          direction[j] = -reduced.a[reduced.pivot_row[j]][k];
          length = std::max(length, std::abs(direction[j]));
        }
        for (const Candidate& from : found_) {
          const Wide size = 1 + *std::max_element(from.z.begin(), from.z.end());
          if (StepSolves(from, direction, size / length) ||
              StepSolves(from, direction, -size / length)) {
            return true;
          }
        }
      }
    }
    return false;
  }

  LcpSolution Report(const Candidate& c) const {
    LcpSolution out;
    out.basic = c.basic;
    Wide sum = 0;
    Wide q_sum = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      const Wide z = c.z[i] * column_scale_[i];
      const Wide w = W(c.z, i) / row_scale_[i];
      const Wide q = q_[i] / row_scale_[i];
      out.z.push_back(static_cast<double>(z));
      out.w.push_back(static_cast<double>(w));
      const Wide gap = std::min(z, w);
      sum += gap * gap;
      q_sum += q * q;
    }
    out.residual = static_cast<double>(
        q_sum > 0 ? std::sqrt(sum) / std::sqrt(q_sum) : std::sqrt(sum));
    return out;
  }

  std::size_t n_;
  Subset all_;
  Matrix m_{};
  Vector q_{};
  Vector row_scale_{};
  Vector column_scale_{};
  std::vector<Subset> singular_;
  std::vector<Candidate> found_;
  LcpResult result_;
};

}  // namespace

LcpResult SolveLcp(std::span<const double> m, std::span<const double> q) {
  if (q.empty() || q.size() > kLcpMaxSize) {
    throw std::invalid_argument(fmt::format(
        "size of the complementarity problem is {}, must be from 1 to {}",
        q.size(), kLcpMaxSize));
  }
  if (m.size() != q.size() * q.size()) {
    throw std::invalid_argument(
        fmt::format("matrix has {} entries, must have {} for {} unknowns",
                    m.size(), q.size() * q.size(), q.size()));
  }
  const auto is_finite = [](double x) { return std::isfinite(x); };
  if (!std::all_of(m.begin(), m.end(), is_finite) ||
      !std::all_of(q.begin(), q.end(), is_finite)) {
    throw std::invalid_argument("an entry of M or q is not finite");
  }
  return Enumeration(m, q).Run();
}

std::string_view Name(LcpStatus status) {
  switch (status) {
    case LcpStatus::kNone:
      return "none";
    case LcpStatus::kUnique:
      return "unique";
    case LcpStatus::kSeveral:
      return "several";
    case LcpStatus::kContinuum:
      return "continuum";
  }
  return "";
}

}  // namespace touchdown::analysis
