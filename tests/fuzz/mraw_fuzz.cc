// The geometry of Photron recordings: a .cih header, a zero byte, and what the
// .mraw beside it holds. Every frame that is promised can be read, whole and in
// part.
#include <algorithm>
#include <string_view>

#include "tests/fuzz/fuzz.h"
#include "touchdown/vision/footage/clip.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  const std::string_view bytes = fuzz::Text(data, size);
  const std::size_t split = std::min(bytes.find('\0'), bytes.size());
  fuzz::WriteScratch("clip.cih", bytes.substr(0, split));
  const auto path = fuzz::WriteScratch(
      "clip.mraw", bytes.substr(std::min(split + 1, bytes.size())));
  fuzz::Answers([&] {
    const auto clip = vision::OpenClip(path);
    const vision::ClipInfo& info = clip->info();
    fuzz::Require(info.frames >= 1, "an open clip has frames");
    constexpr std::int64_t kFew = 8;
    for (std::int64_t i = 0; i < std::min(kFew, info.frames); ++i) {
      fuzz::Touch(clip->Read(i));
    }
    fuzz::Touch(clip->Read(info.frames - 1));
    const core::PixelRect corner{info.width_px / 2, info.height_px / 2,
                                 info.width_px - info.width_px / 2,
                                 info.height_px - info.height_px / 2};
    fuzz::Touch(clip->Read(info.frames - 1, corner));
  });
  return 0;
}
