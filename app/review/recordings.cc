#include "app/review/recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "app/measure/board_pictures.h"
#include "app/review/fields.h"
#include "app/text/whole_number.h"
#include "app/trials/recordings.h"
#include "app/trials/statement.h"
#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

namespace fs = std::filesystem;
using pipeline::FieldError;

}  // namespace

RecordingFolders::RecordingFolders(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    std::error_code trouble;
    const fs::path canonical = fs::canonical(folder, trouble);
    if (trouble || !fs::is_directory(canonical, trouble)) {
      throw core::InputError(fmt::format(
          "{}: there is no such folder; --recordings expects one that "
          "recordings lie in",
          folder.string()));
    }
    // A folder that was given twice is listed once.
    if (std::ranges::find(folders_, canonical) == folders_.end()) {
      folders_.push_back(canonical);
    }
  }
}

std::optional<fs::path> RecordingFolders::ResolvePath(
    std::size_t folder, const fs::path& path) const {
  std::error_code trouble;
  // Links are followed to their end before the place is judged.
  fs::path canonical = fs::canonical(path, trouble);
  if (trouble || !pipeline::IsBelow(canonical, folders_.at(folder)))
    return std::nullopt;
  return canonical;
}

// Files that a link leads to outside are not even opened (is_inside as
// `admit`).
std::vector<std::string> RecordingFolders::Names(std::size_t folder) const {
  const fs::path& root = folders_.at(folder);
  const auto is_inside = [&](const fs::path& file) {
    return ResolvePath(folder, file).has_value();
  };
  std::vector<std::string> names;
  for (const fs::path& found : pipeline::FindRecordings(root, is_inside)) {
    // A header or a single picture that leads out would be read with the rest.
    if (std::ranges::all_of(pipeline::ListFiles(found), is_inside)) {
      names.push_back(found.lexically_relative(root).string());
    }
  }
  return names;
}

fs::path RecordingFolders::Require(const Recording& recording) const {
  // All causes have one message: it does not tell whether a file outside is
  // there.
  const auto refuse = [&]() -> FieldError {
    return {"recording",
            fmt::format("is '{}', must be one of the folders' recordings",
                        recording.name)};
  };
  if (recording.folder >= folders_.size()) throw refuse();
  const auto path = ResolvePath(
      recording.folder,
      (folders_[recording.folder] / recording.name).lexically_normal());
  // A name that ends outside of the folder is refused before it is looked at.
  if (!path || !pipeline::IsRecording(*path)) throw refuse();
  for (const fs::path& file : pipeline::ListFiles(*path)) {
    if (!ResolvePath(recording.folder, file)) throw refuse();
  }
  return *path;
}

std::vector<fs::path> RecordingFolders::RequirePictures(
    const Recording& folder) const {
  std::vector<fs::path> pictures;
  std::optional<fs::path> path;
  if (folder.folder < folders_.size()) {
    path = ResolvePath(folder.folder, folders_[folder.folder] / folder.name);
  }
  std::error_code trouble;
  if (path && fs::is_directory(*path, trouble)) {
    pictures = pipeline::ListPictures(*path);
  }
  const bool are_inside = std::ranges::all_of(pictures, [&](const auto& one) {
    return ResolvePath(folder.folder, one).has_value();
  });
  if (!pictures.empty() && are_inside) return pictures;
  throw FieldError("pictures",
                   fmt::format("is '{}', must be a folder with pictures of the "
                               "board, inside one of the folders",
                               folder.name));
}

Recording ReadRecording(const nlohmann::json& asked) {
  Recording recording;
  recording.name = RequiredText(asked, "name", "a recording of a folder");
  const auto folder = asked.find("folder");
  if (folder == asked.end()) throw FieldError("folder", "is missing");
  // Its upper end is for Require to test, which knows the folders.
  const auto place = pipeline::WholeNumber(*folder, "folder");
  if (place < 0) throw FieldError("folder", "must be at least 0");
  recording.folder = static_cast<std::size_t>(place);
  return recording;
}

}  // namespace touchdown::review
