// touchdown next: the angle to throw, and the rig's settings for it.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/boundary_flags.h"
#include "app/cli/command.h"
#include "app/cli/rig_print.h"
#include "app/pipeline/rig_reach.h"
#include "app/report/boundary_json.h"
#include "app/report/format.h"
#include "app/report/group.h"
#include "app/report/sentences.h"
#include "touchdown/analysis/classic_designs.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/description.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::cli {
namespace {

using core::kDegree;

std::string Degrees(double angle_rad) {
  return fmt::format("{:.2f}", angle_rad / kDegree);
}

// Neyer's test and up-and-down want the trials as they were thrown: the order
// of a CSV file; of a store, the order in which trials were logged.
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

analysis::NextAngle ApplyRule(const BoundaryFlags& flags,
                              const analysis::NextAngleOptions& options,
                              const std::vector<core::Trial>& as_given,
                              const report::Group& group) {
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
  // What there is to know does not depend on the rule.
  next.expected_sd_rad =
      analysis::ExpectedSd(group.study.posterior, next.angle_rad, options);
  next.half_width_rad = group.study.next.half_width_rad;
  next.stop = group.study.next.stop;
  next.trials_to_target = group.study.next.trials_to_target;
  return next;
}

// The rig that throws, and what is asked of it.
struct Thrower {
  rig::Description rig;
  rig::ContactWish wish;
};

Thrower MakeThrower(const BoundaryFlags& flags, const report::Group& group) {
  Thrower out;
  out.rig = rig::ReadDescription(flags.rig);
  if (out.rig.body && out.rig.body->kind != group.campaign.body.kind) {
    throw std::invalid_argument(fmt::format(
        "--rig: the body of {} is a {}, the trials are of a {}", flags.rig,
        core::Name(out.rig.body->kind), core::Name(group.campaign.body.kind)));
  }
  out.wish.kind = group.campaign.angle_kind;
  const core::Campaign& campaign = group.campaign;
  out.wish.speed_mps =
      flags.speed_mps > 0.0
          ? flags.speed_mps
          : (campaign.speed_min_mps + campaign.speed_max_mps) / 2;
  if (!(out.wish.speed_mps > 0.0)) {
    throw std::invalid_argument(
        "--rig: needs --speed-mps, the speed at touchdown: the campaign "
        "declares no speed band");
  }
  if (!flags.corner.empty()) {
    out.wish.corner = core::ParseCorner(flags.corner);
    if (!out.wish.corner) {
      throw std::invalid_argument(fmt::format(
          "--corner: '{}'; expected leading, trailing or flush", flags.corner));
    }
  }
  return out;
}

// The study once more, with the angles that the rig can throw.
void KeepFeasible(const BoundaryFlags& flags, const Thrower& thrower,
                  report::Group& group, analysis::NextAngleOptions& options) {
  if (!flags.feasible.empty()) return;  // as the user says
  const auto reach = pipeline::ReachableAngles(thrower.rig, thrower.wish);
  if (!reach) {
    throw std::invalid_argument(
        fmt::format("--rig: {} cannot throw any {} angle at {:g} m/s: {}",
                    flags.rig, core::Name(thrower.wish.kind),
                    thrower.wish.speed_mps, reach.error().reason));
  }
  options.feasible_rad = *reach;
  group.study.next = analysis::ChooseNextAngle(
      group.study.posterior, group.study.counts.total(), options);
}

core::Expected<rig::SetPoint> PlanNext(const Thrower& thrower,
                                       double angle_rad) {
  // Enough for u to 1 %, and short beside the fit.
  constexpr std::size_t kDraws = 10'000;
  rig::ContactWish wish = thrower.wish;
  wish.angle_rad = angle_rad;
  std::mt19937_64 engine(1);
  return rig::PlanContact(thrower.rig, wish, {kDraws}, engine);
}

nlohmann::ordered_json SetPointsJson(
    const Thrower& thrower, const core::Expected<rig::SetPoint>& point) {
  nlohmann::ordered_json out = {
      {"rig", thrower.rig.name},
      {"speed_mps", thrower.wish.speed_mps},
      {"possible", point.has_value()},
      {"reason", point ? nlohmann::ordered_json(nullptr)
                       : nlohmann::ordered_json(point.error().reason)}};
  if (point) {
    out["elevation_deg"] = point->setting.elevation_rad / kDegree;
    out["compression_mm"] = point->setting.compression_m / core::kMillimetre;
    out["muzzle_height_mm"] =
        point->setting.muzzle_height_m / core::kMillimetre;
    out["contact"] = Json(point->contact);
  }
  return out;
}

void PrintSetPoints(const Thrower& thrower,
                    const core::Expected<rig::SetPoint>& point) {
  if (!point) {
    fmt::print("set-points        none: {}\n", point.error().reason);
    return;
  }
  fmt::print(
      "set-points        elevation {:.2f} deg, compression {:.2f} mm, muzzle "
      "height {:.1f} mm ({}, {:g} m/s at touchdown)\n{}{}",
      point->setting.elevation_rad / kDegree,
      point->setting.compression_m / core::kMillimetre,
      point->setting.muzzle_height_m / core::kMillimetre,
      thrower.rig.name.empty() ? "the rig" : thrower.rig.name,
      thrower.wish.speed_mps,
      Line("launch speed", point->contact.launch_speed_mps, 1.0, "m/s"),
      Text(point->contact.findings));
}

// The campaign without a trial yet: the one asked for, or what the flags say.
core::Campaign EmptyCampaign(const BoundaryFlags& flags,
                             const report::ReportInput& input) {
  for (const core::Campaign& campaign : input.campaigns) {
    if (campaign.name == flags.campaign) return campaign;
  }
  core::Campaign out;
  out.name = flags.campaign;
  if (!flags.body.empty()) {
    out.body.kind = *core::ParseBodyKind(flags.body);  // MakeInput() checked
  }
  out.angle_kind = flags.angle_kind.empty()
                       ? core::DefaultAngleKind(out.body.kind)
                       : *core::ParseAngleKind(flags.angle_kind);
  return out;
}

int RunNext(const BoundaryFlags& flags) {
  report::ReportInput input = MakeInput(flags);
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
  if (groups.empty()) {
    // Before the first trial there is nothing but the prior.
    report::Group group;
    group.campaign = EmptyCampaign(flags, input);
    analysis::StudyOptions study = input.study;
    group.prior = study.fit.scatter;
    group.study = analysis::StudyBoundary({}, study);
    groups.push_back(std::move(group));
  }
  report::Group& group = groups.front();
  analysis::NextAngleOptions options = MakeStudy(flags).next;
  std::optional<Thrower> thrower;
  if (!flags.rig.empty()) {
    thrower = MakeThrower(flags, group);
    KeepFeasible(flags, *thrower, group, options);
  }
  group.study.next = ApplyRule(flags, options, as_given, group);
  const analysis::NextAngle& next = group.study.next;
  if (flags.json) {
    nlohmann::ordered_json document = report::BoundaryDocument(groups);
    for (const char* field :
         {"angle_deg", "expected_sd_deg", "trials_to_target"}) {
      document[field] = document["next"][field];
    }
    document["rule"] = flags.rule;
    if (thrower) {
      document["set_points"] =
          SetPointsJson(*thrower, PlanNext(*thrower, next.angle_rad));
    }
    fmt::print("{}\n",
               document.dump(2, ' ', false,
                             nlohmann::ordered_json::error_handler_t::replace));
    return 0;
  }
  fmt::print("next angle        {} deg{}\n", Degrees(next.angle_rad),
             next.clipped ? " (the end of what is feasible)" : "");
  if (thrower) {
    PrintSetPoints(*thrower, PlanNext(*thrower, next.angle_rad));
  }
  fmt::print("boundary now      {}\n", report::BoundarySentence(group.study));
  fmt::print("sd after it       {} deg expected, {} deg now\n",
             Degrees(next.expected_sd_rad),
             Degrees(group.study.posterior.sd_rad));
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
      app.add_subcommand("next", "The angle to throw next, and when to stop");
  AddBoundaryFlags(*command, *flags);
  command
      ->add_option("--rule", flags->rule,
                   "expected-variance, neyer, 3pod or up-down")
      ->capture_default_str();
  command->add_option(
      "--guess-deg", flags->guess,
      "neyer, 3pod: LOW:HIGH, between which the boundary should "
      "lie");
  command
      ->add_option("--guess-scatter-deg", flags->guess_scatter_deg,
                   "neyer, 3pod: guessed scatter")
      ->capture_default_str();
  command->add_option("--start-deg", flags->start_deg, "up-down: first angle")
      ->capture_default_str();
  command->add_option("--step-deg", flags->step_deg, "up-down: step")
      ->capture_default_str();
  command->add_option("--rig", flags->rig,
                      "rig.toml: print its set-points, stay within its reach");
  command->add_option("--speed-mps", flags->speed_mps,
                      "with --rig: speed at touchdown (default: the middle of "
                      "the campaign's band)");
  command->add_option("--corner", flags->corner,
                      "with --rig: corner that lands first, leading, trailing "
                      "or flush");
  command->callback(
      [flags, &action] { action = [flags] { return RunNext(*flags); }; });
}

}  // namespace touchdown::cli
