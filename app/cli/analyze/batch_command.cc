// touchdown batch brings a folder of recordings, or a manifest, into the trial
// store. Without --watch the recordings are listed, cut down to this machine's
// share (--shard), analysed and logged (app/batch), and a table says which of
// them a person should look at. With --watch the same happens to each recording
// as soon as it is complete, until a signal ends the command.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/batch/batch.h"
#include "app/cli/analyze/analyze_flags.h"
#include "app/cli/analyze/folder_watch.h"
#include "app/cli/command.h"
#include "app/cli/interruption.h"
#include "app/cli/options.h"
#include "app/cli/progress.h"
#include "app/cli/store/condition_flags.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/documents/log_analysis.h"
#include "app/text/text_file.h"
#include "app/trials/recordings.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/register.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;
using pipeline::TriageEntry;

// Holds the flags as typed. `source` is a folder or a manifest.csv; `jobs` 0
// means one analysis on each core; an empty `out` means that no evidence is
// written.
struct BatchFlags {
  std::string source;
  std::string db;
  std::string campaign;
  std::string campaign_from;
  ConditionFlags conditions;
  AnalyzeFlags analyze;
  int jobs = 0;
  std::string shard;
  bool again = false;
  bool watch = false;
  std::string out;
  bool json = false;
  bool columns = false;
};

// The handler of SIGINT and SIGTERM shares this state with the watch. The
// handler may interrupt any instruction, so each must be lock-free.
// watch_interrupted ends the waiting, and the analysis that goes on
// (AnalyzeOptions::interrupted); analysing_batch tells the handler that there
// is one.
std::atomic<bool> watch_interrupted = false;
std::atomic<bool> analysing_batch = false;
// Holds the number of the signal that cut an analysis off; 0 where none did.
std::atomic<int> batch_ended_by = 0;
static_assert(std::atomic<bool>::is_always_lock_free);
static_assert(std::atomic<int>::is_always_lock_free);

// While the watch only waits, a signal ends it in good order. During an
// analysis the process must end soon in any case, since a decoder may look at
// no flag: EndSoon() sees to it. The next run analyses that recording again.
void OnWatchSignal(int signal) {
  watch_interrupted = true;
  if (!analysing_batch) return;
  batch_ended_by = signal;
  EndSoon(signal);
}

