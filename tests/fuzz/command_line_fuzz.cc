// Numbers of the command line. The first byte chooses the kind.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "app/batch/batch.h"
#include "app/cli/values.h"
#include "app/trials/campaign_entry.h"
#include "tests/fuzz/fuzz.h"

namespace touchdown::fuzz {
namespace {

void RequireSane(const core::Estimate& estimate) {
  Require(std::isfinite(estimate.value), "a value is finite");
  Require(std::isfinite(estimate.u) && estimate.u >= 0.0,
          "an uncertainty is finite and at least 0");
}

void Parse(int kind, const std::string& text) {
  switch (kind % 7) {
    case 0:
      RequireSane(cli::ParseEstimate("--x", text, 1e-3, {.relative = 1e-3}));
      break;
    case 1: {
      const auto sides = cli::ParseSides("--x", text, 1e-3, {.relative = 1e-3});
      RequireSane(sides.first);
      RequireSane(sides.second);
      break;
    }
    case 2:
      for (const double number : cli::ParseNumbers("--x", text, 4, "numbers")) {
        Require(std::isfinite(number), "a number is finite");
      }
      break;
    case 3: {
      const auto [first, last] = cli::ParseFrames("--x", text);
      Require(first >= 0 && (last == -1 || last > first), "a range of frames");
      break;
    }
    case 4: {
      const core::PixelRect region = cli::ParseRegion("--x", text);
      Require(region.x >= 0 && region.y >= 0 && region.width >= 1 &&
                  region.height >= 1,
              "a region within a picture");
      break;
    }
    case 5: {
      const auto shard = pipeline::ParseShard("--x", text);
      Require(shard.k >= 1 && shard.k <= shard.n, "a part of the whole");
      break;
    }
    default: {
      pipeline::BodyEntry entry;
      const std::size_t split = std::min(text.find('\n'), text.size());
      entry.diameter_mm = text.substr(0, split);
      entry.sides_mm = text.substr(std::min(split + 1, text.size()));
      if (const auto body = pipeline::ParseBody(entry)) {
        for (const auto* size :
             {&body->diameter_m, &body->long_m, &body->short_m}) {
          if (*size) {
            RequireSane(**size);
            Require((*size)->value > 0.0, "a size is positive");
          }
        }
      }
      break;
    }
  }
}

}  // namespace
}  // namespace touchdown::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace touchdown;  // NOLINT(google-build-using-namespace)
  if (size == 0) return 0;
  try {
    fuzz::Parse(static_cast<int>(data[0]),
                std::string(fuzz::Text(data + 1, size - 1)));
  } catch (const std::invalid_argument& error) {
    fuzz::Require(std::string(error.what()).size() > 3,
                  "an error says what is wrong");
  }
  return 0;
}
