// Each number appears in the unit that its key or heading names: `per_si` is
// how many of that unit make one SI unit.
#include "app/cli/rig/rig_print.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

constexpr double kPerDegree = 1.0 / core::kDegree;  // deg in a rad
constexpr double kPerMm = 1e3;
constexpr double kPerMpa = 1e-6;
constexpr double kPerGram = 1e3;

// Puts one prediction under `name`: first order with u and budget, Monte Carlo
// where it was run. An absent one is null, and its reason goes into `absent`.
void PutPredicted(Json& to, Json& absent, const char* name,
                  const rig::Predicted& value, double per_si) {
  if (!value.first_order) {
    to[name] = nullptr;
    absent[name] = value.first_order.error().reason;
    return;
  }
  Json out = EstimateJson(*value.first_order, per_si);
  if (value.monte_carlo) {
    const rig::MonteCarlo& mc = *value.monte_carlo;
    out["monte_carlo"] = {
        {"mean", mc.mean * per_si},
        {"u", mc.u * per_si},
        {"interval95",
         {mc.interval95.low * per_si, mc.interval95.high * per_si}}};
    out["first_order_valid"] = value.first_order_valid;
  } else {
    out["monte_carlo"] = nullptr;
    // The draws may be absent where the first order is not.
    absent[std::string(name) + ".monte_carlo"] =
        value.monte_carlo.error().reason;
  }
  out["budget"] = Json::array();
  for (const core::BudgetLine& line : value.budget) {
    out["budget"].push_back({{"source", line.source}, {"u", line.u * per_si}});
  }
  to[name] = std::move(out);
}

// Returns a number in the unit of its key, or null where there is none.
Json OrNull(const std::optional<double>& value, double per_si) {
  return value ? Json(*value * per_si) : Json(nullptr);
}

}  // namespace

Json FindingsJson(const std::vector<rig::Finding>& findings) {
  Json out = Json::array();
  for (const rig::Finding& f : findings) {
    out.push_back(
        (f.severity == rig::Severity::kRefusal ? "refused: " : "warning: ") +
        f.what);
  }
  return out;
}

Json SpringJson(const rig::SpringReport& r) {
  return {{"stiffness_of_one_n_per_m", r.stiffness_of_one_n_per_m},
          {"stiffness_eq11_n_per_m", r.stiffness_n_per_m},
          {"stiffness_as_printed_n_per_m", r.stiffness_as_printed_n_per_m},
          {"mean_diameter_mm", r.mean_diameter_m * kPerMm},
          {"spring_index", r.index},
          {"wahl_factor", r.wahl_factor},
          {"force_of_one_n", r.force_of_one_n},
          {"max_shear_mpa", r.max_shear_pa * kPerMpa},
          {"uncorrected_shear_mpa", r.uncorrected_shear_pa * kPerMpa},
          {"solid_length_mm", r.solid_length_m * kPerMm},
          {"clearance_mm", OrNull(r.clearance_m, kPerMm)},
          {"clearance_share", OrNull(r.clearance_share, 1.0)},
          {"slenderness", OrNull(r.slenderness, 1.0)},
          {"mass_g", r.mass_kg * kPerGram},
          {"surge_hz", r.surge_hz}};
}

Json PredictionJson(const rig::ContactPrediction& c) {
  Json out;
  Json absent = Json::object();
  PutPredicted(out, absent, "stiffness_n_per_m", c.stiffness_n_per_m, 1.0);
  PutPredicted(out, absent, "launch_speed_mps", c.launch_speed_mps, 1.0);
  PutPredicted(out, absent, "impact_speed_mps", c.impact_speed_mps, 1.0);
  PutPredicted(out, absent, "approach_angle_deg", c.approach_angle_rad,
               kPerDegree);
  PutPredicted(out, absent, "radius_angle_deg", c.radius_angle_rad, kPerDegree);
  PutPredicted(out, absent, "face_angle_deg", c.face_angle_rad, kPerDegree);
  PutPredicted(out, absent, "flight_time_s", c.flight_time_s, 1.0);
  PutPredicted(out, absent, "range_mm", c.range_m, kPerMm);
  out["corner"] =
      c.corner ? Json(std::string(core::Name(*c.corner))) : Json(nullptr);
  // Without an attitude there is no corner; with one, none is first where the
  // contact point lies straight below the centre.
  if (!c.corner) {
    absent["corner"] = c.face_angle_rad.first_order
                           ? "a corner straight below the centre"
                           : c.face_angle_rad.first_order.error().reason;
  }
  out["p_no_contact"] = c.p_no_contact;
  out["draws"] = c.draws;
  out["warnings"] = FindingsJson(c.findings);
  out["absent"] = absent;
  return out;
}

