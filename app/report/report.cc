// From the input to the files of a report: the trials are sorted and put into
// groups with all statistics (group.cc), the groups become one Document, and
// the Document is rendered as HTML and Markdown. CSV, LaTeX and JSON are made
// of the groups directly.
#include "app/report/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "app/report/boundary_json.h"
#include "app/report/content.h"
#include "app/report/document.h"
#include "app/text/format.h"
#include "app/text/text.h"
#include "app/text/text_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

// The order of the origins on the page: what was filmed stands first.
constexpr core::Origin kOrigins[] = {
    core::Origin::kRecorded, core::Origin::kManual, core::Origin::kSimulated};

// The first page: summary and warnings of the groups of one origin. Origins are
// never pooled, and a section of simulated trials bears the watermark.
Section MakeSummaries(std::span<const Group> groups,
                      std::span<const core::Trial> trials) {
  Section section{groups.front().simulated(), {}};
  auto& out = section.blocks;
  for (const Group& group : groups) {
    out.push_back(MakeSummary(group, trials));
    if (auto callout = MakeChecksCallout(group, groups, trials)) {
      out.push_back(std::move(*callout));
    }
    if (auto callout = MakeDependenceCallout(group, groups, trials)) {
      out.push_back(std::move(*callout));
    }
  }
  return section;
}

// Table 1 of the groups of one origin, with a figure of each group. `figures`
// counts the figures of the page, which makes their identifiers unique.
Section MakeTable1Section(std::span<const Group> groups,
                          std::span<const core::Trial> trials,
                          const ReportInput& input, std::size_t& figures) {
  Section section{groups.front().simulated(), {}};
  auto& out = section.blocks;
  out.push_back(PageBreak{});
  out.push_back(
      Heading{2, fmt::format("Table 1 and the boundary, {} trials",
                             core::Name(groups.front().trials.origin))});
  for (Table& table : MakeTable1(groups, trials, input)) {
    out.push_back(std::move(table));
  }
  out.push_back(Paragraph{
      "In the paper's two words: slide is every motion that is not a bounce "
      "(slide, roll-slide, roll, stick, stays-down). A bounce rises above the "
      "campaign's bounce height. u is the standard uncertainty of a measured "
      "angle; kinds of angle are never pooled.",
      true});
  for (const Group& group : groups) {
    out.push_back(MakeFigure(group, ++figures));
  }
  return section;
}

// How the numbers are made, for whoever has to defend them, and what identifies
// this report.
Section MakeMethods(const ReportInput& input, const std::string& csv) {
  Section section;
  auto& out = section.blocks;
  out.push_back(Heading{2, "Annex: how this report was made"});
  out.push_back(List{
      {fmt::format(
           "Boundary angle: posterior on a grid; this is the estimate. A trial "
           "at the measured angle x, known to u, bounces with probability "
           "Phi((x - boundary) / sqrt(scatter\u00b2 + u\u00b2)); the boundary "
           "is as likely anywhere from {} to {} deg beforehand, the scatter "
           "has the prior named beside the estimate. What the trials of a "
           "set-up share of u moves them together: one unknown offset a "
           "set-up, integrated.",
           Plain(input.study.fit.low_rad / core::kDegree),
           Plain(input.study.fit.high_rad / core::kDegree)) +
           " Undecided trials count by their P(bounce); those without one, "
           "because "
           "the film ends before the top of the rebound, are left out and "
           "listed.",
       "Likelihood profile: the same model without a prior; 95 % where twice "
       "the fall from the maximum is below 3.84. It guards the verdict: no "
       "scatter that the prior thinks unlikely may decide.",
       "Bracket: from the greatest angle at which a body stayed down to the "
       "least at which one bounced. It is exact only for exact angles and a "
       "boundary that does not scatter.",
       "Agreement: the theory predicts slide up to and including its boundary, "
       "bounce above it. A trial whose angle lies within 2 u of the boundary "
       "is too near to tell and is counted apart.",
       "Verdict, for the theory that the campaign declared before its first "
       "trial: confirmed where the 90 % interval of the boundary lies within "
       "the theory's value \u00b1 margin; contradicted where the 95 % interval "
       "lies wholly outside value \u00b1 (margin + U of the theory); else "
       "inconclusive. Either also needs that the best boundary which it denies "
       "fits 33 times worse than the best that it allows, each with whatever "
       "scatter suits it, and ten decided trials; confirmed needs both "
       "outcomes, angles that span two margins, and U below half the margin. "
       "By simulation at most 5 of 100 campaigns see a false verdict, in "
       "whatever of the designs tried, though they look after each of 60 "
       "trials. Simulated trials yield no verdict."}});
  // The digest is that of table1.csv: two reports of the same trials have the
  // same one, and a change in any cell of that file changes it.
  Table table{"", {{"made with"}, {""}}, {}};
  const auto row = [&](const char* name, const std::string& value) {
    if (!value.empty()) table.rows.push_back({{name}, {value}});
  };
  row("software", input.software_version.empty()
                      ? "touchdown"
                      : "touchdown " + input.software_version);
  row("options", input.options);
  row("source", input.source);
  row("trials", fmt::format("{}", input.trials.size()));
  row("digest of the trials", fmt::format("{:016x}", Digest(csv)));
  out.push_back(table);
  return section;
}

