#include "touchdown/vision/detection/frame_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/vision/long_clip.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::vision {
namespace {

// Says how often each frame was decoded.
class Counting : public Clip {
 public:
  Counting(std::int32_t bit_depth, std::map<std::int64_t, int>& reads,
           const std::string& format = "test")
      : reads_(reads) {
    info_.format = format;
    info_.width_px = 17;
    info_.height_px = 11;
    info_.bit_depth = bit_depth;
    info_.frames = 6;
    info_.time_base.fps = 100.0;
  }
  const ClipInfo& info() const override { return info_; }

  static std::uint32_t Sample(std::int64_t index, int x, int y) {
    return static_cast<std::uint32_t>((index * 40 + x * 3 + y * 7) % 251);
  }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    ++reads_[index];
    if (index == 5) throw core::InputError("frame 5 is damaged");
    const std::size_t bytes = info_.bit_depth > 8 ? 2 : 1;
    // Rows padded as a decoder pads them; the same buffer every time.
    const std::size_t stride = 32 * bytes;
    pixels_.assign(stride * 11, std::byte{0});
    for (int y = 0; y < 11; ++y) {
      for (int x = 0; x < 17; ++x) {
        std::byte* at = pixels_.data() + static_cast<std::size_t>(y) * stride +
                        static_cast<std::size_t>(x) * bytes;
        const std::uint32_t value = Sample(index, x, y);
        if (bytes == 1) {
          *at = static_cast<std::byte>(value);
        } else {
          const auto wide = static_cast<std::uint16_t>(value * 10);
          __builtin_memcpy(at, &wide, 2);
        }
      }
    }
    core::Frame frame;
    frame.data = pixels_.data() + static_cast<std::size_t>(window.y) * stride +
                 static_cast<std::size_t>(window.x) * bytes;
    frame.stride_bytes = static_cast<std::ptrdiff_t>(stride);
    frame.bit_depth = info_.bit_depth;
    frame.time_s = static_cast<double>(index) / 100.0;
    return frame;
  }

  ClipInfo info_;
  std::map<std::int64_t, int>& reads_;
  std::vector<std::byte> pixels_;
};

void ExpectFrame(const core::Frame& frame, std::int64_t index,
                 const core::PixelRect& window, std::uint32_t factor) {
  ASSERT_EQ(frame.width_px, window.width);
  ASSERT_EQ(frame.height_px, window.height);
  EXPECT_EQ(frame.origin_x_px, window.x);
  EXPECT_EQ(frame.origin_y_px, window.y);
  EXPECT_EQ(frame.index, index);
  EXPECT_DOUBLE_EQ(frame.time_s, static_cast<double>(index) / 100.0);
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      ASSERT_EQ(frame.at(x, y),
                factor * Counting::Sample(index, x + window.x, y + window.y))
          << index << " " << x << " " << y;
    }
  }
}

TEST(FrameStore, SamePixelsInAnyOrderAndWindowDecodedOnce) {
  for (const std::int32_t depth : {8, 12}) {
    std::map<std::int64_t, int> reads;
    const auto clip = KeepFrames(std::make_unique<Counting>(depth, reads));
    EXPECT_EQ(clip->info().frames, 6);
    EXPECT_EQ(clip->info().bit_depth, depth);
    std::mt19937_64 engine(1);
    for (int k = 0; k < 200; ++k) {
      const auto index = static_cast<std::int64_t>(engine() % 5);
      core::PixelRect window{static_cast<std::int32_t>(engine() % 17),
                             static_cast<std::int32_t>(engine() % 11), 1, 1};
      window.width += static_cast<std::int32_t>(
          engine() % static_cast<std::uint64_t>(17 - window.x));
      window.height += static_cast<std::int32_t>(
          engine() % static_cast<std::uint64_t>(11 - window.y));
      ExpectFrame(clip->Read(index, window), index, window, depth > 8 ? 10 : 1);
    }
    for (const auto& [index, count] : reads) EXPECT_EQ(count, 1) << index;
  }
}

// A kept frame outlives the next read: both are looked at side by side.
TEST(FrameStore, KeptFramesLiveOn) {
  std::map<std::int64_t, int> reads;
  const auto clip = KeepFrames(std::make_unique<Counting>(8, reads));
  const core::Frame first = clip->Read(0);
  const core::Frame second = clip->Read(1);
  ExpectFrame(first, 0, {0, 0, 17, 11}, 1);
  ExpectFrame(second, 1, {0, 0, 17, 11}, 1);
}

