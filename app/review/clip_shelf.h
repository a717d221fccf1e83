// Frames of recordings as pictures for the page, quick to come and bounded in
// memory however many pages ask.
//
// Raw recordings are mapped into memory: a frame costs its encoding alone.
// Compressed ones depend on earlier frames, up to hundreds of them back, so
// from the first request on a thread decodes the recording once, beginning near
// what was asked for, and keeps the pictures; a frame that is not there yet is
// decoded from the nearest key frame.
//
// A recording that has grown or was replaced, by its size or its date, is
// opened anew.
//
// Memory: the pictures kept, most_open readers, and one more of the thread.
#pragma once

#include <compare>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "app/review/reader_pool.h"
#include "app/trials/recordings.h"
#include "touchdown/vision/background/steady_camera.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::review {

struct ShelfOptions {
  // Encoded pictures kept, bytes. 128 MiB: some 500 frames of a compressed clip
  // of 1280 x 800, the whole of most shots.
  std::size_t most_bytes = std::size_t{128} << 20;
  // Recordings open at once, in use or not. A decoder of 1280 x 800 holds some
  // 30 MB. With fewer of them than pages that step through recordings of their
  // own, each step opens its recording again until it has been decoded.
  std::size_t most_open = 6;
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
  vision::ClipInfo Info(const ShownRecording& shown);
  // PNG with the samples as recorded where the recording is raw, else JPEG.
  // Frames deeper than 8 bits are brought to 8, so that the brightest
  // thousandth of the first frame is white.
  Picture Frame(const ShownRecording& shown, std::int64_t index);

  // JPEG of a part of a frame (thumbnail.h). Not kept, and the recording is not
  // decoded ahead for it.
  Picture Small(const ShownRecording& shown, std::int64_t index,
                core::PixelPoint centre, double width_px);

  std::size_t bytes() const;  // of the pictures kept

 private:
  // A recording as it is now: one that grows or is replaced becomes another.
  struct Film {
    ShownRecording shown;
    pipeline::Extent extent;
    friend auto operator<=>(const Film&, const Film&) = default;
  };
  using Key = std::pair<Film, std::int64_t>;  // and the frame
  struct Kept {
    Picture picture;
    std::list<Key>::iterator place;
  };
  // What stays known of a recording when its reader is closed.
  struct Known {
    vision::ClipInfo info;
    std::uint32_t white = 255;  // the level that is shown as white
  };
  // A compressed recording that was asked for.
  struct Asked {
    Film film;
    std::int64_t from = 0;  // the frame asked for first
    bool taken = false;     // the thread has begun with it
  };

  std::unique_ptr<vision::Clip> Open(const ShownRecording& shown);
  static Film DescribeFilm(const ShownRecording& shown);
  std::optional<Known> Recall(const Film& film) const;
  Known Learn(const Film& film, vision::Clip& clip);
  void Ask(const Film& film, std::int64_t index);
  bool IsAsked(const Film& film) const;
  std::optional<Picture> Find(const Key& key);
  void Keep(const Key& key, const Picture& picture);
  void WarmUp();
  void Decode(const Asked& asked);

  const ShelfOptions options_;
  ReaderPool readers_;
  mutable std::mutex guard_;
  std::map<Film, Known> known_;
  std::map<Film, vision::CameraMotion> motions_;  // of those shown steady
  std::map<Key, Kept> kept_;
  std::list<Key> order_;  // the last used first
  std::size_t bytes_ = 0;

  std::condition_variable wake_;
  std::list<Asked> asked_;  // the last asked for first, most_open of them
  bool ending_ = false;
  std::thread warmer_;
};

}  // namespace touchdown::review
