// The flags of `touchdown theory`, as they were given: absent is absent, never
// a silent default.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "touchdown/analysis/theory/corner.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {

// Where a result goes.
struct ResultFlags {
  bool json = false;
  std::string cases;  // a case file to answer instead of the flags
  std::string out;    // empty: standard output
};

struct CornerFlags {
  std::optional<double> alpha_deg;
  std::optional<double> alpha_rad;
  std::string corner;  // leading, trailing
  std::string body;    // rectangle, hoop, shell, solid-sphere
  std::optional<double> kappa;
  std::optional<double> radius_m;
  std::optional<double> mu;
  std::optional<double> omega_rad_per_s;
  std::optional<double> mass_kg;
  double gravity_mps2 = core::kStandardGravity_mps2;
  bool at_rest = false;
};

struct ImpactFlags {
  std::optional<double> speed_mps;
  std::optional<double> approach_deg;
  std::optional<double> tangential_mps;
  std::optional<double> normal_mps;
  std::optional<double> restitution;
};

struct FlatFlags {
  std::optional<double> length_m;
  std::optional<double> height_m;
};

struct TheoryBoundaryFlags {
  std::string model;  // empty: all
  std::optional<double> restitution;
  std::optional<double> speed_mps;
  std::optional<double> bounce_height_m;
  std::optional<double> approach_deg;      // held; the radius angle varies
  std::optional<double> radius_angle_deg;  // held; the approach angle varies
  double u_held_angle_deg = 0.0;
  double u_kappa = 0.0;
  double u_radius_m = 0.0;
  double u_mu = 0.0;
  double u_omega_rad_per_s = 0.0;
  double u_gravity_mps2 = 0.0;
  double u_restitution = 0.0;
  double u_speed_mps = 0.0;
  double u_bounce_height_m = 0.0;
  int draws = 20'000;
  std::uint64_t seed = 1;
};

struct LcpFlags {
  std::string m;
  std::string q;
};

struct MapFlags {
  std::string over = "mu";  // mu, omega
  std::optional<double> max;
  int alpha_points = 361;
  int axis_points = 241;
  bool no_plots = false;
};

struct TheoryFlags {
  ResultFlags result;
  CornerFlags corner;
  ImpactFlags impact;
  FlatFlags flat;
  TheoryBoundaryFlags boundary;
  LcpFlags lcp;
  MapFlags map;
};

// What a command needs, or std::invalid_argument that names the missing flag.
double Need(const std::optional<double>& value, const char* flag);
// A sphere (shell, solid-sphere) touches below its centre: 90 deg, and any
// other angle is refused.
analysis::SinCos NeedAlpha(const CornerFlags& flags);
bool IsSphere(const CornerFlags& flags);
double NeedKappa(const CornerFlags& flags);
analysis::Slip NeedSlip(const CornerFlags& flags);

// Answers a case file by one function of theory_cases.h, and returns the exit
// status. Throws std::invalid_argument where --json is given, too.
int AnswerCases(const ResultFlags& flags,
                std::string (*answer)(const std::string& path));

// Each answers one command and returns the exit status.
int RunRegime(const TheoryFlags& flags);
int RunImpact(const TheoryFlags& flags);
int RunFlat(const TheoryFlags& flags);
int RunBoundary(const TheoryFlags& flags);
int RunLcp(const TheoryFlags& flags);
int RunMap(const TheoryFlags& flags);

}  // namespace touchdown::cli
