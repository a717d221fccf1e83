// Nothing outside of the folders is listed or opened.
#include "app/review/recordings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/trials/statement.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"

namespace touchdown::review {
namespace {

namespace fs = std::filesystem;
using pipeline::FieldError;
using ::testing::ElementsAre;
using ::testing::TestWithParam;
using ::testing::Values;

class RecordingFoldersTest : public TestWithParam<const char*> {
 protected:
  RecordingFoldersTest() {
    for (const char* name : {"given/below", "given/pictures", "given-not",
                             "outside", "outside/pictures"}) {
      fs::create_directories(folder / name);
    }
    for (const char* file :
         {"given/a.mraw", "given/a.cihx", "given/below/b.mp4", "given/c.mraw",
          "given/pictures/1.png", "given/notes.txt", "given/.hidden.mp4",
          "given-not/n.mp4", "outside/o.mp4", "outside/o.cihx",
          "outside/pictures/1.png", "outside/2.png"}) {
      folder.Write(file, "x");
    }
    const fs::path given = folder / "given";
    fs::create_symlink(folder / "outside/o.mp4", given / "link.mp4");
    fs::create_symlink(given / "below/b.mp4", given / "inner.mp4");
    fs::create_symlink(folder / "outside/o.cihx", given / "c.cihx");
    fs::create_directory_symlink(folder / "outside", given / "way");
    // One picture of a recording leads out.
    fs::create_directories(given / "mixed");
    folder.Write("given/mixed/1.png", "x");
    fs::create_symlink(folder / "outside/2.png", given / "mixed/2.png");
  }

  testing::TemporaryFolder folder;
};

TEST_F(RecordingFoldersTest, ListsWhatLiesInside) {
  const RecordingFolders folders({folder / "given"});
  EXPECT_THAT(folders.Names(0),
              ElementsAre("a.mraw", "below/b.mp4", "inner.mp4", "pictures"));
}

TEST_F(RecordingFoldersTest, GivesThePathWithoutLinks) {
  fs::create_directory_symlink(folder / "given", folder / "alias");
  const RecordingFolders folders({folder / "alias", folder / "given"});
  const fs::path given = fs::canonical(folder / "given");
  EXPECT_THAT(folders.folders(), ElementsAre(given));  // once
  EXPECT_EQ(folders.Require({0, "inner.mp4"}), given / "below/b.mp4");
  EXPECT_EQ(folders.Require({0, "pictures"}), given / "pictures");
  EXPECT_EQ(RecordingFolders({folder / "given/pictures"}).Require({0, "."}),
            given / "pictures");
  EXPECT_THAT(folders.RequirePictures({0, "pictures"}),
              ElementsAre(given / "pictures/1.png"));
}

TEST_P(RecordingFoldersTest, RefusesWhatDoesNot) {
  const RecordingFolders folders({folder / "given"});
  EXPECT_THROW(folders.Require({0, GetParam()}), FieldError);
}
INSTANTIATE_TEST_SUITE_P(Names, RecordingFoldersTest,
                         Values("link.mp4", "way/o.mp4", "way/pictures",
                                "../outside/o.mp4", "../given-not/n.mp4",
                                "below/../../outside/o.mp4", "c.mraw", "mixed",
                                "notes.txt", ".hidden.mp4", "none.mp4",
                                "/etc/passwd", "..", "."));

TEST_F(RecordingFoldersTest, RefusesFoldersThatAreNotThere) {
  const RecordingFolders folders({folder / "given"});
  EXPECT_THROW(folders.Require({1, "a.mraw"}), FieldError);
  EXPECT_THROW(RecordingFolders().Require({0, "a.mraw"}), FieldError);
  for (const char* name : {"way/pictures", "mixed", "below", "..", "a.mraw"}) {
    EXPECT_THROW(folders.RequirePictures({0, name}), FieldError) << name;
  }
  EXPECT_THROW(folders.RequirePictures({1, "pictures"}), FieldError);
  EXPECT_THROW(RecordingFolders({folder / "none"}), core::InputError);
  EXPECT_THROW(RecordingFolders({folder / "given/a.mraw"}), core::InputError);
}

TEST(ReadRecording, NamesTheFieldThatIsWrong) {
  using Json = nlohmann::json;
  EXPECT_EQ(ReadRecording(Json{{"folder", 1}, {"name", "a.mp4"}}),
            (Recording{1, "a.mp4"}));
  EXPECT_THROW(ReadRecording(Json{{"folder", 1}}), FieldError);
  EXPECT_THROW(ReadRecording(Json{{"name", "a.mp4"}}), FieldError);
  EXPECT_THROW(ReadRecording(Json{{"folder", -1}, {"name", "a"}}), FieldError);
  EXPECT_THROW(ReadRecording(Json{{"folder", 1.5}, {"name", "a"}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::review
