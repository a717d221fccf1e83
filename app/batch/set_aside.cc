#include "app/batch/set_aside.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace touchdown::pipeline {

SetAside::SetAside(const std::filesystem::path& store)
    : file_(store.string() + ".failed.jsonl") {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file_, ignored)) return;
  // One line a failure, so the lines of a key are counted. The last reason is
  // the one that is shown.
  std::ifstream in(file_);
  for (std::string line; std::getline(in, line);) {
    // A half line of a process that was killed does not spoil the others.
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (!json.is_object()) continue;
    const auto text = [&json](const char* name) -> std::string {
      const auto found = json.find(name);
      return found != json.end() && found->is_string()
                 ? found->get<std::string>()
                 : "";
    };
    const Key key{text("clip_id"), text("options")};
    if (key.clip_id.empty()) continue;
    Failures& failures = failures_[key];
    ++failures.count;
    failures.reason = text("reason");
  }
}

std::optional<std::string> SetAside::FindReason(const Key& key) const {
  const auto found = failures_.find(key);
  if (found == failures_.end() || found->second.count < kMostFailures) {
    return std::nullopt;
  }
  // The reason holds the clip's own message, of one line.
  return fmt::format("set aside, having failed {} times ({}); --again tries it",
                     found->second.count, found->second.reason);
}

void SetAside::Failed(const Key& key, const std::string& clip,
                      const std::string& reason) {
  if (key.clip_id.empty()) return;  // it could not even be read
  Failures& failures = failures_[key];
  ++failures.count;
  failures.reason = reason;
  const std::string line =
      nlohmann::json{{"clip_id", key.clip_id},
                     {"options", key.options_hash},
                     {"clip", clip},
                     {"reason", reason}}
          .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
      "\n";
  // In one piece, whoever else appends.
  // No link is followed and no FIFO waited for: the name beside the store is
  // known to everybody who can write into the folder.
  const int descriptor =
      open(file_.c_str(),
           O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK,
           0666);
  if (descriptor < 0) return;
  [[maybe_unused]] const ssize_t written =
      write(descriptor, line.data(), line.size());
  close(descriptor);
}

}  // namespace touchdown::pipeline
