// This file has the commands and flags of touchdown theory, and the checks that
// several of them share (Need...). What the commands do is in
// theory_contact.cc, theory_boundary.cc and theory_map.cc.
#include <fmt/core.h>

#include <memory>
#include <stdexcept>

#include "app/cli/case_file.h"
#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/theory/theory_options.h"

namespace touchdown::cli {
namespace {

using SharedFlags = std::shared_ptr<TheoryFlags>;

// Adds --json, --cases and --out. `columns` names the columns of a case file,
// for the help of --cases.
void AddResult(CLI::App* command, const SharedFlags& flags,
               const char* columns) {
  AddFlag(*command, "--json", flags->result.json, "one JSON document");
  AddOption(*command, "--cases", flags->result.cases,
            std::string("CSV of cases to answer, as CSV: ") + columns);
  AddOption(*command, "--out", flags->result.out,
            "file for the answer (default: standard output)");
}

// Adds the flags for mass layout, radius, friction, corner and gravity.
void AddShape(CLI::App* command, CornerFlags& f) {
  const Option body =
      AddOption(*command, "--body", f.body,
                "mass layout: rectangle (kappa 3), hoop (1, the paper's "
                "sphere), shell (3/2), solid-sphere (5/2)")
          .OneOf({"rectangle", "hoop", "shell", "solid-sphere"});
  // kappa is all that the equations take of the mass layout.
  AddOption(*command, "--kappa", f.kappa, "R^2/k^2 instead of --body")
      .Exclude(body);
  AddOption(*command, "--radius-m", f.radius_m,
            "R: from the centre of mass to the contact point");
  AddOption(*command, "--mu", f.mu, "friction coefficient");
  AddOption(*command, "--corner", f.corner,
            "which corner lands: leading (ahead of the centre; thrown "
            "nose-down) or trailing (thrown nose-up; the paper's sign)")
      .OneOf({"leading", "trailing"});
  AddOption(*command, "--gravity-mps2", f.gravity_mps2, "gravity")
      .ShowDefault();
}

// Adds the angle in degrees or radians: degrees give exact sines at 0, 30 and
// 90 deg.
void AddAngle(CLI::App* command, CornerFlags& f) {
  const Option degrees = AddOption(
      *command, "--alpha-deg", f.alpha_deg,
      "radius angle: from the ground to the line centre - contact point");
  AddOption(*command, "--alpha-rad", f.alpha_rad, "the same in radians")
      .Exclude(degrees);
}

// Adds the spin; `what` says whether before or after the impact, since the
// commands differ.
void AddSpin(CLI::App* command, CornerFlags& f, const char* what) {
  AddOption(*command, "--omega-rad-per-s", f.omega_rad_per_s, what);
}

void AddRegimeCommand(CLI::App& theory, const SharedFlags& flags,
                      Action& action) {
  auto* command = AddCommand(
      theory, "regime", "what a corner on the ground can do: every solution");
  CornerFlags& f = flags->corner;
  AddAngle(command, f);
  AddShape(command, f);
  AddSpin(command, f, "spin at the contact, after the impact (default 0)");
  AddOption(*command, "--mass-kg", f.mass_kg, "mass (default 1)");
  AddFlag(*command, "--at-rest", f.at_rest,
          "the contact point does not slide (instead of --corner)");
  AddResult(command, flags,
            "id, alpha_rad, mu, slip_sign, m, R, omega, g, kappa_in or k_in");
  SetAction(*command, action, [flags] { return RunRegime(*flags); });
}

void AddImpactCommand(CLI::App& theory, const SharedFlags& flags,
                      Action& action) {
  auto* command =
      AddCommand(theory, "impact",
                 "velocities and spin after one corner has hit the ground");
  CornerFlags& f = flags->corner;
  AddAngle(command, f);
  AddShape(command, f);
  AddSpin(command, f,
          "spin before, counter-clockwise seen with the motion to the right "
          "(default 0)");
  ImpactFlags& impact = flags->impact;
  AddOption(*command, "--restitution", impact.restitution,
            "ratio of impulses e, 0 to 1");
  AddOption(*command, "--speed-mps", impact.speed_mps,
            "speed of the centre before, with --approach-deg");
  AddOption(*command, "--approach-deg", impact.approach_deg,
            "approach angle: of the velocity to the ground");
  AddOption(*command, "--tangential-mps", impact.tangential_mps,
            "instead: velocity of the contact point along the ground, in the "
            "frame that has it ahead of the centre");
  AddOption(*command, "--normal-mps", impact.normal_mps,
            "and away from the ground (negative: approaching; 0: impact "
            "without collision)");
  AddResult(command, flags, "id, alpha, mu, kappa, R, vT0, vN0, alphadot0, e");
  SetAction(*command, action, [flags] { return RunImpact(*flags); });
}

void AddFlatCommand(CLI::App& theory, const SharedFlags& flags,
                    Action& action) {
  auto* command =
      AddCommand(theory, "flat",
                 "a rectangle that slides on its side: forces on both edges");
  AddOption(*command, "--length-m", flags->flat.length_m, "side on the ground");
  AddOption(*command, "--height-m", flags->flat.height_m, "the other side");
  AddOption(*command, "--mu", flags->corner.mu, "friction coefficient");
  AddOption(*command, "--mass-kg", flags->corner.mass_kg, "mass (default 1)");
  AddOption(*command, "--gravity-mps2", flags->corner.gravity_mps2, "gravity")
      .ShowDefault();
  AddResult(command, flags, "id, a, b, mu, slip_sign, m, g");
  SetAction(*command, action, [flags] { return RunFlat(*flags); });
}

void AddBoundaryCommand(CLI::App& theory, const SharedFlags& flags,
                        Action& action) {
  auto* command =
      AddCommand(theory, "boundary",
                 "the boundary angle by each model, with its assumptions");
  CornerFlags& f = flags->corner;
  TheoryBoundaryFlags& b = flags->boundary;
  // The words are those of analysis::BoundaryModelCards().
  AddOption(*command, "--model", b.model,
            "one model (default: all side by side)")
      .OneOf({"published", "printed-equations", "corrected-lcp",
              "paper-replication", "detectable-bounce"});
  AddShape(command, f);
  AddSpin(command, f, "spin at the contact, after the impact (default 0)");
  AddOption(*command, "--restitution", b.restitution, "e, 0 to 1");
  AddOption(*command, "--speed-mps", b.speed_mps,
            "speed of the centre at touchdown");
  AddOption(*command, "--bounce-height-m", b.bounce_height_m,
            "h_c: rising above it is a bounce");
  const Option approach = AddOption(
      *command, "--approach-deg", b.approach_deg,
      "rectangles: the approach angle, held while the radius angle varies");
  AddOption(
      *command, "--radius-angle-deg", b.radius_angle_deg,
      "rectangles: the radius angle, held while the approach angle varies")
      .Exclude(approach);
  AddOption(*command, "--u-held-angle-deg", b.u_held_angle_deg,
            "of the angle that is held");
  AddOption(*command, "--u-kappa", b.u_kappa, "standard uncertainty of kappa");
  AddOption(*command, "--u-radius-m", b.u_radius_m, "of the radius");
  AddOption(*command, "--u-mu", b.u_mu, "of the friction coefficient");
  AddOption(*command, "--u-omega-rad-per-s", b.u_omega_rad_per_s,
            "of the spin");
  AddOption(*command, "--u-gravity-mps2", b.u_gravity_mps2, "of gravity");
  AddOption(*command, "--u-restitution", b.u_restitution, "of restitution");
  AddOption(*command, "--u-speed-mps", b.u_speed_mps, "of the speed");
  AddOption(*command, "--u-bounce-height-m", b.u_bounce_height_m,
            "of the bounce height");
  AddOption(*command, "--draws", b.draws, "draws of the Monte Carlo")
      .ShowDefault();
  AddOption(*command, "--seed", b.seed, "seed of the Monte Carlo")
      .ShowDefault();
  AddResult(command, flags, "id, R, omega, g and perhaps u_omega");
  SetAction(*command, action, [flags] { return RunBoundary(*flags); });
}

void AddLcpCommand(CLI::App& theory, const SharedFlags& flags, Action& action) {
  auto* command =
      AddCommand(theory, "lcp",
                 "every solution of a small linear complementarity problem");
  AddOption(*command, "--matrix", flags->lcp.m,
            "M row by row, e.g. \"2,1;1,2\"; fractions are allowed");
  AddOption(*command, "--vector", flags->lcp.q, "q, e.g. \"-5,-6\"");
  AddResult(command, flags, "name or id, M, q");
  SetAction(*command, action, [flags] { return RunLcp(*flags); });
}

void AddMapCommand(CLI::App& theory, const SharedFlags& flags, Action& action) {
  auto* command =
      AddCommand(theory, "map",
                 "regimes over angle and friction or spin: CSV and drawings");
  CornerFlags& f = flags->corner;
  MapFlags& map = flags->map;
  AddOption(*command, "--over", map.over, "second axis: mu or omega")
      .OneOf({"mu", "omega"})
      .ShowDefault();
  AddOption(*command, "--max", map.max,
            "its end (default 6 for mu; 3 sqrt(g/R) for omega)");
  AddOption(*command, "--alpha-points", map.alpha_points, "0 to 90 deg")
      .ShowDefault();
  AddOption(*command, "--axis-points", map.axis_points, "on the second axis")
      .ShowDefault();
  AddShape(command, f);
  AddSpin(command, f, "spin, for --over mu (default 0)");
  AddFlag(*command, "--no-plots", map.no_plots, "only the CSV");
  AddFlag(*command, "--json", flags->result.json, "one JSON document");
  AddOption(*command, "--out", flags->result.out,
            "folder for regime_map.csv and the drawings");
  SetAction(*command, action, [flags] { return RunMap(*flags); });
}

}  // namespace

void AddTheory(CLI::App& app, Action& action) {
  auto* theory = AddCommand(
      app, "theory", "contact theory: regimes, boundary angles, impacts");
  RequireSubcommand(*theory);
  // One set of flags for all: only one command is called.
  const auto flags = std::make_shared<TheoryFlags>();
  AddRegimeCommand(*theory, flags, action);
  AddBoundaryCommand(*theory, flags, action);
  AddMapCommand(*theory, flags, action);
  AddFlatCommand(*theory, flags, action);
  AddImpactCommand(*theory, flags, action);
  AddLcpCommand(*theory, flags, action);
}

double Need(const std::optional<double>& value, const char* flag) {
  if (value) return *value;
  throw std::invalid_argument(
      fmt::format("{} is missing; give it a value", flag));
}

// A CSV cannot be had as JSON.
int AnswerCases(const ResultFlags& flags,
                std::string (*answer)(const std::string& path)) {
  if (flags.json) {
    throw std::invalid_argument(
        "--cases answers in CSV; leave --json away, or the other");
  }
  WriteResult(answer(flags.cases), flags.out);
  return 0;
}

// A hoop is none of them: its contact point is fixed to the body, as that of a
// rectangle's corner is.
bool IsSphere(const CornerFlags& flags) {
  return flags.body == "shell" || flags.body == "solid-sphere";
}

analysis::SinCos NeedAlpha(const CornerFlags& flags) {
  if (IsSphere(flags)) {
    if (flags.alpha_deg || flags.alpha_rad) {
      throw std::invalid_argument(
          "--alpha-deg with a sphere: it touches below its centre, at 90 deg "
          "always; leave it away, or give --kappa for a point fixed to the "
          "body");
    }
    return analysis::SinCosOfDegrees(90.0);
  }
  // CLI11 has refused both angles together.
  if (flags.alpha_rad) return analysis::SinCosOfRadians(*flags.alpha_rad);
  return analysis::SinCosOfDegrees(Need(flags.alpha_deg, "--alpha-deg"));
}

// CLI11 has refused --kappa and --body together.
double NeedKappa(const CornerFlags& flags) {
  using analysis::MassLayout;
  if (flags.kappa) return *flags.kappa;
  if (flags.body == "rectangle") return Kappa(MassLayout::kRectangle);
  if (flags.body == "hoop") return Kappa(MassLayout::kHoop);
  if (flags.body == "shell") return Kappa(MassLayout::kShell);
  if (flags.body == "solid-sphere") return Kappa(MassLayout::kSolidSphere);
  throw std::invalid_argument(
      "--body is missing; give rectangle, hoop, shell or solid-sphere, or "
      "--kappa a number");
}

// Returns the direction of slip: forward of a leading corner, backward of a
// trailing one, none at rest.
analysis::Slip NeedSlip(const CornerFlags& flags) {
  if (flags.at_rest) {
    if (!flags.corner.empty()) {
      throw std::invalid_argument(
          "--at-rest and --corner exclude each other; give one of them");
    }
    return analysis::Slip::kNone;
  }
  if (flags.corner == "leading") return analysis::Slip::kLeading;
  if (flags.corner == "trailing") return analysis::Slip::kTrailing;
  throw std::invalid_argument("--corner is missing; give leading or trailing");
}

}  // namespace touchdown::cli
