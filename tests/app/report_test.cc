#include "app/report/report.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/report/gnuplot.h"
#include "app/text/text.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;
using ::testing::HasSubstr;

bool Has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

// What page 1 says of the theory begins with.
const std::string kTheory = "**Does the theory agree**: ";

int Count(const std::string& text, std::string_view part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + 1)) {
    ++n;
  }
  return n;
}

struct Shot {
  double set_deg;
  double angle_deg;
  bool bounced;
};

core::Trial MakeTrial(const Shot& shot, core::BodyKind body,
                      core::Origin origin) {
  core::Trial trial;
  trial.origin = origin;
  trial.campaign =
      std::string(core::Name(origin)) + "-" + std::string(core::Name(body));
  trial.body =
      body == core::BodyKind::kSphere
          ? core::Sphere({40 * kMillimetre, 0.02 * kMillimetre})
          : core::Rectangle({60 * kMillimetre, 0.0}, {30 * kMillimetre, 0.0});
  const core::Estimate angle{shot.angle_deg * kDegree, 0.048 * kDegree};
  core::Contact& contact = trial.first.contact;
  contact.found = true;
  if (body == core::BodyKind::kSphere) {
    contact.approach_angle_rad = angle;
  } else {
    trial.angle_kind = core::AngleKind::kFace;
    contact.face_angle_rad = angle;
  }
  trial.set_angle_rad = shot.set_deg * kDegree;
  auto& state = trial.first.state;
  state.label =
      shot.bounced ? core::MotionState::kBounce : core::MotionState::kSlide;
  state.p_bounce = shot.bounced ? 0.9999 : 0.0002;
  state.max_gap_m = core::Estimate{(shot.bounced ? 13.4 : 0.05) * kMillimetre,
                                   0.05 * kMillimetre};
  state.bounce_height_m = core::Estimate{0.8 * kMillimetre, 0.0};
  trial.clip.path = "clips/" + trial.campaign + "-" +
                    std::to_string(static_cast<int>(shot.set_deg * 10)) +
                    ".avi";
  trial.id = trial.clip.path;
  trial.revision = 1;
  return trial;
}

ReportInput Table1Input(core::Origin origin) {
  ReportInput input;
  const double set[] = {0, 3.9, 7.8, 11.8, 27.4, 43, 58.7, 74.4, 90};
  for (const auto body :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    const double boundary = body == core::BodyKind::kSphere ? 12.0 : 8.0;
    for (int i = 0; i < 9; ++i) {
      input.trials.push_back(
          MakeTrial({set[i], set[i] + 0.013 * (i % 3 - 1), set[i] > boundary},
                    body, origin));
    }
    core::Campaign campaign;
    campaign.name = input.trials.back().campaign;
    campaign.body = input.trials.back().body;
    campaign.surface = "asphalt, dry";
    campaign.angle_kind = input.trials.back().angle_kind;
    campaign.theory_name = "published";
    campaign.theory_boundary_rad =
        (body == core::BodyKind::kSphere ? 11.8 : 7.8) * kDegree;
    input.campaigns.push_back(campaign);
  }
  input.software_version = "0.1.0";
  return input;
}

TEST(MakeReport, SimulatedTrialsAreWatermarkedAndGetNoVerdict) {
  const Report report = MakeReport(Table1Input(core::Origin::kSimulated));
  EXPECT_TRUE(Has(report.html, "class=\"simulated\""));
  EXPECT_TRUE(Has(report.html, "SIMULATED"));
  EXPECT_TRUE(Has(report.html, "yield no verdict"));
  EXPECT_TRUE(Has(report.markdown, "SIMULATED"));
  for (const char* verdict : {"Confirmed.", "Contradicted.", "Inconclusive."}) {
    EXPECT_FALSE(Has(report.markdown, kTheory + verdict));
  }
  // Every line of the CSV bears the mark.
  std::istringstream csv(report.csv);
  std::string line;
  std::getline(csv, line);
  int lines = 0;
  while (std::getline(csv, line)) {
    EXPECT_THAT(line, HasSubstr(",simulated,SIMULATED,"));
    ++lines;
  }
  EXPECT_EQ(lines, 18);
}

