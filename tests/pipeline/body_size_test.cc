// What is stated of the body beside what is seen of it.
#include "app/measure/body_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>

namespace touchdown::pipeline {
namespace {

using ::testing::HasSubstr;

AnalyzeOptions Stated(double long_m, double short_m) {
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{1000.0, 1.0};
  options.long_m = core::Estimate{long_m, 1e-3 * long_m};
  options.short_m = core::Estimate{short_m, 1e-3 * short_m};
  return options;
}

vision::Track Seen(double long_px, double short_px, double u = 0.004) {
  vision::Track track;
  track.body.kind = core::BodyKind::kRectangle;
  track.body.half_long_px = {0.5 * long_px, 0.5 * u};
  track.body.half_short_px = {0.5 * short_px, 0.5 * u};
  return track;
}

std::string ReasonOf(const std::optional<SizeConflict>& conflict) {
  return conflict ? conflict->reason : "";
}

TEST(BodySize, StatementThatAgreesHardlyChangesWhatIsSeen) {
  const AnalyzeOptions options = Stated(0.060, 0.020);
  const vision::Track seen = Seen(60.01, 20.00);
  const vision::Track sized = WithStatedSize(seen, options);
  EXPECT_NEAR(sized.body.half_long_px.value, 30.005, 0.001);
  EXPECT_LE(sized.body.half_long_px.u, seen.body.half_long_px.u);
  EXPECT_FALSE(FindSizeConflict(seen.body, options));
}

// Twelve u apart, as a camera's gamma makes it: u reaches the statement, and
// the sentence says so.
TEST(BodySize, ConflictGrowsUAndIsExplainedByTheOutline) {
  const AnalyzeOptions options = Stated(0.0889, 0.0342);
  const vision::Track seen = Seen(88.0, 33.3);
  const vision::Track sized = WithStatedSize(seen, options);
  for (const auto& [half, true_px] :
       {std::pair{sized.body.half_long_px, 44.45},
        std::pair{sized.body.half_short_px, 17.1}}) {
    EXPECT_LT(std::abs(half.value - true_px), 2.0 * half.u);
    EXPECT_GT(half.u, 0.1);
  }
  EXPECT_THAT(ReasonOf(FindSizeConflict(seen.body, options)),
              HasSubstr("outlines 0.45 px too far in"));
}

TEST(BodySize, ConflictOfBothSidesAlikeIsExplainedByTheScale) {
  EXPECT_THAT(
      ReasonOf(FindSizeConflict(Seen(63.0, 21.0).body, Stated(0.060, 0.020))),
      HasSubstr("a scale of 1050.0 px/m would explain both"));
}

TEST(BodySize, ConflictThatNothingExplainsAsksForAnotherBody) {
  EXPECT_THAT(
      ReasonOf(FindSizeConflict(Seen(40.0, 24.0).body, Stated(0.060, 0.020))),
      HasSubstr("another body"));
}

TEST(BodySize, SphereOfAnotherDiameterIsTold) {
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{1000.0, 1.0};
  options.diameter_m = core::Estimate{0.020, 2e-5};
  vision::Track track;
  track.body.kind = core::BodyKind::kSphere;
  track.body.radius_px = {7.5, 0.002};
  EXPECT_THAT(ReasonOf(FindSizeConflict(track.body, options)),
              HasSubstr("a scale of 750.0 px/m or a diameter of 15.000 mm"));
}

// A scale that comes of the body itself cannot contradict it.
TEST(BodySize, NothingIsComparedWithTheBodysOwnScale) {
  AnalyzeOptions options = Stated(0.060, 0.020);
  options.scale_px_per_m.reset();
  const vision::Track seen = Seen(54.0, 19.0);
  EXPECT_EQ(WithStatedSize(seen, options).body.half_short_px,
            seen.body.half_short_px);
  EXPECT_FALSE(FindSizeConflict(seen.body, options));
}

}  // namespace
}  // namespace touchdown::pipeline
