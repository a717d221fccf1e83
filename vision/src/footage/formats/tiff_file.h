// libtiff over bytes in memory, with message handlers of the open file only
// (the library's global ones stay as they are).
#pragma once

#include <tiffio.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "footage/formats/image_codecs.h"

namespace touchdown::vision {

// A file in memory: to be read, or growing.
struct TiffMemory {
  FileBytes input;
  std::vector<std::uint8_t>* output = nullptr;
  std::uint64_t at = 0;
  char error[160] = "";  // the first message: the cause; others follow from it

  std::uint64_t size() const { return output ? output->size() : input.size(); }
};

struct TiffClose {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using TiffHandle = std::unique_ptr<TIFF, TiffClose>;

// `mode` as TIFFOpen takes it; null where libtiff refuses. `memory` must live
// as long as the handle.
TiffHandle OpenTiff(TiffMemory& memory, const char* mode);

// The page whose directory stands at byte `directory` of the file; otherwise
// as DecodeTiff.
void DecodeTiffPage(FileBytes file, std::uint64_t directory,
                    const std::string& name, Image& image);

}  // namespace touchdown::vision
