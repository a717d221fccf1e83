#include "detection/glimpses.h"

#include <algorithm>
#include <cstddef>

#include "detection/scout.h"

namespace touchdown::vision {

// Whether a change of one probe meets one of the next frame: noise of
// compression is in one only.
bool AreInBoth(const Changes& changes, const Changes& next,
               std::int32_t margin_cells) {
  // With one of their two margins; at the picture's border one is cut off.
  const std::int32_t reach = margin_cells * Scout::kCell_px;
  for (const core::PixelRect& a : changes.where) {
    for (const core::PixelRect& b : next.where) {
      if (a.x + reach < b.x + b.width && b.x + reach < a.x + a.width &&
          a.y + reach < b.y + b.height && b.y + reach < a.y + a.height) {
        return true;
      }
    }
  }
  return false;
}

// Frames near probes that show something, and those between probes that are too
// far apart to vouch for what lies between. All frames if no probe shows
// anything.
std::vector<std::int64_t> FramesWorthDecoding(
    std::int64_t first, std::int64_t last,
    const std::vector<std::int64_t>& glimpsed, const std::vector<bool>& shows,
    const GlimpseRule& rule) {
  std::vector<char> worth(static_cast<std::size_t>(last - first), 0);
  const auto mark = [&](std::int64_t from, std::int64_t to) {
    from = std::clamp(from, first, last);
    to = std::clamp(to, from, last);
    std::fill(worth.begin() + (from - first), worth.begin() + (to - first), 1);
  };
  // A gap longer than most_between is decoded; so are the ends of the clip,
  // which one probe alone sees.
  std::int64_t before = first;
  for (std::size_t k = 0; k <= glimpsed.size(); ++k) {
    const std::int64_t now = k < glimpsed.size() ? glimpsed[k] : last;
    if (now - before > rule.most_between) mark(before, now);
    before = now;
  }
  for (std::size_t k = 0; k < glimpsed.size(); ++k) {
    if (!shows[k]) continue;
    const std::int64_t at = glimpsed[k];
    mark(at - rule.reach, at + rule.reach + 1);
    mark(k > 0 ? glimpsed[k - 1] : first, at);
    mark(at, k + 1 < glimpsed.size() ? glimpsed[k + 1] : last);
  }
  if (std::find(shows.begin(), shows.end(), true) == shows.end()) {
    mark(first, last);
  }
  std::vector<std::int64_t> frames;
  for (std::int64_t i = first; i < last; ++i) {
    if (worth[static_cast<std::size_t>(i - first)] != 0) frames.push_back(i);
  }
  return frames;
}

}  // namespace touchdown::vision
