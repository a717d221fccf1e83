// touchdown/vision/footage/clip.h on TIFFs of several pages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <cstring>
#include <functional>
#include <random>

#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using touchdown::testing::ReadAll;
using touchdown::testing::TemporaryFolder;

const ClipOptions kFps{.fps = 100.0};

struct Layout {
  const char* name;
  const char* mode = "w";  // of TIFFOpen: b big-endian, 8 BigTIFF
  int bit_depth = 8;
  int compression = COMPRESSION_NONE;
  std::uint32_t rows_per_strip = 1000;
  bool tiled = false;
};

void WritePage(TIFF* tiff, const core::Frame& frame, const Layout& layout) {
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, frame.width_px);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, frame.height_px);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, frame.is_16_bit() ? 16 : 8);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, layout.compression);
  if (frame.is_16_bit()) {
    TIFFSetField(tiff, TIFFTAG_MAXSAMPLEVALUE, frame.full_scale());
  }
  if (layout.tiled) {
    constexpr std::int32_t kTile = 16;
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kTile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, kTile);
    std::vector<std::uint16_t> tile(kTile * kTile);
    for (std::int32_t y = 0; y < frame.height_px; y += kTile) {
      for (std::int32_t x = 0; x < frame.width_px; x += kTile) {
        for (std::int32_t v = 0; v < std::min(kTile, frame.height_px - y);
             ++v) {
          for (std::int32_t u = 0; u < std::min(kTile, frame.width_px - x);
               ++u) {
            const std::uint32_t sample = frame.at(x + u, y + v);
            const auto at = static_cast<std::size_t>(v * kTile + u);
            if (frame.is_16_bit()) {
              tile[at] = static_cast<std::uint16_t>(sample);
            } else {
              reinterpret_cast<std::uint8_t*>(tile.data())[at] =
                  static_cast<std::uint8_t>(sample);
            }
          }
        }
        TIFFWriteTile(tiff, tile.data(), static_cast<std::uint32_t>(x),
                      static_cast<std::uint32_t>(y), 0, 0);
      }
    }
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, layout.rows_per_strip);
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      void* const row = const_cast<std::byte*>(frame.row<std::byte>(y));
      TIFFWriteScanline(tiff, row, static_cast<std::uint32_t>(y), 0);
    }
  }
  ASSERT_EQ(TIFFWriteDirectory(tiff), 1);
}

void WriteStack(
    const std::filesystem::path& path, std::int64_t frames,
    const Layout& layout,
    const std::function<Image(std::int64_t)>& make = nullptr,
    const std::function<void(TIFF*, std::int64_t)>& tags = nullptr) {
  TIFF* const tiff = TIFFOpen(path.c_str(), layout.mode);
  ASSERT_NE(tiff, nullptr);
  for (std::int64_t i = 0; i < frames; ++i) {
    const Image image = make ? make(i) : Pattern(37, 23, layout.bit_depth, i);
    if (tags) tags(tiff, i);
    WritePage(tiff, image.View(), layout);
  }
  TIFFClose(tiff);
}

class TiffStackOf : public ::testing::TestWithParam<Layout> {};

