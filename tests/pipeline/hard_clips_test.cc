// What must not change an answer does not, and where there is none a reason is
// given: properties over seeded clips, pixels to document.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <utility>

#include "app/measure/analyze.h"
#include "tests/pipeline/analyzed_film.h"
#include "tests/pipeline/changed_clip.h"
#include "tests/pipeline/document.h"
#include "tests/pipeline/filmed.h"

namespace touchdown::pipeline {
namespace {

using core::BodyKind;
using filmed::Change;
using filmed::ChangedClip;
using filmed::Default;
using filmed::ExpectDocument;
using filmed::Film;
using filmed::SampleOf;

constexpr std::uint64_t kSeeds = 4;
constexpr double kMost_u = 1e-3;  // what an answer may change by

// The default throw with another instant, speed and roll.
Film Drawn(BodyKind kind, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  Film film = Default(kind);
  film.contact_frame += 0.5 * within(engine);
  film.camera.roll_rad = 1.0 * core::kDegree * within(engine);
  if (kind == BodyKind::kSphere) {
    film.thrown.before.vx *= 1.0 + 0.1 * within(engine);
  }
  return film;
}

Analysis AnalyzeChanged(const Film& film, std::uint64_t seed,
                        const Change& change) {
  return AnalyzeClip(
      std::make_unique<ChangedClip>(
          vision::OpenScene(filmed::BuildScene(film), seed), change),
      filmed::Known(film));
}

std::uint32_t Same(const SampleOf& of, std::int64_t i, std::int32_t x,
                   std::int32_t y) {
  return of(i, x, y);
}

void ExpectAlike(const core::Measured& a, const core::Measured& b,
                 double most_u, const char* what) {
  ASSERT_EQ(a.has_value(), b.has_value()) << what;
  if (!a) return;
  EXPECT_NEAR(a->value, b->value, most_u * a->u) << what;
  EXPECT_NEAR(a->u, b->u, most_u * a->u) << what;
}

class HardClips : public ::testing::TestWithParam<BodyKind> {};

// The same pixels seen in a mirror: what is left are the orders of sums.
TEST_P(HardClips, AMirroredClipIsTheSame) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Film film = Drawn(GetParam(), seed);
    const std::int32_t last = film.camera.width_px - 1;
    const Analysis a = AnalyzeChanged(film, seed, Same);
    const Analysis b = AnalyzeChanged(
        film, seed,
        [last](const SampleOf& of, std::int64_t i, std::int32_t x,
               std::int32_t y) { return of(i, last - x, y); });
    SCOPED_TRACE(seed);
    const core::Contact& one = a.contacts.first.contact;
    const core::Contact& other = b.contacts.first.contact;
    ExpectAlike(one.time_s, other.time_s, kMost_u, "time");
    ExpectAlike(one.approach_angle_rad, other.approach_angle_rad, kMost_u,
                "approach");
    ExpectAlike(one.face_angle_rad, other.face_angle_rad, kMost_u, "face");
    ExpectAlike(one.radius_angle_rad, other.radius_angle_rad, kMost_u,
                "radius");
    EXPECT_EQ(a.contacts.first.state.label, b.contacts.first.state.label);
  }
}

// Played backwards a sphere comes down as it left, and leaves as it came.
TEST_P(HardClips, AReversedClipIsTheReversedThrow) {
  if (GetParam() != BodyKind::kSphere) {
    return;  // a block's other corner is still in the air where the film ends
  }
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Film film = Drawn(GetParam(), seed);
    const std::int64_t last = film.frames - 1;
    const Analysis a = AnalyzeChanged(film, seed, Same);
    const Analysis b = AnalyzeChanged(
        film, seed,
        [last](const SampleOf& of, std::int64_t i, std::int32_t x,
               std::int32_t y) { return of(last - i, x, y); });
    SCOPED_TRACE(seed);
    const core::ContactRecord& one = a.contacts.first;
    const core::ContactRecord& other = b.contacts.first;
    ASSERT_TRUE(one.contact.frame && other.contact.frame)
        << one.contact.reason << other.contact.reason;
    EXPECT_NEAR(one.contact.frame->value,
                static_cast<double>(last) - other.contact.frame->value,
                kMost_u * one.contact.frame->u);
    ASSERT_TRUE(one.motion.after_normal_mps && other.motion.before_normal_mps);
    EXPECT_NEAR(one.motion.after_normal_mps->value,
                -other.motion.before_normal_mps->value,
                kMost_u * one.motion.after_normal_mps->u);
    ASSERT_TRUE(one.motion.before_tangential_mps &&
                other.motion.after_tangential_mps);
    EXPECT_NEAR(std::abs(one.motion.before_tangential_mps->value),
                std::abs(other.motion.after_tangential_mps->value),
                kMost_u * one.motion.before_tangential_mps->u);
  }
}

