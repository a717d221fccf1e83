#include "app/demo/demo.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "app/documents/evidence.h"
#include "app/documents/log_analysis.h"
#include "app/documents/pictures.h"
#include "app/measure/analyze.h"
#include "app/report/evidence_page.h"
#include "app/report/report.h"
#include "app/report_input/report_input.h"
#include "app/report_input/report_pictures.h"
#include "app/simulate/simulate.h"
#include "app/trials/trial_selection.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/parallel.h"
#include "touchdown/core/units.h"
#include "touchdown/db/store.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;
using core::kMillimetre;

// What a caliper tells of a body: 0.02 mm.
constexpr double kCaliper_m = 0.02 * kMillimetre;

// Returns the body as a technician would state it: the sizes of the rendered
// one, with a caliper's u. The simulator's sizes are exact, and no lab has
// those.
core::Body Measured(const core::Body& made) {
  return made.kind == core::BodyKind::kSphere
             ? core::Sphere({made.diameter_m->value, kCaliper_m})
             : core::Rectangle({made.long_m->value, kCaliper_m},
                               {made.short_m->value, kCaliper_m});
}

// The campaign that a shot belongs to: one for each body.
core::Campaign PaperCampaign(const Shot& shot) {
  const bool sphere = shot.thrown.body.kind == core::BodyKind::kSphere;
  core::Campaign campaign;
  campaign.name = sphere ? "table 1, sphere" : "table 1, rectangle";
  campaign.body = Measured(shot.thrown.body);
  campaign.surface = "simulated";
  campaign.angle_kind = shot.angle_kind;
  campaign.bounce_height_m =
      core::DefaultBounceHeight(core::Size(campaign.body)->value);
  campaign.theory_name = "published";
  constexpr double kSphere_deg = 11.8;    // the paper's Table 1
  constexpr double kRectangle_deg = 7.8;  //
  campaign.theory_boundary_rad =
      (sphere ? kSphere_deg : kRectangle_deg) * kDegree;
  return campaign;
}

// States size, kind of angle and bounce height to the analysis, which a lab
// fixes beforehand. Ground and contact are left to be found.
AnalyzeOptions MakeOptions(const core::Campaign& campaign) {
  AnalyzeOptions options;
  if (campaign.body.kind == core::BodyKind::kSphere) {
    options.diameter_m = *campaign.body.diameter_m;
  } else {
    options.long_m = *campaign.body.long_m;
    options.short_m = *campaign.body.short_m;
  }
  options.angle_kind = campaign.angle_kind;
  options.bounce_height_m = campaign.bounce_height_m;
  return options;
}

}  // namespace

bool DemoRow::right() const {
  // The comparison is made in the paper's two words: rolling where the truth is
  // sliding is right.
  if (state == core::MotionState::kUndecided) return false;
  return core::IsNotBounce(state) == core::IsNotBounce(true_state);
}

DemoResult RunDemo(const DemoOptions& options) {
  // Step 1: render and analyse, a clip a thread. A clip's noise depends on the
  // seed and its name, so the order of the threads changes no answer.
  const std::vector<Shot> shots = Table1Shots();
  const int n = static_cast<int>(shots.size());
  const int threads = core::CountThreads(options.threads);
  DemoResult result;
  result.rows.resize(shots.size());
  std::vector<Analysis> analyses(shots.size());
  std::mutex guard;
  int done = 0;

  const auto make = [&](std::size_t at) {
    const Shot& shot = shots[at];
    SimulateOptions simulate;
    simulate.folder = options.folder / "clips";
    simulate.seed = options.seed;
    const SimulatedClip made = WriteShot(shot, simulate);
    AnalyzeOptions analyze = MakeOptions(PaperCampaign(shot));
    analyze.limit_s = options.limit_s;
    analyses[at] = Analyze(made.clip, analyze);
    WriteEvidence(analyses[at], options.folder / "evidence" / shot.name);
    const Analysis& a = analyses[at];
    DemoRow& row = result.rows[at];
    row.clip = shot.name;
    row.kind = shot.angle_kind;
    // The set angle is the true one: the shots of table1.cc land at it.
    row.true_angle_rad = *shot.set_angle_rad;
    row.angle_rad =
        core::ContactAngle(a.contacts.first.contact, shot.angle_kind);
    row.true_state = made.truth.state;
    row.state = a.contacts.first.state.label;
    row.analyze_s = a.timing.total_s;
    row.frames = a.clip.frames;
    const std::lock_guard lock(guard);
    ++done;
    if (options.progress) {
      options.progress(static_cast<double>(done) / n, shot.name);
    }
  };
  // Whichever thread is free takes the next: clips take unlike times.
  std::atomic<std::size_t> next{0};
  core::InParallel(threads, threads, [&](auto, auto) {
    for (std::size_t i = next++; i < shots.size(); i = next++) make(i);
  });

  result.store = options.folder / "demo.db";
  // Step 2: log in the order of the table, on one thread: a Store belongs to
  // one thread.
  db::Store store = db::Store::Open(result.store, db::OpenMode::kCreate);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const core::Campaign campaign = PaperCampaign(shots[i]);
    // A second run finds its campaigns there, and its clips make further
    // revisions of the trials.
    if (!store.FindCampaign(campaign.name)) store.AddCampaign(campaign);
    core::Trial trial = LoggableTrial(analyses[i], &campaign);
    trial.set_angle_rad = shots[i].set_angle_rad;
    store.LogTrial(trial);
  }

  // Step 3: compare with the truth. The mean is over trials that have an angle;
  // `angles` says how many.
  double square = 0.0;
  for (const DemoRow& row : result.rows) {
    result.right += row.right();
    if (!row.angle_rad) continue;
    const double error = row.angle_rad->value - row.true_angle_rad;
    square += error * error;
    ++result.angles;
  }
  result.rmse_rad = result.angles > 0 ? std::sqrt(square / result.angles) : 0.0;

  // Step 4: report from the store, as `touchdown report` does from a lab's. The
  // title says that the outcome was chosen, wherever the page ends up.
  SelectionOptions select;
  select.store = result.store;
  select.with_evidence = true;
  report::ReportInput input = MakeReportInput(SelectTrials(select));
  input.source =
      "the demo's store: rendered clips, whose speeds, friction and "
      "restitution "
      "were chosen so that the paper's Table 1 comes out; that it does says "
      "nothing of the theory";
  input.title =
      "Table 1 from rendered clips, whose physics was chosen so that it comes "
      "out";
  input.evidence_pages = true;
  input.pictures = FindPictures(options.folder / "evidence", input.trials);
  AddPictures(input);
  report::WriteReport(report::MakeReport(input), options.folder / "report");
  report::WriteEvidencePages(input, options.folder / "report");
  result.report = options.folder / "report" / "table1.html";
  return result;
}

}  // namespace touchdown::pipeline
