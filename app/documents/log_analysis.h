// From an analysis into the trial store.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/measure/analyze.h"
#include "touchdown/core/campaign.h"
#include "touchdown/db/names.h"
#include "touchdown/db/store.h"

namespace touchdown::pipeline {

// What the campaign fixed and the options leave open: body and its size, kind
// of angle, bounce height. Throws core::StoreError if there is no such
// campaign.
void FillFromCampaign(const std::filesystem::path& db,
                      const std::string& campaign, AnalyzeOptions& options);
void FillFromCampaign(const core::Campaign& campaign, AnalyzeOptions& options);

using db::RequireCampaign;

struct Logged {
  std::string trial_id;
  std::int64_t revision = 0;
  // A person's correction stays in force, and this analysis is a proposal.
  bool is_proposal = false;
};

// The trial as the store takes it: with an absolute path and the clip's full
// SHA-256; where the clip shows no body, it is still the campaign's (null: in
// none) that was thrown. `sha256`: where the caller has it already. Throws
// core::InputError if the clip cannot be read.
core::Trial LoggableTrial(const Analysis& analysis,
                          const core::Campaign* campaign,
                          std::string sha256 = {});

// Logs the trial that `analysis` makes, with the clip's full SHA-256, in the
// store at `db` (made where there is none): a new trial, or a further revision
// where the campaign has one of the same clip (a proposal, where a person has
// corrected it). On the disk on return. Throws
// core::StoreError; core::InputError if the clip cannot be read.
Logged LogAnalysis(const Analysis& analysis, const std::filesystem::path& db,
                   const std::string& campaign,
                   const std::optional<core::Conditions>& conditions = {});

}  // namespace touchdown::pipeline
