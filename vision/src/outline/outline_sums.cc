#include "outline/outline_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "numbers/lanes.h"
#include "numbers/robust.h"

namespace touchdown::vision {
namespace {

template <std::size_t kCount>
double SumLanes(const std::array<float, kCount>& lanes) {
  double sum = 0.0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

}  // namespace

// Keeps the columns from fit to fit and grows them only: allocation would take
// longer than a small fit.
void OutlinePixels::Clear(std::size_t room) {
  size = 0;
  if (x.size() >= room + kBlock) return;
  x.resize(room + kBlock);
  y.resize(room + kBlock);
  for (Column* const column : {&value, &background, &behind, &per_noise}) {
    column->resize(room + kBlock);
  }
}

// Writes 1/noise of each pixel, and fills the last block with copies of the
// last pixel of weight 0, so that loops need no remainder.
void OutlinePixels::Finish(double floor_dn2, double slope_dn,
                           double least_dn2) {
  for (std::size_t i = 0; i < size; ++i) {
    const double variance =
        floor_dn2 + slope_dn * static_cast<double>(value[i]);
    per_noise[i] = static_cast<float>(
        1.0 / std::sqrt(variance > least_dn2 ? variance : least_dn2));
  }
  for (std::size_t i = size; i < padded(); ++i) {
    x[i] = x[size - 1];
    y[i] = y[size - 1];
    value[i] = value[size - 1];
    background[i] = background[size - 1];
    behind[i] = behind[size - 1];
    per_noise[i] = 0.0F;
  }
}

double OutlinePixels::MeanBackground() const {
  // Independent sums: no addition waits for the one before. The order is fixed,
  // so that the result does not depend on the processor.
  constexpr std::size_t kSums = 8;
  std::array<double, kSums> sums{};
  std::size_t i = 0;
  for (; i + kSums <= size; i += kSums) {
    for (std::size_t k = 0; k < kSums; ++k) {
      sums[k] += static_cast<double>(background[i + k]);
    }
  }
  for (; i < size; ++i) sums[0] += static_cast<double>(background[i]);
  return std::accumulate(sums.begin(), sums.end(), 0.0) /
         static_cast<double>(size);
}

// One block of pixels in one round. All loops run over whole blocks of fixed
// size, which the compiler turns into vector instructions.
struct OutlineBlock {
  const float* value;
  const float* background;
  const float* behind;
  const float* per_noise;
  double* residuals;

  using Lanes = OutlineSums::Lanes;
  using Totals = OutlineSums::Totals;
  // Of outline_sums.h.
  static constexpr std::size_t kLanes = OutlineSums::kLanes;
  static constexpr std::size_t kPadded = OutlineSums::kPadded;

  // Adds a . b to each of four sums.
  TOUCHDOWN_INLINE static void AddProducts(const BlockColumn& a,
                                           const std::array<BlockColumn, 4>& b,
                                           Lanes* sums) {
    Eight s[4];
    for (std::size_t j = 0; j < 4; ++j) s[j] = EightAt(sums[j].data());
    for (std::size_t k = 0; k < kBlock; k += kLanes) {
      const Eight at = EightAt(&a[k]);
      for (std::size_t j = 0; j < 4; ++j) s[j] += at * EightAt(&b[j][k]);
    }
    for (std::size_t j = 0; j < 4; ++j) EightAt(sums[j].data()) = s[j];
  }

  // Adds a . b to one sum.
  TOUCHDOWN_INLINE static void AddProduct(const BlockColumn& a,
                                          const BlockColumn& b, Lanes& sum) {
    Eight s = EightAt(sum.data());
    for (std::size_t k = 0; k < kBlock; k += kLanes) {
      s += EightAt(&a[k]) * EightAt(&b[k]);
    }
    EightAt(sum.data()) = s;
  }

  // Adds all numbers of a column.
  TOUCHDOWN_INLINE static void Add(const BlockColumn& from, Lanes& sum) {
    Eight s = EightAt(sum.data());
    for (std::size_t k = 0; k < kBlock; k += kLanes) s += EightAt(&from[k]);
    EightAt(sum.data()) = s;
  }

  TOUCHDOWN_INLINE static void Multiply(const BlockColumn& a,
                                        const BlockColumn& b,
                                        BlockColumn& product) {
    for (std::size_t k = 0; k < kBlock; k += kLanes) {
      EightAt(&product[k]) = EightAt(&a[k]) * EightAt(&b[k]);
    }
  }