// Beyond its memory it decodes again, with the same pixels.
TEST(FrameStore, MemoryIsBounded) {
  std::map<std::int64_t, int> reads;
  FrameStoreOptions options;
  options.most_bytes = 2 * 17 * 11;
  const auto clip = KeepFrames(std::make_unique<Counting>(8, reads), options);
  for (int round = 0; round < 3; ++round) {
    for (std::int64_t i = 0; i < 5; ++i) {
      ExpectFrame(clip->Read(i), i, {0, 0, 17, 11}, 1);
      ExpectFrame(clip->Read(i, {3, 2, 5, 4}), i, {3, 2, 5, 4}, 1);
    }
  }
  EXPECT_EQ(reads[0], 1);
  EXPECT_EQ(reads[1], 1);
  EXPECT_GT(reads[4], 1);
}

TEST(FrameStore, DamagedFrameIsSaidEachTime) {
  std::map<std::int64_t, int> reads;
  const auto clip = KeepFrames(std::make_unique<Counting>(8, reads));
  EXPECT_THROW(clip->Read(5), core::InputError);
  EXPECT_THROW(clip->Read(5), core::InputError);
  ExpectFrame(clip->Read(4), 4, {0, 0, 17, 11}, 1);
  EXPECT_THROW(clip->Read(6), std::invalid_argument);
  EXPECT_THROW(clip->Read(0, {10, 0, 8, 11}), std::invalid_argument);
}

// Of a clip that does not fit, the range is decoded once, and a few key frames.
TEST(FrameStore, LongClipsAreDecodedOnce) {
  const Scene scene = testing::LongScene(600);
  const auto same = OpenScene(scene, 1);
  for (const std::int64_t group : {1, 40, 250}) {
    std::map<std::int64_t, int> decoded;
    FrameStoreOptions options;
    // A quarter of its pictures; of three key frames, which cannot tell what is
    // still, windows at the body's place in each are kept, too.
    options.most_bytes = 320 * 160 * (group < 250 ? 148 : 450);
    const auto clip = KeepFrames(std::make_unique<testing::InGroups>(
                                     OpenScene(scene, 1), group, decoded),
                                 options);
    const auto result = TrackBody(*clip);
    ASSERT_TRUE(result) << result.error().reason;
    int times = 0;
    for (const auto& [index, count] : decoded) times += count;
    EXPECT_LE(times, 600 + 33 + 3) << group;
    // What it hands out are the frames.
    for (const Pose& pose : result->track.poses) {
      ASSERT_NE(clip->KnownChanges(pose.frame), nullptr);
      for (const core::PixelRect& rect :
           clip->KnownChanges(pose.frame)->where) {
        const core::Frame kept = clip->Read(pose.frame, rect);
        const core::Frame frame = same->Read(pose.frame, rect);
        for (int y = 0; y < rect.height; y += 5) {
          for (int x = 0; x < rect.width; ++x) {
            ASSERT_EQ(kept.at(x, y), frame.at(x, y)) << pose.frame;
          }
        }
      }
    }
  }
}

