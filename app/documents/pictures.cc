#include "app/documents/pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "app/documents/evidence.h"
#include "app/documents/replay.h"
#include "app/measure/journal.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;

// Recording and options of an analysis.
using Key = std::pair<std::string, std::string>;

// Returns the text json[object][field]; empty where there is none. The file may
// be anybody's.
std::string FindText(const nlohmann::json& json, const char* object,
                     const char* field) {
  const auto outer = json.find(object);
  if (outer == json.end() || !outer->is_object()) return "";
  const auto inner = outer->find(field);
  return inner != outer->end() && inner->is_string() ? inner->get<std::string>()
                                                     : "";
}

// Reads which analysis an analysis.json is of; both parts are empty where it is
// none.
Key ReadKey(const fs::path& analysis) {
  std::ifstream file(analysis);
  const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object()) return {};
  return {FindText(json, "clip", "id"),
          FindText(json, "software", "options_hash")};
}

// Of the recording and the options of the analysis that the trial states;
// nothing where a person or another program gave them a name that is none.
std::optional<fs::path> FindPicture(const fs::path& store,
                                    const core::Trial& trial) {
  const std::string name =
      fmt::format("{}-{}", trial.clip.id, trial.options_hash);
  // Id and hash are hexadecimal. A slash or dots, in a store that came from
  // elsewhere, would lead out of the folder.
  const bool is_plain = std::ranges::all_of(name, [](char c) {
    return c == '-' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z');
  });
  if (trial.clip.id.empty() || !is_plain) return std::nullopt;
  return PictureFolder(store) / (name + ".png");
}

}  // namespace

fs::path PictureFolder(const fs::path& store) {
  return store.string() + ".evidence";
}

bool KeepPicture(const fs::path& store, const core::Trial& trial) {
  const auto picture = FindPicture(store, trial);
  if (!picture) return false;
  try {
    // The analysis is taken from the trial, so that the picture shows what is
    // stored, a person's correction included.
    auto analysis = Replay(trial);
    if (!analysis) return false;
    // The document has the path as it was typed; the trial has the absolute
    // one.
    analysis->clip.path = trial.clip.path;
    const auto sheet = MakeContactSheet(*analysis);
    if (!sheet) return false;
    std::error_code ignored;
    // Where the folder cannot be made, writing the picture says so.
    fs::create_directories(PictureFolder(store), ignored);
    vision::WritePngRgb(*picture, sheet->width_px, sheet->height_px,
                        sheet->rgb);
    return true;
  } catch (const std::exception& trouble) {
    Journal(fmt::format("no picture of the contact in {}: {}", trial.clip.path,
                        trouble.what()));
    return false;
  }
}

std::map<std::string, fs::path> KeptPictures(
    const fs::path& store, std::span<const core::Trial> trials) {
  std::map<std::string, fs::path> out;
  for (const core::Trial& trial : trials) {
    const auto picture = FindPicture(store, trial);
    std::error_code ignored;
    if (picture && fs::is_regular_file(*picture, ignored)) {
      out.emplace(trial.id, *picture);
    }
  }
  return out;
}

std::map<std::string, fs::path> FindPictures(
    const fs::path& folder, std::span<const core::Trial> trials) {
  std::map<Key, fs::path> found;
  std::error_code trouble;
  fs::recursive_directory_iterator entry(folder, trouble);
  // One pass over the folder collects every contact.png by the recording and
  // the options of the analysis.json beside it.
  for (; !trouble && entry != fs::recursive_directory_iterator();
       entry.increment(trouble)) {
    if (entry->path().filename() != "analysis.json") continue;
    const fs::path picture = entry->path().parent_path() / "contact.png";
    std::error_code ignored;
    if (!fs::is_regular_file(picture, ignored)) continue;
    const Key key = ReadKey(entry->path());
    const auto [at, is_new] = found.emplace(key, picture);
    // Directories are listed in any order: the first by path is always the
    // same.
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