// Only --watch catches signals: a plain batch has nothing to end in good order,
// and leaves them to interruption.h.
void CatchWatchSignals() {
  struct sigaction action = {};
  action.sa_handler = OnWatchSignal;  // without SA_RESTART: waiting ends
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// Prints the columns that a manifest.csv may have (`batch --columns`). This
// needs neither a store nor recordings.
int PrintManifestColumns() {
  std::vector<std::vector<std::string>> rows = {{"column", "meaning"}};
  for (const auto& column : pipeline::ManifestColumns()) {
    rows.push_back({std::string(column.name), std::string(column.meaning)});
  }
  fmt::print("{}", Aligned(rows));
  return 0;
}

// Opens --db for writing. Without a campaign a new store is made where there is
// none; with --campaign alone, or conditions that name entries of its register,
// the store must be there. With --campaign-from a new store is made, too, and
// the campaign, its plan and the register's entries are copied into it from
// that other store: so shards on several machines, each with a store of its
// own, log by the same conventions.
db::Store OpenStore(const BatchFlags& flags,
                    const std::optional<core::Conditions>& conditions) {
  if (flags.campaign_from.empty()) {
    const bool refers =
        !flags.campaign.empty() || (conditions && db::NameEntries(*conditions));
    return db::Store::Open(
        flags.db, refers ? db::OpenMode::kWrite : db::OpenMode::kCreate);
  }
  if (flags.campaign.empty()) {
    throw std::invalid_argument(
        "--campaign is missing; --campaign-from needs the campaign's name");
  }
  const auto from = db::Store::Open(flags.campaign_from, db::OpenMode::kRead);
  const core::Campaign campaign =
      pipeline::RequireCampaign(from, flags.campaign);
  // A new store gets its register from there: a condition that names none of
  // its entries is refused before the store is made.
  if (conditions && !fs::exists(flags.db)) db::Resolved(from, *conditions);
  auto store = db::Store::Open(flags.db, db::OpenMode::kCreate);
  // A campaign that --db has already is left alone: if its conventions
  // differed, Restore() would add it a second time under another name.
  std::vector<core::Campaign> missing;
  if (!store.FindCampaign(campaign.name)) missing.push_back(campaign);
  // No trials are copied: the history ends before the first.
  db::Restore(store, from.uuid(), db::AllVersions(from), missing,
              db::PlanEvents(from, campaign.name), [] { return std::nullopt; });
  return store;
}

// Returns "bounce", "undecided, P(bounce) 0.412", or "-" where there is no
// trial.
std::string StateText(const TriageEntry& entry) {
  if (!entry.state) return "-";
  std::string text(core::Name(*entry.state));
  if (*entry.state == core::MotionState::kUndecided && entry.p_bounce) {
    text += fmt::format(", P(bounce) {:.3f}", *entry.p_bounce);
  }
  return text;
}

// Returns "approach 20.013 +- 0.048" in degrees, or "-" where there is no
// angle.
std::string AngleText(const TriageEntry& entry) {
  return entry.angle_rad ? fmt::format("{} {}", core::Name(*entry.angle_kind),
                                       WithU(entry.angle_rad, core::kDegree))
                         : std::string("-");
}

// Prints a table of the recordings that a person should look at, in the order
// of `entries`, and a line with the counts of all. Names and reasons come from
// files, so they are made printable.
void PrintTriage(const std::vector<TriageEntry>& entries) {
  std::vector<std::vector<std::string>> rows = {
      {"look at", "recording", "state", "angle, deg", "because"}};
  for (const TriageEntry& entry : entries) {
    if (entry.attention == pipeline::Attention::kNone) continue;
    rows.push_back({std::string(pipeline::Name(entry.attention)),
                    Printable(entry.clip), StateText(entry), AngleText(entry),
                    Printable(entry.reason)});
  }
  if (rows.size() > 1) fmt::print("{}", Aligned(rows));
  const pipeline::TriageCounts counts = pipeline::Count(entries);
  fmt::print(
      "{} recordings: {} logged, {} known already, {} copies, {} failed; {} to "
      "look at\n",
      entries.size(), counts.logged, counts.known, counts.copies, counts.failed,
      counts.to_look_at);
}

// Reports on a batch: triage.csv in --out, then a table or touchdown.batch/1 on
// stdout. Returns the exit status: 5 where a recording failed, else 0.
int FinishBatch(std::vector<TriageEntry> entries, const BatchFlags& flags) {
  pipeline::SortByNeed(entries);
  if (!flags.out.empty()) {
    std::error_code trouble;  // writing says what is wrong
    fs::create_directories(flags.out, trouble);
    report::WriteTextFile(fs::path(flags.out) / "triage.csv",
                          pipeline::TriageCsv(entries));
  }
  // The checks of scale, frame rate and size take all trials of a campaign, so
  // the store is read anew instead of this batch's entries.
  const std::vector<pipeline::CampaignWord> campaigns = pipeline::CampaignWords(
      db::Store::Open(flags.db, db::OpenMode::kRead), entries);
  if (flags.json) {
    fmt::print("{}\n", pipeline::TriageJson(entries, campaigns));
  } else {
    PrintTriage(entries);
    for (const pipeline::CampaignWord& word : campaigns) {
      // Text tells of failed checks only; the JSON has a sentence for each.
      if (!word.failed) continue;
      fmt::print("campaign {}: {}\n", Printable(word.campaign),
                 Printable(word.sentence));
    }
  }
  const std::size_t failed = pipeline::Count(entries).failed;
  if (failed == 0) return 0;
  // The advice goes to stderr: stdout carries results only.
  Tell(
      fmt::format("{} of {} recordings failed; the list says why, and the "
                  "same command tries them once more (--again: always)",
                  failed, entries.size()));
  return 5;
}

// Returns the options of one RunBatch(), which draws its progress on `bar`. The
// conditions name entries of the register: each is fixed to the version that is
// in force at this moment. Throws std::invalid_argument for a condition that
// names no entry.
pipeline::BatchOptions MakeOptions(
    const BatchFlags& flags, const std::optional<core::Conditions>& conditions,
    const db::Store& store, ProgressBar& bar) {
  pipeline::BatchOptions options;
  if (conditions) options.conditions = db::Resolved(store, *conditions);
  options.jobs = flags.jobs;
  options.again = flags.again;
  options.evidence = flags.out;
  options.progress = [&bar](const pipeline::BatchProgress& progress) {
    bar.Show(progress.share, progress.seconds_left,
             fmt::format("{} of {}, {} failed, ", progress.done, progress.all,
                         progress.failed));
  };
  // Nobody sets the flag without --watch.
  options.stop = [] { return watch_interrupted.load(); };
  return options;
}

// Analyses and logs every recording of the folder once it has stopped growing,
// until SIGINT or SIGTERM. Prints a line for each at once, and the report of
// all at the end. Returns the status of FinishBatch(), or 128 + signal where
// the signal cut an analysis off.
int WatchFolder(const BatchFlags& flags,
                const std::optional<core::Conditions>& conditions,
                pipeline::AnalyzeOptions analyze) {
  analyze.interrupted = &watch_interrupted;
  auto store = OpenStore(flags, conditions);
  // Opening the store may wait for another process, so the signals are caught
  // afterwards: until here Ctrl-C ends the program at once.
  CatchWatchSignals();
  std::vector<TriageEntry> all;
  // Watch() calls this with the recordings that have become complete.
  const auto take = [&](const std::vector<fs::path>& complete) {
    ProgressBar bar("batch");
    analysing_batch = true;
    const auto entries =
        pipeline::RunBatch(store,
                           pipeline::ListBatchClips(complete, flags.source,
                                                    flags.campaign, analyze),
                           MakeOptions(flags, conditions, store, bar));
    analysing_batch = false;
    bar.Finish();
    for (const TriageEntry& entry : entries) {
      if (!flags.json) {
        fmt::print("{}  {}  {}  {}\n", Printable(entry.clip), StateText(entry),
                   AngleText(entry), Printable(entry.reason));
        // A person, or a pipe's reader, sees each line when its recording is
        // done.
        std::fflush(stdout);
      }
      // One that had been taken too early is taken again.
      std::erase_if(all,
                    [&](const auto& one) { return one.clip == entry.clip; });
      all.push_back(entry);
    }
  };
  // inotify only shortens the wait. Whether a recording is complete follows
  // from its size and age alone (pipeline::Settling).
  FolderWatch changes(flags.source);
  pipeline::WatchOptions options;
  options.now = [] { return std::chrono::steady_clock::now(); };
  options.wait = [&](bool growing) {
    // inotify hears nothing of a network drive, so the folder is looked at now
    // and then.
    constexpr std::chrono::milliseconds kNowAndThen{10000};
    if (!watch_interrupted) {
      changes.Wait(growing ? pipeline::Settling::kQuiet : kNowAndThen);
    }
    return !watch_interrupted;
  };
  // Returns when options.wait says that a signal came.
  pipeline::Watch(flags.source, options, take);
  const int status = FinishBatch(std::move(all), flags);
  return batch_ended_by != 0 ? kBySignal + batch_ended_by : status;
}

// Lists the recordings with the options of each: those that lie in the folder
// or below it, or those that the manifest names. Throws core::InputError where
// a folder holds none, or the manifest cannot be read.
std::vector<pipeline::BatchClip> ListClips(
    const BatchFlags& flags, const pipeline::AnalyzeOptions& analyze) {
  if (!fs::is_directory(flags.source)) {
    return pipeline::ListBatchClips(pipeline::ReadManifest(flags.source),
                                    flags.campaign, analyze);
  }
  const auto recordings = pipeline::FindRecordings(flags.source);
  if (recordings.empty()) {
    throw core::InputError(fmt::format(
        "{}: no recording in this folder; videos, .mraw or folders of images "
        "were expected",
        flags.source));
  }
  return pipeline::ListBatchClips(recordings, flags.source, flags.campaign,
                                  analyze);
}

// Checks the flags and runs the batch. Throws std::invalid_argument naming the
// flag that is missing or impossible.
int RunBatch(const BatchFlags& flags) {
  if (flags.columns) return PrintManifestColumns();
  if (flags.source.empty()) {
    throw std::invalid_argument(
        "FOLDER is missing, must be a folder of recordings or a manifest.csv");
  }
  RequireDb(flags.db);
  // Each analysis is a thread that holds part of a recording in memory; more
  // than this is a typing error.
  constexpr int kMaxJobs = 1024;
  if (flags.jobs < 0 || flags.jobs > kMaxJobs) {
    throw std::invalid_argument(
        fmt::format("--jobs is {}, must be 1 to {}, or 0 for one on each core",
                    flags.jobs, kMaxJobs));
  }
  // The flags of the analysis and the conditions are parsed before any
  // recording is listed or the store is made.
  const pipeline::AnalyzeOptions analyze = ToOptions(flags.analyze);
  std::optional<core::Conditions> conditions;
  ApplyConditions(flags.conditions, conditions);
  if (flags.watch) {
    if (!fs::is_directory(flags.source)) {
      throw std::invalid_argument(fmt::format(
          "FOLDER is '{}', must be a folder with --watch: the one that "
          "recordings appear in",
          flags.source));
    }
    if (!flags.shard.empty()) {
      throw std::invalid_argument(
          fmt::format("--shard is '{}', must be left out with --watch, which "
                      "takes every recording",
                      flags.shard));
    }
    return WatchFolder(flags, conditions, analyze);
  }
  auto clips = ListClips(flags, analyze);
  // The list has the same order on every machine that sees the same folder or
  // manifest, so that all shards together are the whole batch.
  if (!flags.shard.empty()) {
    clips = pipeline::SelectShard(std::move(clips),
                                  pipeline::ParseShard("--shard", flags.shard));
  }
  auto store = OpenStore(flags, conditions);
  ProgressBar bar("batch");
  auto entries = pipeline::RunBatch(store, clips,
                                    MakeOptions(flags, conditions, store, bar));
  bar.Finish();
  return FinishBatch(std::move(entries), flags);
}

}  // namespace

