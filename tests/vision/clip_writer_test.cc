// Every format written and read back.
#include "touchdown/vision/footage/clip_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <random>
#include <stdexcept>
#include <tuple>

#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using touchdown::testing::TemporaryFolder;

// Frames made by `make(i)`, i = 0 .. n - 1.
template <class Make>
FrameSource Source(std::int64_t n, Make make) {
  return [n, make, i = std::int64_t{0},
          image = Image{}]() mutable -> std::optional<core::Frame> {
    if (i == n) return std::nullopt;
    image = make(i++);
    return image.View();
  };
}

FrameSource Patterns(std::int64_t n, std::int32_t width, std::int32_t height,
                     std::int32_t bit_depth) {
  return Source(
      n, [=](std::int64_t i) { return Pattern(width, height, bit_depth, i); });
}

// Noise that does not compress.
FrameSource Noise(std::int64_t n, std::int32_t side) {
  return Source(n, [side](std::int64_t i) {
    Image image = Pattern(side, side, 8, 0);
    std::mt19937 random(static_cast<unsigned>(i));
    for (auto& pixel : image.pixels) pixel = static_cast<std::byte>(random());
    return image;
  });
}

// A smooth scene with a soft disc that moves 3 px a frame.
Image Scene(std::int64_t i) {
  Image image{96, 64, 8, std::vector<std::byte>(96 * 64)};
  for (std::int32_t y = 0; y < 64; ++y) {
    for (std::int32_t x = 0; x < 96; ++x) {
      const double r =
          std::hypot(x - 10.0 - 3.0 * static_cast<double>(i % 28), y - 30.0);
      const double disc = 1.0 / (1.0 + std::exp((r - 9.0) / 1.5));
      image.pixels[static_cast<std::size_t>(y * 96 + x)] =
          static_cast<std::byte>(
              std::lround(40.0 + 0.5 * x + 0.3 * y + 120.0 * disc));
    }
  }
  return image;
}

void ExpectPatterns(const std::filesystem::path& path, std::int64_t n,
                    std::int32_t width, std::int32_t height,
                    std::int32_t bit_depth, const ClipOptions& options = {}) {
  const auto clip = OpenClip(path, options);
  ASSERT_EQ(clip->info().frames, n);
  ASSERT_EQ(clip->info().width_px, width);
  ASSERT_EQ(clip->info().height_px, height);
  ASSERT_EQ(clip->info().bit_depth, bit_depth);
  EXPECT_THAT(clip->info().warnings, IsEmpty());
  for (std::int64_t i = 0; i < n; ++i) {
    ASSERT_EQ(Samples(clip->Read(i)),
              Samples(Pattern(width, height, bit_depth, i).View()))
        << "frame " << i;
  }
  ExpectWindowsAreCrops(*clip, n - 1);
  ExpectWindowsAreCrops(*clip, 1);
  ExpectOrderDoesNotMatter(path, options);
}

// --- .mraw -------------------------------------------------------------------

struct MrawCase {
  std::int32_t bit_depth;
  std::optional<MrawBits> bits;
  bool xml;
};
class WriteMrawCases : public ::testing::TestWithParam<MrawCase> {};

TEST_P(WriteMrawCases, IsReadBackExactly) {
  const TemporaryFolder folder;
  MrawOptions options;
  options.fps = 150.0;
  options.save_step = 100;
  options.start_frame = -52;
  options.bits = GetParam().bits;
  options.xml_header = GetParam().xml;
  options.sensor_origin = {320, 16};
  const auto path = folder / "a.mraw";
  // 9 x 7 samples: packed frames begin in the middle of a byte.
  EXPECT_EQ(WriteMraw(path, options, Patterns(5, 9, 7, GetParam().bit_depth)),
            5);
  const auto clip = OpenClip(path);
  EXPECT_EQ(clip->info().bit_depth, GetParam().bit_depth);
  EXPECT_EQ(clip->info().time_base.fps, 150.0);
  EXPECT_EQ(clip->info().first_camera_frame, -52);
  if (GetParam().xml) {
    EXPECT_EQ(clip->info().sensor_origin, (SensorOrigin{320, 16}));
  }
  for (std::int64_t i = 0; i < 5; ++i) {
    EXPECT_EQ(Samples(clip->Read(i)),
              Samples(Pattern(9, 7, GetParam().bit_depth, i).View()));
    ExpectWindowsAreCrops(*clip, i);
  }
  ExpectOrderDoesNotMatter(path);
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, WriteMrawCases,
    ::testing::Values(MrawCase{8, {}, true}, MrawCase{8, {}, false},
                      MrawCase{12, {}, true}, MrawCase{12, {}, false},
                      MrawCase{12, MrawBits::k16, true}, MrawCase{16, {}, true},
                      MrawCase{10, {}, false}, MrawCase{14, {}, true}));

TEST(WriteMraw, ReplacesTheOtherFormOfHeader) {
  const TemporaryFolder folder;
  WriteMraw(folder / "a.mraw", {}, Patterns(2, 4, 4, 8));
  WriteMraw(folder / "a.mraw", {.xml_header = false}, Patterns(3, 6, 5, 8));
  EXPECT_EQ(OpenClip(folder / "a.mraw")->info().frames, 3);
}

