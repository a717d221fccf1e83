#include "footage/formats/luma.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "footage/formats/image_codecs.h"
#include "footage/formats/libav.h"

namespace touchdown::vision {
namespace {

// Samples of one component, as shown: sample (x, y) lies at
// origin + x * dx + y * dy.
struct Lattice {
  const std::uint8_t* origin = nullptr;
  std::ptrdiff_t dx = 0;
  std::ptrdiff_t dy = 0;
};

// Rotation and mirroring cost nothing: they are strides of either sign.
Lattice MakeLattice(const AVFrame& frame,
                    const AVComponentDescriptor& component,
                    const Orientation& orientation,
                    const core::PixelRect& window) {
  Lattice lattice{frame.data[component.plane] + component.offset,
                  component.step, frame.linesize[component.plane]};
  std::int32_t width = frame.width;
  std::int32_t height = frame.height;
  if (orientation.transposed) {
    std::swap(lattice.dx, lattice.dy);
    std::swap(width, height);
  }
  if (orientation.mirrored_x) {
    lattice.origin += (width - 1) * lattice.dx;
    lattice.dx = -lattice.dx;
  }
  if (orientation.mirrored_y) {
    lattice.origin += (height - 1) * lattice.dy;
    lattice.dy = -lattice.dy;
  }
  lattice.origin += window.x * lattice.dx + window.y * lattice.dy;
  return lattice;
}

// out[y][x] = load(x * dx + y * dy), the offset in each of the lattices.
template <class Sample, class Load>
void Copy(const core::PixelRect& window, const Load& load, Sample* out) {
  for (std::int32_t y = 0; y < window.height; ++y) {
    for (std::int32_t x = 0; x < window.width; ++x) {
      *out++ = static_cast<Sample>(load(x, y));
    }
  }
}

std::uint32_t Load8(const Lattice& l, std::int32_t x, std::int32_t y) {
  return l.origin[x * l.dx + y * l.dy];
}

std::uint32_t Load16(const Lattice& l, std::int32_t x, std::int32_t y,
                     bool big_endian) {
  const std::uint8_t* const p = l.origin + x * l.dx + y * l.dy;
  return big_endian ? static_cast<std::uint32_t>(p[0] << 8 | p[1])
                    : static_cast<std::uint32_t>(p[1] << 8 | p[0]);
}

// Luma of the 256 colours that stand behind the indices.
std::array<std::uint8_t, 256> PaletteLuma(const AVFrame& frame) {
  std::array<std::uint8_t, 256> luma{};
  for (std::size_t i = 0; i < luma.size(); ++i) {
    std::uint32_t argb = 0;
    std::memcpy(&argb, frame.data[1] + 4 * i, 4);
    luma[i] = static_cast<std::uint8_t>(
        Luma(argb >> 16 & 0xFF, argb >> 8 & 0xFF, argb & 0xFF));
  }
  return luma;
}

bool Has(const AVPixFmtDescriptor& format, std::uint64_t flag) {
  return (format.flags & flag) != 0;
}

}  // namespace

std::optional<Orientation> ReadOrientation(const std::int32_t matrix[9]) {
  // Shown (x', y') = (a x + c y, b x + d y) with a, b, c, d at 0, 1, 3, 4.
  const std::int32_t a = matrix[0];
  const std::int32_t b = matrix[1];
  const std::int32_t c = matrix[3];
  const std::int32_t d = matrix[4];
  // Turns by whole quarters only: the matrix has zeros on one diagonal.
  if (b == 0 && c == 0 && a != 0 && d != 0) return {{false, a < 0, d < 0}};
  if (a == 0 && d == 0 && b != 0 && c != 0) return {{true, c < 0, b < 0}};
  return std::nullopt;
}

// Whether a pixel format is one of whole samples of 8 to 16 bits.
bool LumaReader::Reads(AVPixelFormat format) {
  const AVPixFmtDescriptor* const d = Libav().av_pix_fmt_desc_get(format);
  if (d == nullptr || Has(*d, AV_PIX_FMT_FLAG_HWACCEL) ||
      Has(*d, AV_PIX_FMT_FLAG_BITSTREAM) || Has(*d, AV_PIX_FMT_FLAG_BAYER) ||
      Has(*d, AV_PIX_FMT_FLAG_FLOAT)) {
    return false;
  }
  if (Has(*d, AV_PIX_FMT_FLAG_PAL)) return true;
  const bool rgb = Has(*d, AV_PIX_FMT_FLAG_RGB);
  const int components = rgb ? 3 : 1;
  if (d->nb_components < components) return false;
  for (int i = 0; i < components; ++i) {
    const AVComponentDescriptor& c = d->comp[i];
    if (c.depth < 8 || c.depth > 16 || c.depth != d->comp[0].depth ||
        (c.depth == 8 && c.shift != 0)) {
      return false;
    }
  }
  return true;
}

// Bits that a camera does not use are shifted out, so that a Frame is
// right-aligned.
LumaReader::LumaReader(AVPixelFormat format, Orientation orientation,
                       std::int32_t significant_bits)
    : format_(format), orientation_(orientation), stored_bits_(0) {
  const AVPixFmtDescriptor* const d = Libav().av_pix_fmt_desc_get(format);
  bit_depth_ = Has(*d, AV_PIX_FMT_FLAG_PAL) ? 8 : d->comp[0].depth;
  shift_ = d->comp[0].shift;
  if (significant_bits > 8 && significant_bits < bit_depth_) {
    shift_ += bit_depth_ - significant_bits;
    bit_depth_ = significant_bits;
  }
  stored_bits_ = bit_depth_;
}

void LumaReader::UndoCineCurve() {
  curve_ = CineLinearOfCode();
  bit_depth_ = kCineLinearBits;
}

core::Frame LumaReader::View(const AVFrame& frame,
                             const core::PixelRect& window) {
  const AVPixFmtDescriptor& d = *Libav().av_pix_fmt_desc_get(format_);
  const bool palette = Has(d, AV_PIX_FMT_FLAG_PAL);
  const bool rgb = Has(d, AV_PIX_FMT_FLAG_RGB) && !palette;
  const bool big_endian = Has(d, AV_PIX_FMT_FLAG_BE);
  const bool wide = bit_depth_ > 8;
  const Lattice y = MakeLattice(frame, d.comp[0], orientation_, window);

  core::Frame view;
  view.width_px = window.width;
  view.height_px = window.height;
  view.bit_depth = bit_depth_;
  view.origin_x_px = window.x;
  view.origin_y_px = window.y;
  // Where samples lie as a Frame has them, they are handed out in place.
  const bool aligned =
      reinterpret_cast<std::uintptr_t>(y.origin) % 2 == 0 && y.dy % 2 == 0;
  if (!palette && !rgb && !curve_ && shift_ == 0 && y.dy > 0 &&
      y.dx == (wide ? 2 : 1) && (!wide || (!big_endian && aligned))) {
    view.data = reinterpret_cast<const std::byte*>(y.origin);
    view.stride_bytes = y.dy;
    return view;
  }

  const auto samples = static_cast<std::size_t>(window.width) *
                       static_cast<std::size_t>(window.height);
  buffer_.resize(wide ? samples : (samples + 1) / 2);
  auto* const out8 = reinterpret_cast<std::uint8_t*>(buffer_.data());
  std::uint16_t* const out16 = buffer_.data();
  if (palette) {
    const auto luma = PaletteLuma(frame);
    Copy(
        window,
        [&](std::int32_t u, std::int32_t v) { return luma[Load8(y, u, v)]; },
        out8);
  } else if (rgb) {
    const Lattice g = MakeLattice(frame, d.comp[1], orientation_, window);
    const Lattice b = MakeLattice(frame, d.comp[2], orientation_, window);
    if (wide) {
      const auto load = [&](const Lattice& l, const AVComponentDescriptor& c,
                            std::int32_t u, std::int32_t v) {
        return Load16(l, u, v, big_endian) >> c.shift & ((1u << c.depth) - 1u);
      };
      Copy(
          window,
          [&](std::int32_t u, std::int32_t v) {
            return Luma(load(y, d.comp[0], u, v), load(g, d.comp[1], u, v),
                        load(b, d.comp[2], u, v));
          },
          out16);
    } else {
      Copy(
          window,
          [&](std::int32_t u, std::int32_t v) {
            return Luma(Load8(y, u, v), Load8(g, u, v), Load8(b, u, v));
          },
          out8);
    }
  } else if (wide) {
    const std::uint32_t mask = (1u << stored_bits_) - 1u;
    Copy(
        window,
        [&](std::int32_t u, std::int32_t v) {
          return Load16(y, u, v, big_endian) >> shift_ & mask;
        },
        out16);
    if (curve_) {
      std::transform(out16, out16 + samples, out16, [&](std::uint16_t code) {
        return (*curve_)[code & ((1u << kCineCodeBits) - 1u)];
      });
    }
  } else {
    Copy(
        window, [&](std::int32_t u, std::int32_t v) { return Load8(y, u, v); },
        out8);
  }
  view.data = reinterpret_cast<const std::byte*>(buffer_.data());
  view.stride_bytes = std::ptrdiff_t{window.width} * (wide ? 2 : 1);
  return view;
}

}  // namespace touchdown::vision
