#include "app/review/reader_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

struct Count {
  std::atomic<int> now = 0;
  std::atomic<int> most = 0;
  std::atomic<int> opened = 0;

  void Enter() {
    ++opened;
    const int here = ++now;
    int seen = most;
    while (here > seen && !most.compare_exchange_weak(seen, here)) {
    }
  }
};

// A recording without pictures that tells how many like it there are.
class CountedClip final : public vision::Clip {
 public:
  explicit CountedClip(Count& count) : count_(count) { count_.Enter(); }
  ~CountedClip() override { --count_.now; }
  const vision::ClipInfo& info() const override { return info_; }

  std::atomic<int> users = 0;

 protected:
  core::Frame ReadWindow(std::int64_t, const core::PixelRect&) override {
    return {};
  }

 private:
  Count& count_;
  vision::ClipInfo info_;
};

ReaderPool::OpenClip Counting(Count& count) {
  return [&count](const ShownRecording& shown) {
    if (shown.path == "damaged") throw core::InputError("damaged");
    return std::make_unique<CountedClip>(count);
  };
}

TEST(ReaderPool, HasNeverMoreReadersThanItMayHoweverManyAsk) {
  Count count;
  std::atomic<int> shared = 0;
  {
    ReaderPool pool(3, Counting(count));
    std::vector<std::jthread> people;
    for (int person = 0; person < 12; ++person) {
      people.emplace_back([&, person] {
        for (int n = 0; n < 200; ++n) {
          const auto lease = pool.Take({std::to_string((person + n) % 7)});
          auto& clip = dynamic_cast<CountedClip&>(lease.clip());
          if (++clip.users > 1) ++shared;
          std::this_thread::yield();
          --clip.users;
        }
      });
    }
    people.clear();
    EXPECT_LE(count.now, 3);
  }
  EXPECT_EQ(count.most, 3);
  EXPECT_EQ(shared, 0);  // one at a time
  EXPECT_EQ(count.now, 0);
}

TEST(ReaderPool, ClosesWhatWasNotUsedForLongest) {
  Count count;
  ReaderPool pool(2, Counting(count));
  pool.Take({"a"});
  pool.Take({"b"});
  pool.Take({"a"});
  EXPECT_EQ(count.opened, 2);
  pool.Take({"c"});  // in the place of b
  pool.Take({"a"});
  EXPECT_EQ(count.opened, 3);
  pool.Take({"b"});
  EXPECT_EQ(count.opened, 4);
  EXPECT_EQ(count.now, 2);
}

TEST(ReaderPool, KeepsNoPlaceForWhatCannotBeOpened) {
  Count count;
  ReaderPool pool(1, Counting(count));
  EXPECT_THROW(pool.Take({"damaged"}), core::InputError);
  EXPECT_THROW(pool.Take({"damaged"}), core::InputError);
  pool.Take({"a"});  // would wait for ever
  EXPECT_EQ(count.now, 1);
}

}  // namespace
}  // namespace touchdown::review