// --- folders of images
// ---------------------------------------------------------

TEST(WriteImageFolder, IsReadBackExactly) {
  const TemporaryFolder folder;
  const ClipOptions options{.fps = 500.0};
  for (const std::int32_t depth : {8, 12, 16}) {
    const auto png = folder / ("png" + std::to_string(depth));
    EXPECT_EQ(WriteImageFolder(png, {}, Patterns(12, 9, 7, depth)), 12);
    ExpectPatterns(png, 12, 9, 7, depth, options);
    const auto tiff = folder / ("tiff" + std::to_string(depth));
    WriteImageFolder(tiff, {.kind = ImageKind::kTiff},
                     Patterns(12, 9, 7, depth));
    ExpectPatterns(tiff, 12, 9, 7, depth, options);
  }
  const auto jpeg = folder / "jpeg";
  WriteImageFolder(jpeg, {.kind = ImageKind::kJpeg}, Source(4, Scene));
  const auto clip = OpenClip(jpeg, options);
  for (std::int64_t i = 0; i < 4; ++i) {
    const auto got = Samples(clip->Read(i));
    const auto expected = Samples(Scene(i).View());
    for (std::size_t k = 0; k < got.size(); ++k) {
      ASSERT_NEAR(got[k], expected[k], 6.0);
    }
  }
}

TEST(WriteImageFolder, LeavesWhatIsThereAlone) {
  const TemporaryFolder folder;
  folder.Write("a.txt", "mine");
  EXPECT_THROW(WriteImageFolder(folder.path(), {}, Patterns(1, 4, 4, 8)),
               core::InputError);
  EXPECT_THROW(WriteImageFolder(folder / "a.txt", {}, Patterns(1, 4, 4, 8)),
               core::InputError);
  std::filesystem::create_directory(folder / "empty");
  EXPECT_EQ(WriteImageFolder(folder / "empty/", {}, Patterns(1, 4, 4, 8)), 1);
}

// --- video
// -----------------------------------------------------------------------

using VideoCase = std::tuple<const char*, VideoCodec, std::int32_t>;
class WriteVideoLossless : public ::testing::TestWithParam<VideoCase> {};

TEST_P(WriteVideoLossless, IsReadBackExactly) {
  const auto [extension, codec, depth] = GetParam();
  const TemporaryFolder folder;
  const auto path = folder / (std::string("a") + extension);
  VideoOptions options;
  options.codec = codec;
  options.fps = 500.0;
  options.quality =
      codec == VideoCodec::kH264 ? std::optional(0) : std::nullopt;
  options.key_frame_distance = 7;
  EXPECT_EQ(WriteVideo(path, options, Patterns(30, 34, 18, depth)), 30);
  const auto clip = OpenClip(path);
  EXPECT_EQ(clip->info().format, extension + 1);
  EXPECT_NEAR(clip->info().time_base.fps, 500.0, 1e-9);
  EXPECT_EQ(clip->info().time_base.source, FpsSource::kContainer);
  EXPECT_TRUE(clip->info().time_base.uniform);
  EXPECT_TRUE(clip->info().time_base.trusted);
  EXPECT_NEAR(clip->Read(29).time_s, 29.0 / 500.0, 1e-12);
  ExpectPatterns(path, 30, 34, 18, depth);
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, WriteVideoLossless,
    ::testing::Values(VideoCase{".avi", VideoCodec::kFfv1, 8},
                      VideoCase{".mkv", VideoCodec::kFfv1, 8},
                      VideoCase{".mkv", VideoCodec::kFfv1, 10},
                      VideoCase{".avi", VideoCodec::kFfv1, 12},
                      VideoCase{".mkv", VideoCodec::kFfv1, 16},
                      VideoCase{".avi", VideoCodec::kRaw, 8},
                      VideoCase{".avi", VideoCodec::kRaw, 16},
                      VideoCase{".mkv", VideoCodec::kRaw, 8},
                      VideoCase{".mp4", VideoCodec::kH264, 8},
                      VideoCase{".mov", VideoCodec::kH264, 8},
                      VideoCase{".mkv", VideoCodec::kH264, 8},
                      VideoCase{".avi", VideoCodec::kH264, 8}));

// Lossy codecs at their default quality, on a smooth scene: within 8 levels of
// 255 everywhere.
class WriteVideoLossy : public ::testing::TestWithParam<VideoCase> {};

