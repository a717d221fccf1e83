// Trials to files and back: app/exchange/trial_json.h,
// app/exchange/trial_csv.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "app/exchange/plan_json.h"
#include "app/exchange/register_json.h"
#include "app/exchange/trial_csv.h"
#include "app/exchange/trial_json.h"
#include "tests/db/fixture.h"
#include "tests/support/random_trials.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/maintenance.h"
#include "touchdown/db/plan.h"

namespace touchdown::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Property: a line of JSON holds a revision bit for bit: the line written from
// what was read is the same line, and says the same.
TEST(RevisionJson, RoundTripsAnything) {
  testing::RandomTrials random(4);
  std::mt19937_64 engine(5);
  for (int i = 0; i < 300; ++i) {
    db::Revision revision;
    revision.id = db::RandomUuid(engine);
    revision.kind = static_cast<db::RevisionKind>(i % 6);
    revision.trial = random.Trial();
    revision.trial.id = db::RandomUuid(engine);
    revision.trial.revision = 1 + i;
    const std::string line = RevisionJson(revision);
    EXPECT_EQ(line.find('\n'), std::string::npos);
    const db::Revision back = RevisionFromJson(line);
    EXPECT_EQ(RevisionJson(back), line);
    EXPECT_EQ(back.trial.first, revision.trial.first);
    EXPECT_EQ(back.trial.later, revision.trial.later);
    EXPECT_EQ(back.trial.body, revision.trial.body);
    EXPECT_EQ(back.trial.clip, revision.trial.clip);
    EXPECT_EQ(back.trial.reason, revision.trial.reason);
    EXPECT_EQ(back.trial.document_json, revision.trial.document_json);
  }
}

// A rebound that was not filmed to its top: no P(bounce), the gap that was
// filmed, and the one that the flight would reach.
TEST(RevisionJson, HoldsAReboundThatWasNotFilmedToItsTop) {
  db::Revision revision;
  revision.trial = db::SphereTrial(1);
  core::StateDecision& state = revision.trial.first.state;
  state.label = core::MotionState::kUndecided;
  state.p_bounce.reset();
  state.reason = "the film ends while the body rises";
  state.max_gap_m = core::Estimate{0.4e-3, 0.02e-3, std::nullopt};
  state.extrapolated_gap_m = core::Estimate{2.1e-3, 0.3e-3, std::nullopt};
  const db::Revision back = RevisionFromJson(RevisionJson(revision));
  EXPECT_EQ(back.trial.first.state, state);

  std::ostringstream csv;
  WriteTrialsCsv(csv, std::vector{revision.trial});
  std::istringstream in(csv.str());
  const CsvTrials read = ReadTrialsCsv(in, "trials.csv", "Ada");
  ASSERT_THAT(read.errors, IsEmpty());
  ASSERT_EQ(read.trials.size(), 1u);
  const core::StateDecision& cells = read.trials[0].trial.first.state;
  EXPECT_FALSE(cells.p_bounce);
  EXPECT_EQ(cells.reason, state.reason);
  ASSERT_TRUE(cells.extrapolated_gap_m);
  EXPECT_NEAR(cells.extrapolated_gap_m->value, 2.1e-3, 1e-15);
  EXPECT_NEAR(cells.extrapolated_gap_m->u, 0.3e-3, 1e-15);
}

TEST(RevisionJson, ReadsExportsThatAreOlderThanTheExtrapolatedGap) {
  db::Revision revision;
  revision.trial = db::SphereTrial(1);
  nlohmann::json old = nlohmann::json::parse(RevisionJson(revision));
  old["contacts"][0].erase("extrapolated_gap_m");
  const core::Measured read =
      RevisionFromJson(old.dump()).trial.first.state.extrapolated_gap_m;
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().reason, "exported before it was measured");
  old["contacts"][0].erase("max_gap_m");
  EXPECT_THROW(RevisionFromJson(old.dump()), std::invalid_argument);
}

