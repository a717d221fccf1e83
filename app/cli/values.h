// Values as they are typed at the command line. Each throws
// std::invalid_argument with the flag's name, what was given and what is
// expected.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "app/trials/typed_values.h"
#include "touchdown/core/points.h"

namespace touchdown::cli {

using pipeline::kPlainSize;
using pipeline::ParseEstimate;
using pipeline::ParseMeasured;
using pipeline::ParseSides;

// Exactly `count` numbers separated by commas.
std::vector<double> ParseNumbers(const std::string& flag,
                                 const std::string& text, std::size_t count,
                                 const std::string& form);

// "X,Y,W,H" in whole pixels, X and Y at least 0, W and H positive, none beyond
// 65536, the largest picture that is read.
core::PixelRect ParseRegion(const std::string& flag, const std::string& text);

// "A:B", "A:" or ":B": frames A, A+1, ... B-1; an open end is -1.
std::pair<std::int64_t, std::int64_t> ParseFrames(const std::string& flag,
                                                  const std::string& text);

}  // namespace touchdown::cli