  // Polynomial level of each pixel: the terms 1, xi, eta, xi^2, xi eta, eta^2
  // times their coefficients.
  TOUCHDOWN_INLINE static void Levels(const CoverBlock& cover,
                                      const float* level, std::size_t count,
                                      BlockColumn& sum) {
    if (count == 1) {
      sum.fill(level[0]);
      return;
    }
    for (std::size_t k = 0; k < kBlock; k += kLanes) {
      const Eight xi = EightAt(&cover.xi[k]);
      const Eight eta = EightAt(&cover.eta[k]);
      EightAt(&sum[k]) = level[0] + xi * level[1] + eta * level[2] +
                         xi * (xi * level[3] + eta * level[4]) +
                         eta * eta * level[5];
    }
  }

  // Derivatives by the coefficients: `factor` times each term.
  TOUCHDOWN_INLINE static void Terms(const CoverBlock& cover,
                                     const BlockColumn& factor,
                                     std::size_t count, BlockColumn* rows) {
    rows[0] = factor;
    if (count == 1) return;
    for (std::size_t k = 0; k < kBlock; k += kLanes) {
      const Eight xi = EightAt(&cover.xi[k]);
      const Eight eta = EightAt(&cover.eta[k]);
      const Eight x = EightAt(&factor[k]) * xi;
      const Eight y = EightAt(&factor[k]) * eta;
      EightAt(&rows[1][k]) = x;
      EightAt(&rows[2][k]) = y;
      EightAt(&rows[3][k]) = x * xi;
      EightAt(&rows[4][k]) = x * eta;
      EightAt(&rows[5][k]) = y * eta;
    }
  }

  TOUCHDOWN_WIDEST void AccumulateBlock(const OutlineRound& round,
                                        const CoverBlock& cover,
                                        Totals& totals) const;
};

// Residual, weight and derivatives of each pixel, then normal equations,
// gradient and the sums that judge the fit.
void OutlineBlock::AccumulateBlock(const OutlineRound& round,
                                   const CoverBlock& cover,
                                   Totals& totals) const {
  struct alignas(64) Work {
    std::array<std::array<BlockColumn, 4>, kPadded / 4> rows;
    BlockColumn in, out, behind, step, inside, outside, residual, weight,
        weighted;
    BlockColumn cost, inlier, square, contrast, contrast_weight;
  };
  Work w;
  const std::size_t n = round.terms();
  const float per_cut =
      round.cut > 0.0 ? static_cast<float>(1.0 / round.cut) : 0.0F;
  std::array<float, 12> levels;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i] = static_cast<float>(round.levels[i]);
  }
  const bool known = round.outer == 0;
  Levels(cover, levels.data(), round.interior, w.in);
  if (known) {
    std::copy_n(background, kBlock, w.out.begin());
    std::copy_n(behind, kBlock, w.behind.begin());
  } else {
    Levels(cover, levels.data() + round.interior, round.outer, w.out);
    w.behind = w.out;
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    const float covered = cover.value[i];
    const float noise = per_noise[i];
    const float rise = w.in[i] - w.behind[i];
    // (measured - out - coverage (in - behind)) / noise.
    const float residual = (value[i] - w.out[i] - covered * rise) * noise;
    const float present = noise > 0.0F ? 1.0F : 0.0F;
    const float t = residual * per_cut;
    // Tukey's biweight, 0 beyond the cut; padding has weight 0.
    const float inner = 1.0F - t * t;
    const float q = inner > 0.0F ? inner : 0.0F;
    const float weight = present * q * q;
    // Coverage times (1 - coverage) picks the edge: the contrast is the mean
    // rise there.
    const float edge = present * covered * (1.0F - covered);
    const float inlier = weight > 0.5F ? 1.0F : 0.0F;
    w.residual[i] = residual;
    w.weight[i] = weight;
    w.step[i] = rise * noise;
    w.inside[i] = covered * noise;
    w.outside[i] = (1.0F - covered) * noise;
    w.cost[i] = weight * residual * residual;
    w.inlier[i] = inlier;
    w.square[i] = inlier * residual * residual;
    w.contrast[i] = edge * rise;
    w.contrast_weight[i] = edge;
  }
  std::copy(w.residual.begin(), w.residual.end(), residuals);
  Add(w.cost, totals.cost);
  Add(w.weight, totals.weights);
  Add(w.inlier, totals.inliers);
  Add(w.square, totals.square);
  Add(w.contrast, totals.contrast);
  Add(w.contrast_weight, totals.contrast_weight);

  BlockColumn* const rows = w.rows[0].data();
  for (std::size_t k = 0; k < round.shapes; ++k) {
    const BlockColumn& d = round.shape[k] == OutlineRound::kBlur ? cover.d_blur
                           : round.shape[k] == OutlineRound::kOpen
                               ? cover.d_open
                               : cover.d_shape[round.shape[k]];
    Multiply(w.step, d, rows[k]);
  }
  Terms(cover, w.inside, round.interior, rows + round.shapes);
  if (!known) {
    Terms(cover, w.outside, round.outer, rows + round.shapes + round.interior);
  }
  // Four rows are multiplied at once: the last group is filled with zeros.
  for (std::size_t k = n; k < (n + 3) / 4 * 4; ++k) rows[k].fill(0.0F);