// Piece by piece a range is decoded as often as at once, no farther than asked
// for but for the key frames, and what is kept in the end is the same.
TEST(FrameStore, GrowsWithoutDecodingTwice) {
  const Scene scene = testing::LongScene(600);
  FrameStoreOptions options;
  options.most_bytes = 320 * 160 * 300;
  for (const std::int64_t group : {1, 40}) {
    for (const std::int64_t piece : {group == 1 ? 75 : 17, 300}) {
      SCOPED_TRACE(group * 1000 + piece);
      std::map<std::int64_t, int> once;
      std::map<std::int64_t, int> decoded;
      const auto open = [&](std::map<std::int64_t, int>& count) {
        return std::make_unique<testing::InGroups>(OpenScene(scene, 1), group,
                                                   count);
      };
      const auto kept = KeepFrames(open(once), options);
      const auto grown = GrowFrames(open(decoded), options);
      for (std::int64_t end = piece; end < 600; end += piece) {
        ASSERT_TRUE(grown->ExtendDecoding(end));
        EXPECT_NE(grown->KnownChanges(end - 1), nullptr);
        EXPECT_EQ(grown->KnownChanges(end), nullptr);
        // Key frames beyond the end and where nothing is (the sphere comes at
        // frame 100), and where frames are stored alone those after them.
        int beyond = 0;
        int before = 0;
        for (const auto& [index, count] : decoded) {
          beyond += index >= end;
          before += index < 100 - 40;
        }
        EXPECT_LE(beyond + before, group == 1 ? 2 * 33 : 33) << end;
        const auto still = grown->StillFrames();
        if (end < 100) continue;
        // It has moved out of where it came in.
        EXPECT_TRUE(end <= 240 || grown->HoldsAllChanges()) << end;
        EXPECT_GE(still.size(), std::min<std::int64_t>(end - 100, 16));
        EXPECT_LE(still.size(), 33U);
        EXPECT_LT(still.back(), end);
      }
      ASSERT_TRUE(grown->ExtendDecoding(600));
      EXPECT_TRUE(grown->StillFrames().empty());
      int times = 0;
      for (const auto& [index, count] : decoded) times += count;
      // What was left out is decoded in the end; one group is entered twice.
      EXPECT_LE(times, 600 + 33 + 3 + group - 1);
      for (std::int64_t i = 0; i < 600; ++i) {
        ASSERT_EQ(grown->KnownChanges(i)->where, kept->KnownChanges(i)->where)
            << i;
        EXPECT_EQ(grown->KnownChanges(i)->noise, kept->KnownChanges(i)->noise);
        for (const core::PixelRect& rect : kept->KnownChanges(i)->where) {
          grown->Read(i, rect);
        }
      }
      for (const std::int64_t i : BackgroundFrames(0, 600, 33)) {
        grown->Read(i);
      }
      int again = 0;
      for (const auto& [index, count] : decoded) again += count;
      EXPECT_EQ(again, times);
    }
  }
}

// A body that stands where every key frame shows it is not among the changes:
// that is said before anyone looks.
TEST(FrameStore, SaysThatTheStillPictureHasAGhost) {
  Scene scene = testing::LongScene(600);
  const auto moves = scene.pose;
  // It waits at the right from frame 100 on, in 12 of 15 key frames.
  scene.pose = [moves](double t) {
    return t < 0.1 ? ScenePose{{9.0, 9.0}, 0.0} : moves(0.500);
  };
  FrameStoreOptions options;
  options.most_bytes = 320 * 160 * 300;
  std::map<std::int64_t, int> decoded;
  const auto clip = GrowFrames(
      std::make_unique<testing::InGroups>(OpenScene(scene, 1), 40, decoded),
      options);
  ASSERT_TRUE(clip->ExtendDecoding(120));
  EXPECT_FALSE(clip->HoldsAllChanges());
}

// A body that every key frame shows and few others do: what differs from the
// picture without it is found in all frames, those kept whole among them.
TEST(FrameStore, WhatKeyFramesHideIsFoundInTheEnd) {
  Scene scene = testing::LongScene(600);
  const auto moves = scene.pose;
  const auto shown = [](std::int64_t frame) { return frame % 40 < 8; };
  scene.pose = [&](double t) {
    return shown(std::lround(1000.0 * t)) ? moves(0.500)
                                          : ScenePose{{9.0, 9.0}, 0.0};
  };
  FrameStoreOptions options;
  options.most_bytes = 320 * 160 * 300;
  std::map<std::int64_t, int> decoded;
  const auto clip = KeepFrames(
      std::make_unique<testing::InGroups>(OpenScene(scene, 1), 40, decoded),
      options);
  int kept_whole = 0;
  for (std::int64_t i = 0; i < 600; ++i) {
    ASSERT_NE(clip->KnownChanges(i), nullptr) << i;
    const core::PixelPoint body = ComputeTruth(scene, 0).centre;
    const auto& where = clip->KnownChanges(i)->where;
    const bool seen = std::any_of(
        where.begin(), where.end(), [&](const core::PixelRect& rect) {
          return body.x_px > rect.x && body.x_px < rect.x + rect.width &&
                 body.y_px > rect.y && body.y_px < rect.y + rect.height;
        });
    EXPECT_EQ(seen, shown(i)) << i;
    const int before = decoded[i];
    clip->Read(i);
    kept_whole += decoded[i] == before && shown(i) ? 1 : 0;
  }
  EXPECT_GE(kept_whole, 5);
}

