// Words of `touchdown theory` that its text, JSON and case files share.
#pragma once

#include <string>
#include <string_view>

#include "touchdown/analysis/theory/impact.h"
#include "touchdown/analysis/theory/spin_boundary.h"

namespace touchdown::cli {

// slip+1>stick>stick: the phases in order, compression first.
std::string PhasesText(const analysis::ImpactResult& result);

// none, collision, without collision.
std::string_view Word(analysis::ImpactStatus status);

// OK, AT_90, NONE (R w^2<g): slide for every alpha.
std::string_view Word(analysis::SpinBoundaryStatus status);

// "3", "0x1.8p+1" or "4/3" as a number. Throws std::invalid_argument.
double ParseFraction(const std::string& text);

}  // namespace touchdown::cli
