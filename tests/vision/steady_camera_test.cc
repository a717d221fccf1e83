#include "touchdown/vision/background/steady_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/pipeline/filmed.h"
#include "tests/pipeline/shaken.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision {
namespace {

using pipeline::filmed::BuildScene;
using pipeline::filmed::ByHand;
using pipeline::filmed::Default;
using pipeline::filmed::Film;
using pipeline::filmed::Shake;
using pipeline::filmed::ShakenClip;

// A sphere above ground with grains that can be seen.
Film OverGrains() {
  Film film = Default(core::BodyKind::kSphere);
  film.look.texture_amplitude = 0.2;
  return film;
}

// The farthest that any corner of the picture goes, px.
double FarthestByHand(std::int64_t frames) {
  double farthest = 0.0;
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    const Shake at = ByHand(frame);
    farthest = std::max(farthest, 0.25 * std::hypot(at.x, at.y));
  }
  return farthest;
}

// Root mean square difference of the ground's grains between frame 0 and
// another, of full scale.
double DifferenceOfGround(Clip& clip, std::int64_t index) {
  const core::PixelRect ground = {10, 100, 60, 12};
  std::vector<double> levels;
  for (const std::int64_t i : {std::int64_t{0}, index}) {
    const core::Frame frame = clip.Read(i, ground);
    for (std::int32_t y = 0; y < ground.height; ++y) {
      for (std::int32_t x = 0; x < ground.width; ++x) {
        levels.push_back(static_cast<double>(frame.at(x, y)) /
                         static_cast<double>(frame.full_scale()));
      }
    }
  }
  const std::size_t half = levels.size() / 2;
  double square = 0.0;
  for (std::size_t i = 0; i < half; ++i) {
    square += std::pow(levels[half + i] - levels[i], 2);
  }
  return std::sqrt(square / static_cast<double>(half));
}

CameraMotion MotionOf(Clip& clip, const SteadyCameraOptions& options = {}) {
  return MeasureCameraMotion(clip, 0, clip.info().frames, options);
}

// What a camera sees that is carried through a scene: bands of rows that lie at
// different depths go different ways. For some frames it is only turned, and
// all go one way.
class ManyDepths final : public Clip {
 public:
  explicit ManyDepths(const Film& film) {
    for (const std::int32_t way : {2, -1, 3, -2, 1, -3}) {
      bands_.push_back(
          std::make_unique<ShakenClip>(film, [way](std::int64_t frame) {
            const auto at = static_cast<std::int32_t>(frame);
            return Shake{at < 4 ? at : way * std::min(at, 12), 0};
          }));
    }
  }

  const ClipInfo& info() const override { return bands_.front()->info(); }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    samples_.clear();
    core::Frame frame;
    const auto bands = static_cast<std::int32_t>(bands_.size());
    for (std::int32_t y = window.y; y < window.y + window.height; ++y) {
      const std::int32_t band = bands * y / info().height_px;
      frame = bands_[static_cast<std::size_t>(band)]->Read(
          index, {window.x, y, window.width, 1});
      for (std::int32_t x = 0; x < window.width; ++x) {
        samples_.push_back(static_cast<std::uint16_t>(frame.at(x, 0)));
      }
    }
    frame.height_px = window.height;
    frame.data = reinterpret_cast<const std::byte*>(samples_.data());
    frame.stride_bytes = 2 * static_cast<std::ptrdiff_t>(window.width);
    return frame;
  }

  std::vector<std::unique_ptr<ShakenClip>> bands_;
  std::vector<std::uint16_t> samples_;
};

TEST(SteadyCamera, ParallaxIsToldAndNotTakenOut) {
  Film film = OverGrains();
  film.frames = 24;
  film.camera.ground_point.y_px = 10.0;  // nearly all of the picture has grains
  ManyDepths clip(film);
  const CameraMotion camera = MotionOf(clip);
  EXPECT_FALSE(camera.most_moved_px);
  EXPECT_TRUE(camera.of.empty());
  EXPECT_TRUE(camera.unexplained);
}

