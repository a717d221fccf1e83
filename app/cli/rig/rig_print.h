// Results of the rig as text for people and as JSON for scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/text/json_fields.h"
#include "touchdown/rig/predict.h"
#include "touchdown/rig/spring.h"

namespace touchdown::cli {

using report::EstimateJson;
using report::Json;

// ["warning: ...", "refused: ..."].
Json FindingsJson(const std::vector<rig::Finding>& findings);

// Everything of the report, in the units that the keys name.
Json SpringJson(const rig::SpringReport& report);

// Every predicted number with both uncertainties and budget; what is absent is
// null, with its reason under "absent".
Json PredictionJson(const rig::ContactPrediction& contact);

// "  name        value +- u unit   (Monte Carlo ...)".
std::string ValueLine(std::string_view name, const core::Estimate& value,
                      double per_si, std::string_view unit);
std::string ValueLine(std::string_view name, const rig::Predicted& value,
                      double per_si, std::string_view unit);
std::string ValueLine(std::string_view name, double value,
                      std::string_view unit);

// "value +- u" with u to two digits and the value to the same place; without a
// u the value to six digits.
std::string Rounded(const core::Estimate& estimate);

std::string FindingsText(const std::vector<rig::Finding>& findings);
std::string SpringText(const rig::SpringReport& report);
std::string PredictionText(const rig::ContactPrediction& contact,
                           bool with_flight);

}  // namespace touchdown::cli
