// Contacts of balls whose marks show how they turn, and what an error that
// poses share does to a path.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/vision/contact_sweep.h"
#include "tests/vision/synthetic_track.h"
#include "touchdown/vision/contact/contact.h"

namespace touchdown::vision {
namespace {

using core::MotionState;
using synthetic::Filming;
using synthetic::FilmPlane;
using synthetic::Throw;
using synthetic::WithScale;
using ::testing::HasSubstr;

TEST(Contact, MarksShowTheSpinOfABall) {
  Throw thrown;
  thrown.marked = true;
  thrown.face_rad = 2.0;
  thrown.before = {1.5, -1.0, -12.0};
  thrown.after = {1.2, 0.6, -41.0};
  Filming filming;
  for (const bool left : {false, true}) {
    filming.camera.travels_left = left;
    const core::Motion motion =
        FindContacts(FilmPlane(thrown, filming), WithScale(filming))
            .first.motion;
    ASSERT_TRUE(motion.before_omega_rad_per_s);
    ASSERT_TRUE(motion.after_omega_rad_per_s);
    EXPECT_NEAR(motion.before_omega_rad_per_s->value, -12.0,
                4.0 * motion.before_omega_rad_per_s->u);
    EXPECT_NEAR(motion.after_omega_rad_per_s->value, -41.0,
                4.0 * motion.after_omega_rad_per_s->u);
    EXPECT_LT(motion.after_omega_rad_per_s->u, 0.1);
  }
  thrown.marked = false;
  const core::Motion motion =
      FindContacts(FilmPlane(thrown, filming), WithScale(filming)).first.motion;
  ASSERT_FALSE(motion.before_omega_rad_per_s);
  EXPECT_EQ(motion.before_omega_rad_per_s.error().reason,
            "no mark on the sphere");
}

// An outline that marks draw to one side of the body bends the path by
// u omega^2: that is no wrong scale, and speeds have it in u.
TEST(Contact, WhatPosesShareGoesRoundWithTheBody) {
  constexpr double kOff_px = 0.1;
  Throw thrown;
  thrown.marked = true;
  thrown.before = {1.5, -1.0, 0.0};
  thrown.after = {1.2, 0.9, -110.0};
  Filming filming;
  filming.frames = 80;
  PlaneTrack track = FilmPlane(thrown, filming);
  for (PlaneSample& s : track.samples) {
    s.along_px += kOff_px * std::cos(s.face_rad);
    s.height_px += kOff_px * std::sin(s.face_rad);
  }
  const auto find = [&](double u_common_px) {
    track.u_common_px = u_common_px;
    return FindContacts(track, WithScale(filming));
  };
  const ContactResult blind = find(0.0);
  EXPECT_TRUE(blind.gravity_refuted);
  const ContactResult told = find(kOff_px);
  EXPECT_FALSE(told.gravity_refuted);
  const core::Motion& motion = told.first.motion;
  ASSERT_TRUE(motion.after_normal_mps);
  EXPECT_GT(motion.after_normal_mps->u,
            0.9 * kOff_px * 110.0 / filming.camera.px_per_m);
  EXPECT_NEAR(motion.after_normal_mps->value, 0.9,
              4.0 * motion.after_normal_mps->u);
}

// Flights of another gravity than the scale's may have places that err along
// the path, and then the path leans, too.
TEST(Contact, PlacesThatBendThePathLeanAtTouchdown) {
  constexpr double kBend = 0.06 * 9.81;  // m/s^2
  Throw thrown;
  thrown.contact_s = 0.06;
  thrown.before = {2.8, -0.5, 0.0};
  thrown.after = {2.5, 0.3, 0.0};
  Filming filming;
  filming.frames = 200;
  filming.camera.fps = 2000.0;
  const PlaneTrack clean = FilmPlane(thrown, filming);
  const core::Contact right =
      FindContacts(clean, WithScale(filming)).first.contact;
  ASSERT_TRUE(right.found && right.time_s);
  const double fallen_s = right.time_s->value - clean.samples.front().time_s;
  int beyond_noise = 0;
  for (const double vertex : {0.0, 0.25, 0.5, 0.75, 1.0}) {  // of the flight
    PlaneTrack bent = clean;
    for (PlaneSample& s : bent.samples) {
      const double t =
          s.time_s - clean.samples.front().time_s - vertex * fallen_s;
      s.height_px += 0.5 * kBend * t * t * filming.camera.px_per_m;
    }
    const ContactResult result = FindContacts(bent, WithScale(filming));
    EXPECT_TRUE(result.gravity_refuted) << vertex;
    const core::Contact& contact = result.first.contact;
    ASSERT_TRUE(contact.found && contact.approach_angle_rad);
    const double off =
        contact.approach_angle_rad->value - right.approach_angle_rad->value;
    // The vertex at an end is sqrt(3) of the rms.
    EXPECT_LT(std::abs(off), 2.2 * contact.approach_angle_rad->u) << vertex;
    // A path that leans by all that it bends would have at most this.
    EXPECT_LT(contact.approach_angle_rad->u, kBend * fallen_s / 2.8);
    beyond_noise += std::abs(off) > 4.0 * right.approach_angle_rad->u ? 1 : 0;
  }
  EXPECT_EQ(beyond_noise, 4);
}

// A contact point that slips goes by v + R omega.
TEST(Contact, MarksTellARollFromASlide) {
  const Filming filming;
  const auto name = [&](double speed_mps, double omega) {
    Throw thrown;
    thrown.stays = true;
    thrown.marked = true;
    thrown.before = {1.4, -0.8, 0.0};
    thrown.after = {speed_mps, 0.0, omega};
    return FindContacts(FilmPlane(thrown, filming), WithScale(filming))
        .first.state;
  };
  const double radius_m = Throw{}.half_long_m;
  EXPECT_EQ(name(1.0, -1.0 / radius_m).label, MotionState::kRoll);
  EXPECT_EQ(name(1.0, 0.0).label, MotionState::kSlide);
  EXPECT_EQ(name(1.0, -0.5 / radius_m).label, MotionState::kRollSlide);
  EXPECT_EQ(name(0.0, -1.0 / radius_m).label, MotionState::kRollSlide);
  EXPECT_EQ(name(0.0, 0.0).label, MotionState::kStick);
  EXPECT_THAT(name(1.0, -1.0 / radius_m).reason,
              HasSubstr("its contact point slips by"));
}

}  // namespace
}  // namespace touchdown::vision
