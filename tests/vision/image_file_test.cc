#include "touchdown/vision/footage/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <stdexcept>

#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"

namespace touchdown::vision {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using touchdown::testing::ReadAll;
using touchdown::testing::TemporaryFolder;

std::string ErrorOfImage(const std::filesystem::path& path) {
  try {
    ReadImage(path);
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_THAT(text, HasSubstr(path.filename().string()));
    return text;
  }
  return "";
}

void ExpectSame(const Image& actual, const Image& expected) {
  EXPECT_EQ(actual.width_px, expected.width_px);
  EXPECT_EQ(actual.height_px, expected.height_px);
  EXPECT_EQ(actual.bit_depth, expected.bit_depth);
  EXPECT_EQ(actual.pixels, expected.pixels);
}

class ImageFileDepth : public ::testing::TestWithParam<int> {};

TEST_P(ImageFileDepth, PngAndTiffAreLossless) {
  const TemporaryFolder folder;
  const Image image = Pattern(37, 23, GetParam(), 3);
  WritePng(folder / "a.png", image.View());
  ExpectSame(ReadImage(folder / "a.png"), image);
  WriteTiff(folder / "a.tif", image.View());
  ExpectSame(ReadImage(folder / "a.tif"), image);
}
INSTANTIATE_TEST_SUITE_P(Depths, ImageFileDepth,
                         ::testing::Values(8, 9, 10, 12, 14, 15, 16));

TEST(ImageFile, AViewWithAStrideIsWrittenAsItIsSeen) {
  const TemporaryFolder folder;
  const Image image = Pattern(20, 10, 8, 0);
  core::Frame crop = image.View();
  crop.data += 3 * crop.stride_bytes + 5;
  crop.width_px = 7;
  crop.height_px = 4;
  WritePng(folder / "a.png", crop);
  EXPECT_EQ(Samples(ReadImage(folder / "a.png").View()), Samples(crop));
  WriteTiff(folder / "a.tif", crop);
  EXPECT_EQ(Samples(ReadImage(folder / "a.tif").View()), Samples(crop));
}

// A smooth picture survives quality 95 within 4 levels (quantiser steps of the
// low frequencies are 2; the sum over a block stays below twice that).
TEST(ImageFile, JpegIsCloseOnASmoothPicture) {
  const TemporaryFolder folder;
  Image image = Pattern(40, 32, 8, 0);
  for (std::int32_t y = 0; y < 32; ++y) {
    for (std::int32_t x = 0; x < 40; ++x) {
      image.pixels[static_cast<std::size_t>(y * 40 + x)] =
          static_cast<std::byte>(60 + 2 * x + y);
    }
  }
  WriteJpeg(folder / "a.jpg", image.View());
  const Image back = ReadImage(folder / "a.jpg");
  ASSERT_EQ(back.pixels.size(), image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    EXPECT_NEAR(static_cast<int>(back.pixels[i]),
                static_cast<int>(image.pixels[i]), 4);
  }
  EXPECT_THROW(WriteJpeg(folder / "b.jpg", Pattern(8, 8, 12, 0).View()),
               std::invalid_argument);
  EXPECT_THROW(WriteJpeg(folder / "b.jpg", image.View(), 0),
               std::invalid_argument);
}

// Rec. BT.601 weights: 0.299, 0.587, 0.114; gray stays gray exactly.
TEST(ImageFile, ColourBecomesLuma) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> rgb = {
      255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 77, 77, 77, 10, 20, 30};
  WritePngRgb(folder / "a.png", 3, 2, rgb);
  EXPECT_THAT(Samples(ReadImage(folder / "a.png").View()),
              ElementsAre(std::lround(0.299 * 255), std::lround(0.587 * 255),
                          std::lround(0.114 * 255), 255, 77,
                          std::lround(0.299 * 10 + 0.587 * 20 + 0.114 * 30)));
  EXPECT_THROW(WritePngRgb(folder / "b.png", 3, 3, rgb), std::invalid_argument);
}

