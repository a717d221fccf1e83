// Manifests of batch.
#include <cmath>
#include <string>

#include "app/batch/manifest.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  fuzz::Answers([&] {
    const auto rows = pipeline::ParseManifest(
        std::string(fuzz::Text(data, size)), "m.csv", "films");
    fuzz::Require(!rows.empty(), "a manifest lists something");
    for (const auto& row : rows) {
      fuzz::Require(!row.name.empty(), "every row names a recording");
      for (const auto& number :
           {row.set_angle_rad, row.set_speed_mps, row.fps}) {
        fuzz::Require(!number || std::isfinite(*number), "numbers are finite");
      }
    }
  });
  return 0;
}
