#include "touchdown/rig/uncertainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "touchdown/core/require.h"
#include "touchdown/rig/launch.h"

namespace touchdown::rig {
namespace {

void ValidateInputs(std::span<const UncertainInput> inputs) {
  for (const UncertainInput& input : inputs) {
    core::RequireFinite(input.name.c_str(), input.estimate.value);
    core::RequireNotNegative((input.name + ".u").c_str(), input.estimate.u);
  }
}

std::vector<double> Values(std::span<const UncertainInput> inputs) {
  std::vector<double> values;
  values.reserve(inputs.size());
  for (const UncertainInput& in : inputs) values.push_back(in.estimate.value);
  return values;
}

// dy/dx * u(x) for every output, x being input `index`.
core::Expected<std::vector<double>> Contribution(
    const UncertainInput& input, std::size_t index, std::vector<double> at,
    const std::vector<double>& centre, const Model& model) {
  constexpr double kStep =
      1e-3;  // of u(x): error about kStep^2, rounding 1e-11
  const double x = at[index];
  const double step = kStep * input.estimate.u;
  // The step that is really made is a difference of doubles.
  const double above = x + step;
  const double below = x - step;
  const auto evaluate = [&](double value) {
    at[index] = value;
    if (!(value > input.low && value < input.high)) {
      return core::Expected<std::vector<double>>(
          core::AbsentBecause(input.name + " is at its limit"));
    }
    return model(at);
  };
  auto high = evaluate(above);
  const auto low = evaluate(below);
  if (!high && !low) return high;
  const std::vector<double>& y1 = high ? *high : centre;
  const std::vector<double>& y0 = low ? *low : centre;
  const double width = (high ? above : x) - (low ? below : x);
  std::vector<double> out(centre.size(), 0.0);
  if (!(width > 0.0)) return out;  // u is below the resolution of x
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = (y1[i] - y0[i]) / width * input.estimate.u;
  }
  return out;
}

double Quantile(std::vector<double>& values, double p) {
  // JCGM 101, 7.7: the value of rank p M + 1/2.
  const auto size = static_cast<double>(values.size());
  const auto rank = static_cast<std::ptrdiff_t>(
      std::clamp(std::floor(p * size + 0.5) - 1.0, 0.0, size - 1.0));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

MonteCarlo Summary(std::vector<double>& values) {
  // Relative to the first value, so that the sum of squares does not cancel.
  const double origin = values.front();
  const auto size = static_cast<double>(values.size());
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : values) {
    sum += value - origin;
    squares += (value - origin) * (value - origin);
  }
  MonteCarlo out;
  out.mean = origin + sum / size;
  out.u = std::sqrt(std::fmax(0.0, squares - sum * sum / size) / (size - 1.0));
  out.u_of_u = out.u / std::sqrt(2.0 * size);
  out.interval95.low = Quantile(values, 0.025);
  out.interval95.high = Quantile(values, 0.975);
  return out;
}

// Relative mean and variance of a product of powers of independent inputs.
IdealSpeedU PowerLaw(const IdealRelativeU& u, double wire_first,
                     double wire_second, double coil_first,
                     double coil_second) {
  core::RequireNotNegative("shear_modulus u", u.shear_modulus);
  core::RequireNotNegative("wire_diameter u", u.wire_diameter);
  core::RequireNotNegative("active_coils u", u.active_coils);
  core::RequireNotNegative("coil_diameter u", u.coil_diameter);
  core::RequireNotNegative("compression u", u.compression);
  core::RequireNotNegative("mass u", u.mass);
  const auto square = [](double v) { return v * v; };
  IdealSpeedU out;
  out.u_rel = std::sqrt(
      square(0.5 * u.shear_modulus) + square(wire_first * u.wire_diameter) +
      square(0.5 * u.active_coils) + square(coil_first * u.coil_diameter) +
      square(u.compression) + square(0.5 * u.mass));
  // Half the second derivative, x^2 v''/(2 v): p (p-1)/2 of a power p.
  out.bias_rel = -0.125 * square(u.shear_modulus) +
                 0.5 * wire_second * square(u.wire_diameter) +
                 0.375 * square(u.active_coils) +
                 0.5 * coil_second * square(u.coil_diameter) +
                 0.375 * square(u.mass);
  return out;
}

}  // namespace

core::Expected<std::vector<FirstOrder>> PropagateFirstOrder(
    std::span<const UncertainInput> inputs, const Model& model) {
  ValidateInputs(inputs);
  const std::vector<double> at = Values(inputs);
  const auto centre = model(at);
  if (!centre) return core::AbsentBecause(centre.error().reason);
  std::vector<FirstOrder> outputs(centre->size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    outputs[i].estimate.value = (*centre)[i];
  }
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    if (inputs[k].estimate.u == 0.0) continue;
    const auto shares = Contribution(inputs[k], k, at, *centre, model);
    if (!shares) return core::AbsentBecause(shares.error().reason);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const double share = std::abs((*shares)[i]);
      outputs[i].budget.push_back({inputs[k].name, share});
      outputs[i].estimate.u = std::hypot(outputs[i].estimate.u, share);
    }
  }
  return outputs;
}

