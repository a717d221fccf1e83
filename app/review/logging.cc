#include "app/review/logging.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/documents/log_analysis.h"
#include "app/documents/replay.h"
#include "app/report_input/report_input.h"
#include "app/report_input/report_pictures.h"
#include "app/review/fields.h"
#include "app/trials/statement.h"
#include "app/trials/typed_values.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/register.h"

namespace touchdown::review {
namespace {

using pipeline::FieldError;

// Under "conditions": what was filled in, by the keys of --condition.
std::optional<core::Conditions> ReadConditions(const nlohmann::json& asked) {
  std::optional<core::Conditions> conditions;
  const auto given = asked.find("conditions");
  if (given == asked.end()) return conditions;
  for (const auto& [key, value] : given->items()) {
    const std::string text = ReadTextField(*given, key.c_str());
    if (text.empty()) continue;
    if (!conditions) conditions.emplace();
    if (!pipeline::SetCondition(key, text, *conditions)) {
      throw FieldError(key, "is no condition of a shot");
    }
  }
  return conditions;
}

// Reads what a person states of a trial by hand. The kind of angle is not among
// it: it is the campaign's.
pipeline::Statement ReadStatement(const nlohmann::json& asked) {
  pipeline::Statement out;
  out.angle_deg = ReadNumberField(asked, "angle_deg");
  out.angle_u_deg = ReadNumberField(asked, "angle_u_deg");
  out.state = ReadTextField(asked, "state");
  out.corner = ReadTextField(asked, "corner");
  out.set_angle_deg = ReadNumberField(asked, "set_angle_deg");
  out.set_speed_mps = ReadNumberField(asked, "set_speed_mps");
  out.note = ReadTextField(asked, "note");
  out.conditions = ReadConditions(asked);
  return out;
}

}  // namespace

db::Logged LogTyped(const std::filesystem::path& store,
                    const nlohmann::json& asked) {
  pipeline::ManualEntry entry;
  // On the page a trial is always of a campaign, whose body it has.
  entry.campaign = RequiredText(asked, "campaign", "one of the campaigns");
  entry.by = RequiredText(asked, "who", "your name");
  entry.statement = ReadStatement(asked);
  return pipeline::LogByHand(store, entry);
}

AnalysisOrder ReadOrder(const std::filesystem::path& store,
                        const RecordingFolders& folders,
                        const nlohmann::json& asked) {
  AnalysisOrder order;
  order.campaign.name = RequiredText(asked, "campaign", "one of the campaigns");
  order.who = RequiredText(asked, "who", "your name");
  if (!asked.contains("recording")) {
    throw FieldError("recording", "is missing, must be one of the list");
  }
  order.recording = ReadRecording(asked["recording"]);
  // It is refused here if it lies outside of the folders.
  order.path = folders.Require(order.recording);
  order.again = asked.value("again", false);
  const auto open = db::Store::Open(store, db::OpenMode::kRead);
  pipeline::RequireCampaign(open, order.campaign.name);
  // The camera is mostly the one of the last shot; a person says if it is not.
  if (!asked.value("other_camera", false)) {
    order.camera = LastCamera(open, order.campaign.name)
                       .value_or(pipeline::AnalyzeOptions{});
  }
  pipeline::Statement setting;
  setting.set_angle_deg = ReadNumberField(asked, "set_angle_deg");
  setting.set_speed_mps = ReadNumberField(asked, "set_speed_mps");
  // Set-points are tried on a trial that nobody keeps, so that a wrong one is
  // refused with its field.
  core::Trial rehearsal;
  pipeline::Apply(setting, rehearsal);  // before the work, not after it
  order.set_angle_rad = rehearsal.set_angle_rad;
  order.set_speed_mps = rehearsal.set_speed_mps;
  order.conditions = ReadConditions(asked);
  if (order.conditions) {
    order.conditions = db::Resolved(open, *order.conditions);
  }
  return order;
}

std::optional<pipeline::AnalyzeOptions> LastCamera(
    const db::Store& store, const std::string& campaign) {
  db::TrialFilter filter;
  filter.campaign = campaign;
  filter.excluded = false;  // perhaps for its camera's sake
  // Documents are large: only those from the last trial back are read, until
  // one says what its camera was.
  filter.with_documents = false;
  std::optional<pipeline::AnalyzeOptions> camera;
  const std::vector<core::Trial> trials = store.Trials(filter);
  for (auto trial = trials.rbegin(); trial != trials.rend() && !camera;
       ++trial) {
    if (trial->clip.path.empty()) continue;
    if (const auto whole = store.Find(trial->id)) {
      camera = pipeline::ReadCameraOptions(*whole);
    }
  }
  return camera;
}

// The report is that of the whole store: no filter is set, and the evidence of
// the trials is in it.
std::size_t BuildReport(const std::filesystem::path& store,
                        const std::filesystem::path& folder,
                        const report::ReachOf& reach_of) {
  pipeline::SelectionOptions options;
  options.store = store;
  options.with_evidence = true;
  report::ReportInput input =
      pipeline::MakeReportInput(pipeline::SelectTrials(options));
  input.reach_of = reach_of;
  input.details = pipeline::ReadStoreDetails(store);
  pipeline::AddPictures(input);
  report::WriteReport(report::MakeReport(input), folder);
  return input.trials.size();
}

}  // namespace touchdown::review
