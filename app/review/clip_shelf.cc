#include "app/review/clip_shelf.h"

#include <algorithm>
#include <exception>
#include <utility>
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

// Recordings of which size and white level stay known. One takes less than 1
// kB; beyond them all are forgotten, and each is found again when it is opened.
constexpr std::size_t kMostKnown = 4096;

// Recordings of which the camera's motion stays known: of a few thousand frames
// it takes 100 kB, and seconds to measure.
constexpr std::size_t kMostMotions = 64;

// A folder of images tells no frame rate; pictures need none.
constexpr double kAnyRate_hz = 1.0;

// The level of which one sample in a thousand lies above.
// It is never below 255: a dark recording keeps its levels. `frame` has more
// than 8 bits.
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

// Brings a deeper frame to 8 bits: 0 stays 0, `white` and above become 255.
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

// Says whether a frame may depend on earlier ones. Raw recordings and folders
// of images are read frame by frame; all else is taken to depend on them.
bool IsCompressed(const vision::ClipInfo& info) {
  return info.format != "mraw" && !info.format.ends_with("-folder");
}

// Encodes a frame of 8 bits. PNG keeps the samples of raw recordings; the
// compressed ones have lost theirs already, and JPEG is smaller.
Picture Encode(const core::Frame& frame, const vision::ClipInfo& info) {
  if (IsCompressed(info)) {
    return {"image/jpeg", std::make_shared<const std::string>(
                              vision::EncodeJpeg(frame, kJpegQuality))};
  }
  return {"image/png",
          std::make_shared<const std::string>(vision::EncodePng(frame))};
}

// Encodes a frame of any depth; `white` is used for deeper ones alone.
Picture Encode(const core::Frame& frame, const vision::ClipInfo& info,
               std::uint32_t white) {
  if (!frame.is_16_bit()) return Encode(frame, info);
  const vision::Image image = ToEightBits(frame, white);
  return Encode(image.View(), info);
}

}  // namespace

ClipShelf::ClipShelf(const ShelfOptions& options)
    : options_(options),
      readers_(options.most_open,
               [this](const ShownRecording& shown) { return Open(shown); }),
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

ClipShelf::Film ClipShelf::DescribeFilm(const ShownRecording& shown) {
  return {shown, pipeline::MeasureExtent(shown.path)};
}

// Opens a recording to look at. Throws like vision::OpenClip.
std::unique_ptr<vision::Clip> ClipShelf::Open(const ShownRecording& shown) {
  vision::ClipOptions options;
  options.fps = kAnyRate_hz;
  // One frame after another: threads would hold more frames each.
  options.decoder_threads = 1;
  auto clip = pipeline::OpenRecording(shown.path, options);
  if (!shown.steady) return clip;
  const Film film = DescribeFilm(shown);
  std::optional<vision::CameraMotion> motion;
  {
    const std::lock_guard lock(guard_);
    const auto found = motions_.find(film);
    if (found != motions_.end()) motion = found->second;
  }
  if (!motion) {
    const auto [first, last] = *shown.steady;
    motion = vision::MeasureCameraMotion(*clip, first, last);
    const std::lock_guard lock(guard_);
    if (motions_.size() >= kMostMotions) motions_.clear();
    motions_.emplace(film, *motion);
  }
  return vision::PutBack(std::move(clip), *motion);
}

// Returns what is known of a recording; nothing before it was first opened.
std::optional<ClipShelf::Known> ClipShelf::Recall(const Film& film) const {
  const std::lock_guard lock(guard_);
  const auto found = known_.find(film);
  if (found == known_.end()) return std::nullopt;
  return found->second;
}

// Remembers a recording's facts. The white level is found once, in the first
// frame: pictures of one recording must not flicker.
ClipShelf::Known ClipShelf::Learn(const Film& film, vision::Clip& clip) {
  if (const auto known = Recall(film)) return *known;
  Known known = {clip.info(), 255};
  if (known.info.bit_depth > 8) known.white = FindWhiteLevel(clip.Read(0));
  const std::lock_guard lock(guard_);
  if (known_.size() >= kMostKnown) known_.clear();
  return known_.emplace(film, std::move(known)).first->second;
}

