// Recordings that were moved, found again from the page.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace touchdown::review {

// {"folder": path} to {"found": [{"from", "to"}], "missing": [path, ...],
// "in_place", "looked_at"}: pipeline::Relink. Throws pipeline::FieldError
// without a folder, else what Relink throws.
nlohmann::ordered_json RelinkedJson(const std::filesystem::path& store,
                                    const nlohmann::json& asked);

}  // namespace touchdown::review
