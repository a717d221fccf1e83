// The header of a .cine, and what its stamps say about the frames' spacing.
#include <cmath>

#include "footage/formats/cine_header.h"
#include "footage/formats/frame_spacing.h"
#include "tests/fuzz/fuzz.h"

namespace touchdown::fuzz {
namespace {

void RequireSane(const vision::CineHeader& header) {
  const auto images = static_cast<std::size_t>(header.images);
  Require(header.times_s.empty() || header.times_s.size() == images,
          "a time for each image, or none");
  Require(header.exposures_s.empty() || header.exposures_s.size() == images,
          "an exposure for each image, or none");
  for (std::size_t i = 1; i < header.times_s.size(); ++i) {
    Require(header.times_s[i] > header.times_s[i - 1], "times ascend");
  }
  const vision::FrameSpacing spacing = vision::FindSpacing(
      header.times_s, {header.stated_fps}, {.jitter_s = vision::kCineJitterS});
  Require(std::isfinite(spacing.fps) && spacing.fps >= 0.0, "a rate, or none");
  Require(
      spacing.times_s.size() == (spacing.uniform ? 0u : header.times_s.size()),
      "a time for each frame where they are not uniform");
  Require(spacing.uniform == vision::DescribeSpacing(spacing).empty(),
          "what is not uniform is said");
}

}  // namespace
}  // namespace touchdown::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  fuzz::Answers([&] {
    fuzz::RequireSane(vision::ParseCineHeader({data, size}, "a.cine"));
  });
  return 0;
}
