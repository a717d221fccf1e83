// Waiting for files to appear or grow.
#pragma once

#include <chrono>
#include <filesystem>

namespace touchdown::cli {

// Wakes when something happens in a folder or below it (inotify). Where the
// kernel cannot tell (a network drive written to from elsewhere, no watches
// left), the time given is what wakes.
class FolderWatch {
 public:
  explicit FolderWatch(std::filesystem::path folder);
  ~FolderWatch();
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  // Returns after something has happened, after `longest`, or early when a
  // signal came. What happened before the call counts. True: `other`, a file
  // descriptor (-1: none), has something to read.
  bool Wait(std::chrono::milliseconds longest, int other = -1);

 private:
  void AddFolders();

  std::filesystem::path folder_;
  int inotify_ = -1;
};

}  // namespace touchdown::cli
