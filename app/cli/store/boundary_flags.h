// The flags that boundary, next and report share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "app/report/group.h"
#include "app/report/report.h"
#include "app/trials/trial_selection.h"
#include "touchdown/analysis/statistics/boundary_study.h"
#include "touchdown/core/estimate.h"

namespace CLI {
class App;
}

namespace touchdown::cli {

// What the user typed; made into options once all of it is there.
struct BoundaryFlags {
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
  std::optional<double> theory_u_deg;
  std::string theory_name;
  std::optional<double> margin_deg;
  double target_deg = 0.5;
  double set_u_deg = 0.5;
  std::string feasible;
  std::string support;
  int max_trials = 60;
  std::string rule = "expected-variance";
  std::string guess;
  double guess_scatter_deg = 2.0;
  double start_deg = 20.0;
  double step_deg = 1.0;
  std::string rig;
  double speed_mps = 0.0;  // at touchdown; 0: the middle of the campaign's band
  std::string corner;
  double bin_deg = 0.0;           // of Table 1; 0: as many as fit a page
  bool evidence = false;          // pages of evidence
  std::string evidence_pictures;  // folder in which their pictures are sought
  std::string out = ".";
  std::string title;
  std::string details;  // report.toml; empty: beside the store
  bool details_example = false;
  bool no_pictures = false;
  bool pdf = false;
  bool eln = false;
  bool json = false;
};

// Adds the flags of the source of trials, its filters, theory and stopping
// rule.
void AddBoundaryFlags(CLI::App& command, BoundaryFlags& flags);

// Check shots have no boundary and no next angle. Throws std::invalid_argument
// where `--campaign` names theirs.
void RefuseCheckShots(const BoundaryFlags& flags,
                      const report::ReportInput& input);

// A line for each trial that the statistics leave out, `heading` before the
// first and as much space before the others; the first few, and how many more.
void PrintLeftOut(const report::Group& group, std::string_view heading);

// What the flags ask for. Throw std::invalid_argument naming the flag.
pipeline::SelectionOptions MakeSelection(const BoundaryFlags& flags);
analysis::StudyOptions MakeStudy(const BoundaryFlags& flags);

// The selected trials with what they are to be compared with.
report::ReportInput MakeInput(const BoundaryFlags& flags,
                              bool with_evidence = false);

// Records that the answer of the trials' campaigns is looked at (db/plan.h),
// each once for the same trials. Called when nothing can be refused any more,
// since a refused command shows no answer. A store that cannot be written is
// told of, and the look goes on.
void KeepLook(const BoundaryFlags& flags, std::string_view command,
              std::span<const core::Trial> trials);

// Throws std::invalid_argument where the flag's value is not from 0 to 90.
void RequireDegrees(const char* flag, double value_deg);

// "11.8" or "11.8+-0.5", in degrees.
core::Estimate ParseTheory(const std::string& text);

// --theory-deg with the u of --theory-u-deg. Throws std::invalid_argument where
// both give one.
core::Estimate ReadTheory(const BoundaryFlags& flags);

// "5:40", in degrees, within 0:90.
core::Interval ParseRange(const char* flag, const std::string& text);

// "11.80": an angle as these commands print it.
std::string DegreesText(double angle_rad);

}  // namespace touchdown::cli
