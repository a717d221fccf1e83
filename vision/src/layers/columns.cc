#include "layers/columns.h"

#include <cstring>

#include "numbers/lanes.h"

namespace touchdown::vision::layers {
namespace {

// Columns that share a pass over the rows: their sums do not wait for another.
constexpr std::size_t kTogether = 4;

TOUCHDOWN_INLINE void LoadEight(const float* first, Eight& eight) {
  std::memcpy(&eight, first, sizeof eight);
}

TOUCHDOWN_INLINE double AddUp(const Eight& eight) {
  double sum = 0.0;
  for (std::size_t k = 0; k < kSumPlaces; ++k) {
    sum += static_cast<double>(eight[k]);
  }
  return sum;
}

// Of kCount columns.
template <std::size_t kCount>
TOUCHDOWN_INLINE void AddSome(const float* const* columns, const float* factors,
                              std::size_t rows, float* to) {
  const std::size_t whole = rows / kSumPlaces * kSumPlaces;
  for (std::size_t i = 0; i < whole; i += kSumPlaces) {
    Eight sum;
    LoadEight(to + i, sum);
    for (std::size_t c = 0; c < kCount; ++c) {
      Eight column;
      LoadEight(columns[c] + i, column);
      sum += factors[c] * column;
    }
    std::memcpy(to + i, &sum, sizeof sum);
  }
  for (std::size_t i = whole; i < rows; ++i) {
    for (std::size_t c = 0; c < kCount; ++c)
      to[i] += factors[c] * columns[c][i];
  }
}

template <std::size_t kCount>
TOUCHDOWN_INLINE void SumSome(const float* const* columns, const float* other,
                              std::size_t rows, double* sums) {
  const std::size_t whole = rows / kSumPlaces * kSumPlaces;
  struct Places {
    Eight eight{};
  };
  std::array<Places, kCount> places;
  for (std::size_t i = 0; i < whole; i += kSumPlaces) {
    Eight by;
    LoadEight(other + i, by);
    for (std::size_t c = 0; c < kCount; ++c) {
      Eight column;
      LoadEight(columns[c] + i, column);
      places[c].eight += column * by;
    }
  }
  for (std::size_t c = 0; c < kCount; ++c) {
    sums[c] = AddUp(places[c].eight);
    for (std::size_t i = whole; i < rows; ++i) {
      sums[c] += static_cast<double>(columns[c][i] * other[i]);
    }
  }
}

}  // namespace

TOUCHDOWN_WIDEST
void AddColumns(const ColumnList& columns, std::size_t count,
                const std::array<float, kMostColumns>& factors,
                std::size_t rows, float* to) {
  std::size_t c = 0;
  for (; c + kTogether <= count; c += kTogether) {
    AddSome<kTogether>(&columns[c], &factors[c], rows, to);
  }
  for (; c < count; ++c) AddSome<1>(&columns[c], &factors[c], rows, to);
}

TOUCHDOWN_WIDEST
void SumProducts(const ColumnList& columns, std::size_t count,
                 const float* other, std::size_t rows,
                 std::array<double, kMostColumns>& sums) {
  std::size_t c = 0;
  for (; c + kTogether <= count; c += kTogether) {
    SumSome<kTogether>(&columns[c], other, rows, &sums[c]);
  }
  for (; c < count; ++c) SumSome<1>(&columns[c], other, rows, &sums[c]);
}

}  // namespace touchdown::vision::layers
