#include "app/report/evidence_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

#include "app/facts/analysis_facts.h"
#include "app/text/text.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;

core::Trial Shot(const std::string& id, double angle_deg, bool bounced) {
  core::Trial trial;
  trial.id = id;
  trial.revision = 1;
  trial.campaign = "asphalt";
  trial.clip.path = "clips/" + id + ".mraw";
  trial.clip.id = "c-" + id;
  trial.body = core::Sphere({40 * kMillimetre, 0.02 * kMillimetre});
  trial.set_angle_rad = 12 * kDegree;
  core::Contact& contact = trial.first.contact;
  contact.found = true;
  contact.approach_angle_rad =
      core::Estimate{angle_deg * kDegree, 0.05 * kDegree};
  contact.approach_budget = {{"ground", 0.03 * kDegree},
                             {"localisation", 0.04 * kDegree}};
  auto& state = trial.first.state;
  state.label =
      bounced ? core::MotionState::kBounce : core::MotionState::kSlide;
  state.p_bounce = bounced ? 1.0 : 0.0;
  state.reason = "greatest gap";
  trial.first.motion.restitution = core::Estimate{0.5, 0.004};
  trial.document_json =
      R"({"clip": {"format": "mraw", "width_px": 640, "height_px": 400,
                   "frames": 320, "bit_depth": 12,
                   "time_base": {"fps": 2000.0, "source": "header"}},
          "scale": {"px_per_m": {"value": 1000.0, "u": 0.8},
                    "source": "calibration"},
          "ground": {"source": "user", "u_angle_deg": 0.02},
          "calibration": {"camera": "south", "date": "2026-08-01",
                          "lens_rms_px": 0.11},
          "scene_model": {"used": ["circle"], "left_out": {"spin": "no mark"}},
          "warnings": ["two shadows"]})";
  return trial;
}

ReportInput TwoShots() {
  ReportInput input;
  input.trials = {Shot("a1", 11.9, false), Shot("b2", 12.4, true)};
  input.evidence_pages = true;
  return input;
}

