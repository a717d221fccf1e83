#include "app/trials/recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>

#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;

// Extensions of containers that vision/clip.h reads.
constexpr std::array<std::string_view, 19> kVideos = {
    ".avi",  ".mov", ".mp4", ".m4v",  ".3gp", ".mkv", ".webm",
    ".cine", ".ts",  ".mpg", ".mpeg", ".asf", ".wmv", ".flv",
    ".ogv",  ".nut", ".y4m", ".mxf",  ".dv"};

// Of the folder that a store keeps its pictures in (pictures.h).
constexpr const char* kEvidence = ".evidence";

// Returns the extension with its dot, ASCII letters in lower case: ".MRAW"
// gives ".mraw". Cameras and Windows programs write either.
std::string LowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

// Says whether the name alone tells that the file is a recording. TIFF stacks
// are not among these: only their content tells them from single pictures.
bool IsRecordingFile(const fs::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".mraw" ||
         std::find(kVideos.begin(), kVideos.end(), extension) != kVideos.end();
}

// A hidden file has a name that begins with a dot. Copying programs write under
// such names until a file is complete.
bool IsHidden(const fs::path& path) {
  return path.filename().string().starts_with('.');
}

// One that cannot be opened is no stack here; opening it will say why.
bool IsStack(const fs::path& path) {
  try {
    return vision::IsTiffStack(path);
  } catch (const core::InputError&) {
    return false;
  }
}

// Holds what lies directly in one folder.
struct Inside {
  std::vector<fs::path> recordings;
  std::vector<fs::path> folders;  // to be looked through, too
};

// Lists the recordings directly in `folder`, which is itself one where it holds
// pictures alone, and the folders below it. Files that `admit` refuses are not
// opened. Throws core::InputError where the folder cannot be read.
Inside ListFolder(const fs::path& folder, const Admit& admit) {
  Inside inside;
  std::error_code trouble;
  std::vector<fs::path> files;
  std::vector<fs::path> images;
  fs::directory_iterator entry(folder, trouble);
  for (; !trouble && entry != fs::directory_iterator();
       entry.increment(trouble)) {
    const fs::path& path = entry->path();
    // An entry that vanishes between the listing and the question counts as
    // neither folder nor file.
    std::error_code ignored;
    if (IsHidden(path)) continue;
    // The pictures beside it were drawn by this program; analysed as a
    // recording they would become a trial.
    if (path.filename() == "analysis.json") return {};  // evidence
    if (entry->is_directory(ignored)) {
      // A link to a folder could lead back up: the search would not end.
      if (!entry->is_symlink(ignored) && path.extension() != kEvidence) {
        inside.folders.push_back(path);
      }
    } else if (entry->is_regular_file(ignored) && (!admit || admit(path))) {
      if (IsRecordingFile(path)) {
        files.push_back(path);
      } else if (vision::IsImageName(path)) {
        images.push_back(path);
      }
    }
  }
  if (trouble) {
    throw core::InputError(
        fmt::format("{}: {}", folder.string(), trouble.message()));
  }
  // A TIFF of several pages is a recording of its own. Whether the folder holds
  // such ones its first picture tells: thousands need not be opened.
  if (!images.empty() && IsStack(*std::ranges::min_element(images))) {
    const auto stacks = std::stable_partition(
        images.begin(), images.end(),
        [](const fs::path& image) { return !IsStack(image); });
    files.insert(files.end(), stacks, images.end());
    images.erase(stacks, images.end());
  }
  // Pictures beside a video are somebody's notes; alone they are a recording.
  if (!images.empty() && files.empty()) inside.recordings.push_back(folder);
  inside.recordings.insert(inside.recordings.end(), files.begin(), files.end());
  return inside;
}

// Appends the recordings of `folder` and of all folders below it, in the order
// of the directory entries; FindRecordings sorts them.
void Collect(const fs::path& folder, const Admit& admit,
             std::vector<fs::path>& recordings) {
  const Inside inside = ListFolder(folder, admit);
  recordings.insert(recordings.end(), inside.recordings.begin(),
                    inside.recordings.end());
  for (const fs::path& below : inside.folders) {
    Collect(below, admit, recordings);
  }
}