TEST_P(WriteVideoLossy, IsReadBackClosely) {
  const auto [extension, codec, depth] = GetParam();
  const TemporaryFolder folder;
  const auto path = folder / (std::string("a") + extension);
  VideoOptions options;
  options.codec = codec;
  const bool fine = extension[1] == 'm' && extension[2] != 'k';  // .mp4, .mov
  const double fps = fine ? 2000.0 : 900.0;
  options.fps = fps;
  options.key_frame_distance = 20;
  WriteVideo(path, options, Source(60, Scene));
  const auto clip = OpenClip(path);
  ASSERT_EQ(clip->info().frames, 60);
  EXPECT_EQ(clip->info().bit_depth, depth);
  EXPECT_NEAR(clip->info().time_base.fps, fps, 1e-9);
  EXPECT_TRUE(clip->info().time_base.uniform);
  for (std::int64_t i = 0; i < 60; ++i) {
    const auto got = Samples(clip->Read(i));
    const auto expected = Samples(Scene(i).View());
    for (std::size_t k = 0; k < got.size(); ++k) {
      ASSERT_NEAR(got[k], expected[k], 8.0) << "frame " << i;
    }
  }
  ExpectWindowsAreCrops(*clip, 17);
  ExpectOrderDoesNotMatter(path);
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, WriteVideoLossy,
    ::testing::Values(VideoCase{".avi", VideoCodec::kMjpeg, 8},
                      VideoCase{".mov", VideoCodec::kMjpeg, 8},
                      VideoCase{".mkv", VideoCodec::kMjpeg, 8},
                      VideoCase{".mp4", VideoCodec::kH264, 8},
                      VideoCase{".mov", VideoCodec::kH264, 8},
                      VideoCase{".mkv", VideoCodec::kH264, 8},
                      VideoCase{".avi", VideoCodec::kH264, 8}));

// --- errors
// ------------------------------------------------------------------------

TEST(ClipWriters, ImpossibleArgumentsAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(WriteMraw(folder / "a.raw", {}, Patterns(1, 4, 4, 8)),
               std::invalid_argument);
  EXPECT_THROW(WriteMraw(folder / "a.mraw", {}, Patterns(0, 4, 4, 8)),
               std::invalid_argument);
  EXPECT_THROW(WriteMraw(folder / "a.mraw", {.fps = 0.0}, Patterns(1, 4, 4, 8)),
               std::invalid_argument);
  EXPECT_THROW(WriteMraw(folder / "a.mraw", {.bits = MrawBits::k12Packed},
                         Patterns(1, 4, 4, 8)),
               std::invalid_argument);
  const auto growing = [] {
    return Source(3, [](std::int64_t i) {
      return Pattern(4, static_cast<std::int32_t>(4 + i), 8, i);
    });
  };
  EXPECT_THROW(WriteMraw(folder / "a.mraw", {}, growing()),
               std::invalid_argument);
  EXPECT_THROW(WriteImageFolder(folder / "a", {}, growing()),
               std::invalid_argument);
  EXPECT_THROW(WriteVideo(folder / "a.avi", {}, growing()),
               std::invalid_argument);
  EXPECT_THROW(WriteVideo(folder / "a.gif", {}, Patterns(1, 4, 4, 8)),
               std::invalid_argument);
  EXPECT_THROW(WriteVideo(folder / "a.mp4", {.codec = VideoCodec::kRaw},
                          Patterns(1, 16, 16, 8)),
               std::invalid_argument);
  EXPECT_THROW(WriteVideo(folder / "a.avi", {.codec = VideoCodec::kMjpeg},
                          Patterns(1, 16, 16, 12)),
               std::invalid_argument);
  EXPECT_THROW(
      WriteVideo(folder / "a.avi", {.quality = 99}, Patterns(1, 16, 16, 8)),
      std::invalid_argument);
  // Nothing is left behind.
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// A file that may not grow stands for a disk that is full.
TEST(ClipWriters, AFullDiskIsOneLineAndLeavesNothing) {
  const TemporaryFolder folder;
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  struct rlimit small = before;
  small.rlim_cur = 100'000;
  auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  std::vector<std::string> errors;
  const auto attempt = [&](auto write) {
    try {
      write();
      errors.emplace_back("no error");
    } catch (const core::InputError& error) {
      errors.emplace_back(error.what());
    }
  };
  attempt([&] { WriteMraw(folder / "a.mraw", {}, Noise(20, 128)); });
  attempt([&] { WriteImageFolder(folder / "a", {}, Noise(2, 400)); });
  attempt([&] {
    WriteImageFolder(folder / "a", {.kind = ImageKind::kTiff}, Noise(2, 400));
  });
  for (const char* name : {"a.avi", "a.mkv"}) {
    attempt([&] {
      WriteVideo(folder / name, {.codec = VideoCodec::kRaw}, Noise(20, 128));
    });
  }
  attempt([&] {
    WriteVideo(folder / "a.mp4", {.codec = VideoCodec::kH264, .quality = 0},
               Noise(20, 128));
  });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  for (const auto& error : errors) {
    EXPECT_THAT(error, HasSubstr("cannot be written: File too large"));
  }
  EXPECT_EQ(errors.size(), 6u);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_THROW(WriteMraw(folder / "no/a.mraw", {}, Patterns(1, 4, 4, 8)),
               core::InputError);
  EXPECT_THROW(WriteVideo(folder / "no/a.avi", {}, Patterns(1, 16, 16, 8)),
               core::InputError);
  EXPECT_THROW(WriteImageFolder(folder / "no/a", {}, Patterns(1, 4, 4, 8)),
               core::InputError);
}

}  // namespace
}  // namespace touchdown::vision
