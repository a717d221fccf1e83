#include "touchdown/db/clips.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/db/fixture.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::db {
namespace {

using ::testing::IsEmpty;

class Clips : public ::testing::Test {
 protected:
  Clips() {
    store.AddCampaign(SphereCampaign());
    first = store.LogTrial(SphereTrial(1)).id;
  }

  Folder folder;
  Store store = OpenFixed(folder / "lab.db");
  std::string first;
};

TEST_F(Clips, AMovedClipHasItsNewPlaceInEveryRevision) {
  store.Exclude(first, "Ada", "chipped");
  const auto clips = KnownClips(store);
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].id, "clip-1");
  EXPECT_EQ(clips[0].size_bytes, 1001);
  EXPECT_EQ(clips[0].last_seen_path, "/lab/clips/1.mraw");
  MoveClip(store, clips[0], "/archive/x.mraw");
  for (const Revision& revision : store.History(first)) {
    EXPECT_EQ(revision.trial.clip.path, "/archive/x.mraw");
  }
  EXPECT_EQ(store.History(first).size(), 2u);
  EXPECT_THAT(Check(store).problems, IsEmpty());
}

TEST_F(Clips, AnotherStoreSaysNothingOfWhereAClipIsHere) {
  Store other = OpenFixed(folder / "other.db", 2);
  Merge(other, store);
  MoveClip(store, KnownClips(store)[0], "/archive/x.mraw");
  Merge(store, other);
  EXPECT_EQ(store.Find(first)->clip.path, "/archive/x.mraw");
}

TEST_F(Clips, ANewAnalysisSaysWhereItIs) {
  MoveClip(store, KnownClips(store)[0], "/archive/x.mraw");
  core::Trial again = SphereTrial(1);
  again.clip.path = "/lab/again.mraw";
  store.LogTrial(again);
  EXPECT_EQ(store.Find(first)->clip.path, "/lab/again.mraw");
}

TEST_F(Clips, APlaceHasAName) {
  EXPECT_THROW(MoveClip(store, KnownClips(store)[0], ""),
               std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::db
