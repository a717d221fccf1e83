#include "app/review/analyses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "app/batch/batch.h"
#include "app/documents/log_analysis.h"
#include "app/measure/options_hash.h"
#include "app/text/format.h"
#include "touchdown/core/cancellation.h"
#include "touchdown/core/units.h"
#include "touchdown/db/store.h"

namespace touchdown::review {
namespace {

// Finished ones that can still be looked at. 32: an hour at the rig.
constexpr std::size_t kMostFinished = 32;
// Of those that are not. A folder of more is for `touchdown batch`.
constexpr std::size_t kMostWaiting = 64;

// Says whether nothing more happens to an analysis.
bool IsFinished(AnalysisState state) {
  return state != AnalysisState::kWaiting && state != AnalysisState::kRunning;
}

// Says whether two orders ask for the same analysis, so that two tabs look at
// one. Who asked plays no part. `again` does: an order without it is answered
// by what the store knows.
bool IsSame(const AnalysisOrder& a, const AnalysisOrder& b) {
  // Returns the hash of what the analysis is told. Of a test the campaign is
  // not in the store and may differ under one name, so its conventions are
  // hashed, too.
  const auto told = [](const AnalysisOrder& order) {
    pipeline::AnalyzeOptions options = order.camera;
    if (order.is_test) pipeline::FillFromCampaign(order.campaign, options);
    return pipeline::OptionsHash(options);
  };
  return a.path == b.path && a.is_test == b.is_test && a.again == b.again &&
         a.campaign.name == b.campaign.name &&
         a.set_angle_rad == b.set_angle_rad &&
         a.set_speed_mps == b.set_speed_mps && a.conditions == b.conditions &&
         told(a) == told(b);
}

// Returns the answer in a few words, for the list on the page: "approach angle
// 20.013 ± 0.048 deg, bounce".
std::string Said(const pipeline::TriageEntry& entry) {
  const std::string state =
      entry.state ? std::string(core::Name(*entry.state)) : "no state";
  if (!entry.angle_rad || !entry.angle_kind) return state;
  return fmt::format("{} angle {} deg, {}", core::Name(*entry.angle_kind),
                     report::WithU(*entry.angle_rad, core::kDegree), state);
}

}  // namespace

std::string_view Name(AnalysisState state) {
  switch (state) {
    case AnalysisState::kWaiting:
      return "waiting";
    case AnalysisState::kRunning:
      return "running";
    case AnalysisState::kDone:
      return "done";
    case AnalysisState::kKnown:
      return "known";
    case AnalysisState::kCancelled:
      return "cancelled";
    case AnalysisState::kFailed:
      break;
  }
  return "failed";
}

// The job is one analysis. The worker's progress and the person's wish to end
// it cross threads without the queue's lock: a frame must not wait for it.
// `status.order` does not change after Add, so the worker reads it without the
// lock.
struct AnalysisQueue::Job {
  AnalysisStatus status;  // under the queue's lock
  std::atomic<double> share = 0.0;
  std::atomic<bool> interrupted = false;
};

AnalysisQueue::AnalysisQueue(std::filesystem::path store)
    : store_(std::move(store)), worker_([this] { Work(); }) {}

AnalysisQueue::~AnalysisQueue() {
  {
    // The one that runs ends at its next look at `interrupted`; the worker is
    // then waited for, since it uses this object.
    const std::lock_guard lock(guard_);
    ending_ = true;
    for (const auto& job : jobs_) job->interrupted = true;
  }
  changed_.notify_all();
  worker_.join();
}

std::string AnalysisQueue::Add(AnalysisOrder order) {
  const std::lock_guard lock(guard_);
  std::size_t waiting = 0;
  for (const auto& job : jobs_) {
    // One that was cancelled and still runs counts as finished: it must not be
    // the answer to a new request.
    if (IsFinished(job->status.state) || job->interrupted) continue;
    if (IsSame(job->status.order, order)) return job->status.id;
    ++waiting;
  }
  if (waiting >= kMostWaiting) {
    throw std::invalid_argument(fmt::format(
        "{} recordings wait already; analyse a whole folder with `touchdown "
        "batch`",
        waiting));
  }
  const auto job = std::make_shared<Job>();
  // Numbers count from 1 in each run of the server; none is used twice.
  job->status.id = fmt::format("{}", ++last_number_);
  job->status.order = std::move(order);
  jobs_.push_back(job);
  changed_.notify_all();
  return job->status.id;
}

bool AnalysisQueue::Cancel(const std::string& id) {
  const std::lock_guard lock(guard_);
  for (const auto& job : jobs_) {
    if (job->status.id != id) continue;
    // One that runs ends by itself, soon, and says so; one that waits never
    // begins.
    job->interrupted = true;
    if (job->status.state == AnalysisState::kWaiting) {
      job->status.state = AnalysisState::kCancelled;
    }
    return true;
  }
  return false;
}

// Copies what the page asks for. The progress is told in frames, as people
// count; `ahead` counts the unfinished ones that were asked for before.
AnalysisStatus AnalysisQueue::MakeStatus(const Job& job) const {
  AnalysisStatus status = job.status;
  status.frames_done = std::llround(std::clamp(job.share.load(), 0.0, 1.0) *
                                    static_cast<double>(status.order.frames));
  for (const auto& other : jobs_) {
    if (other.get() == &job) break;
    if (!IsFinished(other->status.state)) ++status.ahead;
  }
  return status;
}

std::vector<AnalysisStatus> AnalysisQueue::List() const {
  const std::lock_guard lock(guard_);
  std::vector<AnalysisStatus> out;
  for (const auto& job : jobs_) out.push_back(MakeStatus(*job));
  return out;
}

std::optional<AnalysisStatus> AnalysisQueue::Find(const std::string& id) const {
  const std::lock_guard lock(guard_);
  for (const auto& job : jobs_) {
    if (job->status.id == id) return MakeStatus(*job);
  }
  return std::nullopt;
}

// A test that was kept remembers its trial: a second tab that keeps it as well
// gets the same one.
void AnalysisQueue::SetTrial(const std::string& id,
                             const std::string& trial_id) {
  const std::lock_guard lock(guard_);
  for (const auto& job : jobs_) {
    if (job->status.id == id) job->status.trial_id = trial_id;
  }
}

// Drops the oldest finished ones beyond kMostFinished, so that memory does not
// grow with the day: a test holds a whole track.
void AnalysisQueue::Forget() {
  std::size_t over = 0;
  for (const auto& job : jobs_) over += IsFinished(job->status.state) ? 1 : 0;
  std::erase_if(jobs_, [&](const auto& job) {
    if (over <= kMostFinished || !IsFinished(job->status.state)) return false;
    --over;
    return true;
  });
}

// The worker's loop: one analysis at a time, since each may use all cores.
void AnalysisQueue::Work() {
  while (true) {
    std::shared_ptr<Job> next;
    {
      std::unique_lock lock(guard_);
      const auto is_waiting = [](const auto& job) {
        return job->status.state == AnalysisState::kWaiting;
      };
      changed_.wait(lock, [&] {
        return ending_ || std::ranges::any_of(jobs_, is_waiting);
      });
      if (ending_) return;
      next = *std::ranges::find_if(jobs_, is_waiting);
      next->status.state = AnalysisState::kRunning;
    }
    // The lock is not held: it takes seconds, and the page asks for progress
    // meanwhile.
    Run(*next);
    const std::lock_guard lock(guard_);
    Forget();
  }
}

// Runs one job and turns whatever is thrown into its state: nothing may end the
// worker.
void AnalysisQueue::Run(Job& job) {
  const auto end = [&](AnalysisState state, const std::string& trouble) {
    const std::lock_guard lock(guard_);
    job.status.state = state;
    job.status.trouble = trouble;
  };
  try {
    if (job.status.order.is_test) {
      Test(job);
    } else {
      Log(job);
    }
  } catch (const core::Cancelled&) {
    end(AnalysisState::kCancelled, "");
  } catch (const std::exception& error) {
    end(AnalysisState::kFailed, error.what());
  }
}

// Analyses with the settings of a campaign that is not stored yet. The result
// stays in memory until a person keeps or forgets it.
void AnalysisQueue::Test(Job& job) {
  const AnalysisOrder& order = job.status.order;
  pipeline::AnalyzeOptions options = order.camera;
  pipeline::FillFromCampaign(order.campaign, options);
  options.limit_s = pipeline::kUsualLimit_s;
  options.interrupted = &job.interrupted;
  options.progress = [&job](double share) { job.share = share; };
  auto analysis = std::make_shared<pipeline::Analysis>(
      pipeline::Analyze(order.path, options));
  // It outlives what it was told by.
  analysis->options.interrupted = nullptr;
  analysis->options.progress = nullptr;
  if (job.interrupted) throw core::Cancelled("ended before it was looked at");
  const std::lock_guard lock(guard_);
  job.status.analysis = std::move(analysis);
  job.status.state = AnalysisState::kDone;
}

// Analyses and logs by a batch of one clip, so that the page and `touchdown
// batch` know and skip the same recordings.
void AnalysisQueue::Log(Job& job) {
  const AnalysisOrder& order = job.status.order;
  pipeline::BatchClip clip;
  clip.clip = order.path;
  clip.name = order.recording.name;
  clip.campaign = order.campaign.name;
  clip.options = order.camera;
  clip.options.limit_s = pipeline::kUsualLimit_s;
  clip.options.interrupted = &job.interrupted;
  clip.set_angle_rad = order.set_angle_rad;
  clip.set_speed_mps = order.set_speed_mps;
  pipeline::BatchOptions options;
  options.jobs = 1;
  options.again = order.again;
  options.conditions = order.conditions;
  options.reason = "logged on the review page by " + order.who;
  options.progress = [&job](const pipeline::BatchProgress& progress) {
    job.share = progress.share;
  };
  options.stop = [&job] { return job.interrupted.load(); };
  // The thread has a connection of its own: one Store belongs to one thread.
  db::Store store = db::Store::Open(store_, db::OpenMode::kWrite);
  const auto entries = pipeline::RunBatch(store, {&clip, 1}, options);
  // No entry means that `stop` said so.
  if (entries.empty()) throw core::Cancelled("ended before it was logged");
  const pipeline::TriageEntry& entry = entries.front();
  const std::lock_guard lock(guard_);
  switch (entry.done) {
    case pipeline::Done::kLogged:
      job.status.state = AnalysisState::kDone;
      break;
    case pipeline::Done::kKnown:
    case pipeline::Done::kCopy:
      job.status.state = AnalysisState::kKnown;
      break;
    case pipeline::Done::kFailed:
      job.status.state = AnalysisState::kFailed;
      job.status.trouble = entry.reason;
      return;
  }
  job.status.trial_id = entry.trial_id;
  job.status.said = Said(entry);
}

}  // namespace touchdown::review
