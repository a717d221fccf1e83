// Contacts of tracks with known truth. No pixel is needed: what the tracker
// does to a track is the tracker's test.
#include "touchdown/vision/contact/contact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/statistics.h"
#include "tests/vision/contact_sweep.h"
#include "tests/vision/synthetic_track.h"

namespace touchdown::vision {
namespace {

using namespace core::literals;  // NOLINT
using core::MotionState;
using synthetic::Block;
using synthetic::ExpectFinite;
using synthetic::ExpectHonest;
using synthetic::FilmGround;
using synthetic::Filming;
using synthetic::FilmPlane;
using synthetic::FilmTrack;
using synthetic::Numbers;
using synthetic::Rebound;
using synthetic::Shoot;
using synthetic::Sweep;
using synthetic::Throw;
using synthetic::WithScale;
using ::testing::HasSubstr;
using touchdown::testing::Rms;
using touchdown::testing::RmsBand9999;

TEST(Contact, BounceBetweenFrames) {
  for (const double angle : {5.0_deg, 20.0_deg, 45.0_deg, 80.0_deg, 90.0_deg}) {
    SCOPED_TRACE(angle / core::kDegree);
    Throw thrown;
    thrown.before = {1.5 * std::cos(angle), -1.5 * std::sin(angle), 0.0};
    thrown.after = {0.8 * thrown.before.vx, -0.6 * thrown.before.vy, 0.0};
    Filming filming;
    filming.frames = 50;  // until before it comes down again
    const Sweep sweep = Shoot(thrown, filming);
    ExpectHonest(sweep);
    EXPECT_EQ(sweep.later, 0);
    if (angle > 15.0_deg) {
      EXPECT_EQ(sweep.states.at(MotionState::kBounce), 60);
    }
  }
}

TEST(Contact, SoftContactOverSeveralFrames) {
  Throw thrown;
  thrown.duration_s = 3.3e-3;  // 6.6 frames
  Filming filming;
  const Sweep sweep = Shoot(thrown, filming);
  ExpectHonest(sweep);
  EXPECT_EQ(sweep.states.at(MotionState::kBounce), 60);
  EXPECT_EQ(sweep.later, 0);
}

TEST(Contact, SlideAfterTouchdown) {
  Throw thrown;
  thrown.before = {1.4, -0.25, 0.0};
  thrown.after = {1.2, 0.0, 0.0};
  thrown.stays = true;
  const Sweep sweep = Shoot(thrown, {});
  ExpectHonest(sweep);
  EXPECT_EQ(sweep.states.at(MotionState::kStaysDown), 60);

  Throw block = Block(0.0);
  block.before = {1.4, -0.25, 0.0};
  block.after = {1.2, 0.0, 0.0};
  block.stays = true;
  const Sweep blocks = Shoot(block, {});
  ExpectHonest(blocks);
  EXPECT_EQ(blocks.states.at(MotionState::kSlide), 60);
  Throw stuck = block;
  stuck.after = {};
  EXPECT_EQ(Shoot(stuck, {}).states.at(MotionState::kStick), 60);
}

TEST(Contact, RectangleCornerWithSpin) {
  for (const double face : {-25.0_deg, -8.0_deg, 8.0_deg, 25.0_deg}) {
    for (const double omega : {-6.0, 0.0, 6.0}) {
      SCOPED_TRACE(face / core::kDegree);
      SCOPED_TRACE(omega);
      Throw thrown = Block(face);
      thrown.before = {1.2, -0.9, omega};
      Rebound(thrown, 0.6);
      // Film until the other end comes near the ground.
      Filming filming;
      const core::Body body = core::Rectangle({0.06, 0}, {0.02, 0});
      filming.frames = 32;
      while (filming.frames < 60 &&
             Gap(body, thrown.At((filming.frames + 1) / 2000.0)) > 2e-4) {
        ++filming.frames;
      }
      ASSERT_GT(filming.frames, 38);
      const Sweep sweep = Shoot(thrown, filming, 40);
      ExpectHonest(sweep);
    }
  }
}

// A nearly flush block strikes with one corner, and before the next frame with
// the other: two impacts, of which no frame shows the flight between.
TEST(Contact, BothCornersBetweenTwoFrames) {
  Throw first = Block(1.0_deg);
  first.before = {1.2, -0.9, 0.0};
  Rebound(first, 0.5);
  // Until the other corner comes down.
  const core::Body body = core::Rectangle({0.06, 0}, {0.02, 0});
  double second_s = first.contact_s + 2e-5;
  while (Gap(body, first.At(second_s)) > 0.0) second_s += 1e-6;
  const ScenePose there = first.At(second_s);
  Throw second = Block(there.angle_rad);
  second.contact_s = second_s;
  second.x_m = there.centre.x_m;
  const double fall = second_s - first.contact_s;
  second.before = {first.after.vx, first.after.vy - first.gravity_mps2 * fall,
                   first.after.omega};
  Rebound(second, 0.5);
  Filming filming;
  filming.frames = 56;
  filming.camera.fps = 0.4 / fall;
  const double frame = 1.0 / filming.camera.fps;
  filming.first_time_s = first.contact_s - 28.3 * frame;
  std::vector<double> z_time;
  std::vector<double> z_face;
  constexpr std::uint64_t kClips = 40;
  for (std::uint64_t seed = 1; seed <= kClips; ++seed) {
    filming.seed = seed;
    const PlaneTrack track = SeenFromGround(
        synthetic::FilmTrack(
            first,
            [&](double t) { return t < second_s ? first.At(t) : second.At(t); },
            filming),
        synthetic::FilmGround(filming));
    const ContactResult found = FindContacts(track, WithScale(filming));
    const core::Contact& contact = found.first.contact;
    ASSERT_TRUE(contact.found) << contact.reason;
    // Two flights tell no restitution of two impacts between them.
    const core::Motion& motion = found.first.motion;
    ASSERT_FALSE(motion.restitution) << motion.restitution->value;
    EXPECT_THAT(motion.restitution.error().reason,
                ::testing::HasSubstr("more than one impact"));
    EXPECT_EQ(motion.unresolved_impacts, 2);
    EXPECT_GE(found.restitution.unresolved, 2);
    z_time.push_back((contact.time_s->value - first.contact_s) /
                     contact.time_s->u);
    z_face.push_back((contact.face_angle_rad->value - first.face_rad) /
                     contact.face_angle_rad->u);
  }
  EXPECT_LT(Rms(z_time), 1.5);
  EXPECT_LT(Rms(z_face), 1.5);
}

// Lands on one corner, leaves the ground, and 1.74 frames later lands for good:
// no frame shows the greatest gap between, and one shows that there is any.
TEST(Contact, HopThatEndsBetweenFramesIsItsFlights) {
  Throw first = Block(7.0_deg);
  first.before = {2.5, -1.2, 0.0};
  Rebound(first, 0.1);
  const core::Body body = core::Rectangle({0.06, 0}, {0.02, 0});
  double greatest_m = 0.0;
  double second_s = first.contact_s + 2e-5;
  for (double gap = 1.0; gap > 0.0; second_s += 1e-6) {
    gap = Gap(body, first.At(second_s));
    greatest_m = std::max(greatest_m, gap);
  }
  const ScenePose there = first.At(second_s);
  Throw second = Block(there.angle_rad);
  second.contact_s = second_s;
  second.x_m = there.centre.x_m;
  second.after = {2.0, 0.0, 0.0};
  second.stays = true;
  Filming filming;
  filming.camera.fps = 1.74 / (second_s - first.contact_s);
  const double frame = 1.0 / filming.camera.fps;
  filming.first_time_s = first.contact_s - 28.04 * frame;
  std::vector<double> z;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    filming.seed = seed;
    PlaneTrack track = SeenFromGround(
        synthetic::FilmTrack(
            first,
            [&](double t) { return t < second_s ? first.At(t) : second.At(t); },
            filming),
        synthetic::FilmGround(filming));
    track.exposure = 0.05;  // its frames are instants
    const core::ContactRecord record =
        FindContacts(track, WithScale(filming)).first;
    ASSERT_TRUE(record.state.max_gap_m);
    const core::Estimate& gap = *record.state.max_gap_m;
    z.push_back((gap.value - greatest_m) / gap.u);
    EXPECT_LT(gap.u, 0.3 * greatest_m);
  }
  EXPECT_LT(Rms(z), 1.5);
}

// A hop of four frames and seven times the noise is part of what stays down: it
// must not lift the ground, nor be smoothed away.
TEST(Contact, HopTooSmallForAFlightOfItsOwn) {
  Throw thrown;
  thrown.before = {1.2, -0.14, 0.0};
  thrown.after = {1.1, 0.043, 0.0};
  const double lands_s = thrown.contact_s + 2.0 * 0.043 / thrown.gravity_mps2;
  Throw down = thrown;
  down.contact_s = lands_s;
  down.x_m = thrown.At(lands_s).centre.x_m;
  down.stays = true;
  Filming filming;
  filming.frames = 30;
  filming.camera.fps = 500.0;
  filming.u_px = 0.0125;
  std::vector<double> z_gap;
  std::vector<double> z_time;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    filming.seed = seed;
    filming.first_time_s = thrown.contact_s - 10.155 / filming.camera.fps;
    const PlaneTrack track = SeenFromGround(
        synthetic::FilmTrack(
            thrown,
            [&](double t) { return t < lands_s ? thrown.At(t) : down.At(t); },
            filming),
        synthetic::FilmGround(filming));
    const core::ContactRecord record =
        FindContacts(track, WithScale(filming)).first;
    ASSERT_TRUE(record.contact.found);
    ASSERT_TRUE(record.state.max_gap_m);
    const double greatest_m = 0.043 * 0.043 / 2.0 / thrown.gravity_mps2;
    z_gap.push_back((record.state.max_gap_m->value - greatest_m) /
                    record.state.max_gap_m->u);
    z_time.push_back((record.contact.time_s->value - thrown.contact_s) /
                     record.contact.time_s->u);
  }
  EXPECT_LT(Rms(z_gap), 1.7);
  EXPECT_LT(Rms(z_time), 1.5);
}

