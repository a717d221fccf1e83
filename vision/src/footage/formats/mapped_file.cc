#include "footage/formats/mapped_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <mutex>
#include <system_error>

#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

[[noreturn]] void ThrowSystemError(const std::filesystem::path& path,
                                   int error) {
  throw core::InputError(fmt::format("{}: {}", path.string(),
                                     std::generic_category().message(error)));
}

// --- SIGBUS: a mapped file that becomes shorter -----------------------------

// What is mapped now, for the handler. A slot is free where `begin` is 0; it is
// filled before its memory can be touched, and freed after.
struct Slot {
  std::atomic<std::uintptr_t> begin = 0;
  std::atomic<std::uintptr_t> end = 0;
  std::atomic<std::atomic<bool>*> lost = nullptr;
};
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free &&
              std::atomic<std::atomic<bool>*>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free);

// Files that can be mapped at once. One recording has at most two, and there
// are fewer recordings open at once than cores. The handler may not allocate,
// hence a fixed number.
constexpr std::size_t kSlots = 1024;
std::array<Slot, kSlots> slots;
struct sigaction before_us = {};
std::atomic<std::uintptr_t> page_bytes = 0;

// A page of a mapped file that is no longer there raises SIGBUS. The handler
// maps zeros in its place, and notes that the file has lost a part: the reader
// then throws. Only functions that are safe in a signal handler are called.
void OnBusError(int signal, siginfo_t* info, void* context) {
  const auto at = reinterpret_cast<std::uintptr_t>(info->si_addr);
  for (Slot& slot : slots) {
    const std::uintptr_t begin = slot.begin.load();
    if (begin == 0 || at < begin || at >= slot.end.load()) continue;
    const std::uintptr_t page = page_bytes.load();
    const std::uintptr_t first = at / page * page;
    const int error = errno;
    // From here to the end: what is behind a lost page is lost, too.
    void* const zeros = ::mmap(
        reinterpret_cast<void*>(first), slot.end.load() - first, PROT_READ,
        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
    errno = error;
    if (zeros == MAP_FAILED) break;
    slot.lost.load()->store(true);
    return;  // and reads a zero
  }
  if ((before_us.sa_flags & SA_SIGINFO) != 0) {
    before_us.sa_sigaction(signal, info, context);
  } else if (before_us.sa_handler != SIG_DFL &&
             before_us.sa_handler != SIG_IGN) {
    before_us.sa_handler(signal);
  } else {
    // Again, without us.
    ::sigaction(signal, &before_us, nullptr);
  }
}

void CatchBusErrors() {
  static std::once_flag once;
  std::call_once(once, [] {
    page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    struct sigaction action = {};
    action.sa_sigaction = OnBusError;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
    sigemptyset(&action.sa_mask);
    ::sigaction(SIGBUS, &action, &before_us);
  });
}

// False where there is no slot left.
bool Enter(const void* data, std::int64_t size, std::atomic<bool>& lost) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  for (Slot& slot : slots) {
    if (slot.begin.load() != 0) continue;
    const auto begin = reinterpret_cast<std::uintptr_t>(data);
    slot.lost = &lost;
    slot.end = begin + static_cast<std::uintptr_t>(size);
    slot.begin = begin;
    return true;
  }
  return false;
}

void Leave(const void* data) {
  for (Slot& slot : slots) {
    if (slot.begin.load() == reinterpret_cast<std::uintptr_t>(data)) {
      slot.begin = 0;
      return;
    }
  }
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) : path_(path) {
  // O_NONBLOCK: of a FIFO nobody writes into.
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file_ < 0) ThrowSystemError(path, errno);
  struct stat status {};
  if (::fstat(file_, &status) != 0) {
    const int error = errno;
    ::close(file_);
    ThrowSystemError(path, error);
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(file_);
    if (S_ISDIR(status.st_mode)) ThrowSystemError(path, EISDIR);
    throw core::InputError(path.string() +
                           ": is no plain file; copy the recording to a disk");
  }
  size_bytes_ = status.st_size;
  if (size_bytes_ > 0) {
    void* const map = ::mmap(nullptr, static_cast<std::size_t>(size_bytes_),
                             PROT_READ, MAP_SHARED, file_, 0);
    const int error = errno;
    if (map == MAP_FAILED) {
      ::close(file_);
      ThrowSystemError(path, error);
    }
    data_ = static_cast<const std::byte*>(map);
    CatchBusErrors();
    if (!Enter(data_, size_bytes_, lost_)) {
      ::munmap(map, static_cast<std::size_t>(size_bytes_));
      ::close(file_);
      ThrowSystemError(path, EMFILE);
    }
  }
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) {
    Leave(data_);
    ::munmap(const_cast<std::byte*>(data_),
             static_cast<std::size_t>(size_bytes_));
  }
  ::close(file_);
}

void MappedFile::RequireWhole() const {
  struct stat status {};
  if (!lost_.load() && ::fstat(file_, &status) == 0 &&
      status.st_size >= size_bytes_) {
    return;
  }
  throw core::InputError(fmt::format(
      "{}: became shorter while it was read; wait until it is copied",
      path_.string()));
}

void MappedFile::Copy(std::int64_t begin, std::int64_t end,
                      std::byte* to) const {
  while (begin < end) {
    const ssize_t got =
        ::pread(file_, to, static_cast<std::size_t>(end - begin), begin);
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) RequireWhole();
    if (got <= 0) ThrowSystemError(path_, got < 0 ? errno : EIO);
    begin += got;
    to += got;
  }
}

void MappedFile::WillRead(std::int64_t begin, std::int64_t end) const {
#ifdef MADV_POPULATE_READ
  // Bytes. A fault costs many times what a page costs that is got in advance,
  // above all on virtual machines. With one page the system maps those about it
  // that are in memory, in stretches of this size; to ask for each of them
  // takes as long again. An older kernel refuses; nothing is lost.
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
