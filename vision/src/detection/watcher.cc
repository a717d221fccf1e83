#include "detection/watcher.h"

#include <cstddef>

namespace touchdown::vision {
namespace {

// Asks for one blob more than is kept, which shows whether there are more.
DetectOptions OneMore(DetectOptions detect) {
  ++detect.most_blobs;
  return detect;
}

// Keeps the strongest blobs, and notes whether one that could be a body was
// left out.
void KeepStrongestBlobs(const DetectOptions& detect, Seen& seen) {
  // Of the strongest blob's strength. Specks of noise and of compression, of
  // which there may be any number, are no body that was overlooked. Set so that
  // seven recordings give no new warning.
  constexpr double kMinBodyShare = 0.1;
  KeepLargest(seen.blobs, OneMore(detect));
  const auto most = static_cast<std::size_t>(detect.most_blobs);
  if (seen.blobs.size() <= most) return;
  seen.more =
      Strength(seen.blobs[most]) > kMinBodyShare * Strength(seen.blobs.front());
  seen.blobs.resize(most);
}

}  // namespace

// Whether the clip is so large that only changed parts of some frames are
// looked at.
bool IsLong(const Clip& clip, const TrackOptions& options) {
  const ClipInfo& info = clip.info();
  const std::int64_t last = options.last < 0 ? info.frames : options.last;
  return clip.KnownChanges(options.first) != nullptr ||
         static_cast<double>(last - options.first) *
                 static_cast<double>(info.width_px) *
                 static_cast<double>(info.height_px) >
             options.seen_whole_px;
}

Watcher::Watcher(const Clip& clip, const Background& background,
                 const TrackOptions& options, Detector detector)
    : background_(background) {
  detect_.detector = detector;
  detect_.region = options.region;
  if (detector != Detector::kLevels && IsLong(clip, options)) {
    ScoutOptions scout;
    scout.region = options.region;
    scout_.emplace(background, scout);
  }
}

// Blobs of one frame: of the whole frame, or of the windows around its changes.
Seen Watcher::Look(Clip& clip, std::int64_t index) const {
  Seen seen;
  if (!scout_) {
    const core::Frame frame = clip.Read(index);
    seen.time_s = frame.time_s;
    seen.blobs = DetectBlobs(frame, background_, OneMore(detect_));
    KeepStrongestBlobs(detect_, seen);
    return seen;
  }
  Changes changes;
  if (const Changes* known = clip.KnownChanges(index)) {
    changes = *known;
  } else {
    changes = scout_->Look(clip, index);
  }
  DetectOptions detect = OneMore(detect_);
  detect.noise = changes.noise;
  for (const core::PixelRect& rect : changes.where) {
    const core::Frame window = clip.Read(index, rect);
    seen.time_s = window.time_s;
    const auto more = DetectBlobs(window, background_, detect);
    seen.blobs.insert(seen.blobs.end(), more.begin(), more.end());
  }
  KeepStrongestBlobs(detect_, seen);
  return seen;
}

}  // namespace touchdown::vision
