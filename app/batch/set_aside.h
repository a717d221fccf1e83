// Recordings that could not be analysed, kept beside a store, so that a batch
// or a session that is started again does not begin with them each time: one
// that failed twice in the same way is set aside, with its reason, until a
// person asks for it again.
//
//   lab.db.failed.jsonl: {"clip_id", "options", "clip", "reason"} a line
//
// The file is no evidence: removed, all is tried again.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace touchdown::pipeline {

class SetAside {
 public:
  // Failures after which a recording is set aside. One may be an accident (a
  // disk that was full); what failed twice fails a third time.
  static constexpr int kMostFailures = 2;

  // Of the store at that path. Lines that are not understood are passed over.
  explicit SetAside(const std::filesystem::path& store);

  // Of an analysis: which recording, with which options.
  struct Key {
    std::string clip_id;
    std::string options_hash;
    friend auto operator<=>(const Key&, const Key&) = default;
  };

  // Why it is set aside, for a person; nothing where it is to be tried.
  std::optional<std::string> FindReason(const Key& key) const;

  // Notes a failure. What cannot be written is not: the recording is then tried
  // once more than it would be.
  void Failed(const Key& key, const std::string& clip,
              const std::string& reason);

 private:
  struct Failures {
    int count = 0;
    std::string reason;  // the last one's
  };

  std::filesystem::path file_;
  std::map<Key, Failures> failures_;
};

}  // namespace touchdown::pipeline
