#include "app/review/clip_shelf.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <vector>

#include "touchdown/vision/encode_image.h"
#include "touchdown/vision/image_file.h"

namespace touchdown::review {
namespace {

// Visibly the same as the frame of a compressed recording.
constexpr int kJpegQuality = 88;

// A person looks so many frames back first.
constexpr std::int64_t kNear = 20;

// A folder of images tells no frame rate; pictures need none.
constexpr double kAnyRate_hz = 1.0;

std::unique_ptr<vision::Clip> OpenFor(const std::filesystem::path& path) {
  vision::ClipOptions options;
  options.fps = kAnyRate_hz;
  // One frame after another: threads would hold more frames each.
  options.decoder_threads = 1;
  return vision::OpenClip(path, options);
}

// The level of which one sample in a thousand lies above.
std::uint32_t WhiteOf(const core::Frame& frame) {
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

}  // namespace

// One recording, its reader used by one thread at a time.
struct ClipShelf::Open {
  explicit Open(const std::filesystem::path& p)
      : path(p), clip(OpenFor(p)), info(clip->info()) {
    if (info.bit_depth > 8) white = WhiteOf(clip->Read(0));
  }

  bool compressed() const {
    return info.format != "mraw" && !info.format.ends_with("-folder");
  }

  Picture Encode(const core::Frame& frame) const {
    if (frame.is_16_bit()) {
      const vision::Image image = ToEightBits(frame, white);
      return EncodeEight(image.View());
    }
    return EncodeEight(frame);
  }
  Picture EncodeEight(const core::Frame& frame) const {
    if (compressed()) {
      return {"image/jpeg", std::make_shared<const std::string>(
                                vision::EncodeJpeg(frame, kJpegQuality))};
    }
    return {"image/png",
            std::make_shared<const std::string>(vision::EncodePng(frame))};
  }

  std::filesystem::path path;
  std::mutex guard;  // of the reader
  std::unique_ptr<vision::Clip> clip;
  vision::ClipInfo info;
  std::uint32_t white = 255;
  bool warmed = false;  // guarded by the shelf
  std::int64_t warm_from = 0;
  std::atomic<bool> closed = false;
};

ClipShelf::ClipShelf(const ShelfOptions& options)
    : options_(options), warmer_([this] { WarmUp(); }) {}

ClipShelf::~ClipShelf() {
  {
    const std::lock_guard lock(guard_);
    ending_ = true;
    for (const auto& open : to_warm_) open->closed = true;
    for (const auto& open : open_) open->closed = true;
  }
  wake_.notify_all();
  warmer_.join();
}

std::shared_ptr<ClipShelf::Open> ClipShelf::Get(
    const std::filesystem::path& path) {
  {
    const std::lock_guard lock(guard_);
    const auto found =
        std::find_if(open_.begin(), open_.end(),
                     [&](const auto& open) { return open->path == path; });
    if (found != open_.end()) {
      open_.splice(open_.begin(), open_, found);
      return open_.front();
    }
  }
  // Opening takes a while; others go on. Two may open the same: one is kept.
  auto opened = std::make_shared<Open>(path);
  const std::lock_guard lock(guard_);
  for (const auto& open : open_) {
    if (open->path == path) return open;
  }
  open_.push_front(opened);
  while (open_.size() > options_.most_open) {
    open_.back()->closed = true;
    open_.pop_back();
  }
  return opened;
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
  return Get(path)->info;
}

Picture ClipShelf::Frame(const std::filesystem::path& path,
                         std::int64_t index) {
  const Key key{path.string(), index};
  if (const auto kept = Find(key)) return *kept;
  const std::shared_ptr<Open> open = Get(path);
  if (open->compressed()) {
    const std::lock_guard lock(guard_);
    if (!open->warmed) {
      open->warmed = true;
      open->warm_from = index;
      to_warm_.push_front(open);
      wake_.notify_one();
    }
  }
  Picture picture;
  {
    const std::lock_guard lock(open->guard);
    picture = open->Encode(open->clip->Read(index));
  }
  // A raw frame is made again as quickly as it is found.
  if (open->compressed()) Keep(key, picture);
  return picture;
}

void ClipShelf::WarmUp() {
  std::unique_lock lock(guard_);
  for (;;) {
    wake_.wait(lock, [this] { return ending_ || !to_warm_.empty(); });
    if (ending_) return;
    const std::shared_ptr<Open> open = to_warm_.front();
    to_warm_.pop_front();
    lock.unlock();
    try {
      // A reader of its own: the other one jumps to what is asked for.
      const auto clip = OpenFor(open->path);
      std::size_t made = 0;
      // First what is near the frame that was asked for, then the rest.
      const std::int64_t frames = open->info.frames;
      const std::int64_t first =
          std::max<std::int64_t>(0, open->warm_from - kNear);
      for (std::int64_t k = 0; k < frames && !open->closed; ++k) {
        const std::int64_t i = (first + k) % frames;
        const Key key{open->path.string(), i};
        const core::Frame frame = clip->Read(i);
        if (Find(key)) continue;
        const Picture picture = open->Encode(frame);
        made += picture.bytes->size();
        // More would push out what was just made.
        if (made > options_.most_bytes / 2) break;
        Keep(key, picture);
      }
    } catch (const std::exception&) {
      // Whoever asks for the damaged frame is told.
    }
    lock.lock();
  }
}

}  // namespace touchdown::review
