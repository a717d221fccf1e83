#include "app/batch/set_aside.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "app/batch/batch.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/temporary_folder.h"

namespace touchdown::pipeline {
namespace {

const SetAside::Key kKey{"clip", "options"};

TEST(SetAside, HoldsWhatFailedTwiceInTheSameWay) {
  const testing::TemporaryFolder folder;
  SetAside(folder / "lab.db").Failed(kKey, "a.avi", "damaged");
  EXPECT_FALSE(SetAside(folder / "lab.db").FindReason(kKey));
  SetAside later(folder / "lab.db");
  later.Failed(kKey, "a.avi", "damaged\nbadly");
  for (const SetAside& each : {later, SetAside(folder / "lab.db")}) {
    const auto reason = each.FindReason(kKey);
    ASSERT_TRUE(reason);
    EXPECT_NE(reason->find("damaged\nbadly"), std::string::npos);
    EXPECT_NE(reason->find("--again"), std::string::npos);
    EXPECT_FALSE(each.FindReason({"clip", "other options"}));
    EXPECT_FALSE(each.FindReason({"another", "options"}));
  }
}

TEST(SetAside, PassesOverWhatItDoesNotUnderstand) {
  const testing::TemporaryFolder folder;
  folder.Write("lab.db.failed.jsonl",
               "rubbish\n[]\n{\"clip_id\": 7}\n{\"clip_id\": \"clip\", "
               "\"options\": \"options\"}\n{\"clip_id\"");
  EXPECT_FALSE(SetAside(folder / "lab.db").FindReason(kKey));
}

TEST(SetAside, FollowsNoLinkAndWaitsForNoPipe) {
  const testing::TemporaryFolder folder;
  const auto other = folder.Write("other", "kept");
  std::filesystem::create_symlink(other, folder / "lab.db.failed.jsonl");
  SetAside(folder / "lab.db").Failed(kKey, "a.avi", "damaged");
  EXPECT_EQ(testing::ReadAll(other), "kept");
}

// A batch that is started again and again over a recording that cannot be read.
TEST(RunBatch, SetsAsideWhatFailedTwice) {
  const testing::TemporaryFolder folder;
  filmed::WriteRubbish(folder / "shot.avi");
  auto store = db::Store::Open(folder / "lab.db", db::OpenMode::kCreate);
  const std::vector<std::filesystem::path> recordings = {folder / "shot.avi"};
  const auto run = [&](bool again, double fps = 1000.0) {
    AnalyzeOptions analyze;
    analyze.fps = fps;
    BatchOptions options;
    options.again = again;
    return RunBatch(store,
                    ListBatchClips(recordings, folder.path(), "", analyze),
                    options)
        .front()
        .reason;
  };
  const std::string first = run(false);
  EXPECT_EQ(first.find("set aside"), std::string::npos);
  EXPECT_EQ(run(false), first);
  const std::string third = run(false);
  EXPECT_NE(third.find("set aside"), std::string::npos);
  EXPECT_NE(third.find(first), std::string::npos);
  EXPECT_EQ(run(true), first);
  // Told otherwise, it is another question.
  EXPECT_EQ(run(false, 2000.0), first);
}

}  // namespace
}  // namespace touchdown::pipeline
