// Analyses that were asked for on the page: one at a time, in the order in
// which they were asked for, with progress; each can be cancelled.
//
// One that is to be logged goes the way of `touchdown batch`
// (batch/batch.h): what the store knows is not analysed again, and until the
// trial is on the disk nothing is. A test of settings is kept here and written
// nowhere (setup.h).
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "app/measure/analyze.h"
#include "app/review/recordings.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/conditions.h"

namespace touchdown::review {

// What is asked for.
struct AnalysisOrder {
  Recording recording;
  std::filesystem::path path;
  std::int64_t frames = 0;          // of the recording
  pipeline::AnalyzeOptions camera;  // what is known of it
  // Of a test: as it would be; else the store's of that name.
  core::Campaign campaign;
  bool is_test = false;
  std::string who;
  std::optional<double> set_angle_rad = {};
  std::optional<double> set_speed_mps = {};
  std::optional<core::Conditions> conditions = {};
  bool again = false;  // also what the store knows or has set aside
};

enum class AnalysisState {
  kWaiting,
  kRunning,
  kDone,   // logged, or, of a test, to be looked at
  kKnown,  // the store had this answer
  kCancelled,
  kFailed
};
std::string_view Name(AnalysisState state);

struct AnalysisStatus {
  std::string id;
  AnalysisOrder order;
  AnalysisState state = AnalysisState::kWaiting;
  std::int64_t frames_done = 0;
  std::size_t ahead = 0;  // of one that waits: how many come first
  std::string trouble;    // of kFailed: one line
  std::string trial_id;   // where there is one
  std::string said;       // of a trial: angle and state in words
  std::shared_ptr<const pipeline::Analysis> analysis;  // of a test
};

// Safe between threads.
class AnalysisQueue {
 public:
  // Trials go into `store`.
  explicit AnalysisQueue(std::filesystem::path store);
  // Ends what runs; what waits is forgotten.
  ~AnalysisQueue();
  AnalysisQueue(const AnalysisQueue&) = delete;
  AnalysisQueue& operator=(const AnalysisQueue&) = delete;

  // The id. Where the same is asked for already and not finished, that one's:
  // two tabs then look at one analysis. Throws std::invalid_argument where too
  // many wait.
  std::string Add(AnalysisOrder order);

  // Does nothing where it is finished; false where there is none of that id.
  bool Cancel(const std::string& id);

  // The last ones, in the order in which they were asked for.
  std::vector<AnalysisStatus> List() const;
  std::optional<AnalysisStatus> Find(const std::string& id) const;

  // A test has become this trial.
  void SetTrial(const std::string& id, const std::string& trial_id);

 private:
  struct Job;

  void Work();
  void Run(Job& job);
  void Test(Job& job);
  void Log(Job& job);
  AnalysisStatus MakeStatus(const Job& job) const;  // under the lock
  void Forget();                                    // under the lock

  const std::filesystem::path store_;
  mutable std::mutex guard_;
  std::condition_variable changed_;
  std::vector<std::shared_ptr<Job>> jobs_;
  std::int64_t last_number_ = 0;
  bool ending_ = false;
  std::thread worker_;
};

}  // namespace touchdown::review
