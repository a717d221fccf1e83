#include "app/review/statistics.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "app/report/boundary_json.h"
#include "app/report/check_shots.h"
#include "app/report/content.h"
#include "app/report/group.h"
#include "app/report/report.h"
#include "app/report/sentences.h"
#include "app/report_input/report_input.h"
#include "app/text/json.h"
#include "touchdown/core/units.h"

namespace touchdown::review {
namespace {

using report::Json;

// Returns the class by which the page colours a cell.
std::string_view ToneName(report::Tone tone) {
  switch (tone) {
    case report::Tone::kSlide:
      return "slide";
    case report::Tone::kBounce:
      return "bounce";
    case report::Tone::kUndecided:
      return "undecided";
    case report::Tone::kGood:
      return "good";
    case report::Tone::kBad:
      return "bad";
    case report::Tone::kMuted:
      return "muted";
    case report::Tone::kPlain:
      break;
  }
  return "plain";
}

// Turns a table of the report into JSON: texts as they are printed, with their
// tone; the page computes none of them.
Json TableJson(const report::Table& table) {
  Json columns = Json::array();
  for (const auto& column : table.columns) {
    columns.push_back(
        {{"heading", column.heading}, {"numeric", column.numeric}});
  }
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json cells = Json::array();
    for (const auto& cell : row) {
      cells.push_back({{"text", cell.text}, {"tone", ToneName(cell.tone)}});
    }
    rows.push_back(std::move(cells));
  }
  return {{"caption", table.caption},
          {"columns", std::move(columns)},
          {"rows", std::move(rows)}};
}

// Trials of different origins are never in one table.
Json Table1Json(std::span<const report::Group> groups,
                std::span<const core::Trial> trials,
                const report::ReportInput& input) {
  Json out = Json::array();
  for (const core::Origin origin :
       {core::Origin::kRecorded, core::Origin::kManual,
        core::Origin::kSimulated}) {
    std::vector<report::Group> same;
    std::copy_if(groups.begin(), groups.end(), std::back_inserter(same),
                 [origin](const report::Group& group) {
                   return group.trials.origin == origin;
                 });
    if (same.empty()) continue;
    for (const auto& table : report::MakeTable1(same, trials, input)) {
      Json json = TableJson(table);
      json["origin"] = core::Name(origin);
      out.push_back(std::move(json));
    }
  }
  return out;
}

}  // namespace

Statistics MakeStatistics(const std::filesystem::path& store,
                          const report::ReachOf& reach_of) {
  pipeline::SelectionOptions options;
  options.store = store;
  report::ReportInput input =
      pipeline::MakeReportInput(pipeline::SelectTrials(options));
  // The trials are taken out and sorted as the report sorts them: groups refer
  // to them by index.
  input.reach_of = reach_of;
  std::vector<core::Trial> trials = std::move(input.trials);
  input.trials.clear();
  report::SortTrials(trials);
  const std::vector<report::Group> groups = report::MakeGroups(input, trials);

  Statistics out;
  Json json = {{"schema", "touchdown.review.statistics/1"},
               {"groups", Json::array()}};
  // The N-th plot belongs to the N-th group (/api/plots/N).
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const report::Group& group = groups[i];
    report::Figure figure = report::MakeFigure(group, i);
    Json one = report::BoundaryJson(group);
    one["name"] = report::FullName(group);
    one["plot"] = {{"alt", figure.alt}, {"caption", figure.caption}};
    out.plots.push_back(std::move(figure.svg));
    json["groups"].push_back(std::move(one));
  }
  json["table1"] = Table1Json(groups, trials, input);
  // Campaigns that have no trial yet are told with the angle to begin with.
  json["without_trials"] = Json::array();
  for (const core::Campaign& campaign : input.campaigns) {
    if (core::HasCheckShots(campaign)) continue;
    const bool thrown =
        std::any_of(groups.begin(), groups.end(), [&](const auto& group) {
          return group.trials.campaign == campaign.name;
        });
    if (thrown) continue;
    const report::Group empty = report::EmptyGroup(input, campaign);
    json["without_trials"].push_back(
        {{"campaign", campaign.name},
         {"angle_kind", core::Name(campaign.angle_kind)},
         {"first_angle_deg", empty.study.next.angle_rad / core::kDegree},
         {"next", report::NextSentence(empty)}});
  }
  json["check_shots"] = Json::array();
  for (const auto& checks : report::CollectCheckShots(input, trials)) {
    json["check_shots"].push_back(
        {{"campaign", checks.campaign.name},
         {"origin", core::Name(checks.origin)},
         {"speed", report::CheckSentence(checks.speed)},
         {"angle", report::CheckSentence(checks.angle)}});
  }
  out.json = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return out;
}

}  // namespace touchdown::review
