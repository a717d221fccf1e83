// touchdown/vision/footage/clip.h on Phantom .cine files: samples, the camera's
// own times, and frames that it dropped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/vision/cine_file.h"
#include "tests/vision/clip_helpers.h"
#include "touchdown/vision/footage/clip.h"
#include "vision/src/footage/formats/cine_curve.h"
#include "vision/src/footage/formats/cine_header.h"

namespace touchdown::vision {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using touchdown::testing::Shared;
using touchdown::testing::TemporaryFolder;

CineFile Recording(int frames, std::int32_t bits = 8) {
  CineFile file;
  for (int i = 0; i < frames; ++i)
    file.frames.push_back(Pattern(12, 6, bits, i));
  return file;
}

// Stamps at whole periods, some left out.
std::vector<double> Stamps(int frames, double period_s,
                           const std::function<int(int)>& dropped_before) {
  std::vector<double> stamps;
  int slot = 0;
  for (int i = 0; i < frames; ++i) {
    slot += dropped_before(i);
    stamps.push_back(slot++ * period_s);
  }
  return stamps;
}
int None(int) { return 0; }

// --- samples ----------------------------------------------------------------

struct Depth {
  std::int32_t stored;
  std::uint32_t real;
};
class CineSamples : public ::testing::TestWithParam<Depth> {};

TEST_P(CineSamples, AreThoseWritten) {
  const auto [stored, real] = GetParam();
  const auto bits = real > 0 ? static_cast<std::int32_t>(real) : stored;
  CineFile file = Recording(5, bits);
  file.real_bits = real;
  const TemporaryFolder folder;
  const auto path = folder.Write("a.cine", file.Bytes());
  const auto clip = OpenClip(path);
  EXPECT_EQ(clip->info().format, "cine");
  EXPECT_EQ(clip->info().frames, 5);
  EXPECT_EQ(clip->info().bit_depth, bits);
  EXPECT_EQ(clip->info().first_camera_frame, -5);
  EXPECT_EQ(clip->info().time_base.fps, 1000.0);
  EXPECT_THAT(clip->info().warnings, IsEmpty());
  for (const std::int64_t i : {4, 0, 3}) {
    EXPECT_EQ(Samples(clip->Read(i)), Samples(Pattern(12, 6, bits, i).View()));
  }
  ExpectWindowsAreCrops(*clip, 2);
  ExpectOrderDoesNotMatter(path);
}
INSTANTIATE_TEST_SUITE_P(Depths, CineSamples,
                         ::testing::Values(Depth{8, 0}, Depth{16, 10},
                                           Depth{16, 12}, Depth{16, 14},
                                           Depth{16, 0}));

// Of the table that defines the format: black, white, saturation, the ends and
// some between.
TEST(CineCurve, IsThePublishedTable) {
  const CineCurve curve = CineLinearOfCode();
  const std::map<std::size_t, int> published = {
      {0, 2},       {1, 5},      {14, 17},    {64, 64},     {159, 154},
      {160, 156},   {256, 290},  {400, 623},  {512, 998},   {640, 1559},
      {768, 2267},  {800, 2468}, {900, 3159}, {1000, 3947}, {1014, 4064},
      {1015, 4095}, {1023, 4095}};
  for (const auto& [code, linear] : published) {
    EXPECT_EQ(curve[code], linear) << code;
  }
  EXPECT_TRUE(std::is_sorted(curve.begin(), curve.end()));
}

TEST(CinePacked, TenBitsBecomeTwelveLinearOnes) {
  CineFile file = Recording(3, 10);
  file.packed_10 = true;
  const TemporaryFolder folder;
  const auto path = folder.Write("a.cine", file.Bytes());
  const auto clip = OpenClip(path);
  EXPECT_EQ(clip->info().bit_depth, 12);
  EXPECT_THAT(clip->info().warnings, IsEmpty());
  const CineCurve curve = CineLinearOfCode();
  for (const std::int64_t i : {2, 0, 1}) {
    auto expected = Samples(Pattern(12, 6, 10, i).View());
    for (std::uint32_t& sample : expected) sample = curve[sample];
    EXPECT_EQ(Samples(clip->Read(i)), expected);
    EXPECT_EQ(Samples(clip->Another()->Read(i)), expected);
  }
  ExpectWindowsAreCrops(*clip, 1);
}

TEST(CinePacked, OtherPackingIsRefusedInOneLine) {
  std::string bytes = Recording(3, 12).Bytes();
  cine_file::PutAt(bytes, 44 + 16, 1024, 4);  // 12 bits
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(folder.Write("a.cine", bytes)),
              HasSubstr("a.cine: not a recording that can be read"));
}

