// touchdown/vision/footage/clip.h on real recordings; facts: footage/README.md.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"
#include "tests/vision/video_helpers.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {
namespace {

using touchdown::testing::ReadAll;
using touchdown::testing::Shared;
using touchdown::testing::TemporaryFolder;

struct Recording {
  const char* name;
  const char* format;
  std::int32_t width, height, bit_depth;
  std::int64_t frames, first_camera_frame;
  double fps;
  bool trusted;
  std::size_t warnings;
};
class VideoFootage : public ::testing::TestWithParam<Recording> {};

// But for two .cine: the rate of cine_781 is that of the camera's stamps, and
// the samples of data_small_cine are linear ones (clip_cine_test.cc).
TEST_P(VideoFootage, IsWhatItsReadmeSays) {
  const Recording& expected = GetParam();
  const auto path = Shared(std::string("footage/") + expected.name);
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto clip = OpenClip(path);
  const ClipInfo& info = clip->info();
  EXPECT_EQ(info.format, expected.format);
  EXPECT_EQ(info.width_px, expected.width);
  EXPECT_EQ(info.height_px, expected.height);
  EXPECT_EQ(info.bit_depth, expected.bit_depth);
  EXPECT_EQ(info.frames, expected.frames);
  EXPECT_EQ(info.first_camera_frame, expected.first_camera_frame);
  EXPECT_NEAR(info.time_base.fps, expected.fps, 1e-4);
  EXPECT_TRUE(info.time_base.uniform);
  EXPECT_EQ(info.time_base.trusted, expected.trusted);
  EXPECT_EQ(info.warnings.size(), expected.warnings);
  for (std::int64_t i = 0; i < info.frames; ++i) {
    EXPECT_EQ(clip->Read(i).index, i);
  }
  ExpectWindowsAreCrops(*clip, info.frames / 2);
}
INSTANTIATE_TEST_SUITE_P(
    Clips, VideoFootage,
    ::testing::Values(Recording{"red_ball.mp4", "mp4", 1080, 1920, 8, 65, 0,
                                29.97003, false, 1},
                      Recording{"galileo_projectile.mp4", "mp4", 640, 480, 8,
                                33, 0, 30.0, false, 1},
                      Recording{"bouncing_cart.mov", "mov", 640, 480, 8, 328, 0,
                                30.0, false, 1},
                      Recording{"data_small_cine.cine", "cine", 256, 32, 12,
                                235, 0, 100.0, true, 1},
                      Recording{"cine_781.cine", "cine", 256, 256, 12, 15,
                                -5417, 9003.21293, true, 1},
                      Recording{"cine_legacy.cine", "cine", 128, 128, 14, 97,
                                -7722, 35087.0, true, 0}));

TEST(VideoFootageOrder, BackwardsIsForwards) {
  for (const char* name :
       {"footage/galileo_projectile.mp4", "footage/cine_781.cine"}) {
    const auto path = Shared(name);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
    ExpectOrderDoesNotMatter(path);
  }
}

TEST(VideoFootageRedBall, TheFirstTwoFramesAreIdentical) {
  const auto path = Shared("footage/red_ball.mp4");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto clip = OpenClip(path);
  const auto samples = [&](std::int64_t i) { return Samples(clip->Read(i)); };
  const auto first = samples(0);
  const auto second = samples(1);
  const auto third = samples(2);
  const auto distance = [](const auto& a, const auto& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      sum += std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    }
    return sum / static_cast<double>(a.size());
  };
  EXPECT_LT(distance(first, second), 0.1 * distance(second, third));
}

// A second reader of uncompressed .cine, by the format's own layout: the
// offsets of the frames stand in a table, each frame begins with the length of
// its annotation, and rows of 16-bit samples run upwards.
TEST(VideoFootageCine, SamplesAreThoseInTheFile) {
  for (const char* name :
       {"footage/cine_781.cine", "footage/cine_legacy.cine"}) {
    const auto path = Shared(name);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
    const std::string bytes = ReadAll(path);
    const auto number = [&](std::size_t at, std::size_t size) {
      std::uint64_t value = 0;
      std::memcpy(&value, bytes.data() + at, size);
      return value;
    };
    const std::size_t image_header = number(24, 4);    // OffImageHeader
    const std::size_t setup = number(28, 4);           // OffSetup
    const std::size_t table = number(32, 4);           // OffImageOffsets
    const bool flipped = number(setup + 760, 4) != 0;  // bFlipV
    const auto width = static_cast<std::int32_t>(number(image_header + 4, 4));
    const auto height = static_cast<std::int32_t>(number(image_header + 8, 4));
    const auto clip = OpenClip(path);
    ASSERT_EQ(clip->info().width_px, width);
    ASSERT_EQ(clip->info().height_px, height);
    for (std::int64_t i = 0; i < clip->info().frames; i += 7) {
      const std::size_t at = number(table + 8 * static_cast<std::size_t>(i), 8);
      const std::size_t pixels = at + number(at, 4);
      const core::Frame frame = clip->Read(i);
      for (std::int32_t y = 0; y < height; ++y) {
        for (std::int32_t x = 0; x < width; ++x) {
          const auto row =
              static_cast<std::size_t>(flipped ? y : height - 1 - y);
          ASSERT_EQ(frame.at(x, y),
                    number(pixels + 2 * (row * static_cast<std::size_t>(width) +
                                         static_cast<std::size_t>(x)),
                           2))
              << name << " frame " << i << " at " << x << "," << y;
        }
      }
    }
  }
}

// Two readers of the same pictures: libjpeg in the folder, libav in a Motion
// JPEG made of the same files. Their inverse transforms may differ by a level.
TEST(VideoFootageHoop, LibavAndLibjpegAgree) {
  const auto path = Shared("footage/roll_slip_42.4");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const TemporaryFolder folder;
  std::vector<std::string> files;
  for (int i = 4; i <= 26; ++i) {
    files.push_back(
        ReadAll(path / ("RollSlip42." + std::string(i < 10 ? "0" : "") +
                        std::to_string(i) + ".jpg")));
  }
  WritePlain(folder / "carrier.avi", 23, Lossless(VideoCodec::kMjpeg, 30.0));
  Remux(folder / "carrier.avi", folder / "a.avi", [&](AVPacket& packet) {
    const std::string& file = files[static_cast<std::size_t>(packet.pts)];
    const std::int64_t pts = packet.pts;
    av_packet_unref(&packet);
    av_new_packet(&packet, static_cast<int>(file.size()));
    std::memcpy(packet.data, file.data(), file.size());
    packet.pts = packet.dts = pts;
    packet.duration = 1;
    packet.flags = AV_PKT_FLAG_KEY;
  });
  const auto pictures = OpenClip(path, {.fps = 30.0});
  const auto video = OpenClip(folder / "a.avi", {.fps = 30.0});
  ASSERT_EQ(pictures->info().frames, 23);
  ASSERT_EQ(video->info().frames, 23);
  for (std::int64_t i = 0; i < 23; i += 11) {
    const auto a = Samples(pictures->Read(i));
    const auto b = Samples(video->Read(i));
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k], b[k], 1.0);
  }
}

}  // namespace
}  // namespace touchdown::vision
