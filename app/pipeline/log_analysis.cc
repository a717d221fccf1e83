#include "app/pipeline/log_analysis.h"

#include "touchdown/db/store.h"
#include "touchdown/vision/clip_digest.h"

namespace touchdown::pipeline {

core::Trial LoggableTrial(const Analysis& analysis,
                          const std::string& campaign) {
  core::Trial trial = ToTrial(analysis);
  trial.campaign = campaign;
  trial.clip.path = std::filesystem::absolute(analysis.clip.path).string();
  trial.clip.sha256 = vision::Sha256(analysis.clip.path);
  return trial;
}

Logged LogAnalysis(const Analysis& analysis, const std::filesystem::path& db,
                   const std::string& campaign) {
  const core::Trial trial = LoggableTrial(analysis, campaign);
  db::Store store = db::Store::Open(db, db::OpenMode::kCreate);
  const db::Logged logged = store.LogTrial(trial);
  return {logged.id, logged.revision};
}

}  // namespace touchdown::pipeline
