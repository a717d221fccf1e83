#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "app/trials/paper_trials.h"
#include "app/trials/trials_csv.h"
#include "tests/support/run_program.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/store.h"

namespace touchdown {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::Ran;
using testing::ReadAll;
using testing::RunProgram;
using testing::TemporaryFolder;

class BoundaryCommands : public ::testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) {
    const auto path = folder_.path() / name;
    std::ofstream(path) << text;
    return path.string();
  }
  // Trials around 12 deg, sharp.
  std::string Sharp() {
    std::string text = "angle_deg,u_deg,p_bounce,set_angle_deg\n";
    for (int i = 0; i < 40; ++i) {
      const double x = 8.1 + 0.2 * i;
      text += std::to_string(x) + ",0.05," + (x > 12 ? "1" : "0") + ",\n";
    }
    return Write("sharp.csv", text);
  }
  // A store with the paper's Table 1, and the sphere once more as simulated.
  std::string Store() {
    const auto path = folder_.path() / "lab.db";
    db::Store store = db::Store::Open(path, db::OpenMode::kCreate);
    const auto paper = pipeline::PaperTable1Trials(0.5 * core::kDegree);
    for (const auto& campaign : paper.campaigns) store.AddCampaign(campaign);
    for (core::Trial trial : paper.trials) {
      trial.id.clear();
      store.LogTrial(trial);
    }
    return path.string();
  }

  TemporaryFolder folder_;
};

void ExpectOneLine(const Ran& ran, int status, const std::string& part) {
  EXPECT_EQ(ran.status, status);
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr(part));
}

TEST_F(BoundaryCommands, JsonBearsTheNamesThatScriptsDependOn) {
  const Ran ran =
      RunProgram("boundary --json --theory-deg 11.8+-0.1 --trials " + Sharp());
  ASSERT_EQ(ran.status, 0) << ran.err;
  const json document = json::parse(ran.out);
  EXPECT_EQ(document.at("schema"), "touchdown.boundary/1");
  EXPECT_NEAR(document.at("bracket").at("low_deg").get<double>(), 11.9, 1e-9);
  EXPECT_NEAR(document.at("bracket").at("high_deg").get<double>(), 12.1, 1e-9);
  EXPECT_TRUE(document.at("bracket").at("separated").get<bool>());
  EXPECT_EQ(document.at("status"), "separated");
  const json& posterior = document.at("posterior");
  EXPECT_NEAR(posterior.at("median_deg").get<double>(), 12.0, 0.1);
  EXPECT_LT(posterior.at("low95_deg").get<double>(), 12.0);
  EXPECT_GT(posterior.at("high95_deg").get<double>(), 12.0);
  EXPECT_GT(posterior.at("sd_deg").get<double>(), 0.0);
  const json& likelihood = document.at("likelihood");
  for (const char* field : {"estimate_deg", "low95_deg", "high95_deg",
                            "open_low", "open_high", "scatter_deg"}) {
    EXPECT_TRUE(likelihood.contains(field)) << field;
  }
  const json& theory = document.at("theory").at(0);
  EXPECT_EQ(theory.at("boundary_deg"), 11.8);
  EXPECT_EQ(theory.at("verdict"), "confirmed");
  for (const char* field : {"name", "p_below", "e_n", "smallest_margin_deg"}) {
    EXPECT_TRUE(theory.contains(field)) << field;
  }
}

// One slide near the theory: the prior alone said "contradicted".
TEST_F(BoundaryCommands, OneTrialContradictsNoTheory) {
  const auto csv = folder_.path() / "one.csv";
  std::ofstream(csv) << "angle_deg,u_deg,p_bounce\n12,0.1,0\n";
  const Ran ran = RunProgram(
      "boundary --theory-deg 11.8 --margin-deg 1 --trials " + csv.string());
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("verdict     inconclusive"));
  EXPECT_THAT(ran.out, HasSubstr("a verdict needs at least 10"));
}