TEST(EvidencePage, HoldsWhatIsKnownOfATrial) {
  const ReportInput input = TwoShots();
  const std::string html = ToHtml(MakeEvidencePage(input.trials[1], input));
  for (const char* part :
       {"approach angle 12.400 \u00b1 0.050 deg, bounce", "greatest gap",
        "64.0", "36.0", "0.5000 \u00b1 0.0040", "camera south, of 2026-08-01",
        "lens to 0.11 px rms", "1000.00 \u00b1 0.80 px/m, from calibration",
        "2000 frames/s", "spin (no mark)", "two shadows", "c-b2",
        "href=\"../table1.html\"", "No picture of this analysis"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_THAT(html, Not(HasSubstr("class=\"simulated\"")));
}

TEST(EvidencePage, SimulatedTrialsAreWatermarked) {
  ReportInput input = TwoShots();
  input.trials[0].origin = core::Origin::kSimulated;
  EXPECT_THAT(ToHtml(MakeEvidencePage(input.trials[0], input)),
              HasSubstr("class=\"simulated\""));
}

TEST(EvidencePage, EveryRowOfTheReportLinksToItsPage) {
  ReportInput input = TwoShots();
  const Report with = MakeReport(input);
  for (const char* id : {"a1", "b2"}) {
    const std::string link = std::string("evidence/") + id + ".html";
    EXPECT_THAT(with.html, HasSubstr("<a href=\"" + link + "\">"));
    EXPECT_THAT(with.markdown, HasSubstr("](" + link + ")"));
  }
  input.evidence_pages = false;
  const Report without = MakeReport(input);
  EXPECT_THAT(without.html, Not(HasSubstr("evidence/")));
  EXPECT_THAT(without.markdown, Not(HasSubstr("evidence/")));
}

TEST(EvidencePage, NamesAreFileNamesAndDiffer) {
  std::set<std::string> names;
  for (const char* id :
       {"a/b", "a b", "../a", "", "a-b", "A-b", "\xff\xfe", "<script>"}) {
    core::Trial trial;
    trial.id = id;
    const std::string name = EvidencePageName(trial);
    EXPECT_EQ(name.find_first_of("/\\ <>\""), std::string::npos) << name;
    EXPECT_TRUE(name.ends_with(".html"));
    names.insert(name);
  }
  EXPECT_EQ(names.size(), 8u);
  core::Trial longest;
  longest.id = std::string(10'000, '_');
  EXPECT_LT(EvidencePageName(longest).size(), 200u);
  longest.id = std::string(10'000, 'a');
  EXPECT_LT(EvidencePageName(longest).size(), 200u);
}

TEST(EvidencePage, APictureLiesInsideThePage) {
  const TemporaryFolder folder;
  ReportInput input = TwoShots();
  input.pictures["a1"] = folder.path() / "contact.png";
  std::ofstream(input.pictures["a1"]) << "any bytes";
  WriteEvidencePages(input, folder.path());
  std::ifstream page(folder.path() / "evidence" / "a1.html");
  const std::string html{std::istreambuf_iterator<char>(page), {}};
  EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64,YW55IGJ5dGVz\""));
  input.pictures["a1"] = folder.path() / "none.png";
  EXPECT_THROW(WriteEvidencePages(input, folder.path()), core::InputError);
}

TEST(EvidencePage, HostileTextAndDamagedDocumentsStayHarmless) {
  ReportInput input = TwoShots();
  core::Trial& trial = input.trials[0];
  trial.id = "\"><script>alert(1)</script>";
  trial.first.state.reason = "<script>";
  for (const char* document :
       {"", "{", "[]", "{\"clip\": 3, \"scale\": [], \"warnings\": {\"a\": 1}}",
        "{\"scale\": {\"px_per_m\": {\"value\": \"x\"}, \"source\": 7}}",
        "{\"warnings\": [\"<script>\", [[]], null]}"}) {
    trial.document_json = document;
    EXPECT_THAT(ToHtml(MakeEvidencePage(trial, input)),
                Not(HasSubstr("<script")));
  }
  EXPECT_THAT(MakeReport(input).html, Not(HasSubstr("<script")));
}

TEST(SetPoints, ThePredictionOfTheRigStandsBesideTheMeasurement) {
  ReportInput input = TwoShots();
  input.rig.facts = {{"rig", "bench ejector"}};
  // (6.1 - 6.0) / sqrt(0.06^2 + 0.08^2) = 1; (12.4 - 12) / sqrt(0.1^2 + 1^2).
  input.rig.predictions["b2"] = {core::Estimate{6.0, 0.03},
                                 core::Estimate{12 * kDegree, 0.5 * kDegree},
                                 core::Estimate{6.1, 0.04}};
  const core::Measured none = core::AbsentBecause("no set-point of the speed");
  input.rig.predictions["a1"] = {none, none, none};
  const std::string text = MakeReport(input).markdown;
  EXPECT_THAT(text, HasSubstr("6.000 \u00b1 0.030 | 6.100 \u00b1 0.040 | "
                              "+1.00 | 12.00 \u00b1 0.50 | 12.400 \u00b1 "
                              "0.050 | +0.40 |"));
  EXPECT_THAT(text, HasSubstr("no set-point of the speed (1 trial)"));
  EXPECT_THAT(text, HasSubstr("bench ejector"));
}

TEST(AnalysisSources, AreTheSameForEveryTrial) {
  core::Trial trial = Shot("a", 12, true);
  const auto names = AnalysisSources(trial);
  trial.document_json = "{}";
  const auto empty = AnalysisSources(trial);
  ASSERT_EQ(names.size(), empty.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(names[i].first, empty[i].first);
    EXPECT_EQ(empty[i].second, "");
  }
}

TEST(Base64, Rfc4648) {
  const char* const cases[][2] = {
      {"", ""},        {"f", "Zg=="},        {"fo", "Zm8="},
      {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"\xff\xfe\xfd", "//79"}};
  for (const auto& [bytes, text] : cases) EXPECT_EQ(Base64(bytes), text);
}

}  // namespace
}  // namespace touchdown::report
