// touchdown campaign new|plan|list|show keeps the conventions of a campaign,
// which are fixed before its first trial, and its plan (db/plan.h), which may
// change with a reason.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/store/store_flags.h"
#include "app/cli/store/store_text.h"
#include "app/exchange/trial_json.h"
#include "app/trials/campaign_entry.h"
#include "touchdown/core/units.h"
#include "touchdown/db/names.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {
namespace {

using core::kDegree;
using core::kMillimetre;

// Holds the flags of all four commands, each of which uses some. `entry` holds
// the conventions as typed (trials/campaign_entry.h).
struct CampaignFlags {
  std::string db;
  pipeline::CampaignEntry entry;
  bool change = false;
  bool json = false;
  db::Plan plan;
  std::string by;
  std::string why;
};

// Returns `plan` with the fields that were typed; the others stay as they are.
db::Plan UpdatePlan(const CampaignFlags& flags, db::Plan plan) {
  for (const auto field :
       {&db::Plan::design, &db::Plan::stopping_rule, &db::Plan::error_rates}) {
    if (!(flags.plan.*field).empty()) plan.*field = flags.plan.*field;
  }
  return plan;
}

// The plan is kept in words: it is for readers of the report, and nothing in
// the program acts on it.
void AddPlanFlags(CLI::App& command, CampaignFlags& flags) {
  AddOption(command, "--design", flags.plan.design,
            "how angles are chosen, in words: '2 deg steps, ascending'");
  AddOption(command, "--stopping-rule", flags.plan.stopping_rule,
            "when to stop, in words: 'after 40 trials'");
  AddOption(command, "--error-rates", flags.plan.error_rates,
            "in words: 'false verdicts below 5 %, at every look'");
  AddOption(command, "--by", flags.by, "who declares it");
}

// Declares a campaign, in a new store where there is none; with --change,
// changes one that has no trials yet (the store refuses it otherwise). A plan
// that was given besides is recorded as the first.
int NewCampaign(const CampaignFlags& flags) {
  const core::Campaign campaign = pipeline::MakeCampaign(flags.entry);
  // A store is made only for what has been found right.
  db::RequireStorable(campaign);
  auto store = db::Store::Open(
      flags.db, flags.change ? db::OpenMode::kWrite : db::OpenMode::kCreate);
  if (flags.change) {
    store.ChangeCampaign(campaign);
  } else {
    store.AddCampaign(campaign);
  }
  const db::Plan plan = UpdatePlan(flags, {});
  // The program stands in for a name that was not given. A change of
  // conventions always has the same reason, so --why is not asked for.
  if (plan != db::Plan{}) {
    db::SetPlan(store, campaign.name, plan,
                flags.by.empty() ? "touchdown" : flags.by,
                flags.change ? "conventions changed" : "");
  }
  fmt::print("{}", CampaignText(campaign));
  return 0;
}

// Records a further plan of the campaign. Unlike conventions, a plan may change
// after the first trial; then the store wants a reason (--why).
int ChangePlan(const CampaignFlags& flags) {
  if (flags.by.empty()) {
    throw std::invalid_argument("--by is missing, must be who declares it");
  }
  auto store = db::Store::Open(flags.db, db::OpenMode::kWrite);
  // The events come oldest first, so the last plan among them is in force.
  db::Plan plan;
  for (const db::PlanEvent& event : db::PlanEvents(store, flags.entry.name)) {
    if (event.kind == db::PlanEventKind::kPlan) plan = event.plan;
  }
  const db::Plan next = UpdatePlan(flags, plan);
  if (next == plan) {
    throw std::invalid_argument(
        "--design, --stopping-rule and --error-rates say nothing new, must "
        "change or declare one of them");
  }
  db::SetPlan(store, flags.entry.name, next, flags.by, flags.why);
  return 0;
}

// Prints a table of all campaigns, or a touchdown.campaign/1 line for each. The
// table has degrees and millimetres, JSON has SI units.
int ListCampaigns(const CampaignFlags& flags) {
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  std::vector<std::vector<std::string>> rows = {
      {"campaign", "body", "surface", "varied angle", "bounce height, mm",
       "theory", "boundary, deg"}};
  for (const auto& campaign : store.Campaigns()) {
    if (flags.json) {
      fmt::print("{}\n", report::CampaignJson(campaign));
      continue;
    }
    rows.push_back(
        {Printable(campaign.name), BodyText(campaign.body),
         Printable(campaign.surface),
         std::string(core::Name(campaign.angle_kind)),
         fmt::format("{:.4g}", campaign.bounce_height_m / kMillimetre),
         campaign.theory_name.empty() ? "-" : Printable(campaign.theory_name),
         campaign.theory_boundary_rad
             ? fmt::format("{:.4g}", *campaign.theory_boundary_rad / kDegree)
             : "-"});
  }
  if (!flags.json) fmt::print("{}", Aligned(rows));
  return 0;
}

// Returns the campaign that was named; without a name the only one of the
// store. Throws core::StoreError where the name is unknown, and
// std::invalid_argument listing the names where there is a choice.
core::Campaign CampaignToShow(const db::Store& store, const std::string& name) {
  if (!name.empty()) return db::RequireCampaign(store, name);
  const auto campaigns = store.Campaigns();
  if (campaigns.size() == 1) return campaigns.front();
  std::string names;
  for (const auto& campaign : campaigns) {
    names += (names.empty() ? "" : ", ") + campaign.name;
  }
  throw std::invalid_argument(fmt::format(
      "NAME is missing, must be {}",
      names.empty() ? "a campaign: make one with `touchdown campaign new`"
                    : "one of: " + names));
}

// Prints one campaign with the number of its trials.
int ShowCampaign(const CampaignFlags& flags) {
  const auto store = db::Store::Open(flags.db, db::OpenMode::kRead);
  const core::Campaign campaign = CampaignToShow(store, flags.entry.name);
  if (flags.json) {
    fmt::print("{}\n", report::CampaignJson(campaign));
    return 0;
  }
  db::TrialFilter filter;
  filter.campaign = campaign.name;
  // The trials are only counted: their documents stay on the disk.
  filter.with_documents = false;
  fmt::print("{}trials: {}\n", CampaignText(campaign),
             store.Trials(filter).size());
  return 0;
}

}  // namespace

