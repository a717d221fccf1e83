#include "app/pipeline/log_analysis.h"

#include <fmt/format.h>

#include "touchdown/core/errors.h"
#include "touchdown/db/store.h"
#include "touchdown/vision/clip_digest.h"

namespace touchdown::pipeline {

void FillFromCampaign(const std::filesystem::path& db,
                      const std::string& campaign, AnalyzeOptions& options) {
  const db::Store store = db::Store::Open(db, db::OpenMode::kRead);
  const auto found = store.FindCampaign(campaign);
  if (!found) {
    throw core::StoreError(
        fmt::format("{}: there is no campaign '{}'; make it first: touchdown "
                    "campaign new",
                    db.string(), campaign));
  }
  const core::Body& body = found->body;
  if (!options.body_kind && !options.diameter_m && !options.long_m) {
    options.body_kind = body.kind;
    if (body.diameter_m) options.diameter_m = *body.diameter_m;
    if (body.long_m && body.short_m) {
      options.long_m = *body.long_m;
      options.short_m = *body.short_m;
    }
  }
  if (!options.angle_kind) options.angle_kind = found->angle_kind;
  if (!options.bounce_height_m && found->bounce_height_m > 0.0) {
    options.bounce_height_m = found->bounce_height_m;
  }
}

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
  core::Trial trial = LoggableTrial(analysis, campaign);
  db::Store store = db::Store::Open(db, db::OpenMode::kCreate);
  // Where the clip shows no body, it is still the campaign's that was thrown.
  if (const auto found = store.FindCampaign(campaign);
      found && !analysis.body) {
    trial.body = found->body;
    trial.angle_kind = found->angle_kind;
  }
  const db::Logged logged = store.LogTrial(trial);
  return {logged.id, logged.revision};
}

}  // namespace touchdown::pipeline