// Returns a picture that is kept, and makes it the last used.
std::optional<Picture> ClipShelf::Find(const Key& key) {
  const std::lock_guard lock(guard_);
  const auto found = kept_.find(key);
  if (found == kept_.end()) return std::nullopt;
  order_.splice(order_.begin(), order_, found->second.place);
  return found->second.picture;
}

// Keeps a picture, and drops those that were used longest ago while there are
// more than most_bytes. One that is larger than all of it is not kept.
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

// The reader stays open in the pool: frames are mostly asked for next.
vision::ClipInfo ClipShelf::Info(const ShownRecording& shown) {
  const Film film = DescribeFilm(shown);
  if (const auto known = Recall(film)) return known->info;
  const ReaderPool::Lease reader = readers_.Take(shown);
  return Learn(film, reader.clip()).info;
}

Picture ClipShelf::Frame(const ShownRecording& shown, std::int64_t index) {
  const Key key{DescribeFilm(shown), index};
  if (const auto kept = Find(key)) return *kept;
  const ReaderPool::Lease reader = readers_.Take(shown);
  // Somebody else, or the thread, may have made it while this one waited.
  if (const auto kept = Find(key)) return *kept;
  const Known known = Learn(key.first, reader.clip());
  const bool compressed = IsCompressed(known.info);
  if (compressed) Ask(key.first, index);
  // The lease is held while the frame is encoded: its samples belong to the
  // reader.
  Picture picture = Encode(reader.clip().Read(index), known.info, known.white);
  // A raw frame is made again as quickly as it is found.
  if (compressed) Keep(key, picture);
  return picture;
}

// A list shows hundreds of these, each of another recording: decoding them
// ahead would push out what a person is looking at.
Picture ClipShelf::Small(const ShownRecording& shown, std::int64_t index,
                         core::PixelPoint centre, double width_px) {
  const Film film = DescribeFilm(shown);
  const ReaderPool::Lease reader = readers_.Take(shown);
  const Known known = Learn(film, reader.clip());
  const vision::Image image =
      Shrunk(reader.clip().Read(index), centre, width_px, known.white);
  return {"image/jpeg", std::make_shared<const std::string>(
                            vision::EncodeJpeg(image.View(), kJpegQuality))};
}

// Asks the thread to decode a recording ahead. Of more than most_open the one
// that was asked for longest ago is dropped, and its decoding ends.
void ClipShelf::Ask(const Film& film, std::int64_t index) {
  const std::lock_guard lock(guard_);
  // What it was before needs no decoding any more.
  std::erase_if(asked_, [&](const Asked& asked) {
    return asked.film.shown == film.shown && asked.film != film;
  });
  const auto found =
      std::find_if(asked_.begin(), asked_.end(),
                   [&](const Asked& asked) { return asked.film == film; });
  if (found != asked_.end()) {
    asked_.splice(asked_.begin(), asked_, found);
    return;
  }
  asked_.push_front({film, index});
  if (asked_.size() > options_.most_open) asked_.pop_back();
  wake_.notify_one();
}

// Says whether the recording is still among those asked for; the thread asks
// before each frame.
bool ClipShelf::IsAsked(const Film& film) const {
  const std::lock_guard lock(guard_);
  return std::any_of(asked_.begin(), asked_.end(),
                     [&](const Asked& asked) { return asked.film == film; });
}

// The thread's loop: takes the recording that was asked for last and decodes it
// without the lock. An entry that was taken stays in the list, so that it is
// not decoded a second time.
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
  const auto clip = Open(asked.film.shown);
  const Known known = Learn(asked.film, *clip);
  // First what is near the frame that was asked for, then the rest.
  const std::int64_t frames = known.info.frames;
  const std::int64_t first = std::max<std::int64_t>(0, asked.from - kNear);
  std::size_t made = 0;
  for (std::int64_t k = 0; k < frames && IsAsked(asked.film); ++k) {
    // The order is from `first` to the end, then from the beginning.
    const Key key{asked.film, (first + k) % frames};
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
