// Contacts do not depend on where the picture's origin, the clock's zero or the
// units lie, and few or missing frames cost certainty, never honesty.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/statistics.h"
#include "tests/vision/contact_sweep.h"
#include "tests/vision/synthetic_track.h"
#include "touchdown/vision/contact/contact.h"

namespace touchdown::vision {
namespace {

using core::MotionState;
using synthetic::Block;
using synthetic::ExpectFinite;
using synthetic::Filming;
using synthetic::FilmPlane;
using synthetic::Numbers;
using synthetic::Rebound;
using synthetic::Throw;
using synthetic::WithScale;
using ::testing::HasSubstr;
using touchdown::testing::Rms;
using touchdown::testing::RmsBand9999;

struct Filmed {
  Filming filming;
  Track track;
  calib::GroundLine ground;

  std::map<std::string, core::Estimate> Measure() const {
    return Numbers(
        FindContacts(SeenFromGround(track, ground), WithScale(filming)).first);
  }
};

// A sphere, or a block on its corner, that bounces within 42 frames.
Throw Bouncing(bool rectangle) {
  Throw thrown = rectangle ? Block(0.3) : Throw{};
  thrown.before = {1.2, -0.9, rectangle ? 5.0 : 0.0};
  thrown.after = {1.0, 0.45, 0.0};
  if (rectangle) Rebound(thrown, 0.5);
  return thrown;
}

Filmed FilmBouncing(bool rectangle) {
  const Throw thrown = Bouncing(rectangle);
  Filmed filmed;
  filmed.filming.frames = 42;
  filmed.track = synthetic::FilmTrack(
      thrown, [&](double t) { return thrown.At(t); }, filmed.filming);
  filmed.ground = synthetic::FilmGround(filmed.filming);
  return filmed;
}

// DESIGN.md section 5: the same answer wherever the picture's origin lies.
TEST(ContactInvariance, OriginFarAway) {
  for (const bool rectangle : {false, true}) {
    const Filmed filmed = FilmBouncing(rectangle);
    const auto reference = filmed.Measure();
    for (const double far : {1e3, 1e6}) {
      Filmed moved = filmed;
      for (Pose& pose : moved.track.poses) {
        pose.centre.x_px += far;
        pose.centre.y_px -= far;
      }
      calib::GroundLine& line = moved.ground;
      for (core::PixelPoint* p : {&line.p1, &line.p2, &line.reference}) {
        p->x_px += far;
        p->y_px -= far;
      }
      const auto shifted = moved.Measure();
      ASSERT_EQ(reference.size(), shifted.size());
      for (const auto& [name, e] : reference) {
        EXPECT_NEAR(shifted.at(name).value, e.value, 1e-3 * e.u + 1e-9) << name;
        EXPECT_NEAR(shifted.at(name).u, e.u, 1e-3 * e.u + 1e-9) << name;
      }
    }
  }
}

TEST(ContactInvariance, MirroredThrowIsTheSame) {
  for (const bool rectangle : {false, true}) {
    Filmed filmed = FilmBouncing(rectangle);
    const auto reference = filmed.Measure();
    for (Pose& pose : filmed.track.poses) {
      pose.centre.x_px = 640.0 - pose.centre.x_px;
      pose.angle_rad = -pose.angle_rad;
      pose.correlation_xy = -pose.correlation_xy;
    }
    calib::GroundLine& line = filmed.ground;
    std::swap(line.p1, line.p2);
    for (core::PixelPoint* p : {&line.p1, &line.p2, &line.reference}) {
      p->x_px = 640.0 - p->x_px;
    }
    const auto mirrored = filmed.Measure();
    ASSERT_EQ(reference.size(), mirrored.size());
    for (const auto& [name, e] : reference) {
      EXPECT_NEAR(mirrored.at(name).value, e.value, 1e-3 * e.u + 1e-9) << name;
    }
  }
}

// Seconds or hours into the recording, and whatever the unit of time.
TEST(ContactInvariance, ClockChangesNothing) {
  Throw thrown;
  Filming filming;
  const PlaneTrack plane = FilmPlane(thrown, filming);
  const auto reference = Numbers(FindContacts(plane, WithScale(filming)).first);
  PlaneTrack late = plane;
  for (PlaneSample& s : late.samples) s.time_s += 1e3;
  const auto shifted = Numbers(FindContacts(late, WithScale(filming)).first);
  for (const auto& [name, e] : reference) {
    const double offset = name == "time" ? 1e3 : 0.0;
    EXPECT_NEAR(shifted.at(name).value - offset, e.value, 1e-3 * e.u + 1e-9)
        << name;
  }
}

// Slow-motion cameras and far ones: time and length by any factor.
TEST(ContactInvariance, ScaledTimeAndLength) {
  Throw thrown;
  Filming filming;
  const PlaneTrack plane = FilmPlane(thrown, filming);
  const auto reference = Numbers(FindContacts(plane, {}).first);
  for (const double time : {1e-3, 1e3}) {
    PlaneTrack scaled = plane;
    scaled.frame_interval_s *= time;
    for (PlaneSample& s : scaled.samples) s.time_s *= time;
    const auto numbers = Numbers(FindContacts(scaled, {}).first);
    for (const char* name : {"frame", "approach", "e", "centre ratio"}) {
      EXPECT_NEAR(numbers.at(name).value, reference.at(name).value,
                  1e-3 * reference.at(name).u)
          << name << " " << time;
    }
    EXPECT_NEAR(numbers.at("time").value / time, reference.at("time").value,
                1e-3 * reference.at("time").u);
  }
}

// Few frames on either side, contact near the first and the last frame: a
// number with an honest u, or a reason; never NaN.
TEST(ContactFewFrames, FewFramesOnEitherSide) {
  int found = 0;
  std::vector<double> z;
  for (int before = 1; before <= 9; ++before) {
    for (int after = 0; after <= 9; ++after) {
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        for (const bool rectangle : {false, true}) {
          Throw thrown = rectangle ? Block(0.35) : Throw{};
          thrown.before = {1.2, -0.9, 0.0};
          thrown.after = {1.0, 0.45, 0.0};
          if (rectangle) Rebound(thrown, 0.5);
          Filming filming;
          filming.seed = seed;
          thrown.contact_s = (before - 0.6) / 2000.0;
          filming.frames = before + after;
          const ContactResult result =
              FindContacts(FilmPlane(thrown, filming), WithScale(filming));
          SCOPED_TRACE(before);
          SCOPED_TRACE(after);
          ExpectFinite(result);
          if (!result.first.contact.found || result.first.contact.from_start) {
            continue;
          }
          const auto n = Numbers(result.first);
          ++found;
          z.push_back((n.at("approach").value - thrown.ContactAngle()) /
                      n.at("approach").u);
          EXPECT_LT(std::abs(z.back()), 5.0)
              << n.at("approach").value << " +- " << n.at("approach").u;
          EXPECT_LT(std::abs(n.at("time").value - thrown.contact_s),
                    5.0 * n.at("time").u);
          if (after < 3) {
            EXPECT_EQ(result.first.state.label, MotionState::kUndecided);
          }
        }
      }
    }
  }
  EXPECT_GT(found, 200);
  EXPECT_LT(Rms(z), 1.2);
}

TEST(ContactFewFrames, TooFewFramesIsSaid) {
  Filming filming;
  for (int frames = 0; frames < 5; ++frames) {
    filming.frames = frames;
    const ContactResult result =
        FindContacts(FilmPlane(Throw{}, filming), WithScale(filming));
    EXPECT_FALSE(result.first.contact.found);
    EXPECT_THAT(result.first.contact.reason, HasSubstr("frames"));
  }
}

// Frames that the tracker lost, also at the contact itself.
TEST(ContactFewFrames, MissingFrames) {
  Throw thrown;
  std::vector<double> z;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Filming filming;
    filming.seed = seed;
    PlaneTrack plane = FilmPlane(thrown, filming);
    std::erase_if(plane.samples, [&](const PlaneSample& s) {
      return (s.frame >= 29 && s.frame <= 32) ||
             (s.frame + static_cast<std::int64_t>(seed)) % 7 == 0;
    });
    const ContactResult result = FindContacts(plane, WithScale(filming));
    ExpectFinite(result);
    ASSERT_TRUE(result.first.contact.found);
    const auto n = Numbers(result.first);
    EXPECT_NEAR(n.at("time").value, thrown.contact_s, 4.2 * n.at("time").u);
    z.push_back((n.at("approach").value - thrown.ContactAngle()) /
                n.at("approach").u);
  }
  EXPECT_LT(Rms(z), RmsBand9999(30).high);
}

}  // namespace
}  // namespace touchdown::vision