// The theory's u by a flag of its own: in E_n, and in the verdict.
TEST_F(BoundaryCommands, TheTheorysUncertaintyCounts) {
  const std::string trials = " --trials " + Sharp();
  const auto theory = [&](const std::string& flags) {
    const Ran ran = RunProgram("boundary --json " + flags + trials);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return json::parse(ran.out).at("theory").at(0);
  };
  const json exact = theory("--theory-deg 11.8");
  const json vague = theory("--theory-deg 11.8 --theory-u-deg 10");
  EXPECT_EQ(vague.at("u_deg"), 10.0);
  EXPECT_EQ(exact.at("verdict"), "confirmed");
  EXPECT_EQ(vague.at("verdict"), "inconclusive");
  EXPECT_THAT(vague.at("verdict_reason").get<std::string>(),
              HasSubstr("too vague"));
  EXPECT_LT(std::abs(vague.at("e_n").get<double>()),
            std::abs(exact.at("e_n").get<double>()));
  ExpectOneLine(RunProgram("boundary --theory-u-deg 1" + trials), 2,
                "--theory-u-deg");
  ExpectOneLine(
      RunProgram("boundary --theory-deg 11.8+-1 --theory-u-deg 1" + trials), 2,
      "once");
  ExpectOneLine(
      RunProgram("boundary --theory-deg 11.8 --theory-u-deg -1" + trials), 2,
      "expected 0 to 90");
}

// What a boundary can be is the user's to say.
TEST_F(BoundaryCommands, TheSupportOfThePriorIsStated) {
  const auto csv = folder_.path() / "slides.csv";
  std::ofstream(csv) << "angle_deg,u_deg,p_bounce\n12,0.1,0\n14,0.1,0\n";
  const std::string trials = " --trials " + csv.string();
  const auto high = [&](const std::string& flags) {
    const Ran ran = RunProgram("boundary --json" + flags + trials);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return json::parse(ran.out).at("posterior").at("high95_deg").get<double>();
  };
  EXPECT_GT(high(""), 80.0);
  EXPECT_DOUBLE_EQ(high(" --support-deg 0:40"), 40.0);
  ExpectOneLine(RunProgram("boundary --support-deg 0:100" + trials), 2,
                "within 0:90");
  ExpectOneLine(RunProgram("boundary --support-deg 40:0" + trials), 2,
                "low below high");
}

// A drift over the sequence is looked for, and told.
TEST_F(BoundaryCommands, TheReportTellsOfADrift) {
  const auto csv = folder_.path() / "drift.csv";
  std::ofstream file(csv);
  file << "angle_deg,u_deg,p_bounce\n";
  // The boundary rises from 10 to 14 deg over the sequence.
  for (int i = 0; i < 80; ++i) {
    const double x = 9.0 + (i * 7 % 20) * 0.3;
    file << x << ",0.2," << (x > 10.0 + 0.05 * i ? 1 : 0) << "\n";
  }
  file.close();
  const auto out = folder_.path() / "drift";
  const Ran ran = RunProgram("report --body sphere --trials " + csv.string() +
                             " --out " + out.string());
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string page = ReadAll(out / "table1.md");
  EXPECT_THAT(page, HasSubstr("order of the trials"));
  EXPECT_THAT(page, HasSubstr("drifted: order of the trials ("));
  EXPECT_LT(page.find("sphere: not one boundary."),
            page.find("Table 1: motion"));
}

// One error that all trials share: it stays in the interval, and two set-ups
// halve its square.
TEST_F(BoundaryCommands, ErrorsThatTrialsShareStay) {
  const auto interval = [&](const std::string& name, auto calibration) {
    const auto csv = folder_.path() / name;
    std::ofstream file(csv);
    file << "angle_deg,u_deg,p_bounce,common_u_deg,calibration\n";
    for (int i = 0; i < 200; ++i) {
      const double x = 10.0 + 0.02 * i;
      file << x << ",0.05," << (x > 12.0 ? 1 : 0) << ",0.5," << calibration(i)
           << "\n";
    }
    file.close();
    const Ran ran = RunProgram("boundary --json --trials " + csv.string());
    EXPECT_EQ(ran.status, 0) << ran.err;
    return json::parse(ran.out).at("posterior").at("sd_deg").get<double>();
  };
  EXPECT_NEAR(interval("one.csv", [](int) { return "a"; }), 0.5, 0.01);
  EXPECT_NEAR(interval("two.csv", [](int i) { return i % 2 == 0 ? "a" : "b"; }),
              0.5 / std::sqrt(2.0), 0.01);
}

