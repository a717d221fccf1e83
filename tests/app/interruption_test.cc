// Ctrl-C and limits, as a user sees them: the exit status, and that nothing
// half done is left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/text/truth_file.h"
#include "tests/db/fixture.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/busy_clip.h"
#include "tests/support/program.h"
#include "tests/support/running_program.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/store.h"

namespace touchdown {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ProgramResult;
using testing::RunningProgram;
using ::testing::StartsWith;

constexpr int kBySignal = 128;  // as shells count
// What a start alone does not take, and much less than any of the work below.
constexpr double kAtWork_s = 0.1;

class Interruption : public ::testing::Test {
 protected:
  std::string In(const std::string& name) const {
    return (folder_ / name).string();
  }
  // Takes seconds to look at.
  std::string Busy(const std::string& name = "busy.mraw") const {
    testing::WriteBusyClip(folder_ / name, 400);
    return In(name);
  }
  std::string Film(const std::string& name) const {
    pipeline::filmed::WriteSphere(folder_ / name, 24.0, 1);
    return In(name);
  }
  std::string NewStore() const {
    EXPECT_EQ(Run({"campaign", "new", "asphalt", "--db", In("lab.db"), "--body",
                   "sphere", "--diameter-mm", "24"})
                  .status,
              0);
    return In("lab.db");
  }
  std::vector<core::Trial> Trials() const {
    const auto store = db::Store::Open(In("lab.db"), db::OpenMode::kRead);
    EXPECT_THAT(db::Check(store).problems, IsEmpty());
    return store.Trials();
  }
  ProgramResult Run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), TOUCHDOWN_BINARY);
    return testing::RunProgram(std::move(arguments), folder_.path().string());
  }
  static RunningProgram Start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), TOUCHDOWN_BINARY);
    return RunningProgram(std::move(arguments));
  }
  // What is below the folder under a temporary name.
  std::vector<std::string> Leftovers() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      if (name.find(".part") != std::string::npos) names.push_back(name);
    }
    return names;
  }

  db::Folder folder_;
};

TEST_F(Interruption, AnalyzeLeavesNothing) {
  const std::string store = NewStore();
  const std::string clip = Busy();
  for (const int signal : {SIGINT, SIGTERM}) {
    RunningProgram analyze =
        Start({"analyze", clip, "--out", In("out"), "--db", store, "--json"});
    ASSERT_TRUE(analyze.UntilItHasWorked_s(kAtWork_s));
    EXPECT_EQ(analyze.End(signal), kBySignal + signal);
    EXPECT_EQ(analyze.Line(), "");
  }
  EXPECT_FALSE(fs::exists(In("out")));
  EXPECT_THAT(Trials(), IsEmpty());
}

TEST_F(Interruption, ABatchKeepsWhatIsDone) {
  const std::string store = NewStore();
  fs::create_directory(In("films"));
  Film("films/a.mraw");
  Busy("films/b.mraw");
  Busy("films/c.mraw");
  RunningProgram batch =
      Start({"batch", In("films"), "--db", store, "--campaign", "asphalt",
             "--jobs", "2", "--out", In("evidence")});
  ASSERT_TRUE(batch.UntilItHasWorked_s(10.0 * kAtWork_s));
  EXPECT_EQ(batch.End(SIGINT), kBySignal + SIGINT);
  EXPECT_LE(Trials().size(), 1u);
  EXPECT_THAT(Leftovers(), IsEmpty());
  EXPECT_FALSE(fs::exists(In("evidence/b.mraw")));
}

TEST_F(Interruption, AWatchEndsWithWhatItAnalyses) {
  const std::string store = NewStore();
  fs::create_directory(In("films"));
  Film("films/a.mraw");
  Busy("films/b.mraw");
  RunningProgram watch =
      Start({"batch", In("films"), "--db", store, "--campaign", "asphalt",
             "--jobs", "1", "--watch"});
  ASSERT_TRUE(watch.UntilItHasWorked_s(10.0 * kAtWork_s));
  EXPECT_EQ(watch.End(SIGINT), kBySignal + SIGINT);
  EXPECT_LE(Trials().size(), 1u);
}

