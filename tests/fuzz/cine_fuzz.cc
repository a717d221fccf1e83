// Phantom .cine as it is read: libav takes it apart, so what is tried here is
// what we make of its answers. Other containers are left alone.
#include <algorithm>
#include <string_view>

#include "tests/fuzz/fuzz.h"
#include "touchdown/vision/footage/clip.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  const std::string_view bytes = fuzz::Text(data, size);
  if (!bytes.starts_with("CI")) return -1;
  const auto path = fuzz::WriteScratch("clip.cine", bytes);
  fuzz::Answers([&] {
    vision::ClipOptions options;
    options.fps = 1000.0;
    options.decoder_threads = 1;
    const auto clip = vision::OpenClip(path, options);
    const vision::ClipInfo& info = clip->info();
    fuzz::Require(info.frames >= 1, "an open clip has frames");
    fuzz::Require(info.bit_depth >= 1 && info.bit_depth <= 16, "depth 1..16");
    constexpr std::int64_t kFew = 4;
    for (std::int64_t i = 0; i < std::min(kFew, info.frames); ++i) {
      fuzz::Touch(clip->Read(i));
    }
    fuzz::Touch(clip->Read(0, {0, 0, 1, 1}));
  });
  return 0;
}
