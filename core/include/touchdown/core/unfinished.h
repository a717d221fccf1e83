// Output that is not complete yet, so that a program that a signal ends leaves
// none of it behind.
//
// What is written under a temporary name, or is of use only together with what
// follows, is on a list of the whole process while an Unfinished lives. Who
// ends the process without unwinding (app/cli/interruption.h) removes all that
// is on it. The list is the one thing that is shared so: a signal is the whole
// process's, too.
#pragma once

#include <filesystem>
#include <mutex>

namespace touchdown::core {

// A file or folder that goes if the process is ended. Made before the file is.
class Unfinished {
 public:
  explicit Unfinished(std::filesystem::path path);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// While it lives, the process is not ended: for the moment in which several
// outputs take their names that are of use only together. For milliseconds: who
// is to end the process waits for kMostTogether, and no longer.
class AllOrNothing {
 public:
  AllOrNothing();

 private:
  std::unique_lock<std::recursive_timed_mutex> lock_;
};

// Removes what is on the list, and lets nobody add to it from then on: the
// process must end with it. Waits for those that are to be ended together.
void RemoveUnfinished();

}  // namespace touchdown::core