TEST(MakeReport, RecordedTrialsGetAVerdictAndNoWatermark) {
  const Report report = MakeReport(Table1Input(core::Origin::kRecorded));
  EXPECT_FALSE(Has(report.html, "class=\"simulated\""));
  EXPECT_TRUE(Has(report.markdown, kTheory + "Inconclusive."));
}

// Sixty shots about a boundary that rises by 2.4 deg from the first to the last
// of them; `in_order` false: the same shots, logged in a random order.
ReportInput Drifting(bool in_order) {
  ReportInput input;
  std::mt19937_64 engine(24);
  std::uniform_real_distribution<double> around(-3.0, 3.0);
  std::vector<int> order(60);
  for (int i = 0; i < 60; ++i) order[static_cast<std::size_t>(i)] = i;
  std::vector<Shot> shots;
  for (int i = 0; i < 60; ++i) {
    const double angle = 11.8 + around(engine);
    shots.push_back({angle, angle, angle > 11.8 + 2.4 * (i / 59.0 - 0.5)});
  }
  if (!in_order) std::shuffle(order.begin(), order.end(), engine);
  for (int i = 0; i < 60; ++i) {
    const auto k = static_cast<std::size_t>(i);
    auto trial =
        MakeTrial(shots[k], core::BodyKind::kSphere, core::Origin::kRecorded);
    trial.set_angle_rad.reset();
    trial.id = trial.clip.path = fmt::format("clips/{:02d}.avi", i);
    trial.recorded_at_utc =
        fmt::format("2026-08-01T10:{:02d}:00.000Z", order[k]);
    input.trials.push_back(trial);
  }
  core::Campaign campaign;
  campaign.name = input.trials.back().campaign;
  campaign.body = input.trials.back().body;
  campaign.theory_name = "published";
  campaign.theory_boundary_rad = 11.8 * kDegree;
  campaign.margin_rad = 2.0 * kDegree;
  input.campaigns.push_back(campaign);
  return input;
}

TEST(MakeReport, ABoundaryThatDriftsIsNotConfirmed) {
  const Report steady = MakeReport(Drifting(false));
  EXPECT_TRUE(Has(steady.markdown, kTheory + "Confirmed.")) << steady.markdown;
  const Report drifting = MakeReport(Drifting(true));
  EXPECT_TRUE(Has(drifting.markdown, kTheory + "Inconclusive."));
  EXPECT_TRUE(Has(drifting.markdown, "only its average lies within"));
  EXPECT_TRUE(Has(drifting.markdown, "not one boundary"));
  // What would decide is another campaign, not more of this one.
  EXPECT_FALSE(Has(drifting.markdown, "would decide,"));
  EXPECT_TRUE(
      Has(drifting.markdown, "More trials of the same kind cannot confirm it"));
}

TEST(MakeReport, ADriftIsTheReasonOfWhatIsInconclusiveAnyway) {
  ReportInput input = Drifting(true);
  input.campaigns.back().margin_rad = 0.2 * kDegree;
  const Report report = MakeReport(input);
  EXPECT_TRUE(Has(report.markdown, kTheory + "Inconclusive."));
  EXPECT_TRUE(Has(report.markdown, "these trials have no one boundary; "));
  EXPECT_FALSE(Has(report.markdown, "would decide,"));
}

