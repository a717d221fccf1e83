// The fields of what the page sends. Names as in its JSON; FieldError names
// them as the flags of the commands are, so that both say the same.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "touchdown/core/points.h"

namespace touchdown::review {

// Text; empty where the field is missing. Throws pipeline::FieldError where it
// is something else.
std::string ReadTextField(const nlohmann::json& asked, const char* field);

// Text that must be there and not blank; `what` it must be, for the person.
std::string RequiredText(const nlohmann::json& asked, const char* field,
                         const char* what);

// Two points of the recorded picture, px: a list x1, y1, x2, y2; nothing where
// the field is missing or null. Throws std::invalid_argument where it has
// another length, nlohmann's exceptions where it is no list of numbers.
std::optional<std::pair<core::PixelPoint, core::PixelPoint>> ReadTwoPoints(
    const nlohmann::json& asked, const char* field);

// A number, or text that is one, as it was typed; nothing where it is missing
// or empty.
std::optional<double> ReadNumberField(const nlohmann::json& asked,
                                      const char* field);

}  // namespace touchdown::review