TEST(Contact, CornerIsTheOneThatTouches) {
  for (const auto& [face, corner] :
       std::vector<std::pair<double, core::Corner>>{
           {-20.0_deg, core::Corner::kLeading},
           {20.0_deg, core::Corner::kTrailing},
           {60.0_deg, core::Corner::kTrailing},
           {80.0_deg, core::Corner::kLeading},  // past the diagonal, 71.6
           {-80.0_deg, core::Corner::kTrailing},
           {0.0, core::Corner::kFlush},
           {90.0_deg, core::Corner::kFlush}}) {
    for (const bool left : {false, true}) {
      Throw thrown = Block(face);
      thrown.before = {1.2, -0.9, 0.0};
      Rebound(thrown, 0.5);
      if (corner == core::Corner::kFlush) thrown.after = {1.0, 0.4, 0.0};
      Filming filming;
      filming.frames = 40;
      filming.noise = false;
      filming.camera.travels_left = left;
      const ContactResult result =
          FindContacts(FilmPlane(thrown, filming), WithScale(filming));
      ASSERT_TRUE(result.first.contact.corner) << face;
      EXPECT_EQ(*result.first.contact.corner, corner)
          << face / core::kDegree << " degrees, left " << left;
    }
  }
}

// What a neighbouring answer differs by is then the number that was changed.
TEST(Contact, OnItsOwnPathTheAnswerIsTheSame) {
  for (const double face : {-25.0_deg, 0.0_deg, 8.0_deg}) {
    SCOPED_TRACE(face / core::kDegree);
    Throw thrown = Block(face);
    thrown.before = {1.2, -0.9, 3.0};
    Rebound(thrown, 0.6);
    Filming filming;
    filming.frames = 38;
    PlaneTrack track = FilmPlane(thrown, filming);
    ContactOptions options = WithScale(filming);
    const ContactResult result = FindContacts(track, options);
    ASSERT_TRUE(result.first.contact.found) << result.first.contact.reason;
    options.path = result.path;
    const ContactResult again = FindContacts(track, options);
    ASSERT_TRUE(again.first.contact.found) << again.first.contact.reason;
    const core::Estimate angle = *result.first.contact.approach_angle_rad;
    EXPECT_NEAR(again.first.contact.approach_angle_rad->value, angle.value,
                1e-6 * angle.u);
    // Another rate measures the same stretches.
    track.frame_interval_s *= 1.02;
    for (PlaneSample& s : track.samples) s.time_s *= 1.02;
    const ContactResult slower = FindContacts(track, options);
    ASSERT_EQ(slower.path.size(), result.path.size());
    for (std::size_t i = 0; i < result.path.size(); ++i) {
      EXPECT_EQ(slower.path[i].first_frame, result.path[i].first_frame);
      EXPECT_EQ(slower.path[i].last_frame, result.path[i].last_frame);
    }
  }
}