TEST_F(Interruption, SimulateAndDemoLeaveNoPart) {
  RunningProgram table =
      Start({"simulate", "--table1", "--out", In("clips"), "--format", "png"});
  ASSERT_TRUE(table.UntilItHasWorked_s(3.0 * kAtWork_s));
  EXPECT_EQ(table.End(SIGINT), kBySignal + SIGINT);
  EXPECT_THAT(Leftovers(), IsEmpty());

  RunningProgram demo = Start({"demo", "--out", In("demo")});
  ASSERT_TRUE(demo.UntilItHasWorked_s(10.0 * kAtWork_s));
  EXPECT_EQ(demo.End(SIGTERM), kBySignal + SIGTERM);
  EXPECT_THAT(Leftovers(), IsEmpty());
  // No clip without its truth: it would pass for a recording.
  for (const auto& entry : fs::recursive_directory_iterator(In("demo"))) {
    if (entry.path().extension() != ".mraw") continue;
    EXPECT_TRUE(pipeline::HasTruthFile(entry.path())) << entry.path();
  }
}

TEST_F(Interruption, ALimitEndsAnAnalysisWithOneLine) {
  const std::string store = NewStore();
  const ProgramResult ran = Run({"analyze", Busy(), "--limit-s", "0.2", "--out",
                                 In("out"), "--db", store});
  EXPECT_EQ(ran.status, 3);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, StartsWith("touchdown: " + In("busy.mraw") +
                                  ": not done within 0.2 s: ended while "));
  EXPECT_THAT(ran.err, HasSubstr(" of 400; give fewer frames by --frames A:B"));
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  EXPECT_FALSE(fs::exists(In("out")));
  EXPECT_THAT(Trials(), IsEmpty());
}

TEST_F(Interruption, ALimitedDocumentSaysOnlyWhatIsTrue) {
  const ProgramResult ran =
      Run({"analyze", Busy(), "--limit-s", "0.2", "--json"});
  EXPECT_EQ(ran.status, 3);
  const auto document = nlohmann::json::parse(ran.out);
  EXPECT_EQ(document["schema"], "touchdown.analysis/1");
  EXPECT_EQ(document["clip"]["frames"], 400);
  EXPECT_EQ(document["contact"]["found"], false);
  EXPECT_THAT(document["contact"]["reason"].get<std::string>(),
              HasSubstr("not done within 0.2 s"));
  EXPECT_EQ(document["state"]["label"], "undecided");
  EXPECT_TRUE(document["scale"].is_null());
}

TEST_F(Interruption, ALimitFailsAClipOfABatchAndNoOther) {
  const std::string store = NewStore();
  fs::create_directory(In("films"));
  Busy("films/a.mraw");
  Film("films/b.mraw");
  // A limit is wall time: where the machine has much else to do the film, too,
  // may take longer than the first of them. The busy clip takes many
  // times as long.
  for (const std::string limit : {"4", "12", "36"}) {
    const ProgramResult ran =
        Run({"batch", In("films"), "--db", store, "--campaign", "asphalt",
             "--again", "--limit-s", limit});
    ASSERT_EQ(ran.status, 5) << ran.err;
    ASSERT_THAT(ran.out, HasSubstr("not done within " + limit + " s"));
    if (!Trials().empty()) break;
  }
  EXPECT_EQ(Trials().size(), 1u);
}

TEST_F(Interruption, ALimitIsAboveZero) {
  const std::string clip = Film("a.mraw");
  for (const std::string limit : {"0", "-1", "nan"}) {
    const ProgramResult ran = Run({"analyze", clip, "--limit-s=" + limit});
    EXPECT_EQ(ran.status, 2) << limit;
    EXPECT_THAT(ran.err, HasSubstr("--limit-s is "));
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
  EXPECT_EQ(Run({"demo", "--out", In("demo"), "--limit-s", "0"}).status, 2);
  EXPECT_FALSE(fs::exists(In("demo")));
}

}  // namespace
}  // namespace touchdown
