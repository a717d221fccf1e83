#include "footage/apart/reader.h"

#include <poll.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "footage/apart/confine.h"
#include "footage/apart/frame_memory.h"
#include "footage/apart/messages.h"
#include "footage/formats/clip_formats.h"
#include "footage/formats/libav.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {
namespace {

// A quarter of the reader's memory is for frames; decoders need the rest.
constexpr std::size_t kFrameShare = 4;
// Pairs of numbers in one answer about where reading can begin: 16 KiB, half of
// what a message holds.
constexpr std::size_t kMaxEntries = 1024;

// One clip and its line. Pieces for frames that lie elsewhere are its own.
class Line {
 public:
  Line(Descriptor socket, std::unique_ptr<Clip> clip, FrameMemory& memory)
      : socket_(std::move(socket)), clip_(std::move(clip)), memory_(memory) {}
  ~Line() {
    clip_.reset();
    if (piece_ != nullptr) memory_.Give(piece_);
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  // Answers until the other end is gone.
  void Serve() {
    for (;;) {
      Received received = ReceiveMessage(socket_.get());
      if (received.what == Received::What::kEnd) return;
      if (received.what == Received::What::kNothingYet) continue;
      if (!Answer(Packed(std::move(received.bytes)))) return;
    }
  }

 private:
  // Every failure becomes an answer: no exception ends the thread.
  bool Answer(Packed question) {
    std::uint32_t number = 0;
    const auto refuse = [&](Said said, const std::string& what) {
      Packed answer;
      answer.Put(number);
      answer.Put(said);
      answer.PutText(what);
      return SendMessage(socket_.get(), answer.bytes());
    };
    try {
      number = question.Get<std::uint32_t>();
      Packed answer;
      answer.Put(number);
      answer.Put(Said::kDone);
      Descriptor descriptor;
      Do(question, answer, descriptor);
      return SendMessage(socket_.get(), answer.bytes(), descriptor.get());
    } catch (const core::InputError& error) {
      return refuse(Said::kInputError, error.what());
    } catch (const std::invalid_argument& error) {
      return refuse(Said::kInvalidArgument, error.what());
    } catch (const std::bad_alloc&) {
      return refuse(Said::kOther,
                    "it needs more memory than a reader may have");
    } catch (const std::exception& error) {
      return refuse(Said::kOther, error.what());
    }
  }

  // Calls what the question asks for.
  void Do(Packed& question, Packed& answer, Descriptor& descriptor) {
    const auto ask = question.Get<Ask>();
    if (ask == Ask::kOpen) return Open(question, answer);
    if (ask == Ask::kImage) return ReadPicture(question, answer);
    if (!clip_) throw std::logic_error("no clip is open");
    switch (ask) {
      case Ask::kRead:
        return Read(question, answer);
      case Ask::kAnother:
        descriptor = OpenAnother(answer);
        return;
      case Ask::kEntries:
        return Entries(question, answer);
      case Ask::kRequireWhole:
        return clip_->RequireWhole();
      default:
        throw std::logic_error("an unknown question");
    }
  }

  void Open(Packed& question, Packed& answer) {
    const std::filesystem::path path = question.GetText();
    const ClipOptions options = GetOptions(question);
    clip_ = OpenClipInMemory(path, options, &memory_);
    PutInfo(answer, clip_->info());
    answer.Put<std::uint8_t>(clip_->Another() != nullptr);
  }

  void ReadPicture(Packed& question, Packed& answer) {
    const Image image = ReadImage(question.GetText());
    answer.Put(Share(image.View()));
  }

  void Read(Packed& question, Packed& answer) {
    const auto index = question.Get<std::int64_t>();
    core::PixelRect window;
    window.x = question.Get<std::int32_t>();
    window.y = question.Get<std::int32_t>();
    window.width = question.Get<std::int32_t>();
    window.height = question.Get<std::int32_t>();
    answer.Put(Share(clip_->Read(index, window)));
  }

  // The frame in the shared memory: as it lies there, or copied.
  SharedFrame Share(const core::Frame& frame) {
    SharedFrame shared;
    shared.width_px = frame.width_px;
    shared.height_px = frame.height_px;
    shared.bit_depth = frame.bit_depth;
    shared.time_s = frame.time_s;
    const auto offset = memory_.FindOffset(frame.data);
    if (offset && frame.stride_bytes > 0) {
      shared.offset = *offset;
      shared.stride_bytes = frame.stride_bytes;
      return shared;
    }
    const auto row_bytes = static_cast<std::size_t>(frame.width_px) *
                           (frame.is_16_bit() ? 2u : 1u);
    std::byte* const piece =
        Own(row_bytes * static_cast<std::size_t>(frame.height_px));
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      std::copy_n(frame.data + y * frame.stride_bytes, row_bytes,
                  piece + static_cast<std::size_t>(y) * row_bytes);
    }
    shared.offset = memory_.FindOffset(piece).value_or(0);
    shared.stride_bytes = static_cast<std::int64_t>(row_bytes);
    return shared;
  }