MonteCarloRun PropagateMonteCarlo(std::span<const UncertainInput> inputs,
                                  const Model& model, std::size_t draws,
                                  std::mt19937_64& engine) {
  ValidateInputs(inputs);
  if (draws < 2) {
    core::Refuse("draws", static_cast<double>(draws), "at least 2");
  }
  std::normal_distribution<double> normal;
  std::vector<double> at = Values(inputs);
  std::vector<std::vector<double>> columns;
  MonteCarloRun run;
  run.draws = draws;
  for (std::size_t i = 0; i < draws; ++i) {
    bool possible = true;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      const UncertainInput& in = inputs[k];
      if (in.estimate.u == 0.0) continue;
      at[k] = in.estimate.value + in.estimate.u * normal(engine);
      possible = possible && at[k] > in.low && at[k] < in.high;
    }
    if (possible) {
      if (const auto answer = model(at)) {
        columns.resize(answer->size());
        for (std::size_t j = 0; j < columns.size(); ++j) {
          columns[j].push_back((*answer)[j]);
        }
        continue;
      }
    }
    ++run.impossible;
  }
  if (run.draws - run.impossible >= 2) {
    for (std::vector<double>& column : columns) {
      run.outputs.push_back(Summary(column));
    }
  }
  return run;
}

bool FirstOrderIsValid(const core::Estimate& first_order,
                       const MonteCarlo& monte_carlo, int digits) {
  if (digits < 1) core::Refuse("digits", digits, "at least 1");
  const double u = monte_carlo.u;
  if (u == 0.0) return first_order.u == 0.0;
  // u rounded to `digits` digits is c 10^l with c a whole number; 9.6 rounds to
  // 10, one decade up.
  double l = std::floor(std::log10(u)) - digits + 1;
  const double c = std::round(u / std::pow(10.0, l));
  if (c >= std::pow(10.0, digits)) l += 1.0;
  const double unit = std::pow(10.0, l);
  const core::Interval interval = core::Interval95(first_order);
  return std::abs(interval.low - monte_carlo.interval95.low) <= 0.5 * unit &&
         std::abs(interval.high - monte_carlo.interval95.high) <= 0.5 * unit;
}

IdealSpeedU IdealSpeedUncertainty(const Spring& spring,
                                  const IdealRelativeU& u) {
  const double mean = MeanDiameter(spring);
  // d D_m / d d: the mean diameter shrinks as the wire of a measured outer
  // diameter grows.
  const double slope = spring.coil_diameter == CoilDiameter::kOuter   ? -1.0
                       : spring.coil_diameter == CoilDiameter::kInner ? 1.0
                                                                      : 0.0;
  const double wire = slope * spring.wire_diameter_m / mean;
  const double coil = spring.coil_diameter_m / mean;
  // v ~ d^2 D_m^(-3/2).
  return PowerLaw(u, 2.0 - 1.5 * wire, 2.0 - 6.0 * wire + 3.75 * wire * wire,
                  -1.5 * coil, 3.75 * coil * coil);
}

IdealSpeedU PrintedSpeedUncertainty(const IdealRelativeU& u) {
  return PowerLaw(u, 2.0, 2.0, -1.5, 3.75);
}

MonteCarloRun IdealSpeedMonteCarlo(const Spring& spring,
                                   const IdealRelativeU& u, std::size_t draws,
                                   std::mt19937_64& engine) {
  // Eq. (10) scales with X and m^-1/2, so that both may be 1.
  const double nominal = IdealLaunchSpeed(1.0, Stiffness(spring), 1.0);
  const auto input = [](const char* name, double value, double u_rel) {
    return UncertainInput{name, {value, value * u_rel, std::nullopt}, 0.0};
  };
  const std::array<UncertainInput, 6> inputs{
      input("shear modulus", spring.shear_modulus_pa, u.shear_modulus),
      input("wire diameter", spring.wire_diameter_m, u.wire_diameter),
      input("active coils", spring.active_coils, u.active_coils),
      input("coil diameter", spring.coil_diameter_m, u.coil_diameter),
      input("compression", 1.0, u.compression),
      input("mass", 1.0, u.mass)};
  const Model model =
      [&](std::span<const double> x) -> core::Expected<std::vector<double>> {
    Spring drawn = spring;
    drawn.shear_modulus_pa = x[0];
    drawn.wire_diameter_m = x[1];
    drawn.active_coils = x[2];
    drawn.total_coils = x[2];
    drawn.coil_diameter_m = x[3];
    try {
      return std::vector<double>{
          IdealLaunchSpeed(x[4], Stiffness(drawn), x[5]) / nominal};
    } catch (const std::invalid_argument& error) {
      return core::AbsentBecause(error.what());  // a coil without a hole
    }
  };
  return PropagateMonteCarlo(inputs, model, draws, engine);
}

}  // namespace touchdown::rig