TEST_P(TiffStackOf, APageIsAFrame) {
  const TemporaryFolder folder;
  const auto path = folder / "a.tif";
  const Layout& layout = GetParam();
  WriteStack(path, 7, layout);
  EXPECT_TRUE(IsTiffStack(path));
  const auto clip = OpenClip(path, kFps);
  EXPECT_EQ(clip->info().format, "tiff-stack");
  EXPECT_EQ(clip->info().width_px, 37);
  EXPECT_EQ(clip->info().height_px, 23);
  EXPECT_EQ(clip->info().bit_depth, layout.bit_depth);
  EXPECT_EQ(clip->info().frames, 7);
  EXPECT_EQ(clip->info().time_base.source, FpsSource::kUser);
  EXPECT_TRUE(clip->info().time_base.trusted);
  EXPECT_THAT(clip->info().warnings, IsEmpty());
  const auto other = clip->Another();
  for (const std::int64_t i : {0, 6, 3, 4, 0, 5}) {
    const core::Frame frame = clip->Read(i);
    EXPECT_EQ(frame.index, i);
    EXPECT_DOUBLE_EQ(frame.time_s, static_cast<double>(i) / 100.0);
    EXPECT_EQ(Samples(frame),
              Samples(Pattern(37, 23, layout.bit_depth, i).View()));
    EXPECT_EQ(Samples(other->Read(6 - i)),
              Samples(Pattern(37, 23, layout.bit_depth, 6 - i).View()));
  }
  ExpectWindowsAreCrops(*clip, 2);
  ExpectOrderDoesNotMatter(path, kFps);
}
INSTANTIATE_TEST_SUITE_P(
    Layouts, TiffStackOf,
    ::testing::Values(
        Layout{"Bytes"}, Layout{"Strips", "w", 8, COMPRESSION_NONE, 5},
        Layout{"BigEndianBytes", "wb"}, Layout{"Words", "w", 16},
        Layout{"Twelve", "w", 12}, Layout{"BigEndianTwelve", "wb", 12},
        Layout{"BigTiff", "w8", 16}, Layout{"BigEndianBigTiff", "wb8", 10},
        Layout{"Deflate", "w", 12, COMPRESSION_ADOBE_DEFLATE, 4},
        Layout{"Lzw", "w8", 8, COMPRESSION_LZW, 4},
        Layout{"PackBits", "wb", 16, COMPRESSION_PACKBITS},
        Layout{"Tiles", "w", 8, COMPRESSION_NONE, 1, true},
        Layout{"BigEndianTiles", "wb", 14, COMPRESSION_LZW, 1, true}),
    [](const auto& one) { return std::string(one.param.name); });

// Samples that lie in the file as a Frame has them are not copied.
TEST(TiffStack, PlainPagesAreViewsOfTheFile) {
  const TemporaryFolder folder;
  WriteStack(folder / "plain.tif", 3, {"", "w", 12});
  WriteStack(folder / "big.tif", 3, {"", "wb", 12});
  WriteStack(folder / "packed.tif", 3, {"", "w", 12, COMPRESSION_LZW});
  const auto plain = OpenClip(folder / "plain.tif", kFps);
  EXPECT_TRUE(plain->views_last());
  EXPECT_TRUE(plain->windows_are_cheap());
  const core::Frame first = plain->Read(0);
  plain->WillRead(2, {0, 0, 37, 23});
  plain->Read(2);
  EXPECT_EQ(Samples(first), Samples(Pattern(37, 23, 12, 0).View()));
  const auto big = OpenClip(folder / "big.tif", kFps);
  EXPECT_FALSE(big->views_last());
  EXPECT_TRUE(big->windows_are_cheap());
  EXPECT_FALSE(OpenClip(folder / "packed.tif", kFps)->windows_are_cheap());
}

TEST(TiffStack, NeedsAFrameRateAndMoreThanOnePage) {
  const TemporaryFolder folder;
  WriteStack(folder / "a.tif", 2, {""});
  EXPECT_THAT(ErrorOf(folder / "a.tif"), HasSubstr("--fps"));
  WriteStack(folder / "one.tif", 1, {""});
  EXPECT_FALSE(IsTiffStack(folder / "one.tif"));
  EXPECT_THAT(ErrorOf(folder / "one.tif", kFps), HasSubstr("give the folder"));
  EXPECT_THROW(OpenClip(folder / "a.tif",
                        {.channel = Channel::kBlueDifference, .fps = 1.0}),
               std::invalid_argument);
}

