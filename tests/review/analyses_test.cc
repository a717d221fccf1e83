// The queue of analyses: one at a time, joined, cancelled, logged as a batch
// logs.
#include "app/review/analyses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/review/lab.h"

namespace touchdown::review {
namespace {

using enum AnalysisState;
using ::testing::AllOf;
using ::testing::HasSubstr;

class AnalysisQueueTest : public ::testing::Test {
 protected:
  AnalysisOrder Order(const std::filesystem::path& path) const {
    AnalysisOrder order;
    order.recording.name = path.filename();
    order.path = path;
    order.frames = 115;
    order.campaign.name = "board";
    order.who = "Ada";
    return order;
  }
  AnalysisOrder Another(int seed) const {
    const auto path = lab.folder / (std::to_string(seed) + ".mraw");
    pipeline::filmed::WriteSphere(path, 25.0, static_cast<unsigned>(seed));
    return Order(path);
  }
  AnalysisStatus Over(const std::string& id) {
    return Once(id, [](const AnalysisStatus& status) {
      return status.state != kWaiting && status.state != kRunning;
    });
  }
  template <class Holds>
  AnalysisStatus Once(const std::string& id, const Holds& holds) {
    while (true) {
      const auto status = queue.Find(id);
      if (!status || holds(*status)) return status.value();
      std::this_thread::yield();
    }
  }
  std::size_t Trials() const {
    return db::Store::Open(lab.store, db::OpenMode::kRead).Trials().size();
  }

  Lab lab;
  AnalysisQueue queue{lab.store};
};

TEST_F(AnalysisQueueTest, LogsATrialWithWhoAskedForIt) {
  AnalysisOrder order = Another(2);
  order.set_angle_rad = 25 * core::kDegree;
  const AnalysisStatus status = Over(queue.Add(order));
  ASSERT_EQ(status.state, kDone) << status.trouble;
  EXPECT_EQ(status.frames_done, 115);
  EXPECT_THAT(status.said,
              AllOf(HasSubstr("approach angle 2"), HasSubstr("deg, bounce")));
  const auto trial = db::Store::Open(lab.store, db::OpenMode::kRead)
                         .Find(status.trial_id)
                         .value();
  EXPECT_EQ(trial.campaign, "board");
  EXPECT_EQ(trial.reason, "logged on the review page by Ada");
  EXPECT_EQ(trial.set_angle_rad, 25 * core::kDegree);
}

TEST_F(AnalysisQueueTest, DoesNotAnalyseAgainWhatTheStoreKnows) {
  const AnalysisStatus status = Over(queue.Add(Order(lab.clip)));
  EXPECT_EQ(status.state, kKnown) << status.trouble;
  EXPECT_EQ(status.trial_id, lab.trial);
  EXPECT_EQ(Trials(), 1u);
}

TEST_F(AnalysisQueueTest, GivesTwoTabsOneAnalysis) {
  // The first keeps the queue busy while the others are asked for.
  const std::string busy = queue.Add(Another(2));
  const AnalysisOrder order = Another(3);
  const std::string one = queue.Add(order);
  EXPECT_EQ(queue.Add(order), one);
  AnalysisOrder other = order;
  other.camera.fps = 999.0;
  EXPECT_NE(queue.Add(other), one);
  // What is to be analysed again is not answered by what will be known.
  AnalysisOrder again = order;
  again.again = true;
  EXPECT_NE(queue.Add(again), one);
  EXPECT_EQ(Over(one).state, kDone);
  EXPECT_EQ(Over(busy).state, kDone);
}

TEST_F(AnalysisQueueTest, CancelsWhatRunsAndWhatWaits) {
  const std::string runs = queue.Add(Another(2));
  const std::string waits = queue.Add(Another(3));
  Once(runs, [](const AnalysisStatus& s) { return s.frames_done > 0; });
  EXPECT_TRUE(queue.Cancel(waits));
  EXPECT_TRUE(queue.Cancel(runs));
  EXPECT_EQ(Over(runs).state, kCancelled);
  EXPECT_EQ(Over(waits).state, kCancelled);
  EXPECT_FALSE(queue.Cancel("none"));
  EXPECT_EQ(Trials(), 1u);
  // What was cancelled can be asked for again.
  EXPECT_EQ(Over(queue.Add(Order(lab.folder / "2.mraw"))).state, kDone);
}

TEST_F(AnalysisQueueTest, SaysWhyItFailed) {
  const auto path = lab.folder / "rubbish.mp4";
  pipeline::filmed::WriteRubbish(path);
  const AnalysisStatus status = Over(queue.Add(Order(path)));
  EXPECT_EQ(status.state, kFailed);
  EXPECT_THAT(status.trouble, HasSubstr("rubbish.mp4"));
  EXPECT_EQ(status.trouble.find('\n'), std::string::npos);
  AnalysisOrder nowhere = Order(lab.clip);
  nowhere.campaign.name = "none";
  EXPECT_THAT(Over(queue.Add(nowhere)).trouble,
              HasSubstr("no campaign 'none'"));
  EXPECT_EQ(Trials(), 1u);
}

TEST_F(AnalysisQueueTest, KeepsATestToItself) {
  AnalysisOrder order = Another(2);
  order.is_test = true;
  order.campaign.name = "not there yet";
  order.campaign.body = core::Sphere({0.024, 2e-5, std::nullopt});
  const AnalysisStatus status = Over(queue.Add(order));
  ASSERT_EQ(status.state, kDone) << status.trouble;
  ASSERT_TRUE(status.analysis);
  EXPECT_TRUE(status.analysis->contacts.first.contact.found);
  EXPECT_EQ(status.analysis->options.interrupted, nullptr);
  EXPECT_EQ(Trials(), 1u);
  queue.SetTrial(status.id, "its trial");
  EXPECT_EQ(queue.Find(status.id)->trial_id, "its trial");
}

TEST_F(AnalysisQueueTest, HasALimit) {
  const AnalysisOrder order = Order(lab.clip);
  EXPECT_THROW(
      for (int i = 0; i < 1000; ++i) {
        AnalysisOrder another = order;
        another.camera.fps = 1000.0 + i;
        queue.Add(another);
      },
      std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::review