TEST_P(HardClips, FramesThatAreAllEqualShowNothing) {
  for (const std::int64_t frame : {0, 60, 80}) {
    const Analysis a =
        AnalyzeChanged(Default(GetParam()), 1,
                       [frame](const SampleOf& of, std::int64_t, std::int32_t x,
                               std::int32_t y) { return of(frame, x, y); });
    EXPECT_FALSE(a.contacts.first.contact.found);
    ASSERT_FALSE(a.body);
    EXPECT_FALSE(a.body.error().reason.empty());
    ExpectDocument(a);
  }
}

TEST_P(HardClips, WithoutContrastThereIsNoContact) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Film film = Drawn(GetParam(), seed);
    film.look.body_level = film.look.background_level;
    const Analysis a = AnalyzeChanged(film, seed, Same);
    EXPECT_FALSE(a.contacts.first.contact.found) << seed;
    ExpectDocument(a);
  }
}

std::function<std::uint32_t(const SampleOf&, std::int64_t, std::int32_t,
                            std::int32_t)>
Brighter(double factor) {
  return [factor](const SampleOf& of, std::int64_t i, std::int32_t x,
                  std::int32_t y) {
    return static_cast<std::uint32_t>(
        std::min(255.0, std::round(factor * of(i, x, y))));
  };
}

TEST_P(HardClips, AllWhite) {
  const Analysis white =
      AnalyzeChanged(Default(GetParam()), 1, Brighter(100.0));
  EXPECT_FALSE(white.contacts.first.contact.found);
  ExpectDocument(white);
}

// The surround is cut off, in the end the ground, too: the edge moves inwards,
// all around alike, and the instant with it by little. (The line seems to lie
// lower, of which there is a warning.)
TEST_P(HardClips, ASaturatedSurround) {
  for (const double factor : {1.6, 1.8, 2.0, 2.2, 2.5}) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const Film film = Default(GetParam());
      const Analysis bright = AnalyzeChanged(film, seed, Brighter(factor));
      ExpectDocument(bright);
      const core::Contact& contact = bright.contacts.first.contact;
      ASSERT_TRUE(contact.found) << factor << ", " << seed;
      EXPECT_EQ(bright.track->body.kind, GetParam());
      EXPECT_NEAR(contact.frame->value, film.contact_frame, 0.05)
          << factor << ", " << seed;
    }
  }
}

TEST_P(HardClips, ABodyNearlyAsLargeAsThePicture) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Film film = Drawn(GetParam(), seed);
    film.camera.width_px = 56;
    film.camera.height_px = 48;
    film.camera.ground_point = {28.0, 40.3};
    const Analysis a = AnalyzeChanged(film, seed, Same);
    ExpectDocument(a);
    const core::Contact& contact = a.contacts.first.contact;
    if (contact.frame) {
      EXPECT_NEAR(contact.frame->value, film.contact_frame,
                  std::max(1.0, 6.0 * contact.frame->u))
          << seed;
    }
  }
}

// With three to five frames of the body before contact, or after it: a wide u
// or a reason.
TEST_P(HardClips, ContactNextToTheFirstOrLastFrameOfTheBody) {
  for (int frames = 1; frames <= 5; ++frames) {
    for (const bool at_start : {true, false}) {
      Film film = Drawn(GetParam(), 7);
      const auto contact = static_cast<std::int64_t>(film.contact_frame);
      film.frames = contact + 8;  // a block's other corner is far from down
      if (at_start) {
        film.lead_in = contact + 1 - frames;
      } else {
        film.frames = contact + 1 + frames;
      }
      const Analysis a = AnalyzeChanged(film, 1, Same);
      SCOPED_TRACE((at_start ? frames : -frames));
      ExpectDocument(a);
      const core::Contact& found = a.contacts.first.contact;
      if (!found.found) {
        EXPECT_FALSE(found.reason.empty());
      } else if (found.frame) {
        EXPECT_NEAR(found.frame->value, film.contact_frame,
                    5.0 * found.frame->u);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, HardClips,
                         ::testing::Values(BodyKind::kSphere,
                                           BodyKind::kRectangle),
                         [](const auto& each) {
                           return each.param == BodyKind::kSphere ? "Sphere"
                                                                  : "Block";
                         });

}  // namespace
}  // namespace touchdown::pipeline
