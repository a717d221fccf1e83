// The pages of a TIFF, found by walking its chain of directories once: where
// each directory stands, what size its picture has, and whether the file holds
// all of it. Of the directories only what is needed here is looked at, with
// every offset checked; libtiff decodes the pages.
//
// Classic TIFF and BigTIFF (64-bit offsets), either byte order; also ImageJ's
// stacks without directories: one directory, whose description says how many
// pictures lie one behind the other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "footage/formats/image_codecs.h"

namespace touchdown::vision {

struct TiffPage {
  std::uint64_t directory = 0;  // its byte in the file
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  std::int32_t bit_depth = 0;  // significant, as DecodeTiff finds it; 1 .. 64
  bool whole = true;           // the file reaches to the end of its data
  // Where its samples begin if they are gray, not compressed, 0 is black, and
  // all lie in one piece: then they need no decoder. Else 0.
  std::uint64_t samples = 0;
};

struct TiffPages {
  std::vector<TiffPage> pages;  // whole at the end; others are damaged ones
  bool big_endian = false;      // of 16-bit samples
  std::int64_t thumbnails = 0;  // pages of reduced size, left out
  std::string ended_early;      // why there are no more pages, or empty
};

// Throws core::InputError naming the file if it is no TIFF.
TiffPages ListTiffPages(FileBytes file, const std::string& name);

// Whether a TIFF has a second page that is no thumbnail; looks at its first
// directories only. False of what is no TIFF.
bool HasSeveralTiffPages(FileBytes file);

}  // namespace touchdown::vision
