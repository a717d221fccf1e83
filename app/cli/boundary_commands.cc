// touchdown boundary, next, report: from trials to a boundary angle.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/boundary_flags.h"
#include "app/cli/command.h"
#include "app/pipeline/trial_selection.h"
#include "app/pipeline/version.h"
#include "app/report/boundary_json.h"
#include "app/report/format.h"
#include "app/report/group.h"
#include "app/report/report.h"
#include "app/report/sentences.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

using core::kDegree;

struct Answer {
  report::ReportInput input;
  std::vector<core::Trial> trials;
  std::vector<report::Group> groups;
};

report::ReportInput MakeInput(const BoundaryFlags& flags) {
  pipeline::Selection selection = pipeline::SelectTrials(MakeSelection(flags));
  report::ReportInput input;
  input.trials = std::move(selection.trials);
  input.campaigns = std::move(selection.campaigns);
  input.source = std::move(selection.source);
  input.software_version = std::string(pipeline::Version());
  input.study = MakeStudy(flags);
  // A file of bare angles is compared with the published boundary of the body
  // that it is said to be of.
  if (!flags.csv.empty() && flags.body.empty()) input.theories.clear();
  if (flags.csv.empty() && !flags.theory.empty()) {
    const core::Estimate theory = ParseTheory(flags.theory);
    for (const auto body :
         {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
      input.theories.push_back(
          {body,
           {flags.theory_name.empty() ? "theory" : flags.theory_name,
            theory.value, theory.u},
           "given for information"});
    }
  }
  return input;
}

Answer MakeAnswer(const BoundaryFlags& flags) {
  Answer out;
  out.input = MakeInput(flags);
  out.trials = std::move(out.input.trials);
  out.input.trials.clear();
  report::SortTrials(out.trials);
  out.groups = report::MakeGroups(out.input, out.trials);
  if (out.groups.empty()) {
    throw std::invalid_argument(fmt::format(
        "{}: no trial matches; give other filters or log trials first",
        out.input.source));
  }
  return out;
}

std::string Degrees(double angle_rad) {
  return fmt::format("{:.2f}", angle_rad / kDegree);
}

void PrintGroup(const report::Group& group) {
  const auto& study = group.study;
  const auto& p = study.posterior;
  const auto& l = study.likelihood;
  fmt::print("{}\n", report::FullName(group));
  if (group.simulated()) fmt::print("  SIMULATED: no verdict on a theory\n");
  fmt::print("  trials      {} slide, {} bounce, {} undecided, {} left out\n",
             study.counts.not_bounce, study.counts.bounce,
             study.counts.undecided, group.trials.left_out.size());
  fmt::print("  alone       {}\n", report::BracketSentence(study.bracket));
  fmt::print("  boundary    {} deg, 95 % {} to {} deg, 90 % {} to {} deg\n",
             Degrees(p.median_rad), Degrees(p.interval95_rad.low),
             Degrees(p.interval95_rad.high), Degrees(p.interval90_rad.low),
             Degrees(p.interval90_rad.high));
  for (const auto& line : p.sensitivity) {
    fmt::print(
        "              {} deg, 95 % {} to {} deg if the scatter is about "
        "{} deg\n",
        Degrees(line.median_rad), Degrees(line.interval95_rad.low),
        Degrees(line.interval95_rad.high),
        report::Plain(line.prior.median_rad / kDegree));
  }
  fmt::print("  likelihood  {}, 95 % {}{} to {}{} deg\n",
             l.has_estimate ? Degrees(l.estimate_rad) + " deg" : "no estimate",
             l.open_low ? "(open) " : "", Degrees(l.interval95_rad.low),
             Degrees(l.interval95_rad.high), l.open_high ? " (open)" : "");
  fmt::print("  status      {}: {}\n", analysis::Name(p.status),
             report::StatusSentence(study));
  for (const auto& t : study.theories) {
    fmt::print(
        "  theory      {} {} deg{}: E_n {:+.2f}, P(boundary below it) "
        "{:.3f}, smallest margin that passes {:.1f} deg\n",
        t.theory.name, report::Plain(t.theory.boundary_rad / kDegree),
        t.declared ? " (declared)" : "", t.e_n, t.p_below,
        t.smallest_margin_rad / kDegree);
    fmt::print("              {}\n", report::AgreementSentence(t));
  }
  fmt::print("  verdict     {}: {}\n", report::VerdictWord(group),
             report::VerdictSentence(group));
  const std::string outlook = report::OutlookSentence(group);
  if (!outlook.empty()) fmt::print("              {}\n", outlook);
}

int RunBoundary(const BoundaryFlags& flags) {
  const Answer answer = MakeAnswer(flags);
  if (flags.json) {
    fmt::print("{}\n", report::BoundaryDocument(answer.groups).dump(2));
    return 0;
  }
  bool first = true;
  for (const report::Group& group : answer.groups) {
    if (!first) fmt::print("\n");
    first = false;
    PrintGroup(group);
  }
  return 0;
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
                              const std::vector<core::Trial>& as_given,
                              const report::Group& group) {
  const auto study = MakeStudy(flags);
  if (flags.rule == "expected-variance") return group.study.next;
  analysis::NextAngle next;
  if (flags.rule == "neyer") {
    if (flags.guess.empty()) {
      throw std::invalid_argument(
          "--rule neyer: needs --guess-deg LOW:HIGH, between which the "
          "boundary "
          "is believed to lie");
    }
    const core::Interval guess = ParseRange("--guess-deg", flags.guess);
    next = analysis::NextNeyer(
        InOrder(as_given, group),
        {guess.low, guess.high, flags.guess_scatter_deg * kDegree,
         study.next.feasible_rad});
  } else if (flags.rule == "up-down") {
    next = analysis::NextUpDown(
        InOrder(as_given, group),
        {flags.start_deg * kDegree, flags.step_deg * kDegree,
         study.next.feasible_rad});
  } else {
    throw std::invalid_argument(
        fmt::format("--rule: '{}'; expected expected-variance, neyer or "
                    "up-down",
                    flags.rule));
  }
  // What there is to know does not depend on the rule.
  next.expected_sd_rad =
      analysis::ExpectedSd(group.study.posterior, next.angle_rad, study.next);
  next.half_width_rad = group.study.next.half_width_rad;
  next.stop = group.study.next.stop;
  next.trials_to_target = group.study.next.trials_to_target;
  return next;
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
    group.campaign.name = flags.campaign;
    analysis::StudyOptions study = input.study;
    group.prior = study.fit.scatter;
    group.study = analysis::StudyBoundary({}, study);
    groups.push_back(std::move(group));
  }
  report::Group& group = groups.front();
  group.study.next = ApplyRule(flags, as_given, group);
  const analysis::NextAngle& next = group.study.next;
  if (flags.json) {
    nlohmann::ordered_json document = report::BoundaryDocument(groups);
    for (const char* field :
         {"angle_deg", "expected_sd_deg", "trials_to_target"}) {
      document[field] = document["next"][field];
    }
    document["rule"] = flags.rule;
    fmt::print("{}\n", document.dump(2));
    return 0;
  }
  fmt::print("next angle        {} deg{}\n", Degrees(next.angle_rad),
             next.clipped ? " (the end of what is feasible)" : "");
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

int RunReport(const BoundaryFlags& flags, const std::string& options) {
  if (!flags.csv.empty() && flags.body.empty()) {
    throw std::invalid_argument(
        "--trials: a report needs --body sphere or rectangle, which the file "
        "does not say");
  }
  report::ReportInput input = MakeInput(flags);
  input.options = options;
  if (!flags.title.empty()) input.title = flags.title;
  const std::size_t n = input.trials.size();
  report::WriteReport(report::MakeReport(input), flags.out);
  const std::string page =
      (std::filesystem::path(flags.out) / "table1.html").string();
  if (flags.json) {
    const nlohmann::ordered_json document = {
        {"schema", "touchdown.report-files/1"},
        {"trials", n},
        {"folder", flags.out},
        {"files",
         {"table1.md", "table1.csv", "table1.html", "table1.tex",
          "table1.json"}}};
    fmt::print("{}\n", document.dump(2));
  } else {
    fmt::print("{} trials: {}\n", n, page);
  }
  return 0;
}

}  // namespace

