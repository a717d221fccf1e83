// Bodies that are not much wider than the picture's blur.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/pipeline/filmed.h"
#include "tests/vision/synthetic_track.h"
#include "touchdown/vision/synthetic/render.h"
#include "touchdown/vision/tracking/tracker.h"
#include "vision/src/outline/body_cover.h"

namespace touchdown::vision {
namespace {

using pipeline::filmed::Film;

// A dark block of 24 px by twice `half_short_px`, in a blur of 4 px.
Film Blurred(double half_short_px) {
  Film film = pipeline::filmed::Default(core::BodyKind::kRectangle);
  film.camera.psf_sigma_px = 4.0;
  film.camera.fps = 600.0;
  film.thrown.half_long_m = 0.012;
  film.thrown.half_short_m = 1e-3 * half_short_px;
  film.look.background_level = 0.7;
  film.look.body_level = 0.2;
  film.look.ground_level = 0.4;
  film.look.texture_amplitude = 0.0;
  film.noise = 0.008;
  film.lead_in = 24;
  film.contact_frame = 44.3;
  film.frames = 49;
  return film;
}

// The blur leaves it less than half of its contrast: an empty frame is empty
// all the same.
TEST(NarrowBody, IsSeenToBeAway) {
  Film film = Blurred(3.0);
  const auto clip = OpenScene(pipeline::filmed::BuildScene(film), 1);
  synthetic::Filming filming;
  filming.camera = film.camera;
  filming.frames = static_cast<int>(film.frames);
  filming.noise = false;
  film.thrown.contact_s = film.contact_frame / film.camera.fps;
  Track track = synthetic::FilmTrack(
      film.thrown, [&](double t) { return film.thrown.At(t); }, filming);
  track.body.blur_px = film.camera.psf_sigma_px;
  track.body.contrast_dn = -0.5 * 255.0;
  std::erase_if(track.poses,
                [&](const Pose& pose) { return pose.frame < film.lead_in; });
  const BodyCover cover(*clip, track);
  for (std::int64_t frame = 0; frame < film.lead_in; ++frame) {
    const Cover empty = cover.CoverInFrame(frame);
    EXPECT_TRUE(empty.known) << frame;
    EXPECT_EQ(empty.box.width, 0) << frame;
  }
  EXPECT_GT(cover.CoverInFrame(film.lead_in).box.width, 0);
}

// Its own ghost draws first fits far aside: with size, blur and shading all
// free most of them would be lost, and with them the way to a clean background.
TEST(NarrowBody, LeavesNoGhostInTheBackground) {
  Film film = Blurred(4.8);
  const auto clip = OpenScene(pipeline::filmed::BuildScene(film), 1);
  TrackOptions options;
  options.kind = core::BodyKind::kRectangle;
  const auto result = TrackBody(*clip, options);
  ASSERT_TRUE(result) << result.error().reason;
  EXPECT_GE(result->track.poses.size(), 22u);

  film.noise = 0.0;
  const auto clean = OpenScene(pipeline::filmed::BuildScene(film), 1);
  const core::Frame empty = clean->Read(0);
  const Background& background = result->background;
  int unknown = 0;
  double most = 0.0;
  for (std::int32_t y = 0; y < background.height_px; ++y) {
    for (std::int32_t x = 0; x < background.width_px; ++x) {
      unknown += background.known_at(x, y) ? 0 : 1;
      most = std::max(most, std::abs(static_cast<double>(background.at(x, y)) -
                                     empty.at(x, y)));
    }
  }
  EXPECT_EQ(unknown, 0);
  constexpr double kNoise_dn = 0.008 * 255.0;
  EXPECT_LT(most, 2.0 * kNoise_dn);
}

}  // namespace
}  // namespace touchdown::vision
