#include "touchdown/vision/footage/clip_apart.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::vision {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t kWidth_px = 96;
constexpr std::int32_t kHeight_px = 64;
constexpr std::int64_t kFrames = 12;

// Noise, another in every frame.
struct Noise {
  explicit Noise(std::int32_t depth) : bit_depth(depth) {}
  std::optional<core::Frame> Next() {
    if (index == kFrames) return std::nullopt;
    const std::size_t sample = bit_depth > 8 ? 2 : 1;
    bytes.resize(std::size_t{kWidth_px} * kHeight_px * sample);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      state = state * 1664525u + 1013904223u;
      // The upper byte of a word has what the depth leaves.
      const std::uint32_t mask =
          sample == 2 && i % 2 == 1 ? (1u << (bit_depth - 8)) - 1u : 0xFFu;
      bytes[i] = static_cast<std::byte>(state >> 16 & mask);
    }
    core::Frame frame;
    frame.data = bytes.data();
    frame.stride_bytes = static_cast<std::ptrdiff_t>(kWidth_px * sample);
    frame.width_px = kWidth_px;
    frame.height_px = kHeight_px;
    frame.bit_depth = bit_depth;
    frame.index = index++;
    return frame;
  }
  std::int32_t bit_depth;
  std::int64_t index = 0;
  std::uint32_t state = 1;
  std::vector<std::byte> bytes;
};

void Film(const fs::path& path, VideoCodec codec, std::int32_t bit_depth = 8) {
  Noise noise(bit_depth);
  VideoOptions options;
  options.codec = codec;
  options.key_frame_distance = 5;
  WriteVideo(path, options, [&noise] { return noise.Next(); });
}

// The reader that this process has started last; -1: there is none.
pid_t Reader() {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream stat(entry.path() / "stat");
    std::string text;
    std::getline(stat, text);
    const std::size_t name = text.rfind(") ");
    if (name == std::string::npos) continue;
    char state = 0;
    int parent = 0;
    if (std::sscanf(text.c_str() + name, ") %c %d", &state, &parent) == 2 &&
        parent == getpid() && state != 'Z') {
      return static_cast<pid_t>(std::stol(entry.path().filename().string()));
    }
  }
  return -1;
}

// Sends it a signal, and waits until that has done what it does; how it ended
// is left to who started it.
void SendToReader(int signal, int what) {
  const pid_t reader = Reader();
  ASSERT_EQ(kill(reader, signal), 0);
  siginfo_t about;
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(reader), &about, what | WNOWAIT),
            0);
}

void ExpectSameFrame(const core::Frame& a, const core::Frame& b) {
  ASSERT_EQ(a.width_px, b.width_px);
  ASSERT_EQ(a.height_px, b.height_px);
  ASSERT_EQ(a.bit_depth, b.bit_depth);
  EXPECT_EQ(a.time_s, b.time_s);
  const auto bytes =
      static_cast<std::size_t>(a.width_px) * (a.is_16_bit() ? 2u : 1u);
  for (std::int32_t y = 0; y < a.height_px; ++y) {
    ASSERT_EQ(std::memcmp(a.data + y * a.stride_bytes,
                          b.data + y * b.stride_bytes, bytes),
              0)
        << "row " << y << " of frame " << a.index;
  }
}

