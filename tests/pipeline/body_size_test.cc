// What is stated of the body beside what is seen of it.
#include "app/measure/body_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
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

// Of 20 px.
AnalyzeOptions StatedBall() {
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{1000.0, 1.0};
  options.diameter_m = core::Estimate{0.020, 2e-5};
  return options;
}

vision::Track SeenBall(double radius_px) {
  vision::Track track;
  track.body.kind = core::BodyKind::kSphere;
  track.body.radius_px = {radius_px, 0.002};
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
TEST(BodySize, WhatHangsOnAGammaIsUOfTheSize) {
  vision::Track seen = Seen(60.0, 20.0);
  seen.body.gamma_long_px = 0.1;
  seen.body.gamma_short_px = 0.1;
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{1000.0, 0.0};
  const auto body =
      DetermineBody(options, seen.body, FindScale(options, seen.body));
  ASSERT_TRUE(body.long_m);
  EXPECT_NEAR(body.long_m->u, 2e-4, 1e-6);
  EXPECT_NEAR(body.short_m->u, 2e-4, 1e-6);
  // A scale of the body's own size has it, too.
  options = {};
  options.long_m = core::Estimate{0.060, 0.0};
  options.short_m = core::Estimate{0.020, 0.0};
  const auto scale = FindScale(options, seen.body);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->px_per_m.u / scale->px_per_m.value, 0.1 / 30.0, 1e-5);
  // A stated size leaves nothing of it to count twice.
  const vision::Track sized = WithStatedSize(seen, Stated(0.060, 0.020));
  EXPECT_EQ(sized.body.gamma_long_px, 0.0);
  EXPECT_LT(sized.body.half_long_px.u, 0.05);
}

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

// An outline that lies 0.9 px beside a stated body of 53 px (half of 51.2 to
// 53.0) may be off in place by half a pixel, and by that over half its side in
// angle: what a wrong template showed, which was 12 u off before.
TEST(BodySize, ConflictWidensPlaceAndAngle) {
  const AnalyzeOptions options = Stated(0.053, 0.020);
  const vision::Track sized = WithStatedSize(Seen(51.2, 20.0), options);
  EXPECT_NEAR(sized.body.u_common_px, 0.9 / std::numbers::sqrt3, 0.01);
  EXPECT_NEAR(sized.body.u_texture_px, 0.9 / std::numbers::sqrt3, 0.01);
  const double half_px = sized.body.half_long_px.value;
  EXPECT_NEAR(sized.body.u_common_angle_rad,
              0.9 / std::numbers::sqrt3 / half_px, 3e-4);
}

// Three u of the statement apart is chance, and layers have counted what their
// outlines lie beside the statement already.
TEST(BodySize, ChanceAndLayersWidenNothing) {
  const AnalyzeOptions options = Stated(0.053, 0.020);
  EXPECT_EQ(WithStatedSize(Seen(53.15, 20.0), options).body.u_common_px, 0.0);
  vision::Track layered = Seen(51.2, 20.0);
  layered.layered = true;
  EXPECT_EQ(WithStatedSize(layered, options).body.u_common_px, 0.0);
}

// A disc shows no angle that could be off.
TEST(BodySize, ConflictOfADiameterWidensPlaceAlone) {
  const vision::Track sized = WithStatedSize(SeenBall(9.0), StatedBall());
  EXPECT_NEAR(sized.body.u_common_px, 1.0 / std::numbers::sqrt3, 0.01);
  EXPECT_EQ(sized.body.u_common_angle_rad, 0.0);
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
  EXPECT_THAT(ReasonOf(FindSizeConflict(SeenBall(7.5).body, StatedBall())),
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
