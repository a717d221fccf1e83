#include "app/measure/open_recording.h"

#include <fmt/format.h>

#include <string>

#include "app/measure/journal.h"
#include "touchdown/vision/footage/clip_apart.h"

namespace touchdown::pipeline {

std::unique_ptr<vision::Clip> OpenRecording(
    const std::filesystem::path& path, const vision::ClipOptions& options) {
  // A kernel that refuses a limit does not end the analysis; the journal says
  // what was not granted, and `touchdown doctor` shows it, too.
  vision::Confinement granted;
  auto clip = vision::OpenClipApart(path, options, {}, &granted);
  if (!JournalIsKept()) return clip;
  if (!granted.is_apart) {
    Journal(path.string() + ": read in this process, by our own reader");
    return clip;
  }
  const auto tell = [](const std::string& refused) {
    return refused.empty() ? "in force" : "refused (" + refused + ")";
  };
  Journal(fmt::format(
      "{}: read in a process of its own; limits in force, seccomp {}, Landlock "
      "{}",
      path.string(), tell(granted.seccomp), tell(granted.landlock)));
  return clip;
}

}  // namespace touchdown::pipeline
