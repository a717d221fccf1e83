// Stores as older programs made them.
#pragma once

#include <cstdint>
#include <filesystem>

namespace touchdown::db {

// Of the schema's version `version`, from tests/db/data.
void MakeOldStore(const std::filesystem::path& path, std::int64_t version);

}  // namespace touchdown::db
