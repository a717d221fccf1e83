#include "app/review/trial_list.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

#include "app/exchange/trial_list.h"
#include "app/text/json.h"

namespace touchdown::review {
namespace {

using pipeline::Attention;
using pipeline::TriageEntry;
using report::Json;

// Beyond so many that are not known yet, all documents are read in one query.
constexpr std::size_t kOneByOne = 20;

// Lists the campaigns with how many of `trials` each has, excluded ones too.
Json CampaignsJson(const db::Store& store,
                   const std::vector<core::Trial>& trials) {
  Json out = Json::array();
  const auto count = [&](const std::string& name) {
    return std::count_if(
        trials.begin(), trials.end(),
        [&](const core::Trial& trial) { return trial.campaign == name; });
  };
  for (const core::Campaign& campaign : store.Campaigns()) {
    out.push_back({{"name", campaign.name},
                   {"body", core::Name(campaign.body.kind)},
                   {"surface", campaign.surface},
                   {"angle_kind", core::Name(campaign.angle_kind)},
                   {"theory", campaign.theory_name},
                   {"trials", count(campaign.name)}});
  }
  return out;
}

// Puts the document together; a store that is not there yet has the same
// fields.
Json ListJson(const std::filesystem::path& store, const std::string& id,
              std::size_t to_look_at, Json campaigns, Json rows) {
  return {{"schema", "touchdown.review.trials/1"},
          {"store", store.filename().string()},
          {"store_id", id},
          {"to_look_at", to_look_at},
          {"campaigns", std::move(campaigns)},
          {"trials", std::move(rows)}};
}

}  // namespace

std::vector<TriageEntry> TriageMemory::MakeEntries(
    const db::Store& store, const std::vector<core::Trial>& trials) {
  // The lock is held throughout: two tabs that open at once read the documents
  // once.
  const std::lock_guard lock(guard_);
  std::map<std::string, core::Trial> proposals;
  for (core::Trial& proposal : store.Proposals()) {
    proposals.emplace(proposal.id, std::move(proposal));
  }
  const auto proposal_of = [&](const core::Trial& trial) {
    const auto found = proposals.find(trial.id);
    return found == proposals.end() ? nullptr : &found->second;
  };
  // A proposal is a later revision than the one in force.
  const auto key = [&](const core::Trial& trial) {
    const core::Trial* proposal = proposal_of(trial);
    return std::pair(trial.id,
                     proposal != nullptr ? proposal->revision : trial.revision);
  };
  // `trial` must have its document, from which the warnings are read.
  const auto learn = [&](const core::Trial& trial) {
    known_[key(trial)] = pipeline::MakeTriageEntry(
        trial.clip.path, pipeline::Done::kKnown, trial, proposal_of(trial));
  };
  // After the first list few are unknown: those revised since.
  std::vector<const core::Trial*> unknown;
  for (const core::Trial& trial : trials) {
    if (!known_.contains(key(trial))) unknown.push_back(&trial);
  }
  if (unknown.size() > kOneByOne) {
    for (const core::Trial& trial : store.Trials()) learn(trial);
  } else {
    for (const core::Trial* trial : unknown) {
      if (const auto whole = store.Find(trial->id)) learn(*whole);
    }
  }
  std::vector<TriageEntry> out;
  out.reserve(trials.size());
  for (const core::Trial& trial : trials) {
    // One revised at this moment is known by its new revision.
    const auto found = known_.find(key(trial));
    out.push_back(found != known_.end()
                      ? found->second
                      : pipeline::MakeTriageEntry(trial.clip.path,
                                                  pipeline::Done::kKnown, trial,
                                                  proposal_of(trial)));
    // A person has looked at it already.
    if (trial.excluded) out.back().attention = Attention::kNone;
  }
  return out;
}

Json TrialListJson(const db::Store& store, TriageMemory& memory) {
  db::TrialFilter filter;
  filter.with_documents = false;
  const std::vector<core::Trial> trials = store.Trials(filter);
  const std::vector<TriageEntry> triage = memory.MakeEntries(store, trials);
  // The order of SortByNeed, of positions.
  // Positions are sorted and not entries: trials and triage stay side by side.
  std::vector<std::size_t> order(trials.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) {
                     return pipeline::NeedsMore(triage[a], triage[b]);
                   });
  Json rows = Json::array();
  std::size_t to_look_at = 0;
  for (const std::size_t i : order) {
    Json row = report::TrialRowJson(trials[i]);
    const bool look = triage[i].attention != Attention::kNone;
    to_look_at += look ? 1 : 0;
    row["attention"] =
        look ? Json(pipeline::Name(triage[i].attention)) : Json(nullptr);
    row["why"] = triage[i].reason;
    rows.push_back(std::move(row));
  }
  return ListJson(store.path(), store.uuid(), to_look_at,
                  CampaignsJson(store, trials), std::move(rows));
}

Json EmptyListJson(const std::filesystem::path& store) {
  return ListJson(store, "", 0, Json::array(), Json::array());
}

}  // namespace touchdown::review
