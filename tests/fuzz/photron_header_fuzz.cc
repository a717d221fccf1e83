// The headers of Photron recordings: .cih and .cihx, from the same bytes.
#include <cmath>

#include "footage/formats/photron_header.h"
#include "tests/fuzz/fuzz.h"

namespace touchdown::fuzz {
namespace {

void RequireSane(const vision::PhotronHeader& header) {
  Require(header.width_px >= 1 && header.width_px <= 1 << 16, "width bounded");
  Require(header.height_px >= 1 && header.height_px <= 1 << 16,
          "height bounded");
  Require(header.frames >= 1, "there are frames");
  Require(header.stored_bits == 8 || header.stored_bits == 12 ||
              header.stored_bits == 16,
          "stored bits are 8, 12 or 16");
  Require(header.effective_bits >= 1 && header.effective_bits <= 16,
          "effective bits are 1 to 16");
  Require(std::isfinite(header.record_rate_hz) && header.record_rate_hz > 0.0,
          "the rate is positive");
  Require(header.save_step >= 0, "the step is not negative");
}

}  // namespace
}  // namespace touchdown::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  const auto text = fuzz::Text(data, size);
  fuzz::Answers([&] { fuzz::RequireSane(vision::ParseCih(text, "a.cih")); });
  fuzz::Answers([&] { fuzz::RequireSane(vision::ParseCihx(text, "a.cihx")); });
  return 0;
}
