#include "footage/apart/frame_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>

#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Bytes. The first page holds the counter that tells that work goes on; frames
// follow.
constexpr std::size_t kPage = 4096;
// Bytes to which pieces are aligned: what the widest vector instructions want.
constexpr std::size_t kPieceAlign = 64;
// Bytes that a process with little address space (`ulimit -v`) is still given;
// below it reading fails with a message. Not studied.
constexpr std::size_t kMinMemory = std::size_t{32} << 20;

std::size_t RoundUp(std::size_t bytes, std::size_t to) {
  return (bytes + to - 1) / to * to;
}

}  // namespace

FrameMemory::FrameMemory(std::size_t most_bytes)
    : descriptor_(memfd_create("frames", MFD_CLOEXEC | MFD_ALLOW_SEALING)),
      most_bytes_(most_bytes) {
  // Address space is taken once and for all, memory as it is used; where the
  // process may not have so much, half of it is tried.
  void* mapped = MAP_FAILED;
  while (descriptor_ >= 0 && mapped == MAP_FAILED &&
         most_bytes_ >= kMinMemory) {
    mapped = mmap(nullptr, most_bytes_, PROT_READ | PROT_WRITE,
                  MAP_SHARED | MAP_NORESERVE, descriptor_, 0);
    if (mapped == MAP_FAILED) most_bytes_ /= 2;
  }
  if (mapped == MAP_FAILED) {
    throw core::InputError("no memory for frames; raise `ulimit -v`");
  }
  data_ = static_cast<std::byte*>(mapped);
  // The seal promises the other side that the memory cannot shrink under it,
  // which would raise SIGBUS there.
  fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK);
  if (!Enlarge(kPage)) {
    throw core::InputError(
        "no memory for frames; raise `ulimit -v` and `ulimit -f`");
  }
  used_bytes_ = kPage;
}

FrameMemory::~FrameMemory() {
  if (data_ != nullptr) munmap(data_, most_bytes_);
  if (descriptor_ >= 0) close(descriptor_);
}

bool FrameMemory::Enlarge(std::size_t bytes) {
  if (bytes > most_bytes_) return false;
  if (bytes <= file_bytes_) return true;
  if (ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) return false;
  file_bytes_ = bytes;
  return true;
}

std::byte* FrameMemory::Take(std::size_t bytes) {
  Beat();
  // Pieces are never returned to the system: a recording's frames are of one
  // size and use the same pieces again.
  const std::size_t wanted =
      RoundUp(std::max<std::size_t>(bytes, 1), kPieceAlign);
  const std::lock_guard lock(mutex_);
  // Frames of a recording are of one size, so pieces are used as they are; one
  // much larger than what is wanted is left for its like.
  for (Piece& piece : pieces_) {
    if (!piece.taken && piece.bytes >= wanted && piece.bytes / 2 <= wanted) {
      piece.taken = true;
      return data_ + piece.offset;
    }
  }
  if (wanted > most_bytes_ || !Enlarge(used_bytes_ + wanted)) return nullptr;
  pieces_.push_back({used_bytes_, wanted, true});
  used_bytes_ += wanted;
  return data_ + pieces_.back().offset;
}

void FrameMemory::Give(const std::byte* piece) {
  const std::lock_guard lock(mutex_);
  for (Piece& each : pieces_) {
    if (data_ + each.offset == piece) each.taken = false;
  }
}

std::optional<std::size_t> FrameMemory::FindOffset(
    const std::byte* data) const {
  if (data < data_ || data >= data_ + most_bytes_) return std::nullopt;
  return static_cast<std::size_t>(data - data_);
}

FrameMemoryView::FrameMemoryView(int descriptor) : descriptor_(descriptor) {
  const int seals = fcntl(descriptor_, F_GET_SEALS);
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0 || !MapBytes(kPage)) {
    close(descriptor_);
    throw core::InputError("a reader offers memory that it could take back");
  }
}

FrameMemoryView::~FrameMemoryView() {
  munmap(const_cast<std::byte*>(data_), mapped_bytes_);
  close(descriptor_);
}

bool FrameMemoryView::MapBytes(std::size_t bytes) {
  struct stat about = {};
  if (fstat(descriptor_, &about) != 0 ||
      bytes > static_cast<std::size_t>(about.st_size)) {
    return false;
  }
  // All that is there now: it grows a few times while the first frames come.
  const auto all = static_cast<std::size_t>(about.st_size);
  void* const mapped =
      mmap(nullptr, all, PROT_READ, MAP_SHARED, descriptor_, 0);
  if (mapped == MAP_FAILED) return false;
  if (data_ != nullptr) munmap(const_cast<std::byte*>(data_), mapped_bytes_);
  data_ = static_cast<const std::byte*>(mapped);
  mapped_bytes_ = all;
  return true;
}

// Null where the offset lies beyond the memory: the reader's numbers are not
// believed.
const std::byte* FrameMemoryView::At(std::size_t offset, std::size_t bytes) {
  // The sum overflows.
  if (offset > offset + bytes) return nullptr;
  if (offset + bytes > mapped_bytes_ && !MapBytes(offset + bytes))
    return nullptr;
  return data_ + offset;
}

std::uint64_t FrameMemoryView::beats() const {
  return reinterpret_cast<const std::atomic<std::uint64_t>*>(data_)->load(
      std::memory_order_relaxed);
}

}  // namespace touchdown::vision
