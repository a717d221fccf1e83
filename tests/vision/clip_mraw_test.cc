// touchdown/vision/footage/clip.h on Photron recordings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using touchdown::testing::ReadAll;
using touchdown::testing::Shared;
using touchdown::testing::TemporaryFolder;

struct Header {
  std::int64_t frames = 2, width = 3, height = 2, bits = 8, depth = 12;
  std::string side = "Lower", rate = "2000", step = "1", start = "0";
  std::string type = "Mono", format = "MRaw";

  std::string Cih() const {
    return "#Camera Information Header\r\nDate : 2018/12/17\r\n"
           "Record Rate(fps) : " +
           rate + "\r\nTotal Frame : " + std::to_string(frames) +
           "\r\nStart Frame : " + start + "\r\nSave Step : " + step +
           "\r\nImage Width : " + std::to_string(width) +
           "\r\nImage Height : " + std::to_string(height) +
           "\r\nColor Type : " + type +
           "\r\nColor Bit : " + std::to_string(bits) +
           "\r\nFile Format : " + format +
           "\r\nEffectiveBit Depth : " + std::to_string(depth) +
           "\r\nEffectiveBit Side : " + side + "\r\n";
  }

  std::string Cihx() const {
    using std::to_string;
    return std::string("\x01\x00!!!\xFF CIHX\n", 12) +
           "<?xml version=\"1.0\"?>\n<cih>\n<!-- note -->\n"
           "<fileInfo><version>1.0</version><empty/></fileInfo>"
           "<imageFileInfo><fileFormat>" +
           format +
           "</fileFormat><resolution><width>999</width><height>999</height>"
           "</resolution></imageFileInfo>"
           "<imageDataInfo a=\"b\"><resolution><width>" +
           to_string(width) + "</width><height>" + to_string(height) +
           "</height></resolution><colorInfo><type>" + type + "</type><bit>" +
           to_string(bits) + "</bit></colorInfo><effectiveBit><depth>" +
           to_string(depth) + "</depth><side>" + side +
           "</side></effectiveBit><segmentPos><sensorXpos>320</sensorXpos>"
           "<sensorYpos>16</sensorYpos></segmentPos></imageDataInfo>"
           "<frameInfo><totalFrame>" +
           to_string(frames) + "</totalFrame><startFrame>" + start +
           "</startFrame><skipFrame>" + step +
           "</skipFrame></frameInfo><recordInfo><recordRate>" + rate +
           "</recordRate></recordInfo>\n</cih>\n" + std::string("\x00\x01<", 3);
  }
};

TEST(Mraw, Eightbits) {
  const TemporaryFolder folder;
  folder.Write("a.cih", Header{}.Cih());
  const auto path = folder.Write("a.mraw", "abcdefABCDEF");
  const auto clip = OpenClip(path);
  EXPECT_EQ(clip->info().format, "mraw");
  EXPECT_EQ(clip->info().frames, 2);
  EXPECT_EQ(clip->info().bit_depth, 8);
  EXPECT_EQ(clip->info().time_base.fps, 2000.0);
  EXPECT_EQ(clip->info().time_base.source, FpsSource::kHeader);
  EXPECT_TRUE(clip->info().time_base.trusted);
  EXPECT_TRUE(clip->info().warnings.empty());
  const core::Frame frame = clip->Read(1);
  EXPECT_THAT(Samples(frame), ElementsAre('A', 'B', 'C', 'D', 'E', 'F'));
  EXPECT_DOUBLE_EQ(frame.time_s, 1.0 / 2000.0);
}

unsigned Level12(unsigned sample) { return (0x123 + 0x0E1 * sample) & 0xFFF; }

// Bytes AB Cx yz hold ABC and xyz.
std::string Packed12(unsigned samples) {
  std::string bytes;
  for (unsigned i = 0; i < samples; i += 2) {
    bytes += static_cast<char>(Level12(i) >> 4);
    bytes += static_cast<char>((Level12(i) & 0xF) << 4 | Level12(i + 1) >> 8);
    bytes += static_cast<char>(Level12(i + 1) & 0xFF);
  }
  return bytes;
}