TEST(SteadyCamera, MotionOfTheCameraIsTakenOut) {
  const Film film = OverGrains();
  ShakenClip shaken(film, ByHand);
  const CameraMotion camera = MotionOf(shaken);
  const auto steady =
      PutBack(std::make_unique<ShakenClip>(film, ByHand), camera);
  ASSERT_TRUE(camera.most_moved_px);
  EXPECT_FALSE(camera.unexplained);
  EXPECT_NEAR(camera.most_moved_px->value, FarthestByHand(film.frames),
              4.0 * camera.most_moved_px->u);
  EXPECT_LT(camera.most_moved_px->u, 0.1);
  const double noise = std::sqrt(2.0) * film.noise;
  for (const std::int64_t index : {20, 45, 70, 110}) {
    SCOPED_TRACE(index);
    EXPECT_GT(DifferenceOfGround(shaken, index), 5.0 * noise);
    EXPECT_LT(DifferenceOfGround(*steady, index), 1.3 * noise);
  }
}

// Whatever the noise, and whatever the body does.
TEST(SteadyCamera, AStillCameraIsLeftAlone) {
  for (const double noise : {0.0, 0.006, 0.03}) {
    for (const auto kind :
         {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
      SCOPED_TRACE(noise);
      Film film = Default(kind);
      film.look.texture_amplitude = 0.2;
      film.noise = noise;
      auto clip = OpenScene(BuildScene(film), 1);
      const Clip* const given = clip.get();
      const CameraMotion camera = MotionOf(*clip);
      EXPECT_FALSE(camera.most_moved_px) << camera.most_moved_px->value;
      EXPECT_FALSE(camera.unexplained);
      EXPECT_EQ(PutBack(std::move(clip), camera).get(), given);
    }
  }
}

// A block that slides along the edge of a plain ground before a plain wall is
// all that has any gradient across its way. Origin: a clip of the strangers'
// generator (seed 76, scene 0).
TEST(SteadyCamera, ABodyAlongAnEdgeIsNoCamera) {
  Film film = Default(core::BodyKind::kRectangle);
  film.thrown.face_rad = 0.0;
  film.thrown.before = film.thrown.after = {1.0, 0.0, 0.0};
  film.contact_frame = 0.0;
  film.lead_in = 0;
  film.frames = 90;
  film.noise = 0.016;
  film.camera.ground_point.x_px = 60.0;
  film.look.texture_amplitude = 0.0;
  film.look.body_level = 0.95;
  film.look.background_level = 0.3;
  film.look.ground_level = 0.5;
  const auto clip = OpenScene(BuildScene(film), 1);
  const CameraMotion camera = MotionOf(*clip);
  EXPECT_FALSE(camera.most_moved_px) << camera.most_moved_px->value;
  EXPECT_FALSE(camera.unexplained);
  // It is the parts at rest that say so.
  SteadyCameraOptions blind;
  blind.least_support = blind.least_support_of_third = 0.0;
  blind.most_moved = 1.0;
  EXPECT_TRUE(MotionOf(*clip, blind).most_moved_px);
}

TEST(SteadyCamera, AWindowIsAPartOfTheWhole) {
  const Film film = OverGrains();
  auto shaken = std::make_unique<ShakenClip>(film, ByHand);
  const CameraMotion camera = MotionOf(*shaken);
  ASSERT_TRUE(camera.most_moved_px);
  const auto steady = PutBack(std::move(shaken), camera);
  EXPECT_EQ(steady->info().bit_depth, 16);
  const std::uint32_t whole = steady->Read(60).at(100, 105);
  EXPECT_EQ(steady->Read(60, {90, 100, 20, 10}).at(10, 5), whole);
}

TEST(SteadyCamera, RefusesARangeOutsideTheClip) {
  const Film film = OverGrains();
  const auto clip = OpenScene(BuildScene(film), 1);
  EXPECT_THROW(MeasureCameraMotion(*clip, 0, film.frames + 1),
               std::invalid_argument);
  EXPECT_THROW(MeasureCameraMotion(*clip, 5, 5), std::invalid_argument);
  EXPECT_THROW(MeasureCameraMotion(*clip, -1, 5), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::vision
