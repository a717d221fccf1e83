// touchdown next says which angle to throw, and the rig's settings for it. The
// boundary is estimated as by `boundary`; a rule turns the estimate, or the
// bare outcomes in their order, into an angle, and the rig turns that into
// settings.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/rig/rig_print.h"
#include "app/cli/store/boundary_flags.h"
#include "app/cli/store/store_flags.h"
#include "app/report/boundary_json.h"
#include "app/report/group.h"
#include "app/report/sentences.h"
#include "app/session/next_shot.h"
#include "app/shots/thrower.h"
#include "app/text/format.h"
#include "touchdown/analysis/statistics/classic_designs.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::cli {
namespace {

using core::kDegree;

// Returns the group's observations in the order in which they were thrown,
// which Neyer's test, 3pod and up-and-down depend on. `as_given` has the order
// of the CSV file or, from a store, the order in which trials were logged. The
// list is empty where the group has no trial.
std::vector<analysis::Observation> InOrder(
    const std::vector<core::Trial>& as_given, const report::Group& group) {
  for (const auto& candidate : analysis::GroupTrials(as_given)) {
    if (candidate.campaign != group.trials.campaign ||
        candidate.body != group.trials.body ||
        candidate.angle_kind != group.trials.angle_kind ||
        candidate.origin != group.trials.origin) {
      continue;
    }
    std::vector<analysis::Observation> out = candidate.observations;
    std::sort(out.begin(), out.end(),
              [](const auto& a, const auto& b) { return a.trial < b.trial; });
    return out;
  }
  return {};
}

// Returns the next angle by --rule. Throws std::invalid_argument for an unknown
// rule, or one that lacks the guess that it needs.
analysis::NextAngle ApplyRule(const BoundaryFlags& flags,
                              const analysis::NextAngleOptions& options,
                              const std::vector<core::Trial>& as_given,
                              const report::Group& group) {
  // The study has applied its own rule already.
  if (flags.rule == "expected-variance") return group.study.next;
  analysis::NextAngle next;
  if (flags.rule == "neyer" || flags.rule == "3pod") {
    if (flags.guess.empty()) {
      throw std::invalid_argument(
          fmt::format("--rule {}: needs --guess-deg LOW:HIGH, between which "
                      "the boundary is believed to lie",
                      flags.rule));
    }
    const core::Interval guess = ParseRange("--guess-deg", flags.guess);
    const auto rule =
        flags.rule == "neyer" ? analysis::NextNeyer : analysis::NextThreePhase;
    next = rule(InOrder(as_given, group),
                {guess.low, guess.high, flags.guess_scatter_deg * kDegree,
                 options.feasible_rad});
  } else if (flags.rule == "up-down") {
    next =
        analysis::NextUpDown(InOrder(as_given, group),
                             {flags.start_deg * kDegree,
                              flags.step_deg * kDegree, options.feasible_rad});
  } else {
    throw std::invalid_argument(
        fmt::format("--rule: '{}'; expected expected-variance, neyer, "
                    "3pod or up-down",
                    flags.rule));
  }
  // The other rules give an angle only. What is known now, and when to stop,
  // does not depend on the rule.
  next.expected_sd_rad =
      analysis::ExpectedSd(group.study.posterior, next.angle_rad, options);
  next.half_width_rad = group.study.next.half_width_rad;
  next.stop = group.study.next.stop;
  next.trials_to_target = group.study.next.trials_to_target;
  return next;
}

// Returns the settings as the session writes them, with the predicted contact
// where there are settings.
nlohmann::ordered_json PlanJson(const pipeline::Thrower& thrower,
                                const core::Expected<rig::SetPoint>& point) {
  nlohmann::ordered_json out = session::SetPointsJson(thrower, point);
  if (point) out["contact"] = PredictionJson(point->contact);
  return out;
}

// Prints the settings or why there are none, the launch speed that they give,
// and what the springs' check found.
void PrintSetPoints(const pipeline::Thrower& thrower,
                    const core::Expected<rig::SetPoint>& point) {
  fmt::print("set-points        {}\n", session::SetPointsText(thrower, point));
  if (!point) return;
  fmt::print(
      "{}{}",
      ValueLine("launch speed", point->contact.launch_speed_mps, 1.0, "m/s"),
      FindingsText(point->contact.findings));
}

// Returns the campaign to begin where no trial matches: the declared one that
// was asked for, else one made from --body and --angle-kind.
core::Campaign EmptyCampaign(const BoundaryFlags& flags,
                             const report::ReportInput& input) {
  for (const core::Campaign& campaign : input.campaigns) {
    if (campaign.name == flags.campaign) return campaign;
  }
  core::Campaign out;
  out.name = flags.campaign;
  if (!flags.body.empty()) {
    // MakeInput() checked the word.
    out.body = core::UnmeasuredBody(*core::ParseBodyKind(flags.body));
  }
  out.angle_kind = flags.angle_kind.empty()
                       ? core::DefaultAngleKind(out.body.kind)
                       : *core::ParseAngleKind(flags.angle_kind);
  return out;
}

// Answers `next`, as text or as touchdown.boundary/1 with the fields of `next`
// at its top. Returns 0; throws std::invalid_argument where trials of several
// groups match, since one angle cannot serve two boundaries.
int RunNext(const BoundaryFlags& flags) {
  report::ReportInput input = MakeInput(flags);
  RefuseCheckShots(flags, input);
  // Two orders are kept: `as_given` for the rules that follow the throws,
  // `sorted` for the estimate, which must not depend on any order.
  const std::vector<core::Trial> as_given = std::move(input.trials);
  std::vector<core::Trial> sorted = as_given;
  report::SortTrials(sorted);
  input.trials.clear();
  std::vector<report::Group> groups = report::MakeGroups(input, sorted);
  if (groups.size() > 1) {
    std::string names;
    for (const auto& group : groups) {
      names += (names.empty() ? "" : "; ") + report::FullName(group);
    }
    throw std::invalid_argument(fmt::format(
        "{} groups of trials match ({}); choose one with --campaign, --body, "
        "--angle-kind or --origin",
        groups.size(), names));
  }
  // Without a trial the prior alone gives the first angle.
  if (groups.empty()) {
    groups.push_back(report::EmptyGroup(input, EmptyCampaign(flags, input)));
  }
  report::Group& group = groups.front();
  std::optional<pipeline::Thrower> thrower;
  if (!flags.rig.empty()) {
    thrower = pipeline::MakeThrower(flags.rig, group.campaign, flags.speed_mps,
                                    ReadCorner(flags.corner), flags.store);
    // The rig's description was read, but it cannot throw for this campaign.
    if (!group.reach) throw std::invalid_argument(group.reach.error().reason);
  }
  analysis::NextAngleOptions options = input.study.next;
  // An angle that no setting gives is moved to the nearest that one does.
  if (group.reach) options.feasible_rad = group.reach->angle_rad;
  group.study.next = ApplyRule(flags, options, as_given, group);
  KeepLook(flags, "next", as_given);
  const analysis::NextAngle& next = group.study.next;
  if (flags.json) {
    nlohmann::ordered_json document = report::BoundaryDocument(groups);
    // Scripts find the three numbers they want without knowing the groups.
    for (const char* field :
         {"angle_deg", "expected_sd_deg", "trials_to_target"}) {
      document[field] = document["next"][field];
    }
    document["rule"] = flags.rule;
    document["target_deg"] = flags.target_deg;
    document["max_trials"] = flags.max_trials;
    if (thrower) {
      document["set_points"] =
          PlanJson(*thrower, session::PlanNext(*thrower, next.angle_rad));
    }
    fmt::print("{}\n",
               document.dump(2, ' ', false,
                             nlohmann::ordered_json::error_handler_t::replace));
    return 0;
  }
  fmt::print("next angle        {}\n", report::NextSentence(group));
  fmt::print("rule              {}\n", flags.rule);
  if (thrower) {
    PrintSetPoints(*thrower, session::PlanNext(*thrower, next.angle_rad));
  }
  fmt::print("boundary now      {}\n", report::BoundarySentence(group.study));
  PrintLeftOut(group, "left out          ");
  fmt::print("sd after it       {} deg expected, {} deg now\n",
             DegreesText(next.expected_sd_rad),
             DegreesText(group.study.posterior.sd_rad));
  // The last line gives the reason to stop, or says how many trials are left.
  switch (next.stop) {
    case analysis::StopReason::kTargetReached:
      fmt::print("stop              the 95 % interval is within +- {} deg\n",
                 report::Plain(flags.target_deg));
      break;
    case analysis::StopReason::kMaxTrials:
      fmt::print("stop              {} trials were thrown\n",
                 group.study.counts.total());
      break;
    case analysis::StopReason::kNone:
      fmt::print(
          "trials to target  about {} until the 95 % interval is within "
          "+- {} deg\n",
          next.trials_to_target, report::Plain(flags.target_deg));
      break;
  }
  return 0;
}

}  // namespace

void AddNext(CLI::App& app, Action& action) {
  auto flags = std::make_shared<BoundaryFlags>();
  CLI::App* command =
      AddCommand(app, "next", "The angle to throw next, and when to stop");
  AddBoundaryFlags(*command, *flags);
  AddOption(*command, "--rule", flags->rule,
            "expected-variance, neyer, 3pod or up-down")
      .ShowDefault();
  AddOption(*command, "--guess-deg", flags->guess,
            "neyer, 3pod: LOW:HIGH, between which the boundary should lie");
  AddOption(*command, "--guess-scatter-deg", flags->guess_scatter_deg,
            "neyer, 3pod: guessed scatter")
      .ShowDefault();
  AddOption(*command, "--start-deg", flags->start_deg, "up-down: first angle")
      .ShowDefault();
  AddOption(*command, "--step-deg", flags->step_deg, "up-down: step")
      .ShowDefault();
  SetAction(*command, action, [flags] { return RunNext(*flags); });
}

}  // namespace touchdown::cli