TEST(TiffStack, APageUnlikeTheFirstIsNamed) {
  const TemporaryFolder folder;
  const auto error = [&](const Image& odd) {
    WriteStack(folder / "a.tif", 5, {"", "w", 12}, [&](std::int64_t i) {
      return i == 3 ? odd : Pattern(8, 6, 12, i);
    });
    return ErrorOf(folder / "a.tif", kFps);
  };
  EXPECT_THAT(error(Pattern(8, 7, 12, 3)),
              HasSubstr("page 4 (frame 3) is 8x7 at 12 bits, expected 8x6 at "
                        "12 bits like the first page"));
  EXPECT_THAT(error(Pattern(8, 6, 8, 3)), HasSubstr("at 8 bits, expected"));
  EXPECT_THAT(error(Pattern(8, 6, 16, 3)), HasSubstr("at 16 bits, expected"));
}

TEST(TiffStack, ThumbnailsAreLeftOutAndSaid) {
  const TemporaryFolder folder;
  WriteStack(
      folder / "a.tif", 5, {""},
      [](std::int64_t i) {
        return i == 1 ? Pattern(4, 3, 8, i) : Pattern(16, 12, 8, i);
      },
      [](TIFF* tiff, std::int64_t i) {
        TIFFSetField(tiff, TIFFTAG_SUBFILETYPE,
                     i == 1 ? FILETYPE_REDUCEDIMAGE : 0);
      });
  const auto clip = OpenClip(folder / "a.tif", kFps);
  EXPECT_EQ(clip->info().frames, 4);
  EXPECT_THAT(clip->info().warnings, ElementsAre(HasSubstr("1 pages")));
  EXPECT_EQ(Samples(clip->Read(1)), Samples(Pattern(16, 12, 8, 2).View()));
}

// ImageJ writes stacks of more than 4 GB with one directory only.
TEST(TiffStack, ImageJWithoutDirectories) {
  const TemporaryFolder folder;
  WriteStack(folder / "a.tif", 1, {"", "wb", 16}, nullptr,
             [](TIFF* tiff, std::int64_t) {
               TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION,
                            "ImageJ=1.53t\nimages=4\nslices=4\nloop=false\n");
             });
  // The samples of page 0 are moved to the end, for the others to follow.
  std::string bytes = ReadAll(folder / "a.tif");
  const auto samples_of = [](std::int64_t i) {
    std::string samples;
    for (const std::uint32_t v : Samples(Pattern(37, 23, 16, i).View())) {
      samples += static_cast<char>(v >> 8);
      samples += static_cast<char>(v & 0xFF);
    }
    return samples;
  };
  const std::size_t at = bytes.find(samples_of(0));
  ASSERT_NE(at, std::string::npos);
  const auto big_endian = [](std::size_t value) {
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) {
      text += static_cast<char>(value >> shift & 0xFF);
    }
    return text;
  };
  const std::string field("\x01\x11\x00\x04\x00\x00\x00\x01", 8);  // offsets
  const std::size_t offset = bytes.find(field + big_endian(at));
  ASSERT_NE(offset, std::string::npos);
  bytes.replace(offset + field.size(), 4, big_endian(bytes.size()));
  for (int i = 0; i < 4; ++i) bytes += samples_of(i);
  {
    const auto clip = OpenClip(folder.Write("b.tif", bytes), kFps);
    EXPECT_EQ(clip->info().frames, 4);
    EXPECT_THAT(clip->info().warnings, IsEmpty());
    for (const std::int64_t i : {3, 0, 1, 2}) {
      EXPECT_EQ(Samples(clip->Read(i)), Samples(Pattern(37, 23, 16, i).View()));
    }
  }
  bytes.resize(bytes.size() - 10);
  const auto cut = OpenClip(folder.Write("c.tif", bytes), kFps);
  EXPECT_EQ(cut->info().frames, 3);
  EXPECT_THAT(cut->info().warnings,
              ElementsAre(HasSubstr("tells of 4 pictures")));
}