TEST_F(BoundaryCommands, ThePapersTable1IsInconclusive) {
  const Ran ran = RunProgram("boundary --paper-table1 --json");
  ASSERT_EQ(ran.status, 0) << ran.err;
  const json document = json::parse(ran.out);
  const json& sphere = document.at("groups").at(0);
  const json& rectangle = document.at("groups").at(1);
  EXPECT_EQ(sphere.at("body"), "sphere");
  for (const json& group : {sphere, rectangle}) {
    EXPECT_EQ(group.at("theory").at(0).at("verdict"), "inconclusive");
  }
  const auto margin = [](const json& group) {
    return group.at("theory").at(0).at("smallest_margin_deg").get<double>();
  };
  EXPECT_NEAR(margin(sphere), 17.2, 0.05);
  EXPECT_NEAR(margin(rectangle), 10.7, 0.05);
}

TEST_F(BoundaryCommands, AStoreGivesTheSameAsThePaperItself) {
  const Ran from_store = RunProgram("boundary --json --db " + Store());
  ASSERT_EQ(from_store.status, 0) << from_store.err;
  const json a = json::parse(from_store.out);
  const json b = json::parse(RunProgram("boundary --json --paper-table1").out);
  EXPECT_NEAR(a["groups"][0]["posterior"]["median_deg"].get<double>(),
              b["groups"][0]["posterior"]["median_deg"].get<double>(), 1e-6);
}

// The first report of a new user: the paper's own.
TEST_F(BoundaryCommands, ImportOfThePapersTable1MakesItsReport) {
  const std::string store = (folder_.path() / "paper.db").string();
  const Ran imported = RunProgram("import --paper-table1 --db " + store);
  ASSERT_EQ(imported.status, 0) << imported.err;
  EXPECT_EQ(imported.out, "18 trials in 2 campaigns imported\n");
  const auto out = folder_.path() / "report";
  const Ran ran = RunProgram("report --db " + store + " --out " + out.string());
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::string page = ReadAll(out / "table1.md");
  const std::string verdict = "**Does the theory agree**: Inconclusive.";
  const std::size_t sphere = page.find(verdict);
  ASSERT_NE(sphere, std::string::npos);
  EXPECT_NE(page.find(verdict, sphere + 1), std::string::npos);
  EXPECT_THAT(page, HasSubstr("90 % interval would fit a margin of 17.2"));
  EXPECT_THAT(page, HasSubstr("90 % interval would fit a margin of 10.7"));
  // Once more it is refused, and nothing is doubled.
  ExpectOneLine(RunProgram("import --paper-table1 --db " + store), 4,
                "there is a campaign 'paper-table1-sphere' already");
  const json document = json::parse(ReadAll(out / "table1.json"));
  // Typed trials have no clip to check.
  const json& checks = document["groups"][0]["campaign_checks"];
  EXPECT_EQ(checks["failed"], false);
  for (const char* what : {"gravity", "size", "restitution"}) {
    EXPECT_TRUE(checks[what].contains("absent")) << what;
  }
  EXPECT_EQ(document.at("groups").at(0).at("trials").size(), 9u);
  ExpectOneLine(RunProgram("import --paper-table1"), 2, "--db");
  ExpectOneLine(RunProgram("import x.csv --paper-table1 --db " + store), 2,
                "must be left out");
}

// Where no file may grow beyond a limit, which lies in turn before and behind
// every step of the import: all of it is there, or it can be done again.
TEST_F(BoundaryCommands, AnImportOfThePapersTable1ThatFailsCanBeRepeated) {
  constexpr int kStep = 50;  // blocks of 512 bytes; the whole store has 584
  int failed = 0;
  for (int blocks = 450; blocks <= 900; blocks += kStep) {
    const std::string import = "import --paper-table1 --db " +
                               (folder_ / std::to_string(blocks)).string();
    const std::string limited = "ulimit -f " + std::to_string(blocks) + "; " +
                                TOUCHDOWN_BINARY + " " + import +
                                " >/dev/null 2>&1";
    if (std::system(limited.c_str()) == 0) continue;  // NOLINT
    ++failed;
    const Ran again = RunProgram(import);
    EXPECT_EQ(again.status, 0) << blocks << ": " << again.err;
  }
  EXPECT_GT(failed, 0);
}

