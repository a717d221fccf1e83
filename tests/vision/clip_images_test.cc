// touchdown/vision/footage/clip.h on folders of images.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/vision/clip_helpers.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using touchdown::testing::ReadAll;
using touchdown::testing::Shared;
using touchdown::testing::TemporaryFolder;

TEST(ImageFolder, FramesComeInNaturalOrder) {
  const TemporaryFolder folder;
  for (const int i : {10, 8, 11, 9}) {
    WritePng(folder / ("img" + std::to_string(i) + ".png"),
             Pattern(9, 7, 12, i).View());
  }
  folder.Write("notes.txt", "not a picture");
  folder.Write("._img8.png", "left by another system");
  const auto clip = OpenClip(folder.path(), {.fps = 250.0});
  EXPECT_EQ(clip->info().format, "png-folder");
  EXPECT_EQ(clip->info().frames, 4);
  EXPECT_EQ(clip->info().bit_depth, 12);
  EXPECT_EQ(clip->info().time_base.source, FpsSource::kUser);
  EXPECT_TRUE(clip->info().time_base.trusted);
  EXPECT_THAT(clip->info().warnings, IsEmpty());
  for (std::int64_t i = 0; i < 4; ++i) {
    const core::Frame frame = clip->Read(i);
    EXPECT_EQ(Samples(frame), Samples(Pattern(9, 7, 12, 8 + i).View()));
    EXPECT_DOUBLE_EQ(frame.time_s, static_cast<double>(i) / 250.0);
  }
  ExpectWindowsAreCrops(*clip, 2);
  ExpectOrderDoesNotMatter(folder.path(), {.fps = 250.0});
}

TEST(ImageFolder, AGapInTheNumbersIsSaid) {
  const TemporaryFolder folder;
  for (const int i : {1, 2, 4}) {
    WriteTiff(folder / ("a" + std::to_string(i) + ".tif"),
              Pattern(4, 4, 16, i).View());
  }
  EXPECT_THAT(OpenClip(folder.path(), {.fps = 1.0})->info().warnings,
              ElementsAre(HasSubstr("a2.tif is followed by a4.tif")));
}

TEST(ImageFolder, NeedsAFrameRate) {
  const TemporaryFolder folder;
  WritePng(folder / "a.png", Pattern(4, 4, 8, 0).View());
  EXPECT_THAT(ErrorOf(folder.path()), HasSubstr("--fps"));
}

TEST(ImageFolder, MixedAndDamagedPicturesAreNamed) {
  const ClipOptions options{.fps = 100.0};
  {
    const TemporaryFolder folder;
    EXPECT_THAT(ErrorOf(folder.path(), options),
                HasSubstr("no PNG, TIFF or JPEG"));
    WritePng(folder / "a1.png", Pattern(4, 4, 8, 0).View());
    WritePng(folder / "a2.png", Pattern(4, 5, 8, 0).View());
    EXPECT_THAT(ErrorOf(folder.path(), options),
                HasSubstr("a2.png (frame 1): 4x5 at 8 bits, expected 4x4 at 8 "
                          "bits like a1.png"));
    WritePng(folder / "a2.png", Pattern(4, 4, 16, 0).View());
    EXPECT_THAT(ErrorOf(folder.path(), options), HasSubstr("at 16 bits"));
    const std::string bytes = ReadAll(folder / "a2.png");
    folder.Write("a2.png", bytes.substr(0, bytes.size() / 2));
    EXPECT_THAT(ErrorOf(folder.path(), options), HasSubstr("(frame 1)"));
    WriteJpeg(folder / "b.jpg", Pattern(4, 4, 8, 0).View());
    EXPECT_THAT(ErrorOf(folder.path(), options),
                HasSubstr("images of two kinds (a1.png and b.jpg)"));
    EXPECT_THAT(ErrorOf(folder / "b.jpg", options),
                HasSubstr("give the folder"));
  }
}

// A damaged picture does not spoil the others.
TEST(ImageFolder, ReadableFramesStayReadable) {
  const TemporaryFolder folder;
  WritePng(folder / "1.png", Pattern(4, 4, 8, 1).View());
  folder.Write("2.png", "\x89PNG nonsense");
  WritePng(folder / "3.png", Pattern(4, 4, 8, 3).View());
  const auto clip = OpenClip(folder.path(), {.fps = 1.0});
  EXPECT_THROW(clip->Read(1), core::InputError);
  EXPECT_EQ(Samples(clip->Read(2)), Samples(Pattern(4, 4, 8, 3).View()));
  EXPECT_THROW(clip->Read(1), core::InputError);
  EXPECT_EQ(Samples(clip->Read(0)), Samples(Pattern(4, 4, 8, 1).View()));
}

TEST(OpenClip, ImpossibleArgumentsAreNamed) {
  EXPECT_THROW(OpenClip("x", {.fps = 0.0}), std::invalid_argument);
  EXPECT_THROW(OpenClip("x", {.fps = -1.0}), std::invalid_argument);
  EXPECT_THROW(OpenClip("x", {.decoder_threads = -1}), std::invalid_argument);
  EXPECT_THAT(ErrorOf("/no/such/clip.avi"), HasSubstr("no such file"));
  EXPECT_THAT(ErrorOf("/dev/null"), HasSubstr("neither a file nor a folder"));
  const TemporaryFolder folder;
  WritePng(folder / "1.png", Pattern(6, 5, 8, 1).View());
  const auto clip = OpenClip(folder.path(), {.fps = 1.0});
  EXPECT_THROW(clip->Read(-1), std::invalid_argument);
  EXPECT_THROW(clip->Read(1), std::invalid_argument);
  for (const core::PixelRect& window :
       {core::PixelRect{-1, 0, 2, 2}, core::PixelRect{0, 0, 7, 5},
        core::PixelRect{2, 2, 0, 1}, core::PixelRect{5, 0, 2, 1},
        core::PixelRect{2147483647, 0, 2147483647, 1}}) {
    EXPECT_THROW(clip->Read(0, window), std::invalid_argument);
  }
}

TEST(ImageFolderFootage, Hoop) {
  const auto path = Shared("footage/roll_slip_17.6");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  EXPECT_THAT(ErrorOf(path), HasSubstr("--fps"));
  const auto clip = OpenClip(path, {.fps = 1.0 / 0.033367});
  EXPECT_EQ(clip->info().format, "jpeg-folder");
  EXPECT_EQ(clip->info().width_px, 640);
  EXPECT_EQ(clip->info().height_px, 480);
  EXPECT_EQ(clip->info().frames, 37);
  EXPECT_THAT(clip->info().warnings, IsEmpty());
  EXPECT_NEAR(clip->Read(36).time_s, 36 * 0.033367, 1e-12);
}

}  // namespace
}  // namespace touchdown::vision
