// session as a user runs it: typed lines, a folder, signals, and the end at any
// instant. TOUCHDOWN_LONG_TESTS=1 runs the long form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "app/session/session_file.h"
#include "tests/rig/driver/simulated_controller.h"
#include "tests/session/bench.h"
#include "tests/support/busy_clip.h"
#include "tests/support/program.h"
#include "tests/support/running_program.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::session {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::RunningProgram;

class SessionCommand : public ::testing::Test {
 protected:
  std::vector<std::string> Arguments(std::vector<std::string> more = {}) const {
    std::vector<std::string> out = {TOUCHDOWN_BINARY, "session",
                                    "--db",           bench_.db().string(),
                                    "--campaign",     "asphalt",
                                    "--rig",          bench_.rig().string(),
                                    "--watch",        bench_.films().string(),
                                    "--quiet-s",      "0.05"};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  void ExpectMistake(std::vector<std::string> arguments, int status,
                     const std::string& says) const {
    const testing::TemporaryFolder scratch;
    const auto ran =
        testing::RunProgram(std::move(arguments), scratch.path().string());
    EXPECT_EQ(ran.status, status) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(says));
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
  std::vector<core::Trial> Trials() const {
    return db::Store::Open(bench_.db(), db::OpenMode::kRead).Trials();
  }

  Bench bench_;
};

TEST_F(SessionCommand, TakesWhatComesAndEndsWhenTold) {
  RunningProgram session(Arguments({"--operator", "A. Lee", "--no-check"}));
  EXPECT_THAT(session.Until("press Enter"), HasSubstr("bounce height, mm"));
  session.Type("");
  EXPECT_THAT(session.Until("predicted"), HasSubstr("next shot: approach"));
  bench_.Film("a.mraw", 24.0, 1);
  EXPECT_THAT(session.Until("predicted"), HasSubstr("bounce, approach angle"));
  ASSERT_EQ(Trials().size(), 1u);
  session.Type("exclude it hit the frame");
  session.Until("no longer counts");
  // Of another program nothing is taken away.
  ExpectMistake(Arguments({"--operator", "B"}), 4, "another session");
  session.Type("quit");
  EXPECT_EQ(session.End(0), 0);
  EXPECT_TRUE(Trials()[0].excluded);
  EXPECT_EQ(ReadSession(bench_.db())->phase, Phase::kEnded);

  // The operator is the same as last time; the end of the input is the end.
  RunningProgram again(Arguments({"--no-check"}));
  again.Until("known, trial");
  EXPECT_EQ(again.End(SIGTERM), 0);
}

TEST_F(SessionCommand, CtrlCEndsWhatItAnalyses) {
  RunningProgram session(Arguments({"--operator", "A. Lee", "--no-check"}));
  session.Until("press Enter");
  session.Type("");
  session.Until("predicted");
  testing::WriteBusyClip(bench_.films() / "busy.mraw", 400);
  while (ReadSession(bench_.db())->phase != Phase::kAnalysing) sched_yield();
  constexpr int kBySignal = 128;  // as shells count
  EXPECT_EQ(session.End(SIGINT), kBySignal + SIGINT);
  EXPECT_THAT(Trials(), IsEmpty());
  // Another may begin where it was.
  RunningProgram again(Arguments({"--no-check"}));
  EXPECT_THAT(again.Until("predicted"), HasSubstr("next shot"));
}

class SessionAtASerialPort : public SessionCommand {
 protected:
  // A session with the springs latched.
  std::unique_ptr<RunningProgram> Armed() {
    auto session = std::make_unique<RunningProgram>(
        Arguments({"--operator", "A. Lee", "--no-check", "--limit-s", "5",
                   "--driver", controller_.port()}));
    session->Type("");
    session->Until("predicted");
    session->Type("reset");  // whoever ended before has stopped it
    session->Until("ready");
    session->Type("set");
    EXPECT_THAT(session->Until("it reads"), HasSubstr("elevation"));
    session->Type("arm");
    EXPECT_THAT(session->Until("fire"), HasSubstr("ARMED"));
    EXPECT_TRUE(controller_.armed());
    return session;
  }
  // As far as `set`.
  std::unique_ptr<RunningProgram> Ready() {
    auto session = std::make_unique<RunningProgram>(
        Arguments({"--operator", "A. Lee", "--no-check", "--driver",
                   controller_.port()}));
    session->Type("");
    session->Until("predicted");
    session->Type("set");
    EXPECT_THAT(session->Until("it reads"), HasSubstr("elevation"));
    return session;
  }
  // Its end sends stop, then disarm, whatever was known before.
  void ExpectSafeEnd(RunningProgram& session) {
    const auto disarms = controller_.HowOften("disarm");
    const int stops = controller_.stop_bytes();
    controller_.StickLatch(false);
    session.Type("quit");
    EXPECT_EQ(session.End(0), 0);
    EXPECT_TRUE(controller_.Hears("disarm", disarms + 1));
    EXPECT_TRUE(controller_.BecomesStopped());
    EXPECT_TRUE(controller_.BecomesDisarmed());
    EXPECT_GT(controller_.stop_bytes(), stops);
  }

