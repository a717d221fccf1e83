// rig.toml.
#include <stdexcept>

#include "tests/fuzz/fuzz.h"
#include "touchdown/rig/description.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  fuzz::Answers([&] {
    const rig::Description description =
        rig::ParseDescription(fuzz::Text(data, size), "rig.toml");
    // What was accepted can be worked with.
    rig::MakeSpring(description.springs);
    rig::MakeLaunch(description, description.elevation_min_rad);
    rig::CheckCompression(description, 0.01);
  });
  return 0;
}
