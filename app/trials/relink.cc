#include "app/trials/relink.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "app/trials/recordings.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/clips.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;

// The recordings of a folder by their clip.id. One of which the size is no
// known clip's is not read; one that cannot be read is none.
using ById = std::multimap<std::string, fs::path>;

// Reading a clip's id costs up to 64 MiB of it, so the size is compared first.
// A clip of unknown size (0) makes every recording a candidate.
ById ReadIds(const std::vector<fs::path>& recordings,
             const std::vector<db::KnownClip>& clips) {
  ById out;
  for (const fs::path& recording : recordings) {
    try {
      const std::int64_t size = vision::SizeBytes(recording);
      const bool may_be = std::ranges::any_of(clips, [&](const auto& clip) {
        return clip.size_bytes == 0 || clip.size_bytes == size;
      });
      if (may_be) {
        out.emplace(vision::ClipId(recording),
                    fs::absolute(recording).lexically_normal());
      }
    } catch (const core::InputError&) {
      // Damaged, or going away at this moment.
    }
  }
  return out;
}

// Whether `path` is the clip, of which another one shares the id.
bool MatchesDigest(const db::KnownClip& clip, const fs::path& path) {
  try {
    return clip.sha256.empty() || vision::Sha256(path) == clip.sha256;
  } catch (const core::InputError&) {
    return false;
  }
}

// Outside of the folder: a recording of the same size is where it was last
// seen. What `db check` asks, it asks of every byte.
bool IsStillThere(const db::KnownClip& clip) {
  try {
    return clip.size_bytes == 0
               ? fs::exists(clip.last_seen_path)
               : vision::SizeBytes(clip.last_seen_path) == clip.size_bytes;
  } catch (const core::InputError&) {
    return false;
  } catch (const fs::filesystem_error&) {
    return false;
  }
}

}  // namespace

Relinked Relink(db::Store& store, const fs::path& folder) {
  const auto clips = db::KnownClips(store);
  const auto recordings = FindRecordings(folder);
  const ById there = ReadIds(recordings, clips);
  const fs::path root = fs::absolute(folder).lexically_normal();
  // This counts the clips of the store that share an id. Where only one has it
  // the id decides; else the full SHA-256 does, which reads the whole file.
  std::map<std::string, int> sharing;
  for (const db::KnownClip& clip : clips) ++sharing[clip.id];
  Relinked out;
  out.looked_at = recordings.size();
  for (const db::KnownClip& clip : clips) {
    std::vector<fs::path> same;
    // The candidates come in the order of their paths: FindRecordings sorts
    // them, and a multimap keeps equal keys in the order of insertion.
    const auto [begin, end] = there.equal_range(clip.id);
    for (auto it = begin; it != end; ++it) {
      if (sharing[clip.id] == 1 || MatchesDigest(clip, it->second)) {
        same.push_back(it->second);
      }
    }
    const fs::path seen = clip.last_seen_path;
    // A recording is in place, missing, or found elsewhere in the folder.
    if (std::ranges::find(same, seen) != same.end() ||
        (!IsBelow(seen, root) && IsStillThere(clip))) {
      ++out.in_place;
    } else if (same.empty()) {
      out.missing.push_back(clip.last_seen_path);
    } else {
      db::MoveClip(store, clip, same.front().string());
      out.found.push_back({clip.last_seen_path, same.front().string()});
    }
  }
  return out;
}

}  // namespace touchdown::pipeline
