#include "touchdown/core/body.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "touchdown/core/require.h"

namespace touchdown::core {
namespace {

void RequireLength(const std::string& field, const Estimate& e) {
  RequirePositive(field, e.value, "m");
  RequireNotNegative(field + ".u", e.u, "m");
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

Body UnmeasuredBody(BodyKind kind, const std::string& reason) {
  Body body;
  body.kind = kind;
  if (kind == BodyKind::kSphere) {
    body.diameter_m = AbsentBecause(reason);
  } else {
    body.long_m = body.short_m = AbsentBecause(reason);
  }
  return body;
}

Measured Size(const Body& body) {
  return body.kind == BodyKind::kSphere ? body.diameter_m : body.long_m;
}

double DefaultBounceHeight(double size_m) {
  RequirePositive("size", size_m, "m");
  // The campaign's default convention: the larger of 0.5 mm and 2 % of the
  // size. Another bounce height is another definition of "bounce", hence
  // declared before the first trial.
  constexpr double kFloor_m = 0.5e-3;
  constexpr double kShareOfSize = 0.02;
  return std::fmax(kFloor_m, kShareOfSize * size_m);
}

AngleKind DefaultAngleKind(BodyKind kind) {
  return kind == BodyKind::kSphere ? AngleKind::kApproach : AngleKind::kRadius;
}

}  // namespace touchdown::core
