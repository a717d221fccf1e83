// Which recordings lie in a folder, and which of them are complete.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <vector>

namespace touchdown::pipeline {

// Every recording in `folder` and below it, in the order of their paths: videos
// by their extension, .mraw files, TIFFs of several pages (where the first
// picture of their folder is one), folders of images. Left out are hidden files
// and folders, symbolic links to folders, and folders of evidence (they hold an
// analysis.json, or are a store's, lab.db.evidence), and files that `admit`
// (empty: all pass) does not let pass: they are not opened. Throws
// core::InputError if the folder cannot be read.
using Admit = std::function<bool(const std::filesystem::path& file)>;
std::vector<std::filesystem::path> FindRecordings(
    const std::filesystem::path& folder, const Admit& admit = {});

// Whether FindRecordings takes what lies at `path`: it need not be complete,
// nor one that can be read.
bool IsRecording(const std::filesystem::path& path);

// Whether `path` is `folder` or lies in it or deeper, by names alone: both must
// be absolute and normal, or canonical where links are to be followed.
bool IsBelow(const std::filesystem::path& path,
             const std::filesystem::path& folder);

// The camera's headers beside a recording, .cih and .cihx in either spelling.
std::vector<std::filesystem::path> ListCameraHeaders(
    const std::filesystem::path& recording);

// The files that a recording is read from: itself, the header beside an .mraw
// file, the images of a folder.
std::vector<std::filesystem::path> ListFiles(
    const std::filesystem::path& recording);

// How large a recording is (all its files together) and when it was last
// written to.
struct Extent {
  std::int64_t files = 0;
  std::uintmax_t bytes = 0;
  // Of no file: before all others.
  std::filesystem::file_time_type written =
      std::filesystem::file_time_type::min();

  friend auto operator<=>(const Extent&, const Extent&) = default;
};

// How far the clocks of two machines may be apart that are set by the same
// network: they agree to seconds. Smaller calls a camera's clock ahead that is
// not, larger misses one that is. Not studied.
inline constexpr std::chrono::minutes kClocksAgree{2};

// Of a recording that may be growing, or vanish, at this moment: what cannot be
// seen counts nothing.
Extent MeasureExtent(const std::filesystem::path& recording);

// Tells when recordings have stopped growing: a recording is complete when its
// extent has stayed the same for `quiet`. One that changes after it was told is
// told again.
class Settling {
 public:
  using Instant = std::chrono::steady_clock::time_point;
  using Extents = std::map<std::filesystem::path, Extent>;

  // The default: cameras and copying programs write at least once a second; a
  // recording taken too early is refused or cut short, and is taken again when
  // it has grown, so that a short wait costs an analysis and no answer.
  static constexpr std::chrono::milliseconds kQuiet{2000};

  explicit Settling(std::chrono::milliseconds quiet = kQuiet) : quiet_(quiet) {}

  // What is there at the instant `now`; returns what has become complete.
  std::vector<std::filesystem::path> Look(const Extents& there, Instant now);

  // Whether anything is still waited for.
  bool waiting() const { return waiting_; }

 private:
  struct Seen {
    Extent extent;
    Instant since;
    bool told = false;
  };
  std::chrono::milliseconds quiet_;
  std::map<std::filesystem::path, Seen> seen_;
  bool waiting_ = false;
};

// Takes every recording of `folder` once it is complete, until `wait` says that
// it is enough. `take` gets them in the order of their paths, never none.
// Throws core::InputError if the folder cannot be read.
struct WatchOptions {
  std::chrono::milliseconds quiet = Settling::kQuiet;
  std::function<Settling::Instant()> now;
  // Waits until something may have changed; `growing`: at least one recording
  // was not complete when it was looked at. False: end.
  std::function<bool(bool growing)> wait;
};
void Watch(
    const std::filesystem::path& folder, const WatchOptions& options,
    const std::function<void(const std::vector<std::filesystem::path>&)>& take);

}  // namespace touchdown::pipeline
