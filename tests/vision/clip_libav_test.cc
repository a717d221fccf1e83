// touchdown/vision/footage/clip.h on video files: numbers, times, turns and
// damage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <random>

#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"
#include "tests/vision/video_helpers.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::vision {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using touchdown::testing::ReadAll;
using touchdown::testing::TemporaryFolder;

// --- times
// ---------------------------------------------------------------------

TEST(VideoTime, APlaybackRateIsNotTrusted) {
  const TemporaryFolder folder;
  for (const double fps : {24.0, 25.0, 30000.0 / 1001.0, 30.0, 50.0, 60.0}) {
    const auto path = folder / "a.avi";
    WritePlain(path, 3, Lossless(VideoCodec::kFfv1, fps));
    const auto clip = OpenClip(path);
    EXPECT_NEAR(clip->info().time_base.fps, fps, 1e-6);
    EXPECT_FALSE(clip->info().time_base.trusted);
    EXPECT_THAT(clip->info().warnings, ElementsAre(HasSubstr("--fps")));
    const auto told = OpenClip(path, {.fps = 2000.0});
    EXPECT_EQ(told->info().time_base.fps, 2000.0);
    EXPECT_EQ(told->info().time_base.source, FpsSource::kUser);
    EXPECT_TRUE(told->info().time_base.trusted);
    EXPECT_THAT(told->info().warnings, IsEmpty());
    EXPECT_DOUBLE_EQ(told->Read(2).time_s, 2.0 / 2000.0);
  }
  WritePlain(folder / "a.avi", 3, Lossless(VideoCodec::kFfv1, 31.0));
  EXPECT_TRUE(OpenClip(folder / "a.avi")->info().time_base.trusted);
}

TEST(VideoTime, VariableRateGivesTheTrueTimes) {
  const TemporaryFolder folder;
  WritePlain(folder / "even.mkv", 20, Lossless(VideoCodec::kFfv1, 100.0));
  // Every third frame comes 4 ms late, of a period of 10 ms.
  Remux(folder / "even.mkv", folder / "uneven.mkv", [](AVPacket& packet) {
    if (packet.pts % 30 == 20) {
      packet.pts += 4;
      packet.dts += 4;
    }
  });
  const auto clip = OpenClip(folder / "uneven.mkv");
  ASSERT_EQ(clip->info().frames, 20);
  EXPECT_FALSE(clip->info().time_base.uniform);
  EXPECT_THAT(clip->info().warnings,
              ElementsAre(HasSubstr("not equally spaced")));
  for (std::int64_t i = 0; i < 20; ++i) {
    EXPECT_NEAR(clip->Read(i).time_s,
                static_cast<double>(i) * 0.010 + (i % 3 == 2 ? 0.004 : 0.0),
                1e-12);
  }
  ExpectOrderDoesNotMatter(folder / "uneven.mkv");
  // The user's rate is of equally spaced frames.
  const auto told = OpenClip(folder / "uneven.mkv", {.fps = 100.0});
  EXPECT_TRUE(told->info().time_base.uniform);
  EXPECT_DOUBLE_EQ(told->Read(2).time_s, 0.02);
  EXPECT_THAT(told->info().warnings,
              ElementsAre(HasSubstr("not equally spaced")));
}

// 30 fps in ticks of 1 ms: 33, 67, 100 ... are not a variable rate.
TEST(VideoTime, RoundedTimestampsAreUniform) {
  const TemporaryFolder folder;
  WritePlain(folder / "a.mkv", 40, Lossless(VideoCodec::kFfv1, 30.0));
  const auto clip = OpenClip(folder / "a.mkv");
  EXPECT_TRUE(clip->info().time_base.uniform);
  EXPECT_NEAR(clip->info().time_base.fps, 30.0, 1e-9);
  EXPECT_NEAR(clip->Read(1).time_s, 1.0 / 30.0, 1e-12);
}

TEST(VideoTime, TimestampsThatFramesShareAreNotTrusted) {
  const TemporaryFolder folder;
  WritePlain(folder / "a.mp4", 40, Lossless(VideoCodec::kH264, 4000.0));
  Remux(folder / "a.mp4", folder / "b.mkv", [](AVPacket&) {});
  const auto clip = OpenClip(folder / "b.mkv");
  EXPECT_EQ(clip->info().frames, 40);
  EXPECT_FALSE(clip->info().time_base.trusted);
  EXPECT_THAT(clip->info().warnings, Contains(HasSubstr("too coarse")));
  for (const std::int64_t i : {0, 39, 5, 6, 7, 0}) {
    EXPECT_EQ(Samples(clip->Read(i)), Samples(Plain(i).View()));
  }
}

// --- numbers
// ---------------------------------------------------------------------