TEST_F(BoundaryCommands, FiltersChooseTrials) {
  const std::string store = Store();
  const Ran body = RunProgram("boundary --json --body sphere --db " + store);
  ASSERT_EQ(body.status, 0) << body.err;
  EXPECT_EQ(json::parse(body.out).at("body"), "sphere");
  ExpectOneLine(RunProgram("boundary --campaign nonsense --db " + store), 2,
                "there is no campaign 'nonsense'");
  ExpectOneLine(RunProgram("boundary --reviewed --db " + store), 2,
                "no trial matches");
  ExpectOneLine(RunProgram("next --db " + store), 2, "choose one with");
}

// Who is refused has seen no answer.
TEST_F(BoundaryCommands, ARefusedCommandIsNoLook) {
  const std::string store = Store();
  const std::string rest =
      " --db " + store + " --out " + (folder_.path() / "refused").string();
  const auto paper = pipeline::PaperTable1Trials(0.01);
  core::Campaign checks = paper.campaigns.front();
  checks.name = "checks";
  checks.surface = core::kCheckShotSurface;
  core::Trial drop = paper.trials.front();
  drop.id.clear();
  drop.campaign = checks.name;
  {
    db::Store open = db::Store::Open(store, db::OpenMode::kWrite);
    open.AddCampaign(checks);
    open.LogTrial(drop);
  }
  const auto looks = [&] {
    return db::PlanEvents(db::Store::Open(store, db::OpenMode::kRead)).size();
  };
  const std::size_t before = looks();
  for (const char* command :
       {"boundary --campaign checks", "next", "next --rule neyer --body sphere",
        "next --body rectangle --rule magic", "report --bin-deg 100",
        "report --details /none.toml", "report --target-deg=-1"}) {
    const bool is_report = std::string(command).starts_with("report");
    const Ran ran = RunProgram(command + (is_report ? rest : " --db " + store));
    EXPECT_NE(ran.status, 0) << command;
    EXPECT_EQ(looks(), before) << command;
  }
  EXPECT_EQ(
      RunProgram("next --campaign paper-table1-sphere --db " + store).status,
      0);
  EXPECT_EQ(looks(), before + 1);
  EXPECT_EQ(RunProgram("report" + rest).status, 0);
  EXPECT_GT(looks(), before + 1);
}

TEST_F(BoundaryCommands, NextPrintsTheAngle) {
  const Ran ran = RunProgram("next --json --paper-table1 --body sphere");
  ASSERT_EQ(ran.status, 0) << ran.err;
  const json document = json::parse(ran.out);
  EXPECT_GT(document.at("angle_deg").get<double>(), 11.8);
  EXPECT_LT(document.at("angle_deg").get<double>(), 27.4);
  EXPECT_LT(document.at("expected_sd_deg").get<double>(),
            document.at("posterior").at("sd_deg").get<double>());
  EXPECT_GT(document.at("trials_to_target").get<int>(), 0);
}

TEST_F(BoundaryCommands, NextStaysFeasibleAndFollowsTheRule) {
  const auto angle = [](const Ran& ran) {
    return json::parse(ran.out).at("angle_deg").get<double>();
  };
  const std::string paper = "next --json --paper-table1 --body sphere ";
  const Ran clipped = RunProgram(paper + "--feasible-deg 30:40");
  EXPECT_GE(angle(clipped), 30.0);
  const Ran up_down = RunProgram(paper + "--rule up-down --step-deg 2");
  EXPECT_NEAR(angle(up_down), 88.0, 1e-9);  // after the bounce at 90
  const Ran neyer = RunProgram(paper + "--rule neyer --guess-deg 5:20");
  EXPECT_NEAR(angle(neyer), 19.6, 1e-9);  // the middle of the bracket
  ExpectOneLine(RunProgram(paper + "--rule neyer"), 2, "--guess-deg");
  const Ran three = RunProgram(paper + "--rule 3pod --guess-deg 5:20");
  EXPECT_NEAR(angle(three), 19.6, 1e-9);
  ExpectOneLine(RunProgram(paper + "--rule magic"), 2, "magic");
}

