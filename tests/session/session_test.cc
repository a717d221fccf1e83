// A technician's session without a terminal: lines and recordings in, lines
// and trials out.
#include "app/session/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/session/bench.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/db/plan.h"
#include "touchdown/db/register.h"
#include "touchdown/rig/driver/manual_driver.h"

namespace touchdown::session {
namespace {

using core::kDegree;
using ::testing::HasSubstr;
using ::testing::Not;

class SessionTest : public ::testing::Test {
 protected:
  // Ends the session that is there, and begins another over the same store.
  void Begin(bool with_check = false) {
    session_.reset();
    store_.emplace(db::Store::Open(bench_.db(), db::OpenMode::kWrite));
    SessionOptions options;
    options.operator_name = "A. Lee";
    if (with_check) {
      CheckShot check;
      check.body = Bench::campaign().body;
      options.check = check;
    }
    SessionEnds ends;
    ends.say = [this](const std::string& line) { said_ += line + "\n"; };
    ends.now_s = [] {
      return std::chrono::duration<double>(
                 std::chrono::system_clock::now().time_since_epoch())
          .count();
    };
    ends.driver = &driver_;
    ends.analysing = [this](bool runs) { analysing_.push_back(runs); };
    session_.emplace(*store_, Bench::campaign(),
                     pipeline::MakeThrower(bench_.rig(), Bench::campaign()),
                     options, ends, ReadSession(bench_.db()));
    session_->Start();
  }
  std::string Obey(const std::string& line) {
    said_.clear();
    EXPECT_TRUE(session_->Obey(line));
    return said_;
  }
  std::string Take(const std::filesystem::path& recording) {
    said_.clear();
    session_->Take(recording);
    return said_;
  }
  std::vector<core::Trial> Trials(const std::string& campaign = "asphalt") {
    return store_->Trials({.campaign = campaign});
  }
  double Planned_deg() { return ReadSession(bench_.db())->angle_rad / kDegree; }