// Adds one file to an extent. A file that is gone adds nothing, so that the
// extent differs from the one before and the recording is waited for again.
void AddFile(const fs::path& file, Extent& extent) {
  std::error_code trouble;
  const std::uintmax_t bytes = fs::file_size(file, trouble);
  if (trouble) return;
  const auto written = fs::last_write_time(file, trouble);
  if (trouble) return;
  ++extent.files;
  extent.bytes += bytes;
  extent.written = std::max(extent.written, written);
}

}  // namespace

std::vector<fs::path> FindRecordings(const fs::path& folder,
                                     const Admit& admit) {
  std::vector<fs::path> recordings;
  Collect(folder, admit, recordings);
  std::sort(recordings.begin(), recordings.end());
  return recordings;
}

bool IsRecording(const fs::path& path) {
  std::error_code trouble;
  if (fs::is_directory(path, trouble)) {
    // A folder is a recording where it holds pictures and no video; then
    // ListFolder gives the folder itself.
    const auto found = ListFolder(path, {}).recordings;
    return !found.empty() && found.front() == path;
  }
  return fs::is_regular_file(path, trouble) && !IsHidden(path) &&
         (IsRecordingFile(path) ||
          (vision::IsImageName(path) && IsStack(path)));
}

bool IsBelow(const fs::path& path, const fs::path& folder) {
  const fs::path to = path.lexically_relative(folder);
  return !to.empty() && *to.begin() != "..";
}

std::vector<fs::path> ListCameraHeaders(const fs::path& recording) {
  std::vector<fs::path> headers;
  std::error_code trouble;
  for (const char* extension : {".cih", ".cihx", ".CIH", ".CIHX"}) {
    fs::path beside = recording;
    beside.replace_extension(extension);
    if (fs::exists(beside, trouble)) headers.push_back(std::move(beside));
  }
  return headers;
}

std::vector<fs::path> ListFiles(const fs::path& recording) {
  std::vector<fs::path> files;
  std::error_code trouble;
  if (fs::is_directory(recording, trouble)) {
    fs::directory_iterator entry(recording, trouble);
    for (; !trouble && entry != fs::directory_iterator();
         entry.increment(trouble)) {
      // All images count, also those that a stack beside them would set apart:
      // what is asked here is which files may still change.
      if (vision::IsImageName(entry->path())) files.push_back(entry->path());
    }
    return files;
  }
  // A Photron recording is two files. The header may come after the data, and
  // without it the data cannot be read.
  files.push_back(recording);
  if (LowerExtension(recording) == ".mraw") {
    for (fs::path& header : ListCameraHeaders(recording)) {
      files.push_back(std::move(header));
    }
  }
  return files;
}

Extent MeasureExtent(const fs::path& recording) {
  Extent extent;
  for (const fs::path& file : ListFiles(recording)) AddFile(file, extent);
  return extent;
}

std::vector<fs::path> Settling::Look(const Extents& there, Instant now) {
  std::vector<fs::path> complete;
  // Each call judges anew whether something is still waited for. Recordings
  // that have gone are forgotten, so that a file that comes back under the same
  // name is told as a new one.
  waiting_ = false;
  std::erase_if(seen_,
                [&](const auto& one) { return !there.contains(one.first); });
  for (const auto& [path, extent] : there) {
    auto [at, is_new] = seen_.try_emplace(path, Seen{extent, now, false});
    Seen& seen = at->second;
    // Growth starts the wait anew, also for a recording that was told already:
    // the session then logs the whole one in place of the half one.
    if (!is_new && seen.extent != extent) seen = {extent, now, false};
    if (seen.told) continue;
    if (now - seen.since >= quiet_) {
      seen.told = true;
      complete.push_back(path);
    } else {
      waiting_ = true;
    }
  }
  return complete;
}

void Watch(const fs::path& folder, const WatchOptions& options,
           const std::function<void(const std::vector<fs::path>&)>& take) {
  Settling settling(options.quiet);
  // The folder is looked through at least once, so that what was there before
  // the watch began is taken, too.
  do {
    Settling::Extents there;
    for (const fs::path& recording : FindRecordings(folder)) {
      there.emplace(recording, MeasureExtent(recording));
    }
    const auto complete = settling.Look(there, options.now());
    if (!complete.empty()) take(complete);
  } while (options.wait(settling.waiting()));
}

}  // namespace touchdown::pipeline
