// Memory that a reader shares with who looks at its frames: decoders write into
// it, so that no frame is copied. It can grow and never shrinks (sealed), so
// that who maps it cannot be hurt by the reader.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

namespace touchdown::vision {

class FrameMemory {
 public:
  // Of at most `most_bytes`; pages are got as they are used. Throws
  // core::InputError where the kernel gives none.
  explicit FrameMemory(std::size_t most_bytes);
  ~FrameMemory();
  FrameMemory(const FrameMemory&) = delete;
  FrameMemory& operator=(const FrameMemory&) = delete;

  // A piece for a frame, aligned for any processor; null where all is taken.
  // From any thread.
  std::byte* Take(std::size_t bytes);
  void Give(const std::byte* piece);

  // Where in the memory `data` lies; nothing where it lies elsewhere.
  std::optional<std::size_t> FindOffset(const std::byte* data) const;
  int descriptor() const { return descriptor_; }

  // Says that work goes on; from any thread.
  void Beat() const { beats().fetch_add(1, std::memory_order_relaxed); }

 private:
  struct Piece {
    std::size_t offset = 0;
    std::size_t bytes = 0;
    bool taken = false;
  };

  std::atomic<std::uint64_t>& beats() const {
    return *reinterpret_cast<std::atomic<std::uint64_t>*>(data_);
  }
  bool Enlarge(std::size_t bytes);

  int descriptor_ = -1;
  std::byte* data_ = nullptr;
  std::size_t most_bytes_ = 0;
  std::size_t file_bytes_ = 0;  // of the memory's file so far
  std::size_t used_bytes_ = 0;  // given out at some time
  std::mutex mutex_;
  std::vector<Piece> pieces_;
};

// The same memory, as the other side sees it: read only.
class FrameMemoryView {
 public:
  // Takes `descriptor` over. Throws core::InputError unless it is memory that
  // cannot shrink.
  explicit FrameMemoryView(int descriptor);
  ~FrameMemoryView();
  FrameMemoryView(const FrameMemoryView&) = delete;
  FrameMemoryView& operator=(const FrameMemoryView&) = delete;

  // Bytes [offset, offset + bytes), valid until the next At; null where they do
  // not lie in the memory.
  const std::byte* At(std::size_t offset, std::size_t bytes);
  std::uint64_t beats() const;
  int descriptor() const { return descriptor_; }

 private:
  bool MapBytes(std::size_t bytes);

  int descriptor_ = -1;
  const std::byte* data_ = nullptr;
  std::size_t mapped_bytes_ = 0;
};

}  // namespace touchdown::vision
