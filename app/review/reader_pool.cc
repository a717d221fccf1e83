#include "app/review/reader_pool.h"

#include <algorithm>
#include <utility>

namespace touchdown::review {

ReaderPool::ReaderPool(std::size_t most, OpenClip open)
    : most_(std::max<std::size_t>(1, most)), open_(std::move(open)) {}

// A lease that was moved from gives nothing back.
ReaderPool::Lease::Lease(Lease&& other) noexcept
    : pool_(std::exchange(other.pool_, nullptr)), reader_(other.reader_) {}

ReaderPool::Lease::~Lease() {
  if (pool_ != nullptr) pool_->Return(reader_);
}

// Tries, until it succeeds: the recording's own reader if nobody uses it, or a
// new one in its place if the recording has changed; a new one if there is
// room; a new one in place of the idle one that was used longest ago. Waits
// where none of them can be done.
ReaderPool::Lease ReaderPool::Take(const ShownRecording& shown) {
  const pipeline::Extent extent = pipeline::MeasureExtent(shown.path);
  std::list<Lease::Reader> closing;  // outside the lock, after it
  std::unique_lock lock(guard_);
  for (;;) {
    const auto own =
        std::find_if(readers_.begin(), readers_.end(),
                     [&](const auto& reader) { return reader.shown == shown; });
    if (own != readers_.end() && !own->in_use && own->extent != extent) {
      closing.splice(closing.begin(), readers_, own);
      break;
    }
    if (own != readers_.end() && !own->in_use) {
      own->in_use = true;
      readers_.splice(readers_.begin(), readers_, own);
      return {*this, readers_.begin()};
    }
    if (own == readers_.end()) {
      if (readers_.size() < most_) break;
      const auto idle =
          std::find_if(readers_.rbegin(), readers_.rend(),
                       [](const auto& reader) { return !reader.in_use; });
      if (idle != readers_.rend()) {
        closing.splice(closing.begin(), readers_, std::next(idle).base());
        break;
      }
    }
    freed_.wait(lock);
  }
  // The place is taken first, so that nobody opens the same one or one more.
  readers_.push_front({shown, extent, nullptr});
  const auto reader = readers_.begin();
  lock.unlock();
  // Closing a decoder takes time, which others must not wait for.
  closing.clear();
  try {
    reader->clip = open_(shown);
  } catch (...) {
    lock.lock();
    // The place is given back; whoever waited for it tries to open it again.
    readers_.erase(reader);
    lock.unlock();
    freed_.notify_all();
    throw;
  }
  return {*this, reader};
}

// Gives a reader back. All are woken: which of them can go on depends on the
// recording that each waits for.
void ReaderPool::Return(std::list<Lease::Reader>::iterator reader) {
  {
    const std::lock_guard lock(guard_);
    reader->in_use = false;
  }
  freed_.notify_all();
}

}  // namespace touchdown::review
