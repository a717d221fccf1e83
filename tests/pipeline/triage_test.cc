// The order in which a person should look.
#include "app/batch/triage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace touchdown::pipeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

core::Trial Bounce(double u_rad = 0.001) {
  core::Trial trial;
  trial.id = "f81d4fae-7dec-41d0-a765-00a0c91e6bf6";
  trial.revision = 1;
  trial.first.contact.found = true;
  trial.first.contact.approach_angle_rad =
      core::Estimate{0.3, u_rad, std::nullopt};
  trial.first.state.label = core::MotionState::kBounce;
  trial.first.state.p_bounce = 0.999;
  trial.document_json = R"({"warnings": []})";
  return trial;
}

core::Trial Undecided(std::optional<double> p_bounce) {
  core::Trial trial = Bounce();
  trial.first.state.label = core::MotionState::kUndecided;
  trial.first.state.p_bounce = p_bounce;
  return trial;
}

std::vector<TriageEntry> OneOfEach() {
  const auto of = [](const char* name, const core::Trial& trial) {
    return MakeTriageEntry(name, Done::kLogged, trial);
  };
  std::vector<TriageEntry> entries;
  entries.push_back(of("sure", Bounce(0.001)));
  entries.push_back(of("less sure", Bounce(0.002)));
  core::Trial warned = Bounce();
  warned.document_json = R"({"warnings": ["=dark", "blurred"]})";
  entries.push_back(of("warned", warned));
  core::Trial no_angle = Bounce();
  no_angle.first.contact.approach_angle_rad = core::AbsentBecause("too short");
  entries.push_back(of("no angle", no_angle));
  entries.push_back(of("leaning", Undecided(0.9)));
  entries.push_back(of("even", Undecided(0.45)));
  entries.push_back(of("not filmed", Undecided(std::nullopt)));
  core::Trial nothing;
  nothing.first.contact.reason = "nothing moved";
  entries.push_back(of("nothing", nothing));
  TriageEntry copy;
  copy.clip = "copy";
  copy.done = Done::kCopy;
  copy.attention = Attention::kCopy;
  entries.push_back(copy);
  TriageEntry failed;
  failed.clip = "<b>\xff";
  failed.reason = "@cannot be read";
  entries.push_back(failed);
  return entries;
}

TEST(SortByNeed, TheMostPressingFirst) {
  auto entries = OneOfEach();
  SortByNeed(entries);
  std::vector<std::string> names;
  for (const auto& entry : entries) names.push_back(entry.clip);
  EXPECT_THAT(names,
              ElementsAre("<b>\xff", "nothing", "not filmed", "even", "leaning",
                          "no angle", "warned", "copy", "less sure", "sure"));
  EXPECT_EQ(entries[1].reason, "nothing moved");
  EXPECT_EQ(entries[5].reason, "too short");
  EXPECT_EQ(entries[6].reason, "=dark; blurred");
  const TriageCounts counts = Count(entries);
  EXPECT_EQ(counts.logged, 8u);
  EXPECT_EQ(counts.copies, 1u);
  EXPECT_EQ(counts.failed, 1u);
  EXPECT_EQ(counts.to_look_at, 8u);
}

TEST(TriageJson, SaysEverythingAndIsUtf8) {
  const auto document = nlohmann::json::parse(TriageJson(OneOfEach()));
  EXPECT_EQ(document["schema"], "touchdown.batch/1");
  EXPECT_EQ(document["counts"]["clips"], 10);
  EXPECT_EQ(document["counts"]["failed"], 1);
  ASSERT_EQ(document["clips"].size(), 10u);
  const auto& sure = document["clips"][0];
  EXPECT_EQ(sure["state"], "bounce");
  EXPECT_TRUE(sure["attention"].is_null());
  EXPECT_NEAR(sure["angle_deg"]["value"].get<double>(), 17.1887, 1e-4);
  EXPECT_EQ(sure["angle_kind"], "approach");
  EXPECT_EQ(document["clips"][3]["absent"]["angle_deg"], "too short");
  EXPECT_EQ(document["clips"][9]["done"], "failed");
}

// No cell is run as a formula by a spreadsheet.
TEST(TriageCsv, IsATableWithoutFormulas) {
  const std::string csv = TriageCsv(OneOfEach());
  EXPECT_THAT(csv, StartsWith("clip,done,attention,reason,trial,"));
  EXPECT_THAT(csv, HasSubstr("warned,logged,warned,'=dark; blurred,"));
  EXPECT_THAT(csv, HasSubstr("failed,failed,'@cannot be read"));
}

// What the analysis in force warned of is still to be looked at.
TEST(MakeTriageEntry, AProposalHidesNoWarning) {
  core::Trial trial = Bounce();
  trial.document_json = R"({"warnings": ["dark"]})";
  const core::Trial proposal = Undecided(0.5);
  const TriageEntry entry =
      MakeTriageEntry("a", Done::kKnown, trial, &proposal);
  EXPECT_EQ(entry.attention, Attention::kProposed);
  EXPECT_THAT(entry.reason, StartsWith("dark; a person's correction"));
}

// The document of a trial that came from elsewhere need not be JSON.
TEST(MakeTriageEntry, ADocumentThatIsNone) {
  for (const char* document :
       {"", "{", "[]", R"({"warnings": 3})", R"({"warnings": [3, null]})"}) {
    core::Trial trial = Bounce();
    trial.document_json = document;
    EXPECT_EQ(MakeTriageEntry("a", Done::kKnown, trial).attention,
              Attention::kNone)
        << document;
  }
}

}  // namespace
}  // namespace touchdown::pipeline
