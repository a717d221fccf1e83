#include "app/batch/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <variant>

#include "app/batch/set_aside.h"
#include "app/documents/evidence.h"
#include "app/documents/log_analysis.h"
#include "app/documents/pictures.h"
#include "app/measure/journal.h"
#include "app/measure/options_hash.h"
#include "app/text/parse_number.h"
#include "touchdown/core/cancellation.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;

// Where a recording's evidence goes: its own path below `root`. What lies
// elsewhere keeps its whole path.
fs::path EvidenceFolder(const fs::path& root, const BatchClip& clip) {
  fs::path name = fs::path(clip.name).lexically_normal();
  if (!name.has_filename()) name = name.parent_path();  // a slash at the end
  if (name.is_absolute() || name.empty() || *name.begin() == "..") {
    name = fs::absolute(clip.clip).lexically_normal().relative_path();
  }
  return root / name;
}

// The store has the answer already; nothing was analysed.
struct Known {
  std::string trial_id;
};
// There is no answer: the clip cannot be read, its analysis failed, or it is
// set aside.
struct Failed {
  std::string reason;
};

// What a thread found out about one recording.
struct Answer {
  std::string clip_id;  // empty where it could not be read
  std::variant<Failed, Known, core::Trial> what;
  bool analysed = false;
  // Empty until the clip's id is known: a clip that cannot even be read is not
  // set aside.
  SetAside::Key key = {};
};

// Runs one batch.
//
//   Work (jobs_ threads): Claim -> AnswerClip -> waiting_ -> Settle
//
// Threads analyse in any order; Settle logs strictly in the order of the list,
// so that trials, revisions and copies are the same with any number of jobs.
// One lock guards the store and all that the threads share; it is not held
// while a clip is analysed.
class Batch {
 public:
  Batch(db::Store& store, std::span<const BatchClip> clips,
        const BatchOptions& options)
      : store_(store),
        clips_(clips),
        options_(options),
        set_aside_(store.path()) {
    // With fewer jobs than cores the cores are divided among the decoders.
    // Speed alone depends on it.
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    jobs_ = options.jobs > 0 ? static_cast<std::size_t>(options.jobs) : cores;
    jobs_ = std::max<std::size_t>(1, std::min(jobs_, clips.size()));
    decoder_threads_ =
        static_cast<std::int32_t>(std::max<std::size_t>(1, cores / jobs_));
    window_ = kAhead * jobs_;
    shares_.resize(clips.size());
    for (const BatchClip& clip : clips) {
      // Before any work: a campaign that is not there ends the batch at once.
      if (clip.campaign.empty() || campaigns_.contains(clip.campaign)) continue;
      campaigns_[clip.campaign] = RequireCampaign(store, clip.campaign);
    }
  }

  // Analyses all clips; returns their entries in the order of the list, fewer
  // where the batch was stopped. Rethrows the first trouble with the store.
  std::vector<TriageEntry> Run() {
    start_ = std::chrono::steady_clock::now();
    {
      // The threads are joined at the end of this block, before their result is
      // looked at.
      std::vector<std::jthread> threads;
      for (std::size_t i = 0; i < jobs_; ++i) {
        threads.emplace_back([this] { Work(); });
      }
    }
    if (fatal_) std::rethrow_exception(fatal_);
    return std::move(entries_);
  }

 private:
  // How many recordings a job may be ahead of the slowest. Each that waits is a
  // trial in memory, some kilobytes; more would be lost if the batch is killed.
  static constexpr std::size_t kAhead = 4;

  // What one thread does until nothing is left to claim. A clip's own failure
  // is an answer; what is thrown here concerns the whole batch.
  void Work() {
    while (const auto index = Claim()) {
      try {
        Answer answer = AnswerClip(clips_[*index], *index);
        const std::lock_guard lock(mutex_);
        waiting_.emplace(*index, std::move(answer));
        Settle();
      } catch (const core::Cancelled&) {  // as `stop` would, but at once
        const std::lock_guard lock(mutex_);
        stopped_ = true;
      } catch (...) {  // trouble with the store: the batch ends
        const std::lock_guard lock(mutex_);
        if (!fatal_) fatal_ = std::current_exception();
      }
      changed_.notify_all();
    }
  }

