// The path of a body cut into flights, contacts and supported stretches.
#include "vision/src/contact/motion_segments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/vision/synthetic_track.h"

namespace touchdown::vision {
namespace {

using synthetic::Block;
using synthetic::Filming;
using synthetic::FilmPlane;
using synthetic::Rebound;
using synthetic::Throw;

SegmentationOptions OptionsFor(const Filming& filming) {
  SegmentationOptions options;
  options.gravity_px_per_s2 =
      core::kStandardGravity_mps2 * filming.camera.px_per_m;
  return options;
}

// The initials of the stretches' kinds, in order.
std::string KindsOf(const std::vector<Stretch>& stretches) {
  std::string kinds;
  for (const Stretch& s : stretches) {
    kinds += "fsco"[static_cast<int>(s.kind)];
  }
  return kinds;
}

std::string KindsOf(const PlaneTrack& track, const Filming& filming) {
  return KindsOf(SegmentMotion(track, OptionsFor(filming)).stretches);
}

// Heights as `gap` says, at a sphere's radius above the ground.
template <typename Gap>
PlaneTrack Moved(PlaneTrack track, const Gap& gap) {
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    PlaneSample& s = track.samples[i];
    const double is = gap(i, s);
    s.height_px += is - s.gap_px;
    s.gap_px = is;
  }
  return track;
}

TEST(MotionSegments, StretchesCoverTheTrackWithoutAGap) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Filming filming;
    filming.seed = seed;
    const PlaneTrack track = FilmPlane(Throw(), filming);
    std::size_t at = 0;
    for (const Stretch& s :
         SegmentMotion(track, OptionsFor(filming)).stretches) {
      EXPECT_EQ(s.begin, at);
      EXPECT_GT(s.end, s.begin);
      at = s.end;
    }
    EXPECT_EQ(at, track.samples.size());
  }
}

TEST(MotionSegments, BounceIsTwoFlights) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    for (const bool block : {false, true}) {
      Throw thrown = block ? Block(20.0 * core::kDegree) : Throw();
      if (block) Rebound(thrown, 0.6);
      Filming filming;
      filming.seed = seed;
      const PlaneTrack track = FilmPlane(thrown, filming);
      const auto stretches =
          SegmentMotion(track, OptionsFor(filming)).stretches;
      ASSERT_GE(stretches.size(), 2u);
      EXPECT_EQ(KindsOf(stretches).substr(0, 2), "ff") << seed;
      // The cut lies at the true instant.
      const double cut = 0.5 * (track.samples[stretches[0].end - 1].time_s +
                                track.samples[stretches[1].begin].time_s);
      EXPECT_NEAR(cut, thrown.contact_s, 1.01 / filming.camera.fps) << seed;
    }
  }
}

TEST(MotionSegments, SlideIsAFlightAndASupportedStretch) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Throw thrown = Block(0.0);
    thrown.stays = true;
    Filming filming;
    filming.seed = seed;
    EXPECT_EQ(KindsOf(FilmPlane(thrown, filming), filming), "fs") << seed;
  }
}

TEST(MotionSegments, DownFromTheStartIsOneSupportedStretch) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Throw thrown = Block(0.0);
    thrown.contact_s = -1.0;
    thrown.x_m = -1.2;
    thrown.after = {1.2, 0.0, 0.0};
    thrown.stays = true;
    Filming filming;
    filming.seed = seed;
    EXPECT_EQ(KindsOf(FilmPlane(thrown, filming), filming), "s") << seed;
  }
}