TEST(Contact, FaceAngleLiesInItsHalfTurn) {
  for (double face = -170.0; face <= 180.0; face += 17.5) {
    Throw thrown = Block(std::remainder(face, 180.0) * core::kDegree);
    thrown.before = {1.2, -0.9, 0.0};
    Rebound(thrown, 0.5);
    Filming filming;
    filming.frames = 38;
    const ContactResult result =
        FindContacts(FilmPlane(thrown, filming), WithScale(filming));
    ASSERT_TRUE(result.first.contact.face_angle_rad)
        << face << ": " << result.first.contact.reason;
    const double measured = result.first.contact.face_angle_rad->value;
    EXPECT_GT(measured, -90.0_deg - 1e-12);
    EXPECT_LE(measured, 90.0_deg);
    EXPECT_NEAR(
        std::remainder(measured - face * core::kDegree, std::numbers::pi), 0.0,
        5e-3);
    const core::Measured& radius = result.first.contact.radius_angle_rad;
    EXPECT_GE(radius->value, 0.0);
    EXPECT_LE(radius->value, 90.0_deg);
  }
}

// The same body, which came down long before it was filmed.
Throw SlidingFromTheStart(Throw thrown) {
  thrown.contact_s = -1.0;
  thrown.x_m = -1.2;
  thrown.after = {1.2, 0.0, 0.0};
  thrown.stays = true;
  return thrown;
}