TEST_F(BoundaryCommands, NextGivesTheRigsSetPointsAndStaysWithinItsReach) {
  const std::string rig = Write("rig.toml", RunProgram("rig example").out);
  // The example's rectangle stands at a radius angle of 18.4 deg at least.
  const std::string next =
      "next --paper-table1 --body rectangle --speed-mps 4 --rig " + rig;
  const Ran ran = RunProgram(next + " --json");
  ASSERT_EQ(ran.status, 0) << ran.err;
  const json document = json::parse(ran.out);
  EXPECT_NEAR(document.at("angle_deg").get<double>(), 18.44, 0.02);
  EXPECT_TRUE(document.at("next").at("clipped").get<bool>());
  const json& set = document.at("set_points");
  EXPECT_TRUE(set.at("possible").get<bool>());
  EXPECT_GT(set.at("compression_mm").get<double>(), 0.0);
  EXPECT_GT(set.at("contact").at("launch_speed_mps").at("u").get<double>(), 0);
  EXPECT_NEAR(
      set.at("contact").at("radius_angle_deg").at("value").get<double>(),
      document.at("angle_deg").get<double>(), 1e-6);
  EXPECT_THAT(RunProgram(next).out, HasSubstr("compression"));
  ExpectOneLine(RunProgram("next --paper-table1 --body rectangle --rig " + rig),
                2, "--speed-mps");
  ExpectOneLine(RunProgram("next --paper-table1 --body sphere --speed-mps 4 "
                           "--rig " +
                           rig),
                2, "is a rectangle, the trials are of a sphere");
  ExpectOneLine(RunProgram("next --paper-table1 --body rectangle "
                           "--speed-mps 4000 --rig " +
                           rig),
                2, "cannot throw any radius angle");
}

TEST_F(BoundaryCommands, NextBeforeTheFirstTrial) {
  const std::string path = Write("none.csv", "angle_deg,u_deg,p_bounce\n");
  const Ran ran = RunProgram("next --json --trials " + path);
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_NEAR(json::parse(ran.out).at("angle_deg").get<double>(), 45, 1.5);
}

TEST_F(BoundaryCommands, ReportIsTheSameByteForByte) {
  const std::string store = Store();
  const auto a = folder_.path() / "a";
  const auto b = folder_.path() / "b";
  for (const auto& out : {a, b}) {
    const Ran ran = RunProgram("report --evidence --db " + store + " --out " +
                               out.string());
    ASSERT_EQ(ran.status, 0) << ran.err;
  }
  int pages = 0;
  for (const auto& page : std::filesystem::directory_iterator(a / "evidence")) {
    const std::string text = ReadAll(page.path());
    EXPECT_TRUE(text == ReadAll(b / "evidence" / page.path().filename()));
    EXPECT_THAT(ReadAll(a / "table1.html"),
                HasSubstr("evidence/" + page.path().filename().string()));
    ++pages;
  }
  EXPECT_EQ(pages, 18);
  for (const char* name :
       {"table1.md", "table1.csv", "table1.html", "table1.tex", "table1.json",
        "table1.csv-metadata.json"}) {
    const std::string text = ReadAll(a / name);
    EXPECT_FALSE(text.empty()) << name;
    EXPECT_TRUE(text == ReadAll(b / name)) << name;
  }
  EXPECT_EQ(json::parse(ReadAll(a / "table1.json")).at("schema"),
            "touchdown.report/1");
}

TEST_F(BoundaryCommands, MistakesAreOneLine) {
  ExpectOneLine(RunProgram("boundary"), 2, "exactly one of");
  ExpectOneLine(RunProgram("boundary --trials /nowhere.csv"), 3,
                "/nowhere.csv: cannot be read");
  ExpectOneLine(RunProgram("boundary --db /nowhere.db"), 4, "/nowhere.db");
  ExpectOneLine(RunProgram("boundary --paper-table1 --body cube"), 2,
                "--body: 'cube'; expected sphere or rectangle");
  for (const char* flag : {"--target-deg=-1", "--target-deg=0",
                           "--margin-deg=0", "--margin-deg=nan"}) {
    ExpectOneLine(RunProgram(std::string("boundary --paper-table1 ") + flag), 2,
                  std::string(flag).substr(0, 12) + ": ");
  }
  ExpectOneLine(RunProgram("boundary --paper-table1 --set-u-deg=-1"), 2,
                "--set-u-deg: -1; expected 0 to 90");
  ExpectOneLine(RunProgram("boundary --paper-table1 --theory-deg 10+-inf"), 2,
                "--theory-deg: '10+-inf'; expected degrees from 0 to 90");
  ExpectOneLine(RunProgram("boundary --paper-table1 --feasible-deg 50:200"), 2,
                "--feasible-deg: '50:200'; expected LOW:HIGH in degrees within "
                "0:90");
  ExpectOneLine(RunProgram("boundary --paper-table1 --feasible-deg 9"), 2,
                "LOW:HIGH");
  ExpectOneLine(RunProgram("report --trials " + Sharp()), 2, "--body");
  ExpectOneLine(RunProgram("report --paper-table1 --rig /none.toml"), 3,
                "/none.toml");
  ExpectOneLine(RunProgram("report --paper-table1 --evidence /none"), 3,
                "/none");
  ExpectOneLine(RunProgram("report --paper-table1 --details /none.toml"), 3,
                "/none.toml: cannot be read; `touchdown report "
                "--details-example` prints one");
  ExpectOneLine(RunProgram("boundary --theory-deg 200 --trials " + Sharp()), 2,
                "--theory-deg");
}