  for (std::size_t i = 0; i < n; ++i) {
    Multiply(w.weight, rows[i], w.weighted);
    Lanes* const sums = &totals.normal[i * kPadded];
    for (std::size_t j = 0; j <= i; j += 4) {
      AddProducts(w.weighted, w.rows[j / 4], sums + j);
    }
    AddProduct(w.weighted, w.residual, totals.gradient[i]);
  }
}

void OutlineSums::Begin(std::size_t terms) {
  for (std::size_t i = 0; i < terms; ++i) {
    std::fill_n(
        totals_.normal.begin() + static_cast<std::ptrdiff_t>(i * kPadded),
        (i + 4) / 4 * 4, Lanes{});
    totals_.gradient[i] = {};
  }
  totals_.cost = totals_.weights = totals_.inliers = {};
  totals_.square = totals_.contrast = totals_.contrast_weight = {};
}

void OutlineSums::AddTotals(std::size_t terms) {
  for (std::size_t i = 0; i < terms; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      normal_[i * kPadded + j] += SumLanes(totals_.normal[i * kPadded + j]);
    }
    gradient_[i] += SumLanes(totals_.gradient[i]);
  }
  cost += SumLanes(totals_.cost);
  weights += SumLanes(totals_.weights);
  inliers += SumLanes(totals_.inliers);
  square += SumLanes(totals_.square);
  contrast_ += SumLanes(totals_.contrast);
  contrast_weight_ += SumLanes(totals_.contrast_weight);
}

void OutlineSums::SumPixels(const OutlinePixels& pixels,
                            const OutlineImage& image,
                            const OutlineRound& round,
                            std::vector<double>& residuals) {
  const std::size_t n = round.terms();
  normal_.fill(0.0);
  gradient_.fill(0.0);
  cost = weights = inliers = square = contrast_ = contrast_weight_ = 0.0;
  Begin(n);
  residuals.resize(pixels.padded());
  CoverBlock cover;
  for (std::size_t begin = 0; begin < pixels.padded(); begin += kBlock) {
    image.Cover(&pixels.x[begin], &pixels.y[begin], cover);
    const OutlineBlock block = {&pixels.value[begin], &pixels.background[begin],
                                &pixels.behind[begin], &pixels.per_noise[begin],
                                &residuals[begin]};
    block.AccumulateBlock(round, cover, totals_);
    // Pixels whose products are added in single precision before they join the
    // sums in double: so many still add up to 1e-6 of their sum.
    constexpr std::size_t kFloatPixels = 16 * kBlock;
    if ((begin + kBlock) % kFloatPixels == 0 ||
        begin + kBlock >= pixels.padded()) {
      AddTotals(n);
      Begin(n);
    }
  }
  residuals.resize(pixels.size);
  contrast_dn = contrast_weight_ > 0.0 ? contrast_ / contrast_weight_ : 0.0;
}

double OutlineSums::normal(std::size_t i, std::size_t j) const {
  return normal_[i * kPadded + j];
}

double OutlineSums::gradient(std::size_t i) const { return gradient_[i]; }

// Scaled median of |residual|, at least 1. Most residuals are below the one
// that makes the median 1: only those above it are sorted.
double RobustScale(const std::vector<double>& residuals) {
  const double one = 1.0 / kSigmaPerMedian;
  const auto larger = static_cast<std::size_t>(
      std::count_if(residuals.begin(), residuals.end(),
                    [&](double r) { return std::abs(r) > one; }));
  const std::size_t others = residuals.size() - larger;
  const std::size_t middle = residuals.size() / 2;
  if (middle < others) return 1.0;
  // Mostly the median is not far beyond 1, and few residuals lie so near to it:
  // a narrow bracket is tried first.
  std::vector<double> sizes(residuals.size());
  std::size_t count = 0;
  for (const double most :
       {1.1, 1.5, std::numeric_limits<double>::infinity()}) {
    count = 0;
    for (const double r : residuals) {
      const double size = std::abs(r);
      sizes[count] = size;  // written always, kept or not: no branch
      count += static_cast<std::size_t>(size > one) &
               static_cast<std::size_t>(size <= most * one);
    }
    if (count > middle - others) break;
  }
  if (count <= middle - others) return 1.0;
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(middle - others);
  std::nth_element(sizes.begin(), at,
                   sizes.begin() + static_cast<std::ptrdiff_t>(count));
  return kSigmaPerMedian * *at;
}

}  // namespace touchdown::vision