TEST(Contact, OnTheGroundFromTheStart) {
  for (const auto kind :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    const Throw thrown = SlidingFromTheStart(
        kind == core::BodyKind::kSphere ? Throw{} : Block(0.0));
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Filming filming;
      filming.seed = seed;
      const ContactResult result =
          FindContacts(FilmPlane(thrown, filming), WithScale(filming));
      ExpectFinite(result);
      const core::Contact& contact = result.first.contact;
      ASSERT_TRUE(contact.found);
      EXPECT_TRUE(contact.from_start);
      EXPECT_FALSE(contact.time_s);
      EXPECT_THAT(contact.time_s.error().reason, HasSubstr("from the start"));
      EXPECT_EQ(contact.approach_angle_rad->value, 0.0);
      EXPECT_TRUE(core::IsNotBounce(result.first.state.label));
      EXPECT_NEAR(result.first.motion.before_tangential_mps->value, 1.2,
                  4.0 * result.first.motion.before_tangential_mps->u);
      if (kind == core::BodyKind::kRectangle) {
        EXPECT_EQ(result.first.state.label, MotionState::kSlide);
      }
    }
  }
}

// A block that slides on a corner and tips onto its face: it came down before
// it was filmed, at angles that nobody saw.
TEST(Contact, WhatTurnsWhileItIsDownHasNoAngleOfItsTouchdown) {
  const Throw thrown = SlidingFromTheStart(Block(0.0));
  Filming filming;
  PlaneTrack track = FilmPlane(thrown, filming);
  const auto n = static_cast<double>(track.samples.size());
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    PlaneSample& sample = track.samples[i];
    sample.face_rad = (8.0 - 6.0 * static_cast<double>(i) / n) * core::kDegree;
    const double noise_px = sample.gap_px;
    sample.height_px = SupportHeight(track, sample.face_rad) + noise_px;
  }
  const ContactResult result = FindContacts(track, WithScale(filming));
  const core::Contact& contact = result.first.contact;
  ASSERT_TRUE(contact.found) << contact.reason;
  ASSERT_TRUE(contact.from_start);
  for (const core::Measured* angle :
       {&contact.approach_angle_rad, &contact.radius_angle_rad,
        &contact.face_angle_rad, &result.first.motion.before_speed_mps}) {
    ASSERT_FALSE(*angle);
    EXPECT_THAT(angle->error().reason, HasSubstr("was not filmed"));
  }
  EXPECT_TRUE(core::IsNotBounce(result.first.state.label));
}

