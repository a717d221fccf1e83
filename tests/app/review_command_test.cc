// touchdown review: how the browser learns the key.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/local_socket.h"
#include "tests/support/run_program.h"
#include "tests/support/running_program.h"
#include "tests/support/temporary_folder.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;

// Sets a variable of the environment for one test.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* const before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Environment() {
    if (before_.empty()) {
      unsetenv(name_);
    } else {
      setenv(name_, before_.c_str(), 1);
    }
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::string before_;
};

// A lab whose desktop's opener says what it was given, then that it is done.
class ReviewCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(testing::RunProgram("campaign new c --db " + db_ +
                                  " --body sphere --diameter-mm 40 --surface s")
                  .status,
              0);
    fs::create_directories(run_);
    fs::create_directories(folder_ / "bin");
    ASSERT_EQ(mkfifo((folder_ / "said").c_str(), 0600), 0);
    const fs::path opener = folder_.Write(
        "bin/xdg-open",
        "#!/bin/sh\n{ echo \"$*\"; stat -c %a \"$1\"; cat \"$1\"; } > " +
            (folder_ / "said").string() + "\n");
    fs::permissions(opener, fs::perms::owner_all);
  }
  // What the opener was told; waits for it.
  std::string Said() const { return testing::ReadAll(folder_ / "said"); }

  const testing::TemporaryFolder folder_;
  const std::string db_ = folder_ / "lab.db";
  const fs::path run_ = folder_ / "run";
  const Environment path_{
      "PATH", (folder_ / "bin").string() + ":" + std::getenv("PATH")};
  const Environment own_{"XDG_RUNTIME_DIR", run_.string()};
  const Environment desktop_{"DISPLAY", ":0"};
};

// Returns the key of the page's address.
std::string KeyOf(const std::string& address) {
  const std::string key = address.substr(address.find("token=") + 6);
  return key.substr(0, key.find('\n'));
}

// Returns whether the process has the file open.
bool HasOpen(pid_t process, const fs::path& file) {
  std::error_code ignored;  // of what is closed meanwhile
  for (const auto& entry : fs::directory_iterator(
           "/proc/" + std::to_string(process) + "/fd", ignored)) {
    if (fs::read_symlink(entry, ignored) == file) return true;
  }
  return false;
}

TEST_F(ReviewCommand, TellsTheBrowserTheKeyByAFileOfItsOwn) {
  testing::RunningProgram program({TOUCHDOWN_BINARY, "review", "--db", db_});
  std::string address = program.Line();
  ASSERT_TRUE(address.ends_with("\n"));
  address.pop_back();
  const std::string key = KeyOf(address);
  ASSERT_GE(key.size(), 32u);
  const std::string said = Said();
  const std::string arguments = said.substr(0, said.find('\n'));
  EXPECT_EQ(arguments.find(key), std::string::npos) << said;
  EXPECT_EQ(fs::path(arguments).parent_path(), run_);
  EXPECT_NE(said.find("\n600\n"), std::string::npos) << said;
  EXPECT_NE(said.find(address), std::string::npos) << said;
  EXPECT_TRUE(fs::exists(arguments));
  EXPECT_EQ(program.End(SIGTERM), 0);
  EXPECT_FALSE(fs::exists(arguments));
}

// A request that waits for the store, longer than a signal does.
TEST_F(ReviewCommand, LeavesNoKeyWhereASignalCutsARequestOff) {
  testing::RunningProgram program({TOUCHDOWN_BINARY, "review", "--db", db_});
  const std::string address = program.Line();
  ASSERT_NE(Said(), "");
  EXPECT_FALSE(fs::is_empty(run_));
  const int port = std::atoi(
      address.substr(address.find("127.0.0.1:") + 10).c_str());  // NOLINT
  const int store = open(db_.c_str(), O_RDWR | O_CLOEXEC);
  struct flock whole = {};
  whole.l_type = F_WRLCK;
  ASSERT_EQ(fcntl(store, F_SETLK, &whole), 0);
  const std::string body = R"({"campaign": "c", "who": "Ada", "angle_deg": "20",
      "angle_u_deg": "0.5", "state": "bounce"})";
  const testing::LocalSocket socket(port);
  ASSERT_TRUE(socket.Send(
      "POST /api/log HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
      "\r\nContent-Type: application/json\r\nX-Touchdown-Token: " +
      KeyOf(address) + "\r\nContent-Length: " + std::to_string(body.size()) +
      "\r\n\r\n" + body));
  while (!HasOpen(program.pid(), db_)) sched_yield();
  EXPECT_EQ(program.End(SIGTERM), 128 + SIGTERM);
  EXPECT_TRUE(fs::is_empty(run_));
  close(store);
}

}  // namespace
}  // namespace touchdown::cli