TEST(MakeReport, ThePlanOnRecordIsTold) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  const std::string sphere = input.campaigns[0].name;
  Report report = MakeReport(input);
  EXPECT_TRUE(Has(report.markdown, "The plan on record"));
  EXPECT_TRUE(Has(report.markdown, "declared before the first trial"));
  EXPECT_TRUE(Has(report.markdown, "not declared"));
  const db::Plan plan{"the paper's grid", "after 9 trials", "5 %"};
  db::Plan changed = plan;
  changed.stopping_rule = "after 40 trials";
  input.plan = {{"a", sphere, db::PlanEventKind::kPlan, plan, 0, "A. Tester",
                 "", "2026-08-01T09:00:00.000Z"},
                {"b",
                 sphere,
                 db::PlanEventKind::kLook,
                 {},
                 5,
                 "report",
                 "",
                 "2026-08-02T09:00:00.000Z"},
                {"c", sphere, db::PlanEventKind::kPlan, changed, 5, "A. Tester",
                 "too few to tell", "2026-08-03T09:00:00.000Z"}};
  input.trials[0].excluded = true;
  input.trials[0].exclusion_reason = "the spring stuck";
  input.trials[0].recorded_at_utc = "2026-08-04T09:00:00.000Z";
  report = MakeReport(input);
  EXPECT_TRUE(Has(report.markdown, "the paper's grid"));
  EXPECT_TRUE(Has(report.markdown, "changed after trial 5"));
  EXPECT_TRUE(Has(report.markdown, "because too few to tell"));
  EXPECT_TRUE(Has(report.markdown, "after trial 5 (2026-08-02T09:00:00.000Z"));
  EXPECT_TRUE(Has(report.markdown, "the spring stuck"));
}

TEST(MakeReport, SaysWhatTable1AloneSupports) {
  const Report report = MakeReport(Table1Input(core::Origin::kRecorded));
  EXPECT_TRUE(Has(report.html, "[11.8, 27.4)"));
  EXPECT_TRUE(Has(report.html, "[7.8, 11.8)"));
  EXPECT_THAT(report.html, HasSubstr("so the paper&#39;s criterion says slide "
                                     "at every angle"));
  EXPECT_TRUE(Has(report.html, "atan(b/a)"));
  EXPECT_TRUE(Has(report.html, "here 26.6 deg"));
}

TEST(MakeReport, SameTrialsInAnyOrderGiveTheSameBytes) {
  ReportInput input = Table1Input(core::Origin::kSimulated);
  const Report first = MakeReport(input);
  std::mt19937 engine(7);
  std::shuffle(input.trials.begin(), input.trials.end(), engine);
  std::reverse(input.campaigns.begin(), input.campaigns.end());
  const Report second = MakeReport(input);
  EXPECT_EQ(first.markdown, second.markdown);
  EXPECT_EQ(first.csv, second.csv);
  EXPECT_EQ(first.html, second.html);
  EXPECT_EQ(first.latex, second.latex);
  EXPECT_EQ(first.json, second.json);
}

TEST(MakeReport, TheHtmlAsksForNothingOutsideItself) {
  const Report report = MakeReport(Table1Input(core::Origin::kRecorded));
  for (const char* loader :
       {"src=", "<link", "@import", "<script", "href=\"h"}) {
    EXPECT_FALSE(Has(report.html, loader));
  }
  EXPECT_TRUE(Has(report.html, "<svg"));
  EXPECT_TRUE(Has(report.html, "aria-label="));
}

TEST(MakeReport, IdentifiersInTheHtmlAreUnique) {
  const std::string html =
      MakeReport(Table1Input(core::Origin::kRecorded)).html;
  std::vector<std::string> ids;
  for (std::size_t at = html.find("id='"); at != std::string::npos;
       at = html.find("id='", at + 1)) {
    ids.push_back(html.substr(at + 4, html.find('\'', at + 4) - at - 4));
  }
  for (std::size_t at = html.find("id=\""); at != std::string::npos;
       at = html.find("id=\"", at + 1)) {
    ids.push_back(html.substr(at + 4, html.find('"', at + 4) - at - 4));
  }
  EXPECT_GT(ids.size(), 2u);
  std::sort(ids.begin(), ids.end());
  const auto twice = std::adjacent_find(ids.begin(), ids.end());
  EXPECT_TRUE(twice == ids.end()) << *twice;
}

TEST(MakeReport, HostileTextStaysText) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  for (auto& trial : input.trials) {
    trial.campaign = "<script>alert(1)</script>";
    trial.clip.path = "=HYPERLINK(\"x\")|*.avi";
  }
  input.campaigns.resize(1);
  input.campaigns[0].name = input.trials[0].campaign;
  input.campaigns[0].theory_name = "'</text><script>\n`touch x`";
  input.title = "a <b> & \"c\"";
  const Report report = MakeReport(input);
  EXPECT_FALSE(Has(report.html, "<script"));
  EXPECT_THAT(report.html, HasSubstr("a &lt;b&gt; &amp; &quot;c&quot;"));
  EXPECT_FALSE(Has(report.markdown, "<script"));
  EXPECT_TRUE(Has(report.csv, "\"'=HYPERLINK(\"\"x\"\")|*.avi\""));
}