// --- times -------------------------------------------------------------------

TEST(CineTimes, RoundedStampsAreUniform) {
  CineFile file = Recording(40);
  file.stated_fps = 35087;  // a period of 28.5 us, in stamps of whole us
  for (int i = 0; i < 40; ++i) {
    file.stamps_s.push_back(std::floor(28.5 * i + 0.5) * 1e-6);
  }
  const TemporaryFolder folder;
  const auto clip = OpenClip(folder.Write("a.cine", file.Bytes()));
  const TimeBase& time = clip->info().time_base;
  EXPECT_TRUE(time.uniform);
  EXPECT_TRUE(time.trusted);
  EXPECT_EQ(time.source, FpsSource::kHeader);
  EXPECT_EQ(time.fps, 35087.0);
  EXPECT_THAT(clip->info().warnings, IsEmpty());
  EXPECT_DOUBLE_EQ(clip->Read(39).time_s, 39 / 35087.0);
}

// Two frames are lost before frame 5 and one before frame 9.
TEST(CineTimes, DroppedFramesAreSaidAndTimesAreRightAcrossThem) {
  CineFile file = Recording(20);
  const auto dropped = [](int i) { return i == 5 ? 2 : i == 9 ? 1 : 0; };
  file.stamps_s = Stamps(20, 1e-3, dropped);
  for (double& stamp : file.stamps_s)
    stamp += 0.6 * std::sin(stamp * 1e6) * 1e-6;
  const TemporaryFolder folder;
  const auto path = folder.Write("a.cine", file.Bytes());
  const auto clip = OpenClip(path);
  const TimeBase& time = clip->info().time_base;
  EXPECT_FALSE(time.uniform);
  EXPECT_TRUE(time.trusted);
  EXPECT_EQ(time.source, FpsSource::kHeader);
  EXPECT_EQ(time.fps, 1000.0);
  EXPECT_THAT(clip->info().warnings,
              ElementsAre(AllOf(HasSubstr("3 frames are missing"),
                                HasSubstr("2 after frame 4, 1 after frame 8"),
                                HasSubstr("their own times are used"))));
  int slot = 0;
  for (int i = 0; i < 20; ++i) {
    slot += dropped(i);
    EXPECT_DOUBLE_EQ(clip->Read(i).time_s, slot++ * 1e-3);
  }
  ExpectOrderDoesNotMatter(path);
  // The user's rate is of equally spaced frames, and that is said.
  const auto told = OpenClip(path, {.fps = 500.0});
  EXPECT_TRUE(told->info().time_base.uniform);
  EXPECT_DOUBLE_EQ(told->Read(19).time_s, 19 / 500.0);
  EXPECT_THAT(told->info().warnings,
              ElementsAre(HasSubstr("with --fps they are taken as equally")));
}

TEST(CineTimes, AChangedRateKeepsTheStamps) {
  CineFile file = Recording(20);
  for (int i = 0; i < 20; ++i) {
    file.stamps_s.push_back(i < 10 ? i * 1e-3 : 9e-3 + (i - 9) * 1.4e-3);
  }
  const TemporaryFolder folder;
  const auto clip = OpenClip(folder.Write("a.cine", file.Bytes()));
  EXPECT_FALSE(clip->info().time_base.uniform);
  EXPECT_NEAR(clip->info().time_base.fps, 19 / (9e-3 + 10 * 1.4e-3), 1e-3);
  EXPECT_THAT(clip->info().warnings[0], HasSubstr("not equally spaced"));
  for (int i = 0; i < 20; ++i) {
    EXPECT_NEAR(clip->Read(i).time_s,
                file.stamps_s[static_cast<std::size_t>(i)], 2e-9);
  }
}

TEST(CineTimes, StampsAreBelievedMoreThanTheHeadersRate) {
  CineFile file = Recording(20);
  file.stated_fps = 90000;
  file.stamps_s = Stamps(20, 1.0 / 9003.2, None);
  const TemporaryFolder folder;
  const auto clip = OpenClip(folder.Write("a.cine", file.Bytes()));
  EXPECT_TRUE(clip->info().time_base.uniform);
  EXPECT_NEAR(clip->info().time_base.fps, 9003.2, 0.01);
  EXPECT_THAT(clip->info().warnings,
              ElementsAre(HasSubstr("the header says 90000 fps, the camera's "
                                    "times of the frames 9003.2 fps")));
}

