#include "synthetic/gaussian.h"

#include <cmath>

namespace touchdown::vision {
namespace {

// Right end of the lowest layer's rectangle, and the area of each layer, for
// 256 layers of exp(-x^2 / 2) (Marsaglia and Tsang, J. Stat. Softw. 5 (8),
// 2000, section 2).
constexpr double kTail = 3.6541528853610088;
constexpr double kArea = 0.00492867323399;

double Density(double x) { return std::exp(-0.5 * x * x); }

// Right ends of all layers, from the base upward: each has the same area.
GaussianSource::Table MakeTable() {
  GaussianSource::Table table{};
  table.x[0] = kArea / Density(kTail);  // the base layer, with its tail
  table.x[1] = kTail;
  for (int i = 2; i < 256; ++i) {
    table.x[i] = std::sqrt(
        -2.0 * std::log(kArea / table.x[i - 1] + Density(table.x[i - 1])));
  }
  table.x[256] = 0.0;
  for (int i = 0; i <= 256; ++i) table.density[i] = Density(table.x[i]);
  return table;
}

// In (0, 1].
double Uniform(std::mt19937_64& engine) {
  return static_cast<double>((engine() >> 11) + 1) * 0x1p-53;
}

}  // namespace

GaussianSource::GaussianSource() {
  static const Table table = MakeTable();
  table_ = &table;
}

// The one draw in a hundred that the fast test does not accept: from the tail,
// or from the wedge between rectangle and curve.
float GaussianSource::Slow(std::mt19937_64& engine, unsigned layer,
                           double x) const {
  if (layer == 0) {
    for (;;) {  // the tail beyond kTail
      // Marsaglia's tail: exponential draws, accepted under the curve.
      const double a = -std::log(Uniform(engine)) / kTail;
      const double b = -std::log(Uniform(engine));
      if (2.0 * b > a * a) {
        return static_cast<float>(x < 0.0 ? -(kTail + a) : kTail + a);
      }
    }
  }
  const double low = table_->density[layer];
  const double high = table_->density[layer + 1];
  if (low + Uniform(engine) * (high - low) < Density(x)) {
    return static_cast<float>(x);
  }
  return (*this)(engine);
}

}  // namespace touchdown::vision