// Two frames in the air between two corners' impacts are a flight of their own.
TEST(MotionSegments, HopOfTwoFramesIsAFlight) {
  Filming filming;
  filming.camera.fps = 100.0;
  filming.frames = 40;
  Throw thrown;
  thrown.stays = true;
  thrown.contact_s = 20.5 / filming.camera.fps;
  // From frame 20.5 to 22.9 in the air.
  const double g = core::kStandardGravity_mps2 * filming.camera.px_per_m /
                   (filming.camera.fps * filming.camera.fps);
  const auto rise = [g](double frames) {
    return 0.5 * g * frames * (2.4 - frames);
  };
  const PlaneTrack track = Moved(
      FilmPlane(thrown, filming), [&](std::size_t i, const PlaneSample& s) {
        return s.gap_px + (i == 21 ? rise(0.5) : i == 22 ? rise(1.5) : 0.0);
      });
  const auto stretches = SegmentMotion(track, OptionsFor(filming)).stretches;
  ASSERT_EQ(KindsOf(stretches), "ffs");
  EXPECT_EQ(track.samples[stretches[1].begin].frame, 21);
  EXPECT_EQ(track.samples[stretches[1].end - 1].frame, 22);
}

// A soft body stays down for 13 frames: neither flight has them.
TEST(MotionSegments, SoftContactIsBetweenTwoFlights) {
  Filming filming;
  filming.camera.fps = 30000.0;
  filming.frames = 120;
  Throw thrown;
  thrown.before = {30.0, -20.0, 0.0};
  thrown.after = {27.0, 17.0, 0.0};
  thrown.contact_s = 40.3 / 30000.0;
  thrown.duration_s = 13.0 / 30000.0;
  const PlaneTrack track = FilmPlane(thrown, filming);
  const auto stretches = SegmentMotion(track, OptionsFor(filming)).stretches;
  ASSERT_GE(stretches.size(), 3u);
  EXPECT_EQ(stretches.front().kind, StretchKind::kFlight);
  EXPECT_EQ(stretches.back().kind, StretchKind::kFlight);
  EXPECT_NEAR(static_cast<double>(stretches.front().end), 41.0, 2.0);
  EXPECT_NEAR(static_cast<double>(stretches.back().begin), 54.0, 2.0);
  for (std::size_t k = 1; k + 1 < stretches.size(); ++k) {
    EXPECT_EQ(stretches[k].kind, StretchKind::kContact);
  }
}

// A hand holds it for a while: no contact with the ground.
TEST(MotionSegments, HeldBeforeItsFlightIsOther) {
  Filming filming;
  filming.frames = 80;
  Throw thrown;
  thrown.contact_s = 60.4 / filming.camera.fps;
  PlaneTrack track = FilmPlane(thrown, filming);
  const PlaneSample held = track.samples[30];
  for (std::size_t i = 0; i < 30; ++i) {
    PlaneSample& s = track.samples[i];
    const double wave = 3.0 * std::sin(0.2 * static_cast<double>(i));
    s.along_px = held.along_px + wave;
    s.gap_px = held.gap_px + wave;
    s.height_px = held.height_px + wave;
  }
  const auto stretches = SegmentMotion(track, OptionsFor(filming)).stretches;
  const std::string kinds = KindsOf(stretches);
  const std::size_t flight = kinds.find('f');
  ASSERT_NE(flight, std::string::npos);
  EXPECT_GT(flight, 0u);
  EXPECT_EQ(kinds.substr(0, flight), std::string(flight, 'o'));
  EXPECT_NEAR(static_cast<double>(stretches[flight].begin), 30.0, 3.0);
}

// Outlines that lie 0.06 px wrong beside the ground's edge are no impacts.
TEST(MotionSegments, BiasBesideTheGroundIsNoImpact) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Filming filming;
    filming.seed = seed;
    filming.u_px = 0.004;
    filming.u_ground_px = 0.003;
    Throw thrown;
    thrown.stays = true;
    thrown.contact_s = 30.4 / filming.camera.fps;
    const PlaneTrack track = Moved(
        FilmPlane(thrown, filming), [](std::size_t, const PlaneSample& s) {
          return s.gap_px + 0.06 * std::exp(-std::pow(s.gap_px / 2.0, 2));
        });
    EXPECT_EQ(KindsOf(track, filming), "fs") << seed;
  }
}

TEST(MotionSegments, NothingIsCutOutOfAnEmptyTrack) {
  EXPECT_TRUE(SegmentMotion(PlaneTrack{}).stretches.empty());
}

}  // namespace
}  // namespace touchdown::vision
