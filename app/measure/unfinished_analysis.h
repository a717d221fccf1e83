// What is said of a clip whose analysis was ended by its limit.
#pragma once

#include <string>

#include "app/measure/analyze.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::pipeline {

// `while_what`: as core::Cancelled says it ("while outlines are fitted, at
// frame 31").
Unfinished UnfinishedAnalysis(const vision::ClipInfo& clip,
                              const AnalyzeOptions& options,
                              const std::string& while_what);

}  // namespace touchdown::pipeline