// Rows of all lengths, from any sample on, to the file's last byte.
TEST(Mraw, TwelveBitsOfLongRows) {
  const TemporaryFolder folder;
  Header header;
  header.width = 45;
  header.bits = 12;
  folder.Write("a.cihx", header.Cihx());
  const std::string bytes = Packed12(180);
  const auto clip = OpenClip(folder.Write("a.mraw", bytes));
  for (std::int64_t index = 0; index < 2; ++index) {
    for (std::int32_t x = 0; x < 45; ++x) {
      for (std::int32_t width = 1; width <= 45 - x; ++width) {
        const core::Frame frame = clip->Read(index, {x, 0, width, 2});
        for (std::int32_t v = 0; v < 2; ++v) {
          for (std::int32_t u = 0; u < width; ++u) {
            const auto sample =
                static_cast<unsigned>(index * 90 + v * 45 + x + u);
            ASSERT_EQ(frame.at(u, v), Level12(sample));
          }
        }
      }
    }
  }
}

// The packing runs on across rows and frames: 3x3 pictures begin and end in the
// middle of a byte.
TEST(Mraw, TwelveBitsArePackedAcrossRowsAndFrames) {
  const TemporaryFolder folder;
  Header header;
  header.height = 3;
  header.bits = 12;
  folder.Write("a.cihx", header.Cihx());
  const std::string bytes = Packed12(18);
  const auto clip = OpenClip(folder.Write("a.mraw", bytes));
  EXPECT_EQ(clip->info().bit_depth, 12);
  EXPECT_EQ(clip->info().sensor_origin, (SensorOrigin{320, 16}));
  for (std::int64_t index = 0; index < 2; ++index) {
    for (std::int32_t y = 0; y < 3; ++y) {
      for (std::int32_t x = 0; x < 3; ++x) {
        for (std::int32_t width = 1; width <= 3 - x; ++width) {
          const core::Frame frame = clip->Read(index, {x, y, width, 3 - y});
          for (std::int32_t v = 0; v < 3 - y; ++v) {
            for (std::int32_t u = 0; u < width; ++u) {
              const auto sample =
                  static_cast<unsigned>(index * 9 + (y + v) * 3 + x + u);
              ASSERT_EQ(frame.at(u, v), (0x123 + 0x0E1 * sample) & 0xFFF);
            }
          }
        }
      }
    }
  }
}

TEST(Mraw, SixteenBitsByTheSideOfTheirSignal) {
  const TemporaryFolder folder;
  Header header;
  header.frames = 1;
  header.width = 2;
  header.height = 1;
  header.bits = 16;
  folder.Write("lower.cih", header.Cih());
  const auto lower =
      OpenClip(folder.Write("lower.mraw", std::string("\xFF\x0F\x01\x00", 4)));
  EXPECT_EQ(lower->info().bit_depth, 12);
  EXPECT_THAT(Samples(lower->Read(0)), ElementsAre(0xFFF, 0x001));

  // A header that cannot be right is not believed.
  folder.Write("wrong.cih", header.Cih());
  const auto wrong =
      OpenClip(folder.Write("wrong.mraw", std::string("\xFF\x1F\x01\x00", 4)));
  EXPECT_EQ(wrong->info().bit_depth, 16);
  EXPECT_THAT(wrong->info().warnings,
              ElementsAre(HasSubstr("all 16 are read")));
  EXPECT_THAT(Samples(wrong->Read(0)), ElementsAre(0x1FFF, 0x001));

  header.side = "Higher";
  folder.Write("higher.cih", header.Cih());
  const auto higher =
      OpenClip(folder.Write("higher.mraw", std::string("\xF0\xFF\x10\x00", 4)));
  EXPECT_EQ(higher->info().bit_depth, 12);
  EXPECT_THAT(Samples(higher->Read(0)), ElementsAre(0xFFF, 0x001));
}

