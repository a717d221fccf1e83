#include "touchdown/core/unfinished.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace touchdown::core {
namespace {

namespace fs = std::filesystem;

void Touch(const fs::path& path) { std::ofstream(path) << "half"; }

// Whether a process of its own ends as it should: nothing may go on after
// RemoveUnfinished.
template <class Work>
bool DoneInAChild(const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Unfinished, GoesAndWhatIsFinishedStays) {
  const testing::TemporaryFolder folder;
  EXPECT_TRUE(DoneInAChild([&] {
    const Unfinished file(folder / "a.part");
    const Unfinished tree(folder / "b.part");
    const Unfinished nothing(folder / "c.part");
    {
      const Unfinished finished(folder / "d");
      Touch(folder / "d");
    }
    Touch(folder / "a.part");
    fs::create_directory(folder / "b.part");
    Touch(folder / "b.part" / "1.png");
    RemoveUnfinished();
  }));
  EXPECT_FALSE(fs::exists(folder / "a.part"));
  EXPECT_FALSE(fs::exists(folder / "b.part"));
  EXPECT_TRUE(fs::exists(folder / "d"));
}

TEST(Unfinished, WhatBelongsTogetherIsWaitedFor) {
  const testing::TemporaryFolder folder;
  EXPECT_TRUE(DoneInAChild([&] {
    std::atomic<bool> begun = false;
    std::thread writer([&] {
      const AllOrNothing together;
      const Unfinished inner(folder / "x.part");  // the same thread's own
      Touch(folder / "x");
      begun = true;
      begun.notify_all();
      Touch(folder / "y");
    });
    begun.wait(false);
    RemoveUnfinished();
    _exit(fs::exists(folder / "x") && fs::exists(folder / "y") ? 0 : 1);
  }));
}

}  // namespace
}  // namespace touchdown::core