std::string Rounded(const core::Estimate& e) {
  if (!(e.u > 0.0)) return fmt::format("{:.6g}", e.value);
  // This is the decimal place of the first digit of u: -2 for 0.03.
  const int place = static_cast<int>(std::floor(std::log10(e.u)));
  const int decimals = std::max(0, 1 - place);
  // A double has no more to show: both numbers then have their own digits.
  if (decimals > 12) return fmt::format("{:.12g} +- {:.2g}", e.value, e.u);
  return fmt::format("{:.{}f} +- {:.{}f}", e.value, decimals, e.u, decimals);
}

std::string ValueLine(std::string_view name, const core::Estimate& value,
                      double per_si, std::string_view unit) {
  std::string out = fmt::format("  {:<22}{} {}", name,
                                Rounded(core::Scaled(value, per_si)), unit);
  if (value.interval95) {
    const core::Interval i = *core::Scaled(value, per_si).interval95;
    out += fmt::format("   95 %: {:.5g} .. {:.5g}", i.low, i.high);
  }
  return out + '\n';
}

std::string ValueLine(std::string_view name, const rig::Predicted& value,
                      double per_si, std::string_view unit) {
  if (!value.first_order) {
    return fmt::format("  {:<22}absent: {}\n", name,
                       value.first_order.error().reason);
  }
  std::string out =
      fmt::format("  {:<22}{:<22}", name,
                  Rounded(core::Scaled(*value.first_order, per_si)) + " " +
                      std::string(unit));
  // Without uncertain inputs every draw is the same: nothing to add.
  if (value.monte_carlo && value.monte_carlo->u > 0.0) {
    const rig::MonteCarlo& mc = *value.monte_carlo;
    out +=
        fmt::format("  Monte Carlo {}, 95 %: {:.5g} .. {:.5g}{}",
                    Rounded({mc.mean * per_si, mc.u * per_si, {}}),
                    mc.interval95.low * per_si, mc.interval95.high * per_si,
                    value.first_order_valid ? "" : "  (not normal: use this)");
  }
  // A number without a unit would leave a blank at the line's end.
  while (out.back() == ' ') out.pop_back();
  return out + '\n';
}

std::string ValueLine(std::string_view name, double value,
                      std::string_view unit) {
  std::string out = fmt::format("  {:<22}{:.6g} {}", name, value, unit);
  while (out.back() == ' ') out.pop_back();
  return out + '\n';
}

std::string FindingsText(const std::vector<rig::Finding>& findings) {
  std::string out;
  for (const rig::Finding& f : findings) {
    out += fmt::format(
        "  {} {}\n",
        f.severity == rig::Severity::kRefusal ? "REFUSED:" : "warning:",
        f.what);
  }
  return out;
}

// Returns the lines below the stiffness; what needs a free length is left out
// where none was given.
std::string SpringText(const rig::SpringReport& r) {
  std::string out;
  out += ValueLine("of one spring", r.stiffness_of_one_n_per_m, "N/m");
  out += ValueLine("as the paper prints", r.stiffness_as_printed_n_per_m,
                   "N/m (outer diameter in the place of the mean)");
  out += ValueLine("mean coil diameter", r.mean_diameter_m * kPerMm, "mm");
  out += ValueLine("spring index", r.index, "");
  out += ValueLine("Wahl factor", r.wahl_factor, "");
  out += ValueLine("force of one spring", r.force_of_one_n, "N");
  out += ValueLine("greatest shear stress", r.max_shear_pa * kPerMpa, "MPa");
  out += ValueLine("solid length", r.solid_length_m * kPerMm, "mm");
  if (r.clearance_m) {
    out += ValueLine("clearance", *r.clearance_m * kPerMm, "mm");
  }
  out += ValueLine("mass of the springs", r.mass_kg * kPerGram, "g");
  out += ValueLine("surge frequency", r.surge_hz, "Hz");
  return out;
}

std::string PredictionText(const rig::ContactPrediction& c, bool with_flight) {
  std::string out;
  out += ValueLine("stiffness", c.stiffness_n_per_m, 1.0, "N/m");
  out += ValueLine("launch speed", c.launch_speed_mps, 1.0, "m/s");
  if (!with_flight) return out;
  out += ValueLine("impact speed", c.impact_speed_mps, 1.0, "m/s");
  out += ValueLine("approach angle", c.approach_angle_rad, kPerDegree, "deg");
  // Only a rectangle has these two.
  if (c.face_angle_rad.first_order) {
    out += ValueLine("radius angle", c.radius_angle_rad, kPerDegree, "deg");
    out += ValueLine("face angle", c.face_angle_rad, kPerDegree, "deg");
  }
  out += ValueLine("flight time", c.flight_time_s, 1e3, "ms");
  out += ValueLine("range", c.range_m, kPerMm, "mm");
  if (c.corner) {
    out += fmt::format("  {:<22}{}\n", "first to touch",
                       *c.corner == core::Corner::kFlush
                           ? "flush"
                           : std::string(core::Name(*c.corner)) + " corner");
  }
  return out;
}

}  // namespace touchdown::cli
