// What the server keeps between requests: where the store is, and answers that
// are dear to make, for as long as the store does not change.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "app/review/analyses.h"
#include "app/review/clip_shelf.h"
#include "app/review/recordings.h"
#include "app/review/statistics.h"
#include "app/review/trial_list.h"
#include "touchdown/db/store.h"

namespace touchdown::review {

class Desk {
 public:
  // `reach_of`: what the next angle stays within; empty: any angle.
  // `recordings`: the folders that recordings are chosen from.
  Desk(std::filesystem::path store, std::filesystem::path reports,
       report::ReachOf reach_of = {}, RecordingFolders recordings = {});

  // A connection of the caller's own: one Store belongs to one thread.
  db::Store Open(db::OpenMode mode) const;
  // Whether there is a store already: one that was named and is not there is
  // made when its first trial is kept (setup.h).
  bool HasStore() const;
  const std::filesystem::path& store() const { return store_; }
  const std::filesystem::path& reports() const { return reports_; }
  const report::ReachOf& reach_of() const { return reach_of_; }

  // Differs whenever the store may have changed: size and time of its files.
  std::string Stamp() const;

  // Boundary, next angle and Table 1, made once for each state of the store.
  // Whoever asks while it is being made waits for it.
  std::shared_ptr<const Statistics> StatisticsNow();

  TriageMemory& triage() { return triage_; }
  ClipShelf& shelf() { return shelf_; }
  const RecordingFolders& recordings() const { return recordings_; }
  AnalysisQueue& analyses() { return analyses_; }

  // Where the recording of a trial was last seen; empty where there is none.
  // Asked for with every frame, so it is remembered.
  std::string FindClipPath(const std::string& id);

 private:
  std::filesystem::path store_;
  std::filesystem::path reports_;
  report::ReachOf reach_of_;

  std::mutex statistics_guard_;
  std::string statistics_stamp_;
  std::shared_ptr<const Statistics> statistics_;
  TriageMemory triage_;
  ClipShelf shelf_;

  std::mutex clips_guard_;
  std::string clips_stamp_;
  std::map<std::string, std::string> clips_;

  RecordingFolders recordings_;
  AnalysisQueue analyses_;
};

}  // namespace touchdown::review
