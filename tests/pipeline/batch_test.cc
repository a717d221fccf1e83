// Many recordings into the store: the same as one by one, whatever the jobs,
// the killing and the bad ones among them.
#include "app/batch/batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "app/documents/log_analysis.h"
#include "app/exchange/trial_json.h"
#include "app/trials/recordings.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;
using testing::TemporaryFolder;

core::Campaign SphereCampaign() {
  core::Campaign campaign;
  campaign.name = "asphalt";
  campaign.body = core::Sphere({0.024, 0.00002, std::nullopt});
  campaign.bounce_height_m = 0.0005;
  return campaign;
}

class RunBatchTest : public ::testing::Test {
 protected:
  RunBatchTest() {
    std::filesystem::create_directory(films());
    filmed::WriteSphere(films() / "a.mraw", 24.0, 1);
    filmed::WriteSphere(films() / "b.mraw", 20.0, 2);
    filmed::WriteSphere(films() / "d.mraw", 30.0, 3);
  }

  std::filesystem::path films() const { return folder_ / "films"; }

  db::Store Open(const std::string& name) const {
    auto store = db::Store::Open(folder_ / name, db::OpenMode::kCreate);
    if (!store.FindCampaign("asphalt")) store.AddCampaign(SphereCampaign());
    return store;
  }

  std::vector<BatchClip> Clips(const AnalyzeOptions& options = {}) const {
    return ListBatchClips(FindRecordings(films()), films(), "asphalt", options);
  }

  TemporaryFolder folder_;
};

// All of a trial that does not depend on when and how fast, as text.
std::string Timeless(core::Trial trial) {
  trial.id.clear();
  trial.recorded_at_utc.clear();
  auto document = nlohmann::json::parse(trial.document_json);
  document.erase("timing_s");
  trial.document_json = document.dump();
  return report::RevisionJson({"", db::RevisionKind::kLogged, trial});
}

std::vector<std::string> Timeless(const db::Store& store) {
  std::vector<std::string> trials;
  for (const auto& trial : store.Trials()) trials.push_back(Timeless(trial));
  return trials;
}

std::vector<Done> DoneOf(const std::vector<TriageEntry>& entries) {
  std::vector<Done> done;
  for (const auto& entry : entries) done.push_back(entry.done);
  return done;
}

TEST_F(RunBatchTest, SaysWhyEachTrialIsStated) {
  db::Store store = Open("lab.db");
  BatchOptions options;
  options.reason = "asked for by Ada";
  RunBatch(store, Clips(), options);
  ASSERT_EQ(store.Trials().size(), 3u);
  for (const core::Trial& trial : store.Trials()) {
    EXPECT_EQ(trial.reason, "asked for by Ada");
  }
}

TEST_F(RunBatchTest, LogsNothingMoreOnceItIsInterrupted) {
  db::Store store = Open("lab.db");
  std::atomic<bool> interrupted = false;
  AnalyzeOptions analyze;
  analyze.interrupted = &interrupted;
  BatchOptions options;
  options.jobs = 1;
  // When the frames of the first have been read.
  options.progress = [&](const BatchProgress& progress) {
    interrupted = interrupted || progress.share > 0.3;
  };
  EXPECT_THAT(RunBatch(store, Clips(analyze), options), IsEmpty());
  EXPECT_THAT(store.Trials(), IsEmpty());
}

TEST_F(RunBatchTest, IsTheSameAsOneByOneWhateverTheJobs) {
  filmed::WriteRubbish(films() / "c.avi");
  filmed::WriteSphere(films() / "e.mraw", 24.0, 1);  // a again
  for (const auto& clip : {"a", "b", "d"}) {
    const auto path = films() / (std::string(clip) + ".mraw");
    AnalyzeOptions options;
    FillFromCampaign(SphereCampaign(), options);
    Open("one.db");
    LogAnalysis(Analyze(path, options), folder_ / "one.db", "asphalt");
  }
  const auto expected = Timeless(Open("one.db"));
  ASSERT_EQ(expected.size(), 3u);
  EXPECT_TRUE(Open("one.db").Trials()[0].first.contact.found);
  for (const int jobs : {1, 2, 5}) {
    SCOPED_TRACE(jobs);
    auto store = Open("jobs" + std::to_string(jobs) + ".db");
    const auto entries = RunBatch(store, Clips(), {.jobs = jobs});
    EXPECT_THAT(DoneOf(entries),
                ElementsAre(Done::kLogged, Done::kLogged, Done::kFailed,
                            Done::kLogged, Done::kCopy));
    EXPECT_EQ(Timeless(store), expected);
    EXPECT_THAT(entries[2].reason, HasSubstr("c.avi"));
    EXPECT_THAT(entries[4].reason, HasSubstr("same recording as a.mraw"));
    EXPECT_EQ(entries[0].attention, Attention::kNone) << entries[0].reason;
    EXPECT_NEAR(entries[0].angle_rad->value, 24.0 * core::kDegree,
                4.0 * entries[0].angle_rad->u);
  }
}

