// A whole file in memory, read-only, without reading it: pages come in as they
// are touched, so that a clip may be larger than memory.
//
// Where another program shortens the file while it is mapped, the kernel raises
// SIGBUS in who touches the lost part. A handler of ours then puts zeros in its
// place and takes a note; what was measured meanwhile is worth nothing, and
// RequireWhole() says so. A SIGBUS of any other memory goes on to the handler
// that was there before.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace touchdown::vision {

class MappedFile {
 public:
  // Throws core::InputError if the file cannot be opened or mapped, or is no
  // plain file (a FIFO is not waited for).
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const std::byte* data() const { return data_; }
  std::int64_t size_bytes() const { return size_bytes_; }

  // Throws core::InputError where the file has become shorter since it was
  // mapped: bytes that were read before may be wrong.
  void RequireWhole() const;
  // The same, of what was touched so far: takes a nanosecond.
  void RequireNothingLost() const {
    if (lost_.load(std::memory_order_relaxed)) RequireWhole();
  }

  // Bytes [begin, end), which lie in the file, into `to`. Throws
  // core::InputError.
  void Copy(std::int64_t begin, std::int64_t end, std::byte* to) const;

  // A hint: bytes [begin, end) are going to be used.
  void WillRead(std::int64_t begin, std::int64_t end) const;
  // Gives the pages back, which takes a large file milliseconds.
  void HasRead() const;

 private:
  std::filesystem::path path_;
  int file_ = -1;
  const std::byte* data_ = nullptr;  // null if the file is empty
  std::int64_t size_bytes_ = 0;
  std::atomic<bool> lost_ = false;  // the handler's note
};

}  // namespace touchdown::vision
