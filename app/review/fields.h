// The fields of what the page sends. Names as in its JSON; FieldError names
// them as the flags of the commands are, so that both say the same.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace touchdown::review {

// Text; empty where the field is missing. Throws pipeline::FieldError where it
// is something else.
std::string ReadTextField(const nlohmann::json& asked, const char* field);

// Text that must be there and not blank; `what` it must be, for the person.
std::string RequiredText(const nlohmann::json& asked, const char* field,
                         const char* what);

// A number, or text that is one, as it was typed; nothing where it is missing
// or empty.
std::optional<double> ReadNumberField(const nlohmann::json& asked,
                                      const char* field);

}  // namespace touchdown::review
