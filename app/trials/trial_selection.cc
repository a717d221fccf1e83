#include "app/trials/trial_selection.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "app/trials/paper_trials.h"
#include "app/trials/trials_csv.h"
#include "touchdown/core/body.h"
#include "touchdown/core/nearest.h"
#include "touchdown/db/store.h"

namespace touchdown::pipeline {
namespace {

// Returns the campaign of that name, null for trials in none.
const core::Campaign* Find(const std::vector<core::Campaign>& campaigns,
                           const std::string& name) {
  const auto found =
      std::find_if(campaigns.begin(), campaigns.end(),
                   [&](const core::Campaign& c) { return c.name == name; });
  return found == campaigns.end() ? nullptr : &*found;
}

// Says whether a person ever corrected the trial. Exclusions are no review:
// they say nothing of the measurement.
bool IsReviewed(const db::Store& store, const std::string& id) {
  const auto history = store.History(id);
  return std::any_of(history.begin(), history.end(), [](const auto& revision) {
    return revision.kind == db::RevisionKind::kCorrected;
  });
}

// Nothing where the program never spoke, or no person after it.
std::optional<TwoLabels> FindLabels(const std::vector<db::Revision>& history,
                                    const std::string& id) {
  TwoLabels out{id};
  bool program = false;
  bool person = false;
  for (const auto& revision : history) {
    const core::MotionState label = revision.trial.first.state.label;
    // The program's last word is a logged revision with a document (one by hand
    // has none); the person's is the last correction. Proposals count for
    // neither.
    if (revision.kind == db::RevisionKind::kLogged &&
        !revision.trial.document_json.empty()) {
      out.by_program = label;
      program = true;
    } else if (revision.kind == db::RevisionKind::kCorrected) {
      out.by_person = label;
      person = true;
    }
  }
  if (!program || !person) return std::nullopt;
  return out;
}

// The versions of the register that the trials' conditions name.
std::vector<db::Entry> CollectEntries(const db::Store& store,
                                      const std::vector<core::Trial>& trials) {
  std::set<std::string> ids;
  for (const core::Trial& trial : trials) {
    if (!trial.conditions) continue;
    for (const db::ConditionEntry& entry : db::kConditionEntries) {
      ids.insert(((*trial.conditions).*entry.member).id);
    }
  }
  if (ids.empty()) return {};
  std::vector<db::Entry> out = db::AllVersions(store);
  std::erase_if(out, [&](const db::Entry& e) { return !ids.contains(e.id); });
  return out;
}

// Selects trials of a store. Filters that the store knows are part of the
// query; SelectTrials applies the rest. Throws core::StoreError, and
// std::invalid_argument for a campaign that is not there.
Selection FromStore(const SelectionOptions& options) {
  const db::Store store = db::Store::Open(options.store, db::OpenMode::kRead);
  db::TrialFilter filter;
  filter.campaign = options.campaign;
  filter.origin = options.origin;
  filter.body = options.body;
  filter.from_utc = options.from_utc;
  filter.until_utc = options.until_utc;
  filter.with_documents = options.with_evidence;
  Selection out;
  out.campaigns = store.Campaigns();
  // A misspelt name would give an empty report. The empty name stands for
  // trials in no campaign.
  if (options.campaign && !options.campaign->empty() &&
      Find(out.campaigns, *options.campaign) == nullptr) {
    std::vector<std::string> names;
    for (const auto& campaign : out.campaigns) names.push_back(campaign.name);
    throw std::invalid_argument(
        fmt::format("--campaign: there is no campaign '{}' in {}; {}",
                    *options.campaign, options.store.string(),
                    core::DidYouMean(*options.campaign, names,
                                     "see `touchdown campaign list`")));
  }
  out.plan = db::PlanEvents(store);
  out.trials = store.Trials(filter);
  if (options.reviewed_only) {
    std::erase_if(out.trials, [&](const core::Trial& trial) {
      return !IsReviewed(store, trial.id);
    });
  }
  if (options.with_evidence) {
    for (const core::Trial& trial : out.trials) {
      // One revision: nobody has revised it, and it was logged when it says.
      if (trial.revision < 2) continue;
      const std::vector<db::Revision> history = store.History(trial.id);
      if (auto labels = FindLabels(history, trial.id)) {
        out.labels.push_back(std::move(*labels));
      }
      out.first_logged_utc[trial.id] = history.front().trial.recorded_at_utc;
    }
    out.register_entries = CollectEntries(store, out.trials);
  }
  out.source = fmt::format("store {} ({})", options.store.filename().string(),
                           store.uuid());
  return out;
}

// Reads the trials of a CSV file into one campaign that is made up here: its
// name is the file's unless one was given. The options state what the file
// cannot say (body, kind, origin, theory); they do not filter.
Selection FromCsv(const SelectionOptions& options) {
  CsvTrials what;
  what.campaign = options.campaign.value_or(options.csv.stem().string());
  what.body = options.body.value_or(core::BodyKind::kSphere);
  what.angle_kind =
      options.angle_kind.value_or(core::DefaultAngleKind(what.body));
  what.origin = options.origin.value_or(core::Origin::kManual);
  Selection out;
  out.trials = ReadTrialsCsv(options.csv, what);
  core::Campaign campaign;
  campaign.name = what.campaign;
  campaign.body = core::UnmeasuredBody(what.body);
  campaign.angle_kind = what.angle_kind;
  campaign.surface = options.surface.value_or("");
  if (options.theory_rad) {
    campaign.theory_name =
        options.theory_name.empty() ? "theory" : options.theory_name;
    campaign.theory_boundary_rad = options.theory_rad;
    campaign.theory_u_rad = options.theory_u_rad;
  }
  if (options.margin_rad > 0.0) campaign.margin_rad = options.margin_rad;
  out.campaigns.push_back(campaign);
  out.source = "file " + options.csv.filename().string();
  return out;
}

// Takes the 18 trials of the paper's Table 1; they have no plan and no
// evidence.
Selection FromPaper(const SelectionOptions& options) {
  PaperTrials paper = PaperTable1Trials(options.paper_u_rad);
  return {std::move(paper.trials),
          std::move(paper.campaigns),
          {},
          "the paper's Table 1"};
}

}  // namespace

Selection SelectTrials(const SelectionOptions& options) {
  const int sources = (options.store.empty() ? 0 : 1) +
                      (options.csv.empty() ? 0 : 1) +
                      (options.paper_table1 ? 1 : 0);
  if (sources != 1) {
    throw std::invalid_argument(
        fmt::format("{} sources of trials were given; expected exactly one of "
                    "--db, --trials and --paper-table1",
                    sources));
  }
  if (options.store.empty() &&
      (options.from_utc || options.until_utc || options.reviewed_only)) {
    throw std::invalid_argument(
        "--from, --until and --reviewed need --db: a CSV file and the paper's "
        "Table 1 know neither dates nor reviews");
  }
  const bool from_csv = !options.csv.empty();
  Selection out = from_csv               ? FromCsv(options)
                  : options.paper_table1 ? FromPaper(options)
                                         : FromStore(options);
  if (from_csv) return out;
  // The filters are applied once more, to the paper's trials and for what the
  // store's query cannot ask (kind of angle, surface). A trial in no campaign
  // has no surface, so a filter by surface drops it.
  std::erase_if(out.trials, [&](const core::Trial& trial) {
    const core::Campaign* campaign = Find(out.campaigns, trial.campaign);
    return (options.campaign && trial.campaign != *options.campaign) ||
           (options.body && trial.body.kind != *options.body) ||
           (options.angle_kind && trial.angle_kind != *options.angle_kind) ||
           (options.origin && trial.origin != *options.origin) ||
           (options.surface &&
            (campaign == nullptr || campaign->surface != *options.surface));
  });
  return out;
}

}  // namespace touchdown::pipeline