void ExpectSameClip(const fs::path& path, const ClipOptions& options = {}) {
  const auto here = OpenClip(path, options);
  Confinement granted;
  const auto apart = OpenClipApart(path, options, {}, &granted);
  EXPECT_TRUE(granted.is_apart) << path;
  ASSERT_NE(Reader(), -1);
  const ClipInfo& a = here->info();
  const ClipInfo& b = apart->info();
  EXPECT_EQ(a.path, b.path);
  EXPECT_EQ(a.format, b.format);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.bit_depth, b.bit_depth);
  EXPECT_EQ(a.is_predicted, b.is_predicted);
  EXPECT_EQ(a.gamma_is_known, b.gamma_is_known);
  EXPECT_EQ(a.has_colour, b.has_colour);
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_EQ(a.time_base.fps, b.time_base.fps);
  EXPECT_EQ(a.time_base.source, b.time_base.source);
  const auto other_here = here->OpenAnother();
  const auto other_apart = apart->OpenAnother();
  EXPECT_EQ(other_here != nullptr, other_apart != nullptr);
  const core::PixelRect window = {7, 5, 31, 17};
  // In order, then about.
  std::vector<std::int64_t> order;
  for (std::int64_t i = 0; i < a.frames; ++i) order.push_back(i);
  order.insert(order.end(), {9, 3, 4, 11, 0});
  for (const std::int64_t i : order) {
    EXPECT_EQ(here->EntryFrame(i), apart->EntryFrame(i));
    ExpectSameFrame(here->Read(i), apart->Read(i));
    ExpectSameFrame(here->Read(i, window), apart->Read(i, window));
    if (other_apart) {
      ExpectSameFrame(here->Read(a.frames - 1 - i),
                      other_apart->Read(a.frames - 1 - i));
    }
  }
}

TEST(OpenClipApart, GivesTheFramesOfOpenClip) {
  const testing::TemporaryFolder folder;
  Film(folder / "mjpeg.avi", VideoCodec::kMjpeg);
  Film(folder / "h264.mp4", VideoCodec::kH264);
  Film(folder / "ffv1.mkv", VideoCodec::kFfv1, 12);
  Film(folder / "raw.avi", VideoCodec::kRaw, 16);
  for (const char* name : {"mjpeg.avi", "h264.mp4", "ffv1.mkv", "raw.avi"}) {
    SCOPED_TRACE(name);
    ExpectSameClip(folder / name);
  }
}

TEST(OpenClipApart, ReadsFoldersOfPicturesAndWhatTheirLinksLeadTo) {
  const testing::TemporaryFolder folder;
  ClipOptions options;
  options.fps = 500.0;
  for (const auto kind :
       {ImageKind::kPng, ImageKind::kTiff, ImageKind::kJpeg}) {
    const fs::path at = folder / std::to_string(static_cast<int>(kind));
    Noise noise(8);
    WriteImageFolder(at, {kind}, [&noise] { return noise.Next(); });
    ExpectSameClip(at, options);
    const fs::path links = folder / ("links" + at.filename().string());
    fs::create_directories(links);
    for (const auto& entry : fs::directory_iterator(at)) {
      fs::create_symlink(entry.path(), links / entry.path().filename());
    }
    ExpectSameClip(links, options);
  }
}

TEST(OpenClipApart, LeavesOurOwnReadersInTheProcess) {
  const testing::TemporaryFolder folder;
  Noise noise(8);
  WriteMraw(folder / "a.mraw", {}, [&noise] { return noise.Next(); });
  Confinement granted;
  const auto clip = OpenClipApart(folder / "a.mraw", {}, {}, &granted);
  EXPECT_FALSE(granted.is_apart);
  EXPECT_EQ(Reader(), -1);
}

TEST(OpenClipApart, SaysWhatOpenClipSays) {
  const testing::TemporaryFolder folder;
  folder.Write("rubbish.avi", "no recording");
  Film(folder / "cut.avi", VideoCodec::kMjpeg);
  fs::resize_file(folder / "cut.avi", 300);
  const auto trouble = [](const auto& open) -> std::string {
    try {
      open();
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  };
  for (const char* name : {"rubbish.avi", "cut.avi", "none.avi"}) {
    const fs::path path = folder / name;
    const std::string here = trouble([&] { OpenClip(path); });
    EXPECT_NE(here.find(name), std::string::npos);
    EXPECT_EQ(trouble([&] { OpenClipApart(path); }), here);
  }
  EXPECT_EQ(Reader(), -1);
}

TEST(OpenClipApart, TellsTheDeathOfAReader) {
  // The address sanitizer ends a process by its own way at a SIGSEGV.
#ifdef __SANITIZE_ADDRESS__
  constexpr const char* kHow = "ended with status 1";
#else
  constexpr const char* kHow = "SIGSEGV";
#endif
  const testing::TemporaryFolder folder;
  Film(folder / "shot.avi", VideoCodec::kMjpeg);
  const auto clip = OpenClipApart(folder / "shot.avi");
  clip->Read(0);
  SendToReader(SIGSEGV, WEXITED);
  for (int again = 0; again < 2; ++again) {
    try {
      clip->Read(5);
      ADD_FAILURE() << "a frame of a reader that has ended";
    } catch (const core::InputError& error) {
      const std::string what = error.what();
      EXPECT_NE(what.find("shot.avi"), std::string::npos);
      EXPECT_NE(what.find(kHow), std::string::npos) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos);
    }
  }
  EXPECT_EQ(Reader(), -1);
}