TEST(TiffStack, AFolderOfPicturesRefusesAStack) {
  const TemporaryFolder folder;
  WriteTiff(folder / "a1.tif", Pattern(37, 23, 8, 0).View());
  WriteStack(folder / "a2.tif", 3, {""});
  EXPECT_THAT(ErrorOf(folder.path(), kFps),
              HasSubstr("a2.tif (frame 1): a TIFF of several pages, expected a "
                        "picture a file"));
  std::filesystem::remove(folder / "a1.tif");
  EXPECT_THAT(ErrorOf(folder.path(), kFps), HasSubstr("a2.tif (frame 0)"));
}

// Cut anywhere: one line, or the first frames of the whole with a warning.
TEST(TiffStack, ACutStackKeepsItsWholePages) {
  const TemporaryFolder folder;
  for (const Layout& layout :
       {Layout{"", "w", 8}, Layout{"", "w8", 12, COMPRESSION_LZW, 4}}) {
    WriteStack(folder / "a.tif", 12, layout);
    const std::string whole = ReadAll(folder / "a.tif");
    std::int64_t most = 0;
    for (std::size_t part = 1; part < 50; ++part) {
      const auto cut =
          folder.Write("cut.tif", whole.substr(0, whole.size() * part / 50));
      try {
        const auto clip = OpenClip(cut, kFps);
        const std::int64_t n = clip->info().frames;
        EXPECT_GE(n, most);
        most = n;
        EXPECT_LT(n, 12);
        EXPECT_THAT(clip->info().warnings,
                    ElementsAre(HasSubstr("ends early")));
        for (std::int64_t i = 0; i < n; ++i) {
          ASSERT_EQ(Samples(clip->Read(i)),
                    Samples(Pattern(37, 23, layout.bit_depth, i).View()));
        }
      } catch (const core::InputError& error) {
        EXPECT_EQ(most, 0) << error.what();
      }
    }
    EXPECT_GE(most, 10);
  }
}

// A directory that points at an earlier one ends the list.
TEST(TiffStack, ACircleOfDirectoriesEnds) {
  const TemporaryFolder folder;
  WriteStack(folder / "a.tif", 3, {""});
  std::string bytes = ReadAll(folder / "a.tif");
  std::uint32_t first = 0;
  std::memcpy(&first, bytes.data() + 4, 4);
  std::uint32_t at = first;
  for (int i = 0; i < 2; ++i) {
    std::uint16_t entries = 0;
    std::memcpy(&entries, bytes.data() + at, 2);
    std::memcpy(&at, bytes.data() + at + 2 + 12 * entries, 4);
  }
  std::uint16_t entries = 0;
  std::memcpy(&entries, bytes.data() + at, 2);
  std::memcpy(bytes.data() + at + 2 + 12 * entries, &first, 4);
  const auto clip = OpenClip(folder.Write("b.tif", bytes), kFps);
  EXPECT_EQ(clip->info().frames, 3);
  EXPECT_THAT(clip->info().warnings, ElementsAre(HasSubstr("earlier one")));
}

// Seeded mutations: a clip or an error of the right lane, never a crash.
TEST(TiffStack, MutatedStacksNeverCrash) {
  const TemporaryFolder folder;
  std::mt19937 random(23);
  int refused = 0;
  for (const Layout& layout : {Layout{"", "w", 8}, Layout{"", "wb8", 12},
                               Layout{"", "w", 12, COMPRESSION_LZW, 4},
                               Layout{"", "w", 8, COMPRESSION_NONE, 1, true}}) {
    WriteStack(folder / "a.tif", 3, layout, [&](std::int64_t i) {
      return Pattern(9, 7, layout.bit_depth, i);
    });
    const std::string whole = ReadAll(folder / "a.tif");
    for (int round = 0; round < 150; ++round) {
      std::string bytes = whole;
      for (int i = 0; i < 4; ++i) {
        bytes[random() % bytes.size()] = static_cast<char>(random());
      }
      refused += ErrorOf(folder.Write("m.tif", bytes), kFps).empty() ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace touchdown::vision
