// --verbose and --log: what the program says of what it does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "tests/pipeline/film_file.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace touchdown::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

constexpr const char* kAnalyze = "analyze --diameter-mm 24 ";

class Journal : public ::testing::Test {
 protected:
  Journal() { pipeline::filmed::WriteSphere(clip_, 25.0, 1); }

  const testing::TemporaryFolder folder_;
  const std::filesystem::path clip_ = folder_ / "shot.mraw";
};

TEST_F(Journal, IsQuietByDefault) {
  const auto ran = testing::RunProgram(kAnalyze + clip_.string());
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.err, "");
}

TEST_F(Journal, SaysStagesTimesAndReasonsOnStderr) {
  const auto ran =
      testing::RunProgram("--verbose " + (kAnalyze + clip_.string()));
  EXPECT_EQ(ran.status, 0);
  EXPECT_THAT(ran.err,
              AllOf(HasSubstr("read in this process"), HasSubstr("opened in "),
                    HasSubstr("mraw"), HasSubstr("used: static background"),
                    HasSubstr("left out: lens distortion, because: "),
                    HasSubstr("state: bounce, because: "),
                    HasSubstr("times: decoding ")));
  EXPECT_THAT(ran.out, Not(HasSubstr("left out: lens distortion, because")));
}

TEST_F(Journal, SaysAStageWhenItBegins) {
  const auto ran =
      testing::RunProgram("--verbose " + (kAnalyze + clip_.string()));
  std::size_t last = 0;
  for (const char* line :
       {"shot.mraw: read in this process", "shot.mraw: the clip is decoded, ",
        "shot.mraw: the body is looked for, ",
        "shot.mraw: outlines are fitted, ",
        "shot.mraw: the ground is looked for, ",
        "shot.mraw: the answer is checked, ", "opened in "}) {
    const std::size_t here = ran.err.find(line, last);
    ASSERT_NE(here, std::string::npos) << line << "\n" << ran.err;
    last = here;
  }
}

TEST_F(Journal, SaysAStageOfWhatIsNeverDone) {
  const auto ran = testing::RunProgram(kAnalyze + clip_.string() +
                                       " --verbose --limit-s 0.000001");
  EXPECT_EQ(ran.status, 3);
  EXPECT_THAT(ran.err,
              HasSubstr("shot.mraw: light and camera are looked at, from "));
}

TEST_F(Journal, GoesIntoAFileWithInstants) {
  const auto log = folder_ / "touchdown.log";
  const auto ran =
      testing::RunProgram(kAnalyze + clip_.string() + " --log " + log.string());
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.err, "");
  const std::string text = testing::ReadAll(log);
  EXPECT_THAT(text, HasSubstr("opened in "));
  EXPECT_THAT(text.substr(0, text.find('\n')),
              MatchesRegex("....-..-..T..:..:......*touchdown .*analyze .*"));
  // A further run goes on behind it.
  testing::RunProgram(kAnalyze + clip_.string() + " --log " + log.string());
  EXPECT_TRUE(testing::ReadAll(log).starts_with(text));
}

TEST_F(Journal, SaysWhereAForeignRecordingIsRead) {
  folder_.Write("rubbish.avi", "none");
  const auto ran = testing::RunProgram(
      "analyze " + (folder_ / "rubbish.avi").string() + " --verbose");
  EXPECT_EQ(ran.status, 3);
  EXPECT_THAT(ran.err, HasSubstr("ended with status 3: "));
}

TEST_F(Journal, RefusesWhatIsNoPlainFile) {
  const auto fifo = folder_ / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  for (const std::string& name :
       {fifo.string(), std::string("/dev/null"), folder_.path().string()}) {
    const auto ran =
        testing::RunProgram(kAnalyze + clip_.string() + " --log " + name);
    EXPECT_EQ(ran.status, 6) << name;
    EXPECT_THAT(ran.err, HasSubstr("--log")) << name;
  }
}

TEST_F(Journal, CannotBeForgedByAName) {
  const std::string name =
      "'" + (folder_ / "a\nforged line.avi").string() + "'";
  const auto ran = testing::RunProgram("analyze " + name + " --verbose");
  EXPECT_THAT(ran.err, AllOf(HasSubstr("a\\x0aforged line.avi"),
                             Not(HasSubstr("\nforged"))));
}

TEST(Version, TellsTheCommit) {
  const auto ran = testing::RunProgram("--version");
  EXPECT_THAT(ran.out, MatchesRegex("[0-9.]+ \\(([0-9a-f]+(-dirty)?|unknown "
                                    "commit)\\)\n"));
}

}  // namespace
}  // namespace touchdown::cli
