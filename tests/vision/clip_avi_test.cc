// touchdown/vision/footage/clip.h on uncompressed gray .avi, as the software of
// cameras writes it: samples are what they were, and up is up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using touchdown::testing::TemporaryFolder;

// An .avi by hand (Microsoft's "AVI RIFF File Reference", Windows' DIB).
struct Avi {
  std::int32_t width = 12;
  std::int32_t height = 6;  // negative: rows run downwards in a DIB
  std::uint16_t bits = 8;   // of a pixel
  std::string four_cc = std::string(4, '\0');
  std::string palette;          // four bytes a colour: B, G, R, 0
  std::int32_t row_bytes = 12;  // with padding
  std::vector<Image> frames;    // samples, or indices into the palette
  std::vector<bool> dropped;    // before frame i stands an empty chunk
  bool bottom_up = false;       // of what is written
  std::int32_t shift_left = 0;  // of the samples, in 16-bit words

  std::string Bytes() const;
};

void Put(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) {
    out += i < 8 ? static_cast<char>(value >> (8 * i) & 0xFF) : '\0';
  }
}

std::string Chunk(const std::string& name, const std::string& content) {
  std::string out = name;
  Put(out, content.size(), 4);
  out += content;
  if (content.size() % 2 != 0) out += '\0';
  return out;
}

std::string Avi::Bytes() const {
  const std::int32_t rows = std::abs(height);
  std::string movie = "movi";
  std::string index;
  std::uint32_t chunks = 0;
  const auto add = [&](const std::string& content) {
    index += "00db";
    Put(index, 16, 4);  // a key frame
    Put(index, movie.size(), 4);
    Put(index, content.size(), 4);
    movie += Chunk("00db", content);
    ++chunks;
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i < dropped.size() && dropped[i]) add("");
    const core::Frame frame = frames[i].View();
    std::string pixels;
    for (std::int32_t v = 0; v < rows; ++v) {
      const std::int32_t y = bottom_up ? rows - 1 - v : v;
      std::string row;
      for (std::int32_t x = 0; x < width; ++x) {
        Put(row, frame.at(x, y) << shift_left, bits / 8);
      }
      row.resize(static_cast<std::size_t>(row_bytes), '\0');
      pixels += row;
    }
    add(pixels);
  }
  const auto picture = static_cast<std::uint32_t>(row_bytes * rows);

  std::string main;
  Put(main, 2000, 4);  // us a frame
  Put(main, 0, 8);
  Put(main, 0x10, 4);  // it has an index
  Put(main, chunks, 4);
  Put(main, 0, 4);
  Put(main, 1, 4);
  Put(main, picture, 4);
  Put(main, static_cast<std::uint32_t>(width), 4);
  Put(main, static_cast<std::uint32_t>(rows), 4);
  Put(main, 0, 16);
  std::string stream = "vids" + four_cc;
  Put(stream, 0, 12);
  Put(stream, 1, 4);
  Put(stream, 500, 4);  // frames a second
  Put(stream, 0, 4);
  Put(stream, chunks, 4);
  Put(stream, picture, 4);
  Put(stream, 0, 16);
  std::string bitmap;
  Put(bitmap, 40, 4);
  Put(bitmap, static_cast<std::uint32_t>(width), 4);
  Put(bitmap, static_cast<std::uint32_t>(height), 4);
  Put(bitmap, 1, 2);
  Put(bitmap, bits, 2);
  bitmap += four_cc;
  Put(bitmap, picture, 4);
  Put(bitmap, 0, 8);
  Put(bitmap, palette.size() / 4, 4);
  Put(bitmap, 0, 4);
  bitmap += palette;
  const std::string list =
      "hdrl" + Chunk("avih", main) +
      Chunk("LIST", "strl" + Chunk("strh", stream) + Chunk("strf", bitmap));
  return Chunk("RIFF", "AVI " + Chunk("LIST", list) + Chunk("LIST", movie) +
                           Chunk("idx1", index));
}

std::string GrayPalette() {
  std::string palette;
  for (int i = 0; i < 256; ++i) {
    palette += std::string(3, static_cast<char>(i)) + '\0';
  }
  return palette;
}

struct Kind {
  const char* name;
  const char* four_cc = "";
  std::uint16_t bits = 8;
  bool palette = false;
  bool top_down = false;   // the height is negative
  bool bottom_up = false;  // the rows are
  std::int32_t width = 12;
  std::int32_t row_bytes = 12;
  std::int32_t bit_depth = 8;
  std::int32_t shift_left = 0;
};

