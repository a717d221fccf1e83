#include "app/measure/lens_uncertainty.h"

#include <cmath>
#include <vector>

#include "app/measure/shared_uncertainty.h"
#include "touchdown/calib/lens_directions.h"

namespace touchdown::pipeline {
namespace {

// Columns whose outer products add up to the covariance.
std::vector<calib::LensVector> Directions(const calib::LensCovariance& c) {
  // In units of the parameters' own standard deviations: they are px and pure
  // numbers.
  const calib::LensVector deviation = c.diagonal().cwiseSqrt();
  const calib::LensVector unit =
      deviation.unaryExpr([](double v) { return v > 0.0 ? 1.0 / v : 0.0; });
  const calib::LensDirections own =
      calib::DecomposeLensCovariance(unit.asDiagonal() * c * unit.asDiagonal());
  std::vector<calib::LensVector> directions;
  for (int k = 0; k < calib::kLensParameters; ++k) {
    // A direction in which the pictures fix the lens to rounding moves nothing.
    const double variance = own.variances[k];
    constexpr double kRounding = 1e-9;
    if (!(variance > kRounding)) continue;
    directions.emplace_back(
        deviation.cwiseProduct(std::sqrt(variance) * own.directions.col(k)));
  }
  return directions;
}

}  // namespace

void AddLensUncertainty(vision::ContactResult& contacts,
                        const calib::Lens& lens,
                        const calib::LensCovariance& covariance,
                        const ContactsThrough& again) {
  std::vector<MovedContacts> moved;
  for (const calib::LensVector& direction : Directions(covariance)) {
    // One side is enough: over one standard deviation of a calibrated lens the
    // contacts move linearly.
    moved.push_back({again(calib::ToLens(calib::ToVector(lens) + direction))});
  }
  AddShared(contacts, "lens", moved);
}

}  // namespace touchdown::pipeline
