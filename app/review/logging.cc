#include "app/review/logging.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "app/pipeline/analyze.h"
#include "app/pipeline/log_analysis.h"
#include "app/pipeline/pictures.h"
#include "app/pipeline/report_input.h"
#include "app/pipeline/report_pictures.h"
#include "app/pipeline/statement.h"
#include "app/pipeline/typed_values.h"
#include "app/review/fields.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/register.h"

namespace touchdown::review {
namespace {

using pipeline::FieldError;

// Under "conditions": what was filled in, by the keys of --condition.
std::optional<core::Conditions> ConditionsOf(const nlohmann::json& asked) {
  std::optional<core::Conditions> conditions;
  const auto given = asked.find("conditions");
  if (given == asked.end()) return conditions;
  for (const auto& [key, value] : given->items()) {
    const std::string text = TextOf(*given, key.c_str());
    if (text.empty()) continue;
    if (!conditions) conditions.emplace();
    if (!pipeline::SetCondition(key, text, *conditions)) {
      throw FieldError(key, "is no condition of a shot");
    }
  }
  return conditions;
}

pipeline::Statement StatementOf(const nlohmann::json& asked) {
  pipeline::Statement out;
  out.angle_deg = NumberOf(asked, "angle_deg");
  out.angle_u_deg = NumberOf(asked, "angle_u_deg");
  out.state = TextOf(asked, "state");
  out.corner = TextOf(asked, "corner");
  out.set_angle_deg = NumberOf(asked, "set_angle_deg");
  out.set_speed_mps = NumberOf(asked, "set_speed_mps");
  out.note = TextOf(asked, "note");
  out.conditions = ConditionsOf(asked);
  return out;
}

}  // namespace

db::Logged LogTyped(const std::filesystem::path& store,
                    const nlohmann::json& asked) {
  pipeline::ManualEntry entry;
  entry.campaign = RequiredText(asked, "campaign", "one of the campaigns");
  entry.by = RequiredText(asked, "who", "your name");
  entry.statement = StatementOf(asked);
  return pipeline::LogByHand(store, entry);
}

db::Logged LogRecording(const std::filesystem::path& store,
                        const nlohmann::json& asked) {
  const std::string name =
      RequiredText(asked, "campaign", "one of the campaigns");
  const std::string who = RequiredText(asked, "who", "your name");
  const std::filesystem::path clip =
      RequiredText(asked, "clip", "the path of a recording on this machine");
  if (!std::filesystem::exists(clip)) {
    throw FieldError("clip", fmt::format("is '{}', must be a recording that "
                                         "is there",
                                         clip.string()));
  }
  pipeline::Statement setting;
  setting.set_angle_deg = NumberOf(asked, "set_angle_deg");
  setting.set_speed_mps = NumberOf(asked, "set_speed_mps");
  setting.conditions = ConditionsOf(asked);
  core::Trial rehearsal;
  pipeline::Apply(setting, rehearsal);  // before the work, not after it
  pipeline::AnalyzeOptions options;
  const auto open = db::Store::Open(store, db::OpenMode::kRead);
  const core::Campaign campaign = pipeline::RequireCampaign(open, name);
  if (setting.conditions) {
    setting.conditions = db::Resolved(open, *setting.conditions);
  }
  pipeline::FillFromCampaign(campaign, options);
  options.limit_s = pipeline::kUsualLimit_s;
  core::Trial trial =
      pipeline::LoggableTrial(pipeline::Analyze(clip, options), &campaign);
  pipeline::Apply(setting, trial);
  trial.reason = "logged on the review page by " + who;
  const db::Logged logged =
      db::Store::Open(store, db::OpenMode::kWrite).LogTrial(trial);
  pipeline::KeepPicture(store, trial);
  return logged;
}

std::size_t BuildReport(const std::filesystem::path& store,
                        const std::filesystem::path& folder,
                        const report::ReachOf& reach_of) {
  pipeline::SelectionOptions options;
  options.store = store;
  options.with_evidence = true;
  report::ReportInput input =
      pipeline::InputOf(pipeline::SelectTrials(options));
  input.reach_of = reach_of;
  input.details = pipeline::DetailsBeside(store);
  pipeline::AddPictures(input);
  report::WriteReport(report::MakeReport(input), folder);
  return input.trials.size();
}

}  // namespace touchdown::review