// Too large to be kept piece by piece: said at once, and nothing is decoded.
TEST(FrameStore, GrowsOnlyWhereThereIsRoom) {
  const Scene scene = testing::LongScene(600);
  std::map<std::int64_t, int> decoded;
  FrameStoreOptions options;
  options.most_bytes = 320 * 160 * 45;
  const auto clip = GrowFrames(
      std::make_unique<testing::InGroups>(OpenScene(scene, 1), 40, decoded),
      options);
  EXPECT_FALSE(clip->ExtendDecoding(100));
  EXPECT_TRUE(decoded.empty());
  EXPECT_TRUE(clip->ExtendDecoding(600));
}

// The answer is that of a clip whose every pixel can be looked at.
TEST(FrameStore, WindowsAreEnough) {
  const Scene scene = testing::LongScene(600);
  const auto whole = OpenScene(scene, 1);
  TrackOptions as_long;
  as_long.seen_whole_px = 0.0;
  const auto expected = TrackBody(*whole, as_long);
  std::map<std::int64_t, int> decoded;
  FrameStoreOptions options;
  options.most_bytes = 320 * 160 * 150;
  const auto clip = KeepFrames(
      std::make_unique<testing::InGroups>(OpenScene(scene, 1), 100, decoded),
      options);
  const auto result = TrackBody(*clip);
  ASSERT_TRUE(expected && result);
  ASSERT_EQ(result->track.poses.size(), expected->track.poses.size());
  for (std::size_t i = 0; i < result->track.poses.size(); ++i) {
    const Pose& a = result->track.poses[i];
    const Pose& b = expected->track.poses[i];
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_NEAR(a.centre.x_px, b.centre.x_px, 0.05 * b.u_x_px);
    EXPECT_NEAR(a.centre.y_px, b.centre.y_px, 0.05 * b.u_y_px);
  }
}

// A clip whose frames are stored alone, each reader with its own count.
class Alone : public Clip {
 public:
  Alone(const Scene& scene, std::atomic<int>& decoded)
      : scene_(scene), clip_(OpenScene(scene, 1)), decoded_(decoded) {}
  const ClipInfo& info() const override { return clip_->info(); }
  std::unique_ptr<Clip> Another() const override {
    return std::make_unique<Alone>(scene_, decoded_);
  }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    ++decoded_;
    return clip_->Read(index, window);
  }

  const Scene& scene_;
  std::unique_ptr<Clip> clip_;
  std::atomic<int>& decoded_;
};

// Frames that are stored alone are decoded by several readers, each once, and
// the answer does not depend on how many there are.
TEST(FrameStore, ManyReadersGiveTheSameAnswer) {
  const Scene scene = testing::LongScene(600);
  std::vector<Pose> alone;
  int once = 0;
  for (const int threads : {1, 2, 3, 5}) {
    SCOPED_TRACE(threads);
    std::atomic<int> decoded = 0;
    FrameStoreOptions options;
    options.most_bytes = 320 * 160 * 150;
    options.threads = threads;
    const auto clip =
        KeepFrames(std::make_unique<Alone>(scene, decoded), options);
    EXPECT_LT(decoded, 600);
    if (threads == 1) once = decoded;
    EXPECT_EQ(decoded, once);
    const auto result = TrackBody(*clip);
    ASSERT_TRUE(result) << result.error().reason;
    const std::vector<Pose>& poses = result->track.poses;
    if (threads == 1) alone = poses;
    ASSERT_EQ(poses.size(), alone.size());
    if (threads == 1) continue;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      ASSERT_EQ(poses[i].frame, alone[i].frame);
      ASSERT_EQ(poses[i].centre.x_px, alone[i].centre.x_px);
      ASSERT_EQ(poses[i].centre.y_px, alone[i].centre.y_px);
    }
  }
}

TEST(FrameStore, MappedClipsAreLeftAsTheyAre) {
  std::map<std::int64_t, int> reads;
  auto raw = std::make_unique<Counting>(8, reads, "mraw");
  const Clip* const same = raw.get();
  EXPECT_EQ(KeepFrames(std::move(raw)).get(), same);
}

}  // namespace
}  // namespace touchdown::vision