TEST(VideoNumbers, IdenticalFramesAtTheStartAreFrames) {
  const TemporaryFolder folder;
  for (const char* name : {"a.mp4", "a.mkv", "a.avi"}) {
    WritePlain(
        folder / name, 12, Lossless(VideoCodec::kH264),
        [](std::int64_t i) { return Plain(std::max<std::int64_t>(i, 4)); });
    const auto clip = OpenClip(folder / name);
    ASSERT_EQ(clip->info().frames, 12);
    for (std::int64_t i = 0; i < 12; ++i) {
      EXPECT_EQ(Samples(clip->Read(i)),
                Samples(Plain(std::max<std::int64_t>(i, 4)).View()));
    }
  }
}

TEST(VideoNumbers, JumpsAreExactWhateverTheThreads) {
  const TemporaryFolder folder;
  for (const char* name : {"a.mp4", "a.mkv", "a.avi"}) {
    WritePlain(folder / name, 90, Lossless(VideoCodec::kH264));
    for (const std::int32_t threads : {1, 2, 5}) {
      const auto clip = OpenClip(folder / name, {.decoder_threads = threads});
      for (const std::int64_t i : {0, 40, 89, 41, 42, 60, 3, 3, 88, 10, 9, 8}) {
        ASSERT_EQ(Samples(clip->Read(i)), Samples(Plain(i).View()))
            << name << " frame " << i << " with " << threads << " threads";
      }
    }
  }
}

// --- display rotation
// --------------------------------------------------------------

// Only where each frame is stored alone is a second reader of use.
TEST(VideoNumbers, AnotherReaderReadsTheSame) {
  const testing::TemporaryFolder folder;
  for (const VideoCodec codec : {VideoCodec::kFfv1, VideoCodec::kMjpeg}) {
    const auto path = folder / (codec == VideoCodec::kFfv1 ? "a.mkv" : "a.avi");
    VideoOptions options = Lossless(codec);
    options.key_frame_distance = 1;
    WritePlain(path, 20, options);
    const auto clip = OpenClip(path);
    const auto other = clip->Another();
    ASSERT_NE(other, nullptr);
    EXPECT_EQ(other->info().frames, 20);
    for (const std::int64_t i : {13, 14, 3, 19, 0}) {
      const core::Frame a = clip->Read(i);
      const core::Frame b = other->Read(i);
      EXPECT_EQ(b.index, i);
      EXPECT_EQ(a.time_s, b.time_s);
      for (std::int32_t y = 0; y < kHeight; ++y) {
        for (std::int32_t x = 0; x < kWidth; ++x) {
          ASSERT_EQ(a.at(x, y), b.at(x, y)) << i;
        }
      }
    }
  }
  WritePlain(folder / "b.mkv", 20, Lossless(VideoCodec::kH264));
  EXPECT_EQ(OpenClip(folder / "b.mkv")->Another(), nullptr);
}

// Rotating by a quarter turn anticlockwise takes stored (x, y) to shown
// (y, width - 1 - x).
TEST(VideoRotation, UpIsUp) {
  const TemporaryFolder folder;
  for (const char* name : {"a.mp4", "a.mov"}) {
    for (int turns = 0; turns < 4; ++turns) {
      VideoOptions options = Lossless(VideoCodec::kH264);
      options.turn_quarters = turns;
      WritePlain(folder / name, 3, options);
      const auto clip = OpenClip(folder / name);
      const bool upright = turns % 2 == 0;
      ASSERT_EQ(clip->info().width_px, upright ? kWidth : kHeight);
      ASSERT_EQ(clip->info().height_px, upright ? kHeight : kWidth);
      EXPECT_THAT(clip->info().warnings, IsEmpty());
      const core::Frame shown = clip->Read(2);
      const Image stored = Plain(2);
      for (std::int32_t y = 0; y < kHeight; ++y) {
        for (std::int32_t x = 0; x < kWidth; ++x) {
          std::int32_t u = x;
          std::int32_t v = y;
          std::int32_t width = kWidth;
          for (int turn = 0; turn < turns; ++turn) {
            const std::int32_t old_u = u;
            u = v;
            v = width - 1 - old_u;
            width = width == kWidth ? kHeight : kWidth;
          }
          ASSERT_EQ(shown.at(u, v), stored.View().at(x, y))
              << turns << " turns, stored " << x << "," << y;
        }
      }
      ExpectWindowsAreCrops(*clip, 1);
      ExpectOrderDoesNotMatter(folder / name);
    }
  }
}

// --- damage
// ------------------------------------------------------------------------

TEST(VideoDamage, WhatIsNoRecordingIsOneLine) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(folder.Write("empty.avi", "")),
              HasSubstr("not a recording that can be read"));
  EXPECT_THAT(ErrorOf(folder.Write("text.mp4", "hello, world\nbye\n")),
              HasSubstr("not a recording that can be read"));
  EXPECT_THAT(ErrorOf(folder.Write("list.m3u8", "#EXTM3U\n#EXTINF:1,\na.ts\n")),
              HasSubstr("not a recording that can be read"));
  std::string noise(100'000, '\0');
  std::mt19937 random(5);
  for (char& c : noise) c = static_cast<char>(random());
  EXPECT_NE(ErrorOf(folder.Write("noise.mkv", noise)), "");
}

