// A body and a campaign as they are typed: at the command line and on the
// review page.
#pragma once

#include <optional>
#include <string>

#include "touchdown/core/body.h"
#include "touchdown/core/campaign.h"

namespace touchdown::pipeline {

// Sizes may bear their standard uncertainty: "40+-0.02", "60+-0.02x20+-0.02".
struct BodyEntry {
  std::string kind;  // sphere or rectangle; empty: by which size is given
  std::string diameter_mm;
  std::string sides_mm;
};

// Nothing if none of the three was given. Throws FieldError (statement.h)
// naming body, diameter-mm or sides-mm; std::invalid_argument for sizes that no
// body has.
std::optional<core::Body> ParseBody(const BodyEntry& entry);

struct CampaignEntry {
  std::string name;
  BodyEntry body;
  std::string surface;
  std::string angle_kind;                  // empty: the body's default
  std::optional<double> bounce_height_mm;  // nothing: the default convention
  std::string speed_mps;                   // "3.5:4.5"; empty: no band
  std::string theory;                      // empty: none is declared
  std::optional<double> theory_boundary_deg;
  std::optional<double> theory_u_deg;
  double margin_deg = 1.0;
};

// Throws FieldError naming the field as the flag of `campaign new` is.
core::Campaign MakeCampaign(const CampaignEntry& entry);

}  // namespace touchdown::pipeline
