// The document of an analysis (touchdown.analysis/1).
#pragma once

#include <string>

#include "app/measure/analyze.h"

namespace touchdown::pipeline {

// The touchdown.analysis/1 document.
std::string ToJson(const Analysis& analysis);

}  // namespace touchdown::pipeline