  Bench bench_;
  std::vector<std::string> asked_;
  rig::ManualDriver driver_{[this](const std::string& question) {
    asked_.push_back(question);
    return question.find("yes/no") == std::string::npos ? "" : "yes";
  }};
  std::string said_;
  std::vector<bool> analysing_;  // what was told of analyses
  std::optional<db::Store> store_;
  std::optional<Session> session_;
};

TEST_F(SessionTest, FromConventionsToTheSecondShot) {
  Begin();
  EXPECT_THAT(said_, HasSubstr("press Enter to accept"));
  // What comes too early waits.
  const auto early = bench_.Film("early.mraw", 24.0, 9);
  const auto minute_ago =
      std::filesystem::file_time_type::clock::now() - std::chrono::minutes(1);
  for (const auto& file :
       std::filesystem::directory_iterator(early.parent_path())) {
    std::filesystem::last_write_time(file.path(), minute_ago);
  }
  EXPECT_EQ(Take(early), "");
  EXPECT_TRUE(Trials().empty());
  EXPECT_TRUE(analysing_.empty());
  EXPECT_THAT(Obey("begin"), HasSubstr("press Enter"));
  EXPECT_THAT(Obey(""), HasSubstr("next shot: approach angle"));
  ASSERT_EQ(Trials().size(), 1u);
  EXPECT_FALSE(Trials()[0].set_angle_rad);
  EXPECT_EQ(analysing_, (std::vector<bool>{true, false}));

  const double planned_deg = Planned_deg();
  const std::string answer = Take(bench_.Film("a.mraw", 24.0, 1));
  EXPECT_THAT(answer, HasSubstr("bounce, approach angle 2"));
  EXPECT_THAT(answer, HasSubstr("by A. Lee"));
  EXPECT_THAT(answer, HasSubstr("boundary"));
  EXPECT_THAT(answer, HasSubstr("  set        elevation"));
  EXPECT_THAT(answer, HasSubstr("  predicted  approach angle"));
  ASSERT_EQ(Trials().size(), 2u);
  // Who was told the boundary has looked at it.
  const auto plan = db::PlanEvents(*store_, "asphalt");
  ASSERT_FALSE(plan.empty());
  EXPECT_EQ(plan.back().kind, db::PlanEventKind::kLook);
  EXPECT_EQ(plan.back().author, "session");
  EXPECT_EQ(plan.back().trials, 2);
  const core::Trial trial = Trials()[1];
  EXPECT_EQ(trial.author, "A. Lee");
  EXPECT_DOUBLE_EQ(*trial.set_angle_rad, planned_deg * kDegree);
  EXPECT_GT(*trial.set_speed_mps, 0.5);
  EXPECT_EQ(trial.clip.sha256.size(), 64u);
  EXPECT_EQ(ReadSession(bench_.db())->last["trial"], trial.id);
  // The same recording under another name is no other shot.
  std::filesystem::copy_file(bench_.films() / "a.mraw",
                             bench_.films() / "copy.mraw");
  std::filesystem::copy_file(bench_.films() / "a.cihx",
                             bench_.films() / "copy.cihx");
  analysing_.clear();
  EXPECT_THAT(Take(bench_.films() / "copy.mraw"), HasSubstr("known, trial"));
  EXPECT_EQ(Trials().size(), 2u);
  EXPECT_TRUE(analysing_.empty());
  EXPECT_FALSE(session_->Obey("quit"));
}

// What was set is stored with each shot: as the controller read it, else as it
// was planned; who, with what, and the operator's words.
TEST_F(SessionTest, WhatWasSetIsStoredWithTheShot) {
  {
    auto store = db::Store::Open(bench_.db(), db::OpenMode::kWrite);
    for (const auto& [kind, name] :
         {std::pair(db::RegisterKind::kSpring, "S 3"),
          std::pair(db::RegisterKind::kOperator, "A. Lee")}) {
      db::Entry entry = db::NewEntry(kind, name);
      entry.author = "Ada";
      db::AddEntry(store, entry);
    }
  }
  Begin();
  Obey("");
  EXPECT_THAT(Obey("condition spring=S 4"), HasSubstr("must be a spring"));
  EXPECT_THAT(Obey("condition temperature_c=21"), HasSubstr("40+-0.02"));
  EXPECT_THAT(Obey("condition hop=1"), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(Obey("condition spring=S 3"), HasSubstr("from now on"));
  EXPECT_THAT(Obey("condition temperature_c=21.5+-0.5"),
              HasSubstr("from now on"));
  EXPECT_THAT(Obey("note the door was open"), HasSubstr("with the next shot"));
  const auto planned = ReadSession(bench_.db())->set_points;
  Take(bench_.Film("a.mraw", 24.0, 1));
  Take(bench_.Film("b.mraw", 24.0, 2));
  ASSERT_EQ(Trials().size(), 2u);
  const core::Conditions first = *Trials()[0].conditions;
  EXPECT_NEAR(first.elevation_rad->value / kDegree,
              planned["elevation_deg"].get<double>(), 0.01);
  EXPECT_NEAR(first.compression_m->value / core::kMillimetre,
              planned["compression_mm"].get<double>(), 0.01);
  EXPECT_NEAR(first.muzzle_height_m->value / core::kMillimetre,
              planned["muzzle_height_mm"].get<double>(), 0.1);
  EXPECT_DOUBLE_EQ(first.compression_m->u, 0.1 * core::kMillimetre);  // kRig
  EXPECT_EQ(first.spring.name, "S 3");
  EXPECT_EQ(first.person.name, "A. Lee");
  EXPECT_DOUBLE_EQ(first.temperature_k->value, 294.65);
  EXPECT_EQ(first.note, "the door was open");
  const core::Conditions second = *Trials()[1].conditions;
  EXPECT_EQ(second.note, "");
  EXPECT_EQ(second.spring.name, "S 3");
  // A shot of before these set-points has none.
  const auto early = bench_.Film("early.mraw", 24.0, 9);
  const auto minute_ago =
      std::filesystem::file_time_type::clock::now() - std::chrono::minutes(1);
  for (const auto& file :
       std::filesystem::directory_iterator(early.parent_path())) {
    std::filesystem::last_write_time(file.path(), minute_ago);
  }
  Take(early);
  EXPECT_THAT(Trials()[2].conditions->elevation_rad.error().reason,
              HasSubstr("before these set-points"));
}

// rig.toml and the register are one: what is thrown by is kept there, once for
// each text, and can be thrown by from there.
TEST_F(SessionTest, TheRigIsKeptInTheRegister) {
  auto store = db::Store::Open(bench_.db(), db::OpenMode::kWrite);
  const auto thrower = pipeline::MakeThrower(bench_.rig(), Bench::campaign());
  const core::Registered first = pipeline::KeepRig(store, thrower, "A. Lee");
  EXPECT_EQ(first.name, "bench");
  EXPECT_EQ(pipeline::KeepRig(store, thrower, "Bob"), first);
  const auto named = pipeline::MakeThrower("bench", Bench::campaign(), 0.0,
                                           std::nullopt, bench_.db());
  EXPECT_EQ(named.entry, first);
  EXPECT_EQ(named.rig.u_compression_m, thrower.rig.u_compression_m);
  EXPECT_THROW(pipeline::MakeThrower("no such rig", Bench::campaign(), 0.0,
                                     std::nullopt, bench_.db()),
               core::InputError);
  std::ofstream(bench_.rig(), std::ios::app) << "# measured again\n";
  const core::Registered changed = pipeline::KeepRig(
      store, pipeline::MakeThrower(bench_.rig(), Bench::campaign()), "Bob");
  EXPECT_EQ(changed.name, "bench");
  EXPECT_NE(changed.id, first.id);
  EXPECT_EQ(
      db::ReadEntryVersions(store, db::RegisterKind::kRig, "bench").size(), 2u);
}

TEST_F(SessionTest, TheDailyCheckShotIsAskedForComparedAndLogged) {
  Begin(true);
  EXPECT_THAT(Obey(""),
              HasSubstr("check shot: drop the sphere 24 mm from 300"));
  EXPECT_EQ(session_->phase(), Phase::kCheck);
  EXPECT_THAT(Obey("skip"), HasSubstr("wants a reason"));
  const std::string answer = Take(bench_.Drop("drop.mraw", 0.3));
  EXPECT_THAT(answer, HasSubstr("check shot agrees"));
  EXPECT_THAT(answer, HasSubstr("next shot: approach angle"));
  EXPECT_TRUE(Trials().empty());
  const auto checks = Trials("check: sphere 24 mm from 300 mm");
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_THAT(checks[0].reason, HasSubstr("E_n"));
  // Done for today; one more only when asked for.
  Begin(true);
  EXPECT_EQ(session_->phase(), Phase::kShot);
  EXPECT_THAT(Obey("check"), HasSubstr("check shot: drop"));
  EXPECT_THAT(Take(bench_.Drop("high.mraw", 0.4)), HasSubstr("DOES NOT AGREE"));
  EXPECT_THAT(Obey("check"), HasSubstr("check shot: drop"));
  EXPECT_THAT(Obey("skip no time"), HasSubstr("skipped: no time"));
  // Why is on record; the plan is as it was.
  const auto events = db::PlanEvents(*store_, "asphalt");
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().reason, "check shot skipped: no time");
  EXPECT_EQ(events.back().author, "A. Lee");
  EXPECT_EQ(events.back().plan, db::Plan{});
  EXPECT_EQ(session_->phase(), Phase::kShot);
}

TEST_F(SessionTest, APersonCorrectsInWords) {
  Begin();
  Obey("");
  Obey("operator B. Ray");
  Take(bench_.Film("a.mraw", 24.0, 1));
  const std::string id = Trials()[0].id;
  EXPECT_EQ(Trials()[0].author, "B. Ray");
  EXPECT_THAT(Obey("exclude"), HasSubstr("wants a reason"));
  EXPECT_THAT(Obey("exclude it hit the frame"), HasSubstr("no longer counts"));
  EXPECT_EQ(Trials()[0].exclusion_reason, "it hit the frame");
  EXPECT_THAT(Obey("exclude again"), HasSubstr("excluded already"));
  EXPECT_THAT(Obey("undo"), HasSubstr("counts again"));
  EXPECT_FALSE(Trials()[0].excluded);
  EXPECT_THAT(Obey("undo"), HasSubstr("no longer counts"));
  EXPECT_THAT(Obey("undo"), HasSubstr("nothing to undo"));
  EXPECT_THAT(Obey("include it was good"), HasSubstr("counts again"));
  const auto history = store_->History(id);
  ASSERT_EQ(history.size(), 5u);  // nothing was removed
  EXPECT_EQ(history[3].trial.reason, "undo of the log");
  EXPECT_EQ(history[3].trial.author, "B. Ray");
  // Whoever comes after an interruption can still take the last one back.
  Begin();
  EXPECT_THAT(Obey("undo"), HasSubstr("no longer counts"));
  EXPECT_TRUE(Trials()[0].excluded);
  EXPECT_THAT(Obey("nonsense"), HasSubstr("is no command"));
  EXPECT_THAT(Obey("help"), HasSubstr("operator NAME"));
}

TEST_F(SessionTest, SkipsRepeatsAndTakesAnAngleOfOnesOwn) {
  Begin();
  EXPECT_THAT(Obey(""), HasSubstr("next shot"));
  EXPECT_THAT(Obey("repeat"), HasSubstr("there is no trial yet"));
  const double first = Planned_deg();
  Obey("skip");
  const double second = Planned_deg();
  EXPECT_GE(std::abs(first - second), 1.0 - 1e-9);
  Obey("skip");
  EXPECT_GE(std::abs(first - Planned_deg()), 1.0 - 1e-9);
  EXPECT_GE(std::abs(second - Planned_deg()), 1.0 - 1e-9);
  Obey("angle 23.5");
  EXPECT_NEAR(Planned_deg(), 23.5, 1e-9);
  EXPECT_THAT(Obey("angle 100"), HasSubstr("what the rig can throw"));
  EXPECT_THAT(Obey("angle x"), HasSubstr("angle is 'x'"));
  Take(bench_.Film("a.mraw", 24.0, 1));
  EXPECT_NEAR(*Trials()[0].set_angle_rad, 23.5 * kDegree, 1e-12);
  Obey("repeat");
  EXPECT_NEAR(Planned_deg(), 23.5, 1e-9);
}

TEST_F(SessionTest, GoesOnWhereItWas) {
  Begin();
  Obey("");
  Take(bench_.Film("a.mraw", 24.0, 1));
  Obey("angle 20.25");
  // Nobody is there; the shot that was planned is made.
  session_.reset();
  bench_.Film("b.mraw", 20.0, 2);
  Begin();
  EXPECT_NEAR(Planned_deg(), 20.25, 1e-9);
  EXPECT_THAT(Take(bench_.films() / "a.mraw"), HasSubstr("known, trial"));
  EXPECT_THAT(Take(bench_.films() / "b.mraw"), HasSubstr("(set 20.25)"));
  EXPECT_EQ(Trials().size(), 2u);
  // It was used up: a third has set-points only from a new plan.
  Begin();
  const auto old = bench_.Film("c.mraw", 22.0, 3);
  for (const char* file : {"c.mraw", "c.cihx"}) {
    std::filesystem::last_write_time(
        bench_.films() / file,
        std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  }
  EXPECT_THAT(Take(old), HasSubstr("shown: logged without set-points"));
  EXPECT_FALSE(Trials()[2].set_angle_rad);
}

// By a clock that is ahead, each recording seems to be of the plan.
TEST_F(SessionTest, ARecordingFromTheFutureHasNoSetPoints) {
  Begin();
  Obey("");
  const auto ahead = bench_.Film("a.mraw", 24.0, 1);
  for (const char* file : {"a.mraw", "a.cihx"}) {
    std::filesystem::last_write_time(
        bench_.films() / file,
        std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  }
  EXPECT_THAT(Take(ahead), HasSubstr("camera is ahead: logged without"));
  ASSERT_EQ(Trials().size(), 1u);
  EXPECT_FALSE(Trials()[0].set_angle_rad);
  EXPECT_FALSE(Trials()[0].set_speed_mps);
  EXPECT_THAT(Trials()[0].conditions->elevation_rad.error().reason,
              HasSubstr("clock of the camera is ahead"));
}

TEST_F(SessionTest, WhatCannotBeAnalysedIsSaidAndTheShotStays) {
  Begin();
  Obey("");
  const double planned = Planned_deg();
  pipeline::filmed::WriteRubbish(bench_.films() / "bad.avi");
  EXPECT_THAT(Take(bench_.films() / "bad.avi"), HasSubstr("not logged: "));
  EXPECT_THAT(Take(bench_.films() / "gone.avi"), HasSubstr("not logged: "));
  EXPECT_TRUE(Trials().empty());
  EXPECT_EQ(session_->phase(), Phase::kShot);
  EXPECT_EQ(Planned_deg(), planned);
}

TEST_F(SessionTest, ARecordingThatGrewIsNotLoggedTwice) {
  Begin();
  Obey("");
  // The first 100 of 115 frames, then all.
  pipeline::filmed::Film film =
      pipeline::filmed::Default(core::BodyKind::kSphere);
  film.frames = 100;
  pipeline::filmed::WriteFilm(bench_.films() / "a.mraw", film, 1);
  Take(bench_.films() / "a.mraw");
  film.frames = 115;
  pipeline::filmed::WriteFilm(bench_.films() / "a.mraw", film, 1);
  Take(bench_.films() / "a.mraw");
  const auto trials = Trials();
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_TRUE(trials[0].excluded);
  EXPECT_THAT(trials[0].exclusion_reason, HasSubstr("not complete"));
  EXPECT_FALSE(trials[1].excluded);
  EXPECT_EQ(trials[1].set_angle_rad, trials[0].set_angle_rad);
  // Another shot under the same name is another shot.
  bench_.Film("a.mraw", 20.0, 5);
  Take(bench_.films() / "a.mraw");
  ASSERT_EQ(Trials().size(), 3u);
  EXPECT_FALSE(Trials()[1].excluded);
}

TEST_F(SessionTest, ConventionsThatChangeEndIt) {
  Begin();
  Obey("");
  auto changed = Bench::campaign();
  changed.bounce_height_m = 0.001;
  store_->ChangeCampaign(changed);
  const auto film = bench_.Film("a.mraw", 24.0, 1);
  EXPECT_THROW(session_->Take(film), core::StoreError);
  EXPECT_TRUE(Trials().empty());
}

TEST_F(SessionTest, TheRigFiresOnAPersonsWordOnly) {
  Begin();
  EXPECT_THAT(Obey(""), HasSubstr("next shot"));
  EXPECT_THAT(Obey("fire 1"), HasSubstr("refused: no arming"));
  EXPECT_THAT(Obey("set"), HasSubstr("it reads elevation"));
  EXPECT_THAT(Obey("arm"), HasSubstr("fire 1"));
  EXPECT_THAT(Obey("fire"), HasSubstr("wants the number"));
  EXPECT_THAT(Obey("fire 2"), HasSubstr("refused"));
  EXPECT_THAT(Obey("fire 1"), HasSubstr("fired (1 shots)"));
  EXPECT_THAT(Obey("stop"), HasSubstr("STOPPED"));
  EXPECT_THAT(Obey("arm"), HasSubstr("refused: the rig was stopped"));
  EXPECT_THAT(Obey("reset"), HasSubstr("ready"));
  EXPECT_THAT(Obey("rig"), HasSubstr("interlock closed, not armed"));
}

}  // namespace
}  // namespace touchdown::session
