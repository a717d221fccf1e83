// touchdown review: how the browser learns the key.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

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

TEST(ReviewCommand, TellsTheBrowserTheKeyByAFileOfItsOwn) {
  const testing::TemporaryFolder folder;
  const std::string db = folder / "lab.db";
  ASSERT_EQ(testing::RunProgram("campaign new c --db " + db +
                                " --body sphere --diameter-mm 40 --surface s")
                .status,
            0);
  const fs::path run = folder / "run";
  fs::create_directories(run);
  // A desktop's opener: says what it was given, then that it is done.
  fs::create_directories(folder / "bin");
  ASSERT_EQ(mkfifo((folder / "said").c_str(), 0600), 0);
  const fs::path opener =
      folder.Write("bin/xdg-open",
                   "#!/bin/sh\n{ echo \"$*\"; stat -c %a \"$1\"; cat \"$1\";"
                   " } > " +
                       (folder / "said").string() + "\n");
  fs::permissions(opener, fs::perms::owner_all);
  const Environment path("PATH",
                         (folder / "bin").string() + ":" + std::getenv("PATH"));
  const Environment own("XDG_RUNTIME_DIR", run.string());
  const Environment desktop("DISPLAY", ":0");
  testing::RunningProgram program({TOUCHDOWN_BINARY, "review", "--db", db});
  std::string address = program.Line();
  ASSERT_TRUE(address.ends_with("\n"));
  address.pop_back();
  const std::string key = address.substr(address.find("token=") + 6);
  ASSERT_GE(key.size(), 32u);
  const std::string said = testing::ReadAll(folder / "said");
  const std::string arguments = said.substr(0, said.find('\n'));
  EXPECT_EQ(arguments.find(key), std::string::npos) << said;
  EXPECT_EQ(fs::path(arguments).parent_path(), run);
  EXPECT_NE(said.find("\n600\n"), std::string::npos) << said;
  EXPECT_NE(said.find(address), std::string::npos) << said;
  EXPECT_TRUE(fs::exists(arguments));
  EXPECT_EQ(program.End(SIGTERM), 0);
  EXPECT_FALSE(fs::exists(arguments));
}

}  // namespace
}  // namespace touchdown::cli
