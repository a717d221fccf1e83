// The folders that the server was given, and the recordings in them: nothing
// outside is listed or opened, whatever a name says and wherever a symbolic
// link leads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace touchdown::review {

// A recording as the page names it.
struct Recording {
  std::size_t folder = 0;  // its place in RecordingFolders::folders()
  std::string name;        // below it

  friend bool operator==(const Recording&, const Recording&) = default;
};

class RecordingFolders {
 public:
  RecordingFolders() = default;  // of none
  // Throws core::InputError naming what is no folder.
  explicit RecordingFolders(const std::vector<std::filesystem::path>& folders);

  const std::vector<std::filesystem::path>& folders() const { return folders_; }

  // Names of the recordings in a folder, of which every file lies inside, in
  // their order. Throws core::InputError if the folder cannot be read.
  std::vector<std::string> Names(std::size_t folder) const;

  // Where it lies, without links. Throws pipeline::FieldError, naming
  // "recording", where there is no such recording inside the folder.
  std::filesystem::path Require(const Recording& recording) const;

  // The pictures of a folder inside, at least one, by their names. Throws like
  // Require, naming "pictures".
  std::vector<std::filesystem::path> RequirePictures(
      const Recording& folder) const;

 private:
  // Nothing where it is not there or leads outside.
  std::optional<std::filesystem::path> ResolvePath(
      std::size_t folder, const std::filesystem::path& path) const;

  std::vector<std::filesystem::path> folders_;  // canonical
};

// {"folder": n, "name": text} of what the page sends. Throws
// pipeline::FieldError.
Recording ReadRecording(const nlohmann::json& asked);

}  // namespace touchdown::review