// Carried near the ground at first, and set down in a motion that is no flight:
// no line of the ground is so far off that it was down from the start.
TEST(Contact, WhatComesDownLaterIsNotDownFromTheStart) {
  const Throw thrown = SlidingFromTheStart(Block(0.0));
  Filming filming;
  PlaneTrack track = FilmPlane(thrown, filming);
  // Poses that follow the pixels' rows: in steps, which no flight has.
  constexpr double kCarried_px = 2.5;
  constexpr double kStep_px = 0.5;
  ASSERT_LT(kCarried_px, 0.3 * track.half_short_px);
  const std::size_t n = track.samples.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(n);
    const double fallen = std::clamp(2.0 - 3.0 * share, 0.0, 1.0);
    PlaneSample& sample = track.samples[i];
    sample.height_px -= sample.gap_px;
    sample.gap_px = kStep_px * std::round(kCarried_px * fallen / kStep_px);
    sample.height_px += sample.gap_px;
    sample.u_gap_px = sample.u_height_px = sample.u_along_px = 0.01;
  }
  const ContactResult result = FindContacts(track, WithScale(filming));
  EXPECT_FALSE(result.first.contact.found);
  EXPECT_THAT(result.first.contact.reason, HasSubstr("comes down by 2.5 px"));
}

// On an incline a spring turns it round each time it comes down; the line is
// inclined to its path by what changes its gap by half a pixel, and that is
// known to a hundredth.
TEST(Contact, CarriedToAndFroFromTheStart) {
  const Throw thrown = SlidingFromTheStart(Block(0.0));
  Filming filming;
  PlaneTrack track = FilmPlane(thrown, filming);
  ASSERT_GE(track.samples.size(), 30u);
  const auto n = static_cast<double>(track.samples.size());
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    PlaneSample& sample = track.samples[i];
    const double share = static_cast<double>(i) / n;
    const double way = std::fmod(3.0 * share, 1.0);  // of three
    sample.along_px = 800.0 * way * (1.0 - way);
    sample.height_px -= sample.gap_px;
    sample.gap_px = 0.5 * (1.0 - 4.0 * way * (1.0 - way));
    sample.height_px += sample.gap_px;
    sample.u_gap_px = sample.u_height_px = sample.u_along_px = 0.01;
  }
  const ContactResult result = FindContacts(track, WithScale(filming));
  ASSERT_TRUE(result.first.contact.found) << result.first.contact.reason;
  EXPECT_TRUE(result.first.contact.from_start);
  EXPECT_TRUE(core::IsNotBounce(result.first.state.label));
}

TEST(Contact, NoneWhereTheGroundLineLiesAboveTheBody) {
  Throw thrown;
  Filming filming;
  PlaneTrack track = FilmPlane(thrown, filming);
  for (auto& sample : track.samples) {
    sample.gap_px -= 1000.0;
    sample.height_px -= 1000.0;
  }
  const ContactResult result = FindContacts(track, WithScale(filming));
  ExpectFinite(result);
  EXPECT_FALSE(result.first.contact.found);
  EXPECT_THAT(result.first.contact.reason, HasSubstr("below the ground line"));
}

TEST(Contact, NoneWhereTheClipEndsBefore) {
  Throw thrown;
  Filming filming;
  filming.frames = 25;  // contact at frame 30.2
  const ContactResult result =
      FindContacts(FilmPlane(thrown, filming), WithScale(filming));
  ExpectFinite(result);
  EXPECT_FALSE(result.first.contact.found);
  EXPECT_THAT(result.first.contact.reason, HasSubstr("never reaches zero"));
  EXPECT_EQ(result.first.state.label, MotionState::kUndecided);
  EXPECT_FALSE(result.first.state.p_bounce);
  EXPECT_TRUE(result.later.empty());
}

TEST(Contact, NoneWhereTheBodyPassesHigh) {
  Throw thrown;
  Filming filming;
  const Track track = synthetic::FilmTrack(
      thrown,
      [](double t) {
        return ScenePose{{t, 0.1 + t - 4.9 * t * t}};
      },
      filming);
  const ContactResult result =
      FindContacts(SeenFromGround(track, synthetic::FilmGround(filming)),
                   WithScale(filming));
  EXPECT_FALSE(result.first.contact.found);
  EXPECT_FALSE(result.first.contact.reason.empty());
}

