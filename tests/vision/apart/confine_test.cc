// What a confined process cannot do, tried in one.
#include "footage/apart/confine.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <string>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace touchdown::vision {
namespace {

constexpr int kRefused = 77;  // the kernel has no such thing

// The exit status of a process that does this.
int StatusOf(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

bool IsRefused(long result, int error) { return result < 0 && errno == error; }

TEST(ConfineToFile, LeavesOneFile) {
  const testing::TemporaryFolder folder;
  const std::string one = folder.Write("one", "1");
  const std::string two = folder.Write("two", "2");
  const int status = StatusOf([&] {
    if (!ConfineToFile(one).empty()) return kRefused;
    if (open(one.c_str(), O_RDONLY) < 0) return 1;
    if (!IsRefused(open(two.c_str(), O_RDONLY), EACCES)) return 2;
    if (!IsRefused(open(one.c_str(), O_WRONLY), EACCES)) return 3;
    if (!IsRefused(unlink(two.c_str()), EACCES)) return 4;
    if (!IsRefused(open("/etc/passwd", O_RDONLY), EACCES)) return 5;
    return 0;
  });
  if (status == kRefused) GTEST_SKIP() << "this kernel has no Landlock";
  EXPECT_EQ(status, 0);
}

TEST(ConfineCalls, LeavesWhatAReaderNeeds) {
  const testing::TemporaryFolder folder;
  const std::string file = folder.Write("file", "1");
  const int status = StatusOf([&] {
    if (!ConfineCalls().empty()) return kRefused;
    if (open(file.c_str(), O_RDONLY) < 0) return 1;
    bool ran = false;
    std::thread([&ran] { ran = true; }).join();
    if (!ran) return 2;
    int pair[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, pair) != 0) return 3;
    if (!IsRefused(open(file.c_str(), O_WRONLY), EPERM)) return 4;
    if (!IsRefused(open((file + "x").c_str(), O_CREAT | O_WRONLY, 0600),
                   EPERM)) {
      return 5;
    }
    if (!IsRefused(socket(AF_INET, SOCK_STREAM, 0), EPERM)) return 6;
    if (!IsRefused(socket(AF_UNIX, SOCK_STREAM, 0), EPERM)) return 7;
    if (!IsRefused(fork(), EPERM)) return 8;
    if (!IsRefused(execl("/bin/true", "true", nullptr), EPERM)) return 9;
    if (!IsRefused(kill(getppid(), 0), EPERM)) return 10;
    if (!IsRefused(unlink(file.c_str()), EPERM)) return 11;
    return 0;
  });
  if (status == kRefused) GTEST_SKIP() << "this kernel has no seccomp";
  EXPECT_EQ(status, 0);
}

TEST(ConfineCalls, LetsAnAbortBeSeen) {
  const int status = StatusOf([] {
    if (!ConfineCalls().empty()) return kRefused;
    abort();
  });
  if (status == kRefused) GTEST_SKIP() << "this kernel has no seccomp";
  EXPECT_EQ(status, -SIGABRT);
}

}  // namespace
}  // namespace touchdown::vision
