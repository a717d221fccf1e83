#include "layers/unknowns.h"

namespace touchdown::vision::layers {

double Unknowns::Dot(const Unknowns& other) const {
  double sum = AsVector(poses).dot(AsVector(other.poses));
  for (std::size_t i = 0; i < kShared; ++i) sum += shared[i] * other.shared[i];
  const auto add = [&sum](const auto& a, const auto& b) {
    sum += AsVector(a).template cast<double>().dot(
        AsVector(b).template cast<double>());
  };
  add(picture, other.picture);
  add(still, other.still);
  return sum;
}

void Unknowns::Add(double factor, const Unknowns& other) {
  const auto by = static_cast<float>(factor);
  AsVector(poses) += factor * AsVector(other.poses);
  for (std::size_t i = 0; i < kShared; ++i) {
    shared[i] += factor * other.shared[i];
  }
  AsVector(picture) += by * AsVector(other.picture);
  AsVector(still) += by * AsVector(other.still);
}

void Unknowns::TurnTo(const Unknowns& other, double factor) {
  const auto by = static_cast<float>(factor);
  AsVector(poses) = AsVector(other.poses) + factor * AsVector(poses);
  for (std::size_t i = 0; i < kShared; ++i) {
    shared[i] = other.shared[i] + factor * shared[i];
  }
  AsVector(picture) = AsVector(other.picture) + by * AsVector(picture);
  AsVector(still) = AsVector(other.still) + by * AsVector(still);
}

}  // namespace touchdown::vision::layers
