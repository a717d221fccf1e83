// Readers of recordings, as many as may be at one time: those in use count.
//
// A decoder of 1280 x 800 holds some 30 MB, so what bounds the server's memory
// is the number of readers. Each recording has one at most: requests for the
// same one wait for each other, and those for one recording more than there may
// be readers wait until one is free, which is then closed. One that has grown
// or was replaced is opened anew.
#pragma once

#include <compare>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "app/trials/recordings.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::review {

// A recording as it is looked at.
struct ShownRecording {
  std::filesystem::path path;
  // The frames, first and one past the last, that are shown as a camera that
  // stood still would have seen them (vision::PutBack); nothing: as recorded.
  std::optional<std::pair<std::int64_t, std::int64_t>> steady = {};
  friend auto operator<=>(const ShownRecording&,
                          const ShownRecording&) = default;
};

// Safe between threads.
class ReaderPool {
 public:
  using OpenClip =
      std::function<std::unique_ptr<vision::Clip>(const ShownRecording&)>;

  // `most` readers, at least 1; `open` makes one and throws where it cannot.
  ReaderPool(std::size_t most, OpenClip open);

  // A reader that nobody else uses until this goes.
  class Lease {
   public:
    ~Lease();
    Lease(Lease&& other) noexcept;
    Lease& operator=(Lease&&) = delete;
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;

    vision::Clip& clip() const { return *reader_->clip; }

   private:
    friend class ReaderPool;
    struct Reader {
      ShownRecording shown;
      pipeline::Extent extent;  // when it was opened
      std::unique_ptr<vision::Clip> clip;
      bool in_use = true;
    };
    Lease(ReaderPool& pool, std::list<Reader>::iterator reader)
        : pool_(&pool), reader_(reader) {}

    ReaderPool* pool_;
    std::list<Reader>::iterator reader_;
  };

  // Waits for the recording's reader, or for room for it. Throws what `open`
  // throws.
  Lease Take(const ShownRecording& shown);

 private:
  void Return(std::list<Lease::Reader>::iterator reader);

  const std::size_t most_;
  const OpenClip open_;
  std::mutex guard_;
  std::condition_variable freed_;
  std::list<Lease::Reader> readers_;  // the last used first
};

}  // namespace touchdown::review
