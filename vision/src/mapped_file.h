// A whole file in memory, read-only, without reading it: pages come in as they
// are touched, so that a clip may be larger than memory.
//
// A file that another program shortens while it is mapped ends this program
// (SIGBUS) when the lost part is touched: recordings are not edited in place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace touchdown::vision {

class MappedFile {
 public:
  // Throws core::InputError if the file cannot be opened or mapped.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const std::byte* data() const { return data_; }
  std::int64_t size_bytes() const { return size_bytes_; }

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
};

}  // namespace touchdown::vision
