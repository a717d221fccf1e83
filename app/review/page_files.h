// The page's own files, as they were when the program was built (embed.cmake).
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace touchdown::review {

// By name, e.g. "app.js"; nothing where there is none.
std::optional<std::string_view> PageFile(std::string_view name);

}  // namespace touchdown::review
