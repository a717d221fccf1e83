// The luma of decoded video frames, upright: in place where the pixel format
// and orientation allow, else copied.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "footage/formats/cine_curve.h"
#include "footage/formats/libav.h"
#include "touchdown/core/frame.h"
#include "touchdown/core/points.h"

namespace touchdown::vision {

// How the stored picture is to be shown: first transposed, then mirrored.
struct Orientation {
  bool transposed = false;
  bool mirrored_x = false;  // left and right change places, as shown
  bool mirrored_y = false;

  friend bool operator==(const Orientation&, const Orientation&) = default;
};

// From the display matrix of a stream (libavutil/display.h); nothing if it asks
// for something else than quarter turns and mirroring.
std::optional<Orientation> ReadOrientation(const std::int32_t matrix[9]);

// What to do with the frames of one stream.
class LumaReader {
 public:
  // Whether there is a luma of 8 to 16 bits to be had from the pixel format:
  // Y of all YUV and gray formats as stored (limited range stays limited),
  // Rec. BT.601 luma of RGB and palettes. Not: Bayer mosaics, floats, formats
  // of fewer than 8 bits a sample.
  static bool Reads(AVPixelFormat format);

  // `significant_bits`: where 0 < significant_bits < depth of the format, the
  // samples were scaled up by the decoder and are shifted down again.
  LumaReader(AVPixelFormat format, Orientation orientation,
             std::int32_t significant_bits);

  // Undoes the companding of a packed .cine, whose samples have ten bits: from
  // now on they have twelve, linear in light.
  void UndoCineCurve();

  std::int32_t bit_depth() const { return bit_depth_; }
  AVPixelFormat format() const { return format_; }
  const Orientation& orientation() const { return orientation_; }

  // A window of `frame`, in coordinates as shown. Sets data, stride, size,
  // depth and origin; valid as long as `frame` and until the next View.
  core::Frame View(const AVFrame& frame, const core::PixelRect& window);

 private:
  AVPixelFormat format_;
  Orientation orientation_;
  std::int32_t bit_depth_;
  std::int32_t shift_ = 0;
  std::int32_t stored_bits_;  // of a sample, before the curve is undone
  std::optional<CineCurve> curve_;
  std::vector<std::uint16_t> buffer_;  // of the window, where it is copied
};

}  // namespace touchdown::vision
