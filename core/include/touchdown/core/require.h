// Checks of arguments: an impossible one throws std::invalid_argument that
// names the field, its value with its unit, and its allowed range.
#pragma once

#include <string_view>

namespace touchdown::core {

[[noreturn]] void Refuse(std::string_view field, double value,
                         std::string_view range, std::string_view unit = "");

void Require(bool ok, std::string_view field, double value,
             std::string_view range);
void RequireFinite(std::string_view field, double value,
                   std::string_view unit = "");
// And finite, these two.
void RequirePositive(std::string_view field, double value,
                     std::string_view unit = "");
void RequireNotNegative(std::string_view field, double value,
                        std::string_view unit = "");
void RequireInRange(std::string_view field, double value, double low,
                    double high, std::string_view unit = "");

}  // namespace touchdown::core
