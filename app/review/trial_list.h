// The list of trials, those that need a look first.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>

#include "app/batch/triage.h"
#include "touchdown/db/store.h"

namespace touchdown::review {

// Remembers why each revision needs a look: that is read from the documents of
// the analyses, which are most of a store's bytes. Safe between threads.
class TriageMemory {
 public:
  // Of trials read without their documents. An excluded trial needs no look.
  std::vector<pipeline::TriageEntry> MakeEntries(
      const db::Store& store, const std::vector<core::Trial>& trials);

 private:
  std::mutex guard_;
  std::map<std::pair<std::string, std::int64_t>, pipeline::TriageEntry> known_;
};

// touchdown.review.trials/1: rows of touchdown.list/1 with `attention` and
// `why`, the most pressing first; `campaigns` with their counts.
nlohmann::ordered_json TrialListJson(const db::Store& store,
                                     TriageMemory& memory);

// The same of a store that is not there yet.
nlohmann::ordered_json EmptyListJson(const std::filesystem::path& store);

}  // namespace touchdown::review