  // Returns the place of the next clip in the list, nothing where the batch
  // ends. Waits while this thread would get too far ahead of the slowest
  // (kAhead).
  std::optional<std::size_t> Claim() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] {
      return fatal_ || stopped_ || next_ == clips_.size() ||
             next_ < entries_.size() + window_;
    });
    stopped_ = stopped_ || (options_.stop && options_.stop());
    if (fatal_ || stopped_ || next_ == clips_.size()) return std::nullopt;
    return next_++;
  }

  // Makes a clip into a trial that is not logged yet, or finds why there is
  // none. Holds the lock only to ask the store. Throws core::StoreError and
  // core::OutputError, which end the batch, and core::Cancelled.
  Answer AnswerClip(const BatchClip& clip, std::size_t index) {
    Answer answer;
    try {
      AnalyzeOptions analyze = clip.options;
      const core::Campaign* campaign = nullptr;
      if (!clip.campaign.empty()) {
        campaign = &campaigns_.at(clip.campaign);
        // The campaign's conventions belong to the options before they are
        // hashed: the hash must be that of the analysis that would be made.
        FillFromCampaign(*campaign, analyze);
      }
      answer.clip_id = vision::ClipId(clip.clip);
      if (!options_.again) {
        const std::lock_guard lock(mutex_);
        const auto last = store_.FindLogged(clip.campaign, answer.clip_id);
        // A set-point that the list does not give asks for nothing.
        const auto same = [](const std::optional<double>& wanted,
                             const std::optional<double>& there) {
          return !wanted || wanted == there;
        };
        // The same clip, options and set-points: a batch that was killed goes
        // on behind what it has logged.
        if (last && last->options_hash == OptionsHash(analyze) &&
            same(clip.set_angle_rad, last->set_angle_rad) &&
            same(clip.set_speed_mps, last->set_speed_mps)) {
          answer.what = Known{last->trial_id};
          return answer;
        }
        if (const auto reason =
                set_aside_.FindReason({answer.clip_id, OptionsHash(analyze)})) {
          answer.what = Failed{*reason};
          return answer;
        }
      }
      answer.key = {answer.clip_id, OptionsHash(analyze)};
      // Threads and progress are set after the hash was taken: they decide no
      // answer.
      analyze.decoder_threads = decoder_threads_;
      analyze.progress = [this, index](double share) {
        const std::lock_guard lock(mutex_);
        shares_[index] = std::clamp(share, 0.0, 1.0);
        Report();
      };
      answer.analysed = true;
      Journal("batch: " + clip.name + " begins");
      const Analysis analysis = Analyze(clip.clip, analyze);
      // The evidence is written before the trial is logged: whoever finds a
      // trial in the store finds its evidence, too.
      if (!options_.evidence.empty()) {
        WriteEvidence(analysis, EvidenceFolder(options_.evidence, clip));
      }
      core::Trial trial = LoggableTrial(analysis, campaign);
      trial.set_angle_rad = clip.set_angle_rad;
      trial.set_speed_mps = clip.set_speed_mps;
      trial.conditions = options_.conditions;
      trial.reason = options_.reason;
      // A person who cancels between the analysis and this line must not find a
      // trial.
      if (analyze.interrupted != nullptr && *analyze.interrupted) {
        throw core::Cancelled(clip.name + ": ended before it was logged");
      }
      // Beside the store and for people; a picture that fails does not fail the
      // trial.
      KeepPicture(store_.path(), trial);
      answer.what = std::move(trial);
    } catch (const core::StoreError&) {
      // A store or a disk that takes nothing fails every further clip as well.
      throw;
    } catch (const core::OutputError&) {
      throw;
    } catch (const core::Cancelled&) {
      // Whoever cancelled wants all of the batch to end.
      throw;
    } catch (const std::exception& error) {
      // All else concerns this clip alone: the batch goes on.
      answer.what = Failed{error.what()};
      const std::lock_guard lock(mutex_);
      NoteFailure(clip, answer.key, error.what());
    }
    return answer;
  }

  // Keeps a failure for the journal and for the next start. Under the lock.
  void NoteFailure(const BatchClip& clip, const SetAside::Key& key,
                   const std::string& reason) {
    Journal("batch: " + clip.name + " failed: " + reason);
    set_aside_.Failed(key, clip.name, reason);
  }

  // Logs what is next in order, as far as it is there. Under the lock.
  void Settle() {
    while (!waiting_.empty() && waiting_.begin()->first == entries_.size()) {
      const Answer answer = std::move(waiting_.begin()->second);
      waiting_.erase(waiting_.begin());
      const std::size_t index = entries_.size();
      entries_.push_back(MakeEntry(clips_[index], answer));
      analysed_ += answer.analysed ? 1 : 0;
      failed_ += entries_.back().done == Done::kFailed ? 1 : 0;
      Report();
    }
  }

  // Logs the answer and returns its entry. Under the lock, in the order of the
  // list: of two copies of a recording the first in the list is logged. Throws
  // core::StoreError.
  TriageEntry MakeEntry(const BatchClip& clip, const Answer& answer) {
    TriageEntry entry;
    entry.clip = clip.name;
    if (!answer.clip_id.empty()) {
      const auto [first, is_new] =
          first_of_.try_emplace({clip.campaign, answer.clip_id}, clip.name);
      if (!is_new) {
        entry.done = Done::kCopy;
        entry.attention = Attention::kCopy;
        entry.reason = fmt::format(
            "the same recording as {}: a campaign has one trial of each",
            first->second);
        return entry;
      }
    }
    if (const auto* failed = std::get_if<Failed>(&answer.what)) {
      entry.reason = failed->reason;
      return entry;
    }
    if (const auto* known = std::get_if<Known>(&answer.what)) {
      return StoredEntry(clip.name, Done::kKnown, known->trial_id);
    }
    try {
      const db::Logged logged =
          store_.LogTrial(std::get<core::Trial>(answer.what));
      return StoredEntry(clip.name, Done::kLogged, logged.id);
    } catch (const std::invalid_argument& refused) {
      entry.reason = refused.what();
      NoteFailure(clip, answer.key, entry.reason);
      return entry;
    }
  }

  // Makes the entry of a trial that is in the store, with the proposal that may
  // wait beside a person's correction. Under the lock.
  TriageEntry StoredEntry(const std::string& name, Done done,
                          const std::string& id) const {
    const auto proposals = store_.Proposals(id);
    return MakeTriageEntry(name, done, RequireTrial(id),
                           proposals.empty() ? nullptr : &proposals.front());
  }

  // Returns the trial of that id. One that is missing was removed from the file
  // by something other than this program.
  core::Trial RequireTrial(const std::string& id) const {
    auto trial = store_.Find(id);
    if (!trial) {
      throw core::StoreError(fmt::format(
          "{}: trial {} was there a moment ago; see `touchdown db check`",
          store_.path().string(), id));
    }
    return *std::move(trial);
  }

  // Under the lock.
  // Tells the caller how far the batch is. `share` counts clips, those begun by
  // the share of them that is analysed.
  void Report() const {
    if (!options_.progress) return;
    BatchProgress progress;
    progress.done = entries_.size();
    progress.failed = failed_;
    progress.all = clips_.size();
    double begun = 0.0;
    for (std::size_t i = entries_.size(); i < next_; ++i) begun += shares_[i];
    const double work = static_cast<double>(entries_.size()) + begun;
    progress.share = work / static_cast<double>(clips_.size());
    // What is known takes no time: only analyses tell how long the rest takes.
    const double analysed = static_cast<double>(analysed_) + begun;
    if (analysed > 0.0) {
      const double gone = std::chrono::duration<double>(
                              std::chrono::steady_clock::now() - start_)
                              .count();
      progress.seconds_left =
          gone / analysed * (static_cast<double>(clips_.size()) - work);
    }
    options_.progress(progress);
  }

  db::Store& store_;  // used under the lock only
  std::span<const BatchClip> clips_;
  const BatchOptions& options_;
  SetAside set_aside_;  // used under the lock only
  std::map<std::string, core::Campaign> campaigns_;
  std::size_t jobs_ = 1;
  std::int32_t decoder_threads_ = 1;
  std::size_t window_ = 1;
  std::chrono::steady_clock::time_point start_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0;  // the first that nobody has claimed
  // Answers that are not logged yet because an earlier clip is not done, by
  // their place in the list.
  std::map<std::size_t, Answer> waiting_;
  // Campaign and clip id to the name of the clip that came first.
  std::map<std::pair<std::string, std::string>, std::string> first_of_;
  std::vector<TriageEntry> entries_;
  std::vector<double> shares_;  // of the analysis of each
  std::size_t analysed_ = 0;
  std::size_t failed_ = 0;
  bool stopped_ = false;
  std::exception_ptr fatal_;
};

}  // namespace

