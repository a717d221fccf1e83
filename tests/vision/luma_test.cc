#include "vision/src/footage/formats/luma.h"

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>
}

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

namespace touchdown::vision {
namespace {

constexpr int kWidth = 22;
constexpr int kHeight = 14;

// A frame of random samples in every component; av_write_image_line is the
// oracle's inverse: it knows where each pixel format keeps them.
struct Picture {
  LibavPtr<AVFrame> frame{av_frame_alloc()};
  // components[c][y * kWidth + x], full resolution components only
  std::vector<std::uint16_t> components[3];
};

Picture RandomPicture(AVPixelFormat format) {
  Picture picture;
  picture.frame->format = format;
  picture.frame->width = kWidth;
  picture.frame->height = kHeight;
  av_frame_get_buffer(picture.frame.get(), 0);
  // av_write_image_line sets bits and clears none.
  for (const auto* const buffer : picture.frame->buf) {
    if (buffer != nullptr) std::memset(buffer->data, 0, buffer->size);
  }
  const AVPixFmtDescriptor* const d = av_pix_fmt_desc_get(format);
  std::mt19937 random(1);
  const int components = (d->flags & AV_PIX_FMT_FLAG_RGB) != 0 ? 3 : 1;
  for (int c = 0; c < components; ++c) {
    const auto mask = static_cast<std::uint16_t>((1u << d->comp[c].depth) - 1u);
    for (int y = 0; y < kHeight; ++y) {
      std::vector<std::uint16_t> row;
      for (int x = 0; x < kWidth; ++x) {
        row.push_back(static_cast<std::uint16_t>(random() & mask));
      }
      av_write_image_line(row.data(), picture.frame->data,
                          picture.frame->linesize, d, 0, y, c, kWidth);
      picture.components[c].insert(picture.components[c].end(), row.begin(),
                                   row.end());
    }
  }
  return picture;
}

class LumaFormats : public ::testing::TestWithParam<AVPixelFormat> {};

TEST_P(LumaFormats, EveryWindowInEveryOrientation) {
  const AVPixelFormat format = GetParam();
  ASSERT_TRUE(LumaReader::Reads(format));
  const AVPixFmtDescriptor* const d = av_pix_fmt_desc_get(format);
  const Picture picture = RandomPicture(format);
  const bool rgb = (d->flags & AV_PIX_FMT_FLAG_RGB) != 0;
  for (int turn = 0; turn < 8; ++turn) {
    const Orientation o{(turn & 4) != 0, (turn & 2) != 0, (turn & 1) != 0};
    LumaReader reader(format, o, 0);
    EXPECT_EQ(reader.bit_depth(), d->comp[0].depth);
    const int width = o.transposed ? kHeight : kWidth;
    const int height = o.transposed ? kWidth : kHeight;
    for (const core::PixelRect& window :
         {core::PixelRect{0, 0, width, height}, core::PixelRect{3, 5, 7, 4}}) {
      const core::Frame view = reader.View(*picture.frame, window);
      EXPECT_GT(view.stride_bytes, 0);
      for (int v = 0; v < window.height; ++v) {
        for (int u = 0; u < window.width; ++u) {
          // Undo mirroring, then transposition.
          int x = window.x + u;
          int y = window.y + v;
          if (o.mirrored_x) x = width - 1 - x;
          if (o.mirrored_y) y = height - 1 - y;
          if (o.transposed) std::swap(x, y);
          const auto i = static_cast<std::size_t>(y * kWidth + x);
          if (rgb) {
            const double luma = 0.299 * picture.components[0][i] +
                                0.587 * picture.components[1][i] +
                                0.114 * picture.components[2][i];
            // The integer weights are within 2^-17 of the decimal ones.
            ASSERT_NEAR(view.at(u, v), luma, 0.5 + 3 * 65535.0 / (1 << 17));
          } else {
            ASSERT_EQ(view.at(u, v), picture.components[0][i]);
          }
        }
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(
    Formats, LumaFormats,
    ::testing::Values(
        AV_PIX_FMT_GRAY8, AV_PIX_FMT_YUV420P, AV_PIX_FMT_YUVJ422P,
        AV_PIX_FMT_NV12, AV_PIX_FMT_YUYV422, AV_PIX_FMT_UYVY422, AV_PIX_FMT_YA8,
        AV_PIX_FMT_YUV420P10LE, AV_PIX_FMT_YUV444P12BE, AV_PIX_FMT_P010LE,
        AV_PIX_FMT_GRAY10LE, AV_PIX_FMT_GRAY12BE, AV_PIX_FMT_GRAY16LE,
        AV_PIX_FMT_GRAY16BE, AV_PIX_FMT_RGB24, AV_PIX_FMT_BGR24,
        AV_PIX_FMT_RGB0, AV_PIX_FMT_ABGR, AV_PIX_FMT_GBRP, AV_PIX_FMT_GBRP10LE,
        AV_PIX_FMT_RGB48LE, AV_PIX_FMT_RGB48BE, AV_PIX_FMT_BGRA64LE),
    [](const auto& tested) {
      return std::string(av_get_pix_fmt_name(tested.param));
    });

TEST(LumaReader, PaletteAndUpsideDownRows) {
  const LibavPtr<AVFrame> frame(av_frame_alloc());
  frame->format = AV_PIX_FMT_PAL8;
  frame->width = 4;
  frame->height = 3;
  ASSERT_EQ(av_frame_get_buffer(frame.get(), 0), 0);
  auto* const palette = reinterpret_cast<std::uint32_t*>(frame->data[1]);
  // A gray ramp, as cameras write it, with one colour.
  for (std::uint32_t i = 0; i < 256; ++i)
    palette[i] = 0xFF000000u | i * 0x010101u;
  palette[7] = 0xFF0A141E;  // 10, 20, 30
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      frame->data[0][y * frame->linesize[0] + x] =
          static_cast<std::uint8_t>(y * 4 + x);
    }
  }
  // As uncompressed .avi comes out of the decoder: last row first in memory.
  frame->data[0] += 2 * frame->linesize[0];
  frame->linesize[0] = -frame->linesize[0];
  LumaReader reader(AV_PIX_FMT_PAL8, {}, 0);
  const core::Frame view = reader.View(*frame, {0, 0, 4, 3});
  EXPECT_EQ(view.at(0, 0), 8u);
  EXPECT_EQ(view.at(3, 2), 3u);
  EXPECT_EQ(
      view.at(3, 1),
      static_cast<unsigned>(std::lround(0.299 * 10 + 0.587 * 20 + 0.114 * 30)));
  LumaReader gray(AV_PIX_FMT_GRAY8, {}, 0);
  EXPECT_GT(gray.View(*frame, {0, 0, 4, 3}).stride_bytes, 0);
  EXPECT_EQ(gray.View(*frame, {1, 1, 2, 2}).at(0, 0), 5u);
  frame->linesize[0] = -frame->linesize[0];
  frame->data[0] -= 2 * frame->linesize[0];
}

TEST(LumaReader, WhatIsNotRead) {
  for (const AVPixelFormat format :
       {AV_PIX_FMT_BAYER_RGGB8, AV_PIX_FMT_MONOBLACK, AV_PIX_FMT_GRAYF32LE,
        AV_PIX_FMT_RGB565LE, AV_PIX_FMT_VAAPI, AV_PIX_FMT_NONE}) {
    EXPECT_FALSE(LumaReader::Reads(format));
  }
}

// libavutil/display.h: shown = (a x + c y, b x + d y).
TEST(ReadOrientation, QuarterTurnsAndMirrors) {
  constexpr std::int32_t k = 65536;
  const auto of = [](std::int32_t a, std::int32_t b, std::int32_t c,
                     std::int32_t d) {
    const std::int32_t matrix[9] = {a, b, 0, c, d, 0, 0, 0, 1 << 30};
    return ReadOrientation(matrix);
  };
  EXPECT_EQ(of(k, 0, 0, k), (Orientation{false, false, false}));
  EXPECT_EQ(of(-k, 0, 0, -k), (Orientation{false, true, true}));
  EXPECT_EQ(of(0, k, -k, 0), (Orientation{true, true, false}));
  EXPECT_EQ(of(0, -k, k, 0), (Orientation{true, false, true}));
  EXPECT_EQ(of(k, k, -k, k), std::nullopt);
  EXPECT_EQ(of(0, 0, 0, 0), std::nullopt);
}

}  // namespace
}  // namespace touchdown::vision