Avi AviOf(const Kind& kind, int frames) {
  Avi avi;
  avi.width = kind.width;
  avi.height = kind.top_down ? -6 : 6;
  avi.bits = kind.bits;
  if (kind.four_cc[0] != '\0') avi.four_cc = kind.four_cc;
  if (kind.palette) avi.palette = GrayPalette();
  avi.row_bytes = kind.row_bytes;
  avi.bottom_up = kind.bottom_up;
  avi.shift_left = kind.shift_left;
  for (int i = 0; i < frames; ++i) {
    avi.frames.push_back(Pattern(kind.width, 6, kind.bit_depth, i));
  }
  return avi;
}

class AviGray : public ::testing::TestWithParam<Kind> {};

TEST_P(AviGray, SamplesAreThoseWritten) {
  const Kind& kind = GetParam();
  const TemporaryFolder folder;
  const auto path = folder.Write("a.avi", AviOf(kind, 5).Bytes());
  const auto clip = OpenClip(path);
  EXPECT_EQ(clip->info().frames, 5);
  EXPECT_EQ(clip->info().width_px, kind.width);
  EXPECT_EQ(clip->info().height_px, 6);
  EXPECT_EQ(clip->info().bit_depth, kind.bits);
  EXPECT_EQ(clip->info().time_base.fps, 500.0);
  if (kind.four_cc[0] == '\0' && !kind.palette) {
    EXPECT_THAT(clip->info().warnings, ElementsAre(HasSubstr("no palette")));
  } else {
    EXPECT_THAT(clip->info().warnings, IsEmpty());
  }
  for (const std::int64_t i : {4, 0, 2}) {
    auto expected = Samples(Pattern(kind.width, 6, kind.bit_depth, i).View());
    for (std::uint32_t& sample : expected) sample <<= kind.shift_left;
    EXPECT_EQ(Samples(clip->Read(i)), expected) << "frame " << i;
  }
  ExpectWindowsAreCrops(*clip, 3);
  ExpectOrderDoesNotMatter(path);
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, AviGray,
    ::testing::Values(
        Kind{"Y800", "Y800"}, Kind{"GREY", "GREY"}, Kind{"Y8", "Y8  "},
        Kind{"Y16", "Y16 ", 16, false, false, false, 12, 24, 16},
        Kind{"Y16of12", "Y16 ", 16, false, false, false, 12, 24, 12},
        Kind{"Y16of10Above", "Y16 ", 16, false, false, false, 12, 24, 10, 6},
        Kind{"PaletteBottomUp", "", 8, true, false, true},
        Kind{"PaletteTopDown", "", 8, true, true, false},
        Kind{"PaletteOddWidth", "", 8, true, false, true, 9, 12},
        Kind{"NoPaletteBottomUp", "", 8, false, false, true},
        Kind{"NoPaletteTopDown", "", 8, false, true, false}),
    [](const auto& one) { return std::string(one.param.name); });

// A palette that is no ramp: what counts is the brightness of its colours.
TEST(AviPalette, IndicesBecomeBrightness) {
  Avi avi = AviOf({"", "", 8, true, false, true}, 2);
  for (std::size_t i = 0; i < avi.palette.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) {
      avi.palette[i + c] = static_cast<char>(255 - static_cast<int>(i / 4));
    }
  }
  const TemporaryFolder folder;
  const auto clip = OpenClip(folder.Write("a.avi", avi.Bytes()));
  auto expected = Samples(Pattern(12, 6, 8, 1).View());
  for (std::uint32_t& sample : expected) sample = 255 - sample;
  EXPECT_EQ(Samples(clip->Read(1)), expected);
}

// An empty chunk stands for a frame that was not saved.
TEST(AviTimes, EmptyChunksAreMissingFrames) {
  Avi avi = AviOf({"", "Y800"}, 8);
  avi.dropped = {false, false, false, true};
  const TemporaryFolder folder;
  const auto clip = OpenClip(folder.Write("a.avi", avi.Bytes()));
  EXPECT_EQ(clip->info().frames, 8);
  EXPECT_FALSE(clip->info().time_base.uniform);
  EXPECT_EQ(clip->info().time_base.fps, 500.0);
  ASSERT_EQ(clip->info().warnings.size(), 1u);
  EXPECT_THAT(clip->info().warnings[0],
              HasSubstr("1 frame is missing, dropped when they were recorded "
                        "or saved (1 after frame 2)"));
  for (const std::int64_t i : {7, 3, 2, 0}) {
    EXPECT_DOUBLE_EQ(clip->Read(i).time_s,
                     static_cast<double>(i > 2 ? i + 1 : i) / 500.0);
    EXPECT_EQ(Samples(clip->Read(i)), Samples(Pattern(12, 6, 8, i).View()));
  }
}

}  // namespace
}  // namespace touchdown::vision
