// touchdown theory boundary gives the boundary angle by each model of
// analysis/theory/boundary_models.h, side by side. A model that lacks one of
// its inputs is listed with what it needs; named alone by --model, it is an
// error of the user.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/case_file.h"
#include "app/cli/theory/theory_cases.h"
#include "app/cli/theory/theory_options.h"
#include "app/text/json.h"
#include "touchdown/analysis/theory/boundary_models.h"

namespace touchdown::cli {
namespace {

using analysis::BoundaryAnswer;
using analysis::BoundaryInputs;
using analysis::BoundaryModel;
using core::kDegree;
using report::Json;

// The paper calls its hoop a sphere, so for boundaries `hoop` means its sphere:
// the angle that varies is the approach angle.
bool CountsAsSphere(const CornerFlags& f) {
  return IsSphere(f) || f.body == "hoop";
}

// Returns the flags that the model cannot do without and that were not given.
std::vector<std::string> Missing(BoundaryModel model, const TheoryFlags& flags,
                                 bool sphere) {
  std::vector<std::string> out;
  const auto need = [&](bool given, const char* flag) {
    if (!given) out.emplace_back(flag);
  };
  const CornerFlags& f = flags.corner;
  const TheoryBoundaryFlags& b = flags.boundary;
  // Without spin the radius has no influence on the models that take it for the
  // spin alone.
  const bool spins = f.omega_rad_per_s.value_or(0.0) != 0.0;
  switch (model) {
    case BoundaryModel::kPublished:
    case BoundaryModel::kPaperReplication:
      break;
    case BoundaryModel::kPrintedEquations:
      need(!spins || f.radius_m.has_value(), "--radius-m");
      break;
    case BoundaryModel::kCorrectedLcp:
      if (sphere) break;
      need(!f.corner.empty(), "--corner");
      // Friction matters where the corner leads: there it may turn the sign of
      // A_hat (Painleve's wedge).
      need(f.corner != "leading" || f.mu.has_value(), "--mu");
      need(!spins || f.radius_m.has_value(), "--radius-m");
      break;
    case BoundaryModel::kDetectableBounce:
      need(b.restitution.has_value(), "--restitution");
      need(b.speed_mps.has_value(), "--speed-mps");
      need(b.bounce_height_m.has_value(), "--bounce-height-m");
      if (sphere) break;
      need(!f.corner.empty(), "--corner");
      need(f.mu.has_value(), "--mu");
      need(f.radius_m.has_value(), "--radius-m");
      break;
  }
  return out;
}

// Returns the flags as inputs of the models: each value with its u, angles in
// radians. Throws std::invalid_argument where neither --body nor --kappa was
// given.
BoundaryInputs MakeBoundaryInputs(const TheoryFlags& flags, bool sphere) {
  const CornerFlags& f = flags.corner;
  const TheoryBoundaryFlags& b = flags.boundary;
  BoundaryInputs in;
  in.body = sphere ? core::BodyKind::kSphere : core::BodyKind::kRectangle;
  in.slip = f.corner == "leading" ? analysis::Slip::kLeading
                                  : analysis::Slip::kTrailing;
  in.kappa = {NeedKappa(f), b.u_kappa, std::nullopt};
  // What was not given keeps a default that no model asked for here uses.
  in.radius_m = {f.radius_m.value_or(in.radius_m.value), b.u_radius_m,
                 std::nullopt};
  in.mu = {f.mu.value_or(in.mu.value), b.u_mu, std::nullopt};
  in.omega_rad_per_s = {f.omega_rad_per_s.value_or(0.0), b.u_omega_rad_per_s,
                        std::nullopt};
  in.gravity_mps2 = {f.gravity_mps2, b.u_gravity_mps2, std::nullopt};
  in.restitution = {b.restitution.value_or(in.restitution.value),
                    b.u_restitution, std::nullopt};
  in.speed_mps = {b.speed_mps.value_or(in.speed_mps.value), b.u_speed_mps,
                  std::nullopt};
  in.bounce_height_m = {b.bounce_height_m.value_or(in.bounce_height_m.value),
                        b.u_bounce_height_m, std::nullopt};
  // The flags exclude each other: at most one of the two angles is held.
  const std::optional<double> held_deg =
      b.approach_deg ? b.approach_deg : b.radius_angle_deg;
  if (held_deg) {
    in.held_kind =
        b.approach_deg ? core::AngleKind::kApproach : core::AngleKind::kRadius;
    in.held_angle_rad = {*held_deg * kDegree, b.u_held_angle_deg * kDegree,
                         std::nullopt};
  }
  return in;
}

// Returns an angle in degrees, or null.
Json DegreesJson(const std::optional<double>& angle_rad) {
  return angle_rad ? Json(*angle_rad / kDegree) : Json(nullptr);
}

// Returns one model's answer for JSON: boundary or the reason that there is
// none, the state of every range of angles, sensitivities and uncertainty.
Json AnswerJson(const BoundaryAnswer& a) {
  Json json;
  if (a.boundary_rad) {
    json["boundary_deg"] = *a.boundary_rad / kDegree;
  } else {
    json["boundary_deg"] = nullptr;
    json["absent"] = a.boundary_rad.error().reason;
  }
  json["angle_kind"] = Name(a.angle_kind);
  json["ranges"] = Json::array();
  for (const auto& range : a.ranges) {
    json["ranges"].push_back({{"from_deg", range.from_rad / kDegree},
                              {"to_deg", range.to_rad / kDegree},
                              {"state", range.state}});
  }
  json["sensitivities"] = Json::array();
  for (const auto& s : a.sensitivities) {
    json["sensitivities"].push_back({{"input", s.input},
                                     {"deg_per_unit", s.slope / kDegree},
                                     {"u_deg", s.u_rad / kDegree}});
  }
  // The share of draws without a boundary means nothing where none was drawn.
  const auto& u = a.uncertainty;
  json["uncertainty"] = {
      {"first_order_u_deg", u.first_order_u_rad / kDegree},
      {"first_order_is_valid", u.first_order_is_valid},
      {"draws", u.n_draws},
      {"p_none", u.n_draws > 0 ? Json(u.p_none) : Json(nullptr)},
      {"mean_deg", DegreesJson(u.mean_rad)},
      {"u_deg", DegreesJson(u.u_rad)},
      {"low95_deg", DegreesJson(u.low_rad)},
      {"high95_deg", DegreesJson(u.high_rad)}};
  json["notes"] = a.notes;
  return json;
}

// Returns the same for a person; what has no uncertain input shows no
// uncertainty.
std::string AnswerText(const BoundaryAnswer& a) {
  std::string out;
  const auto& u = a.uncertainty;
  if (a.boundary_rad) {
    out += fmt::format("  boundary     {:.4f} deg ({} angle)\n",
                       *a.boundary_rad / kDegree, Name(a.angle_kind));
  } else {
    out +=
        fmt::format("  boundary     none: {}\n", a.boundary_rad.error().reason);
  }
  for (const auto& range : a.ranges) {
    out += fmt::format("    {:7.3f} to {:7.3f} deg  {}\n",
                       range.from_rad / kDegree, range.to_rad / kDegree,
                       range.state);
  }
  if (u.first_order_u_rad > 0.0) {
    out +=
        fmt::format("  u            {:.4g} deg to first order{}\n",
                    u.first_order_u_rad / kDegree,
                    u.first_order_is_valid ? "" : ", which is not valid here");
  }
  for (const auto& s : a.sensitivities) {
    out += fmt::format("    {:<16} {:+.4g} deg per unit, {:.4g} deg\n", s.input,
                       s.slope / kDegree, s.u_rad / kDegree);
  }
  if (u.n_draws > 0) {
    out += fmt::format("  Monte Carlo  P(no boundary) = {:.4g}, from {} draws",
                       u.p_none, u.n_draws);
    if (u.mean_rad) {
      out += fmt::format(
          "; where there is one: {:.4f} deg, u = {:.4g} deg, 95 % in [{:.4f}, "
          "{:.4f}] deg",
          *u.mean_rad / kDegree, *u.u_rad / kDegree, *u.low_rad / kDegree,
          *u.high_rad / kDegree);
    }
    out += '\n';
  }
  for (const std::string& note : a.notes) {
    out += fmt::format("  note         {}\n", note);
  }
  return out;
}

}  // namespace

// Answers `theory boundary`. Returns 0, also where no model has a boundary.
int RunBoundary(const TheoryFlags& flags) {
  if (!flags.result.cases.empty()) {
    return AnswerCases(flags.result, BoundaryCases);
  }
  const bool sphere = CountsAsSphere(flags.corner);
  const BoundaryInputs inputs = MakeBoundaryInputs(flags, sphere);
  Json json = {{"schema", "touchdown.theory.boundary/1"},
               {"seed", flags.boundary.seed},
               {"models", Json::array()}};
  std::string text;
  // The cards say what each model assumes and where it holds; these lines go
  // with every number, so that none is quoted without them.
  for (const auto& card : analysis::BoundaryModelCards()) {
    if (!flags.boundary.model.empty() && flags.boundary.model != card.name) {
      continue;
    }
    Json entry = {{"model", card.name},
                  {"label", card.label},
                  {"assumptions", card.assumptions},
                  {"range", card.range},
                  {"source", card.source},
                  {"is_physics", card.is_physics}};
    text += fmt::format("{}{}: {}\n", text.empty() ? "" : "\n", card.name,
                        card.label);
    const auto missing = Missing(card.model, flags, sphere);
    if (!missing.empty()) {
      const std::string reason =
          fmt::format("needs {}", fmt::join(missing, ", "));
      if (!flags.boundary.model.empty()) {
        throw std::invalid_argument(
            fmt::format("model {} {}", card.name, reason));
      }
      entry["boundary_deg"] = nullptr;
      entry["absent"] = reason;
      text += fmt::format("  not asked    {}\n", reason);
    } else {
      // Each model draws the same numbers, whichever others are asked.
      std::mt19937_64 engine(flags.boundary.seed);
      const BoundaryAnswer answer = analysis::EvaluateBoundary(
          card.model, inputs, engine, {.n_draws = flags.boundary.draws});
      entry.update(AnswerJson(answer));
      text += AnswerText(answer);
    }
    text +=
        fmt::format("  assumes      {}\n  holds for    {}\n  source       {}\n",
                    card.assumptions, card.range, card.source);
    json["models"].push_back(entry);
  }
  WriteResult(flags.result.json ? json.dump(2) + "\n" : text, flags.result.out);
  return 0;
}

}  // namespace touchdown::cli
