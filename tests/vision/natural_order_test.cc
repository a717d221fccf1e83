#include "vision/src/footage/formats/natural_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace touchdown::vision {
namespace {

TEST(NaturalLess, SortsAsAPersonNumbers) {
  const std::vector<std::string> sorted = {"",
                                           "9a",
                                           "10",
                                           "a",
                                           "a1b2",
                                           "a1b10",
                                           "a01b11",
                                           "a2",
                                           "img2.png",
                                           "img02.png",
                                           "img002.png",
                                           "img10.png",
                                           "img10a.png",
                                           "img99999999999999999999998.png",
                                           "img99999999999999999999999.png",
                                           "roll17.06.jpg",
                                           "roll17.10.jpg",
                                           "roll17.100.jpg",
                                           "\xC3\xA4"};
  std::vector<std::string> shuffled = sorted;
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    std::sort(shuffled.begin(), shuffled.end(), NaturalLess);
    EXPECT_EQ(shuffled, sorted);
  }
}

// Property: exactly one of a < b, b < a, a == b; and < is transitive.
TEST(NaturalLess, IsATotalOrder) {
  std::mt19937 random(2);
  std::vector<std::string> names;
  for (int i = 0; i < 60; ++i) {
    std::string name;
    for (std::size_t n = random() % 6; n > 0; --n)
      name += "a01.2"[random() % 5];
    names.push_back(name);
  }
  for (const auto& a : names) {
    for (const auto& b : names) {
      EXPECT_EQ((NaturalLess(a, b) ? 1 : 0) + (NaturalLess(b, a) ? 1 : 0) +
                    (a == b ? 1 : 0),
                1)
          << a << " " << b;
      for (const auto& c : names) {
        if (NaturalLess(a, b) && NaturalLess(b, c)) {
          EXPECT_TRUE(NaturalLess(a, c)) << a << " " << b << " " << c;
        }
      }
    }
  }
}

}  // namespace
}  // namespace touchdown::vision
