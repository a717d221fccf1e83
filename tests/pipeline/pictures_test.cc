#include "app/documents/pictures.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "app/documents/log_analysis.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/views.h"

namespace touchdown::pipeline {
namespace {

using testing::TemporaryFolder;

TEST(FindPictures, ByRecordingAndOptions) {
  const TemporaryFolder folder;
  const auto leave = [&](const char* name, const char* json, bool picture) {
    std::filesystem::create_directories(folder.path() / name);
    std::ofstream(folder.path() / name / "analysis.json") << json;
    if (picture) std::ofstream(folder.path() / name / "contact.png") << "p";
  };
  const char* const document =
      R"({"clip": {"id": "one"}, "software": {"options_hash": "h"}})";
  leave("b/deep", document, true);
  leave("a", document, false);
  leave("c", document, true);
  leave("damaged", "{", true);
  leave("other", R"({"clip": {"id": "two"}, "software": {}})", true);
  core::Trial trials[3];
  trials[0].id = "t0";
  trials[0].clip.id = "one";
  trials[0].options_hash = "h";
  trials[1] = trials[0];
  trials[1].id = "t1";
  trials[1].options_hash = "other options";
  trials[2].id = "by hand";
  const auto found = FindPictures(folder.path(), trials);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.at("t0"), folder.path() / "b/deep" / "contact.png");
  EXPECT_THROW(FindPictures(folder.path() / "none", trials), core::InputError);
}

// However a trial was logged, its picture is drawn from its recording and what
// the store holds of it.
TEST(KeepPicture, OfATrialOfTheStore) {
  const TemporaryFolder folder;
  const auto clip = folder / "shot.mraw";
  const auto store = folder / "lab.db";
  filmed::WriteSphere(clip, 25.0, 1);
  AnalyzeOptions options;
  options.diameter_m = core::Estimate{24 * core::kMillimetre, 2e-5, {}};
  const std::string id =
      LogAnalysis(Analyze(clip, options), store, "").trial_id;
  const auto trials = db::Store::Open(store, db::OpenMode::kRead).Trials();
  ASSERT_EQ(trials.size(), 1u);
  const auto kept = KeptPictures(store, trials);
  ASSERT_TRUE(kept.contains(id));
  EXPECT_EQ(kept.at(id).parent_path(), folder / "lab.db.evidence");
  EXPECT_EQ(testing::ReadAll(kept.at(id)).substr(1, 3), "PNG");
  // Drawn again where it is missing, not where the recording is missing, too.
  std::filesystem::remove(kept.at(id));
  EXPECT_TRUE(KeptPictures(store, trials).empty());
  EXPECT_TRUE(KeepPicture(store, trials[0]));
  EXPECT_EQ(KeptPictures(store, trials), kept);
  std::filesystem::remove(kept.at(id));
  std::filesystem::rename(clip, folder / "moved.mraw");
  EXPECT_FALSE(KeepPicture(store, trials[0]));
  EXPECT_TRUE(KeptPictures(store, trials).empty());
  // A name is not taken for a path.
  core::Trial hostile = trials[0];
  hostile.clip.id = "../../shot";
  EXPECT_FALSE(KeepPicture(store, hostile));
}

// The path in the document is what the view of the store gives.
TEST(Path, IsInTheStoreInMillimetres) {
  const TemporaryFolder folder;
  const auto clip = folder / "shot.mraw";
  const auto store = folder / "lab.db";
  filmed::WriteSphere(clip, 25.0, 1);
  AnalyzeOptions options;
  options.diameter_m = core::Estimate{24 * core::kMillimetre, 2e-5, {}};
  const Analysis analysis = Analyze(clip, options);
  LogAnalysis(analysis, store, "");
  ASSERT_TRUE(analysis.plane && analysis.scale);
  const double mm = 1.0 / analysis.scale->px_per_m.value / core::kMillimetre;
  std::size_t i = 0;
  for (const db::View& view : db::Views()) {
    if (view.name != "v_tracks") continue;
    db::ForEachRow(
        db::Store::Open(store, db::OpenMode::kRead), view, "",
        [&](std::span<const db::Cell> row) {
          const vision::PlaneSample& s = analysis.plane->samples.at(i++);
          EXPECT_EQ(std::get<std::int64_t>(row[2]), s.frame);
          EXPECT_DOUBLE_EQ(std::get<double>(row[3]), s.time_s);
          EXPECT_NEAR(std::get<double>(row[4]), s.along_px * mm, 1e-4);
          EXPECT_NEAR(std::get<double>(row[5]), s.height_px * mm, 1e-4);
          EXPECT_NEAR(std::get<double>(row[6]), s.gap_px * mm, 1e-4);
          EXPECT_EQ(row[7], db::Cell());  // a sphere has no face
        });
  }
  EXPECT_EQ(i, analysis.plane->samples.size());
  EXPECT_GT(i, 20u);
}

}  // namespace
}  // namespace touchdown::pipeline
