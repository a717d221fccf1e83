// batch as a user runs it: exits, what is on stdout, odd names, the watch.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/db/fixture.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/program.h"
#include "tests/support/running_program.h"
#include "touchdown/db/store.h"

namespace touchdown {
namespace {

using ::testing::HasSubstr;
using testing::ProgramResult;
using ::testing::StartsWith;

class BatchCommand : public ::testing::Test {
 protected:
  BatchCommand() {
    std::filesystem::create_directory(folder_ / "films");
    EXPECT_EQ(Run({"campaign", "new", "asphalt", "--db", Db(), "--body",
                   "sphere", "--diameter-mm", "24"})
                  .status,
              0);
  }

  std::string Db(const std::string& name = "lab.db") const {
    return (folder_ / name).string();
  }
  std::filesystem::path Write(const std::string& name,
                              const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::string Films() const { return (folder_ / "films").string(); }

  ProgramResult Run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), TOUCHDOWN_BINARY);
    return testing::RunProgram(std::move(arguments), folder_.path().string());
  }
  ProgramResult Batch(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"batch", Films(),      "--db",
                                          Db(),    "--campaign", "asphalt"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run(std::move(arguments));
  }
  void ExpectMistake(std::vector<std::string> arguments, int status,
                     const std::string& says) const {
    const ProgramResult ran = Run(std::move(arguments));
    EXPECT_EQ(ran.status, status) << says;
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, StartsWith("touchdown: "));
    EXPECT_THAT(ran.err, HasSubstr(says));
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }

  db::Folder folder_;
};

TEST_F(BatchCommand, OneBadClipIsExit5AndStopsNothing) {
  // Names that a shell, a terminal, a table or SQL could trip over.
  const std::vector<std::string> names = {"it's; DROP TABLE trials;--.mraw",
                                          "$(touch x) `y` \"z\".mraw",
                                          "two\nlines \xc3\xbc.mraw"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    pipeline::filmed::WriteSphere(folder_ / ("films/" + names[i]), 24.0, i + 1);
  }
  pipeline::filmed::WriteRubbish(folder_ / "films/=bad.avi");
  const ProgramResult ran = Batch({"--out", (folder_ / "out").string()});
  EXPECT_EQ(ran.status, 5) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("failed"));
  EXPECT_THAT(ran.out, HasSubstr("=bad.avi"));
  EXPECT_THAT(ran.out, HasSubstr("4 recordings: 3 logged, 0 known already, 0 "
                                 "copies, 1 failed; 1 to look at"));
  EXPECT_THAT(ran.err, HasSubstr("1 of 4 recordings failed"));
  EXPECT_THAT(testing::ReadText((folder_ / "out/triage.csv").string()),
              HasSubstr("\n'=bad.avi,failed,failed,"));
  for (const std::string& name : names) {
    EXPECT_TRUE(
        std::filesystem::exists(folder_ / ("out/" + name) / "analysis.json"));
  }

  const ProgramResult again = Batch({"--json", "--jobs", "1"});
  EXPECT_EQ(again.status, 5);
  const auto document = nlohmann::json::parse(again.out);
  EXPECT_EQ(document["schema"], "touchdown.batch/1");
  EXPECT_EQ(document["counts"]["known"], 3);
  EXPECT_EQ(document["clips"][0]["clip"], "=bad.avi");
  EXPECT_EQ(document["clips"][0]["attention"], "failed");
  EXPECT_EQ(document["clips"][1]["state"], "bounce");
  std::filesystem::remove(folder_ / "films/=bad.avi");
  EXPECT_EQ(Batch().status, 0);
}

TEST_F(BatchCommand, AManifestAttachesSetPoints) {
  pipeline::filmed::WriteSphere(folder_ / "films/a.mraw", 24.0, 1);
  const auto manifest =
      Write("m.csv", "clip,set_angle_deg,campaign\nfilms/a.mraw,25,asphalt\n");
  EXPECT_EQ(Run({"batch", manifest.string(), "--db", Db()}).status, 0);
  const auto store = db::Store::Open(Db(), db::OpenMode::kRead);
  ASSERT_EQ(store.Trials().size(), 1u);
  EXPECT_DOUBLE_EQ(*store.Trials()[0].set_angle_rad, 25.0 * core::kDegree);
  Write("m.csv", "clip,set_angle_deg\nfilms/a.mraw,steep\n");
  ExpectMistake({"batch", manifest.string(), "--db", Db()}, 3,
                "m.csv: row 2, column set_angle_deg: 'steep'");
  EXPECT_THAT(Run({"batch", "--columns"}).out, HasSubstr("set_speed_mps"));
}