// What other software writes: 16-bit RGBA, white-is-zero, big-endian.
TEST(ImageFile, TiffOfOtherKinds) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name, const char* mode, int bits,
                         int samples, int meaning, const void* row,
                         bool tiled = false) {
    TIFF* const tiff = TIFFOpen((folder / name).c_str(), mode);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 2);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, samples);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, meaning);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    if (tiled) {
      TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
      TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
      std::vector<char> tile(256);
      tile[0] = 7;
      tile[1] = 8;
      TIFFWriteTile(tiff, tile.data(), 0, 0, 0, 0);
    } else {
      TIFFWriteScanline(tiff, const_cast<void*>(row), 0, 0);
    }
    TIFFClose(tiff);
    return folder / name;
  };
  const std::uint16_t rgba[] = {65535, 0, 0, 9, 1000, 2000, 3000, 9};
  const Image colour =
      ReadImage(write("c.tif", "wb", 16, 4, PHOTOMETRIC_RGB, rgba));
  EXPECT_EQ(colour.bit_depth, 16);
  EXPECT_THAT(Samples(colour.View()),
              ElementsAre(std::lround(0.299 * 65535),
                          std::lround(299.0 + 2 * 587.0 + 3 * 114.0)));
  const std::uint8_t white[] = {0, 200};
  EXPECT_THAT(Samples(ReadImage(write("w.tif", "w", 8, 1,
                                      PHOTOMETRIC_MINISWHITE, white))
                          .View()),
              ElementsAre(255, 55));
  EXPECT_THAT(Samples(ReadImage(write("t.tif", "w", 8, 1,
                                      PHOTOMETRIC_MINISBLACK, nullptr, true))
                          .View()),
              ElementsAre(7, 8));
  const std::uint32_t wide[] = {1, 2};
  EXPECT_THAT(
      ErrorOfImage(write("x.tif", "w", 32, 1, PHOTOMETRIC_MINISBLACK, wide)),
      HasSubstr("expected gray or RGB of 8 or 16 bits"));
}

TEST(ImageFile, DamagedFilesAreOneLine) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOfImage(folder / "no.png"), HasSubstr("No such file"));
  EXPECT_THAT(ErrorOfImage(folder.Write("e.png", "")), HasSubstr("is empty"));
  EXPECT_THAT(ErrorOfImage(folder.Write("g.png", "hello")),
              HasSubstr("not a PNG, TIFF or JPEG"));
  const Image image = Pattern(60, 50, 8, 0);
  WritePng(folder / "a.png", image.View());
  WriteTiff(folder / "a.tif", image.View());
  WriteJpeg(folder / "a.jpg", image.View());
  for (const std::string name : {"a.png", "a.tif", "a.jpg"}) {
    const std::string whole = ReadAll(folder / name);
    for (const double part : {0.1, 0.5, 0.9, 0.99}) {
      const auto length =
          static_cast<std::size_t>(part * static_cast<double>(whole.size()));
      EXPECT_NE(
          ErrorOfImage(folder.Write("cut." + name, whole.substr(0, length))),
          "")
          << name << " cut to " << part;
    }
  }
}

// Seeded mutations: a picture or an error of the right lane, never a crash.
TEST(ImageFile, MutatedFilesNeverCrash) {
  const TemporaryFolder folder;
  std::mt19937 random(7);
  const Image image = Pattern(24, 16, 12, 0);
  WritePng(folder / "a.png", image.View());
  WriteTiff(folder / "a.tif", image.View());
  WriteJpeg(folder / "a.jpg", Pattern(24, 16, 8, 0).View());
  int refused = 0;
  for (const std::string name : {"a.png", "a.tif", "a.jpg"}) {
    const std::string whole = ReadAll(folder / name);
    for (int round = 0; round < 60; ++round) {
      std::string bytes = whole;
      for (int i = 0; i < 3; ++i) {
        bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
      }
      refused += ErrorOfImage(folder.Write("m." + name, bytes)).empty() ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 50);
}

TEST(ImageFile, AnOutputThatCannotBeWrittenIsOneLine) {
  const TemporaryFolder folder;
  const Image image = Pattern(8, 8, 8, 0);
  EXPECT_THROW(WritePng(folder / "no/a.png", image.View()), core::InputError);
  EXPECT_THROW(WriteTiff(folder / "no/a.tif", image.View()), core::InputError);
  EXPECT_THROW(WriteJpeg(folder / "no/a.jpg", image.View()), core::InputError);
}

}  // namespace
}  // namespace touchdown::vision
