// What one Gauss-Newton step solves for, as a vector.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "layers/layer_model.h"

namespace touchdown::vision::layers {

template <class Number>
Eigen::Map<const Eigen::VectorX<Number>> AsVector(
    const std::vector<Number>& numbers) {
  return {numbers.data(), static_cast<Eigen::Index>(numbers.size())};
}
template <class Number>
Eigen::Map<Eigen::VectorX<Number>> AsVector(std::vector<Number>& numbers) {
  return {numbers.data(), static_cast<Eigen::Index>(numbers.size())};
}

// All unknowns but the still picture where no sample shows it.
struct Unknowns {
  std::vector<double> poses;  // x, y, angle of each frame
  std::array<double, kShared> shared{};
  std::vector<float> picture;  // T's coefficients; of a flat body none
  std::vector<float> still;    // of each shown pixel
  std::vector<float> change;   // of each sample: a part's own

  Unknowns(std::size_t frames, std::size_t cells, std::size_t pixels)
      : poses(kPose * frames), picture(cells), still(pixels) {}
  double Dot(const Unknowns& other) const;
  // x += factor other
  void Add(double factor, const Unknowns& other);
  // x = other + factor x
  void TurnTo(const Unknowns& other, double factor);
};

}  // namespace touchdown::vision::layers