// The last frame is the one before, at, or just after touchdown: a contact with
// angle and time, but nothing of a rebound.
TEST(Contact, AtTheLastFrame) {
  Throw thrown;  // frame 30.24
  for (const int frames : {31, 32}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Filming filming;
      filming.frames = frames;
      filming.seed = seed;
      const ContactResult result =
          FindContacts(FilmPlane(thrown, filming), WithScale(filming));
      ExpectFinite(result);
      SCOPED_TRACE(frames);
      ASSERT_TRUE(result.first.contact.found) << result.first.contact.reason;
      const auto numbers = Numbers(result.first);
      EXPECT_NEAR(numbers.at("time").value, thrown.contact_s,
                  4.2 * numbers.at("time").u);
      EXPECT_NEAR(numbers.at("approach").value, thrown.ContactAngle(),
                  4.2 * numbers.at("approach").u);
      EXPECT_EQ(result.first.state.label, MotionState::kUndecided);
      EXPECT_FALSE(result.first.state.p_bounce);
      EXPECT_THAT(result.first.state.reason,
                  HasSubstr("no rebound was filmed"));
    }
  }
}

// Bounce after bounce, e = 0.7: each with its own time and restitution.
TEST(Contact, SeveralContacts) {
  Filming filming;
  filming.camera.fps = 500.0;
  filming.frames = 320;
  Throw thrown;
  const double e = 0.7;
  const double vx = 0.3;
  struct Hop {
    double at_s, vy;  // of the rebound
  };
  std::vector<Hop> hops;
  double at = 0.1037;
  double vy = 1.1;
  const double g = thrown.gravity_mps2;
  while (at < 0.5) {
    hops.push_back({at, e * vy});
    vy *= e;
    at += 2.0 * vy / g;
  }
  const auto motion = [&](double t) {
    const Hop* last = nullptr;
    for (const Hop& hop : hops) {
      if (t >= hop.at_s) last = &hop;
    }
    const double s = t - (last ? last->at_s : hops[0].at_s);
    const double v = last ? last->vy : -1.1;
    return ScenePose{{vx * t, 0.02 + v * s - 0.5 * g * s * s}, 0.0};
  };
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    filming.seed = seed;
    const Track track = synthetic::FilmTrack(thrown, motion, filming);
    const ContactResult result =
        FindContacts(SeenFromGround(track, synthetic::FilmGround(filming)),
                     WithScale(filming));
    ExpectFinite(result);
    ASSERT_TRUE(result.first.contact.found);
    EXPECT_EQ(result.evidence.size(), 1 + result.later.size());
    ASSERT_GE(result.later.size(), 3u);
    std::vector<core::ContactRecord> records = {result.first};
    records.insert(records.end(), result.later.begin(), result.later.end());
    for (std::size_t i = 0; i < std::min<std::size_t>(4, records.size()); ++i) {
      const auto numbers = Numbers(records[i]);
      EXPECT_NEAR(numbers.at("time").value, hops[i].at_s,
                  4.2 * numbers.at("time").u)
          << i;
      EXPECT_NEAR(numbers.at("e").value, e, 4.2 * numbers.at("e").u) << i;
      EXPECT_NEAR(numbers.at("approach").value, std::atan2(hops[i].vy / e, vx),
                  4.2 * numbers.at("approach").u)
          << i;
    }
    EXPECT_EQ(result.first.state.label, MotionState::kBounce);
    const auto greatest = hops[0].vy * hops[0].vy / (2.0 * g);
    EXPECT_NEAR(result.first.state.max_gap_m->value, greatest,
                4.2 * result.first.state.max_gap_m->u + 1e-5);
  }
}

// The state against the closed form: the rise v'^2 / 2g on either side of the
// bounce height.
TEST(Contact, StateByTheRise) {
  const double g = core::kStandardGravity_mps2;
  for (const double rise_mm : {0.2, 0.4, 1.2, 2.4}) {
    Throw thrown;
    thrown.before = {1.4, -0.5, 0.0};
    thrown.after = {1.3, std::sqrt(2.0 * g * rise_mm * 1e-3), 0.0};
    Filming filming;
    // Until it is down again: 0.8 mm is the bounce height of 40 mm.
    const double back_s = 2.0 * thrown.after.vy / g;
    filming.frames = static_cast<int>((thrown.contact_s + back_s) * 2000.0) - 1;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      filming.seed = seed;
      const ContactResult result =
          FindContacts(FilmPlane(thrown, filming), WithScale(filming));
      const core::StateDecision& state = result.first.state;
      SCOPED_TRACE(rise_mm);
      ASSERT_TRUE(state.max_gap_m) << state.reason;
      EXPECT_NEAR(state.max_gap_m->value, rise_mm * 1e-3,
                  4.2 * state.max_gap_m->u);
      EXPECT_NEAR(state.bounce_height_m->value, 0.8e-3, 2e-6);
      EXPECT_EQ(state.label,
                rise_mm > 0.8 ? MotionState::kBounce : MotionState::kStaysDown);
      EXPECT_EQ(state.micro_bounce, rise_mm < 0.8);
    }
  }
}

