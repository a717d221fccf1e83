#include "touchdown/core/nearest.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace touchdown::core {
namespace {

const std::vector<std::string> kNames = {"asphalt, block", "asphalt, ball",
                                         "ice"};

TEST(Nearest, IsTheCandidateWithTheFewestLettersChanged) {
  EXPECT_EQ(Nearest("asphalt, blok", kNames), "asphalt, block");
  EXPECT_EQ(Nearest("asfalt, ball", kNames), "asphalt, ball");
  EXPECT_EQ(Nearest("ise", kNames), "ice");
  EXPECT_EQ(Nearest("ice", kNames), "ice");
}

TEST(Nearest, IsNothingBeyondAThirdOfTheLetters) {
  EXPECT_EQ(Nearest("concrete", kNames), "");
  EXPECT_EQ(Nearest("asphalt", {}), "");
  // Every letter of a word of two may be wrong: that says nothing.
  EXPECT_EQ(Nearest("xy", kNames), "");
}

TEST(DidYouMean, SaysWhatToDoWhereNothingIsNear) {
  EXPECT_EQ(DidYouMean("ise", kNames, "see the list"), "did you mean 'ice'?");
  EXPECT_EQ(DidYouMean("concrete", kNames, "see the list"), "see the list");
}

}  // namespace
}  // namespace touchdown::core