TEST(MakeReport, NoTrialsIsAReportThatSaysSo) {
  const Report report = MakeReport({});
  EXPECT_TRUE(Has(report.markdown, "No trials."));
}

TEST(MakeReport, AbsentNumbersShowTheirReason) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  input.trials[0].first.state.max_gap_m =
      core::AbsentBecause("the rebound was not filmed");
  input.trials[1].first.contact.approach_angle_rad =
      core::AbsentBecause("two bodies");
  const Report report = MakeReport(input);
  EXPECT_TRUE(Has(report.markdown, "absent: the rebound was not filmed"));
  EXPECT_TRUE(Has(report.markdown, "no approach angle: two bodies"));
}

TEST(MakeReport, TwoLabelsOfTheSameTrialsAreCompared) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  for (int i = 0; i < 6; ++i) {  // six discordant, all one way: p = 1/32
    input.labels.push_back({input.trials[static_cast<std::size_t>(i)].id,
                            core::MotionState::kSlide,
                            core::MotionState::kBounce});
  }
  input.labels.push_back({input.trials[6].id, core::MotionState::kUndecided,
                          core::MotionState::kBounce});
  const Report report = MakeReport(input);
  EXPECT_THAT(report.markdown, HasSubstr("7 trials bear both labels"));
  EXPECT_THAT(report.markdown, HasSubstr("McNemar exact p = 0.0313"));
  EXPECT_THAT(report.markdown, HasSubstr("1 of them, undecided"));
  EXPECT_THAT(report.markdown, HasSubstr("Both agree in 0 of 6, 95 %"));
}

TEST(MakeReport, WhatStandsBehindTheTrialsIsSaid) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  for (core::Trial& trial : input.trials) {
    trial.first.contact.approach_budget = {{"ground", 0.03 * kDegree},
                                           {"localisation", 0.04 * kDegree}};
    trial.software_version = "0.1.0";
    trial.document_json =
        R"({"scale": {"source": "calibration"}, "ground": {"source": "user"},
            "clip": {"time_base": {"fps": 2000.0, "source": "header"}}})";
  }
  input.trials[0].document_json = "{ damaged";
  const Report report = MakeReport(input);
  EXPECT_THAT(report.markdown, HasSubstr("Budget of the approach angle"));
  // Once: a row a trial, and the root mean square below.
  EXPECT_EQ(Count(report.markdown, "Budget of the approach angle"), 1);
  EXPECT_THAT(report.markdown,
              HasSubstr("| clip or trial | localisation | ground | all |"));
  EXPECT_THAT(report.markdown, HasSubstr("that count | 0.04 | 0.03 | 0.05 |"));
  EXPECT_THAT(report.markdown, HasSubstr("calibration (8 trials)"));
  EXPECT_THAT(report.markdown,
              HasSubstr("2000 frames/s, from the header (8 trials)"));
}

// Who knows nothing of the project reads this first.
TEST(MakeReport, BeginsWithPlainWords) {
  const Report report = MakeReport(Table1Input(core::Origin::kRecorded));
  const std::string& text = report.markdown;
  std::size_t at = 0;
  for (const char* part :
       {"What was tested",
        "a sphere (diameter 40.000 \u00b1 0.020 mm); surface: "
        "asphalt, dry. 9 trials, filmed, with the approach "
        "angle from 0 to 90 deg",
        "What came out", "stayed down in 4 trials and bounced in 5",
        "above which it bounces, is estimated at", "How sure",
        "No trial lies between 11.79 deg, the steepest that stayed down, and "
        "27.4 deg, the flattest that bounced",
        "Does the theory agree", "neither confirm nor contradict",
        "May I rely on it", "not enough for a verdict",
        "Order, laboratory, equipment", "Table 1: motion state"}) {
    const std::size_t next = text.find(part, at);
    ASSERT_NE(next, std::string::npos) << part << "\n" << text.substr(at, 900);
    at = next;
  }
}

