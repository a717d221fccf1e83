// The daily check shot: a known body dropped from a known height, whose speed
// and angle at touchdown are known without any camera.
#pragma once

#include <string>

#include "touchdown/core/body.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/trial.h"
#include "touchdown/core/units.h"

namespace touchdown::session {

struct CheckShot {
  core::Body body;
  // From the body's lowest point at rest to the ground. u: a scale read at
  // arm's length.
  core::Estimate height_m{
      300.0 * core::kMillimetre, 1.0 * core::kMillimetre, {}};
  core::Estimate gravity_mps2{core::kStandardGravity_mps2, 0.015, {}};
  // How far from upright a drop may be for reasons that are not the camera's:
  // a floor that slopes by 3 mm in 1 m (0.17 deg), and a release that gives 10
  // mm/s sideways (0.24 deg at 2.4 m/s).
  double upright_u_rad = 0.3 * core::kDegree;
};

// sqrt(2 g h), with the uncertainty of both. Throws std::invalid_argument
// unless the height and gravity are positive. Air takes less than 0.1 % of it
// where the body outweighs 1000 times the air in the path it sweeps.
core::Estimate ExpectedSpeed(const CheckShot& check);

// The body in words: "sphere 40 mm". Throws std::invalid_argument where it has
// no size.
std::string DroppedBody(const CheckShot& check);

// The campaign that check shots are logged in, so that they are never pooled
// with others: its name says body and height.
core::Campaign CheckCampaign(const CheckShot& check);

// Measured against known: E_n = difference / sqrt(U^2 + U_known^2), U = 2 u
// (ISO 13528:2015, 9.7); |E_n| <= 1 agrees.
struct CheckResult {
  core::Expected<double> speed_e_n = core::AbsentBecause("not measured");
  core::Expected<double> angle_e_n = core::AbsentBecause("not measured");
  bool agrees = false;  // both are there, and agree
  std::string text;     // one sentence for a person
};
CheckResult Compare(const CheckShot& check, const core::Trial& trial);

}  // namespace touchdown::session
