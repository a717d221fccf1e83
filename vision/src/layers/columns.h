// Columns of numbers, one a sample: sums of columns and of products. Results do
// not depend on the processor (numbers/lanes.h).
#pragma once

#include <array>
#include <cstddef>

namespace touchdown::vision::layers {

// Most columns that a call takes.
inline constexpr std::size_t kMostColumns = 16;
using ColumnList = std::array<const float*, kMostColumns>;

// to_i += sum_c factor_c column_c,i over the first `count` columns.
void AddColumns(const ColumnList& columns, std::size_t count,
                const std::array<float, kMostColumns>& factors,
                std::size_t rows, float* to);

// sum_i column_c,i other_i of each of the first `count` columns.
void SumProducts(const ColumnList& columns, std::size_t count,
                 const float* other, std::size_t rows,
                 std::array<double, kMostColumns>& sums);

}  // namespace touchdown::vision::layers