// Rows of 11 samples: packed ones begin within a byte in every second row.
TEST(Mraw, WhatIsReadOnceIsTheSame) {
  const TemporaryFolder folder;
  Header header;
  header.frames = 3;
  header.width = 11;
  header.height = 7;
  const auto samples =
      static_cast<std::size_t>(header.frames * header.width * header.height);
  std::string bytes;
  for (std::size_t i = 0; i < 2 * samples; ++i) {
    bytes += static_cast<char>(i % 2 == 0 ? 7 * i + i / 3 : i % 16);
  }
  for (const std::int64_t bits : {8, 12, 16}) {
    header.bits = bits;
    for (const char* side : {"Lower", "Higher"}) {
      header.side = side;
      folder.Write("a.cih", header.Cih());
      const auto path = folder.Write(
          "a.mraw", bytes.substr(0, (samples * header.bits + 7) / 8));
      const auto clip = OpenClip(path);
      const auto once = OpenClip(path);
      // The whole frame, rows of it, one row; read within them and elsewhere.
      const core::PixelRect windows[] = {
          {0, 0, 11, 7}, {2, 1, 8, 4}, {0, 3, 11, 1}, {5, 6, 6, 1}};
      for (std::int64_t frame = 0; frame < header.frames; ++frame) {
        for (const core::PixelRect& ahead : windows) {
          once->WillReadOnce(frame, ahead);
          for (const core::PixelRect& window : windows) {
            EXPECT_EQ(Samples(once->Read(frame, window)),
                      Samples(clip->Read(frame, window)))
                << bits << " bits, " << side << ", frame " << frame;
          }
        }
      }
    }
  }
}

TEST(Mraw, SaveStepAndStartFrame) {
  const TemporaryFolder folder;
  Header header;
  header.step = "100";
  header.start = "-52";
  folder.Write("a.cih", header.Cih());
  const auto path = folder.Write("a.mraw", "abcdefABCDEF");
  const auto clip = OpenClip(path);
  EXPECT_EQ(clip->info().first_camera_frame, -52);
  EXPECT_EQ(clip->info().time_base.fps, 20.0);
  EXPECT_THAT(clip->info().warnings, ElementsAre(HasSubstr("100th")));
  // The user knows better than the header.
  const auto with_fps = OpenClip(path, {.fps = 123.0});
  EXPECT_EQ(with_fps->info().time_base.fps, 123.0);
  EXPECT_EQ(with_fps->info().time_base.source, FpsSource::kUser);
}

TEST(Mraw, SaveStepZeroIsTakenAsOneAndSaidSo) {
  const TemporaryFolder folder;
  Header header;
  header.step = "0";
  folder.Write("a.cihx", header.Cihx());
  const auto clip = OpenClip(folder.Write("a.mraw", "abcdefABCDEF"));
  EXPECT_EQ(clip->info().time_base.fps, 2000.0);
  EXPECT_THAT(clip->info().warnings, ElementsAre(HasSubstr("step of 0")));
}

TEST(Mraw, OpensByEitherFile) {
  const TemporaryFolder folder;
  const auto data = folder.Write("a.b.mraw", "abcdefABCDEF");
  const auto header = folder.Write("a.b.cihx", Header{}.Cihx());
  EXPECT_EQ(Samples(OpenClip(data)->Read(1)),
            Samples(OpenClip(header)->Read(1)));
}

TEST(Mraw, AFileCutShortKeepsItsWholeFrames) {
  const TemporaryFolder folder;
  Header header;
  header.frames = 5;
  folder.Write("a.cih", header.Cih());
  const auto clip = OpenClip(folder.Write("a.mraw", "abcdefABCDEFxyz"));
  EXPECT_EQ(clip->info().frames, 2);
  EXPECT_THAT(clip->info().warnings,
              ElementsAre(HasSubstr("2 of the 5 frames")));
  EXPECT_THROW(clip->Read(2), std::invalid_argument);
}