TEST(MakeReport, AVerdictIsSaidOnce) {
  const Report report = MakeReport(Table1Input(core::Origin::kRecorded));
  EXPECT_EQ(Count(report.markdown, "neither confirm nor contradict"), 2)
      << "one of each body";
}

TEST(MakeReport, TheCoverNamesWhatIsAbsent) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  input.made_on = "2026-11-23";
  input.trials[0].recorded_at_utc = "2026-08-02T09:00:00.000Z";
  input.trials[1].recorded_at_utc = "2026-08-09T09:00:00.000Z";
  // Revised since: its shot was made earlier.
  input.first_logged_utc[input.trials[1].id] = "2026-08-01T09:00:00.000Z";
  core::Conditions conditions;
  conditions.person.name = "Ada";
  conditions.camera = {"south", "version-1"};
  conditions.temperature_k = core::Estimate{core::kIcePoint_k + 21.5, 0.2};
  conditions.anomaly = core::Anomaly::kLight;
  conditions.anomaly_note = "a lamp failed";
  input.trials[0].conditions = conditions;
  db::Entry camera = db::NewEntry(db::RegisterKind::kCamera, "south");
  camera.texts["serial"] = "4711";
  input.register_entries = {camera};
  input.details.file = "report.toml";
  input.details.laboratory = "Rig hall";
  input.details.equipment = {{"south", "", "2025-07-01", "2026-07-01", ""},
                             {"plumb line", "P 2", "", "", ""}};
  input.details.signatures = {{"tested by", "Ada"}};
  const std::string text = MakeReport(input).markdown;
  for (const char* part :
       {"**laboratory**: Rig hall", "2026-08-01 to 2026-08-02",
        "**operator**: Ada (1 trial)", "air 21.5 degC in 1 of 18 trials",
        "light: a lamp failed (1 trial)", "17 of 18 trials say nothing",
        "customer (customer.name)", "order (order.number)",
        "**date of the report**: 2026-11-23",
        "| camera | south | no. 4711 | 2025-07-01 | 2026-07-01, overdue at the "
        "last trial | absent |",
        "|  | plumb line | P 2 | absent | absent | absent |",
        "| tested by | Ada |", "at most 5 of 100 campaigns"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

// As the paper has it: angles across, and the paper's own below each body.
TEST(MakeReport, Table1HasTheAnglesAcross) {
  const Report report = MakeReport(Table1Input(core::Origin::kRecorded));
  EXPECT_THAT(report.markdown,
              HasSubstr("| set angle (deg) | 0 | 3.9 | 7.8 | 11.8 | 27.4 | 43 "
                        "| 58.7 | 74.4 | 90 |"));
  const std::string words =
      " | slide | slide | slide | slide | bounce | bounce | bounce | bounce | "
      "bounce |";
  EXPECT_THAT(report.markdown, HasSubstr("| sphere: motion state" + words));
  EXPECT_THAT(report.markdown, HasSubstr("| sphere: the paper's own" + words));
}

// An E_n counts both uncertainties: without the rig's there is none.
TEST(MakeReport, SetPointsWithoutARigHaveNoErrorNumber) {
  const Report report = MakeReport(Table1Input(core::Origin::kRecorded));
  EXPECT_THAT(report.markdown,
              HasSubstr("| set angle (deg) | measured minus set \u00b1 u (deg) "
                        "| clip or trial |"));
  EXPECT_FALSE(Has(report.markdown, "E\\_n of the angle"));
  EXPECT_THAT(report.markdown, HasSubstr("\u22120.013 \u00b1 0.048"));
}

TEST(MakeReport, NumbersAreTypesetAndNeverMinusZero) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  input.trials[0].first.contact.approach_angle_rad =
      core::Estimate{-0.0001 * kDegree, 0.05 * kDegree};
  for (const std::string& text :
       {MakeReport(input).markdown, MakeReport(input).html}) {
    for (const char* part : {"+-", "-0.00", "\u22120.00 ", " -0."}) {
      EXPECT_FALSE(Has(text, part)) << part;
    }
  }
}

// A strip as the pipeline takes it, a path, and a trial that has neither.
TEST(MakeReport, ShowsTheContactsAndThePaths) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  ContactStrip strip;
  strip.px_per_m = 1000.0;
  strip.pictures.push_back({"before: frame 4, 2.00 ms earlier",
                            "PNG",
                            {10, 20, 100, 75},
                            {{20, 30}, {40, 30}, {40, 50}},
                            {{0, 90}, {200, 90}},
                            {{20, 30}, {60, 60}},
                            {},
                            core::PixelPoint{60, 90}});
  input.strips.emplace(input.trials[0].id, strip);
  input.no_strip.emplace(input.trials[1].id, "logged by hand");
  input.trajectories.emplace(
      input.trials[0].id,
      Trajectory{{{-0.02, 0.04}, {0.0, 0.02}, {0.02, 0.02}}, {0.02, 0.0, 0.0}});
  const Report report = MakeReport(input);
  for (const char* part :
       {"<figure class=\"strip\">", "href=\"data:image/png;base64,UE5H\"",
        "viewBox=\"9.5 19.5 100 75\"", ">20 mm</text>", "stroke-dasharray",
        "before: frame 4, 2.00 ms earlier", "Paths of 1 of 9 trials",
        "logged by hand (1 trial)"}) {
    EXPECT_THAT(report.html, HasSubstr(part));
  }
  EXPECT_THAT(report.markdown, HasSubstr("before: frame 4"));
}

