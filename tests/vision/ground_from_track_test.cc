// Ground lines that only the track tells. No pixel is needed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/statistics.h"
#include "tests/vision/synthetic_track.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/contact/contact.h"
#include "touchdown/vision/contact/supported_path.h"

namespace touchdown::vision {
namespace {

using synthetic::Filming;
using synthetic::Throw;
using touchdown::testing::Rms;
using touchdown::testing::RmsBand9999;

// What a ramp carries: it speeds up along its path, which tells where the ramp
// is. Flight, steady motion and a short way tell nothing.
TEST(GroundFromPath, OfWhatIsCarried) {
  const Throw body;
  for (const double slope_deg : {-50.0, -20.0, 0.0, 35.0, 60.0}) {
    SCOPED_TRACE(slope_deg);
    Filming filming;
    filming.camera.roll_rad = slope_deg * core::kDegree;
    const auto film = [&](double acceleration, double speed, double fall) {
      return synthetic::FilmTrack(
          body,
          [=](double t) {
            return ScenePose{{speed * t + 0.5 * acceleration * t * t - 0.2,
                              body.half_long_m - 0.5 * fall * t * t},
                             0.0};
          },
          filming);
    };
    filming.frames = 400;  // at 2000 a second
    const auto ground = GroundFromPath(film(4.0, 0.5, 0.0));
    ASSERT_TRUE(ground);
    EXPECT_EQ(ground->source, calib::GroundSource::kContactPoints);
    EXPECT_NEAR(calib::ImageAngle(*ground), filming.camera.roll_rad,
                4.0 * ground->u_angle_rad);
    EXPECT_NEAR(
        calib::HeightAboveLine(*ground, ToImage(filming.camera, {0.0, 0.0})),
        0.0, 4.0 * std::hypot(ground->u_offset_px, 0.003));
    EXPECT_LT(ground->u_angle_rad, 1e-3);
    EXPECT_FALSE(GroundFromPath(film(0.0, 1.0, 0.0))) << "steady";
    // Free flight, of which this slope takes its parts.
    const double g = core::kStandardGravity_mps2;
    EXPECT_FALSE(GroundFromPath(film(g * std::sin(filming.camera.roll_rad), 0.8,
                                     g * std::cos(filming.camera.roll_rad))))
        << "flight";
  }
  // Falling straight down is no wall's work.
  Filming filming;
  filming.frames = 400;
  EXPECT_FALSE(GroundFromPath(synthetic::FilmTrack(
      body,
      [](double t) {
        return ScenePose{{0.0, 0.3 - 4.9 * t * t}, 0.0};
      },
      filming)));
}

// No frame shows the body near the ground, on which it lay for a while: how
// long, and so how deep, nothing tells. The line says so, and the contact's
// time and the line hold the truth.
TEST(GroundFromContacts, IsKnownNoBetterThanTheWayThatWasNotSeen) {
  Throw thrown;
  thrown.before = {1.4, -2.0, 0.0};
  thrown.after = {-1.2, 1.0, 0.0};
  thrown.duration_s = 0.005;
  Filming filming;
  filming.frames = 80;
  Track track = synthetic::FilmTrack(
      thrown, [&](double t) { return thrown.At(t); }, filming);
  const double contact = thrown.contact_s * filming.camera.fps;
  const double release = contact + thrown.duration_s * filming.camera.fps;
  std::erase_if(track.poses, [&](const Pose& pose) {
    const auto frame = static_cast<double>(pose.frame);
    return frame > contact - 10.0 && frame < release + 5.0;
  });
  const auto ground = GroundFromContacts(track);
  ASSERT_TRUE(ground);
  const double truth_px = ToImage(filming.camera, {0.0, 0.0}).y_px;
  const double off_px = std::abs(ground->p1.y_px - truth_px);
  EXPECT_GT(ground->u_offset_px, 5.0);
  EXPECT_LT(off_px, 3.0 * ground->u_offset_px);
  const ContactResult found = FindContacts(SeenFromGround(track, *ground));
  ASSERT_TRUE(found.first.contact.frame) << found.first.contact.reason;
  EXPECT_LT(std::abs(found.first.contact.frame->value - contact),
            3.0 * found.first.contact.frame->u);
}

// Without any line: the ground through the lowest point at the first rebound.
TEST(GroundFromContacts, AtTheFirstRebound) {
  Throw thrown;
  std::vector<double> z;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Filming filming;
    filming.seed = seed;
    const Track track = synthetic::FilmTrack(
        thrown, [&](double t) { return thrown.At(t); }, filming);
    const auto ground = GroundFromContacts(track);
    ASSERT_TRUE(ground);
    EXPECT_EQ(ground->source, calib::GroundSource::kContactPoints);
    EXPECT_NEAR(calib::ImageAngle(*ground), 0.0, 1e-12);
    EXPECT_DOUBLE_EQ(ground->u_angle_rad, 0.5 * core::kDegree);
    z.push_back((ground->reference.y_px - 330.0) / ground->u_offset_px);
    EXPECT_LT(ground->u_offset_px, 1.0);
  }
  EXPECT_LT(Rms(z), RmsBand9999(30).high);
  // No rebound, no ground.
  Throw slides;
  slides.contact_s = -1.0;
  slides.after = {1.2, 0.0, 0.0};
  slides.stays = true;
  const Track flat = synthetic::FilmTrack(
      slides, [&](double t) { return slides.At(t); }, Filming{});
  EXPECT_FALSE(GroundFromContacts(flat));
}

// A sphere that hops along the ground `contacts` times and then falls past it,
// until `after_s` from there.
Track FilmHops(int contacts, double after_s) {
  constexpr double kRebound_mps = 0.6;
  constexpr double kBetween_s =
      2.0 * kRebound_mps / core::kStandardGravity_mps2;
  constexpr double kFirst_s = 0.05;
  Filming filming;
  filming.camera.fps = 500.0;
  const double edge_s = kFirst_s + contacts * kBetween_s;
  filming.frames = static_cast<int>(filming.camera.fps * (edge_s + after_s));
  return synthetic::FilmTrack(
      Throw{},
      [&](double t) {
        const double hop = std::clamp(std::floor((t - kFirst_s) / kBetween_s),
                                      -1.0, static_cast<double>(contacts - 1));
        const double s = t - kFirst_s - hop * kBetween_s;
        return ScenePose{
            {0.3 * t, 0.02 + kRebound_mps * s -
                          0.5 * core::kStandardGravity_mps2 * s * s},
            0.0};
      },
      filming);
}

// It falls off an edge later: then three contacts at one level tell the ground.
// A hand makes two.
TEST(GroundFromContacts, ThreeAtOneLevel) {
  const auto ground = GroundFromContacts(FilmHops(4, 0.1));
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->reference.y_px, 330.0, 4.0 * ground->u_offset_px);
  EXPECT_FALSE(GroundFromContacts(FilmHops(2, 0.1)));
}