TEST(Mraw, SizesThatDoNotFitAreRefused) {
  const TemporaryFolder folder;
  folder.Write("a.cih", Header{}.Cih());
  EXPECT_THAT(ErrorOf(folder.Write("a.mraw", "abcdefABCDEFx")),
              HasSubstr("has 13 bytes, but a.cih describes 2 frames of 3x2 at "
                        "8 bits, which are 12 bytes"));
  EXPECT_THAT(ErrorOf(folder.Write("a.mraw", "abcde")),
              HasSubstr("less than one frame"));
  EXPECT_THAT(ErrorOf(folder.Write("a.mraw", "")),
              HasSubstr("0 bytes, less than one frame"));
  EXPECT_THAT(ErrorOf(folder.Write("b.mraw", "abcdefABCDEF")),
              HasSubstr("no .cihx or .cih of the same name beside it"));
  EXPECT_THAT(ErrorOf(folder.Write("c.cih", Header{}.Cih())),
              HasSubstr("no .mraw of the same name beside it"));
}

TEST(Mraw, ImpossibleHeadersAreRefusedByName) {
  const TemporaryFolder folder;
  const auto data = folder.Write("a.mraw", "abcdefABCDEF");
  const auto error_with = [&](auto change) {
    Header header;
    change(header);
    folder.Write("a.cih", header.Cih());
    const std::string of_cih = ErrorOf(data);
    folder.Write("a.cihx", header.Cihx());
    EXPECT_NE(ErrorOf(data), "");
    std::filesystem::remove(folder / "a.cihx");
    return of_cih;
  };
  EXPECT_THAT(error_with([](Header& h) { h.width = 0; }),
              HasSubstr("a.cih: 'Image Width' is '0', expected a whole number "
                        "in 1 .. 65536"));
  EXPECT_THAT(error_with([](Header& h) { h.height = 1ll << 40; }),
              HasSubstr("'Image Height'"));
  EXPECT_THAT(error_with([](Header& h) { h.frames = -1; }),
              HasSubstr("'Total Frame' is '-1'"));
  EXPECT_THAT(error_with([](Header& h) { h.bits = 24; }),
              HasSubstr("'Color Bit' is '24', expected 8, 12 or 16"));
  EXPECT_THAT(error_with([](Header& h) { h.rate = "fast"; }),
              HasSubstr("'Record Rate(fps)' is 'fast', expected a positive"));
  EXPECT_THAT(error_with([](Header& h) { h.rate = "nan"; }),
              HasSubstr("'Record Rate(fps)'"));
  EXPECT_THAT(error_with([](Header& h) { h.step = "-1"; }),
              HasSubstr("'Save Step' is '-1'"));
  EXPECT_THAT(error_with([](Header& h) { h.type = "Color"; }),
              HasSubstr("colour is not read"));
  EXPECT_THAT(error_with([](Header& h) { h.format = "Tif"; }),
              HasSubstr("'File Format' is 'Tif', expected MRaw"));
  EXPECT_THAT(error_with([](Header& h) { h.side = "Left"; }),
              HasSubstr("'EffectiveBit Side' is 'Left'"));
  folder.Write("a.cih", "Total Frame : 2\n");
  EXPECT_THAT(ErrorOf(data), HasSubstr("'Image Width' is missing"));
  folder.Write("a.cihx", "garbage");
  EXPECT_THAT(ErrorOf(data), HasSubstr("no <cih> ... </cih> in it"));
}

// Sizes near the largest: no product overflows, nothing is allocated.
TEST(Mraw, HugeClaimsAreRefusedBySize) {
  const TemporaryFolder folder;
  Header header;
  header.width = header.height = 1 << 16;
  header.bits = 16;
  header.frames = 1ll << 40;
  folder.Write("a.cih", header.Cih());
  EXPECT_THAT(ErrorOf(folder.Write("a.mraw", "abcdefABCDEF")),
              HasSubstr("less than one frame"));
}

