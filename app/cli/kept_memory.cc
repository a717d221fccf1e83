#include "app/cli/kept_memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace touchdown::cli {

// Only glibc on Linux has these knobs; elsewhere the function does nothing and
// the program runs as well, a little slower.
void KeepMemory() {
#if defined(__GLIBC__) && defined(MADV_HUGEPAGE)
  constexpr int kMiB = 1 << 20;
  // A still picture of a camera of some Mpx stays below; what is larger is
  // asked of the system, and returned to it.
  constexpr int kLargest = 32 * kMiB;
  // What analyze of such a clip needs, and a little more; the heap grows by as
  // much again.
  constexpr int kRoom = 16 * kMiB;
  // Blocks up to kLargest come from the heap, which keeps that much of freed
  // memory at its end and grows by kRoom at a time.
  ::mallopt(M_MMAP_THRESHOLD, kLargest);
  ::mallopt(M_TRIM_THRESHOLD, kLargest);
  ::mallopt(M_TOP_PAD, kRoom);
  // Returns where the heap ends at this moment.
  const auto end = [] { return reinterpret_cast<std::uintptr_t>(::sbrk(0)); };
  const std::uintptr_t before = end();
  // One block makes the heap grow by kRoom; the part between its old and its
  // new end is then asked to be on large pages. Volatile: compilers leave out a
  // block that is freed unused.
  void* const volatile some = std::malloc(kMiB);
  std::free(some);
  // madvise() wants whole pages: the first that begins and the last that ends
  // within the new part, 2 MiB each as on x86-64.
  constexpr std::uintptr_t kLargePage = std::uintptr_t{2} << 20;
  const std::uintptr_t from =
      (before + kLargePage - 1) / kLargePage * kLargePage;
  const std::uintptr_t to = end() / kLargePage * kLargePage;
  if (from < to) {
    ::madvise(reinterpret_cast<void*>(from),  // NOLINT: an address
              to - from, MADV_HUGEPAGE);
  }
#endif
}

}  // namespace touchdown::cli