struct DamageCase {
  const char* name;
  VideoCodec codec;
};
class VideoDamageIn : public ::testing::TestWithParam<DamageCase> {};

// Cut anywhere: an error of one line, or a clip whose frames are the first ones
// of the whole, with a warning.
TEST_P(VideoDamageIn, ACutClipKeepsItsWholeFrames) {
  const TemporaryFolder folder;
  const auto path = folder / GetParam().name;
  WritePlain(path, 40, Lossless(GetParam().codec));
  const std::string whole = ReadAll(path);
  const auto cut = folder / (std::string("cut_") + GetParam().name);
  std::int64_t most = 0;
  for (int part = 1; part < 40; ++part) {
    folder.Write(
        cut.filename().string(),
        whole.substr(0, whole.size() * static_cast<std::size_t>(part) / 40));
    try {
      const auto clip = OpenClip(cut);
      const std::int64_t n = clip->info().frames;
      EXPECT_LE(n, 40);
      if (n < 40) {
        EXPECT_THAT(clip->info().warnings, Contains(HasSubstr("ends early")));
      }
      EXPECT_GE(n, most) << "more of the file gives no fewer frames";
      most = n;
      for (std::int64_t i = 0; i < n; ++i) {
        ASSERT_EQ(Samples(clip->Read(i)), Samples(Plain(i).View()))
            << "frame " << i << " of " << n << ", cut to " << part << "/40";
      }
      EXPECT_TRUE(clip->info().time_base.uniform);
    } catch (const core::InputError& error) {
      EXPECT_EQ(most, 0) << error.what();
    }
  }
  // An .mp4 or .mov has its list of frames at the end.
  if (GetParam().name[2] != 'm' || GetParam().name[3] == 'k') {
    EXPECT_GE(most, 36);
  }
}

// Bytes overwritten in the middle: every frame is the right one or an error
// that names it (FFV1 has check sums; others may show changed pixels).
TEST_P(VideoDamageIn, ABadFrameIsNamedAndTheOthersStay) {
  const TemporaryFolder folder;
  const auto path = folder / GetParam().name;
  WritePlain(path, 40, Lossless(GetParam().codec));
  std::string bytes = ReadAll(path);
  std::mt19937 random(3);
  for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 60; ++i) {
    bytes[i] = static_cast<char>(random());
  }
  folder.Write(GetParam().name, bytes);
  const auto clip = OpenClip(path);
  int right = 0;
  int changed = 0;
  int refused = 0;
  for (std::int64_t i = 0; i < clip->info().frames; ++i) {
    try {
      const core::Frame frame = clip->Read(i);
      EXPECT_EQ(frame.index, i);
      ++(Samples(frame) == Samples(Plain(i).View()) ? right : changed);
    } catch (const core::InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("frame " + std::to_string(i)));
      ++refused;
    }
  }
  EXPECT_GE(right, 15);
  EXPECT_GE(refused + changed, 1);
  if (GetParam().codec == VideoCodec::kFfv1) {
    EXPECT_EQ(changed, 0);
    EXPECT_GE(right, 35);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, VideoDamageIn,
    ::testing::Values(DamageCase{"a.avi", VideoCodec::kRaw},
                      DamageCase{"a.avi", VideoCodec::kFfv1},
                      DamageCase{"a.mkv", VideoCodec::kFfv1},
                      DamageCase{"a.avi", VideoCodec::kH264},
                      DamageCase{"a.mkv", VideoCodec::kH264},
                      DamageCase{"a.mp4", VideoCodec::kH264}));

// Seeded mutations of headers: a clip or an error of the right lane.
TEST(VideoDamage, MutatedHeadersNeverCrash) {
  const TemporaryFolder folder;
  std::mt19937 random(11);
  for (const DamageCase& kind : {DamageCase{"a.avi", VideoCodec::kFfv1},
                                 DamageCase{"a.mkv", VideoCodec::kFfv1},
                                 DamageCase{"a.mp4", VideoCodec::kH264},
                                 DamageCase{"b.avi", VideoCodec::kRaw}}) {
    WritePlain(folder / kind.name, 3, Lossless(kind.codec));
    const std::string whole = ReadAll(folder / kind.name);
    for (int round = 0; round < 60; ++round) {
      std::string bytes = whole;
      // The lists are at either end.
      for (int i = 0; i < 4; ++i) {
        const std::size_t at =
            random() % std::min<std::size_t>(700, bytes.size());
        bytes[i % 2 == 0 ? at : bytes.size() - 1 - at] =
            static_cast<char>(random());
      }
      ErrorOf(folder.Write(std::string("m_") + kind.name, bytes));
    }
  }
}

}  // namespace
}  // namespace touchdown::vision
