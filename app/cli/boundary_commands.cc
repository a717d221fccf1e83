// touchdown boundary, next, report: from trials to a boundary angle.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

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

// What the user typed; made into options once all of it is there.
struct Flags {
  std::string store;
  std::string csv;
  bool paper_table1 = false;
  double paper_u_deg = 0.5;
  std::string campaign;
  std::string surface;
  std::string body;
  std::string angle_kind;
  std::string origin;
  std::string from;
  std::string until;
  bool reviewed = false;
  std::string theory;
  std::string theory_name;
  double margin_deg = 0.0;
  double target_deg = 0.5;
  double set_u_deg = 0.5;
  std::string feasible;
  int max_trials = 60;
  std::string rule = "expected-variance";
  std::string guess;
  double guess_scatter_deg = 2.0;
  double start_deg = 20.0;
  double step_deg = 1.0;
  std::string out = ".";
  std::string title;
  bool json = false;
};

double Number(const char* flag, std::string_view text, const char* form) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) {
    throw std::invalid_argument(
        fmt::format("{}: '{}'; expected {}", flag, text, form));
  }
  return value;
}

// "11.8" or "11.8+-0.5".
core::Estimate ParseTheory(const std::string& text) {
  constexpr const char* kForm = "degrees from 0 to 90, e.g. 11.8 or 11.8+-0.5";
  const std::size_t sign = text.find("+-");
  const double value =
      Number("--theory-deg", std::string_view(text).substr(0, sign), kForm);
  const double u = sign == std::string::npos
                       ? 0.0
                       : Number("--theory-deg",
                                std::string_view(text).substr(sign + 2), kForm);
  if (!(value >= 0.0 && value <= 90.0) || !(u >= 0.0)) {
    throw std::invalid_argument(
        fmt::format("--theory-deg: '{}'; expected {}", text, kForm));
  }
  return {value * kDegree, u * kDegree, {}};
}

// "5:40", in degrees.
core::Interval ParseRange(const char* flag, const std::string& text) {
  constexpr const char* kForm = "LOW:HIGH in degrees, e.g. 5:40";
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw std::invalid_argument(
        fmt::format("{}: '{}'; expected {}", flag, text, kForm));
  }
  const std::string_view view(text);
  const core::Interval range{
      Number(flag, view.substr(0, colon), kForm) * kDegree,
      Number(flag, view.substr(colon + 1), kForm) * kDegree};
  if (!(range.low < range.high)) {
    throw std::invalid_argument(fmt::format(
        "{}: '{}'; expected {}, low below high", flag, text, kForm));
  }
  return range;
}

template <class Parse>
auto Word(const char* flag, const std::string& text, Parse parse,
          const char* words) -> decltype(parse(text)) {
  if (text.empty()) return std::nullopt;
  auto parsed = parse(text);
  if (!parsed) {
    throw std::invalid_argument(
        fmt::format("{}: '{}'; expected {}", flag, text, words));
  }
  return parsed;
}

std::optional<std::string> Given(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return text;
}

pipeline::SelectionOptions MakeSelection(const Flags& flags) {
  pipeline::SelectionOptions out;
  out.store = flags.store;
  out.csv = flags.csv;
  out.paper_table1 = flags.paper_table1;
  if (!(flags.paper_u_deg >= 0.0 && flags.paper_u_deg <= 90.0)) {
    throw std::invalid_argument(
        fmt::format("--paper-u-deg: {}; expected 0 to 90", flags.paper_u_deg));
  }
  out.paper_u_rad = flags.paper_u_deg * kDegree;
  out.campaign = Given(flags.campaign);
  out.surface = Given(flags.surface);
  out.body =
      Word("--body", flags.body, core::ParseBodyKind, "sphere or rectangle");
  out.angle_kind = Word("--angle-kind", flags.angle_kind, core::ParseAngleKind,
                        "approach, radius or face");
  out.origin = Word("--origin", flags.origin, core::ParseOrigin,
                    "recorded, simulated or manual");
  out.from_utc = Given(flags.from);
  out.until_utc = Given(flags.until);
  out.reviewed_only = flags.reviewed;
  if (flags.margin_deg < 0.0) {
    throw std::invalid_argument(fmt::format(
        "--margin-deg: {}; expected more than 0", flags.margin_deg));
  }
  if (!flags.csv.empty() && !flags.theory.empty()) {
    const core::Estimate theory = ParseTheory(flags.theory);
    out.theory_name = flags.theory_name;
    out.theory_rad = theory.value;
    out.theory_u_rad = theory.u;
  }
  out.margin_rad = flags.margin_deg * kDegree;
  return out;
}

