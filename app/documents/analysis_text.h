// An analysis for a person to read, in a few aligned lines.
#pragma once

#include <string>

#include "app/measure/analyze.h"

namespace touchdown::pipeline {

std::string ToText(const Analysis& analysis);

}  // namespace touchdown::pipeline
