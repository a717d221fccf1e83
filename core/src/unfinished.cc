#include "touchdown/core/unfinished.h"

#include <chrono>
#include <set>
#include <system_error>
#include <utility>

namespace touchdown::core {
namespace {

// Of a fifth of a second, in which a process that is told to end has ended,
// what is left when all is removed.
constexpr std::chrono::milliseconds kMostTogether{120};

struct List {
  std::recursive_timed_mutex mutex;
  std::multiset<std::filesystem::path> paths;
};

// Never destroyed: threads may write while the process ends.
List& TheList() {
  static List& list = *new List;
  return list;
}

}  // namespace

Unfinished::Unfinished(std::filesystem::path path) : path_(std::move(path)) {
  List& list = TheList();
  const std::lock_guard lock(list.mutex);
  list.paths.insert(std::filesystem::absolute(path_));
}

Unfinished::~Unfinished() {
  List& list = TheList();
  const std::lock_guard lock(list.mutex);
  std::error_code ignored;
  const auto at = list.paths.find(std::filesystem::absolute(path_, ignored));
  if (at != list.paths.end()) list.paths.erase(at);
}

AllOrNothing::AllOrNothing() : lock_(TheList().mutex) {}

void RemoveUnfinished() {
  List& list = TheList();
  const bool locked = list.mutex.try_lock_for(kMostTogether);
  for (const std::filesystem::path& path : list.paths) {
    // Other threads may still write into a folder.
    constexpr int kTries = 20;
    std::error_code trouble;
    for (int i = 0; i < kTries; ++i) {
      std::filesystem::remove_all(path, trouble);
      if (!trouble) break;
    }
  }
  static_cast<void>(locked);  // for ever: nobody goes on
}

}  // namespace touchdown::core
