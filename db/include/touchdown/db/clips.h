// Where the recordings of a store's trials are: they are moved, a trial is not.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/db/store.h"

namespace touchdown::db {

// A recording that trials were analysed from. Two of one `id` differ in their
// SHA-256 (vision/clip_digest.h).
struct KnownClip {
  std::int64_t row = 0;  // in this store
  std::string id;
  std::string sha256;           // empty: not computed yet
  std::int64_t size_bytes = 0;  // 0: not recorded
  std::string last_seen_path;
};

std::vector<KnownClip> KnownClips(const Store& store);

// From now on the recording is looked for at `path`. What was recorded of its
// trials stays as it is: no revision is added, no link of the chain is touched.
// Throws std::invalid_argument where `path` is empty, core::StoreError like
// Store.
void MoveClip(Store& store, const KnownClip& clip, std::string_view path);

}  // namespace touchdown::db