// Seeded mutations of valid headers: an error of the right lane or a clip that
// can be read to its end, never a crash.
TEST(Mraw, MutatedHeadersNeverCrash) {
  const TemporaryFolder folder;
  std::mt19937 random(20240601);
  const auto draw = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  Header header;
  header.bits = 12;
  header.frames = 4;
  const std::string cih = header.Cih();
  const std::string cihx = header.Cihx();
  const auto data = folder.Write("a.mraw", std::string(36, '\x5A'));
  int refused = 0;
  for (int round = 0; round < 600; ++round) {
    const bool xml = round % 2 == 0;
    std::string text = xml ? cihx : cih;
    for (std::size_t n = draw(4) + 1; n > 0; --n) {
      switch (draw(4)) {
        case 0:
          text[draw(text.size())] = static_cast<char>(draw(256));
          break;
        case 1:
          text.erase(draw(text.size()), draw(20));
          break;
        case 2:
          text.insert(draw(text.size()), text.substr(draw(text.size()), 30));
          break;
        default:
          text.insert(draw(text.size()), "9999999999");
      }
    }
    std::filesystem::remove(folder / "a.cih");
    std::filesystem::remove(folder / "a.cihx");
    folder.Write(xml ? "a.cihx" : "a.cih", text);
    refused += ErrorOf(data).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 600);
}

// --- real recordings (facts: footage/README.md) ------------------------------

TEST(MrawFootage, TwelveBitBall) {
  const auto path = Shared("footage/ball_12bit.mraw");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto clip = OpenClip(path);
  const ClipInfo& info = clip->info();
  EXPECT_EQ(info.width_px, 384);
  EXPECT_EQ(info.height_px, 384);
  EXPECT_EQ(info.bit_depth, 12);
  EXPECT_EQ(info.frames, 15);
  EXPECT_EQ(info.first_camera_frame, 52);
  EXPECT_EQ(info.time_base.fps, 30000.0);
  EXPECT_EQ(info.time_base.source, FpsSource::kHeader);
  EXPECT_TRUE(info.time_base.trusted);
  EXPECT_EQ(info.sensor_origin, (SensorOrigin{320, 320}));
  EXPECT_TRUE(info.warnings.empty());
  // Backlit: the background is saturated, and in row 109 of frame 0 the sphere,
  // centre x 175.1 and radius 63.2, is dark between 112 and 238.
  const core::Frame frame = clip->Read(0);
  EXPECT_EQ(frame.at(20, 110), frame.full_scale());
  const std::uint32_t half = frame.full_scale() / 2;
  std::int32_t left = 0;
  while (frame.at(left, 109) > half) ++left;
  std::int32_t right = 383;
  while (frame.at(right, 109) > half) --right;
  EXPECT_NEAR(0.5 * (left + right), 175.13, 0.6);
  EXPECT_NEAR(0.5 * (right - left + 1), 63.2, 0.6);
  ExpectWindowsAreCrops(*clip, 14);
}

TEST(MrawFootage, SaveStepOfABeam) {
  const auto path = Shared("footage/data_showcase.cih");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto clip = OpenClip(path);
  const ClipInfo& info = clip->info();
  EXPECT_EQ(info.width_px, 640);
  EXPECT_EQ(info.height_px, 40);
  EXPECT_EQ(info.bit_depth, 8);
  EXPECT_EQ(info.frames, 75);
  EXPECT_EQ(info.time_base.fps, 150.0);
  EXPECT_EQ(info.sensor_origin, std::nullopt);
  EXPECT_THAT(info.warnings, ElementsAre(HasSubstr("150 fps")));
  EXPECT_DOUBLE_EQ(clip->Read(74).time_s, 74.0 / 150.0);
  ExpectWindowsAreCrops(*clip, 74);
}

}  // namespace
}  // namespace touchdown::vision
