// The sketch for a microcontroller, compiled for this machine and spoken to
// through the program's own line protocol. Its clock is the test's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <map>
#include <string>

#include "touchdown/rig/driver/line_protocol.h"

namespace touchdown::rig {
namespace {

// What the sketch takes from the Arduino core.
namespace sketch {

constexpr int LOW = 0;
constexpr int HIGH = 1;
constexpr int OUTPUT = 1;
constexpr int INPUT_PULLUP = 2;

std::map<int, int> pins;
unsigned long now_ms = 0;

void pinMode(int pin, int mode) {
  if (mode == INPUT_PULLUP) pins.try_emplace(pin, HIGH);
}
void digitalWrite(int pin, int level) { pins[pin] = level; }
int digitalRead(int pin) { return pins[pin]; }
unsigned long millis() { return now_ms; }
void delay(unsigned long ms) { now_ms += ms; }

struct {
  std::string in;
  std::string out;
  void begin(long) {}
  int available() const { return static_cast<int>(in.size()); }
  int read() {
    const int c = static_cast<unsigned char>(in.front());
    in.erase(0, 1);
    return c;
  }
  void print(char c) { out += c; }
  void print(const char* text) { out += text; }
} Serial;

#include "rig/controller/touchdown_rig.ino"

}  // namespace sketch

class Sketch : public ::testing::Test {
 protected:
  Sketch() {
    sketch::setup();
    sketch::pins[sketch::kInterlockPin] = sketch::LOW;  // closed
    sketch::pins[sketch::kButtonPin] = sketch::HIGH;    // not pressed
    Ask("disarm");
    Ask("reset");
  }
  std::string Exchange(const std::string& bytes) {
    sketch::Serial.out.clear();
    sketch::Serial.in += bytes;
    sketch::loop();
    return sketch::Serial.out;
  }
  Answer Ask(const std::string& verb, const std::string& argument = "") {
    const std::string said =
        Exchange(FormatLine(Request{++number_, verb, argument}));
    const auto answer =
        ParseAnswer(said.size() < 2 ? "" : said.substr(1, said.size() - 2));
    EXPECT_TRUE(answer) << said;
    if (!answer) return {};
    EXPECT_EQ(answer->number, number_);
    EXPECT_EQ(answer->verb, verb);
    return *answer;
  }
  static bool IsLatched() {
    return sketch::pins[sketch::kLatchPin] == sketch::HIGH;
  }
  static void Pass(unsigned long ms) {
    sketch::now_ms += ms;
    sketch::loop();
  }

  static std::uint32_t number_;
};
std::uint32_t Sketch::number_ = 100;

TEST_F(Sketch, SpeaksTheProtocol) {
  EXPECT_EQ(Ask("hello").text, "touchdown-rig/2 sketch");
  EXPECT_EQ(Ask("angle", "-12500").text, "-12500");
  EXPECT_EQ(Ask("compress", "30250").text, "30250");
  EXPECT_EQ(Ask("interlock").text, "closed");
  const std::string status = Ask("status").text;
  EXPECT_EQ(ReadField(status, "angle"), -12500);
  EXPECT_EQ(ReadField(status, "compress"), 30250);
  EXPECT_EQ(ReadField(status, "armed"), 0);
  const auto before = *ReadField(status, "shots");
  const std::string token = Ask("arm").text;
  EXPECT_TRUE(IsLatched());
  EXPECT_EQ(ReadField(Ask("status").text, "armed"), 1);
  EXPECT_FALSE(Ask("fire", "T0").ok);
  EXPECT_TRUE(IsLatched());
  EXPECT_EQ(ReadField(Ask("fire", token).text, "shots"), before + 1);
  EXPECT_FALSE(IsLatched());
  EXPECT_FALSE(Ask("fire", token).ok);
  EXPECT_FALSE(Ask("dance").ok);
}

TEST_F(Sketch, DisarmsWithinTwoSecondsOfSilence) {
  ASSERT_TRUE(Ask("arm").ok);
  for (int i = 0; i < 10; ++i) {
    Pass(1000);
    ASSERT_TRUE(IsLatched());
    Ask("status");
  }
  Pass(1700);
  EXPECT_TRUE(IsLatched());
  Pass(static_cast<unsigned long>(kLongestSilence.count()) - 1700);
  EXPECT_FALSE(IsLatched());
  EXPECT_EQ(ReadField(Ask("status").text, "compress"), 0);
  // Noise, and damaged lines, are no sign of life.
  ASSERT_TRUE(Ask("arm").ok);
  for (int i = 0; i < 20; ++i) {
    Exchange("\n7 status*0000\nxyz\n");
    Pass(100);
  }
  EXPECT_FALSE(IsLatched());
}

TEST_F(Sketch, DisarmsAfterAMinuteWhateverIsSaid) {
  ASSERT_TRUE(Ask("arm").ok);
  for (int i = 0; i < 61; ++i) {
    Pass(1000);
    Ask("status");
  }
  EXPECT_FALSE(IsLatched());
}

TEST_F(Sketch, StopsInTheMiddleOfALine) {
  ASSERT_TRUE(Ask("arm").ok);
  Exchange("\n7 sta" + std::string(1, kStopByte));
  EXPECT_FALSE(IsLatched());
  EXPECT_FALSE(Ask("arm").ok);
  EXPECT_TRUE(Ask("disarm").ok);
  EXPECT_EQ(ReadField(Ask("status").text, "stopped"), 1);
  EXPECT_TRUE(Ask("reset").ok);
  EXPECT_TRUE(Ask("arm").ok);
  // The farewell of a program that ends.
  Exchange(std::string(3, kStopByte) +
           FormatLine(Request{kAlwaysNew, "disarm", ""}));
  EXPECT_FALSE(IsLatched());
  EXPECT_FALSE(Ask("arm").ok);
}

TEST_F(Sketch, TheGuardAndTheButtonDisarm) {
  ASSERT_TRUE(Ask("arm").ok);
  sketch::pins[sketch::kInterlockPin] = sketch::HIGH;
  Pass(1);
  EXPECT_FALSE(IsLatched());
  EXPECT_FALSE(Ask("arm").ok);
  sketch::pins[sketch::kInterlockPin] = sketch::LOW;
  ASSERT_TRUE(Ask("arm").ok);
  sketch::pins[sketch::kButtonPin] = sketch::LOW;
  Pass(1);
  EXPECT_FALSE(IsLatched());
  EXPECT_FALSE(Ask("reset").ok);
  sketch::pins[sketch::kButtonPin] = sketch::HIGH;
  EXPECT_TRUE(Ask("reset").ok);
}

TEST_F(Sketch, WhatComesTwiceIsDoneOnce) {
  const std::string arm = FormatLine(Request{++number_, "arm", ""});
  const std::string first = Exchange(arm);
  EXPECT_EQ(Exchange(arm), first);  // the same token
  Ask("disarm");
  EXPECT_FALSE(IsLatched());
  const std::string always = FormatLine(Request{kAlwaysNew, "disarm", ""});
  Exchange(always);
  ASSERT_TRUE(Ask("arm").ok);
  Exchange(always);
  EXPECT_FALSE(IsLatched());
  // Longer than a line may be.
  EXPECT_EQ(Exchange("\n" + std::string(1000, '9') + "\n"), "");
}

}  // namespace
}  // namespace touchdown::rig
