#include "app/review/desk.h"

#include <fmt/format.h>

#include "app/measure/journal.h"
#include "app/trials/looks.h"

namespace touchdown::review {

Desk::Desk(std::filesystem::path store, std::filesystem::path reports,
           report::ReachOf reach_of, RecordingFolders recordings)
    : store_(std::move(store)),
      reports_(std::move(reports)),
      reach_of_(std::move(reach_of)),
      recordings_(std::move(recordings)),
      analyses_(store_) {}

db::Store Desk::Open(db::OpenMode mode) const {
  return db::Store::Open(store_, mode);
}

bool Desk::HasStore() const {
  // An empty file counts as none: SQLite makes one before it writes to it.
  std::error_code none;
  return std::filesystem::file_size(store_, none) > 0 && !none;
}

std::string Desk::Stamp() const {
  // The stamp is like "4e000.18ad3f2c8d1c2a00.-.": size and time in hexadecimal
  // of each file; "-" stands for one that is not there.
  // What is written goes to the log beside the store first.
  std::string stamp;
  for (const char* suffix : {"", "-wal"}) {
    std::filesystem::path file = store_;
    file += suffix;
    std::error_code none;
    const auto size = std::filesystem::file_size(file, none);
    const auto time = std::filesystem::last_write_time(file, none);
    stamp +=
        none ? std::string("-.")
             : fmt::format("{:x}.{:x}.", size, time.time_since_epoch().count());
  }
  return stamp;
}

std::shared_ptr<const Statistics> Desk::StatisticsNow() {
  // The lock is held while they are made, which takes seconds: who asks
  // meanwhile would otherwise make the same once more.
  const std::lock_guard lock(statistics_guard_);
  if (!statistics_ || Stamp() != statistics_stamp_) {
    // Whoever gets these sees the answers, so the look is recorded first. The
    // journal says it where that fails; the page is shown all the same.
    const std::string trouble = pipeline::KeepLooks(
        store_, pipeline::CampaignsWithAnswer(store_), "review");
    if (!trouble.empty()) {
      pipeline::Journal("this look is not on record: " + trouble);
    }
    // Taken before reading: what changes meanwhile makes them stale; the look
    // does not.
    const std::string stamp = Stamp();
    statistics_ =
        std::make_shared<const Statistics>(MakeStatistics(store_, reach_of_));
    statistics_stamp_ = stamp;
  }
  return statistics_;
}

// A person who steps through a clip asks with every frame; the store is asked
// once as long as it does not change.
std::string Desk::FindClipPath(const std::string& id) {
  const std::lock_guard lock(clips_guard_);
  // A recording may have been found elsewhere meanwhile (relinking.h).
  if (std::string stamp = Stamp(); stamp != clips_stamp_) {
    clips_stamp_ = std::move(stamp);
    clips_.clear();
  }
  const auto known = clips_.find(id);
  if (known != clips_.end()) return known->second;
  const auto trial = Open(db::OpenMode::kRead).Find(id);
  // An id that is not there is not remembered: it may come.
  if (!trial) return "";
  return clips_[id] = trial->clip.path;
}

}  // namespace touchdown::review