// "Report 2026-17, Laboratory, 2026-08-31": number or title, then what is known
// of laboratory and day. It stands below every printed page.
std::string MakeFooter(const ReportInput& input) {
  std::string out = input.details.number.empty()
                        ? input.title
                        : "Report " + input.details.number;
  for (const std::string& part : {input.details.laboratory, input.made_on}) {
    if (!part.empty()) out += ", " + part;
  }
  return out;
}

}  // namespace

Report MakeReport(const ReportInput& input) {
  // Groups hold indices into this sorted copy.
  std::vector<core::Trial> trials = input.trials;
  SortTrials(trials);
  const std::vector<Group> groups = MakeGroups(input, trials);

  Document document;
  document.title = input.title;
  document.footer = MakeFooter(input);
  auto& sections = document.sections;
  std::vector<std::vector<Group>> by_origin;
  for (const core::Origin origin : kOrigins) {
    std::vector<Group> same;
    std::copy_if(
        groups.begin(), groups.end(), std::back_inserter(same),
        [origin](const Group& g) { return g.trials.origin == origin; });
    if (!same.empty()) by_origin.push_back(std::move(same));
  }
  // A report of no trials is a report all the same: it says so.
  if (groups.empty()) {
    sections.push_back(
        {false,
         {Callout{"No trials.", "The store holds no trial for this report."}}});
  }
  // Page 1 is the summary; the cover and the contents follow it.
  for (const auto& same : by_origin) {
    sections.push_back(MakeSummaries(same, trials));
  }
  sections.push_back(MakeCover(input));
  sections.push_back({false, {Heading{3, "Contents"}, Contents{}}});
  // Results, then each group's pages, check shots, and the annexes.
  std::size_t figures = 0;
  for (const auto& same : by_origin) {
    sections.push_back(MakeTable1Section(same, trials, input, figures));
  }
  for (const Group& group : groups) {
    sections.push_back(MakeGroupSection(group, trials, input, figures));
  }
  for (const CheckShots& checks : CollectCheckShots(input, trials)) {
    sections.push_back(MakeCheckSection(checks, trials, input, figures));
  }
  for (const Group& group : groups) {
    sections.push_back(MakeStatistics(group, trials));
    // The annexes begin on a page of their own.
    if (&group == &groups.front()) {
      auto& blocks = sections.back().blocks;
      blocks.insert(blocks.begin(), PageBreak{});
    }
  }
  sections.push_back(MakePaperSection());
  const std::string csv = MakeCsv(groups, trials);
  sections.push_back(MakeMethods(input, csv));
  sections.push_back(MakeGlossary());
  sections.back().blocks.push_back(Paragraph{"End of the report.", true});
  Report out;
  out.markdown = ToMarkdown(document);
  out.csv = csv;
  out.html = ToHtml(document);
  out.csv_schema = CsvSchema();
  out.latex = MakeLatex(groups, trials, input);
  // Bytes that are not UTF-8 (in a path, say) become replacement characters
  // here: this document is for reading, and the store keeps the bytes.
  out.json = ReportDocument(input, groups, trials)
                 .dump(1, ' ', false,
                       nlohmann::ordered_json::error_handler_t::replace) +
             "\n";
  return out;
}

void WriteReport(const Report& report, const std::filesystem::path& folder) {
  std::error_code trouble;
  std::filesystem::create_directories(folder, trouble);
  if (trouble) {
    throw core::OutputError(
        fmt::format("{}: cannot be made: {}; give a folder that can",
                    folder.string(), trouble.message()));
  }
  // In the order of kReportFiles. Each file appears whole or not at all.
  const std::string* const texts[] = {&report.markdown, &report.csv,
                                      &report.html,     &report.latex,
                                      &report.json,     &report.csv_schema};
  for (std::size_t i = 0; i < std::size(texts); ++i) {
    WriteTextFile(folder / kReportFiles[i], *texts[i]);
  }
}

}  // namespace touchdown::report