// A line 1 px off is near enough for any one contact; three that agree refute
// it, two do not.
TEST(GroundRefuted, ByReboundsOffTheLine) {
  const auto refuted = [](int contacts, double off_px) {
    const double y_px = 330.0 + off_px;
    calib::GroundLine line = calib::MakeGroundLine({0.0, y_px}, {640.0, y_px});
    line.u_offset_px = 0.02;
    return FindContacts(SeenFromGround(FilmHops(contacts, -0.01), line))
        .ground_refuted;
  };
  EXPECT_EQ(refuted(4, 0.0), "");
  EXPECT_EQ(refuted(2, 1.0), "");
  EXPECT_EQ(refuted(4, 1.0),
            "4 of 4 rebounds are more than 4 standard deviations above the "
            "ground line");
  EXPECT_EQ(refuted(4, -1.0),
            "4 of 4 rebounds are more than 4 standard deviations below the "
            "ground line");
}

// Struck at the top of its first hop, in the air: that is told, and is no
// contact. Without the blow nothing is told.
TEST(Contact, ABlowInTheAirIsTold) {
  constexpr double kRebound_mps = 0.6;
  constexpr double kFirst_s = 0.05;
  constexpr double kTop_s =
      kFirst_s + kRebound_mps / core::kStandardGravity_mps2;
  Filming filming;
  filming.camera.fps = 500.0;
  filming.frames = 100;
  const auto warnings = [&](double blow_mps) {
    const auto motion = [=](double t) {
      const double s = t - kFirst_s;
      const double up = s < 0.0 ? -kRebound_mps : kRebound_mps;
      const double blow = std::max(0.0, t - kTop_s) * blow_mps;
      return ScenePose{{0.3 * t, 0.02 + up * s + blow -
                                     0.5 * core::kStandardGravity_mps2 * s * s},
                       0.0};
    };
    calib::GroundLine line =
        calib::MakeGroundLine({0.0, 330.0}, {640.0, 330.0});
    line.u_offset_px = 0.02;
    const ContactResult found = FindContacts(
        SeenFromGround(synthetic::FilmTrack(Throw{}, motion, filming), line));
    EXPECT_TRUE(found.first.contact.found) << found.first.contact.reason;
    return std::count_if(found.warnings.begin(), found.warnings.end(),
                         [](const std::string& warning) {
                           return warning.find("something struck it") !=
                                  std::string::npos;
                         });
  };
  EXPECT_EQ(warnings(0.0), 0);
  EXPECT_EQ(warnings(0.4), 1);
}

}  // namespace
}  // namespace touchdown::vision
