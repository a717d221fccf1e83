// What need not be typed each time, as a person types it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/temporary_folder.h"

namespace touchdown {
namespace {

using ::testing::HasSubstr;
using testing::ReadAll;
using testing::TemporaryFolder;

class DefaultsCommand : public ::testing::Test {
 protected:
  struct Ran {
    int status = -1;
    std::string out;
    std::string err;
  };
  // `touchdown arguments` in the lab's folder; `before` sets variables.
  Ran Run(const std::string& arguments, const std::string& before = "") {
    const auto out = folder_.path() / "out";
    const auto err = folder_.path() / "err";
    const std::string command = "cd '" + lab_.string() + "' && " + before +
                                " " + TOUCHDOWN_BINARY + " " + arguments +
                                " >" + out.string() + " 2>" + err.string();
    const int status = std::system(command.c_str());  // NOLINT
    return {WEXITSTATUS(status), ReadAll(out), ReadAll(err)};
  }
  void SetUp() override {
    std::filesystem::create_directory(lab_);
    ASSERT_EQ(Run("import --paper-table1 --db lab.db").status, 0);
  }

  TemporaryFolder folder_;
  std::filesystem::path lab_ = folder_.path() / "lab";
};

TEST_F(DefaultsCommand, UseSaysWhatTheNextCommandsMean) {
  EXPECT_THAT(Run("boundary").err, HasSubstr("exactly one of"));
  const Ran used = Run("use lab.db paper-table1-sphere");
  ASSERT_EQ(used.status, 0) << used.err;
  EXPECT_THAT(used.out, HasSubstr("lab.db, campaign 'paper-table1-sphere'"));
  const Ran boundary = Run("boundary");
  EXPECT_EQ(boundary.status, 0) << boundary.err;
  EXPECT_THAT(boundary.out, HasSubstr("sphere"));
  EXPECT_EQ(boundary.out.find("rectangle"), std::string::npos);
  // A source on the line is the only one.
  const Ran paper = Run("boundary --paper-table1");
  EXPECT_EQ(paper.status, 0) << paper.err;
  EXPECT_THAT(paper.out, HasSubstr("rectangle"));
  const Ran all = Run("boundary --db lab.db");
  EXPECT_THAT(all.out, HasSubstr("rectangle"));
  const Ran other = Run("boundary --campaign paper-table1-rectangle");
  EXPECT_THAT(other.out, HasSubstr("rectangle"));
  EXPECT_EQ(Run("campaign list").status, 0);
}

TEST_F(DefaultsCommand, TheEnvironmentGoesBeforeTheFile) {
  ASSERT_EQ(Run("use lab.db paper-table1-sphere").status, 0);
  const Ran ran = Run("boundary", "TOUCHDOWN_DB=lab.db");
  EXPECT_EQ(ran.status, 0) << ran.err;
  // The file's campaign is of the file's store.
  EXPECT_THAT(ran.out, HasSubstr("rectangle"));
  EXPECT_THAT(Run("boundary", "TOUCHDOWN_DB=/none/x.db").err,
              HasSubstr("/none/x.db"));
}

TEST_F(DefaultsCommand, AMistakeIsOneLineThatSaysWhatWasMeant) {
  const Ran word = Run("reprot");
  EXPECT_EQ(word.status, 2);
  EXPECT_THAT(word.err, HasSubstr("there is no command 'reprot'; did you mean "
                                  "`touchdown report`?"));
  const Ran name = Run("use lab.db paper-table1-shere");
  EXPECT_EQ(name.status, 2);
  EXPECT_THAT(name.err, HasSubstr("did you mean 'paper-table1-sphere'?"));
  // Wherever a campaign is named.
  for (const char* command :
       {"campaign show paper-table1-shere --db lab.db",
        "list --campaign paper-table1-shere --db lab.db",
        "boundary --campaign paper-table1-shere --db lab.db",
        "export --campaign paper-table1-shere --db lab.db --format csv"}) {
    EXPECT_THAT(Run(command).err,
                HasSubstr("did you mean 'paper-table1-sphere'?"))
        << command;
  }
  EXPECT_FALSE(std::filesystem::exists(lab_ / "touchdown.toml"));
  std::ofstream(lab_ / "touchdown.toml") << "db = \"lab.db\"\nstore = 1\n";
  const Ran key = Run("boundary");
  EXPECT_EQ(key.status, 3);
  EXPECT_THAT(key.err, HasSubstr("touchdown.toml:2: store; expected db ="));
}

// It hinders only who needs it; `doctor` names it, and `use` mends it.
TEST_F(DefaultsCommand, ABrokenFileCanBeMended) {
  std::ofstream(lab_ / "touchdown.toml") << "db = lab.db\n";
  EXPECT_EQ(Run("boundary").status, 3);
  for (const char* command : {"--help", "--version", "boundary --help",
                              "boundary --db lab.db", "rig plan --help"}) {
    const Ran ran = Run(command);
    EXPECT_EQ(ran.status, 0) << command << ": " << ran.err;
  }
  const Ran doctor = Run("doctor");
  EXPECT_EQ(doctor.status, 3);
  EXPECT_THAT(doctor.out,
              HasSubstr("TROUBLE  defaults     touchdown.toml:1: "));
  EXPECT_EQ(Run("use lab.db paper-table1-sphere").status, 0);
  EXPECT_EQ(Run("boundary").status, 0);
  EXPECT_EQ(Run("doctor").out.find("defaults"), std::string::npos);
}

// What stands behind "--" is positional.
TEST_F(DefaultsCommand, DefaultsStandBeforePositionalArguments) {
  ASSERT_EQ(Run("use lab.db").status, 0);
  const Ran show = Run("campaign show -- paper-table1-sphere");
  EXPECT_EQ(show.status, 0) << show.err;
  EXPECT_THAT(show.out, HasSubstr("paper-table1-sphere"));
}

}  // namespace
}  // namespace touchdown
