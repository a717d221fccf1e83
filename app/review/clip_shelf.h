// Frames of recordings as pictures for the page, quick to come and bounded in
// memory however many pages ask.
//
// Raw recordings are mapped into memory: a frame costs its encoding alone.
// Compressed ones depend on earlier frames, up to hundreds of them back, so
// from the first request on a thread decodes the recording once, beginning near
// what was asked for, and keeps the pictures; a frame that is not there yet is
// decoded from the nearest key frame.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "touchdown/vision/clip.h"

namespace touchdown::review {

struct ShelfOptions {
  // Encoded pictures kept, bytes. 128 MiB: some 500 frames of a compressed clip
  // of 1280 x 800, the whole of most shots.
  std::size_t most_bytes = std::size_t{128} << 20;
  // Recordings open at once. A decoder of 1280 x 800 holds some 30 MB; with six
  // of them and ten recordings looked at in turn the server held 364 MB.
  std::size_t most_open = 3;
};

struct Picture {
  std::string type;  // "image/png" or "image/jpeg"
  std::shared_ptr<const std::string> bytes;
};

// Safe between threads.
class ClipShelf {
 public:
  explicit ClipShelf(const ShelfOptions& options = {});
  ~ClipShelf();
  ClipShelf(const ClipShelf&) = delete;
  ClipShelf& operator=(const ClipShelf&) = delete;

  // Both throw like vision::OpenClip, Frame also like vision::Clip::Read.
  vision::ClipInfo Info(const std::filesystem::path& path);
  // PNG with the samples as recorded where the recording is raw, else JPEG.
  // Frames deeper than 8 bits are brought to 8, so that the brightest
  // thousandth of the first frame is white.
  Picture Frame(const std::filesystem::path& path, std::int64_t index);

  std::size_t bytes() const;  // of the pictures kept

 private:
  struct Open;
  using Key = std::pair<std::string, std::int64_t>;  // path and frame
  struct Kept {
    Picture picture;
    std::list<Key>::iterator place;
  };

  std::shared_ptr<Open> Get(const std::filesystem::path& path);
  std::optional<Picture> Find(const Key& key);
  void Keep(const Key& key, const Picture& picture);
  void WarmUp();

  const ShelfOptions options_;
  mutable std::mutex guard_;
  std::list<std::shared_ptr<Open>> open_;  // the last used first
  std::map<Key, Kept> kept_;
  std::list<Key> order_;  // the last used first
  std::size_t bytes_ = 0;

  std::condition_variable wake_;
  std::list<std::shared_ptr<Open>> to_warm_;  // the last asked for first
  bool ending_ = false;
  std::thread warmer_;
};

}  // namespace touchdown::review