TEST(OpenClipApart, EndsAReaderThatIsSilent) {
  const testing::TemporaryFolder folder;
  Film(folder / "shot.avi", VideoCodec::kMjpeg);
  ReaderLimits limits;
  limits.silence_s = 3.0;  // opening takes less on a busy machine
  const auto clip = OpenClipApart(folder / "shot.avi", {}, limits);
  SendToReader(SIGSTOP, WSTOPPED);
  EXPECT_THROW(clip->Read(5), core::InputError);
  EXPECT_EQ(Reader(), -1);
}

TEST(OpenClipApart, IsCancelledWhileAReaderIsSilent) {
  const testing::TemporaryFolder folder;
  Film(folder / "shot.avi", VideoCodec::kMjpeg);
  const auto clip = OpenClipApart(folder / "shot.avi");
  SendToReader(SIGSTOP, WSTOPPED);
  clip->set_cancellation(core::Cancellation::After(0.1));
  EXPECT_THROW(clip->Read(5), core::Cancelled);
}

TEST(OpenClipApart, AnotherOutlivesTheClipItIsOf) {
  const testing::TemporaryFolder folder;
  Film(folder / "shot.avi", VideoCodec::kMjpeg);
  auto clip = OpenClipApart(folder / "shot.avi");
  auto another = clip->OpenAnother();
  ASSERT_TRUE(another);
  clip.reset();
  EXPECT_EQ(another->Read(3).index, 3);
  another.reset();
  EXPECT_EQ(Reader(), -1);
}

TEST(OpenClipApart, RefusesWhatNeedsMoreMemoryThanAReaderHas) {
  const testing::TemporaryFolder folder;
  Film(folder / "shot.avi", VideoCodec::kMjpeg);
  ReaderLimits limits;
  limits.memory_bytes = std::size_t{16} << 20;
  EXPECT_THROW(OpenClipApart(folder / "shot.avi", {}, limits),
               core::InputError);
}

// `ulimit -f` is for disks, and the memory of frames is no disk.
TEST(OpenClipApart, ReadsWhereNoFileMayGrow) {
  const testing::TemporaryFolder folder;
  Film(folder / "film.avi", VideoCodec::kFfv1);
  rlimit before = {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit none = before;
  none.rlim_cur = 0;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &none), 0);
  std::int64_t frames = 0;
  try {
    const auto clip = OpenClipApart(folder / "film.avi");
    for (; frames < clip->info().frames; ++frames) clip->Read(frames);
  } catch (const core::InputError& error) {
    ADD_FAILURE() << error.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(frames, kFrames);
}

TEST(ReadImageApart, GivesThePictureOfReadImage) {
  const testing::TemporaryFolder folder;
  Noise noise(12);
  WritePng(folder / "a.png", *noise.Next());
  const Image here = ReadImage(folder / "a.png");
  const Image apart = ReadImageApart(folder / "a.png");
  EXPECT_EQ(apart.bit_depth, 12);
  EXPECT_EQ(apart.width_px, here.width_px);
  EXPECT_EQ(apart.pixels, here.pixels);
  folder.Write("b.png", "no picture");
  EXPECT_THROW(ReadImageApart(folder / "b.png"), core::InputError);
}

}  // namespace
}  // namespace touchdown::vision