TEST(Contact, BounceHeightIsTheCampaigns) {
  Throw thrown;
  thrown.after = {1.3, 0.3, 0.0};  // rises by 4.6 mm
  Filming filming;
  filming.frames = 130;
  ContactOptions options = WithScale(filming);
  options.bounce_height_m = 0.02;
  const ContactResult result =
      FindContacts(FilmPlane(thrown, filming), options);
  EXPECT_EQ(result.first.state.bounce_height_m->value, 0.02);
  EXPECT_EQ(result.first.state.label, MotionState::kStaysDown);
  EXPECT_TRUE(result.first.state.micro_bounce);
}

TEST(Contact, ClipThatEndsWhileItRisesIsUndecided) {
  Throw thrown;
  thrown.after = {1.3, 0.15, 0.0};  // 1.15 mm at last, 31 frames after contact
  Filming filming;
  filming.frames = 30 + 8;  // it has risen by half a millimetre
  const ContactResult result =
      FindContacts(FilmPlane(thrown, filming), WithScale(filming));
  EXPECT_EQ(result.first.state.label, MotionState::kUndecided);
  EXPECT_THAT(result.first.state.reason, HasSubstr("still rises"));
}

// Without a scale: angles, times and ratios as with one, lengths absent.
TEST(Contact, WithoutAScale) {
  Throw thrown;
  std::vector<double> z_time, z_angle, z_e;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Filming filming;
    filming.seed = seed;
    const ContactResult result = FindContacts(FilmPlane(thrown, filming), {});
    ExpectFinite(result);
    ASSERT_TRUE(result.first.contact.found);
    const auto n = Numbers(result.first);
    for (const char* name : {"speed", "vn", "vt", "vn'", "vt'", "gravity",
                             "max gap", "bounce height", "detectable gap"}) {
      EXPECT_FALSE(n.contains(name)) << name;
    }
    EXPECT_THAT(result.first.motion.before_speed_mps.error().reason,
                HasSubstr("no scale"));
    EXPECT_EQ(result.first.state.label, MotionState::kBounce);
    z_time.push_back((n.at("time").value - thrown.contact_s) / n.at("time").u);
    z_angle.push_back((n.at("approach").value - thrown.ContactAngle()) /
                      n.at("approach").u);
    z_e.push_back((n.at("e").value - 0.5) / n.at("e").u);
  }
  for (const auto& z : {z_time, z_angle, z_e}) {
    EXPECT_LT(Rms(z), RmsBand9999(60).high);
    EXPECT_GT(Rms(z), 0.7 * RmsBand9999(60).low);
  }
}

// A line that is not the ground: the body turns back well above it.
TEST(Contact, LineThatIsNotTheGroundIsRefuted) {
  Throw thrown;
  Filming filming;
  for (const double lower_px : {8.0, 40.0}) {
    Filming wrong = filming;
    wrong.camera.ground_point.y_px += lower_px;
    const Track track = synthetic::FilmTrack(
        thrown, [&](double t) { return thrown.At(t); }, filming);
    const PlaneTrack plane =
        SeenFromGround(track, synthetic::FilmGround(wrong));
    const ContactResult result = FindContacts(plane, WithScale(filming));
    EXPECT_FALSE(result.ground_refuted.empty()) << lower_px;
    ExpectFinite(result);
  }
  const ContactResult right =
      FindContacts(FilmPlane(thrown, filming), WithScale(filming));
  EXPECT_TRUE(right.ground_refuted.empty()) << right.ground_refuted;
}

}  // namespace
}  // namespace touchdown::vision
