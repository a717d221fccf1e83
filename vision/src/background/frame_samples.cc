#include "background/frame_samples.h"

namespace touchdown::vision {

FrameSamples::FrameSamples(Clip& clip, std::span<const std::int64_t> frames)
    : clip_(clip), indices_(frames.begin(), frames.end()) {
  // Frames whose windows are cheap are not read here; others are read whole,
  // and copied where the clip's own view does not last.
  for (const std::int64_t index : indices_) {
    if (!clip.views_last() && clip.windows_are_cheap()) continue;
    core::Frame frame = clip.Read(index);
    if (!clip.views_last()) {
      copies_.emplace_back(frame);
      frame = copies_.back().View();
    }
    whole_.push_back(frame);
  }
}

// More threads help only where each can read for itself.
int FrameSamples::Threads(int wanted) const {
  return !whole_.empty() || clip_.Another() != nullptr ? wanted : 1;
}

FrameSamples::Reader::Reader(const FrameSamples& samples) : samples_(samples) {
  // A reader of a compressed clip would decode it anew.
  if (samples.are_raw()) own_ = samples.clip_.OpenAnother();
}

void FrameSamples::Reader::WillRead(const core::PixelRect& window) {
  if (!own_) return;
  for (const std::int64_t index : samples_.indices_) {
    own_->WillRead(index, window);
  }
}

// The same window of all samples, valid until the next call.
const std::vector<core::Frame>& FrameSamples::Reader::Read(
    const core::PixelRect& window) {
  samples_.clip_.cancellation().Check();
  windows_.clear();
  for (const core::Frame& frame : samples_.whole_) {
    windows_.push_back(CutWindow(frame, window));
  }
  if (!windows_.empty()) return windows_;
  Clip& clip = own_ ? *own_ : samples_.clip_;
  copies_.resize(samples_.size());
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    copies_[k].Keep(clip.Read(samples_.indices_[k], window));
    windows_.push_back(copies_[k].View());
  }
  return windows_;
}

}  // namespace touchdown::vision
