// Gravity, size and restitution pooled over a group's trials, for a reader.
#include <fmt/core.h>

#include <algorithm>

#include "app/facts/campaign_checks.h"
#include "app/report/content.h"
#include "app/text/format.h"

namespace touchdown::report {
namespace {

// Whether any trial of the group was analysed from a clip. Trials that were
// typed have none, and there is nothing to check.
bool HasClips(const Group& group, std::span<const core::Trial> trials) {
  return std::any_of(
      group.members.begin(), group.members.end(),
      [&](std::size_t i) { return !trials[i].document_json.empty(); });
}

// One line of the table: trials, ratio in percent with its u, distance from 1
// in units of u, and the result. A check that could not be made has its reason
// in place of the result.
std::vector<Cell> CheckRow(const char* what,
                           const core::Expected<analysis::PooledCheck>& check) {
  if (!check) {
    return {{what}, {""}, {""}, {""}, {check.error().reason, Tone::kMuted}};
  }
  return {{what},
          {fmt::format("{}", check->trials)},
          {WithU(check->ratio, 0.01)},
          {Signed(check->z, 1)},
          {check->failed ? "failed" : "agrees",
           check->failed ? Tone::kBad : Tone::kPlain}};
}

}  // namespace

std::vector<Block> MakeChecks(const Group& group,
                              std::span<const core::Trial> trials) {
  if (!HasClips(group, trials)) return {};
  const CampaignChecks checks = CheckCampaign(group.members, trials);
  Table table{"Checks over all trials: measured over what it should be",
              {{"what"},
               {"trials", true},
               {"ratio, %", true},
               {"off by, u", true},
               {"result"}},
              {CheckRow("gravity from the flights", checks.gravity),
               CheckRow("size in the picture", checks.size),
               CheckRow("restitution, at most 1", checks.restitution)}};
  // A failed check gets its explanation in plain type; what the checks could
  // have shown is small print.
  std::vector<Block> out;
  out.push_back(std::move(table));
  out.push_back(Paragraph{
      checks.Failed() ? checks.explanation : WhatChecksShow(checks) + ".",
      !checks.Failed()});
  return out;
}

std::optional<Callout> MakeChecksCallout(const Group& group,
                                         std::span<const Group> groups,
                                         std::span<const core::Trial> trials) {
  if (!HasClips(group, trials)) return std::nullopt;
  const CampaignChecks checks = CheckCampaign(group.members, trials);
  const std::string name = ShortName(group, groups);
  // Only a failure is worth a box on the first page.
  if (checks.Failed()) {
    return Callout{name + ": " + checks.Suspects() + " is wrong.",
                   checks.explanation, Tone::kBad};
  }
  return std::nullopt;
}

}  // namespace touchdown::report
