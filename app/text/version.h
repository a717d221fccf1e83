// The program's version: what is kept with every result. --version prints the
// commit beside it.
#pragma once

#include <string_view>

namespace touchdown::pipeline {

std::string_view Version();

// "2e27c84b1234", "-dirty" behind it where files differed from it, or "unknown
// commit".
std::string_view Commit();

}  // namespace touchdown::pipeline