TEST(RevisionJson, NamesTheFieldThatIsWrong) {
  db::Revision revision;
  revision.trial = db::SphereTrial(1);
  nlohmann::json json = nlohmann::json::parse(RevisionJson(revision));
  const auto message = [](const nlohmann::json& bad) -> std::string {
    try {
      RevisionFromJson(bad.dump());
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  for (const auto& [key, value] : json.items()) {
    nlohmann::json bad = json;
    bad.erase(key);
    // Exports of before the register have no conditions.
    EXPECT_THAT(message(bad),
                HasSubstr(key == "conditions" ? "accepted" : "'" + key + "'"));
    bad[key] = nlohmann::json::array({1});
    EXPECT_NE(message(bad), "accepted") << key;
  }
  EXPECT_THROW(RevisionFromJson("not json"), std::invalid_argument);
  EXPECT_THROW(RevisionFromJson("[]"), std::invalid_argument);
}

TEST(ExportReader, BringsAStoreOverWhole) {
  db::Folder folder;
  db::Store a = db::OpenFixed(folder / "a.db", 1);
  a.AddCampaign(db::SphereCampaign());
  db::SetPlan(a, db::SphereCampaign().name, {"up \xff", "after 40", ""}, "Ada",
              "");
  testing::RandomTrials random(6);
  std::string id;
  for (int i = 0; i < 30; ++i) id = a.LogTrial(random.Trial()).id;
  db::Entry spring = db::NewEntry(db::RegisterKind::kSpring, "S \xff 3");
  spring.author = "Ada";
  spring.measured.insert_or_assign("stiffness_n_per_m",
                                   core::Estimate{1200.0, 2.0, std::nullopt});
  spring = db::AddEntry(a, spring);
  core::Trial first = db::SphereTrial(1);
  first.conditions.emplace().spring.name = spring.name;
  const auto asphalt = a.LogTrial(first);
  spring.reason = "it was painted";
  spring.texts["note"] = "=green";
  db::ChangeEntry(a, spring);
  a.LogTrial(db::SphereTrial(1));
  a.Exclude(asphalt.id, "Ada", "lamp");
  db::RecordLook(a, db::SphereCampaign().name, "report");
  const auto exported = [](const db::Store& store) {
    std::ostringstream out;
    WriteExportHeader(out, "the store");
    for (const auto& e : db::AllVersions(store)) out << EntryJson(e) << '\n';
    for (const auto& c : store.Campaigns()) out << CampaignJson(c) << '\n';
    for (const auto& e : db::PlanEvents(store)) out << PlanEventJson(e) << '\n';
    store.ForEachHistory([&](const auto& history) {
      for (const auto& r : history) out << RevisionJson(r) << '\n';
    });
    return out.str();
  };
  std::istringstream in(exported(a));
  ExportReader reader(in, "a.jsonl");
  EXPECT_EQ(reader.store_uuid(), "the store");
  db::Store b = db::OpenFixed(folder / "b.db", 2);
  const auto report =
      db::Restore(b, reader.store_uuid(), reader.entries(), reader.campaigns(),
                  reader.plan(), [&reader] { return reader.NextHistory(); });
  EXPECT_EQ(report.plan_events_added, 2);
  EXPECT_THAT(db::Check(b).problems, ::testing::IsEmpty());
  EXPECT_EQ(report.trials_added, 31);
  EXPECT_EQ(report.revisions_added, 33);
  EXPECT_EQ(report.register_versions_added, 3);  // with the campaign's surface
  EXPECT_EQ(exported(b), exported(a));
  EXPECT_EQ(b.Find(asphalt.id)->conditions->spring.name, "S \xff 3");
}

TEST(ExportReader, APlanIsOfACampaignOfTheFile) {
  db::PlanEvent of_gravel;
  of_gravel.campaign = "gravel";
  std::istringstream in(
      "{\"schema\":\"touchdown.export/1\",\"store\":\"x\"}\n" +
      PlanEventJson(of_gravel) + "\n");
  try {
    ExportReader reader(in, "a.jsonl");
    ADD_FAILURE();
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.jsonl:2: campaign is 'gravel'"));
  }
}

TEST(ExportReader, NamesFileAndLine) {
  std::istringstream in(
      "{\"schema\":\"touchdown.export/1\",\"store\":\"x\"}\n\nrubbish\n");
  ExportReader reader(in, "a.jsonl");
  try {
    reader.NextHistory();
    ADD_FAILURE();
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.jsonl:3: this is not JSON"));
  }
  std::istringstream empty("");
  EXPECT_THROW(ExportReader(empty, "a.jsonl"), core::InputError);
}

// --- CSV ---------------------------------------------------------------------

CsvTrials Read(const std::string& text) {
  std::istringstream in(text);
  return ReadTrialsCsv(in, "t.csv", "Ada");
}

TEST(ReadTrialsCsv, ReadsWhatALabWrites) {
  // A byte order mark, CRLF, quotes, a line break in a cell, a blank line.
  const CsvTrials read = Read(
      "\xef\xbb\xbf"
      "state,body_kind,diameter_mm,diameter_u_mm,approach_angle_deg,"
      "approach_angle_u_deg,state_because,set_angle_deg\r\n"
      "bounce,sphere,40,0.02,20,0.5,\"seen, \"\"clearly\"\"\nand twice\",21\r\n"
      "\r\n"
      "slide,rectangle,,,,,,\r\n");
  EXPECT_THAT(read.errors, IsEmpty());
  ASSERT_EQ(read.trials.size(), 2u);
  const core::Trial& trial = read.trials[0].trial;
  EXPECT_EQ(read.trials[0].row, 2u);
  EXPECT_EQ(trial.origin, core::Origin::kManual);
  EXPECT_EQ(trial.author, "Ada");
  EXPECT_DOUBLE_EQ(trial.body.diameter_m->value, 0.040);
  EXPECT_DOUBLE_EQ(trial.body.diameter_m->u, 0.00002);
  EXPECT_DOUBLE_EQ(trial.first.contact.approach_angle_rad->value,
                   20 * core::kDegree);
  EXPECT_EQ(trial.first.state.reason, "seen, \"clearly\"\nand twice");
  EXPECT_DOUBLE_EQ(*trial.set_angle_rad, 21 * core::kDegree);
  EXPECT_EQ(trial.first.motion.restitution.error().reason, "not recorded");
  EXPECT_EQ(read.trials[1].trial.angle_kind, core::AngleKind::kRadius);
}

TEST(ReadTrialsCsv, NamesRowAndColumnOfEachError) {
  const CsvTrials read = Read(
      "body_kind,state,approach_angle_deg,approach_angle_u_deg\n"
      "sphere,bounce,20,0.5\n"
      "sphere,fly,2x,0.5\n"
      "sphere,bounce,20,\n"
      "sphere,bounce,\"12,5\",1\n"
      "sphere,bounce,nan,1\n"
      "sphere,bounce,,1\n"
      "sphere,bounce,1,-1\n"
      "sphere,bounce\n"
      ",bounce,1,1\n");
  EXPECT_EQ(read.trials.size(), 1u);
  EXPECT_THAT(
      read.errors,
      ElementsAre(
          HasSubstr("t.csv: row 3, column state: 'fly'"),
          HasSubstr("row 3, column approach_angle_deg: '2x': a number with a"),
          HasSubstr("row 4, column approach_angle_u_deg"),
          HasSubstr("row 5, column approach_angle_deg: '12,5'"),
          HasSubstr("row 6, column approach_angle_deg: 'nan'"),
          HasSubstr("row 7, column approach_angle_u_deg"),
          HasSubstr("row 8, column approach_angle_u_deg: '-1'"),
          HasSubstr("row 9: 2 cells, 4"),
          HasSubstr("row 10, column body_kind")));
}

TEST(ReadTrialsCsv, RefusesHeadersItDoesNotUnderstand) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      Read(text);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message("body_kind,state,diameter_m\n"),
              HasSubstr("this table has it as 'diameter_mm'"));
  EXPECT_THAT(message("body_kind,state,approach_angle_rad\n"),
              HasSubstr("'approach_angle_deg'"));
  EXPECT_THAT(message("body_kind,state,colour\n"), HasSubstr("no column"));
  EXPECT_THAT(message("body_kind,state,state\n"), HasSubstr("twice"));
  EXPECT_THAT(message("state\n"), HasSubstr("'body_kind' is missing"));
  EXPECT_THAT(message(""), HasSubstr("empty"));
  EXPECT_THAT(message("body_kind,state\nsphere,\"bounce\n"),
              HasSubstr("row 2: a quote is left open"));
}

