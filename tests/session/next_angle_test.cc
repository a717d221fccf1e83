// The next angle is one and the same in the session, in `next`, on the review
// page and in the report, and lies where the rig can throw.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/review/statistics.h"
#include "app/session/session.h"
#include "app/shots/thrower.h"
#include "tests/session/bench.h"
#include "tests/support/run_program.h"
#include "touchdown/core/units.h"
#include "touchdown/db/plan.h"

namespace touchdown::session {
namespace {

using core::kDegree;
using nlohmann::json;
using ::testing::HasSubstr;
using testing::ReadAll;
using testing::RunProgram;

struct Seen {
  double angle_deg;
  bool bounced;
};

class NextAngleTest : public ::testing::Test {
 protected:
  void Log(const std::vector<Seen>& shots) {
    auto store = db::Store::Open(bench_.db(), db::OpenMode::kWrite);
    for (const Seen& shot : shots) {
      core::Trial trial = Trial(shot.angle_deg);
      trial.first.state.label = shot.bounced ? core::MotionState::kBounce
                                             : core::MotionState::kStaysDown;
      trial.first.state.p_bounce = shot.bounced ? 1.0 : 0.0;
      store.LogTrial(trial);
    }
  }
  static core::Trial Trial(double angle_deg) {
    core::Trial trial;
    trial.campaign = "asphalt";
    trial.body = Bench::campaign().body;
    trial.first.contact.found = true;
    trial.first.contact.approach_angle_rad =
        core::Estimate{angle_deg * kDegree, 0.05 * kDegree, std::nullopt};
    trial.author = "touchdown";
    return trial;
  }
  // What each of the four says, as a sentence; the angle with it.
  void ExpectOneAnswer(const std::string& words) {
    const std::string db = " --db " + bench_.db().string();
    const std::string rig = " --rig " + bench_.rig().string();
    const auto next = RunProgram("next --campaign asphalt --json" + db + rig);
    ASSERT_EQ(next.status, 0) << next.err;
    const json document = json::parse(next.out);
    const double angle_deg = document["angle_deg"];
    const std::string sentence = document["sentences"]["next"];
    EXPECT_THAT(sentence, HasSubstr(words));
    EXPECT_THAT(RunProgram("next --campaign asphalt" + db + rig).out,
                HasSubstr(sentence));
    EXPECT_THAT(RunProgram("boundary --campaign asphalt" + db + rig).out,
                HasSubstr(sentence));

    const auto folder = bench_.films() / "report";
    const auto report =
        RunProgram("report --out " + folder.string() + db + rig);
    ASSERT_EQ(report.status, 0) << report.err;
    const json table = json::parse(ReadAll(folder / "table1.json"));
    EXPECT_EQ(table["groups"][0]["next"]["angle_deg"], angle_deg);
    EXPECT_THAT(ReadAll(folder / "table1.md"), HasSubstr(sentence));

    const json page = json::parse(
        review::MakeStatistics(
            bench_.db(), pipeline::ReachOfRig(bench_.rig(), 0.0, std::nullopt))
            .json);
    EXPECT_EQ(page["groups"][0]["next"]["angle_deg"], angle_deg);
    EXPECT_EQ(page["groups"][0]["sentences"]["next"], sentence);

    EXPECT_NEAR(Planned_deg(), angle_deg, 1e-12);
    EXPECT_THAT(said_, HasSubstr(sentence));
    const core::Interval reach = pipeline::RequireReach(
        pipeline::MakeThrower(bench_.rig(), Bench::campaign()));
    EXPECT_GE(angle_deg * kDegree, reach.low - 1e-12);
    EXPECT_LE(angle_deg * kDegree, reach.high + 1e-12);
  }
  // The angle that a session plans now.
  double Planned_deg() {
    std::filesystem::remove(SessionPath(bench_.db()));
    auto store = db::Store::Open(bench_.db(), db::OpenMode::kWrite);
    SessionOptions options;
    options.operator_name = "A. Lee";
    SessionEnds ends;
    said_.clear();
    ends.say = [this](const std::string& line) { said_ += line + "\n"; };
    ends.now_s = [] { return 0.0; };
    Session session(store, Bench::campaign(),
                    pipeline::MakeThrower(bench_.rig(), Bench::campaign()),
                    options, ends, std::nullopt);
    session.Start();
    return ReadSession(bench_.db())->angle_rad / kDegree;
  }

