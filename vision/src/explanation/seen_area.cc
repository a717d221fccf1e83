#include "explanation/seen_area.h"

#include <cstddef>

namespace touchdown::vision {
namespace {

// Samples of a cell: with fewer its picture is the sample itself.
constexpr int kLeastSamples = 3;

struct Cell {
  double from_still = 0.0;  // sums of squares, DN^2
  double from_body = 0.0;
  int samples = 0;

  bool is_told() const { return samples >= kLeastSamples; }
  bool is_seen() const {
    // r of seen_area.h: between a contrast as large as the noise and none at
    // all. Larger takes background for body; smaller loses faint bodies. Of 141
    // clips of right bodies 136 are seen whole.
    constexpr double kMostLeft = 0.75;
    return from_body < kMostLeft * from_still;
  }
};

std::vector<Cell> FillCells(const std::vector<CoveredPoints>& covered,
                            const TwoLayers& layers,
                            const LatticeLevels& levels) {
  std::vector<Cell> cells(layers.cells());
  for (std::size_t k = 0; k < covered.size(); ++k) {
    const float* level = levels.of(k);
    for (std::size_t i = 0; i < covered[k].point.size(); ++i) {
      const auto p = static_cast<std::size_t>(covered[k].point[i]);
      const float m = covered[k].cover[i];
      if (m < kWhollyCovered || !layers.is_known(p)) continue;
      const double from_still = level[p] - layers.still(p);
      const double from_body =
          from_still + m * (layers.still(p) - layers.picture(covered[k], i));
      Cell& cell = cells[static_cast<std::size_t>(covered[k].cell[i])];
      cell.from_still += from_still * from_still;
      cell.from_body += from_body * from_body;
      ++cell.samples;
    }
  }
  return cells;
}

// The cells that are reached from the grid's corner, which is outside the body,
// through the sides of cells that are no body.
std::vector<bool> ReachFromOutside(const std::vector<Cell>& cells,
                                   std::size_t columns) {
  std::vector<bool> is_reached(cells.size(), false);
  std::vector<std::size_t> front = {0};
  is_reached[0] = true;
  const auto reach = [&](std::size_t c) {
    const Cell& cell = cells[c];
    const bool is_outside = cell.samples == 0;
    const bool is_empty = cell.is_told() && !cell.is_seen();
    if (is_reached[c] || !(is_outside || is_empty)) return;
    is_reached[c] = true;
    front.push_back(c);
  };
  while (!front.empty()) {
    const std::size_t c = front.back();
    front.pop_back();
    if (c % columns > 0) reach(c - 1);
    if (c % columns + 1 < columns) reach(c + 1);
    if (c >= columns) reach(c - columns);
    if (c + columns < cells.size()) reach(c + columns);
  }
  return is_reached;
}

}  // namespace

std::optional<double> MeasureSeenArea(const std::vector<CoveredPoints>& covered,
                                      const TwoLayers& layers,
                                      const LatticeLevels& levels) {
  const std::vector<Cell> cells = FillCells(covered, layers, levels);
  const std::vector<bool> is_reached =
      ReachFromOutside(cells, layers.columns());
  int told = 0;
  int seen = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!cells[c].is_told()) continue;
    ++told;
    seen += !is_reached[c];
  }
  // Cells: fewer are no area. Not studied.
  constexpr int kLeastCells = 20;
  if (told < kLeastCells) return std::nullopt;
  return static_cast<double>(seen) / told;
}

}  // namespace touchdown::vision
