// touchdown boundary and report lead from trials to a boundary angle. Both
// select trials by the same flags (boundary_flags.h), estimate one boundary for
// each group of trials that may be pooled, and record that the answer is looked
// at before they show it. `boundary` prints the groups, `report` writes files.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/store/boundary_flags.h"
#include "app/documents/pictures.h"
#include "app/report/boundary_json.h"
#include "app/report/eln_file.h"
#include "app/report/evidence_page.h"
#include "app/report/group.h"
#include "app/report/print_pdf.h"
#include "app/report/report.h"
#include "app/report/sentences.h"
#include "app/report_input/report_input.h"
#include "app/report_input/report_pictures.h"
#include "app/shots/rig_prediction.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {
namespace {

using core::kDegree;

// Holds the groups of `boundary` with what they were made of. `trials` are
// sorted as the tables are, and taken out of `input`: the groups refer to them
// by index.
struct Answer {
  report::ReportInput input;
  std::vector<core::Trial> trials;
  std::vector<report::Group> groups;
};

// Selects trials and estimates the boundary of each group. Throws
// std::invalid_argument where no trial matches or --campaign names check shots,
// which have no boundary.
Answer MakeAnswer(const BoundaryFlags& flags) {
  Answer out;
  out.input = MakeInput(flags);
  RefuseCheckShots(flags, out.input);
  out.trials = std::move(out.input.trials);
  out.input.trials.clear();
  // The order in which the store gives the trials must not change the answer.
  report::SortTrials(out.trials);
  out.groups = report::MakeGroups(out.input, out.trials);
  if (out.groups.empty()) {
    throw std::invalid_argument(fmt::format(
        "{}: no trial matches; give other filters or log trials first",
        out.input.source));
  }
  KeepLook(flags, "boundary", out.trials);
  return out;
}

// Prints one group for a person. Each line has its heading in the first 14
// columns; all angles are in degrees.
void PrintGroup(const report::Group& group) {
  const auto& study = group.study;
  const auto& p = study.posterior;
  const auto& l = study.likelihood;
  fmt::print("{}\n", report::FullName(group));
  if (group.simulated()) fmt::print("  SIMULATED: no verdict on a theory\n");
  fmt::print("  trials      {} slide, {} bounce, {} undecided, {} left out\n",
             study.counts.not_bounce, study.counts.bounce,
             study.counts.undecided, group.trials.left_out.size());
  PrintLeftOut(group, "  left out    ");
  fmt::print("  alone       {}\n", report::BracketSentence(study.bracket));
  fmt::print("  boundary    {} deg, 95 % {} to {} deg, 90 % {} to {} deg\n",
             DegreesText(p.median_rad), DegreesText(p.interval95_rad.low),
             DegreesText(p.interval95_rad.high),
             DegreesText(p.interval90_rad.low),
             DegreesText(p.interval90_rad.high));
  // The interval above may cover several priors on the scatter; how far it
  // reaches under the first alone shows what the others add.
  if (p.cautious_prior || p.sharp_prior) {
    fmt::print(
        "              {} to {} deg under the first of its priors on the "
        "scatter\n",
        DegreesText(analysis::Quantile(p, 0.025)),
        DegreesText(analysis::Quantile(p, 0.975)));
  }
  fmt::print(
      "  scatter     {} deg, 95 % {} to {} deg (sd of the estimate {} "
      "deg)\n",
      DegreesText(p.scatter_median_rad), DegreesText(p.scatter95_rad.low),
      DegreesText(p.scatter95_rad.high), DegreesText(p.sd_rad));
  // These lines give the same estimate under other priors on the scatter: where
  // they differ much, the trials say little.
  for (const auto& line : p.sensitivity) {
    fmt::print(
        "              {} deg, 95 % {} to {} deg if the scatter is about "
        "{} deg\n",
        DegreesText(line.median_rad), DegreesText(line.interval95_rad.low),
        DegreesText(line.interval95_rad.high),
        report::Plain(line.prior.median_rad / kDegree));
  }
  fmt::print(
      "  likelihood  {}, 95 % {}{} to {}{} deg\n",
      l.has_estimate ? DegreesText(l.estimate_rad) + " deg" : "no estimate",
      l.open_low ? "(open) " : "", DegreesText(l.interval95_rad.low),
      DegreesText(l.interval95_rad.high), l.open_high ? " (open)" : "");
  fmt::print("  status      {}: {}\n", analysis::Name(p.status),
             report::StatusSentence(study));
  // Each theory is compared; only the declared one gets the verdict below.
  for (const auto& t : study.theories) {
    fmt::print(
        "  theory      {} {} deg{}: E_n {}, P(boundary below it) {}, the 90 % "
        "interval fits a margin of {:.1f} deg\n",
        t.theory.name,
        report::WithU({t.theory.boundary_rad, t.theory.u_rad, {}}, kDegree),
        t.declared ? " (declared)" : "", report::Signed(t.e_n, 2),
        report::Probability(t.p_below), t.smallest_margin_rad / kDegree);
    fmt::print("              {}\n", report::AgreementSentence(t));
  }
  fmt::print("  verdict     {}: {}\n", report::VerdictWord(group),
             report::VerdictSentence(group));
  // Says how the verdict may still change; it is empty where there is nothing
  // to say.
  const std::string outlook = report::OutlookSentence(group);
  if (!outlook.empty()) fmt::print("              {}\n", outlook);
  fmt::print("  next angle  {}\n", report::NextSentence(group));
}

// `boundary`: prints each group as text, or all as one touchdown.boundary/1
// document. Returns 0.
int AnswerBoundary(const BoundaryFlags& flags) {
  const Answer answer = MakeAnswer(flags);
  if (flags.json) {
    fmt::print("{}\n",
               report::BoundaryDocument(answer.groups)
                   .dump(2, ' ', false,
                         nlohmann::ordered_json::error_handler_t::replace));
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

// `report`: writes the report into --out and says on stdout which file to open.
// `options` is the command line as the report quotes it. Returns 0; throws
// std::invalid_argument for a flag, core::InputError and core::OutputError for
// files.
int RunReport(const BoundaryFlags& flags, const std::string& options) {
  if (flags.details_example) {
    fmt::print("{}", report::DetailsExample());
    return 0;
  }
  // The report compares trials with the paper's boundary of one kind of body,
  // and bare angles do not tell which that is.
  if (!flags.csv.empty() && flags.body.empty()) {
    throw std::invalid_argument(
        "--trials: a report needs --body sphere or rectangle, which the file "
        "does not say");
  }
  RequireDegrees("--bin-deg", flags.bin_deg);
  report::ReportInput input = MakeInput(flags, true);
  input.options = options;
  input.details = flags.details.empty()
                      ? pipeline::ReadStoreDetails(flags.store)
                      : report::ReadDetails(flags.details);
  if (!flags.title.empty()) input.title = flags.title;
  const std::size_t n = input.trials.size();
  // Predicts every trial that has set-points, for the pages that compare what
  // the rig was set to with what was measured.
  if (!flags.rig.empty()) {
    input.rig = pipeline::PredictTrials(flags.rig, input.trials);
  }
  // Tables link to pages of evidence only where these are written below.
  input.evidence_pages = flags.evidence;
  // 0 leaves it to the report: a row for each angle, or bins that fit a page.
  input.bin_width_rad = flags.bin_deg * kDegree;
  // Pictures that the store keeps take precedence over those of the folder:
  // merge() leaves alone what is there.
  if (flags.evidence && !flags.store.empty()) {
    input.pictures = pipeline::KeptPictures(flags.store, input.trials);
  }
  if (!flags.evidence_pictures.empty()) {
    input.pictures.merge(
        pipeline::FindPictures(flags.evidence_pictures, input.trials));
  }
  if (!flags.no_pictures) {
    // Pages of evidence are one file a trial: they have room for all.
    pipeline::AddPictures(
        input, flags.evidence ? input.trials.size() : pipeline::kMostStrips);
  }
  KeepLook(flags, "report", input.trials);
  // The plan is read again, so that the report shows this very look.
  if (!flags.store.empty()) {
    input.plan =
        db::PlanEvents(db::Store::Open(flags.store, db::OpenMode::kRead));
  }
  // The five texts and the schema are on the disk before anything is made from
  // them: the PDF is printed from the page, the archive packs the files.
  report::WriteReport(report::MakeReport(input), flags.out);
  if (flags.evidence) report::WriteEvidencePages(input, flags.out);
  const std::string page =
      (std::filesystem::path(flags.out) / "table1.html").string();
  nlohmann::ordered_json files = report::kReportFiles;
  // --json lists what was written, so each extra file is added to the list.
  if (flags.pdf) {
    report::PrintPdf(page, std::filesystem::path(flags.out) / "table1.pdf");
    files.push_back("table1.pdf");
  }
  if (flags.eln) {
    report::WriteEln(input, flags.out);
    files.push_back("table1.eln");
  }
  if (flags.json) {
    const nlohmann::ordered_json document = {
        {"schema", "touchdown.report-files/1"},
        {"trials", n},
        {"folder", flags.out},
        {"files", files},
        {"evidence_pages", flags.evidence ? n : 0},
        {"pictures", input.pictures.size()},
        {"strips", input.strips.size()}};
    fmt::print("{}\n",
               document.dump(2, ' ', false,
                             nlohmann::ordered_json::error_handler_t::replace));
  } else {
    fmt::print("{} trial{}: {}", n, n == 1 ? "" : "s", page);
    if (flags.evidence) {
      fmt::print("; {} pages of evidence, {} with a picture", n,
                 input.pictures.size());
    }
    fmt::print("\n");
  }
  return 0;
}

}  // namespace

void AddBoundary(CLI::App& app, Action& action) {
  auto flags = std::make_shared<BoundaryFlags>();
  CLI::App* command =
      AddCommand(app, "boundary",
                 "Estimate the boundary angle and compare it with theory");
  AddBoundaryFlags(*command, *flags);
  SetAction(*command, action, [flags] { return AnswerBoundary(*flags); });
}

// `report` has its own flags besides those of boundary; --evidence takes its
// folder or stands alone, which CLI11 tells apart by its count.
void AddReport(CLI::App& app, Action& action) {
  auto flags = std::make_shared<BoundaryFlags>();
  CLI::App* command =
      AddCommand(app, "report",
                 "Write the report: table1.html, .md, .csv, .tex and .json");
  AddBoundaryFlags(*command, *flags);
  AddOption(*command, "--out", flags->out, "folder for the report")
      .ShowDefault();
  AddOption(*command, "--title", flags->title, "title of the report");
  AddOption(*command, "--details", flags->details,
            "report.toml: laboratory, customer, order, equipment, signatures "
            "(default: the one beside the store)");
  AddFlag(*command, "--details-example", flags->details_example,
          "print a commented report.toml, and nothing else");
  AddFlag(*command, "--no-pictures", flags->no_pictures,
          "no pictures of the contacts and no trajectories: the recordings are "
          "not opened");
  AddFlag(*command, "--pdf", flags->pdf,
          "also table1.pdf, tagged, printed by chromium");
  AddFlag(*command, "--eln", flags->eln,
          "also table1.eln, all of it for a laboratory notebook (RO-Crate in a "
          "zip archive)");
  AddOption(*command, "--bin-deg", flags->bin_deg,
            "width of the bins of the angle in Table 1 (default: one row an "
            "angle, bins where there are many)");
  const Option evidence =
      AddOption(
          *command, "--evidence", flags->evidence_pictures,
          "a page of evidence for every trial, in evidence/; with a folder, "
          "with the pictures that analyze or batch put there (--out)")
          .AllowNoValue()
          .NameType("[FOLDER]");
  // What was given is known after parsing only, so it is asked here.
  SetAction(*command, action, [flags, command, evidence] {
    flags->evidence = evidence.IsGiven();
    // The options as asked for, without where the report goes.
    std::string options;
    for (const GivenOption& option : ListGiven(*command)) {
      if (option.name == "--out" || option.name == "--json") continue;
      options += (options.empty() ? "" : " ") + option.name;
      if (option.is_flag) continue;
      for (const std::string& value : option.values) options += " " + value;
    }
    return RunReport(*flags, options);
  });
}

}  // namespace touchdown::cli
