// The document of an analysis (touchdown.analysis/1).
#pragma once

#include <string>

#include "app/measure/analyze.h"
#include "app/text/json.h"

namespace touchdown::pipeline {

// The touchdown.analysis/1 document.
std::string ToJson(const Analysis& analysis);

// Its "checks": what was asked of the answer, and what came of it.
report::Json ChecksJson(const Analysis& analysis);

}  // namespace touchdown::pipeline