  rig::SimulatedController controller_;
};

TEST_F(SessionAtASerialPort, ThrowsWhenAPersonSaysSo) {
  const auto session = Armed();
  session->Type("fire 1");
  EXPECT_THAT(session->Until("fired"), HasSubstr("1 shots"));
  EXPECT_EQ(controller_.shots(), 1);
  session->Type("fire 1");
  EXPECT_THAT(session->Until("refused"), HasSubstr("no arming"));
  session->Type("quit");
  EXPECT_EQ(session->End(0), 0);
  EXPECT_EQ(controller_.shots(), 1);
}

TEST_F(SessionAtASerialPort, KeepsEachLineToAndFromTheController) {
  const testing::TemporaryFolder folder;
  const auto log = folder / "session.log";
  RunningProgram session(
      Arguments({"--operator", "A. Lee", "--no-check", "--driver",
                 controller_.port(), "--log", log.string()}));
  session.Type("");
  session.Until("predicted");
  session.Type("quit");
  EXPECT_EQ(session.End(0), 0);
  EXPECT_THAT(testing::ReadAll(log),
              ::testing::AllOf(HasSubstr("controller <- "),
                               HasSubstr("controller -> "), HasSubstr("hello"),
                               HasSubstr("typed: quit"), HasSubstr("said: ")));
}

TEST_F(SessionAtASerialPort, ControlCStopsTheRigAndThenTheSession) {
  const auto session = Armed();
  session->Signal(SIGINT);
  EXPECT_THAT(session->Until("STOPPED"), HasSubstr("reset"));
  EXPECT_TRUE(controller_.BecomesStopped());
  EXPECT_FALSE(controller_.armed());
  session->Type("fire 1");
  EXPECT_THAT(session->Until("refused"), HasSubstr("stopped"));
  session->Type("reset");
  session->Until("ready");
  EXPECT_FALSE(controller_.stopped());
  session->Signal(SIGINT);
  session->Until("STOPPED");
  EXPECT_TRUE(controller_.BecomesStopped());
  EXPECT_EQ(session->End(SIGINT), 0);
  EXPECT_EQ(controller_.shots(), 0);
}

TEST_F(SessionAtASerialPort, IsNeverLeftArmed) {
  {
    const auto session = Armed();
    ExpectSafeEnd(*session);
  }
  {
    const auto session = Armed();
    EXPECT_EQ(session->End(SIGTERM), 0);
    EXPECT_TRUE(controller_.BecomesStopped());
    EXPECT_FALSE(controller_.armed());
  }
}

TEST_F(SessionAtASerialPort, NoSignalLeavesItArmed) {
  for (const int signal : {SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGABRT, SIGSEGV,
                           SIGBUS, SIGFPE, SIGILL}) {
    SCOPED_TRACE(strsignal(signal));
    const auto session = Armed();
    const auto disarms = controller_.HowOften("disarm");
    const bool is_fault = signal == SIGABRT || signal == SIGSEGV ||
                          signal == SIGBUS || signal == SIGFPE ||
                          signal == SIGILL;
    EXPECT_EQ(session->End(signal), is_fault ? -1 : 0);
    EXPECT_TRUE(controller_.BecomesStopped());
    EXPECT_TRUE(controller_.Hears("disarm", disarms + 1));
    EXPECT_FALSE(controller_.armed());
  }
}

// What no handler survives: the controller's own watch.
TEST_F(SessionAtASerialPort, AKilledProgramIsNoticedByItsSilence) {
  controller_.Watch();
  const auto session = Armed();
  const auto killed = std::chrono::steady_clock::now();
  EXPECT_EQ(session->End(SIGKILL), -1);
  EXPECT_TRUE(controller_.BecomesDisarmed());
  EXPECT_LE(std::chrono::steady_clock::now() - killed, rig::kLongestSilence);
  EXPECT_EQ(controller_.silences(), 1);
}

// The four situations in which springs were latched and nobody was told.
TEST_F(SessionAtASerialPort, SaysNotArmedOnlyWhereTheControllerDoes) {
  {
    SCOPED_TRACE("the answer to arm is lost");
    const auto session = Ready();
    controller_.Script("arm", std::deque<rig::Act>(3, rig::Act::kSilence));
    controller_.StickLatch();
    session->Type("arm");
    session->Until("no answer to 'arm'");
    session->Type("rig");
    EXPECT_THAT(session->Until("interlock"), HasSubstr(", ARMED, STOPPED"));
    ExpectSafeEnd(*session);
  }
  controller_.Unstop();
  {
    SCOPED_TRACE("an empty token");
    const auto session = Ready();
    controller_.Script("arm", {rig::Act::kEmpty});
    controller_.StickLatch();
    session->Type("arm");
    session->Until("without a token");
    session->Type("rig");
    EXPECT_THAT(session->Until("interlock"), HasSubstr(", ARMED, STOPPED"));
    ExpectSafeEnd(*session);
  }
  controller_.Unstop();
  {
    SCOPED_TRACE("fire is refused");
    const auto session = Ready();
    session->Type("arm");
    session->Until("fire 1");
    controller_.Script("fire", {rig::Act::kRefusal});
    controller_.StickLatch();
    session->Type("fire 1");
    session->Until("refused");
    session->Type("rig");
    EXPECT_THAT(session->Until("interlock"), HasSubstr(", ARMED, STOPPED"));
    ExpectSafeEnd(*session);
  }
  controller_.Unstop();
  {
    SCOPED_TRACE("armed already when connected");
    controller_.LatchByHand();
    controller_.StickLatch();
    RunningProgram session(Arguments({"--operator", "A. Lee", "--no-check",
                                      "--driver", controller_.port()}));
    EXPECT_THAT(session.Until("rig: ARMED"), HasSubstr("was ARMED"));
    ExpectSafeEnd(session);
  }
}

// Whatever is being analysed. The limit is the issue's; what is waited for is
// the controller.
TEST_F(SessionAtASerialPort, TypedStopActsWhileARecordingIsAnalysed) {
  const auto session = Armed();
  testing::WriteBusyClip(bench_.films() / "busy.mraw", 400);
  while (ReadSession(bench_.db())->phase != Phase::kAnalysing) sched_yield();
  const auto typed = std::chrono::steady_clock::now();
  session->Type("stop");
  EXPECT_TRUE(controller_.BecomesStopped());
  EXPECT_LE(std::chrono::steady_clock::now() - typed,
            std::chrono::milliseconds(100));
  EXPECT_EQ(ReadSession(bench_.db())->phase, Phase::kAnalysing);
  EXPECT_FALSE(controller_.armed());
}

// What was typed before a stop, and waits, is not done after it.
TEST_F(SessionAtASerialPort, AStopDropsWhatWaits) {
  const auto session = Armed();
  testing::WriteBusyClip(bench_.films() / "busy.mraw", 400);
  while (ReadSession(bench_.db())->phase != Phase::kAnalysing) sched_yield();
  const auto resets = controller_.HowOften("reset");
  session->Type("reset");
  session->Type("set");
  session->Type("stop");
  EXPECT_TRUE(controller_.BecomesStopped());
  EXPECT_EQ(ReadSession(bench_.db())->phase, Phase::kAnalysing);
  session->Until("STOPPED; `reset`");
  session->Type("rig");
  EXPECT_THAT(session->Until("interlock"), HasSubstr("STOPPED"));
  EXPECT_EQ(controller_.HowOften("reset"), resets);
  EXPECT_TRUE(controller_.stopped());
}

TEST_F(SessionAtASerialPort, PastedLinesNeverFire) {
  const auto session = Ready();
  session->Type("arm\nfire 1");
  EXPECT_THAT(session->Until("refused"),
              HasSubstr("together with other lines"));
  session->Type("fire 1\nrig");
  EXPECT_THAT(session->Until("refused"),
              HasSubstr("together with other lines"));
  session->Until("interlock");
  EXPECT_EQ(controller_.HowOften("fire"), 0);
  for (const char* mistake : {"fire 1.9", "fire 1 2", "fire -1", "fire 0",
                              "fire 1e0", "fire +1", "fire 0x1", "fire"}) {
    session->Type(mistake);
    session->Until("fire wants the number");
  }
  EXPECT_EQ(controller_.HowOften("fire"), 0);
  session->Type("fire 1");
  EXPECT_THAT(session->Until("fired"), HasSubstr("1 shots"));
}

TEST_F(SessionAtASerialPort, AFaultOfTheStoreDisarmsIt) {
  const auto session = Armed();
  auto changed = Bench::campaign();
  changed.bounce_height_m = 0.001;
  db::Store::Open(bench_.db(), db::OpenMode::kWrite).ChangeCampaign(changed);
  bench_.Film("a.mraw", 24.0, 1);
  EXPECT_EQ(session->End(0), 4);
  EXPECT_FALSE(controller_.armed());
  EXPECT_TRUE(Trials().empty());
}

TEST_F(SessionAtASerialPort, WhoNoLongerAnswersIsStopped) {
  const auto session = Armed();
  controller_.Script("disarm", {rig::Act::kDeafness, rig::Act::kDeafness,
                                rig::Act::kDeafness, rig::Act::kDeafness});
  session->Type("quit");
  EXPECT_EQ(session->End(0), 0);
  EXPECT_TRUE(controller_.BecomesStopped());
  EXPECT_FALSE(controller_.armed());
}

TEST_F(SessionAtASerialPort, WhatRefusesToDisarmIsStopped) {
  const auto session = Armed();
  controller_.Script("disarm", {rig::Act::kRefusal});
  session->Type("quit");
  EXPECT_EQ(session->End(0), 0);
  EXPECT_TRUE(controller_.BecomesStopped());
  EXPECT_FALSE(controller_.armed());
}

TEST_F(SessionCommand, MistakesAreOneLine) {
  ExpectMistake(Arguments(), 2, "--operator is missing");
  auto arguments = Arguments({"--operator", "A"});
  arguments[11] = "0";
  ExpectMistake(arguments, 2, "--quiet-s is 0");
  ExpectMistake(Arguments({"--operator", "A", "--check-height-mm", "0"}), 2,
                "height");
  ExpectMistake(Arguments({"--operator", "A", "--driver", "/dev/null"}), 3,
                "no serial port");
  arguments = Arguments({"--operator", "A"});
  arguments[5] = "concrete";
  ExpectMistake(arguments, 4, "there is no campaign 'concrete'");
  arguments = Arguments({"--operator", "A"});
  arguments[9] = bench_.rig().string();
  ExpectMistake(arguments, 3, "there is no such folder");
}

TEST_F(SessionCommand, SurvivesAKillAtAnyInstant) {
  const int rounds = std::getenv("TOUCHDOWN_LONG_TESTS") != nullptr ? 50 : 6;
  std::mt19937_64 engine(20261121);
  const testing::TemporaryFolder made;
  std::set<std::string> reported;
  const auto note = [&](const std::string& lines) {
    for (std::size_t at = lines.find("\ntrial "); at != std::string::npos;
         at = lines.find("\ntrial ", at + 1)) {
      reported.insert(lines.substr(at + 7, 8));
    }
  };
  const auto start = [&] {
    return Arguments({"--operator", "A. Lee", "--no-check"});
  };
  for (int round = 0; round < rounds; ++round) {
    SCOPED_TRACE(round);
    const std::string name = "film" + std::to_string(round);
    pipeline::filmed::WriteSphere(made / (name + ".mraw"), 24.0,
                                  static_cast<std::uint64_t>(round + 1));
    RunningProgram session(start());
    session.Type("");
    const auto wait = engine() % 4;
    std::string lines = "\n";
    if (wait == 1) lines += session.Line();
    if (wait >= 2) lines += session.Until("next shot");
    for (const char* extension : {".cihx", ".mraw"}) {
      std::filesystem::rename(made / (name + extension),
                              bench_.films() / (name + extension));
    }
    if (wait == 3) lines += session.Until(name + ".mraw");
    // Up to about one analysis later.
    const timespec pause{0, static_cast<long>(engine() % 300'000'000)};
    nanosleep(&pause, nullptr);
    EXPECT_EQ(session.End(SIGKILL), -1);
    lines += session.Until("what is never said");
    note(lines);
    const auto store = db::Store::Open(bench_.db(), db::OpenMode::kWrite);
    EXPECT_THAT(db::Check(store).problems, IsEmpty());
    std::set<std::string> ids;
    std::set<std::string> clips;
    for (const auto& trial : store.Trials()) {
      ids.insert(trial.id.substr(0, 8));
      EXPECT_TRUE(clips.insert(trial.clip.id).second) << "logged twice";
    }
    for (const auto& id : reported) EXPECT_TRUE(ids.contains(id)) << id;
    if (HasFailure()) return;
  }
  // What was recorded while nobody was there is taken now; each is named once.
  RunningProgram last(start());
  last.Type("");
  for (int i = 0; i < rounds; ++i) last.Until(".mraw");
  last.Type("quit");
  EXPECT_EQ(last.End(0), 0);
  const auto trials = Trials();
  EXPECT_EQ(trials.size(), static_cast<std::size_t>(rounds));
  std::set<std::string> paths;
  for (const auto& trial : trials) {
    EXPECT_FALSE(trial.excluded);
    EXPECT_EQ(trial.revision, 1);
    paths.insert(trial.clip.path);
  }
  EXPECT_EQ(paths.size(), trials.size());
}

}  // namespace
}  // namespace touchdown::session
