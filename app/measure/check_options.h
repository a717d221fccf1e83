// What is impossible in the options of an analysis.
#pragma once

#include <optional>

#include "app/measure/analyze.h"

namespace touchdown::pipeline {

// The body's kind, where the options tell. Throws std::invalid_argument where
// they contradict each other.
std::optional<core::BodyKind> DetermineKind(const AnalyzeOptions& options);

// Throws std::invalid_argument naming what is impossible, with its range.
void CheckOptions(const AnalyzeOptions& options, const vision::ClipInfo& clip);

}  // namespace touchdown::pipeline
