// Still images in files: one gray picture read from PNG, TIFF or JPEG, and PNG
// written (contact sheets, image folders).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "touchdown/core/frame.h"

namespace touchdown::vision {

// A gray picture that owns its pixels; rows without padding, samples as in
// core::Frame.
struct Image {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int32_t bit_depth = 8;
  std::vector<std::byte> pixels;

  core::Frame View() const;  // valid as long as the image is neither changed
};

// Whether the name ends in .png, .tif, .tiff, .jpg or .jpeg (in any case).
bool IsImageName(const std::filesystem::path& path);

// Whether it is a TIFF of several pages: a recording (clip.h), not a picture.
// Looks at its beginning only; false of a file that is no TIFF. Throws
// core::InputError if the file cannot be opened.
bool IsTiffStack(const std::filesystem::path& path);

// Reads the luma of one picture; the kind is told by the content, not the name.
//
//   PNG   1 to 16 bit, gray, palette, colour; alpha is left out. An sBIT chunk
//         of 9 to 15 bits tells the bit depth, else 16-bit files have depth 16
//   TIFF  first page; 8 or 16 bit, gray or RGB, in strips or tiles, any
//         compression of libtiff. MaxSampleValue of 2^n - 1, n = 9 to 15, tells
//         the bit depth
//   JPEG  8 bit; Y as stored (full range), or of RGB
//
// Colour becomes luma by Rec. ITU-R BT.601: Y = 0.299 R + 0.587 G + 0.114 B,
// rounded to the nearest. Gamma and colour profiles are left alone.
//
// Throws core::InputError naming the file if it cannot be read, is damaged or
// cut short, or is of a kind not named here.
Image ReadImage(const std::filesystem::path& path);

// The same, keeping the memory of `image`.
void ReadImage(const std::filesystem::path& path, Image& image);

// Writes a gray picture of 8 bits, or of 9 to 16 bits as a 16-bit PNG (scaled
// to full range, with an sBIT chunk: ReadImage gives back the same samples).
// The file appears under its name only when it is complete. Throws
// core::InputError naming the file if it cannot be written.
void WritePng(const std::filesystem::path& path, const core::Frame& frame);

// Writes an 8-bit RGB picture: height_px rows of width_px times R, G, B,
// without padding. Throws std::invalid_argument if the sizes do not fit
// together.
void WritePngRgb(const std::filesystem::path& path, std::int32_t width_px,
                 std::int32_t height_px, std::span<const std::uint8_t> rgb);

// 8-bit or 9- to 16-bit gray in a TIFF (deflate); samples right-aligned, their
// depth in MaxSampleValue. Errors as WritePng.
void WriteTiff(const std::filesystem::path& path, const core::Frame& frame);

// 8-bit gray JPEG of quality 1 to 100. Errors as WritePng;
// std::invalid_argument if the frame has more than 8 bits.
void WriteJpeg(const std::filesystem::path& path, const core::Frame& frame,
               int quality = 95);

}  // namespace touchdown::vision
