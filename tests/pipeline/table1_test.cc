// The 18 shots of Table 1, rendered, analysed, and compared with their truth.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/pipeline/analyze.h"
#include "app/pipeline/simulate.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/render.h"

namespace touchdown::pipeline {
namespace {

struct Outcome {
  std::string name;
  core::AngleKind kind = core::AngleKind::kApproach;
  double true_rad = 0.0;
  bool bounces = false;
  std::optional<Analysis> analysis;
};

Outcome Film(const Shot& shot, std::uint64_t seed) {
  const ShotTruth truth = TruthOf(shot);
  AnalyzeOptions options;
  // Measured with a caliper.
  const core::Body& body = shot.thrown.body;
  const auto measured = [](const core::Measured& m) {
    return core::Estimate{m->value, 1e-3 * m->value, std::nullopt};
  };
  if (body.kind == core::BodyKind::kSphere) {
    options.diameter_m = measured(body.diameter_m);
  } else {
    options.long_m = measured(body.long_m);
    options.short_m = measured(body.short_m);
  }
  options.angle_kind = shot.angle_kind;
  Outcome outcome;
  outcome.name = shot.name;
  outcome.kind = shot.angle_kind;
  outcome.true_rad = shot.angle_kind == core::AngleKind::kApproach
                         ? truth.touchdown->approach_angle_rad
                         : *truth.touchdown->face_angle_rad;
  outcome.bounces = truth.state == core::MotionState::kBounce;
  outcome.analysis = AnalyzeClip(
      vision::OpenScene(SceneOf(shot, truth.motion), seed), options);
  return outcome;
}

TEST(Table1Analysed, EighteenOfEighteenWithinAFewHundredthsOfADegree) {
  const std::vector<Shot> shots = Table1Shots();
  std::vector<Outcome> outcomes(shots.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    while (true) {
      const std::size_t i = next++;
      if (i >= shots.size()) return;
      outcomes[i] = Film(shots[i], 1);
    }
  };
  std::thread other(work);
  work();
  other.join();

  int right = 0;
  double square = 0.0;
  for (const Outcome& outcome : outcomes) {
    const core::ContactRecord& first = outcome.analysis->contacts.first;
    SCOPED_TRACE(outcome.name);
    ASSERT_TRUE(first.contact.found) << first.contact.reason;
    const core::Measured& angle = Angle(first.contact, outcome.kind);
    ASSERT_TRUE(angle) << angle.error().reason;
    // 90 and -90 degrees are one face angle.
    const double error = outcome.kind == core::AngleKind::kFace
                             ? std::remainder(angle->value - outcome.true_rad,
                                              core::kDegree * 180)
                             : angle->value - outcome.true_rad;
    EXPECT_LE(std::abs(error), 4.0 * angle->u)
        << error / core::kDegree << " +- " << angle->u / core::kDegree;
    square += error * error;
    const bool bounce = first.state.label == core::MotionState::kBounce;
    const bool slide = core::IsNotBounce(first.state.label);
    EXPECT_TRUE(outcome.bounces ? bounce : slide)
        << Name(first.state.label) << ": " << first.state.reason;
    right += outcome.bounces ? bounce : slide;
    RecordProperty(outcome.name + "_error_mdeg",
                   std::to_string(1e3 * error / core::kDegree));
  }
  EXPECT_EQ(right, 18);
  const double rmse_deg =
      std::sqrt(square / static_cast<double>(outcomes.size())) / core::kDegree;
  EXPECT_LE(rmse_deg, 0.15);
  std::printf("Table 1: %d of 18 right, RMSE %.4f deg\n", right, rmse_deg);
}

}  // namespace
}  // namespace touchdown::pipeline
