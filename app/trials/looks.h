// Looks at the answers of campaigns, on record (db/plan.h).
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>

namespace touchdown::pipeline {

// Records that `command` shows the answers of these campaigns, each once for
// the same trials. A look waits for nobody: where another process keeps the
// store from being written, or it cannot be written at all, what is in the way
// is returned and the look goes on; else nothing.
std::string KeepLooks(const std::filesystem::path& store,
                      const std::set<std::string>& campaigns,
                      std::string_view command);

// The campaigns of a store that have an answer: all but check shots.
std::set<std::string> CampaignsWithAnswer(const std::filesystem::path& store);

}  // namespace touchdown::pipeline
