#include "detection/frame_choice.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "detection/first_look.h"
#include "footage/kept_pixels.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {

// Whether each frame can be decoded without another one.
bool AreStoredAlone(const Clip& clip, std::int64_t first, std::int64_t last) {
  for (std::int64_t i = first; i < last; ++i) {
    if (clip.EntryFrame(i) != i) return false;
  }
  return true;
}

// The frames at which decoding can begin, nearest before those that the
// background's samples would be taken from.
std::vector<std::int64_t> ChooseKeyFrames(const Clip& clip, std::int64_t first,
                                          std::int64_t last) {
  std::set<std::int64_t> keys;
  for (const std::int64_t frame :
       BackgroundFrames(first, last, BackgroundOptions{}.samples)) {
    keys.insert(clip.EntryFrame(frame));
  }
  keys.erase(keys.begin(), keys.lower_bound(first));
  if (keys.empty()) keys.insert(first);
  return {keys.begin(), keys.end()};
}

// Frames that backgrounds of the whole range, of its beginning and of its end
// need, as far as three fifths of the memory reach.
std::set<std::int64_t> FramesKeptWhole(const ClipInfo& info,
                                       const FrameStoreOptions& options) {
  const std::int64_t first = options.first;
  const std::int64_t last = options.last;
  const std::int64_t part = EndPart(first, last);
  const std::size_t room = options.most_bytes * 3 / 5;
  std::set<std::int64_t> whole;
  for (const auto& [from, to] :
       {std::pair{first, last}, std::pair{first, std::min(first + part, last)},
        std::pair{std::max(first, last - part), last}}) {
    std::set<std::int64_t> more = whole;
    for (const std::int64_t frame :
         BackgroundFrames(from, to, BackgroundOptions{}.samples)) {
      more.insert(frame);
    }
    if (more.size() * FrameBytes(info) > room) break;
    whole = std::move(more);
  }
  return whole;
}

}  // namespace touchdown::vision
