#include "app/cli/analyze/folder_watch.h"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <system_error>
#include <utility>

namespace touchdown::cli {

namespace fs = std::filesystem;

// No inotify is no error: Wait() then returns after its time.
FolderWatch::FolderWatch(fs::path folder)
    : folder_(std::move(folder)),
      inotify_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  AddFolders();
}

FolderWatch::~FolderWatch() {
  if (inotify_ >= 0) close(inotify_);
}

// Watches the folder and all below it; inotify itself does not look into
// subfolders. Called before each wait, because new ones appear; a folder that
// is watched already stays as it is. Folders that cannot be read are skipped.
void FolderWatch::AddFolders() {
  if (inotify_ < 0) return;
  // These events change the extent of a recording, bring one or remove one.
  constexpr std::uint32_t kEvents = IN_CREATE | IN_MODIFY | IN_CLOSE_WRITE |
                                    IN_MOVED_TO | IN_MOVED_FROM | IN_DELETE;
  inotify_add_watch(inotify_, folder_.c_str(), kEvents);
  std::error_code trouble;
  fs::recursive_directory_iterator entry(
      folder_, fs::directory_options::skip_permission_denied, trouble);
  for (; !trouble && entry != fs::recursive_directory_iterator();
       entry.increment(trouble)) {
    std::error_code ignored;
    if (entry->is_directory(ignored)) {
      inotify_add_watch(inotify_, entry->path().c_str(), kEvents);
    }
  }
}

// Between a new folder's appearance and the watch on it files may be missed:
// they are found all the same when the caller looks, by the time given at the
// latest.
bool FolderWatch::Wait(std::chrono::milliseconds longest, int other) {
  AddFolders();
  // Negative descriptors are passed over.
  std::array<pollfd, 2> events{pollfd{inotify_, POLLIN, 0},
                               pollfd{other, POLLIN, 0}};
  const int ready =
      poll(events.data(), events.size(), static_cast<int>(longest.count()));
  // The events are only emptied out: the caller looks at the folder itself.
  std::array<char, 4096> told{};
  while (inotify_ >= 0 && read(inotify_, told.data(), told.size()) > 0) {
  }
  return ready > 0 && events[1].revents != 0;
}

}  // namespace touchdown::cli