void AddCampaign(CLI::App& app, Action& action) {
  CLI::App* command =
      AddCommand(app, "campaign",
                 "trials of one body on one surface, with its conventions");
  RequireSubcommand(*command);
  // One set of flags serves all four: only one of them is called.
  auto flags = std::make_shared<CampaignFlags>();
  CLI::App* make =
      AddCommand(*command, "new", "declare a campaign before its first trial");
  AddOption(*make, "NAME", flags->entry.name, "of the campaign").Require();
  AddDbFlag(*make, flags->db);
  AddBodyFlags(*make, flags->entry.body);
  AddOption(*make, "--surface", flags->entry.surface, "e.g. 'asphalt, dry'");
  AddOption(*make, "--angle-kind", flags->entry.angle_kind,
            "the varied angle: approach (default for spheres), radius "
            "(rectangles) or face");
  AddOption(*make, "--bounce-height-mm", flags->entry.bounce_height_mm,
            "default: the larger of 0.5 and 2 % of the body's size");
  AddOption(*make, "--speed-mps", flags->entry.speed_mps,
            "band of the speed at touchdown, LOW:HIGH");
  AddOption(*make, "--theory", flags->entry.theory,
            "the one theory that gets a verdict");
  AddOption(*make, "--theory-boundary-deg", flags->entry.theory_boundary_deg,
            "its boundary angle");
  AddOption(*make, "--theory-u-deg", flags->entry.theory_u_deg,
            "standard uncertainty of that");
  AddOption(*make, "--margin-deg", flags->entry.margin_deg,
            "equivalence margin of the verdict")
      .ShowDefault();
  AddPlanFlags(*make, *flags);
  AddFlag(*make, "--change", flags->change,
          "change a campaign that has no trials yet");
  SetAction(*make, action, [flags] { return NewCampaign(*flags); });
  CLI::App* plan =
      AddCommand(*command, "plan",
                 "declare or change design, stopping rule and error rates");
  AddOption(*plan, "NAME", flags->entry.name, "of the campaign").Require();
  AddDbFlag(*plan, flags->db);
  AddPlanFlags(*plan, *flags);
  AddOption(*plan, "--why", flags->why,
            "reason of the change; needed after the first trial");
  SetAction(*plan, action, [flags] { return ChangePlan(*flags); });
  CLI::App* list = AddCommand(*command, "list", "all campaigns of a store");
  AddDbFlag(*list, flags->db);
  AddFlag(*list, "--json", flags->json, "one JSON line for each");
  SetAction(*list, action, [flags] { return ListCampaigns(*flags); });
  CLI::App* show = AddCommand(*command, "show", "one campaign");
  AddOption(*show, "NAME", flags->entry.name,
            "of the campaign; not needed where there is only one");
  AddDbFlag(*show, flags->db);
  AddFlag(*show, "--json", flags->json, "one JSON document");
  SetAction(*show, action, [flags] { return ShowCampaign(*flags); });
}

}  // namespace touchdown::cli
