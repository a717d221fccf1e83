// Standard normal numbers, fast: a camera frame needs 256 000 of them.
#pragma once

#include <cstdint>
#include <random>

namespace touchdown::vision {

// The ziggurat method with 256 layers (G. Marsaglia and W. W. Tsang, J. Stat.
// Softw. 5(8), 2000; layer and position from separate bits of one draw, as J.
// A. Doornik, "An improved ziggurat method", 2005, asks for). The same on every
// platform, unlike std::normal_distribution. Cheap to make: its table is shared
// and constant.
class GaussianSource {
 public:
  GaussianSource();

  float operator()(std::mt19937_64& engine) const {
    const std::uint64_t bits = engine();
    const auto layer = static_cast<unsigned>(bits & 0xffu);
    // 53 bits to [-1, 1).
    const double u =
        static_cast<double>(static_cast<std::int64_t>(bits) >> 11) * 0x1p-52;
    const double x = u * table_->x[layer];
    if ((x < 0.0 ? -x : x) < table_->x[layer + 1]) {
      return static_cast<float>(x);
    }
    return Slow(engine, layer, x);
  }

  struct Table {
    double x[257];
    double density[257];
  };

 private:
  float Slow(std::mt19937_64& engine, unsigned layer, double x) const;

  const Table* table_;
};

}  // namespace touchdown::vision
