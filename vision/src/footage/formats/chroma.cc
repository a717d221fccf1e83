#include "footage/formats/chroma.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace touchdown::vision {

bool ChromaReader::Reads(AVPixelFormat format) {
  const AVPixFmtDescriptor* const d = Libav().av_pix_fmt_desc_get(format);
  // Formats that hold no planes of Cb and Cr.
  constexpr std::uint64_t kOther =
      AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_HWACCEL |
      AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_BAYER | AV_PIX_FMT_FLAG_FLOAT;
  return d != nullptr && d->nb_components >= 3 && (d->flags & kOther) == 0 &&
         (d->flags & AV_PIX_FMT_FLAG_PLANAR) != 0 && d->comp[1].depth == 8 &&
         d->comp[1].step == 1;
}

ChromaReader::ChromaReader(AVPixelFormat format, Orientation orientation,
                           Channel channel)
    : format_(format),
      orientation_(orientation),
      component_(channel == Channel::kBlueDifference ? 1 : 2) {}

// The colour difference at each luma pixel, bilinearly between chroma samples,
// whose places the format tells: centred, to the left, or at the top left of
// their luma pixels.
core::Frame ChromaReader::View(const AVFrame& frame,
                               const core::PixelRect& window) {
  const AVPixFmtDescriptor& d = *Libav().av_pix_fmt_desc_get(format_);
  const AVComponentDescriptor& component = d.comp[component_];
  const std::uint8_t* const plane =
      frame.data[component.plane] + component.offset;
  const std::ptrdiff_t stride = frame.linesize[component.plane];
  const double step_x = 1 << d.log2_chroma_w;
  const double step_y = 1 << d.log2_chroma_h;
  const int width = -((-frame.width) >> d.log2_chroma_w);
  const int height = -((-frame.height) >> d.log2_chroma_h);
  // Of the first chroma sample, in luma pixels as stored.
  const bool centred = frame.chroma_location == AVCHROMA_LOC_CENTER;
  const double first_x = centred ? 0.5 * (step_x - 1.0) : 0.0;
  const double first_y = frame.chroma_location == AVCHROMA_LOC_TOPLEFT
                             ? 0.0
                             : 0.5 * (step_y - 1.0);
  buffer_.resize(static_cast<std::size_t>(window.width) *
                 static_cast<std::size_t>(window.height));
  const int shown_width = orientation_.transposed ? frame.height : frame.width;
  const int shown_height = orientation_.transposed ? frame.width : frame.height;
  std::uint8_t* out = buffer_.data();
  for (std::int32_t v = window.y; v < window.y + window.height; ++v) {
    for (std::int32_t u = window.x; u < window.x + window.width; ++u) {
      // As shown -> as stored: mirrored, then transposed.
      double x = orientation_.mirrored_x ? shown_width - 1 - u : u;
      double y = orientation_.mirrored_y ? shown_height - 1 - v : v;
      if (orientation_.transposed) std::swap(x, y);
      const double cx = std::clamp((x - first_x) / step_x, 0.0,
                                   static_cast<double>(width - 1));
      const double cy = std::clamp((y - first_y) / step_y, 0.0,
                                   static_cast<double>(height - 1));
      const int x0 = static_cast<int>(cx);
      const int y0 = static_cast<int>(cy);
      const int x1 = std::min(x0 + 1, width - 1);
      const int y1 = std::min(y0 + 1, height - 1);
      const double sx = cx - x0;
      const double sy = cy - y0;
      const double value = (1 - sy) * ((1 - sx) * plane[y0 * stride + x0] +
                                       sx * plane[y0 * stride + x1]) +
                           sy * ((1 - sx) * plane[y1 * stride + x0] +
                                 sx * plane[y1 * stride + x1]);
      *out++ = static_cast<std::uint8_t>(std::lround(value));
    }
  }
  core::Frame view;
  view.data = reinterpret_cast<const std::byte*>(buffer_.data());
  view.stride_bytes = window.width;
  view.width_px = window.width;
  view.height_px = window.height;
  view.bit_depth = 8;
  view.origin_x_px = window.x;
  view.origin_y_px = window.y;
  return view;
}

}  // namespace touchdown::vision
