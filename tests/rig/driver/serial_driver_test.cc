// End to end over a pseudo-terminal, with a controller that also misbehaves.
// No clock is waited for: the driver's runs where the controller is silent.
#include "touchdown/rig/driver/serial_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include <csignal>
#include <cstring>
#include <stdexcept>

#include "tests/rig/driver/simulated_controller.h"
#include "touchdown/core/errors.h"

namespace touchdown::rig {
namespace {

using core::InputError;
using core::literals::operator""_deg;
using core::literals::operator""_mm;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

constexpr Setting kWanted{30.25_mm, -12.5_deg, 300.0_mm};

class SerialDriverTest : public ::testing::Test {
 protected:
  std::uint64_t Armed() {
    const auto read = driver_.Set(kWanted);
    EXPECT_TRUE(read) << read.error().reason;
    const auto arming = driver_.Arm();
    EXPECT_TRUE(arming) << arming.error().reason;
    return arming ? arming->number : 0;
  }
  std::string WhyNot(std::uint64_t arming) {
    const auto shots = driver_.Fire({"A. Lee", arming});
    return shots ? "fired" : shots.error().reason;
  }

  SimulatedController controller_;
  SerialDriver driver_{controller_.port(), {}, controller_.Time()};
};

TEST_F(SerialDriverTest, SetsArmsAndFires) {
  EXPECT_EQ(driver_.name(), "simulated");
  controller_.Moves(3);
  const auto read = driver_.Set(kWanted);
  ASSERT_TRUE(read) << read.error().reason;
  EXPECT_NEAR(read->elevation_rad, -12.5_deg, 1e-9);
  EXPECT_NEAR(read->compression_m, 30.25_mm, 1e-9);
  EXPECT_EQ(read->muzzle_height_m, 300.0_mm);
  const auto arming = driver_.Arm();
  ASSERT_TRUE(arming) << arming.error().reason;
  EXPECT_TRUE(controller_.armed());
  EXPECT_EQ(controller_.shots(), 0);
  const auto shots = driver_.Fire({"A. Lee", arming->number});
  ASSERT_TRUE(shots) << shots.error().reason;
  EXPECT_EQ(*shots, 1);
  EXPECT_EQ(controller_.shots(), 1);
  EXPECT_THAT(controller_.heard(),
              ElementsAre("hello", "status", "angle", "compress", "status",
                          "status", "status", "status", "interlock", "status",
                          "arm", "status", "interlock", "fire", "status"));
  const DriverStatus status = driver_.Status();
  EXPECT_EQ(status.interlock, Interlock::kClosed);
  EXPECT_EQ(status.shots, 1);
  EXPECT_EQ(status.armed, ArmedState::kNo);
}

TEST_F(SerialDriverTest, NeverFiresWithoutAPersonsWordForThisArming) {
  EXPECT_THAT(WhyNot(1), HasSubstr("no arming"));
  EXPECT_THAT(driver_.Arm().error().reason, HasSubstr("nothing is set"));
  const auto first = Armed();
  EXPECT_THROW(driver_.Fire({"", first}), std::invalid_argument);
  EXPECT_THAT(WhyNot(first + 1), HasSubstr("is confirmed, but"));
  const auto second = Armed();
  EXPECT_THAT(WhyNot(first), HasSubstr("is confirmed, but"));
  EXPECT_EQ(WhyNot(second), "fired");
  EXPECT_THAT(WhyNot(second), HasSubstr("no arming"));
  EXPECT_EQ(controller_.HowOften("fire"), 1);
}

// The four ways to springs that are latched though nobody was told so.
TEST_F(SerialDriverTest, ALostAnswerToArmLeavesNothingLatched) {
  ASSERT_TRUE(driver_.Set(kWanted));
  controller_.Script("arm", {Act::kSilence, Act::kSilence, Act::kSilence});
  EXPECT_THROW(driver_.Arm(), InputError);
  EXPECT_FALSE(controller_.armed());
  EXPECT_EQ(controller_.HowOften("disarm"), 1);
  EXPECT_EQ(driver_.Armed(), ArmedState::kNo);
}

TEST_F(SerialDriverTest, AnEmptyTokenLeavesNothingLatched) {
  ASSERT_TRUE(driver_.Set(kWanted));
  controller_.Script("arm", {Act::kEmpty});
  EXPECT_THAT([&] { driver_.Arm(); },
              ThrowsMessage<InputError>(HasSubstr("without a token")));
  EXPECT_FALSE(controller_.armed());
  EXPECT_EQ(controller_.HowOften("disarm"), 1);
  EXPECT_EQ(driver_.Armed(), ArmedState::kNo);
}

TEST_F(SerialDriverTest, ARefusedShotLeavesNothingLatched) {
  const auto arming = Armed();
  EXPECT_EQ(driver_.Armed(), ArmedState::kYes);
  controller_.Script("fire", {Act::kRefusal});
  // It fires all the same, or not: what counts is what it says afterwards.
  EXPECT_THAT(WhyNot(arming), HasSubstr("worn"));
  EXPECT_EQ(driver_.Armed(), ArmedState::kNo);
  EXPECT_FALSE(controller_.armed());
}

TEST(SerialDriver, OneThatIsFoundArmedIsDisarmed) {
  SimulatedController controller;
  controller.LatchByHand();
  {
    SerialDriver driver(controller.port(), {}, controller.Time());
    EXPECT_TRUE(driver.was_found_armed());
    EXPECT_EQ(driver.Armed(), ArmedState::kNo);
    EXPECT_FALSE(controller.armed());
  }
  // Latched by hand at any time later it is shown, and disarmed at the end.
  EXPECT_TRUE(controller.BecomesStopped());
}

TEST(SerialDriver, ALatchThatSticksIsShownAndStopped) {
  SimulatedController controller;
  SerialDriver driver(controller.port(), {}, controller.Time());
  EXPECT_FALSE(driver.was_found_armed());
  ASSERT_TRUE(driver.Set(kWanted));
  ASSERT_TRUE(driver.Arm());
  controller.StickLatch();
  driver.Disarm();
  EXPECT_EQ(driver.Armed(), ArmedState::kYes);
  EXPECT_TRUE(driver.is_stopped());
  EXPECT_FALSE(driver.Reset("A. Lee"));
  EXPECT_TRUE(driver.is_stopped());
}

TEST_F(SerialDriverTest, WhatWasHeardTooLongAgoIsUnknown) {
  Armed();
  EXPECT_EQ(driver_.Armed(), ArmedState::kYes);
  // Each silence is 500 ms of the driver's clock.
  controller_.Script("status", {Act::kDeafness, Act::kDeafness});
  driver_.Refresh();
  EXPECT_EQ(driver_.Armed(), ArmedState::kYes);
  driver_.Refresh();
  EXPECT_EQ(driver_.Armed(), ArmedState::kUnknown);
  EXPECT_EQ(Name(driver_.Armed()), "UNKNOWN, take it as ARMED");
  driver_.Refresh();
  EXPECT_EQ(driver_.Armed(), ArmedState::kYes);
}

// An old answer that comes again is none: each question has its number.
TEST_F(SerialDriverTest, ALateAnswerIsNoNews) {
  driver_.Refresh();
  EXPECT_EQ(driver_.Armed(), ArmedState::kNo);
  controller_.Script("status", {Act::kLate, Act::kDeafness});
  driver_.Refresh();
  controller_.LatchByHand();
  driver_.Refresh();  // hears the late "armed=0" before the silence
  EXPECT_EQ(driver_.Armed(), ArmedState::kUnknown);
}

TEST_F(SerialDriverTest, OneThatIsStoppedByItsButtonWantsAReset) {
  controller_.PressButton();
  driver_.Refresh();
  EXPECT_TRUE(driver_.is_stopped());
  EXPECT_THAT(driver_.Set(kWanted).error().reason, HasSubstr("was stopped"));
  ASSERT_TRUE(driver_.Reset("A. Lee"));
  EXPECT_EQ(WhyNot(Armed()), "fired");
}

TEST(SerialDriver, ItsEndStopsAndDisarms) {
  SimulatedController controller;
  {
    SerialDriver driver(controller.port(), {}, controller.Time());
    ASSERT_TRUE(driver.Set(kWanted));
    ASSERT_TRUE(driver.Arm());
    EXPECT_TRUE(controller.armed());
  }
  EXPECT_TRUE(controller.BecomesStopped());
  EXPECT_FALSE(controller.armed());
  EXPECT_GE(controller.HowOften("disarm"), 1);
  EXPECT_GE(controller.stop_bytes(), 1);
}

TEST_F(SerialDriverTest, SettingDisarms) {
  const auto arming = Armed();
  ASSERT_TRUE(driver_.Set(kWanted));
  EXPECT_FALSE(controller_.armed());
  EXPECT_THAT(WhyNot(arming), HasSubstr("no arming"));
  EXPECT_EQ(controller_.HowOften("fire"), 0);
}

TEST_F(SerialDriverTest, AnOpenInterlockNeitherArmsNorFires) {
  ASSERT_TRUE(driver_.Set(kWanted));
  controller_.OpenInterlock();
  EXPECT_THAT(driver_.Arm().error().reason, HasSubstr("interlock is open"));
  EXPECT_EQ(controller_.HowOften("arm"), 0);

  controller_.OpenInterlock(false);
  const auto arming = Armed();
  controller_.OpenInterlock();  // between arming and firing
  EXPECT_THAT(WhyNot(arming), HasSubstr("interlock is open"));
  EXPECT_EQ(controller_.HowOften("fire"), 0);
  // It had disarmed by itself, and said so.
  EXPECT_EQ(driver_.Armed(), ArmedState::kNo);
  EXPECT_FALSE(driver_.is_stopped());
  controller_.OpenInterlock(false);
  EXPECT_THAT(WhyNot(arming), HasSubstr("no arming"));
}

TEST_F(SerialDriverTest, AnInterlockThatOpensAtTheLastMomentIsTheControllers) {
  const auto arming = Armed();
  controller_.When("fire", [this] { controller_.OpenInterlock(); });
  EXPECT_THAT(WhyNot(arming), HasSubstr("refuses 'fire': interlock open"));
  EXPECT_EQ(controller_.shots(), 0);
}

TEST_F(SerialDriverTest, WhateverTheInterlockSaysButClosedIsOpen) {
  const auto arming = Armed();
  controller_.Script("interlock", {Act::kWrongEcho});
  EXPECT_THAT(WhyNot(arming), HasSubstr("interlock is open"));
  const auto again = Armed();
  controller_.Script("interlock", {Act::kRefusal});
  EXPECT_THAT(WhyNot(again), HasSubstr("worn"));
  EXPECT_EQ(controller_.HowOften("fire"), 0);
}

// Each kind of trouble, twice in a row, for each command that may be repeated.
TEST_F(SerialDriverTest, TroubleOnTheLineIsGotOver) {
  for (const Act act : {Act::kSilence, Act::kDeafness, Act::kGarbage,
                        Act::kHalf, Act::kDamaged, Act::kLate}) {
    SCOPED_TRACE(static_cast<int>(act));
    for (const char* verb : {"angle", "compress", "status", "interlock", "arm"})
      controller_.Script(verb, {act, act});
    const auto arming = Armed();
    EXPECT_EQ(WhyNot(arming), "fired");
  }
  EXPECT_EQ(controller_.shots(), 6);
  EXPECT_EQ(controller_.HowOften("fire"), 6);
}

TEST_F(SerialDriverTest, TriesHaveABound) {
  controller_.Script("angle", {Act::kDeafness, Act::kDeafness, Act::kDeafness});
  EXPECT_THAT([&] { driver_.Set(kWanted); },
              ThrowsMessage<InputError>(
                  AllOf(StartsWith(controller_.port() + ": no answer"),
                        HasSubstr("3 tries of 500 ms"))));
  EXPECT_EQ(controller_.HowOften("angle"), 3);
}

TEST_F(SerialDriverTest, AWrongEchoIsAskedAgainThenGivenUp) {
  controller_.Script("compress", {Act::kWrongEcho});
  EXPECT_TRUE(driver_.Set(kWanted));
  controller_.Script("angle",
                     {Act::kWrongEcho, Act::kWrongEcho, Act::kWrongEcho});
  EXPECT_THAT([&] { driver_.Set(kWanted); },
              ThrowsMessage<InputError>(HasSubstr("'99999' understood")));
  EXPECT_FALSE(driver_.Arm());
}

TEST_F(SerialDriverTest, AMovementThatSticksOrNeverEndsIsAReason) {
  controller_.Moves(0, 9000);
  EXPECT_THAT(driver_.Set(kWanted).error().reason,
              HasSubstr("it stopped at 9.00 deg"));
  controller_.Moves(1'000'000);
  EXPECT_THAT(driver_.Set(kWanted).error().reason,
              HasSubstr("still moves after 30 s"));
}

TEST_F(SerialDriverTest, ALostAnswerToFireIsNeverFiredAgain) {
  // It fired; only the answer was lost, or late.
  for (const Act act : {Act::kSilence, Act::kLate, Act::kDamaged}) {
    const auto arming = Armed();
    controller_.Script("fire", {act});
    const auto before = controller_.HowOften("fire");
    EXPECT_EQ(WhyNot(arming), "fired");
    EXPECT_EQ(controller_.HowOften("fire"), before + 1);
  }
  EXPECT_EQ(controller_.shots(), 3);
  // It did not: the rig is stopped, whatever it does later.
  const auto arming = Armed();
  controller_.Script("fire", {Act::kDeafness});
  EXPECT_THAT(WhyNot(arming), HasSubstr("no shot counted: stopped"));
  EXPECT_EQ(controller_.HowOften("fire"), 4);
  EXPECT_TRUE(driver_.Status().stopped);
  EXPECT_THAT(driver_.Set(kWanted).error().reason, HasSubstr("was stopped"));
  ASSERT_TRUE(driver_.Reset("A. Lee"));
  EXPECT_GE(controller_.stop_bytes(), 1);
  EXPECT_EQ(WhyNot(Armed()), "fired");
}

TEST_F(SerialDriverTest, SilenceAfterFireStopsAndSaysSo) {
  const auto arming = Armed();
  controller_.Script("fire", {Act::kDeafness});
  controller_.Script("status",
                     {Act::kDeafness, Act::kDeafness, Act::kDeafness});
  EXPECT_THROW(driver_.Fire({"A. Lee", arming}), InputError);
  EXPECT_TRUE(driver_.Status().stopped);
}

TEST_F(SerialDriverTest, AnUnpluggedControllerIsOneLine) {
  controller_.Script("compress", {Act::kHangUp});
  EXPECT_THAT(
      [&] { driver_.Set(kWanted); },
      ThrowsMessage<InputError>(AllOf(StartsWith(controller_.port()),
                                      HasSubstr("controller is gone"))));
  driver_.Stop();  // there is nobody left, and nothing falls over
  EXPECT_TRUE(driver_.Status().stopped);
}

TEST_F(SerialDriverTest, StopEndsACommandThatWaits) {
  controller_.When("angle", [this] { driver_.Stop(); });
  controller_.Script("angle", {Act::kDeafness});
  EXPECT_THAT(driver_.Set(kWanted).error().reason, HasSubstr("stopped"));
  EXPECT_EQ(controller_.HowOften("angle"), 1);
  controller_.When("angle", {});
  // Reset hears the answer only after the bytes before it.
  ASSERT_TRUE(driver_.Reset("A. Lee"));
  EXPECT_GE(controller_.stop_bytes(), 1);
  EXPECT_EQ(WhyNot(Armed()), "fired");
}

// Between the look at the interlock and the shot: the stop byte overtakes.
TEST_F(SerialDriverTest, StopBetweenInterlockAndShotWins) {
  const auto arming = Armed();
  controller_.When("interlock", [this] { driver_.Stop(); });
  EXPECT_THAT(WhyNot(arming), HasSubstr("stopped"));
  EXPECT_EQ(controller_.shots(), 0);
  EXPECT_EQ(controller_.HowOften("fire"), 0);
}

Driver* stopped_by_signal = nullptr;

TEST_F(SerialDriverTest, StopWorksFromASignal) {
  stopped_by_signal = &driver_;
  struct sigaction action = {};
  struct sigaction before = {};
  action.sa_handler = [](int) { stopped_by_signal->Stop(); };
  sigaction(SIGUSR1, &action, &before);
  const pthread_t self = pthread_self();
  controller_.Moves(1'000'000);
  int looks = 0;
  controller_.When("status", [&] {
    if (++looks == 5) pthread_kill(self, SIGUSR1);
  });
  EXPECT_THAT(driver_.Set(kWanted).error().reason, HasSubstr("stopped"));
  sigaction(SIGUSR1, &before, nullptr);
  controller_.Moves(0);
  ASSERT_TRUE(driver_.Reset("A. Lee"));
  EXPECT_GE(controller_.stop_bytes(), 1);
}

// A controller that reads nothing, and a line that is full to the brim.
TEST_F(SerialDriverTest, StopGetsThroughAFullLine) {
  controller_.StopListening();
  const int second =
      open(controller_.port().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_GE(second, 0);
  const std::string bytes(4096, 'x');
  while (write(second, bytes.data(), bytes.size()) > 0) {
  }
  ASSERT_EQ(errno, EAGAIN);
  driver_.Stop();
  close(second);
  // Everything the controller will ever read: the byte is in it.
  bool heard = false;
  std::array<char, 4096> read_bytes{};
  pollfd end{controller_.master(), POLLIN, 0};
  while (!heard && poll(&end, 1, 5000) == 1) {
    const ssize_t n =
        read(controller_.master(), read_bytes.data(), read_bytes.size());
    ASSERT_GT(n, 0);
    heard = std::memchr(read_bytes.data(), kStopByte,
                        static_cast<std::size_t>(n)) != nullptr;
  }
  EXPECT_TRUE(heard);
}

TEST_F(SerialDriverTest, ThePortBelongsToOneProgram) {
  EXPECT_THAT(
      [&] { SerialDriver second(controller_.port(), {}, controller_.Time()); },
      ThrowsMessage<InputError>(HasSubstr("another program uses this port")));
}

TEST(SerialPort, MistakesAreNamed) {
  EXPECT_THAT([] { SerialDriver driver("/nowhere/ttyUSB0"); },
              ThrowsMessage<InputError>(
                  StartsWith("/nowhere/ttyUSB0: cannot be opened")));
  EXPECT_THAT([] { SerialDriver driver("/dev/null"); },
              ThrowsMessage<InputError>(HasSubstr("no serial port")));
  SerialOptions options;
  options.baud = 300;
  EXPECT_THAT([&] { SerialDriver driver("/dev/null", options); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("baud is 300")));
  SimulatedController controller;
  controller.Script("hello", {Act::kWrongEcho});
  EXPECT_THAT(
      [&] { SerialDriver driver(controller.port(), {}, controller.Time()); },
      ThrowsMessage<InputError>(HasSubstr("says '99999'")));
}

}  // namespace
}  // namespace touchdown::rig
