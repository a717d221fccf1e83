#include "touchdown/vision/footage/clip_apart.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>
#include <vector>

#include "footage/apart/frame_memory.h"
#include "footage/apart/messages.h"
#include "footage/apart/reader.h"
#include "footage/apart/reader_process.h"
#include "footage/formats/clip_formats.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Whether main has said that this program can be a reader.
std::atomic<bool>& CanServe() {
  static std::atomic<bool> can = false;
  return can;
}

// A clip that another process reads: frames come through shared memory,
// everything else as messages.
class ApartClip final : public Clip {
 public:
  ApartClip(std::shared_ptr<ReaderProcess> process, Descriptor socket,
            const ClipOptions& options, Confinement* confinement)
      : line_(process, std::move(socket)) {
    Confinement granted;
    See(line_.Greeting(granted).Release());
    if (confinement != nullptr) *confinement = granted;
    Packed question;
    question.PutText(process->path().string());
    PutOptions(question, options);
    Answered answered = line_.Question(Ask::kOpen, question);
    info_ = GetInfo(answered.answer);
    info_.path = process->path();
    has_another_ = answered.answer.GetFlag();
  }

  // Another reader's line to the same process.
  ApartClip(const ApartClip& like, Descriptor socket)
      : line_(like.line_.process(), std::move(socket)),
        info_(like.info_),
        has_another_(like.has_another_) {
    See(fcntl(like.memory_->descriptor(), F_DUPFD_CLOEXEC, 0));
  }

  const ClipInfo& info() const override { return info_; }

  void RequireWhole() const override {
    line_.Question(Ask::kRequireWhole, {}, cancellation());
  }

  std::int64_t EntryFrame(std::int64_t index) const override {
    while (entries_known_ <= index) AskEntries();
    const auto after = std::upper_bound(
        entries_.begin(), entries_.end(), index,
        [](std::int64_t i, const auto& entry) { return i < entry.first; });
    return after == entries_.begin() ? 0 : std::prev(after)->second;
  }

  std::unique_ptr<Clip> Another() const override {
    if (!has_another_) return nullptr;
    Answered answered = line_.Question(Ask::kAnother, {}, cancellation());
    if (!answered.answer.GetFlag() || !answered.descriptor) return nullptr;
    return std::make_unique<ApartClip>(*this, std::move(answered.descriptor));
  }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    Packed question;
    question.Put(index);
    for (const std::int32_t n :
         {window.x, window.y, window.width, window.height}) {
      question.Put(n);
    }
    const auto shared = line_.Question(Ask::kRead, question, cancellation())
                            .answer.Get<SharedFrame>();
    core::Frame frame;
    frame.bit_depth = shared.bit_depth;
    frame.stride_bytes = shared.stride_bytes;
    frame.time_s = shared.time_s;
    frame.data = FindWindowData(shared, window);
    if (frame.data == nullptr) {
      line_.process()->Lose(
          fmt::format("gave frame {} wrongly and was ended", index));
    }
    return frame;
  }

 private:
  void See(int descriptor) {
    memory_ = std::make_shared<FrameMemoryView>(descriptor);
    line_.Watch(memory_);
  }

  // Null where the samples of the window do not lie in the memory.
  const std::byte* FindWindowData(const SharedFrame& shared,
                                  const core::PixelRect& window) {
    const std::int64_t sample = shared.bit_depth > 8 ? 2 : 1;
    const std::int64_t row = sample * window.width;
    // Bytes of a row: more is no answer of an honest reader, and the product
    // below stays far from overflow.
    constexpr std::int64_t kMaxStride = std::int64_t{1} << 32;
    if (shared.bit_depth != info_.bit_depth || shared.stride_bytes < row ||
        shared.stride_bytes > kMaxStride || shared.offset % sample != 0 ||
        shared.stride_bytes % sample != 0) {
      return nullptr;
    }
    const std::int64_t bytes = shared.stride_bytes * (window.height - 1) + row;
    return memory_->At(shared.offset, static_cast<std::size_t>(bytes));
  }

  void AskEntries() const {
    Packed question;
    question.Put(entries_known_);
    Answered answered = line_.Question(Ask::kEntries, question, cancellation());
    const auto known = answered.answer.Get<std::int64_t>();
    const auto count = answered.answer.Get<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto at = answered.answer.Get<std::int64_t>();
      const auto entry = answered.answer.Get<std::int64_t>();
      entries_.emplace_back(at, std::clamp<std::int64_t>(entry, 0, at));
    }
    // All that there is, where the reader makes no progress.
    entries_known_ = known > entries_known_ ? known : info_.frames;
  }

  mutable ReaderLine line_;
  ClipInfo info_;
  bool has_another_ = false;
  std::shared_ptr<FrameMemoryView> memory_;
  // From which frame on reading begins at which, of frames up to
  // entries_known_.
  mutable std::vector<std::pair<std::int64_t, std::int64_t>> entries_;
  mutable std::int64_t entries_known_ = 0;
};

}  // namespace

std::optional<int> ServeAsReader(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], kReaderArgument) == 0) {
    return ServeReader();
  }
  CanServe() = true;
  return std::nullopt;
}

std::unique_ptr<Clip> OpenClipApart(const std::filesystem::path& path,
                                    const ClipOptions& options,
                                    const ReaderLimits& limits,
                                    Confinement* confinement) {
  if (!CanServe() || !IsForeign(path)) return OpenClip(path, options);
  if (auto plain = OpenPlainTiffStack(path, options)) return plain;
  const auto process = std::make_shared<ReaderProcess>(path, limits);
  return std::make_unique<ApartClip>(process, process->TakeFirstLine(), options,
                                     confinement);
}

Image ReadImageApart(const std::filesystem::path& path,
                     const ReaderLimits& limits) {
  if (!CanServe() || !IsForeign(path)) return ReadImage(path);
  const auto process = std::make_shared<ReaderProcess>(path, limits);
  ReaderLine line(process, process->TakeFirstLine());
  Confinement granted;
  const auto memory =
      std::make_shared<FrameMemoryView>(line.Greeting(granted).Release());
  line.Watch(memory);
  Packed question;
  question.PutText(path.string());
  Packed answer = line.Question(Ask::kImage, question).answer;
  const auto shared = answer.Get<SharedFrame>();
  Image image;
  image.width_px = shared.width_px;
  image.height_px = shared.height_px;
  image.bit_depth = shared.bit_depth;
  const std::int64_t row_bytes =
      std::int64_t{shared.width_px} * (shared.bit_depth > 8 ? 2 : 1);
  const bool is_picture =
      shared.width_px >= 1 && shared.width_px <= kMostSide_px &&
      shared.height_px >= 1 && shared.height_px <= kMostSide_px &&
      shared.bit_depth >= 1 && shared.bit_depth <= 16 &&
      shared.stride_bytes == row_bytes;
  const auto bytes =
      is_picture ? static_cast<std::size_t>(row_bytes * shared.height_px) : 0;
  const std::byte* const data =
      is_picture ? memory->At(shared.offset, bytes) : nullptr;
  if (data == nullptr) process->Lose("gave the picture wrongly and was ended");
  image.pixels.assign(data, data + bytes);
  return image;
}

}  // namespace touchdown::vision
