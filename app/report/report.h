// The Table 1 report: trials against the published boundary angles.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "app/report/contact_strip.h"
#include "app/report/details.h"
#include "app/report/shot_prediction.h"
#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/boundary_study.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/expected.h"
#include "touchdown/core/trial.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"

namespace touchdown::report {

// A boundary angle to compare trials of one body with, for information: only a
// campaign's own declared theory gets a verdict.
struct ReportTheory {
  core::BodyKind body = core::BodyKind::kSphere;
  analysis::TheoryBoundary boundary;
  std::string note;  // where it comes from, one sentence
};

// The paper's 11.8 deg (sphere) and 7.8 deg (rectangle), labelled published.
std::vector<ReportTheory> PublishedTheories();

// What the program said of a trial before a person revised it, and the person.
struct LabelPair {
  std::string trial;  // id
  core::MotionState by_program = core::MotionState::kUndecided;
  core::MotionState by_person = core::MotionState::kUndecided;
};

// The contact angles that can be thrown: the next angle stays within them.
struct Reach {
  core::Interval angle_rad;
  std::string by;  // in words: "what bench throws at 1.3 m/s"
};
// Of one campaign; absent with the reason where nothing can be thrown for it.
using ReachOf = std::function<core::Expected<Reach>(const core::Campaign&)>;

struct ReportInput {
  std::vector<core::Trial> trials;  // in any order; last revisions only
  std::vector<core::Campaign> campaigns;
  std::vector<LabelPair> labels;    // of the trials that bear both
  std::vector<db::PlanEvent> plan;  // of the campaigns, where a store has them
  std::vector<ReportTheory> theories = PublishedTheories();
  // How boundaries are estimated; what depends on the campaign (theory, margin,
  // origin) is filled in.
  analysis::StudyOptions study;
  ReachOf reach_of;  // empty: no rig was given, any angle can be thrown
  // The boundary is taken to be among the angles that can be thrown: they are
  // the support of its prior, where there are any.
  bool support_is_reach = false;
  // The rig that threw them; without facts none was given.
  RigUsed rig;
  // Whether every trial has a page of evidence (evidence_page.h) to link to,
  // and the pictures of the contacts where there are any, by trial id.
  bool evidence_pages = false;
  std::map<std::string, std::filesystem::path> pictures;
  // Of the recordings, by trial id: the contact as it was filmed, or why it is
  // not shown, and the path.
  std::map<std::string, ContactStrip> strips;
  std::map<std::string, std::string> no_strip;
  std::map<std::string, Trajectory> trajectories;
  // For the cover: what no trial knows; the day of the report, YYYY-MM-DD; when
  // the trials that were revised since had been logged, by id; the versions of
  // the lab's register that the trials name.
  Details details;
  std::string made_on;
  std::map<std::string, std::string> first_logged_utc;
  std::vector<db::Entry> register_entries;
  // Bins of the angle in Table 1; 0: a row an angle, or bins that fit a page.
  double bin_width_rad = 0.0;
  std::string title = "Table 1: slide or bounce at touchdown";
  std::string software_version;
  std::string options;  // how the report was asked for
  std::string source;   // where the trials come from
};

// Every text is a whole file.
struct Report {
  std::string markdown;
  std::string csv;  // one line a trial
  std::string html;
  std::string latex;       // Table 1 alone, to \input into a paper
  std::string json;        // touchdown.report/1: every number
  std::string csv_schema;  // the columns of `csv`, as the W3C's CSVW
};

// The files of a report, in their order in Report.
inline constexpr const char* kReportFiles[] = {
    "table1.md",  "table1.csv",  "table1.html",
    "table1.tex", "table1.json", "table1.csv-metadata.json"};

// Makes the report. The same input gives the same bytes: no clock, everything
// sorted. Throws std::invalid_argument where two campaigns have one name, and
// core::InputError where a plot cannot be drawn.
Report MakeReport(const ReportInput& input);

// Writes kReportFiles into `folder` (made where it is missing), each under a
// temporary name first. Throws core::InputError.
void WriteReport(const Report& report, const std::filesystem::path& folder);

}  // namespace touchdown::report