void AddBatch(CLI::App& app, Action& action) {
  auto flags = std::make_shared<BatchFlags>();
  CLI::App* command = AddCommand(
      app, "batch",
      "analyse and log many recordings; can be killed and started again");
  AddOption(*command, "FOLDER", flags->source,
            "a folder of recordings (looked through with all below it), or a "
            "manifest.csv that lists them with their set-points");
  AddOption(*command, "--db", flags->db,
            "the trial store; what it knows is not analysed again");
  AddOption(*command, "--campaign", flags->campaign,
            "the campaign of the trials; body, sizes, angle kind and bounce "
            "height are then the campaign's where not given");
  AddOption(*command, "--campaign-from", flags->campaign_from,
            "another store that has the campaign: its conventions are copied "
            "where --db lacks it");
  AddOption(*command, "--jobs", flags->jobs,
            "analyses at a time; 0: one on each core")
      .ShowDefault();
  AddOption(*command, "--shard", flags->shard,
            "only part k of n, as 2/8; use one --db a part, then `db merge`");
  AddFlag(*command, "--again", flags->again,
          "analyse also what is known (a further revision of each) and what "
          "failed twice");
  AddFlag(*command, "--watch", flags->watch,
          "go on with new recordings of the folder, each when it has stopped "
          "growing; ends with Ctrl-C");
  AddOption(*command, "--out", flags->out,
            "write triage.csv, and each recording's evidence in a folder of "
            "its name");
  AddFlag(*command, "--json", flags->json, "one JSON document on stdout");
  AddFlag(*command, "--columns", flags->columns,
          "print the columns of a manifest");
  AddConditionFlag(*command, flags->conditions);
  AddAnalyzeFlags(*command, flags->analyze);
  SetAction(*command, action, [flags] { return RunBatch(*flags); });
}

}  // namespace touchdown::cli
