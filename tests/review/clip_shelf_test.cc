#include "app/review/clip_shelf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <utility>

#include "tests/pipeline/film_file.h"
#include "tests/pipeline/shaken.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip_writer.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::review {
namespace {

using pipeline::filmed::WriteSphere;

vision::Image Decode(const Picture& picture,
                     const testing::TemporaryFolder& folder) {
  const auto file = folder.Write(
      picture.type == "image/png" ? "a.png" : "a.jpg", *picture.bytes);
  return vision::ReadImage(file);
}

TEST(ClipShelf, GivesTheSamplesOfARawRecording) {
  const testing::TemporaryFolder folder;
  WriteSphere(folder / "a.mraw", 25.0, 1);
  ClipShelf shelf;
  const Picture picture = shelf.Frame({folder / "a.mraw"}, 70);
  EXPECT_EQ(picture.type, "image/png");
  const vision::Image image = Decode(picture, folder);
  const auto clip = vision::OpenClip(folder / "a.mraw");
  const core::Frame frame = clip->Read(70);
  ASSERT_EQ(image.width_px, frame.width_px);
  ASSERT_EQ(image.height_px, frame.height_px);
  for (int y = 0; y < frame.height_px; ++y) {
    for (int x = 0; x < frame.width_px; ++x) {
      ASSERT_EQ(image.View().at(x, y), frame.at(x, y)) << x << ", " << y;
    }
  }
  EXPECT_EQ(shelf.bytes(), 0u);  // it is as quickly made again
}

// A compressed recording of `frames` frames, each of one level of its own.
void WriteLevels(const std::filesystem::path& path, int frames,
                 int first = 20) {
  vision::VideoOptions options;
  options.codec = vision::VideoCodec::kH264;
  options.key_frame_distance = 25;
  options.fps = 100.0;
  std::vector<std::byte> pixels(64 * 48);
  std::int64_t n = 0;
  vision::WriteVideo(path, options, [&]() -> std::optional<core::Frame> {
    if (n == frames) return std::nullopt;
    std::fill(pixels.begin(), pixels.end(),
              static_cast<std::byte>(first + 3 * n));
    core::Frame frame;
    frame.data = pixels.data();
    frame.stride_bytes = 64;
    frame.width_px = 64;
    frame.height_px = 48;
    frame.index = n++;
    return frame;
  });
}

TEST(ClipShelf, GivesEachFrameOfACompressedRecordingInAnyOrder) {
  const testing::TemporaryFolder folder;
  WriteLevels(folder / "a.mp4", 60);
  ClipShelf shelf;
  for (const int n : {59, 0, 30, 29, 31, 5, 58, 30}) {
    const Picture picture = shelf.Frame({folder / "a.mp4"}, n);
    EXPECT_EQ(picture.type, "image/jpeg");
    const auto level = Decode(picture, folder).View().at(32, 24);
    EXPECT_NEAR(static_cast<double>(level), 20 + 3 * n, 4.0) << n;
  }
}

// A recording that was replaced is another one: its frames, its pictures.
TEST(ClipShelf, SeesThatARecordingHasChanged) {
  const testing::TemporaryFolder folder;
  const auto path = folder / "a.mp4";
  WriteLevels(path, 60);
  ClipShelf shelf;
  EXPECT_EQ(shelf.Info({path}).frames, 60);
  shelf.Frame({path}, 7);
  WriteLevels(path, 30, 100);
  EXPECT_EQ(shelf.Info({path}).frames, 30);
  const auto level = Decode(shelf.Frame({path}, 7), folder).View().at(32, 24);
  EXPECT_NEAR(static_cast<double>(level), 100 + 3 * 7, 4.0);
}

// What stands still is where frame 0 shows it; as recorded it is not.
TEST(ClipShelf, PutsTheFramesOfACameraThatMovedBack) {
  const testing::TemporaryFolder folder;
  const auto path = folder / "a.mraw";
  constexpr std::int64_t kFrames = 30;
  constexpr std::int64_t kLate = 25;  // by then it has gone 5 px
  {
    pipeline::filmed::Film film =
        pipeline::filmed::Default(core::BodyKind::kSphere);
    film.look.texture_amplitude = 0.2;
    pipeline::filmed::ShakenClip clip(film, pipeline::filmed::ByHand);
    std::int64_t frame = 0;
    vision::WriteMraw(path, {}, [&]() -> std::optional<core::Frame> {
      if (frame == kFrames) return std::nullopt;
      return clip.Read(frame++);
    });
  }
  ClipShelf shelf;
  const vision::Image first = Decode(shelf.Frame({path}, 0), folder);
  const auto rms = [&](const Picture& picture) {
    const vision::Image image = Decode(picture, folder);
    double square = 0.0;
    int n = 0;
    // A part of what stands still.
    for (int y = 90; y < 110; ++y) {
      for (int x = 12; x < 60; ++x, ++n) {
        const double d = static_cast<double>(image.View().at(x, y)) -
                         static_cast<double>(first.View().at(x, y));
        square += d * d;
      }
    }
    return std::sqrt(square / n);
  };
  const double recorded = rms(shelf.Frame({path}, kLate));
  const double steady = rms(shelf.Frame(
      {path, std::pair<std::int64_t, std::int64_t>{0, kFrames}}, kLate));
  EXPECT_LT(steady, 0.3 * recorded);
}

TEST(ClipShelf, KeepsNoMoreThanItMay) {
  const testing::TemporaryFolder folder;
  WriteLevels(folder / "a.mp4", 60);
  WriteLevels(folder / "b.mp4", 60);
  ShelfOptions options;
  options.most_bytes = 4000;
  options.most_open = 1;
  ClipShelf shelf(options);
  for (int n = 0; n < 60; ++n) {
    shelf.Frame({folder / (n % 2 == 0 ? "a.mp4" : "b.mp4")}, n);
    EXPECT_LE(shelf.bytes(), options.most_bytes);
  }
}

TEST(ClipShelf, SaysWhatIsWrong) {
  const testing::TemporaryFolder folder;
  ClipShelf shelf;
  EXPECT_THROW(shelf.Frame({folder / "none.mraw"}, 0), core::InputError);
  WriteSphere(folder / "a.mraw", 25.0, 1);
  EXPECT_THROW(shelf.Frame({folder / "a.mraw"}, 100'000),
               std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::review