TEST(MakeReport, RefusesTwoCampaignsOfOneName) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  input.campaigns.push_back(input.campaigns[0]);
  EXPECT_THROW(MakeReport(input), std::invalid_argument);
}

TEST(MakeReport, ManyTrialsAreBinned) {
  ReportInput input;
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> angle(0, 30);
  for (int i = 0; i < 200; ++i) {
    const double a = angle(engine);
    input.trials.push_back(MakeTrial({a, a, a > 12}, core::BodyKind::kSphere,
                                     core::Origin::kRecorded));
    input.trials.back().id = std::to_string(i);
  }
  EXPECT_THAT(MakeReport(input).markdown,
              HasSubstr("set angle, bins of 1 deg"));
}

// Daily drops of a known body; the 13th after somebody moved the camera.
ReportInput WithCheckShots(ReportInput input, int shots) {
  core::Campaign checks;
  checks.name = "check: sphere 24 mm from 300 mm";
  checks.body = core::Sphere({24 * kMillimetre, 0.02 * kMillimetre});
  checks.surface = core::kCheckShotSurface;
  input.campaigns.push_back(checks);
  for (int i = 0; i < shots; ++i) {
    core::Trial trial;
    trial.campaign = checks.name;
    trial.body = checks.body;
    trial.id = "check-" + std::to_string(i);
    trial.recorded_at_utc =
        "2026-08-" + std::string(i < 9 ? "0" : "") + std::to_string(i + 1);
    trial.set_angle_rad = 90 * kDegree;
    trial.first.contact.found = true;
    trial.first.contact.approach_angle_rad =
        core::Estimate{(89.8 - 0.05 * (i % 3)) * kDegree, 0.1 * kDegree};
    trial.first.state.label = core::MotionState::kBounce;
    trial.first.motion.before_speed_mps =
        core::Estimate{2.425 + 0.004 * (i % 4) + (i == 12 ? 0.1 : 0.0), 0.003};
    // The order in which they are given does not matter.
    input.trials.insert(input.trials.begin(), trial);
  }
  return input;
}

TEST(MakeReport, CheckShotsHaveAControlChartAndNothingElse) {
  const ReportInput plain = Table1Input(core::Origin::kRecorded);
  const Report without = MakeReport(plain);
  const Report with = MakeReport(WithCheckShots(plain, 22));
  // Neither a row nor a column of Table 1.
  EXPECT_EQ(with.latex, without.latex);
  EXPECT_EQ(with.csv, without.csv);
  EXPECT_FALSE(Has(with.markdown, "sphere (check"));
  EXPECT_THAT(with.markdown,
              HasSubstr("## check: sphere 24 mm from 300 mm, recorded"));
  EXPECT_THAT(with.markdown, HasSubstr("beyond them: no. 13."));
  EXPECT_THAT(with.html, HasSubstr("individuals control chart"));
  const auto json = nlohmann::json::parse(with.json);
  EXPECT_EQ(json["groups"].size(), 2u);
  ASSERT_EQ(json["check_shots"].size(), 1u);
  const auto& speed = json["check_shots"][0]["speed_mps"];
  EXPECT_EQ(speed["values"].size(), 22u);
  EXPECT_EQ(speed["values"][0]["trial"], "check-0");
  EXPECT_EQ(speed["chart"]["beyond"], nlohmann::json::array({12}));
  EXPECT_FALSE(speed["chart"]["provisional"].get<bool>());
}