TEST_F(RunBatchTest, WhatIsKnownIsNotAnalysedAgain) {
  auto store = Open("lab.db");
  auto clips = Clips();
  RunBatch(store, clips);
  const auto once = Timeless(store);
  EXPECT_THAT(DoneOf(RunBatch(store, clips)),
              ElementsAre(Done::kKnown, Done::kKnown, Done::kKnown));
  EXPECT_EQ(Timeless(store), once);

  // Other options are another answer, and so is a set-point.
  AnalyzeOptions options;
  options.bounce_height_m = 0.001;
  EXPECT_THAT(DoneOf(RunBatch(store, Clips(options))),
              ElementsAre(Done::kLogged, Done::kLogged, Done::kLogged));
  EXPECT_EQ(store.Trials()[0].revision, 2);
  clips = Clips(options);
  clips[1].set_angle_rad = 0.35;
  EXPECT_THAT(DoneOf(RunBatch(store, clips)),
              ElementsAre(Done::kKnown, Done::kLogged, Done::kKnown));
  EXPECT_THAT(store.Trials()[1].set_angle_rad, Optional(0.35));
  EXPECT_THAT(DoneOf(RunBatch(store, clips)),
              ElementsAre(Done::kKnown, Done::kKnown, Done::kKnown));
  EXPECT_THAT(DoneOf(RunBatch(store, clips, {.again = true})),
              ElementsAre(Done::kLogged, Done::kLogged, Done::kLogged));
}

// A person's correction is not undone by running the batch again.
TEST_F(RunBatchTest, CorrectionsStay) {
  auto store = Open("lab.db");
  RunBatch(store, Clips());
  core::Trial trial = store.Trials()[0];
  trial.first.state.label = core::MotionState::kRoll;
  trial.set_angle_rad = 0.4;
  store.Correct(trial, "Ada", "seen on the contact sheet");
  auto clips = Clips();
  clips[0].set_angle_rad = std::nullopt;
  EXPECT_THAT(DoneOf(RunBatch(store, clips)),
              ElementsAre(Done::kKnown, Done::kKnown, Done::kKnown));
  EXPECT_EQ(store.Trials()[0].first.state.label, core::MotionState::kRoll);
}

// Nor by analysing it again: the new answer is a proposal, which triage shows
// with what differs and how to accept it.
TEST_F(RunBatchTest, AnalysedAgainACorrectionStaysInForce) {
  auto store = Open("lab.db");
  RunBatch(store, Clips());
  core::Trial trial = store.Trials()[0];
  trial.first.state.label = core::MotionState::kRoll;
  store.Correct(trial, "Ada", "seen on the contact sheet");
  const auto again = RunBatch(store, Clips(), {.again = true});
  EXPECT_EQ(store.Trials()[0].first.state.label, core::MotionState::kRoll);
  EXPECT_EQ(store.Trials()[0].author, "Ada");
  EXPECT_EQ(again[0].attention, Attention::kProposed);
  EXPECT_EQ(again[0].revision, 2);
  EXPECT_THAT(again[0].reason,
              AllOf(HasSubstr("correction (roll, approach angle"),
                    HasSubstr("proposes bounce, approach angle"),
                    HasSubstr("--accept 3")));
  EXPECT_EQ(again[1].attention, Attention::kNone) << again[1].reason;
  // Also where nothing is analysed.
  const auto known = RunBatch(store, Clips());
  EXPECT_EQ(known[0].done, Done::kKnown);
  EXPECT_EQ(known[0].attention, Attention::kProposed);
}

// Killed at every step of its progress, then started again: nothing that was
// told as done is lost or done twice.
TEST_F(RunBatchTest, GoesOnWhereItWasKilled) {
  { Open("lab.db"); }
  for (std::size_t kill_at = 1; kill_at <= 3; ++kill_at) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      auto store = db::Store::Open(folder_ / "lab.db", db::OpenMode::kWrite);
      RunBatch(store, Clips(),
               {.jobs = 2, .progress = [&](const BatchProgress& progress) {
                  if (progress.done >= kill_at) raise(SIGKILL);
                }});
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
    const auto store = db::Store::Open(folder_ / "lab.db", db::OpenMode::kRead);
    EXPECT_EQ(store.Trials().size(), kill_at);
    EXPECT_THAT(db::Check(store).problems, IsEmpty());
  }
  auto store = Open("lab.db");
  EXPECT_THAT(DoneOf(RunBatch(store, Clips())),
              ElementsAre(Done::kKnown, Done::kKnown, Done::kKnown));
  for (const auto& trial : store.Trials()) EXPECT_EQ(trial.revision, 1);
}

