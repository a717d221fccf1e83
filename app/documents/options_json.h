// The options of an analysis in its document, in SI: those that decide the
// answer (app/measure/option_fields.h). Limits, threads and progress belong to
// the run and not to the analysis.
#pragma once

#include <optional>
#include <string>

#include "app/measure/option_fields.h"
#include "app/text/json.h"
#include "touchdown/calib/plane.h"

namespace touchdown::pipeline {

// The line as it was used: two points, and the reference point at which its
// offset and its direction are uncorrelated.
report::Json GroundLineJson(const calib::GroundLine& line);
report::Json OptionsJson(const AnalyzeOptions& options);

// The inverse. Each throws Json::exception, std::invalid_argument or
// core::InputError where the document is damaged or of another program. What is
// absent is read as absent; `only`: of the options of one scope.
calib::GroundLine ReadGroundLine(const report::Json& json);
AnalyzeOptions ReadOptions(const report::Json& json,
                           std::optional<OptionScope> only = std::nullopt);

}  // namespace touchdown::pipeline
