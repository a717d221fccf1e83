// The program's version, as printed by --version and kept with every result.
#pragma once

#include <string_view>

namespace touchdown::pipeline {

std::string_view Version();

}  // namespace touchdown::pipeline