TEST_F(BoundaryCommands, ABadLineOfACsvIsNamed) {
  const auto run = [&](const std::string& text) {
    return RunProgram("boundary --trials " + Write("bad.csv", text));
  };
  ExpectOneLine(run("angle_deg,u_deg\n1,2\n"), 3, "p_bounce");
  ExpectOneLine(run("angle_deg,u_deg,p_bounce\n10,0.1,1\nx,0.1,1\n"), 3,
                "line 3: angle_deg is 'x'");
  ExpectOneLine(run("angle_deg,u_deg,p_bounce\n10,0.1\n"), 3, "2 cells");
  ExpectOneLine(run("angle_deg,u_deg,p_bounce\n10,nan,1\n"), 3, "u_deg");
  ExpectOneLine(run("angle_deg,u_deg,p_bounce\n100,0.1,1\n"), 3, "0 to 90");
  ExpectOneLine(run(""), 3, "is empty");
}

TEST_F(BoundaryCommands, DatesAndReviewsNeedAStore) {
  const std::string file =
      Write("t.csv", "angle_deg,u_deg,p_bounce\n9,0.1,1\n");
  for (const std::string& source :
       {std::string("--paper-table1"), "--trials " + file}) {
    for (const char* filter :
         {" --from 2026-01-01", " --until 2026-01-01", " --reviewed"}) {
      ExpectOneLine(RunProgram("boundary " + source + filter), 2, "need --db");
    }
  }
}

TEST(ReadTrialsCsv, ReadsQuotedCellsWhole) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.csv";
  std::ofstream(path) << "angle_deg,u_deg,p_bounce,calibration\n"
                         "\n"
                         "# a remark, \"quoted\n"
                         "12.5,0.2,1,\"lens A,\nsecond\"\n"
                         "13.5,0.2,1,B\n";
  const auto trials = pipeline::ReadTrialsCsv(path, {.campaign = "c"});
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_EQ(trials[0].conditions->calibration.name, "lens A,\nsecond");
  EXPECT_EQ(trials[0].id, "line 4");
  EXPECT_EQ(trials[1].id, "line 6");
}

TEST(ReadTrialsCsv, ReadsColumnsInAnyOrderWithSpacesAndAMark) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.csv";
  std::ofstream(path) << "\xEF\xBB\xBFp_bounce, note ,u_deg,angle_deg\r\n"
                         "# a remark\r\n"
                         "\"0.5\",x, 0.2 ,12.5\r\n";
  const auto trials = pipeline::ReadTrialsCsv(path, {.campaign = "c"});
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_NEAR(core::ContactAngle(trials[0])->value / core::kDegree, 12.5,
              1e-12);
  EXPECT_NEAR(core::ContactAngle(trials[0])->u / core::kDegree, 0.2, 1e-12);
  EXPECT_EQ(trials[0].first.state.label, core::MotionState::kUndecided);
  EXPECT_EQ(trials[0].origin, core::Origin::kManual);
}

TEST(PaperTable1Trials, AreTheEighteenOfThePaper) {
  const auto paper = pipeline::PaperTable1Trials(0.0);
  EXPECT_EQ(paper.trials.size(), 18u);
  const auto bounces = std::count_if(
      paper.trials.begin(), paper.trials.end(), [](const core::Trial& trial) {
        return trial.first.state.label == core::MotionState::kBounce;
      });
  EXPECT_EQ(bounces, 5 + 6);
  EXPECT_EQ(paper.campaigns.size(), 2u);
}

}  // namespace
}  // namespace touchdown
