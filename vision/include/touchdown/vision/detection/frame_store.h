// Keeps what an analysis looks at more than once, so that a compressed clip is
// decoded once however often its frames are looked at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "touchdown/core/points.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct FrameStoreOptions {
  // What is kept at most; what does not fit is decoded again when it is wanted
  // again. 192 MiB: of a 1280 x 800 8-bit clip 196 whole frames; the whole
  // program stays under 300 MiB.
  std::size_t most_bytes = std::size_t{192} << 20;

  // Frames [first, last) and the part of the picture that will be looked at;
  // last < 0: to the end, width 0: the whole picture.
  std::int64_t first = 0;
  std::int64_t last = -1;
  core::PixelRect region;

  // Of a clip that grows piece by piece, what lies between two key frames that
  // show nothing is not decoded, if they are at most so many frames apart. 300:
  // common encoders set a key frame every 250 at the least. A body that passes
  // between two of them, before or after it is seen in another, is not looked
  // at; 32, the most that a glimpse may be apart otherwise, would decode such
  // clips from their first frame on.
  std::int64_t most_between_keys = 300;

  int threads = 0;  // 0: one for each core; affects speed only

  // Called now and then with the share done, 0..1; may be empty.
  std::function<void(double)> progress;
};

// A clip of which frames are decoded as far as they are wanted.
class GrowingClip : public Clip {
 public:
  // Decodes on, in order, so that [first, last) is at hand; what was decoded is
  // not decoded again. With all of the range it is what KeepFrames gives.
  // False: only all of the range is of use, because a frame is damaged, because
  // pictures or body are too large to be kept, or because the clip is so small
  // that it is kept whole: a second look costs more than decoding.
  virtual bool ExtendDecoding(std::int64_t last) = 0;

  // Of the frames decoded, those that are kept whole, evenly spread: what
  // backgrounds are made of. Empty: all are.
  virtual std::vector<std::int64_t> StillFrames() const = 0;

  // Whether what is kept holds all that differs from the still picture of
  // StillFrames. False: the provisional still picture has a ghost.
  virtual bool HoldsAllChanges() = 0;

  // Ranges [first, last) of what has grown that were not decoded, but for key
  // frames, because those show nothing.
  virtual std::vector<std::pair<std::int64_t, std::int64_t>> LeftOut()
      const = 0;

  // How often a frame that had been decoded was asked for where it is not kept.
  virtual std::int64_t DecodedAgain() const = 0;
};

// As KeepFrames, but nothing of the range is decoded yet: ExtendDecoding does.
// Not for raw clips. While it grows, 16 to 33 frames more are kept whole, and
// the still picture is that of the key frames of the whole range: they are
// decoded first.
std::unique_ptr<GrowingClip> GrowFrames(std::unique_ptr<Clip> clip,
                                        const FrameStoreOptions& options = {});

// A clip that hands out the same frames as `clip`. Raw clips, which are mapped
// into memory, are returned as they are. A clip whose pictures all fit is kept
// whole, as it is read. Of a longer one the range is decoded here, once and in
// order: the frames that a background is made of are kept whole, of the others
// the windows that differ from the still picture (Clip::KnownChanges). Where
// each frame is stored alone there are several readers, and what lies between
// glimpses that show nothing is not decoded (KnownChanges: nothing; Read
// decodes it). The still picture is that of key frames, which are decoded
// first; where it turns out to hold a ghost of the body, the range is decoded a
// second time with the right one. A damaged frame ends the pass; reading it
// says what is wrong.
std::unique_ptr<Clip> KeepFrames(std::unique_ptr<Clip> clip,
                                 const FrameStoreOptions& options = {});

}  // namespace touchdown::vision
