#include "touchdown/core/parallel.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
#include <vector>

namespace touchdown::core {
namespace {

// Property: each item is worked on once, whatever the threads and their items.
TEST(Parallel, WorksOnEachItemOnce) {
  for (const int threads : {0, 1, 2, 7}) {
    for (const std::int64_t count : {0, 1, 5, 100}) {
      std::vector<int> worked(static_cast<std::size_t>(count), 0);
      InParallel(count, threads, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = begin; i < end; ++i) {
          ++worked[static_cast<std::size_t>(i)];
        }
      });
      EXPECT_EQ(worked, std::vector<int>(worked.size(), 1));
    }
  }
}

TEST(Parallel, ThrowsWhatTheFirstFailingPartThrows) {
  EXPECT_THROW(InParallel(4, 4,
                          [](std::int64_t begin, std::int64_t) {
                            if (begin == 3) throw std::logic_error("last");
                            if (begin == 1) throw std::out_of_range("first");
                          }),
               std::out_of_range);
}

}  // namespace
}  // namespace touchdown::core
