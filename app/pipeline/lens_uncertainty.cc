#include "app/pipeline/lens_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <vector>

namespace touchdown::pipeline {
namespace {

constexpr std::size_t kQuantities = 18;

// Every number of a contact that the lens can move.
std::array<core::Measured*, kQuantities> QuantitiesOf(
    core::ContactRecord& record) {
  core::Contact& c = record.contact;
  core::Motion& m = record.motion;
  return {&c.approach_angle_rad,
          &c.radius_angle_rad,
          &c.face_angle_rad,
          &c.time_s,
          &c.frame,
          &c.duration_s,
          &record.state.max_gap_m,
          &m.before_speed_mps,
          &m.before_normal_mps,
          &m.before_tangential_mps,
          &m.before_omega_rad_per_s,
          &m.after_normal_mps,
          &m.after_tangential_mps,
          &m.after_omega_rad_per_s,
          &m.restitution,
          &m.centre_rebound_ratio,
          &m.impulse_ratio,
          &m.gravity_check_mps2};
}

// Columns whose outer products add up to the covariance.
std::vector<calib::LensVector> Directions(const calib::LensCovariance& c) {
  // In units of the parameters' own standard deviations: they are px and pure
  // numbers.
  const calib::LensVector deviation = c.diagonal().cwiseSqrt();
  const calib::LensVector unit =
      deviation.unaryExpr([](double v) { return v > 0.0 ? 1.0 / v : 0.0; });
  const Eigen::SelfAdjointEigenSolver<calib::LensCovariance> solver(
      unit.asDiagonal() * c * unit.asDiagonal());
  std::vector<calib::LensVector> directions;
  for (int k = 0; k < calib::kLensParameters; ++k) {
    const double variance = solver.eigenvalues()[k];
    constexpr double kRounding = 1e-9;
    if (!(variance > kRounding)) continue;
    directions.emplace_back(deviation.cwiseProduct(
        std::sqrt(variance) * solver.eigenvectors().col(k)));
  }
  return directions;
}

void Widen(core::Estimate& e, double u_lens) {
  const double before = e.u;
  e.u = std::hypot(e.u, u_lens);
  if (e.interval95 && before > 0.0) {
    const double factor = e.u / before;
    e.interval95->low = e.value - factor * (e.value - e.interval95->low);
    e.interval95->high = e.value + factor * (e.interval95->high - e.value);
  }
}

}  // namespace

void AddLensUncertainty(vision::ContactResult& contacts,
                        const calib::Lens& lens,
                        const calib::LensCovariance& covariance,
                        const ContactsThrough& again) {
  std::vector<core::ContactRecord*> records = {&contacts.first};
  for (core::ContactRecord& later : contacts.later) records.push_back(&later);
  std::vector<std::array<double, kQuantities>> variances(records.size());
  for (auto& of_record : variances) of_record.fill(0.0);
  for (const calib::LensVector& direction : Directions(covariance)) {
    vision::ContactResult moved =
        again(calib::LensOf(calib::VectorOf(lens) + direction));
    std::vector<core::ContactRecord*> others = {&moved.first};
    for (core::ContactRecord& later : moved.later) others.push_back(&later);
    for (std::size_t i = 0; i < records.size() && i < others.size(); ++i) {
      const auto ours = QuantitiesOf(*records[i]);
      const auto theirs = QuantitiesOf(*others[i]);
      for (std::size_t q = 0; q < kQuantities; ++q) {
        if (!*ours[q] || !*theirs[q]) continue;
        const double change = (*theirs[q])->value - (*ours[q])->value;
        variances[i][q] += change * change;
      }
    }
  }
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto ours = QuantitiesOf(*records[i]);
    for (std::size_t q = 0; q < kQuantities; ++q) {
      if (*ours[q]) Widen(**ours[q], std::sqrt(variances[i][q]));
    }
    core::Contact& contact = records[i]->contact;
    if (!contact.approach_budget.empty()) {
      contact.approach_budget.push_back({"lens", std::sqrt(variances[i][0])});
    }
    if (!contact.attitude_budget.empty()) {
      contact.attitude_budget.push_back(
          {"lens", std::sqrt(variances[i][contact.radius_angle_rad ? 1 : 2])});
    }
  }
}

}  // namespace touchdown::pipeline