analysis::StudyOptions MakeStudy(const Flags& flags) {
  analysis::StudyOptions out;
  out.next.target_half_width_rad = flags.target_deg * kDegree;
  out.next.set_u_rad = flags.set_u_deg * kDegree;
  out.next.max_trials = flags.max_trials;
  if (!flags.feasible.empty()) {
    out.next.feasible_rad = ParseRange("--feasible-deg", flags.feasible);
  }
  return out;
}

struct Answer {
  report::ReportInput input;
  std::vector<core::Trial> trials;
  std::vector<report::Group> groups;
};

report::ReportInput MakeInput(const Flags& flags) {
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

Answer MakeAnswer(const Flags& flags) {
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

int RunBoundary(const Flags& flags) {
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

analysis::NextAngle ApplyRule(const Flags& flags,
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

int RunNext(const Flags& flags) {
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

int RunReport(const Flags& flags, const std::string& options) {
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

void AddSource(CLI::App& command, Flags& flags) {
  command.add_option("--db", flags.store, "trial store");
  command.add_option("--trials", flags.csv,
                     "CSV file with angle_deg, u_deg, p_bounce and, where "
                     "there were set-points, set_angle_deg");
  command.add_flag("--paper-table1", flags.paper_table1,
                   "the paper's own Table 1");
  command
      .add_option("--paper-u-deg", flags.paper_u_deg,
                  "assumed u of the paper's angles")
      ->capture_default_str();
  command.add_option("--campaign", flags.campaign, "only this campaign");
  command.add_option("--surface", flags.surface, "only this surface");
  command.add_option("--body", flags.body, "sphere or rectangle");
  command.add_option("--angle-kind", flags.angle_kind,
                     "approach, radius or face");
  command.add_option("--origin", flags.origin, "recorded, simulated or manual");
  command.add_option("--from", flags.from, "logged at this UTC time or later");
  command.add_option("--until", flags.until, "logged before this UTC time");
  command.add_flag("--reviewed", flags.reviewed,
                   "only trials that a person has corrected");
  command.add_option("--theory-deg", flags.theory,
                     "a theory's boundary, D or D+-u: of --trials the declared "
                     "one, else for information");
  command.add_option("--theory-name", flags.theory_name, "its name");
  command.add_option("--margin-deg", flags.margin_deg,
                     "equivalence margin, of --trials (default 1)");
  command.add_option("--feasible-deg", flags.feasible,
                     "angles the rig can throw, LOW:HIGH");
  command
      .add_option("--set-u-deg", flags.set_u_deg,
                  "repeatability of the ejector")
      ->capture_default_str();
  command
      .add_option("--target-deg", flags.target_deg,
                  "half-width of the 95 % interval to reach")
      ->capture_default_str();
  command.add_option("--max-trials", flags.max_trials, "stop there")
      ->capture_default_str();
  command.add_flag("--json", flags.json, "one JSON document");
}

}  // namespace

void AddBoundary(CLI::App& app, Action& action) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand(
      "boundary", "Estimate the boundary angle and compare it with theory");
  AddSource(*command, *flags);
  command->callback(
      [flags, &action] { action = [flags] { return RunBoundary(*flags); }; });
}

void AddNext(CLI::App& app, Action& action) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command =
      app.add_subcommand("next", "The angle to throw next, and when to stop");
  AddSource(*command, *flags);
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
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand(
      "report", "Write table1.md, .csv, .html, .tex and .json");
  AddSource(*command, *flags);
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
