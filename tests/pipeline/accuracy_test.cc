// An extract of the accuracy table (./dev bench accuracy): 228 clips of its
// design, with the table's limits widened by what so few clips scatter.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/accuracy/score.h"

namespace touchdown::accuracy {
namespace {

using Sums = std::array<Sum, kQuantities>;

Sums SumOf(Hardship hardship, std::uint64_t first, std::uint64_t count) {
  Sums sums;
  for (std::uint64_t i = first; i < first + count; ++i) {
    const Outcome outcome = Analyse(Draw(i, hardship));
    for (std::size_t q = 0; q < kQuantities; ++q) {
      Add(sums[q], outcome, static_cast<Quantity>(q));
    }
  }
  return sums;
}

TEST(Accuracy, RegularClipsAreNearTheCramerRaoBound) {
  constexpr std::uint64_t kClips = 200;
  const Sums sums = SumOf(Hardship::kNone, 0, kClips);
  for (std::size_t q = 0; q < kQuantities; ++q) {
    SCOPED_TRACE(kQuantityNames[q]);
    const Sum& s = sums[q];
    EXPECT_EQ(s.measured, s.expected);
    ASSERT_GE(s.measured, 8U);
    // 1.5: what the whole table reaches; three standard errors of a scatter.
    const double few = 3.0 / std::sqrt(2.0 * static_cast<double>(s.measured));
    EXPECT_LT(s.RmseOverBound(), 1.5 * (1.0 + few));
    EXPECT_GT(s.RmseOverBound(), 1.0 - few);  // nobody beats the bound
    EXPECT_LE(std::abs(s.MeanZ()), 1.5 * s.MeanZBand());
    EXPECT_GE(s.CoverageBand().high, 0.95);
  }
}

TEST(Accuracy, HardClipsAreHonest) {
  constexpr std::uint64_t kClips = 4;
  Sum all;  // of all quantities
  std::size_t approach = 0;
  for (const Hardship hardship : kHardships) {
    const Sums sums = SumOf(hardship, 100, kClips);
    approach += sums[kApproach].measured;
    for (const Sum& s : sums) {
      all.measured += s.measured;
      all.covered += s.covered;
    }
  }
  EXPECT_GE(approach, 25U);  // of 28: a few may be absent, with a reason
  ASSERT_GE(all.measured, 60U);
  EXPECT_GE(all.CoverageBand().high, 0.95);
}

// What shines on a block, or hides it, is told by few numbers: a texture of any
// shape in its place leaves the sides open, and u was 10 to 100 times the
// bound.
TEST(Accuracy, HighlightsAndOccludersAreNoTexture) {
  for (const Case& c :
       {Draw(48, Hardship::kShaded), Draw(49, Hardship::kShaded),
        Draw(32, Hardship::kObstacle)}) {
    SCOPED_TRACE(c.seed);
    const Outcome outcome = Analyse(c);
    ASSERT_TRUE(outcome.readings[kRadius]);
    const Reading& radius = *outcome.readings[kRadius];
    EXPECT_LT(radius.u, 4.0 * radius.bound);
    EXPECT_LT(std::abs(radius.error), 2.5 * radius.u);
  }
}

// A shadow that touches a block explains change as a part of it would: with it
// the sides were up to 3 px too large, the face angle 250 bounds off.
TEST(Accuracy, AShadowIsNoPartOfABlock) {
  for (const std::uint64_t index : {30U, 56U}) {
    SCOPED_TRACE(index);
    const Outcome outcome = Analyse(Draw(index, Hardship::kShadow));
    ASSERT_TRUE(outcome.readings[kFace]) << outcome.reasons[kFace];
    const Reading& face = *outcome.readings[kFace];
    EXPECT_LT(std::abs(face.error), 5.0 * face.bound);
    EXPECT_LT(std::abs(face.error), 2.5 * face.u);
  }
}

// Where the face's levels cross those of the wall, outlines of free size lose
// the stated one, and the clip was refused.
TEST(Accuracy, APictureDoesNotHideAStatedSize) {
  for (const std::uint64_t index : {4U, 10U, 17U, 54U}) {
    SCOPED_TRACE(index);
    const Outcome outcome = Analyse(Draw(index, Hardship::kPictured));
    ASSERT_TRUE(outcome.readings[kApproach]) << outcome.reasons[kApproach];
    const Reading& approach = *outcome.readings[kApproach];
    EXPECT_LT(approach.u, 4.0 * approach.bound);
    EXPECT_LT(std::abs(approach.error), 2.5 * approach.u);
  }
}

// Rebounds from none to ten times the bounce height: where the gap is off it by
// more than twice its u no label is wrong.
TEST(Accuracy, NoFalseAndNoMissedBounce) {
  constexpr std::uint64_t kClips = 40;
  States states;
  for (std::uint64_t i = 0; i < kClips; ++i)
    Add(states, Analyse(DrawRebound(i)));
  EXPECT_GE(states.clear, 25U);
  EXPECT_EQ(states.false_bounces, 0U);
  EXPECT_EQ(states.missed_bounces, 0U);
  EXPECT_LE(states.undecided, 2U);  // 5 %
}

TEST(Accuracy, TheBoundFollowsTheTextbook) {
  // A circle of diameter 40, contrast 120, noise 4 DN and a total blur of 1 px:
  // 0.0079 px (circle of radius R: sd = 1 / sqrt(pi R J)).
  Case c = Draw(0, Hardship::kNone);
  c.levels.kind = core::BodyKind::kSphere;
  c.film.thrown.kind = core::BodyKind::kSphere;
  c.film.thrown.half_long_m = c.film.thrown.half_short_m =
      20.0 / c.film.camera.px_per_m;
  c.levels.contrast = -120.0 / 255.0;
  c.levels.bit_depth = 16;  // no rounding to speak of
  c.levels.noise = 4.0 / 255.0;
  c.levels.blur_px = std::sqrt(1.0 - 1.0 / 12.0);
  c.levels.open = 0.0;
  EXPECT_NEAR(BoundOf(c).centre_px, 0.0079, 0.00005);
}

// Where the picture on its face is none, a body is as well known as by the
// closed form, which counts its level, its corners and the still picture as
// known; with one the picture takes from what the outline tells, and what it
// tells of a ball's turning is not asked for.
TEST(Accuracy, TheBoundOfAPictureBeginsAtThatOfNone) {
  for (const std::uint64_t i : {2U, 6U, 7U}) {
    SCOPED_TRACE(i);
    const Case pictured = Draw(i, Hardship::kPictured);
    ASSERT_TRUE(pictured.film.look.face);
    Case plain = pictured;
    plain.film.look.face.reset();
    Case faint = pictured;
    faint.film.look.face->amplitude = 1e-5;
    const Bound without = BoundOf(plain);
    const Bound nearly = BoundOf(faint);
    const Bound with = BoundOf(pictured);
    EXPECT_NEAR(nearly.approach_rad / without.approach_rad, 1.0, 0.05);
    EXPECT_NEAR(nearly.frame / without.frame, 1.0, 0.05);
    if (pictured.levels.kind == core::BodyKind::kRectangle) {
      EXPECT_NEAR(nearly.face_rad / without.face_rad, 1.0, 0.08);
      EXPECT_GT(with.face_rad, 1.5 * without.face_rad);
    }
  }
}

}  // namespace
}  // namespace touchdown::accuracy