Shard ParseShard(const std::string& flag, const std::string& text) {
  // Without a slash the second part is empty and no number.
  const std::string_view whole = text;
  const std::size_t slash = std::min(whole.find('/'), whole.size());
  const auto k = report::ParseNumber<std::size_t>(whole.substr(0, slash));
  const auto n = report::ParseNumber<std::size_t>(
      whole.substr(std::min(slash + 1, whole.size())));
  if (!k || !n || *k < 1 || *k > *n) {
    throw std::invalid_argument(fmt::format(
        "{} is '{}', must be k/n with k in 1 .. n, as in 2/8", flag, text));
  }
  return {*k, *n};
}

std::vector<BatchClip> SelectShard(std::vector<BatchClip> clips, Shard shard) {
  std::vector<BatchClip> part;
  // Every n-th clip is taken, not a block: neighbours in a folder are of one
  // campaign, and each machine gets some of each.
  for (std::size_t i = shard.k - 1; i < clips.size(); i += shard.n) {
    part.push_back(std::move(clips[i]));
  }
  return part;
}

std::vector<BatchClip> ListBatchClips(std::span<const fs::path> recordings,
                                      const fs::path& folder,
                                      const std::string& campaign,
                                      const AnalyzeOptions& options) {
  std::vector<BatchClip> clips;
  for (const fs::path& recording : recordings) {
    BatchClip clip;
    clip.clip = recording;
    // The name is the path below the folder. A recording that is the folder
    // itself (a folder of images) has none there and keeps its own path.
    clip.name = recording.lexically_relative(folder).string();
    if (clip.name == "." || clip.name.empty()) clip.name = recording.string();
    clip.campaign = campaign;
    clip.options = options;
    clips.push_back(std::move(clip));
  }
  return clips;
}

std::vector<BatchClip> ListBatchClips(std::span<const ManifestRow> rows,
                                      const std::string& campaign,
                                      const AnalyzeOptions& options) {
  std::vector<BatchClip> clips;
  for (const ManifestRow& row : rows) {
    BatchClip clip;
    clip.clip = row.clip;
    clip.name = row.name;
    clip.campaign = row.campaign.value_or(campaign);
    clip.options = options;
    // A row's own rate wins over --fps.
    if (row.fps) clip.options.fps = row.fps;
    clip.set_angle_rad = row.set_angle_rad;
    clip.set_speed_mps = row.set_speed_mps;
    clips.push_back(std::move(clip));
  }
  return clips;
}

std::vector<TriageEntry> RunBatch(db::Store& store,
                                  std::span<const BatchClip> clips,
                                  const BatchOptions& options) {
  if (clips.empty()) return {};
  return Batch(store, clips, options).Run();
}

}  // namespace touchdown::pipeline