TEST_F(BatchCommand, MistakesAreOneLineAndLeaveNoStore) {
  ExpectMistake({"batch", Films(), "--db", Db("new.db")}, 3, "no recording");
  pipeline::filmed::WriteSphere(folder_ / "films/a.mraw", 24.0, 1);
  ExpectMistake({"batch", Films()}, 2, "--db is missing");
  ExpectMistake({"batch", "--db", Db("new.db")}, 2, "FOLDER is missing");
  ExpectMistake({"batch", Db("none"), "--db", Db("new.db")}, 3,
                "cannot be read");
  ExpectMistake({"batch", Films(), "--db", Db("new.db"), "--shard", "3/2"}, 2,
                "--shard is '3/2'");
  ExpectMistake({"batch", Films(), "--db", Db("new.db"), "--condition", "x=1"},
                2, "--condition is 'x=1'");
  ExpectMistake(
      {"batch", Films(), "--db", Db("new.db"), "--condition", "spring=S 3"}, 4,
      "no such trial store");
  ExpectMistake({"batch", Films() + "/a.mraw", "--db", Db("new.db"), "--watch"},
                2, "a.mraw', must be a folder with --watch");
  ExpectMistake(
      {"batch", Films(), "--db", Db("new.db"), "--watch", "--shard", "1/2"}, 2,
      "--shard is '1/2', must be left out with --watch");
  ExpectMistake({"batch", Films(), "--db", Db("new.db"), "--jobs", "-1"}, 2,
                "--jobs is -1");
  ExpectMistake({"batch", Films(), "--db", Db("new.db"), "--campaign", "x"}, 4,
                "no such trial store");
  ExpectMistake({"batch", Films(), "--db", Db(), "--campaign", "x"}, 4,
                "there is no campaign 'x'");
  ExpectMistake({"batch", Films(), "--db", Db("new.db"), "--fps", "-1",
                 "--region", "1e300,0,5,5"},
                2, "--region is '1e300,0,5,5'");
  ExpectMistake(
      {"batch", Films(), "--db", Db("new.db"), "--campaign-from", Db()}, 2,
      "--campaign is missing");
  ExpectMistake({"batch", Films(), "--db", Db("new.db"), "--campaign-from",
                 Db(), "--campaign", "x"},
                4, "there is no campaign 'x'");
  // Nor does a condition that the other store's register does not have leave a
  // store with the campaign alone.
  ExpectMistake({"batch", Films(), "--db", Db("new.db"), "--campaign-from",
                 Db(), "--campaign", "asphalt", "--condition", "rig=none"},
                2, "rig");
  EXPECT_FALSE(std::filesystem::exists(Db("new.db")));
}

// What the array job of docs/cluster.md does, without Slurm.
TEST_F(BatchCommand, ShardsOfTheirOwnStoresMerge) {
  for (int i = 0; i < 3; ++i) {
    pipeline::filmed::WriteSphere(
        folder_ / ("films/" + std::to_string(i) + ".mraw"), 24.0,
        static_cast<std::uint64_t>(i + 1));
  }
  for (const std::string k : {"1", "2"}) {
    const ProgramResult ran =
        Run({"batch", Films(), "--db", Db("shard-" + k + ".db"), "--campaign",
             "asphalt", "--campaign-from", Db(), "--shard", k + "/2"});
    EXPECT_EQ(ran.status, 0) << ran.err;
  }
  const ProgramResult merged =
      Run({"db", "merge", "--db", Db(), Db("shard-1.db"), Db("shard-2.db")});
  EXPECT_EQ(merged.status, 0) << merged.err;
  EXPECT_THAT(
      merged.out,
      HasSubstr(
          "0 campaigns, 0 versions of the register, 0 plans and looks added"));
  EXPECT_EQ(db::Store::Open(Db(), db::OpenMode::kRead).Trials().size(), 3u);
}

TEST_F(BatchCommand, TheWatchTakesWhatComes) {
  pipeline::filmed::WriteSphere(folder_ / "films/a.mraw", 24.0, 1);
  testing::RunningProgram watch({TOUCHDOWN_BINARY, "batch", Films(), "--db",
                                 Db(), "--campaign", "asphalt", "--watch"});
  EXPECT_THAT(watch.Line(), StartsWith("a.mraw  bounce  approach 2"));
  std::filesystem::create_directory(folder_ / "films/later");
  pipeline::filmed::WriteSphere(folder_ / "films/later/b.mraw", 20.0, 2);
  EXPECT_THAT(watch.Line(), StartsWith("later/b.mraw  bounce  approach"));
  EXPECT_EQ(watch.End(SIGTERM), 0);
  EXPECT_THAT(watch.Line(), HasSubstr("2 recordings: 2 logged"));
  EXPECT_EQ(db::Store::Open(Db(), db::OpenMode::kRead).Trials().size(), 2u);
}

}  // namespace
}  // namespace touchdown
