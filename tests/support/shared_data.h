// Where reference numbers and real recordings lie, when they are at hand. They
// are not part of the project: tests that need them skip with a message when
// the folder is absent.
//
//   const auto path = testing::Shared("reference/data/spring_cases.csv");
//   if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace touchdown::testing {

// $TOUCHDOWN_SHARED, or the folder `shared` beside the source tree.
inline std::filesystem::path SharedFolder() {
  if (const char* folder = std::getenv("TOUCHDOWN_SHARED")) return folder;
  return std::filesystem::path(TOUCHDOWN_SOURCE_DIR).parent_path() / "shared";
}

inline std::filesystem::path Shared(std::string_view relative) {
  return SharedFolder() / relative;
}

}  // namespace touchdown::testing
