#include "app/pipeline/pictures.h"

#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "touchdown/core/errors.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Recording and options of an analysis.
using Key = std::pair<std::string, std::string>;

std::string TextAt(const Json& json, const char* object, const char* field) {
  const auto outer = json.find(object);
  if (outer == json.end() || !outer->is_object()) return "";
  const auto inner = outer->find(field);
  return inner != outer->end() && inner->is_string() ? inner->get<std::string>()
                                                     : "";
}

Key KeyOf(const fs::path& analysis) {
  std::ifstream file(analysis);
  const Json json = Json::parse(file, nullptr, false);
  if (!json.is_object()) return {};
  return {TextAt(json, "clip", "id"), TextAt(json, "software", "options_hash")};
}

}  // namespace

std::map<std::string, fs::path> FindPictures(
    const fs::path& folder, std::span<const core::Trial> trials) {
  std::map<Key, fs::path> found;
  std::error_code trouble;
  fs::recursive_directory_iterator entry(folder, trouble);
  for (; !trouble && entry != fs::recursive_directory_iterator();
       entry.increment(trouble)) {
    if (entry->path().filename() != "analysis.json") continue;
    const fs::path picture = entry->path().parent_path() / "contact.png";
    std::error_code ignored;
    if (!fs::is_regular_file(picture, ignored)) continue;
    const Key key = KeyOf(entry->path());
    const auto [at, is_new] = found.emplace(key, picture);
    if (!is_new && picture < at->second) at->second = picture;
  }
  if (trouble) {
    throw core::InputError(fmt::format(
        "{}: {}; give the folder that analyze or batch wrote with --out",
        folder.string(), trouble.message()));
  }
  std::map<std::string, fs::path> out;
  for (const core::Trial& trial : trials) {
    if (trial.clip.id.empty()) continue;
    const auto at = found.find({trial.clip.id, trial.options_hash});
    if (at != found.end()) out.emplace(trial.id, at->second);
  }
  return out;
}

}  // namespace touchdown::pipeline
