// A disk that loses power: an SQLite VFS that passes everything on to the real
// one and remembers, for each file, what was brought to the disk and what was
// only written. At any write or sync a picture can be taken of what a power
// loss at that instant could leave: of the writes not yet synced, each sector
// may be there or not, whatever the order, and the last may be torn.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace touchdown::db {

using Bytes = std::vector<char>;
// File name -> contents; what a machine finds after the power is back.
using DiskPicture = std::map<std::string, Bytes>;

class PowerLossDisk {
 public:
  // Becomes SQLite's default VFS for as long as it lives. `on_write` is called
  // after every write, sync, truncation and deletion.
  explicit PowerLossDisk(std::function<void()> on_write);
  ~PowerLossDisk();
  PowerLossDisk(const PowerLossDisk&) = delete;
  PowerLossDisk& operator=(const PowerLossDisk&) = delete;

  DiskPicture AfterPowerLoss(std::mt19937_64& engine) const;

  // --- for the VFS's callbacks -----------------------------------------------
  // `is_log`: a journal or a log; SQLite syncs the folder of a new one with it.
  void Opened(const std::string& name, bool is_log);
  void Wrote(const std::string& name, const void* data, std::size_t size,
             std::int64_t offset);
  void Truncated(const std::string& name, std::int64_t size);
  void Synced(const std::string& name);
  void Deleted(const std::string& name, bool folder_synced);
  sqlite3_vfs& real() const { return *real_; }

 private:
  struct Write {
    std::int64_t offset = 0;
    Bytes data;
    std::int64_t truncate_to = -1;  // >= 0: a truncation, no data
  };
  struct File {
    bool exists = false;
    bool name_synced = false;   // its entry in the folder is on the disk
    bool syncs_folder = false;  // at its next sync
    Bytes synced;
    std::vector<Write> pending;
    // The file of that name before it was deleted; may be back.
    bool has_ghost = false;
    Bytes ghost;
  };

  sqlite3_vfs* real_;
  sqlite3_vfs vfs_{};
  std::function<void()> on_write_;
  std::map<std::string, File> files_;
};

}  // namespace touchdown::db
