// Finds recordings that were moved: by what they are, not by their names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "touchdown/db/store.h"

namespace touchdown::pipeline {

struct Relinked {
  struct Move {
    std::string from;  // where it was last seen
    std::string to;    // where it is
  };
  std::vector<Move> found;
  std::vector<std::string> missing;  // where they were last seen
  std::size_t in_place = 0;          // are where they were last seen
  std::size_t looked_at = 0;         // recordings in the folder
};

// Looks in `folder` and below it (FindRecordings) for the recordings of the
// store that are not where it last saw them, each known by its clip.id, and
// where two share one, by its SHA-256. Of several copies the first by path is
// taken. Only the place is changed. A file of which the size is no recording's
// of the store is not read; a recording outside of the folder is taken for
// what it was where its size is. Throws core::InputError where the folder
// cannot be read, core::StoreError.
Relinked Relink(db::Store& store, const std::filesystem::path& folder);

}  // namespace touchdown::pipeline
