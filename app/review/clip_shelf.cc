#include "app/review/clip_shelf.h"

#include <algorithm>
#include <exception>
#include <vector>

#include "app/measure/open_recording.h"
#include "app/review/thumbnail.h"
#include "touchdown/vision/footage/encode_image.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::review {
namespace {

// Visibly the same as the frame of a compressed recording.
constexpr int kJpegQuality = 88;

// A person looks so many frames back first.
constexpr std::int64_t kNear = 20;

// A folder of images tells no frame rate; pictures need none.
constexpr double kAnyRate_hz = 1.0;

std::unique_ptr<vision::Clip> OpenShelfClip(const std::filesystem::path& path) {
  vision::ClipOptions options;
  options.fps = kAnyRate_hz;
  // One frame after another: threads would hold more frames each.
  options.decoder_threads = 1;
  return pipeline::OpenRecording(path, options);
}

// The level of which one sample in a thousand lies above.
std::uint32_t FindWhiteLevel(const core::Frame& frame) {
  std::vector<std::uint32_t> count(std::size_t{frame.full_scale()} + 1);
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    const auto* const row = frame.row<std::uint16_t>(y);
    for (std::int32_t x = 0; x < frame.width_px; ++x) {
      ++count[std::min<std::uint32_t>(row[x], frame.full_scale())];
    }
  }
  const std::int64_t above =
      std::int64_t{frame.width_px} * frame.height_px / 1000;
  std::int64_t seen = 0;
  std::uint32_t level = frame.full_scale();
  while (level > 255 && (seen += count[level]) <= above) --level;
  return level;
}

vision::Image ToEightBits(const core::Frame& frame, std::uint32_t white) {
  vision::Image image;
  image.width_px = frame.width_px;
  image.height_px = frame.height_px;
  image.pixels.reserve(static_cast<std::size_t>(frame.width_px) *
                       static_cast<std::size_t>(frame.height_px));
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    const auto* const row = frame.row<std::uint16_t>(y);
    for (std::int32_t x = 0; x < frame.width_px; ++x) {
      image.pixels.push_back(static_cast<std::byte>(
          std::min<std::uint32_t>(255, row[x] * 255u / white)));
    }
  }
  return image;
}

bool IsCompressed(const vision::ClipInfo& info) {
  return info.format != "mraw" && !info.format.ends_with("-folder");
}

Picture Encode(const core::Frame& frame, const vision::ClipInfo& info) {
  if (IsCompressed(info)) {
    return {"image/jpeg", std::make_shared<const std::string>(
                              vision::EncodeJpeg(frame, kJpegQuality))};
  }
  return {"image/png",
          std::make_shared<const std::string>(vision::EncodePng(frame))};
}

Picture Encode(const core::Frame& frame, const vision::ClipInfo& info,
               std::uint32_t white) {
  if (!frame.is_16_bit()) return Encode(frame, info);
  const vision::Image image = ToEightBits(frame, white);
  return Encode(image.View(), info);
}

}  // namespace

ClipShelf::ClipShelf(const ShelfOptions& options)
    : options_(options),
      readers_(options.most_open, OpenShelfClip),
      warmer_([this] { WarmUp(); }) {}

ClipShelf::~ClipShelf() {
  {
    const std::lock_guard lock(guard_);
    ending_ = true;
    asked_.clear();
  }
  wake_.notify_all();
  warmer_.join();
}

std::optional<ClipShelf::Known> ClipShelf::Recall(
    const std::string& path) const {
  const std::lock_guard lock(guard_);
  const auto found = known_.find(path);
  if (found == known_.end()) return std::nullopt;
  return found->second;
}

ClipShelf::Known ClipShelf::Learn(const std::string& path, vision::Clip& clip) {
  if (const auto known = Recall(path)) return *known;
  Known known = {clip.info(), 255};
  if (known.info.bit_depth > 8) known.white = FindWhiteLevel(clip.Read(0));
  const std::lock_guard lock(guard_);
  return known_.emplace(path, std::move(known)).first->second;
}

std::optional<Picture> ClipShelf::Find(const Key& key) {
  const std::lock_guard lock(guard_);
  const auto found = kept_.find(key);
  if (found == kept_.end()) return std::nullopt;
  order_.splice(order_.begin(), order_, found->second.place);
  return found->second.picture;
}

