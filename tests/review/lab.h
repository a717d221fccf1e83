// A store with one analysed trial of a small rendered recording.
#pragma once

#include <filesystem>
#include <string>

#include "app/documents/log_analysis.h"
#include "app/measure/analyze.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/body.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/units.h"
#include "touchdown/db/store.h"

namespace touchdown::review {

struct Lab {
  Lab() {
    pipeline::filmed::WriteSphere(clip, 25.0, 1);
    core::Campaign campaign;
    campaign.name = "board";
    campaign.body = core::Sphere({24 * core::kMillimetre, 2e-5, std::nullopt});
    campaign.bounce_height_m = 0.5 * core::kMillimetre;
    db::Store::Open(store, db::OpenMode::kCreate).AddCampaign(campaign);
    pipeline::AnalyzeOptions options;
    pipeline::FillFromCampaign(campaign, options);
    trial = pipeline::LogAnalysis(pipeline::Analyze(clip, options), store,
                                  campaign.name)
                .trial_id;
  }

  core::Trial Now() const {
    return *db::Store::Open(store, db::OpenMode::kRead).Find(trial);
  }

  touchdown::testing::TemporaryFolder folder;
  std::filesystem::path store = folder / "lab.db";
  std::filesystem::path clip = folder / "shot.mraw";
  std::string trial;
};

}  // namespace touchdown::review