void AddBoundary(CLI::App& app, Action& action) {
  auto flags = std::make_shared<BoundaryFlags>();
  CLI::App* command = app.add_subcommand(
      "boundary", "Estimate the boundary angle and compare it with theory");
  AddBoundaryFlags(*command, *flags);
  command->callback(
      [flags, &action] { action = [flags] { return RunBoundary(*flags); }; });
}

void AddNext(CLI::App& app, Action& action) {
  auto flags = std::make_shared<BoundaryFlags>();
  CLI::App* command =
      app.add_subcommand("next", "The angle to throw next, and when to stop");
  AddBoundaryFlags(*command, *flags);
  command
      ->add_option("--rule", flags->rule, "expected-variance, neyer or up-down")
      ->capture_default_str();
  command->add_option("--guess-deg", flags->guess,
                      "neyer: LOW:HIGH, between which the boundary should lie");
  command
      ->add_option("--guess-scatter-deg", flags->guess_scatter_deg,
                   "neyer: guessed scatter")
      ->capture_default_str();
  command->add_option("--start-deg", flags->start_deg, "up-down: first angle")
      ->capture_default_str();
  command->add_option("--step-deg", flags->step_deg, "up-down: step")
      ->capture_default_str();
  command->callback(
      [flags, &action] { action = [flags] { return RunNext(*flags); }; });
}

void AddReport(CLI::App& app, Action& action) {
  auto flags = std::make_shared<BoundaryFlags>();
  CLI::App* command = app.add_subcommand(
      "report", "Write table1.md, .csv, .html, .tex and .json");
  AddBoundaryFlags(*command, *flags);
  command->add_option("--out", flags->out, "folder for the report")
      ->capture_default_str();
  command->add_option("--title", flags->title, "title of the report");
  command->callback([flags, command, &action] {
    // The options as asked for, without where the report goes.
    std::string options;
    for (const CLI::Option* option : command->get_options()) {
      if (option->count() == 0 || option->check_name("--out") ||
          option->check_name("--json")) {
        continue;
      }
      options += (options.empty() ? "" : " ") + option->get_name(false, true);
      for (const std::string& result : option->results()) {
        if (result != "true") options += " " + result;
      }
    }
    action = [flags, options] { return RunReport(*flags, options); };
  });
}

}  // namespace touchdown::cli