  Bench bench_;
  std::string said_;
};

TEST_F(NextAngleTest, IsTheSameEverywhere) {
  Log({{18.0, false}, {22.0, false}, {27.0, true}, {40.0, true}});
  ExpectOneAnswer("(within ");
}

// Whoever asks for the next angle is told the boundary: a look, once for the
// same trials.
TEST_F(NextAngleTest, IsALookOnRecord) {
  Log({{18.0, false}, {27.0, true}});
  for (int i = 0; i < 2; ++i) {
    const auto next =
        RunProgram("next --campaign asphalt --db " + bench_.db().string());
    ASSERT_EQ(next.status, 0) << next.err;
  }
  const auto store = db::Store::Open(bench_.db(), db::OpenMode::kRead);
  const auto plan = db::PlanEvents(store, "asphalt");
  ASSERT_EQ(plan.size(), 1u);
  EXPECT_EQ(plan[0].kind, db::PlanEventKind::kLook);
  EXPECT_EQ(plan[0].author, "next");
  EXPECT_EQ(plan[0].trials, 2);
}

TEST_F(NextAngleTest, SaysThatEveryBodyBounced) {
  Log({{40.0, true}, {30.0, true}});
  ExpectOneAnswer("Every body bounced: the boundary lies lower");
}

TEST_F(NextAngleTest, SaysThatNoBodyBounced) {
  Log({{15.0, false}, {20.0, false}});
  ExpectOneAnswer("Every body stayed down: the boundary lies higher");
}

// A boundary below what the rig throws: the nearer end, and what can be done.
TEST_F(NextAngleTest, StaysWithinTheRigsReachAndSaysWhatCanBeDone) {
  const core::Interval reach = pipeline::RequireReach(
      pipeline::MakeThrower(bench_.rig(), Bench::campaign()));
  ASSERT_GT(reach.low, 2.0 * kDegree);  // else this test shows nothing
  Log({{reach.low / kDegree, true}, {reach.low / kDegree + 0.1, true}});
  ExpectOneAnswer("another speed or bounce height");
}

// A film that ends while the body rises says nothing: neither the boundary nor
// the next set-point moves, and the trial is named with its reason.
TEST_F(NextAngleTest, AReboundNotFilmedToItsTopMovesNothing) {
  Log({{18.0, false}, {22.0, false}, {27.0, true}, {40.0, true}});
  const std::string ask = "next --campaign asphalt --db " +
                          bench_.db().string() + " --rig " +
                          bench_.rig().string();
  const json before = json::parse(RunProgram(ask + " --json").out);
  {
    core::Trial cut = Trial(24.0);
    cut.first.state.label = core::MotionState::kUndecided;
    cut.first.state.reason = "the film ends while the body rises";
    cut.first.state.max_gap_m = core::Estimate{0.3e-3, 0.01e-3, std::nullopt};
    cut.first.state.extrapolated_gap_m =
        core::Estimate{4.0e-3, 0.2e-3, std::nullopt};
    auto store = db::Store::Open(bench_.db(), db::OpenMode::kWrite);
    store.LogTrial(cut);
  }
  const json after = json::parse(RunProgram(ask + " --json").out);
  EXPECT_EQ(after["posterior"], before["posterior"]);
  EXPECT_EQ(after["likelihood"], before["likelihood"]);
  EXPECT_EQ(after["next"], before["next"]);
  EXPECT_EQ(after["counts"]["left_out"], 1);
  const std::string reason =
      "undecided, without a P(bounce): the film ends while the body rises; the "
      "flight would reach 4 +- 0.2 mm";
  EXPECT_EQ(after["left_out"][0]["reason"], reason);
  EXPECT_THAT(RunProgram(ask).out, HasSubstr(reason));
  ExpectOneAnswer("(within ");
  // The report typesets what a terminal cannot.
  std::string typeset = reason;
  typeset.replace(typeset.find("+-"), 2, "±");
  EXPECT_THAT(ReadAll(bench_.films() / "report" / "table1.md"),
              HasSubstr(typeset));
}

}  // namespace
}  // namespace touchdown::session