TEST(MakeReport, OneCheckShotHasNoLimits) {
  const Report report =
      MakeReport(WithCheckShots(Table1Input(core::Origin::kRecorded), 1));
  EXPECT_THAT(report.markdown,
              HasSubstr("1 value: a control chart needs two values."));
}

// The whole interval is on the plot, also where it is far wider than the
// trials; an end that the trials leave open says so.
TEST(DrawBoundaryPlot, ShowsTheWholeInterval) {
  ReportInput input;
  for (const double angle : {10.0, 11.0, 12.0}) {
    input.trials.push_back(MakeTrial({angle, angle, false},
                                     core::BodyKind::kSphere,
                                     core::Origin::kRecorded));
  }
  const Report open = MakeReport(input);
  EXPECT_THAT(open.html, HasSubstr("set no upper end"));
  EXPECT_THAT(open.html, HasSubstr("its median and 95 % interval"));
  // The axis reaches the last of its tics.
  EXPECT_THAT(open.html, HasSubstr("> 90</text>"));
  input.trials.push_back(MakeTrial({30, 30, true}, core::BodyKind::kSphere,
                                   core::Origin::kRecorded));
  EXPECT_FALSE(Has(MakeReport(input).html, "set no upper end"));
}

TEST(MakeReport, TheUserChoosesTheBins) {
  ReportInput input = Table1Input(core::Origin::kRecorded);
  input.bin_width_rad = 30 * kDegree;
  const std::string text = MakeReport(input).markdown;
  EXPECT_THAT(text, HasSubstr("set angle, bins of 30 deg"));
  EXPECT_THAT(text, HasSubstr("slide 4, bounce 1"));
}

TEST(WriteReport, WritesItsFilesAndNothingElse) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("touchdown-report-test-" + std::to_string(getpid()));
  WriteReport({"m", "c", "h", "t", "j", "s"}, folder);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(names, ::testing::UnorderedElementsAreArray(kReportFiles));
  std::filesystem::remove_all(folder);
}

TEST(MakeReport, TheCsvSchemaHasTheColumnsOfTheCsv) {
  const Report report = MakeReport(Table1Input(core::Origin::kRecorded));
  const auto schema = nlohmann::json::parse(report.csv_schema);
  std::string names;
  for (const auto& column : schema["tableSchema"]["columns"]) {
    names += (names.empty() ? "" : ",") + column["name"].get<std::string>();
  }
  EXPECT_EQ(names, report.csv.substr(0, report.csv.find("\r\n")));
}

TEST(WriteReport, AFolderThatCannotBeMadeIsAnInputError) {
  EXPECT_THROW(WriteReport({}, "/proc/none/here"), core::InputError);
}

TEST(RunGnuplot, MissingIsSaidWithWhatToDo) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  std::string message;
  try {
    RunGnuplot("set terminal svg\nplot x\n");
  } catch (const core::InputError& error) {
    message = error.what();
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("gnuplot-nox"));
}

TEST(RunGnuplot, ARefusedScriptIsSaid) {
  EXPECT_THROW(RunGnuplot("plot nonsense(\n"), core::InputError);
}

TEST(RunGnuplot, AScriptLargerThanAPipePasses) {
  std::string script = "set terminal svg\n$d << EOD\n";
  for (int i = 0; i < 30000; ++i) script += std::to_string(i) + " 1\n";
  script += "EOD\nplot $d with dots\n";
  EXPECT_GT(script.size(), 200000u);
  EXPECT_THAT(RunGnuplot(script), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace touchdown::report
