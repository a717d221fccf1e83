// The truth that `simulate` writes beside its clips, by which simulated footage
// is known: <clip without extension>.truth.json.
#pragma once

#include <filesystem>

namespace touchdown::pipeline {

inline std::filesystem::path TruthPath(const std::filesystem::path& clip) {
  std::filesystem::path base = clip;
  if (!base.has_filename()) base = base.parent_path();  // folder with a slash
  return base.replace_extension(".truth.json");
}

inline bool HasTruthFile(const std::filesystem::path& clip) {
  std::error_code ignored;
  return std::filesystem::exists(TruthPath(clip), ignored);
}

}  // namespace touchdown::pipeline