TEST(CineTimes, StampsThatCannotBeRightAreLeft) {
  const TemporaryFolder folder;
  const auto open = [&](double odd) {
    CineFile file = Recording(6);
    file.stamps_s = Stamps(6, 1e-3, None);
    file.stamps_s[4] = odd;
    return OpenClip(folder.Write("a.cine", file.Bytes()));
  };
  for (const double odd : {1e7, 2e-3, 0.0}) {
    const auto clip = open(odd);
    EXPECT_TRUE(clip->info().time_base.uniform);
    EXPECT_EQ(clip->info().time_base.fps, 1000.0);
    EXPECT_THAT(clip->info().warnings,
                ElementsAre(HasSubstr("cannot be right (frame 4 is")));
  }
}

TEST(CineTimes, AChangingExposureIsSaid) {
  CineFile file = Recording(6);
  file.stamps_s = Stamps(6, 1e-3, None);
  file.exposures_s.assign(6, 20e-6);
  const TemporaryFolder folder;
  EXPECT_THAT(OpenClip(folder.Write("a.cine", file.Bytes()))->info().warnings,
              IsEmpty());
  file.exposures_s[3] = 40e-6;
  EXPECT_THAT(OpenClip(folder.Write("b.cine", file.Bytes()))->info().warnings,
              ElementsAre(HasSubstr("changes between frames (20 to 40 us)")));
}

TEST(CineTimes, ACutFileKeepsTheTimesOfItsFrames) {
  CineFile file = Recording(20);
  file.stamps_s = Stamps(20, 1e-3, [](int i) { return i == 5 ? 1 : 0; });
  const std::string bytes = file.Bytes();
  const TemporaryFolder folder;
  const auto clip =
      OpenClip(folder.Write("a.cine", bytes.substr(0, bytes.size() - 4 * 80)));
  EXPECT_EQ(clip->info().frames, 16);
  EXPECT_FALSE(clip->info().time_base.uniform);
  EXPECT_DOUBLE_EQ(clip->Read(15).time_s, 16e-3);
}

// --- the header
// ----------------------------------------------------------------

TEST(CineHeader, WhatIsNoneIsOneLine) {
  const auto error = [](const std::string& bytes) -> std::string {
    try {
      ParseCineHeader(
          {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
          "a.cine");
    } catch (const core::InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(error(""), HasSubstr("a.cine: does not begin with CI"));
  EXPECT_THAT(error("CI too short"), HasSubstr("FirstImageNo is expected"));
  std::string far = Recording(2).Bytes();
  cine_file::PutAt(far, 24, 0xFFFFFFFF, 4);
  EXPECT_THAT(error(far),
              HasSubstr("biCompression is expected at byte 4294967311"));
  EXPECT_EQ(error(Recording(2).Bytes()), "");
}

TEST(CineHeader, MutatedHeadersNeverCrash) {
  CineFile file = Recording(6);
  file.stamps_s = Stamps(6, 1e-3, None);
  file.exposures_s.assign(6, 20e-6);
  const std::string whole = file.Bytes();
  const std::size_t blocks = whole.size() - 6 * (80 + 8) - 48 - 32;
  const TemporaryFolder folder;
  std::mt19937 random(31);
  for (int round = 0; round < 300; ++round) {
    std::string bytes = whole;
    for (int i = 0; i < 3; ++i) {
      const std::size_t at = i == 0 ? random() % 84 : blocks + random() % 80;
      bytes[at] = static_cast<char>(random());
    }
    ErrorOf(folder.Write("m.cine", bytes));
  }
}

// --- real recordings (facts: footage/README.md)
// --------------------------------

// The header says 90000 fps. The stamps say 9003.2, and so does what is
// independent of them: image -5417 was taken 0.60167 s before the trigger.
TEST(CineFootage, TheRateIsThatOfTheStamps) {
  const auto path = Shared("footage/cine_781.cine");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto clip = OpenClip(path);
  EXPECT_NEAR(clip->info().time_base.fps, 5417 / 0.60167, 0.2);
  EXPECT_TRUE(clip->info().time_base.uniform);
  EXPECT_THAT(clip->info().warnings, ElementsAre(HasSubstr("90000 fps")));
}

// The last stamp lies 292 days after the others.
TEST(CineFootage, AnImpossibleStampIsSaid) {
  const auto path = Shared("footage/data_small_cine.cine");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto clip = OpenClip(path);
  EXPECT_EQ(clip->info().time_base.fps, 100.0);
  EXPECT_TRUE(clip->info().time_base.uniform);
  EXPECT_EQ(clip->info().bit_depth, 12);
  EXPECT_THAT(clip->info().warnings,
              ElementsAre(HasSubstr("frame 234 is 2.52806e+07 s later")));
}

}  // namespace
}  // namespace touchdown::vision