  std::byte* Own(std::size_t bytes) {
    if (bytes > piece_bytes_) {
      if (piece_ != nullptr) memory_.Give(piece_);
      piece_bytes_ = 0;
      piece_ = memory_.Take(bytes);
      if (piece_ == nullptr) throw std::bad_alloc();
      piece_bytes_ = bytes;
    }
    return piece_;
  }

  // A line and a thread of its own for another reader; its other end.
  Descriptor OpenAnother(Packed& answer) {
    std::unique_ptr<Clip> another = clip_->Another();
    answer.Put<std::uint8_t>(another != nullptr);
    if (!another) return {};
    auto [ours, theirs] = MakeSocketPair();
    std::thread([socket = std::move(ours), clip = std::move(another),
                 &memory = memory_]() mutable {
      Line(std::move(socket), std::move(clip), memory).Serve();
    }).detach();
    return std::move(theirs);
  }

  // Where the frame to begin at changes: pairs of a frame and that.
  void Entries(Packed& question, Packed& answer) {
    const auto from = question.Get<std::int64_t>();
    const std::int64_t frames = clip_->info().frames;
    std::vector<std::pair<std::int64_t, std::int64_t>> found;
    std::int64_t last = -1;
    std::int64_t index = std::max<std::int64_t>(0, from);
    for (; index < frames && found.size() < kMaxEntries; ++index) {
      const std::int64_t entry = clip_->EntryFrame(index);
      if (entry != last) found.emplace_back(index, entry);
      last = entry;
    }
    answer.Put(index);  // what is to be asked for next
    answer.Put(static_cast<std::uint32_t>(found.size()));
    for (const auto& [at, entry] : found) {
      answer.Put(at);
      answer.Put(entry);
    }
  }

  Descriptor socket_;
  std::unique_ptr<Clip> clip_;
  FrameMemory& memory_;
  std::byte* piece_ = nullptr;
  std::size_t piece_bytes_ = 0;
};

}  // namespace

int ServeReader() {
  // Named for `ps`; and nothing but both lines stays open.
  prctl(PR_SET_NAME, "reader");
  close_range(kFirstLine + 1, ~0u, 0);
  Received first = ReceiveMessage(kLifeLine);
  if (first.what != Received::What::kMessage) return 0;
  Packed message(std::move(first.bytes));
  // Used by threads that nobody waits for, to the process's end.
  std::unique_ptr<FrameMemory> memory;
  Packed greeting;
  greeting.Put(std::uint32_t{0});
  try {
    const auto limits = message.Get<ReaderLimits>();
    Limit(limits);
    memory = std::make_unique<FrameMemory>(limits.memory_bytes / kFrameShare);
    const std::filesystem::path path = message.GetText();
    // Libraries cannot be loaded any more afterwards.
    std::error_code ignored;
    if (!std::filesystem::is_directory(path, ignored) && !IsImageName(path)) {
      Libav();
    }
    greeting.Put(Said::kDone);
    // While this is the only thread: it holds for those that it starts.
    greeting.PutText(ConfineToFile(path));
    greeting.PutText(ConfineCalls());
  } catch (const core::InputError& error) {
    Packed trouble;
    trouble.Put(std::uint32_t{0});
    trouble.Put(Said::kInputError);
    trouble.PutText(error.what());
    SendMessage(kFirstLine, trouble.bytes());
    return 0;
  }
  SendMessage(kFirstLine, greeting.bytes(), memory->descriptor());
  std::thread([&memory] {
    Line(Descriptor(kFirstLine), nullptr, *memory).Serve();
  }).detach();
  // Decoding may go on for ever; the end of the line ends it.
  pollfd life = {kLifeLine, POLLIN, 0};
  while (poll(&life, 1, -1) < 0) {
  }
  // Without destructors: threads are at work.
  _exit(0);
}

}  // namespace touchdown::vision
