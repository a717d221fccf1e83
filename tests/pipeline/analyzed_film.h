// A film rendered, analysed with its scale known, and compared with its truth.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

#include "app/measure/analyze.h"
#include "tests/pipeline/filmed.h"
#include "touchdown/core/estimate.h"
#include "touchdown/vision/synthetic/scene.h"

namespace touchdown::pipeline::filmed {

inline AnalyzeOptions Known(const Film& film) {
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{
      film.camera.px_per_m, 1e-4 * film.camera.px_per_m, std::nullopt};
  return options;
}

inline Analysis AnalyzeFilm(const Film& film, std::uint64_t seed = 1) {
  return AnalyzeClip(vision::OpenScene(BuildScene(film), seed), Known(film));
}

// |error| within 4 standard uncertainties.
inline void ExpectMeasured(const core::Measured& measured, double truth,
                           const char* what) {
  ASSERT_TRUE(measured) << what << ": " << measured.error().reason;
  EXPECT_NEAR(measured->value, truth, 4.0 * measured->u) << what;
}

}  // namespace touchdown::pipeline::filmed
