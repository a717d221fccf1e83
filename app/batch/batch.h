// Many recordings into the trial store: what `analyze --db` does to one, done
// to each, so that it can be killed and started again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/batch/manifest.h"
#include "app/batch/triage.h"
#include "app/measure/analyze.h"
#include "touchdown/db/store.h"

namespace touchdown::pipeline {

// One recording, with all that decides its trial.
struct BatchClip {
  std::filesystem::path clip;
  std::string name;      // what reports call it
  std::string campaign;  // empty: none
  AnalyzeOptions options;
  std::optional<double> set_angle_rad;
  std::optional<double> set_speed_mps;
};

// Part k of n of a batch: every n-th recording, beginning with the k-th. All
// parts together are the batch, whatever machine each runs on.
struct Shard {
  std::size_t k = 1;  // 1 .. n
  std::size_t n = 1;
};
// "2/8". Throws std::invalid_argument naming `flag`.
Shard ParseShard(const std::string& flag, const std::string& text);
std::vector<BatchClip> SelectShard(std::vector<BatchClip> clips, Shard shard);

// The recordings of a folder or of a manifest. `options` holds for each, a
// manifest's cells first; `campaign` where a manifest names none.
std::vector<BatchClip> ListBatchClips(
    std::span<const std::filesystem::path> recordings,
    const std::filesystem::path& folder, const std::string& campaign,
    const AnalyzeOptions& options);
std::vector<BatchClip> ListBatchClips(std::span<const ManifestRow> rows,
                                      const std::string& campaign,
                                      const AnalyzeOptions& options);

struct BatchProgress {
  std::size_t done = 0;  // logged, known, copies and failed
  std::size_t failed = 0;
  std::size_t all = 0;
  double share = 0.0;                  // of the work, 0..1
  std::optional<double> seconds_left;  // nothing before the first analysis
};

struct BatchOptions {
  // Analyses at a time, each in a thread with at most one recording in memory;
  // 0: one for each core. Decides speed only.
  int jobs = 0;
  // Analyse also what is known, and what is set aside (set_aside.h).
  bool again = false;
  // Where the evidence of each recording goes, in a folder of its name; empty:
  // none is written.
  std::filesystem::path evidence = {};
  // Of each shot. Nothing: those stated before, if any, stay in force.
  std::optional<core::Conditions> conditions = {};
  // Of each trial: why it is stated.
  std::string reason = {};
  // Called from any thread, one call at a time. May be empty.
  std::function<void(const BatchProgress&)> progress = {};
  // Looked at before each recording: true ends the batch early. May be empty.
  std::function<bool()> stop = {};
};

// Analyses `clips` and logs each trial as soon as it and all before it are
// done, so that the store and the result do not depend on `jobs`. What the
// store knows already (FindLogged: same clip id in the same campaign, same
// options hash, same set-points where `clips` gives them) is not analysed
// again: a batch that was killed goes on where it was. A recording that cannot
// be analysed or logged is an entry with its reason and stops nothing; trouble
// with the store itself (core::StoreError) ends the batch.
//
// One entry a recording, in the order of `clips`; fewer if `stop` said so or an
// analysis was interrupted (AnalyzeOptions::interrupted): what was under way
// then leaves nothing.
// Throws core::StoreError also if a campaign does not exist.
std::vector<TriageEntry> RunBatch(db::Store& store,
                                  std::span<const BatchClip> clips,
                                  const BatchOptions& options = {});

}  // namespace touchdown::pipeline
