// What counts as a recording, and when it is complete. Time is the test's own.
#include "app/trials/recordings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"

namespace touchdown::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace)
namespace fs = std::filesystem;

std::vector<std::string> Names(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& path : FindRecordings(folder)) {
    names.push_back(path.lexically_relative(folder).string());
  }
  return names;
}

TEST(FindRecordings, VideosRawsAndFoldersOfImages) {
  const TemporaryFolder folder;
  for (const char* below : {"shots", "shots/img", "evidence", "lab.db.evidence",
                            ".trash", "notes", "it's \"odd\"\n\xc3\xbc"}) {
    fs::create_directories(folder / below);
  }
  for (const char* file :
       {"b.MP4", "a.cine", "x.mraw", "x.cihx", "x.truth.json", ".hidden.avi",
        "y.avi.part123", "shots/img/1.png", "shots/img/2.png",
        "evidence/analysis.json", "evidence/contact.png",
        "lab.db.evidence/1.png", ".trash/z.avi", "notes/readme.txt",
        "it's \"odd\"\n\xc3\xbc/k.avi"}) {
    folder.Write(file, "x");
  }
  // A link to a folder could lead in a circle.
  fs::create_directory_symlink(folder.path(), folder / "shots/circle");
  EXPECT_THAT(Names(folder.path()),
              ElementsAre("a.cine", "b.MP4", "it's \"odd\"\n\xc3\xbc/k.avi",
                          "shots/img", "x.mraw"));
  EXPECT_THROW(FindRecordings(folder / "none"), core::InputError);
}

// Pictures beside a video are notes; alone they are a recording.
TEST(FindRecordings, PicturesBesideAVideoAreNotes) {
  const TemporaryFolder folder;
  folder.Write("a.png", "x");
  EXPECT_THAT(FindRecordings(folder.path()), ElementsAre(folder.path()));
  folder.Write("a.avi", "x");
  EXPECT_THAT(Names(folder.path()), ElementsAre("a.avi"));
}

// A TIFF of several pages is a recording of its own.
TEST(FindRecordings, StacksAreRecordings) {
  // Two directories without entries: pages of nothing.
  const std::string stack(
      "II*\0\x08\0\0\0"
      "\0\0\x0E\0\0\0"
      "\0\0\0\0\0\0",
      20);
  const TemporaryFolder folder;
  for (const char* below : {"stacks", "pictures"}) {
    fs::create_directories(folder / below);
  }
  folder.Write("stacks/a.tif", stack);
  folder.Write("stacks/b.TIFF", stack);
  folder.Write("stacks/map.png", "x");
  folder.Write("pictures/1.tif", "x");
  folder.Write("pictures/2.tif", "x");
  EXPECT_THAT(Names(folder.path()),
              ElementsAre("pictures", "stacks/a.tif", "stacks/b.TIFF"));
}

TEST(FindRecordings, OpensNothingThatIsNotAdmitted) {
  const TemporaryFolder folder;
  folder.Write("a.avi", "x");
  folder.Write("b.avi", "x");
  const auto found = FindRecordings(
      folder.path(), [](const fs::path& p) { return p.stem() != "a"; });
  EXPECT_THAT(found, ElementsAre(folder / "b.avi"));
}

TEST(IsRecording, AsFindRecordingsFindsThem) {
  const TemporaryFolder folder;
  for (const char* below : {"img", "none", "evidence"}) {
    fs::create_directories(folder / below);
  }
  for (const char* file : {"a.avi", "a.txt", "img/1.png", "evidence/1.png",
                           "evidence/analysis.json", ".b.avi"}) {
    folder.Write(file, "x");
  }
  EXPECT_TRUE(IsRecording(folder / "a.avi"));
  EXPECT_TRUE(IsRecording(folder / "img"));
  for (const char* other :
       {"a.txt", "none", "evidence", "img/1.png", ".b.avi", "not there.avi"}) {
    EXPECT_FALSE(IsRecording(folder / other)) << other;
  }
}

TEST(ListFiles, ARecordingIsReadFrom) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "img");
  for (const char* file :
       {"x.mraw", "x.cihx", "x.txt", "img/1.png", "img/notes.txt", "a.avi"}) {
    folder.Write(file, "x");
  }
  EXPECT_THAT(ListFiles(folder / "x.mraw"),
              ElementsAre(folder / "x.mraw", folder / "x.cihx"));
  EXPECT_THAT(ListFiles(folder / "img"), ElementsAre(folder / "img/1.png"));
  EXPECT_THAT(ListFiles(folder / "a.avi"), ElementsAre(folder / "a.avi"));
}

TEST(Settling, TellsARecordingWhenItHasStoppedGrowing) {
  Settling settling(2s);
  const Settling::Instant start{};
  const auto at = [&](std::uintmax_t bytes) {
    return Settling::Extents{{"a.avi", {1, bytes, {}}}};
  };
  EXPECT_THAT(settling.Look(at(10), start), IsEmpty());
  EXPECT_TRUE(settling.waiting());
  EXPECT_THAT(settling.Look(at(20), start + 1900ms), IsEmpty());
  EXPECT_THAT(settling.Look(at(20), start + 3800ms), IsEmpty());
  EXPECT_THAT(settling.Look(at(20), start + 3900ms), ElementsAre("a.avi"));
  EXPECT_FALSE(settling.waiting());
  // Once is enough, unless it grows again or comes back.
  EXPECT_THAT(settling.Look(at(20), start + 9s), IsEmpty());
  EXPECT_THAT(settling.Look(at(30), start + 10s), IsEmpty());
  EXPECT_THAT(settling.Look(at(30), start + 12s), ElementsAre("a.avi"));
  EXPECT_THAT(settling.Look({}, start + 13s), IsEmpty());
  EXPECT_THAT(settling.Look(at(30), start + 14s), IsEmpty());
  EXPECT_THAT(settling.Look(at(30), start + 16s), ElementsAre("a.avi"));
}

// A camera writes the samples, and some time later the header beside them.
TEST(Watch, TakesARecordingWhenAllOfItIsThere) {
  const TemporaryFolder folder;
  Settling::Instant now{};
  int step = 0;
  std::vector<std::string> taken;
  WatchOptions options;
  options.quiet = 2s;
  options.now = [&] { return now; };
  options.wait = [&](bool growing) {
    switch (++step) {
      case 1:
        EXPECT_FALSE(growing);
        folder.Write("a.mraw", "12");
        break;
      case 2:
        EXPECT_TRUE(growing);
        folder.Write("a.mraw", "1234");
        break;
      case 3:
        folder.Write("a.cihx", "x");
        break;
      case 5:
        folder.Write("b.avi", "x");
        break;
      default:
        break;
    }
    now += step == 4 || step == 6 ? 2000ms : 1500ms;
    return step < 8;
  };
  Watch(folder.path(), options, [&](const auto& complete) {
    for (const auto& path : complete) {
      taken.push_back(path.filename().string() + " at step " +
                      std::to_string(step));
    }
  });
  EXPECT_THAT(taken, ElementsAre("a.mraw at step 4", "b.avi at step 6"));
}

TEST(MeasureExtent, TellsWhenItWasWritten) {
  const TemporaryFolder folder;
  const auto path = folder.Write("a.avi", "12345");
  const auto hour_ago =
      std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::filesystem::last_write_time(path, hour_ago);
  EXPECT_EQ(MeasureExtent(path).written, hour_ago);
  const Extent before = MeasureExtent(path);
  folder.Write("a.avi", "54321");  // as long as before
  EXPECT_NE(MeasureExtent(path), before);
}

}  // namespace
}  // namespace touchdown::pipeline