TEST_F(RunBatchTest, TroubleWithTheStoreEndsIt) {
  auto store = db::Store::Open(folder_ / "lab.db", db::OpenMode::kCreate);
  EXPECT_THROW(RunBatch(store, Clips()), core::StoreError);  // no campaign
  Open("lab.db");
  auto reader = db::Store::Open(folder_ / "lab.db", db::OpenMode::kRead);
  EXPECT_THROW(RunBatch(reader, Clips(), {.jobs = 2}), core::StoreError);
}

// A campaign that another analysis would be of: each start would end the same.
TEST_F(RunBatchTest, WhatTheStoreRefusesIsSetAside) {
  auto store = Open("lab.db");
  AnalyzeOptions options;
  options.angle_kind = core::AngleKind::kFace;
  std::vector<BatchClip> clips = Clips(options);
  clips.resize(1);
  const auto run = [&] { return RunBatch(store, clips).front(); };
  const TriageEntry first = run();
  EXPECT_EQ(first.done, Done::kFailed);
  EXPECT_THAT(first.reason, HasSubstr("never pooled"));
  EXPECT_EQ(run().reason, first.reason);
  EXPECT_THAT(run().reason,
              AllOf(HasSubstr("set aside"), HasSubstr(first.reason)));
}

TEST_F(RunBatchTest, OptionsThatDoNotFitAClipAreItsFailure) {
  AnalyzeOptions options;
  options.last_frame = 100000;
  auto store = Open("lab.db");
  const auto entries = RunBatch(store, Clips(options));
  ASSERT_EQ(entries.size(), 3u);
  for (const auto& entry : entries) {
    EXPECT_EQ(entry.done, Done::kFailed);
    EXPECT_THAT(entry.reason, HasSubstr("frames is 0:100000"));
  }
}

TEST_F(RunBatchTest, StopsWhenItIsTold) {
  auto store = Open("lab.db");
  int looked = 0;
  const auto entries = RunBatch(
      store, Clips(), {.jobs = 1, .stop = [&] { return ++looked > 2; }});
  EXPECT_EQ(entries.size(), 2u);
  EXPECT_EQ(store.Trials().size(), 2u);
}

TEST_F(RunBatchTest, ProgressEndsAtTheEnd) {
  auto store = Open("lab.db");
  BatchProgress last;
  double share = 0.0;
  RunBatch(store, Clips(), {.jobs = 2, .progress = [&](const auto& progress) {
                              EXPECT_GE(progress.done, last.done);
                              share = std::max(share, progress.share);
                              last = progress;
                            }});
  EXPECT_EQ(last.done, 3u);
  EXPECT_EQ(last.all, 3u);
  EXPECT_DOUBLE_EQ(share, 1.0);
  EXPECT_THAT(last.seconds_left, Optional(0.0));
}

TEST_F(RunBatchTest, EvidenceGoesToAFolderOfEachName) {
  auto store = Open("lab.db");
  RunBatch(store, Clips(), {.evidence = films() / "out"});
  for (const char* name : {"a.mraw", "b.mraw", "d.mraw"}) {
    EXPECT_TRUE(std::filesystem::exists(films() / "out" / name / "track.csv"));
  }
  // Evidence is no recording, wherever it lies.
  EXPECT_EQ(FindRecordings(films()).size(), 3u);
}

// Two machines take a part each; their stores together are the batch.
TEST_F(RunBatchTest, ShardsMergeToTheWhole) {
  auto whole = Open("whole.db");
  RunBatch(whole, Clips());
  auto merged = Open("merged.db");
  for (const std::size_t k : {1u, 2u}) {
    auto part = Open("part" + std::to_string(k) + ".db");
    RunBatch(part, SelectShard(Clips(), {k, 2}));
    EXPECT_THAT(db::Merge(merged, part).conflicts, IsEmpty());
  }
  auto expected = Timeless(whole);
  auto got = Timeless(merged);
  std::sort(expected.begin(), expected.end());
  std::sort(got.begin(), got.end());
  EXPECT_EQ(got, expected);
}

TEST(SelectShard, EveryClipIsInOnePart) {
  std::vector<BatchClip> clips(10);
  for (std::size_t i = 0; i < 10; ++i) clips[i].name = std::to_string(i);
  std::multiset<std::string> names;
  for (std::size_t k = 1; k <= 3; ++k) {
    const auto part = SelectShard(clips, {k, 3});
    EXPECT_GE(part.size(), 3u);
    for (const auto& clip : part) names.insert(clip.name);
  }
  EXPECT_EQ(names.size(), 10u);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 10u);
}

TEST(ParseShard, RefusesWhatIsNoPart) {
  EXPECT_EQ(ParseShard("--shard", "2/8").k, 2u);
  EXPECT_EQ(ParseShard("--shard", "2/8").n, 8u);
  for (const char* text : {"", "1", "0/3", "4/3", "a/b", "1/3x", "-1/3", "1/",
                           "1/99999999999999999999"}) {
    EXPECT_THROW(ParseShard("--shard", text), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace touchdown::pipeline
