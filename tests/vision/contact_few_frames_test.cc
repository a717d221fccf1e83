// Contacts of tracks that have just enough frames, or too few: the answer is
// honest, or there is none.
#include <gtest/gtest.h>

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
using synthetic::ExpectFinite;
using synthetic::Filming;
using synthetic::FilmPlane;
using synthetic::Numbers;
using synthetic::Rebound;
using synthetic::Throw;
using synthetic::WithScale;

// 1.9 px a frame, at a noise of `u_px`.
Filming Slowly(int frames, double u_px) {
  Filming filming;
  filming.camera.fps = 800.0;
  filming.frames = frames;
  filming.u_px = u_px;
  filming.u_angle_rad = u_px / 30.0;
  filming.u_ground_px = u_px / 4.0;
  filming.u_ground_rad = u_px / 1000.0;
  return filming;
}

struct Shots {
  std::vector<double> z;  // of approach angle and time
  int absent = 0;
};

// Contact anywhere in the frame that follows the first `before` ones.
Shots ShootAfter(int before, Throw thrown, Filming filming) {
  constexpr int kShots = 200;
  constexpr double kGolden = 0.618034;
  Shots shots;
  for (int seed = 1; seed <= kShots; ++seed) {
    filming.seed = static_cast<std::uint64_t>(seed);
    thrown.contact_s =
        (before - 1 + std::fmod(kGolden * seed, 1.0)) / filming.camera.fps;
    const ContactResult result =
        FindContacts(FilmPlane(thrown, filming), WithScale(filming));
    ExpectFinite(result);
    const auto numbers = Numbers(result.first);
    // Of a body that is down from the start there is no time.
    if (!numbers.contains("approach") || !numbers.contains("time")) {
      ++shots.absent;
      continue;
    }
    const core::Estimate& angle = numbers.at("approach");
    const core::Estimate& time = numbers.at("time");
    shots.z.push_back((angle.value - thrown.ContactAngle()) / angle.u);
    shots.z.push_back((time.value - thrown.contact_s) / time.u);
  }
  return shots;
}

Throw ReboundingBlock() {
  Throw block = Block(20.0_deg);
  Rebound(block, 0.6);
  return block;
}

// Two frames before a rebound, with all that follows of it, are enough. Where
// the second one is so near the ground that it may be of either flight there is
// no answer: the more often, the coarser the poses.
TEST(ContactOfFewFrames, TwoBeforeARebound) {
  for (const double u_px : {0.004, 0.02}) {
    for (const int frames : {5, 6, 10, 20}) {
      for (const Throw& thrown : {Throw(), ReboundingBlock()}) {
        SCOPED_TRACE(::testing::Message() << u_px << " px, " << frames);
        const Shots shots = ShootAfter(2, thrown, Slowly(frames, u_px));
        EXPECT_LT(touchdown::testing::Rms(shots.z),
                  touchdown::testing::RmsBand9999(shots.z.size()).high);
        EXPECT_LT(touchdown::testing::Largest(shots.z), 6.0);
        EXPECT_LE(shots.absent, u_px < 0.01 ? 10 : 40);
      }
    }
  }
}

TEST(ContactOfFewFrames, ThreeBefore) {
  for (const double u_px : {0.004, 0.02}) {
    for (const int frames : {5, 7, 20}) {
      for (const Throw& thrown : {Throw(), ReboundingBlock()}) {
        SCOPED_TRACE(::testing::Message() << u_px << " px, " << frames);
        const Shots shots = ShootAfter(3, thrown, Slowly(frames, u_px));
        EXPECT_LT(touchdown::testing::Rms(shots.z),
                  touchdown::testing::RmsBand9999(shots.z.size()).high);
        EXPECT_EQ(shots.absent, 0);
      }
    }
  }
}

// Without a rebound nothing checks two frames.
TEST(ContactOfFewFrames, TwoBeforeItStaysDownAreTooFew) {
  Throw thrown;
  thrown.stays = true;
  for (const int frames : {5, 6, 10, 20}) {
    SCOPED_TRACE(frames);
    EXPECT_GE(ShootAfter(2, thrown, Slowly(frames, 0.004)).absent, 180);
  }
}

// Of a block whose first blow was missed the next one is not the first.
TEST(ContactOfFewFrames, OneBeforeIsTooFew) {
  for (const int frames : {5, 10, 20}) {
    for (const Throw& thrown : {Throw(), ReboundingBlock()}) {
      SCOPED_TRACE(frames);
      EXPECT_GE(ShootAfter(1, thrown, Slowly(frames, 0.004)).absent, 180);
    }
  }
}

}  // namespace
}  // namespace touchdown::vision