void ClipShelf::Keep(const Key& key, const Picture& picture) {
  const std::lock_guard lock(guard_);
  if (kept_.contains(key) || picture.bytes->size() > options_.most_bytes) {
    return;
  }
  order_.push_front(key);
  kept_[key] = {picture, order_.begin()};
  bytes_ += picture.bytes->size();
  while (bytes_ > options_.most_bytes) {
    const auto last = kept_.find(order_.back());
    bytes_ -= last->second.picture.bytes->size();
    kept_.erase(last);
    order_.pop_back();
  }
}

std::size_t ClipShelf::bytes() const {
  const std::lock_guard lock(guard_);
  return bytes_;
}

vision::ClipInfo ClipShelf::Info(const std::filesystem::path& path) {
  if (const auto known = Recall(path.string())) return known->info;
  const ReaderPool::Lease reader = readers_.Take(path);
  return Learn(path.string(), reader.clip()).info;
}

Picture ClipShelf::Frame(const std::filesystem::path& path,
                         std::int64_t index) {
  const Key key{path.string(), index};
  if (const auto kept = Find(key)) return *kept;
  const ReaderPool::Lease reader = readers_.Take(path);
  // Somebody else, or the thread, may have made it while this one waited.
  if (const auto kept = Find(key)) return *kept;
  const Known known = Learn(key.first, reader.clip());
  const bool compressed = IsCompressed(known.info);
  if (compressed) Ask(key.first, index);
  Picture picture = Encode(reader.clip().Read(index), known.info, known.white);
  // A raw frame is made again as quickly as it is found.
  if (compressed) Keep(key, picture);
  return picture;
}

Picture ClipShelf::Small(const std::filesystem::path& path, std::int64_t index,
                         core::PixelPoint centre, double width_px) {
  const ReaderPool::Lease reader = readers_.Take(path);
  const Known known = Learn(path.string(), reader.clip());
  const vision::Image image =
      Shrunk(reader.clip().Read(index), centre, width_px, known.white);
  return {"image/jpeg", std::make_shared<const std::string>(
                            vision::EncodeJpeg(image.View(), kJpegQuality))};
}

void ClipShelf::Ask(const std::string& path, std::int64_t index) {
  const std::lock_guard lock(guard_);
  const auto found =
      std::find_if(asked_.begin(), asked_.end(),
                   [&](const Asked& asked) { return asked.path == path; });
  if (found != asked_.end()) {
    asked_.splice(asked_.begin(), asked_, found);
    return;
  }
  asked_.push_front({path, index});
  if (asked_.size() > options_.most_open) asked_.pop_back();
  wake_.notify_one();
}

bool ClipShelf::IsAsked(const std::string& path) const {
  const std::lock_guard lock(guard_);
  return std::any_of(asked_.begin(), asked_.end(),
                     [&](const Asked& asked) { return asked.path == path; });
}

void ClipShelf::WarmUp() {
  std::unique_lock lock(guard_);
  for (;;) {
    const auto next =
        std::find_if(asked_.begin(), asked_.end(),
                     [](const Asked& asked) { return !asked.taken; });
    if (ending_) return;
    if (next == asked_.end()) {
      wake_.wait(lock);
      continue;
    }
    next->taken = true;
    const Asked asked = *next;
    lock.unlock();
    try {
      Decode(asked);
    } catch (const std::exception&) {
      // Whoever asks for the damaged frame is told.
    }
    lock.lock();
  }
}

// Makes the pictures of a recording as long as it is among those asked for.
void ClipShelf::Decode(const Asked& asked) {
  // A reader of its own: the other one jumps to what is asked for.
  const auto clip = OpenShelfClip(asked.path);
  const Known known = Learn(asked.path, *clip);
  // First what is near the frame that was asked for, then the rest.
  const std::int64_t frames = known.info.frames;
  const std::int64_t first = std::max<std::int64_t>(0, asked.from - kNear);
  std::size_t made = 0;
  for (std::int64_t k = 0; k < frames && IsAsked(asked.path); ++k) {
    const Key key{asked.path, (first + k) % frames};
    const core::Frame frame = clip->Read(key.second);
    if (Find(key)) continue;
    const Picture picture = Encode(frame, known.info, known.white);
    made += picture.bytes->size();
    // More would push out what was just made.
    if (made > options_.most_bytes / 2) break;
    Keep(key, picture);
  }
}

}  // namespace touchdown::review
