// What a contact's u counts: noise, what all poses share, line and scale. Of
// tracks with known truth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/statistics.h"
#include "tests/vision/contact_sweep.h"
#include "tests/vision/synthetic_track.h"
#include "touchdown/vision/contact/contact.h"

namespace touchdown::vision {
namespace {

using namespace core::literals;  // NOLINT
using synthetic::Block;
using synthetic::FilmGround;
using synthetic::Filming;
using synthetic::FilmPlane;
using synthetic::FilmTrack;
using synthetic::Numbers;
using synthetic::Rebound;
using synthetic::Throw;
using synthetic::WithScale;
using ::testing::HasSubstr;
using touchdown::testing::Rms;

// What all poses have in common is the same before and after the impact: only
// the height has it. A texture lies otherwise on the outline then.
TEST(ContactUncertainty, TimeIsWidenedByWhatTheImpactChanges) {
  Throw thrown;
  thrown.before = {1.4, -0.8, 0.0};
  thrown.after = {1.2, 0.5, 0.0};
  const Filming filming;
  const PlaneTrack clean = FilmPlane(thrown, filming);
  const auto find_time_u = [&](const PlaneTrack& track) {
    return FindContacts(track, WithScale(filming)).first.contact.time_s->u;
  };
  const double u = find_time_u(clean);
  constexpr double kOff_px = 0.01;
  PlaneTrack drifting = clean;
  drifting.u_common_px = kOff_px;
  EXPECT_NEAR(find_time_u(drifting), u, 0.02 * u);
  PlaneTrack textured = clean;
  textured.u_common_px = textured.u_texture_px = kOff_px;
  const double fall_px_per_s = 0.8 * filming.camera.px_per_m;
  EXPECT_NEAR(find_time_u(textured), std::hypot(u, kOff_px / fall_px_per_s),
              0.02 * u);
  drifting.is_predicted = true;  // frames lag behind the body
  EXPECT_NEAR(find_time_u(drifting),
              std::hypot(u, 0.5 * kOff_px / fall_px_per_s), 0.02 * u);
  EXPECT_GT(kOff_px / fall_px_per_s, 0.2 * u);  // the above tell them apart
}

// A block that glides in flat, less than a pixel above the ground: its outline
// and the ground's edge are seen as one, off by more the nearer they are. What
// touches the ground with a corner, or comes down steeply, hardly changes.
TEST(ContactUncertainty, AGlideBesideTheGroundIsKnownLess) {
  constexpr double kOff_px = 0.02;
  constexpr double kBlur_px = 1.0;
  Filming filming;
  filming.camera.fps = 2000.0;
  filming.frames = 60;
  filming.u_px = 0.004;
  filming.u_angle_rad = 1e-4;
  filming.u_ground_rad = 5e-5;
  const auto find = [&](const Throw& thrown, double blur_px) {
    PlaneTrack track = FilmPlane(thrown, filming);
    track.blur_px = blur_px;
    for (PlaneSample& s : track.samples) {
      const double off =
          kOff_px * std::exp(-std::max(s.gap_px, 0.0) / kBlur_px);
      s.gap_px -= off;
      s.height_px -= off;
    }
    return *FindContacts(track, WithScale(filming))
                .first.contact.approach_angle_rad;
  };
  Throw glide = Block(0.0);
  glide.before = {1.6, -0.12, 0.0};
  glide.after = {1.5, 0.0, 0.0};
  glide.stays = true;
  const core::Estimate angle = find(glide, kBlur_px);
  EXPECT_NEAR(angle.value, glide.ContactAngle(), 2.0 * angle.u);
  const double u_without = find(glide, 0.0).u;
  EXPECT_GT(angle.u, 1.3 * u_without);
  EXPECT_GT(std::abs(angle.value - glide.ContactAngle()), 2.0 * u_without);
  Throw steep = glide;
  steep.before.vy = -4.0;
  EXPECT_LT(find(steep, kBlur_px).u, 1.2 * find(steep, 0.0).u);
  Throw corner = Block(20.0_deg);
  Rebound(corner, 0.5);
  EXPECT_LT(find(corner, kBlur_px).u, 1.05 * find(corner, 0.0).u);
}

// A scale that is wrong makes gravity wrong: flights that are clear in the
// picture stay what they are, and lengths say that they may be off. Thirty
// frames of fall tell of a tenth.
TEST(ContactUncertainty, WrongScaleLeavesTheContact) {
  for (const double off : {-0.3, -0.2, -0.1, 0.1, 0.2, 0.4}) {
    SCOPED_TRACE(off);
    for (Throw thrown : {Throw{}, Block(10.0_deg)}) {
      thrown.before = {1.5, -1.2, 0.0};
      Rebound(thrown, 0.7);
      Filming filming;
      filming.frames = 90;
      const PlaneTrack track = FilmPlane(thrown, filming);
      ContactOptions options = WithScale(filming);
      const ContactResult right = FindContacts(track, options);
      EXPECT_FALSE(right.gravity_refuted);
      options.scale->px_per_m.value *= 1.0 + off;
      const ContactResult result = FindContacts(track, options);
      EXPECT_TRUE(result.gravity_refuted);
      EXPECT_THAT(result.warnings,
                  ::testing::Contains(HasSubstr("check both")));
      ASSERT_TRUE(result.first.contact.found) << result.first.contact.reason;
      EXPECT_EQ(result.first.state.label, right.first.state.label);
      const core::Estimate& time = *result.first.contact.time_s;
      EXPECT_NEAR(time.value, right.first.contact.time_s->value, 4.0 * time.u);
      ASSERT_TRUE(result.first.motion.before_normal_mps);
      const core::Estimate& normal = *result.first.motion.before_normal_mps;
      EXPECT_NEAR(normal.value, right.first.motion.before_normal_mps->value,
                  4.0 * normal.u);
    }
  }
}

// Short flights do not refute the gravity that the scale tells, as the cut of
// the path needs it; that they have another is told all the same. A frame rate
// that is 1.2 times too high makes it 1.44 times too large.
TEST(ContactUncertainty, ShortFlightsTellAWrongFrameRate) {
  constexpr double kTooHigh = 1.2;
  Throw thrown;
  thrown.contact_s = 0.0103;
  thrown.before = {1.5, -1.2, 0.0};
  Rebound(thrown, 0.6);
  Filming filming;
  filming.camera.fps = 2000.0;
  filming.frames = 45;
  filming.u_px = 0.01;
  int refuted = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    filming.seed = seed;
    const PlaneTrack track = FilmPlane(thrown, filming);
    ContactOptions options = WithScale(filming);
    // As a scale that is too small by the square.
    options.scale->px_per_m.value /= kTooHigh * kTooHigh;
    const ContactResult result = FindContacts(track, options);
    refuted += result.gravity_refuted ? 1 : 0;
    const core::Measured& g = result.first.motion.gravity_check_mps2;
    ASSERT_TRUE(g) << g.error().reason;
    EXPECT_NEAR(g->value / (kTooHigh * kTooHigh), core::kStandardGravity_mps2,
                4.0 * g->u);
    EXPECT_GT(g->value - core::kStandardGravity_mps2, 4.0 * g->u);
  }
  EXPECT_LT(refuted, 10);
}

// All poses lie 0.16 px beside the body, in its own directions, as
// outlines in a camera's gamma do: after the impact it tumbles, and the error
// goes round with it. Its path is a flight all the same.
TEST(ContactUncertainty, AnErrorThatGoesRoundWithTheBodyIsNoOtherMotion) {
  Throw thrown = Block(-60.0_deg);
  thrown.contact_s = 0.0503;
  thrown.before = {4.0, -1.5, -10.0};
  thrown.after = {3.2, 0.8, -64.0};
  Filming filming;
  filming.camera.fps = 500.0;
  filming.frames = 59;
  filming.u_px = 0.005;
  Track track = FilmTrack(
      thrown, [&](double t) { return thrown.At(t); }, filming);
  track.body.u_common_px = 0.13;
  for (Pose& pose : track.poses) {
    const double c = std::cos(pose.angle_rad);
    const double s = std::sin(pose.angle_rad);
    pose.centre.x_px += 0.16 * c;
    pose.centre.y_px += 0.16 * s;
  }
  const ContactResult result = FindContacts(
      SeenFromGround(track, FilmGround(filming)), WithScale(filming));
  ASSERT_TRUE(result.first.contact.found) << result.first.contact.reason;
  const core::Estimate& time = *result.first.contact.time_s;
  EXPECT_NEAR(time.value, thrown.contact_s, 4.0 * time.u);
}

// Flights that meet far off the line were cut wrongly, or there was more than
// one impact: what they tell is known no better than the line is missed by.
TEST(ContactUncertainty, FlightsThatMissTheLineAreWidened) {
  Throw thrown;
  thrown.before = {1.4, -0.5, 0.0};
  thrown.after = {1.2, 0.3, 0.0};
  const Filming filming;
  const PlaneTrack track = FilmPlane(thrown, filming);
  PlaneTrack off = track;
  constexpr double kOff_px = 0.4;  // the line is said to be known to 0.02
  for (PlaneSample& s : off.samples) {
    s.gap_px += kOff_px;
    s.height_px += kOff_px;
  }
  const ContactResult on_line = FindContacts(track, WithScale(filming));
  const ContactResult off_line = FindContacts(off, WithScale(filming));
  ASSERT_TRUE(on_line.first.contact.found);
  ASSERT_TRUE(off_line.first.contact.found);
  ASSERT_EQ(off_line.warnings.size(), 1u);
  EXPECT_THAT(off_line.warnings[0], HasSubstr("standard deviations above"));
  EXPECT_GT(off_line.first.contact.time_s->u,
            3.0 * on_line.first.contact.time_s->u);
  EXPECT_GT(off_line.first.contact.approach_angle_rad->u,
            3.0 * on_line.first.contact.approach_angle_rad->u);
}

// The budget adds up to the uncertainty that is printed.
TEST(ContactUncertainty, BudgetAddsUp) {
  for (const bool rectangle : {false, true}) {
    Throw thrown = rectangle ? Block(0.3) : Throw{};
    thrown.before.omega = rectangle ? 4.0 : 0.0;
    if (rectangle) Rebound(thrown, 0.5);
    Filming filming;
    filming.frames = 42;
    const core::Contact contact =
        FindContacts(FilmPlane(thrown, filming), WithScale(filming))
            .first.contact;
    const auto total = [](const core::Budget& budget) {
      double sum = 0.0;
      for (const core::BudgetLine& line : budget) sum += line.u * line.u;
      return std::sqrt(sum);
    };
    EXPECT_NEAR(total(contact.approach_budget), contact.approach_angle_rad->u,
                1e-12);
    if (rectangle) {
      EXPECT_NEAR(total(contact.attitude_budget), contact.face_angle_rad->u,
                  1e-12);
    }
  }
}

// Noise that the poses understate is found in the track's own scatter.
TEST(ContactUncertainty, UnderstatedNoiseIsWidened) {
  Throw thrown;
  std::vector<double> z;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Filming filming;
    filming.seed = seed;
    filming.u_px = 0.08;
    PlaneTrack plane = FilmPlane(thrown, filming);
    for (PlaneSample& s : plane.samples) {
      s.u_along_px = s.u_height_px = s.u_gap_px = 0.01;
    }
    const auto n = Numbers(FindContacts(plane, WithScale(filming)).first);
    z.push_back((n.at("approach").value - thrown.ContactAngle()) /
                n.at("approach").u);
  }
  EXPECT_LT(Rms(z), 1.4);
}

}  // namespace
}  // namespace touchdown::vision
