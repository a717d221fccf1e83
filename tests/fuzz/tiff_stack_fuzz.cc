// TIFFs of several pages: the list of pages is ours, the pages are libtiff's.
#include <algorithm>

#include "footage/formats/tiff_pages.h"
#include "tests/fuzz/fuzz.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::fuzz {
namespace {

void RequireSane(const vision::TiffPages& list, std::uint64_t size) {
  Require(list.pages.empty() || list.pages.back().whole,
          "the last page is whole");
  for (const vision::TiffPage& page : list.pages) {
    if (page.samples == 0) continue;
    const auto bytes = static_cast<std::uint64_t>(page.width_px) *
                       static_cast<std::uint64_t>(page.height_px) *
                       (page.bit_depth > 8 ? 2u : 1u);
    Require(page.samples <= size && bytes <= size - page.samples,
            "plain samples lie in the file");
  }
}

}  // namespace
}  // namespace touchdown::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  fuzz::Answers([&] {
    fuzz::RequireSane(vision::ListTiffPages({data, size}, "stack.tif"), size);
  });
  const auto path = fuzz::WriteScratch("stack.tif", fuzz::Text(data, size));
  fuzz::Answers([&] {
    const auto clip = vision::OpenClip(path, {.fps = 1000.0});
    const vision::ClipInfo& info = clip->info();
    fuzz::Require(info.frames >= 1, "an open clip has frames");
    fuzz::Require(info.bit_depth >= 8 && info.bit_depth <= 16, "depth 8..16");
    constexpr std::int64_t kFew = 4;
    for (std::int64_t i = 0; i < std::min(kFew, info.frames); ++i) {
      fuzz::Answers([&] { fuzz::Touch(clip->Read(i)); });
    }
    fuzz::Touch(clip->Read(info.frames - 1, {0, 0, 1, 1}));
  });
  return 0;
}
