#include "touchdown/core/body.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace touchdown::core {
namespace {

void RequireLength(const char* field, const Estimate& e) {
  if (!(e.value > 0.0) || !std::isfinite(e.value)) {
    throw std::invalid_argument(std::string(field) + " is " +
                                std::to_string(e.value) +
                                " m, must be positive and finite");
  }
  if (!(e.u >= 0.0) || !std::isfinite(e.u)) {
    throw std::invalid_argument(std::string(field) + ".u is " +
                                std::to_string(e.u) +
                                " m, must be at least 0 and finite");
  }
}

}  // namespace

Body Sphere(Estimate diameter_m) {
  RequireLength("diameter", diameter_m);
  Body body;
  body.kind = BodyKind::kSphere;
  body.diameter_m = diameter_m;
  return body;
}

Body Rectangle(Estimate side_a_m, Estimate side_b_m) {
  RequireLength("side a", side_a_m);
  RequireLength("side b", side_b_m);
  if (side_a_m.value < side_b_m.value) std::swap(side_a_m, side_b_m);
  Body body;
  body.kind = BodyKind::kRectangle;
  body.long_m = side_a_m;
  body.short_m = side_b_m;
  return body;
}

Measured Size(const Body& body) {
  return body.kind == BodyKind::kSphere ? body.diameter_m : body.long_m;
}

double DefaultBounceHeight(double size_m) {
  if (!(size_m > 0.0) || !std::isfinite(size_m)) {
    throw std::invalid_argument("size is " + std::to_string(size_m) +
                                " m, must be positive and finite");
  }
  constexpr double kFloor_m = 0.5e-3;
  constexpr double kShareOfSize = 0.02;
  return std::fmax(kFloor_m, kShareOfSize * size_m);
}

AngleKind DefaultAngleKind(BodyKind kind) {
  return kind == BodyKind::kSphere ? AngleKind::kApproach : AngleKind::kRadius;
}

}  // namespace touchdown::core
