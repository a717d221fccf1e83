// Some frames of a clip, read window by window, the same one of each: where
// windows are cheap to read no whole frame need be copied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "footage/kept_pixels.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// The picture is worked on in bands of so many rows: those of all samples stay
// in a processor's own cache.
inline constexpr std::int32_t kBandRows = 8;

class FrameSamples {
 public:
  // Reads the frames, or makes ready to. Throws what Clip::Read throws. `clip`
  // must outlive this.
  FrameSamples(Clip& clip, std::span<const std::int64_t> frames);

  std::size_t size() const { return indices_.size(); }
  bool is_16_bit() const { return clip_.info().bit_depth > 8; }
  // Read as the sensor gave them, not compressed.
  bool are_raw() const { return clip_.windows_are_cheap(); }
  // As many as asked for, or 1 where only one thread can read the clip.
  int Threads(int wanted) const;

  // One thread's.
  class Reader {
   public:
    explicit Reader(const FrameSamples& samples);
    // Before windows in this one are read.
    void WillRead(const core::PixelRect& window);
    // A window of each sample, valid until the next.
    const std::vector<core::Frame>& Read(const core::PixelRect& window);

   private:
    const FrameSamples& samples_;
    std::unique_ptr<Clip> own_;  // null where one thread alone can read
    std::vector<core::Frame> windows_;
    std::vector<KeptPixels> copies_;
  };

 private:
  Clip& clip_;
  std::vector<std::int64_t> indices_;
  std::vector<core::Frame> whole_;  // empty where windows are read
  std::vector<KeptPixels> copies_;
};

}  // namespace touchdown::vision
