#include "app/documents/log_analysis.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "app/documents/pictures.h"
#include "app/documents/replay.h"
#include "touchdown/db/store.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::pipeline {
namespace {

// Puts the trial into the campaign.
void EnterCampaign(const Analysis& analysis, const core::Campaign& campaign,
                   core::Trial& trial) {
  trial.campaign = campaign.name;
  // A clip that shows no body is a shot all the same: the campaign's body was
  // thrown, and the store refuses a trial of another one.
  if (!analysis.body) {
    trial.body = campaign.body;
    trial.angle_kind = campaign.angle_kind;
  }
}

}  // namespace

void FillFromCampaign(const std::filesystem::path& db,
                      const std::string& campaign, AnalyzeOptions& options) {
  // The store is closed again before the analysis begins, which may take
  // minutes.
  FillFromCampaign(
      RequireCampaign(db::Store::Open(db, db::OpenMode::kRead), campaign),
      options);
}

void FillFromCampaign(const core::Campaign& campaign, AnalyzeOptions& options) {
  // What a person stated for this clip goes before the campaign. A body counts
  // as stated by its kind or by any size: half of it from each would mix two.
  const core::Body& body = campaign.body;
  if (!options.body_kind && !options.diameter_m && !options.long_m) {
    options.body_kind = body.kind;
    if (body.diameter_m) options.diameter_m = *body.diameter_m;
    if (body.long_m && body.short_m) {
      options.long_m = *body.long_m;
      options.short_m = *body.short_m;
    }
  }
  if (!options.angle_kind) options.angle_kind = campaign.angle_kind;
  if (!options.bounce_height_m && campaign.bounce_height_m > 0.0) {
    options.bounce_height_m = campaign.bounce_height_m;
  }
}

core::Trial LoggableTrial(const Analysis& analysis,
                          const core::Campaign* campaign, std::string sha256) {
  // The path is made absolute, so that the store finds the clip from any
  // folder. Size and SHA-256 tell when it was moved or changed.
  core::Trial trial = ToTrial(analysis);
  trial.clip.path = std::filesystem::absolute(analysis.clip.path).string();
  trial.clip.size_bytes = vision::SizeBytes(analysis.clip.path);
  trial.clip.sha256 =
      sha256.empty() ? vision::Sha256(analysis.clip.path) : std::move(sha256);
  if (campaign != nullptr) EnterCampaign(analysis, *campaign, trial);
  return trial;
}

Logged LogAnalysis(const Analysis& analysis, const std::filesystem::path& db,
                   const std::string& campaign,
                   const std::optional<core::Conditions>& conditions) {
  // Read the clip before the store is opened: what cannot be read makes none.
  core::Trial trial = LoggableTrial(analysis, nullptr);
  trial.conditions = conditions;
  db::Store store = db::Store::Open(
      db, campaign.empty() ? db::OpenMode::kCreate : db::OpenMode::kWrite);
  if (!campaign.empty()) {
    EnterCampaign(analysis, RequireCampaign(store, campaign), trial);
  }
  const db::Logged logged = store.LogTrial(trial);
  // The picture comes after the trial is on the disk: it may fail, the trial
  // must not.
  KeepPicture(db, trial);
  return {logged.id, logged.revision, logged.is_proposal};
}

}  // namespace touchdown::pipeline
