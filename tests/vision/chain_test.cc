#include "vision/src/detection/chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace touchdown::vision {
namespace {

// A blob of that area at (x, y), of one contrast.
Blob At(double x_px, double y_px, double area_px2) {
  Blob blob;
  blob.centre = {x_px, y_px};
  blob.area_px2 = area_px2;
  blob.contrast_dn = 50.0;
  return blob;
}

TEST(ChainBuilder, JoinsABodyThatWasHidden) {
  ChainBuilder builder;
  for (const std::int64_t frame : {0, 1, 2, 3, 20, 21, 22, 23, 50, 51, 52}) {
    const auto x = 10.0 * static_cast<double>(frame);
    // A second thing, of another size, for part of the time.
    std::vector<Blob> blobs = {At(x, 50.0, 400.0)};
    if (frame >= 20 && frame < 30) blobs.push_back(At(700.0 - x, 300.0, 40.0));
    builder.Add(frame, 1e-3 * static_cast<double>(frame), blobs);
  }
  const std::vector<Chain> chains = builder.Finish();
  ASSERT_EQ(chains.size(), 2u);
  EXPECT_EQ(chains[0].links.size(), 11u);
  EXPECT_EQ(chains[1].links.size(), 4u);
  EXPECT_EQ(builder.left_out(), 0u);
}

TEST(ChainBuilder, KeepsTheStrongestOfTooMany) {
  LinkOptions options;
  options.most_chains = 3;
  ChainBuilder builder(options);
  for (std::int64_t frame = 0; frame < 6; ++frame) {
    const auto x = 5.0 * static_cast<double>(frame);
    std::vector<Blob> blobs;
    for (int k = 0; k < 5; ++k) {
      blobs.push_back(At(x, 200.0 * k, 20.0 * (1 << (2 * k))));
    }
    builder.Add(frame, 1e-3 * static_cast<double>(frame), blobs);
  }
  const std::vector<Chain> chains = builder.Finish();
  ASSERT_EQ(chains.size(), 3u);
  EXPECT_EQ(builder.left_out(), 2u);
  EXPECT_EQ(chains[0].links.front().blob.centre.y_px, 800.0);
  EXPECT_EQ(chains[2].links.front().blob.centre.y_px, 400.0);
}

// A hand that moves about is larger than the ball that it lets fall.
TEST(ChainBuilder, WhatFallsComesBeforeWhatIsLarger) {
  ChainBuilder builder;
  for (std::int64_t frame = 0; frame < 40; ++frame) {
    const auto t = static_cast<double>(frame);
    builder.Add(frame, 0.04 * t,
                {At(300.0 + 20.0 * std::sin(0.3 * t), 60.0, 1000.0),
                 At(100.0 + 2.0 * t, 50.0 + 0.25 * t * t, 200.0)});
  }
  const std::vector<Chain> chains = builder.Finish();
  ASSERT_EQ(chains.size(), 2u);
  EXPECT_EQ(chains[0].links.front().blob.area_px2, 200.0);
  EXPECT_TRUE(chains[0].Falls());
  EXPECT_FALSE(chains[1].Falls());
}

// At thousands of frames per second no body falls by its own size: the stronger
// comes first.
TEST(ChainBuilder, NothingIsSaidToFallThatFallsByLessThanItsSize) {
  ChainBuilder builder;
  for (std::int64_t frame = 0; frame < 40; ++frame) {
    const auto t = static_cast<double>(frame);
    builder.Add(frame, 0.001 * t,
                {At(300.0 + 5.0 * t, 60.0, 1000.0),
                 At(100.0 + 5.0 * t, 150.0 + 3.0 * t + 0.01 * t * t, 800.0)});
  }
  const std::vector<Chain> chains = builder.Finish();
  ASSERT_EQ(chains.size(), 2u);
  EXPECT_FALSE(chains[1].Falls());
  EXPECT_EQ(chains[0].links.front().blob.area_px2, 1000.0);
}

}  // namespace
}  // namespace touchdown::vision
