#include "mapped_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& path, int error) {
  throw core::InputError(fmt::format("{}: {}", path.string(),
                                     std::generic_category().message(error)));
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) : path_(path) {
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) Fail(path, errno);
  struct stat status {};
  if (::fstat(file_, &status) != 0) {
    const int error = errno;
    ::close(file_);
    Fail(path, error);
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(file_);
    Fail(path, EISDIR);
  }
  size_bytes_ = status.st_size;
  if (size_bytes_ > 0) {
    void* const map = ::mmap(nullptr, static_cast<std::size_t>(size_bytes_),
                             PROT_READ, MAP_SHARED, file_, 0);
    const int error = errno;
    if (map == MAP_FAILED) {
      ::close(file_);
      Fail(path, error);
    }
    data_ = static_cast<const std::byte*>(map);
  }
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) {
    ::munmap(const_cast<std::byte*>(data_),
             static_cast<std::size_t>(size_bytes_));
  }
  ::close(file_);
}

void MappedFile::Copy(std::int64_t begin, std::int64_t end,
                      std::byte* to) const {
  while (begin < end) {
    const ssize_t got =
        ::pread(file_, to, static_cast<std::size_t>(end - begin), begin);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) Fail(path_, got < 0 ? errno : EIO);
    begin += got;
    to += got;
  }
}

void MappedFile::WillRead(std::int64_t begin, std::int64_t end) const {
#ifdef MADV_POPULATE_READ
  // A fault costs many times what a page costs that is got in advance, above
  // all on virtual machines. With one page the system maps those about it that
  // are in memory, in stretches of this size; to ask for each of them takes as
  // long again. An older kernel refuses; nothing is lost.
  constexpr std::uintptr_t kStretch = std::uintptr_t{64} << 10;
  static const std::int64_t page = ::sysconf(_SC_PAGESIZE);
  begin = std::max<std::int64_t>(begin, 0) / page * page;
  end = std::min(end, size_bytes_);
  const auto map = reinterpret_cast<std::uintptr_t>(data_);
  while (begin < end) {
    ::madvise(const_cast<std::byte*>(data_) + begin,
              static_cast<std::size_t>(page), MADV_POPULATE_READ);
    const std::uintptr_t at = map + static_cast<std::uintptr_t>(begin);
    begin += static_cast<std::int64_t>(kStretch - at % kStretch);
  }
#endif
}

void MappedFile::HasRead() const {
  if (data_ == nullptr) return;
  ::madvise(const_cast<std::byte*>(data_),
            static_cast<std::size_t>(size_bytes_), MADV_DONTNEED);
}

}  // namespace touchdown::vision
