#include "touchdown/rig/driver/line_protocol.h"

#include <gtest/gtest.h>

#include <random>

namespace touchdown::rig {
namespace {

// The check value of CRC-16/CCITT-FALSE (IBM-3740) in the catalogue of
// parametrised CRC algorithms.
TEST(LineProtocol, ChecksumOfTheCatalogue) {
  EXPECT_EQ(Crc16("123456789"), 0x29B1);
  EXPECT_EQ(Crc16(""), 0xFFFF);
}

std::string WithoutLineFeeds(const std::string& line) {
  EXPECT_EQ(line.front(), '\n');
  EXPECT_EQ(line.back(), '\n');
  return line.substr(1, line.size() - 2);
}

TEST(LineProtocol, LinesComeBack) {
  EXPECT_EQ(FormatLine(Request{7, "angle", "12500"}).substr(0, 15),
            "\n7 angle 12500*");
  for (const Request& request :
       {Request{7, "angle", "12500"}, Request{4294967295u, "arm", ""},
        Request{0, "fire", "T1 x"}}) {
    const std::string line = FormatLine(request);
    const auto back = ParseRequest(WithoutLineFeeds(line));
    ASSERT_TRUE(back) << line;
    EXPECT_EQ(back->number, request.number);
    EXPECT_EQ(back->verb, request.verb);
    EXPECT_EQ(back->argument, request.argument);
  }
  for (const bool ok : {true, false}) {
    const std::string line = FormatLine(Answer{7, ok, "angle", "out of range"});
    const auto back = ParseAnswer(WithoutLineFeeds(line));
    ASSERT_TRUE(back) << line;
    EXPECT_EQ(back->ok, ok);
    EXPECT_EQ(back->verb, "angle");
    EXPECT_EQ(back->text, "out of range");
  }
}

// A CRC of 16 bits sees every error of one or two bits in a line so short.
TEST(LineProtocol, DamagedLinesAreNoLines) {
  const std::string line =
      WithoutLineFeeds(FormatLine(Answer{7, true, "angle", "12500"}));
  for (std::size_t i = 0; i < line.size() * 8; ++i) {
    for (std::size_t j = i; j < line.size() * 8; ++j) {
      std::string bad = line;
      bad[i / 8] = static_cast<char>(bad[i / 8] ^ (1 << i % 8));
      if (j != i) bad[j / 8] = static_cast<char>(bad[j / 8] ^ (1 << j % 8));
      // Small letters are hexadecimal digits too: the same checksum.
      const auto answer = ParseAnswer(bad);
      EXPECT_TRUE(!answer || answer->text == "12500") << bad;
    }
  }
  for (std::size_t n = 0; n < line.size(); ++n) {
    EXPECT_FALSE(ParseAnswer(line.substr(0, n))) << n;
  }
  EXPECT_FALSE(ParseRequest(line + line));
}

TEST(LineProtocol, FieldsAreWholeNumbers) {
  EXPECT_EQ(ReadField("angle=-5 moving=0", "angle"), -5);
  EXPECT_EQ(ReadField("angle=-5 moving=0", "moving"), 0);
  EXPECT_FALSE(ReadField("angle=-5 moving=0", "shots"));
  EXPECT_FALSE(ReadField("angle=5x", "angle"));
  EXPECT_FALSE(ReadField("angle", "angle"));
}

TEST(LineProtocol, NoiseIsNoLine) {
  std::mt19937_64 engine(7);
  for (int i = 0; i < 20'000; ++i) {
    std::string noise(engine() % 40, ' ');
    for (char& c : noise) c = static_cast<char>(engine());
    EXPECT_FALSE(ParseAnswer(noise));
    EXPECT_FALSE(ParseRequest(noise));
  }
}

}  // namespace
}  // namespace touchdown::rig
