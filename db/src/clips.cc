#include "touchdown/db/clips.h"

#include <stdexcept>

#include "statement.h"

namespace touchdown::db {

std::vector<KnownClip> KnownClips(const Store& store) {
  Statement row(store.connection(),
                "SELECT id, clip_id, ifnull(sha256, ''), size_bytes, "
                "last_seen_path FROM clips ORDER BY id");
  std::vector<KnownClip> clips;
  while (row.Step()) {
    KnownClip clip;
    clip.row = row.TakeInteger();
    clip.id = row.TakeText();
    clip.sha256 = row.TakeText();
    clip.size_bytes = row.TakeInteger();
    clip.last_seen_path = row.TakeText();
    clips.push_back(std::move(clip));
  }
  return clips;
}

void MoveClip(Store& store, const KnownClip& clip, std::string_view path) {
  if (path.empty()) {
    throw std::invalid_argument(
        "path is empty, must be where the recording is");
  }
  Statement(store.connection(),
            "UPDATE clips SET last_seen_path = ?, last_seen_at_utc = ? "
            "WHERE id = ? AND clip_id = ?")
      .Add(path)
      .Add(store.sources().now_utc())
      .Add(clip.row)
      .Add(clip.id)
      .Run();
}

}  // namespace touchdown::db
