// A campaign: trials of one body on one surface in one speed band, with its
// conventions fixed before the first trial.
#pragma once

#include <optional>
#include <string>

#include "touchdown/core/body.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/words.h"

namespace touchdown::core {

struct Campaign {
  std::string name;     // unique within a store
  Body body;            //
  std::string surface;  // free text, e.g. "asphalt, dry"
  AngleKind angle_kind = AngleKind::kApproach;
  double bounce_height_m = 0.0;  // rising above it is what `bounce` means
  double speed_min_mps = 0.0;    // speed band at touchdown; 0..0 = not declared
  double speed_max_mps = 0.0;

  // The one theory declared before the first trial; only it gets a verdict.
  // Empty name: none declared.
  std::string theory_name;
  std::optional<double> theory_boundary_rad;
  double theory_u_rad = 0.0;  // standard uncertainty of the theory's value

  // Equivalence margin of the verdict. Default 1 degree: the reading error of a
  // good protractor; a wider margin is confirmed more easily and says less.
  double margin_rad = 0.017453292519943295;
};

// The surface of the campaigns that check shots are logged in: a known body
// dropped from a known height, to see that camera and software are as they
// were. Check shots have no boundary angle and no next angle, and no theory
// speaks of them; they have a control chart.
inline constexpr const char* kCheckShotSurface = "check shot, dropped";
inline bool HasCheckShots(const Campaign& campaign) {
  return campaign.surface == kCheckShotSurface;
}

}  // namespace touchdown::core
