// Frames that the camera dropped: what is measured is what was thrown.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <set>

#include "tests/pipeline/analyzed_film.h"
#include "tests/pipeline/filmed.h"
#include "tests/support/temporary_folder.h"
#include "tests/vision/cine_file.h"

namespace touchdown::pipeline {
namespace {

using filmed::Default;
using filmed::ExpectMeasured;
using filmed::Film;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using touchdown::testing::TemporaryFolder;

// The film as a .cine without some of its frames, with the camera's times.
vision::CineFile Without(const Film& film,
                         const std::set<std::int64_t>& dropped,
                         bool with_stamps) {
  const auto clip = vision::OpenScene(filmed::BuildScene(film), 1);
  vision::CineFile file;
  file.stated_fps = static_cast<std::uint32_t>(film.camera.fps);
  for (std::int64_t i = 0; i < film.frames; ++i) {
    if (dropped.contains(i)) continue;
    const core::Frame frame = clip->Read(i);
    vision::Image image{frame.width_px, frame.height_px, frame.bit_depth, {}};
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      const std::byte* const row = frame.row<std::byte>(y);
      image.pixels.insert(image.pixels.end(), row,
                          row + image.width_px * (frame.is_16_bit() ? 2 : 1));
    }
    file.frames.push_back(image);
    if (with_stamps) {
      file.stamps_s.push_back(static_cast<double>(i) / film.camera.fps);
    }
  }
  return file;
}

// Some before the body is seen, some in flight, one and two on each side of the
// contact at frame 80.37.
TEST(DroppedFrames, TheContactIsWhereItWas) {
  const TemporaryFolder folder;
  for (const core::BodyKind kind :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    const Film film = Default(kind);
    const auto path = folder.Write(
        "a.cine", Without(film, {20, 21, 60, 70, 71, 84}, true).Bytes());
    const Analysis analysis = Analyze(path, filmed::Known(film));
    EXPECT_THAT(analysis.clip.warnings,
                Contains(AllOf(HasSubstr("6 frames are missing"),
                               HasSubstr("2 after frame 19"))));
    const core::ContactRecord& first = analysis.contacts.first;
    ASSERT_TRUE(first.contact.found) << first.contact.reason;
    ExpectMeasured(first.contact.time_s, film.contact_frame / film.camera.fps,
                   "time");
    EXPECT_LT(first.contact.time_s->u, 0.2 / film.camera.fps);
    ExpectMeasured(first.contact.approach_angle_rad, film.thrown.ContactAngle(),
                   "approach");
    ExpectMeasured(first.motion.before_normal_mps, film.thrown.before.vy, "vn");
    ExpectMeasured(first.motion.before_tangential_mps, film.thrown.before.vx,
                   "vt");
    ExpectMeasured(first.motion.after_normal_mps, film.thrown.after.vy, "vn'");
    EXPECT_EQ(first.state.label, core::MotionState::kBounce);
  }
}

// The contact itself was not filmed: two frames before it and one after.
TEST(DroppedFrames, AContactWithinAGap) {
  const TemporaryFolder folder;
  const Film film = Default(core::BodyKind::kSphere);
  const auto path =
      folder.Write("a.cine", Without(film, {79, 80, 81}, true).Bytes());
  const Analysis analysis = Analyze(path, filmed::Known(film));
  const core::ContactRecord& first = analysis.contacts.first;
  ASSERT_TRUE(first.contact.found) << first.contact.reason;
  ExpectMeasured(first.contact.time_s, film.contact_frame / film.camera.fps,
                 "time");
  ExpectMeasured(first.contact.approach_angle_rad, film.thrown.ContactAngle(),
                 "approach");
  EXPECT_EQ(first.state.label, core::MotionState::kBounce);
}

// What the times are for: without them the contact comes five frames early.
TEST(DroppedFrames, WithoutTheirTimesTheyCannotBeSeen) {
  const TemporaryFolder folder;
  const Film film = Default(core::BodyKind::kSphere);
  const auto path = folder.Write(
      "a.cine", Without(film, {20, 21, 30, 31, 32}, false).Bytes());
  const Analysis analysis = Analyze(path, filmed::Known(film));
  const core::ContactRecord& first = analysis.contacts.first;
  ASSERT_TRUE(first.contact.found) << first.contact.reason;
  ExpectMeasured(first.contact.time_s,
                 (film.contact_frame - 5.0) / film.camera.fps, "time");
}

}  // namespace
}  // namespace touchdown::pipeline
