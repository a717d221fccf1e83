// Days as they are written in files: 2026-11-21.
#pragma once

#include <string>

namespace touchdown::pipeline {

std::string Today();  // of the local clock

// `days` after `date`. Throws std::invalid_argument naming `flag` where `date`
// is no day.
std::string AddDays(const std::string& flag, const std::string& date, int days);

}  // namespace touchdown::pipeline
