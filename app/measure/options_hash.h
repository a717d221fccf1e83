// A digest of the options that decide an analysis, kept with its result.
#pragma once

#include <string>

#include "app/measure/analyze.h"

namespace touchdown::pipeline {

// 16 hexadecimal digits (FNV-1a, 64 bits) of every option that can change the
// answer, written out in full; the progress callback is not one.
std::string OptionsHash(const AnalyzeOptions& options);

}  // namespace touchdown::pipeline
