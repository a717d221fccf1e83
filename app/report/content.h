// The parts of the report. Internal to app/report.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/check_shots.h"
#include "app/report/document.h"
#include "app/report/group.h"
#include "app/report/report.h"

namespace touchdown::report {

// The Table 1 of groups that share an origin (paper_table.cc).
std::vector<Table> MakeTable1(std::span<const Group> groups,
                              std::span<const core::Trial> trials,
                              const ReportInput& input);

// What the cover block holds beside results (cover.cc), and why an entry of it
// is absent: "report.toml does not say customer.name".
Section MakeCover(const ReportInput& input);
std::string Where(std::string_view key, const ReportInput& input);

// What a reader wants first of a group, in plain words (summary.cc).
Terms MakeSummary(const Group& group, std::span<const core::Trial> trials);

// The words of the report (glossary.cc).
Section MakeGlossary();

// "diameter 40.000 ± 0.020 mm" (group_section.cc).
std::string SizeText(const core::Body& body);

// The group's own pages (group_section.cc).
Section MakeGroupSection(const Group& group,
                         std::span<const core::Trial> trials,
                         const ReportInput& input, std::size_t& figures);

// "shot7.mraw: approach angle 12.400 ± 0.050 deg, bounce": above the pictures
// of a contact (group_pictures.cc).
std::string StripCaption(const core::Trial& trial);

// The group's trajectories in one plot, and a strip of pictures a trial
// (group_pictures.cc). `figures` makes identifiers unique.
std::vector<Block> MakePictures(const Group& group,
                                std::span<const core::Trial> trials,
                                const ReportInput& input, std::size_t& figures);

// The annex of a group's numbers, in the order in which they should be read
// (group_statistics.cc).
Section MakeStatistics(const Group& group, std::span<const core::Trial> trials);

// Every trial of the group, its set-points, and what was left out
// (trial_tables.cc).
std::vector<Block> MakeTrialTables(const Group& group,
                                   std::span<const core::Trial> trials,
                                   const ReportInput& input);

// Labels of two kinds, budget, rig, calibration and software
// (evidence_tables.cc).
std::vector<Block> MakeEvidence(const Group& group,
                                std::span<const core::Trial> trials,
                                const ReportInput& input);

// The group's plot with its text (group_figure.cc). `index` makes identifiers
// unique.
Figure MakeFigure(const Group& group, std::size_t index);

// What the boundary depends on besides the angle, or drifted with, at p < 0.01:
// "order of the trials, speed at touchdown"; empty where no test says so.
std::string TellingDependence(const Group& group,
                              std::span<const core::Trial> trials);

// The score tests of what else the boundary may depend on; empty where nothing
// varies that could be tested.
std::vector<Block> MakeDependence(const Group& group,
                                  std::span<const core::Trial> trials);

// For page 1: that the trials do not have one boundary; nothing where no test
// says so.
std::optional<Callout> MakeDependenceCallout(
    const Group& group, std::span<const Group> groups,
    std::span<const core::Trial> trials);

// What was declared before the first trial, what was changed, who looked when,
// and what was excluded (plan_section.cc).
std::vector<Block> MakePlan(const Group& group,
                            std::span<const core::Trial> trials,
                            const ReportInput& input);

// Gravity, size and restitution pooled over the group, and what they can show
// (checks_section.cc).
std::vector<Block> MakeChecks(const Group& group,
                              std::span<const core::Trial> trials);

// For page 1: that scale, frame rate, size or ground are wrong in all trials;
// nothing where no check failed.
std::optional<Callout> MakeChecksCallout(const Group& group,
                                         std::span<const Group> groups,
                                         std::span<const core::Trial> trials);

// The control charts of one campaign's check shots (check_shots.cc).
Section MakeCheckSection(const CheckShots& checks,
                         std::span<const core::Trial> trials,
                         const ReportInput& input, std::size_t& figures);

// What the paper's own Table 1 supports, and its errata (paper_section.cc).
Section MakePaperSection();

// table1.csv and its schema, table1.csv-metadata.json (report_csv.cc).
std::string CsvSchema();
std::string MakeCsv(std::span<const Group> groups,
                    std::span<const core::Trial> trials);

// table1.tex (report_latex.cc).
std::string MakeLatex(std::span<const Group> groups,
                      std::span<const core::Trial> trials,
                      const ReportInput& input);

}  // namespace touchdown::report
