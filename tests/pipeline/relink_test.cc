#include "app/trials/relink.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "app/documents/log_analysis.h"
#include "app/measure/analyze.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/store.h"

namespace touchdown::pipeline {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Two recordings, each with a trial.
class Relinking : public ::testing::Test {
 protected:
  Relinking() {
    core::Campaign campaign;
    campaign.name = "board";
    campaign.body = core::Sphere({24 * core::kMillimetre, 2e-5, std::nullopt});
    campaign.bounce_height_m = 0.5 * core::kMillimetre;
    db::Store::Open(path, db::OpenMode::kCreate).AddCampaign(campaign);
    fs::create_directory(clips);
    for (const auto& [name, seed] : {std::pair("a", 1), std::pair("b", 2)}) {
      const fs::path clip = clips / (std::string(name) + ".mraw");
      filmed::WriteSphere(clip, 25.0, seed);
      AnalyzeOptions options;
      FillFromCampaign(campaign, options);
      trials.push_back(
          LogAnalysis(Analyze(clip, options), path, campaign.name).trial_id);
    }
  }

  db::Store Open() const { return db::Store::Open(path, db::OpenMode::kWrite); }

  // A recording under another name: its two files.
  void Move(const std::string& name, const fs::path& folder,
            const std::string& now) const {
    fs::create_directories(folder);
    for (const char* ending : {".mraw", ".cihx"}) {
      fs::rename(clips / (name + ending), folder / (now + ending));
    }
  }

  testing::TemporaryFolder folder;
  fs::path path = folder / "lab.db";
  fs::path clips = folder / "clips";
  std::vector<std::string> trials;
};

TEST_F(Relinking, FindsWhatWasMovedByWhatItIs) {
  const auto before = Open().History(trials[0]);
  // The other one now bears its name: a name says nothing.
  Move("a", clips / "archive" / "2026", "shot");
  Move("b", clips, "a");
  auto store = Open();
  const Relinked relinked = Relink(store, clips);
  EXPECT_EQ(relinked.looked_at, 2u);
  EXPECT_THAT(relinked.missing, IsEmpty());
  EXPECT_EQ(store.Find(trials[0])->clip.path,
            (clips / "archive" / "2026" / "shot.mraw").string());
  EXPECT_EQ(store.Find(trials[1])->clip.path, (clips / "a.mraw").string());
  // Nothing else: no revision, and the chain holds.
  const auto after = store.History(trials[0]);
  ASSERT_EQ(after.size(), before.size());
  EXPECT_EQ(after[0].id, before[0].id);
  EXPECT_EQ(after[0].trial.first, before[0].trial.first);
  EXPECT_EQ(after[0].trial.document_json, before[0].trial.document_json);
  EXPECT_THAT(db::Check(store).problems, IsEmpty());
}

TEST_F(Relinking, SaysWhatItDidNotFindAndLeavesItsPlace) {
  Move("a", folder / "archive", "a");
  auto store = Open();
  const Relinked relinked = Relink(store, clips);
  EXPECT_THAT(relinked.found, IsEmpty());
  EXPECT_THAT(relinked.missing, ElementsAre((clips / "a.mraw").string()));
  EXPECT_EQ(relinked.in_place, 1u);
  EXPECT_EQ(store.Find(trials[0])->clip.path, (clips / "a.mraw").string());
}

TEST_F(Relinking, TakesNoOtherRecordingOfTheSameSize) {
  fs::create_directory(folder / "others");
  filmed::WriteSphere(folder / "others" / "a.mraw", 25.0, 3);
  Move("a", folder / "archive", "a");
  auto store = Open();
  EXPECT_THAT(Relink(store, folder / "others").found, IsEmpty());
}

TEST_F(Relinking, ACorrectionKeepsTheNewPlace) {
  Move("a", folder / "archive", "a");
  auto store = Open();
  Relink(store, folder / "archive");
  core::Trial seen = *store.Find(trials[0]);
  seen.first.state.label = core::MotionState::kSlide;
  store.Correct(seen, "Ada", "seen by eye");
  EXPECT_EQ(store.Find(trials[0])->clip.path,
            (folder / "archive" / "a.mraw").string());
}

TEST_F(Relinking, AFolderThatIsNotThereIsAnError) {
  auto store = Open();
  EXPECT_THROW(Relink(store, folder / "nowhere"), core::InputError);
}

}  // namespace
}  // namespace touchdown::pipeline