// Property: what CSV can hold comes back. (Cells are text, so a number is the
// same to within rounding of the unit.)
TEST(WriteTrialsCsv, IsReadBack) {
  std::vector<core::Trial> trials;
  for (int i = 0; i < 10; ++i) {
    core::Trial trial = db::SphereTrial(i);
    trial.first.state.reason = i % 2 == 0 ? "=HYPERLINK(\"x\")" : "-a, \"b\"";
    trial.first.motion.restitution =
        core::Estimate{0.1 * i, 0.01, std::nullopt};
    if (i % 3 != 0) {
      core::Conditions& conditions = trial.conditions.emplace();
      conditions.spring.name = "=S\n" + std::to_string(i);
      conditions.temperature_k = core::Estimate{294.65, 0.5, std::nullopt};
      conditions.anomaly = core::Anomaly::kOther;
      conditions.anomaly_note = "@dust";
    }
    trials.push_back(trial);
  }
  std::ostringstream out;
  WriteTrialsCsv(out, trials);
  // No cell begins as a formula does.
  EXPECT_EQ(out.str().find(",="), std::string::npos);
  EXPECT_EQ(out.str().find("\"="), std::string::npos);
  const CsvTrials read = Read(out.str());
  EXPECT_THAT(read.errors, IsEmpty());
  ASSERT_EQ(read.trials.size(), trials.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const core::Trial& back = read.trials[i].trial;
    EXPECT_EQ(back.campaign, trials[i].campaign);
    EXPECT_EQ(back.origin, trials[i].origin);
    EXPECT_EQ(back.clip, trials[i].clip);
    EXPECT_EQ(back.conditions, trials[i].conditions);
    EXPECT_EQ(back.first.state.label, trials[i].first.state.label);
    EXPECT_EQ(back.first.state.reason, trials[i].first.state.reason);
    EXPECT_NEAR(back.first.contact.approach_angle_rad->value,
                trials[i].first.contact.approach_angle_rad->value, 1e-15);
    EXPECT_NEAR(back.first.motion.restitution->value,
                trials[i].first.motion.restitution->value, 1e-15);
  }
}

}  // namespace
}  // namespace touchdown::report
