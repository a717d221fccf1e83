// With --stop-early the first contact is the same as without, and what comes
// after the decision is not read.
#include "app/measure/stop_early.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "app/documents/analysis_json.h"
#include "app/documents/log_analysis.h"
#include "app/documents/replay.h"
#include "app/measure/footage.h"
#include "app/measure/options_hash.h"
#include "tests/pipeline/document.h"
#include "tests/vision/long_clip.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/background/steady_camera.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::pipeline {
namespace {

constexpr std::int64_t kFrames = 600;
constexpr double kFps = 1000.0;
constexpr double kRadius_m = 0.012;
constexpr double kGravity = core::kStandardGravity_mps2;

using Pose = std::function<vision::ScenePose(double)>;

vision::ScenePose Away() { return {{9.0, 9.0}, 0.0}; }

// A sphere that flies in from the left at 2 m/s, touches down at `contact_s`
// and leaves the ground again and again with `e` of its normal velocity.
struct Thrown {
  double contact_s = 0.20037;
  double vx = 2.0;
  double vy = 0.6;  // downwards, at touchdown
  double e = 0.6;
  double vx_after = 2.0;
  double lead_s = 0.12;  // it is nowhere before

  vision::ScenePose At(double time_s) const {
    double t = time_s - contact_s;
    if (t < -lead_s) return Away();
    if (t < 0.0) {
      return {{0.2 + vx * t, kRadius_m - vy * t - 0.5 * kGravity * t * t}, 0.0};
    }
    const double x = 0.2 + vx_after * t;
    double up = e * vy;
    constexpr double kRest = 1e-3;  // m/s
    while (up > kRest && t > 2.0 * up / kGravity) {
      t -= 2.0 * up / kGravity;
      up *= e;
    }
    const double gap =
        up > kRest ? std::max(0.0, up * t - 0.5 * kGravity * t * t) : 0.0;
    return {{x, kRadius_m + gap}, 0.0};
  }
};
Pose Bouncing(const Thrown& thrown) {
  return [thrown](double t) { return thrown.At(t); };
}
// It slides on at half the speed.
constexpr Thrown kStays{.e = 0.0, .vx_after = 1.0};

vision::Scene BuildScene(const Pose& pose, std::int32_t bit_depth = 8) {
  vision::Scene scene;
  scene.camera.width_px = 480;
  scene.camera.height_px = 160;
  scene.camera.px_per_m = 1000.0;
  scene.camera.ground_point = {0.0, 130.3};
  scene.camera.fps = kFps;
  scene.camera.bit_depth = bit_depth;
  scene.look.texture_amplitude = 0.03;
  scene.body = core::Sphere({2.0 * kRadius_m, 0.0});
  scene.frames = kFrames;
  scene.noise = {1.5, 0.02};
  scene.pose = pose;
  return scene;
}

// How the frames are kept: all whole, or windows of most.
struct Keeping {
  std::size_t most_bytes = std::size_t{192} << 20;
  std::int64_t group = 1;  // frames stored one upon the other
};
constexpr Keeping kAlone{std::size_t{480} * 160 * 300, 1};
constexpr Keeping kGroups{std::size_t{480} * 160 * 300, 40};
constexpr Keeping kWhole;

AnalyzeOptions Known() {
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{1000.0, 0.1, std::nullopt};
  options.stop_early = true;
  options.decoder_threads = 1;
  return options;
}

struct Both {
  Analysis whole;
  Analysis early;
  std::map<std::int64_t, int> decoded_whole;
  std::map<std::int64_t, int> decoded_early;
};

Both AnalyzeBoth(const vision::Scene& scene, const Keeping& keeping,
                 std::uint64_t seed = 1) {
  Both both;
  const AnalyzeOptions options = Known();
  const auto open = [&](std::map<std::int64_t, int>& count) {
    return std::make_unique<vision::testing::InGroups>(
        vision::OpenScene(scene, seed), keeping.group, count);
  };
  auto clip = open(both.decoded_whole);
  const vision::ClipInfo info = clip->info();
  const ClipCalibration camera = FitToClip(options, info);
  std::optional<vision::CameraMotion> motion;
  Footage footage = MakeSteady(std::move(clip), options, motion);
  vision::FrameStoreOptions keep = MakeKeepOptions(options, info);
  keep.most_bytes = keeping.most_bytes;
  footage.clip = vision::KeepFrames(std::move(footage.clip), keep);
  both.whole = AnalyzeFootage(std::move(footage), camera, options);
  motion.reset();  // what its measurement decodes counts for both
  both.early =
      AnalyzeUntilDecided(MakeSteady(open(both.decoded_early), options, motion),
                          camera, options, {}, keeping.most_bytes);
  return both;
}

void ExpectNear(const core::Measured& early, const core::Measured& whole,
                const char* what) {
  ASSERT_EQ(early.has_value(), whole.has_value()) << what;
  if (!whole) return;
  constexpr double kMost_u = 2.0;
  EXPECT_NEAR(early->value, whole->value, kMost_u * early->u) << what;
  // Fewer frames tell no more, and not much less.
  constexpr double kLeast = 0.9;
  constexpr double kMost = 1.5;
  EXPECT_GE(early->u, kLeast * whole->u) << what;
  EXPECT_LE(early->u, kMost * whole->u) << what;
}

// The same answer from [0, stop); of what follows only key frames were read.
void ExpectStopped(const Both& both, std::int64_t latest,
                   const Keeping& keeping) {
  ASSERT_TRUE(both.early.stopped_at)
      << ReasonToContinue(both.whole, kFrames, 0);
  const std::int64_t stop = *both.early.stopped_at;
  EXPECT_LE(stop, latest);
  const core::ContactRecord& early = both.early.contacts.first;
  const core::ContactRecord& whole = both.whole.contacts.first;
  EXPECT_EQ(early.state.label, whole.state.label);
  ExpectNear(early.contact.time_s, whole.contact.time_s, "time");
  ExpectNear(early.contact.approach_angle_rad, whole.contact.approach_angle_rad,
             "angle");
  std::set<std::int64_t> keys;
  for (const std::int64_t frame : vision::BackgroundFrames(
           0, kFrames, vision::BackgroundOptions{}.samples)) {
    keys.insert(frame / keeping.group * keeping.group);
    if (keeping.group == 1) keys.insert(frame + 1);  // to be sure of it
  }
  // Those in which was looked whether the camera moved.
  std::set<std::int64_t> looks = {0, 1};
  const int count_of_looks = vision::SteadyCameraOptions{}.looks;
  for (std::int64_t k = 1; k <= count_of_looks; ++k) {
    looks.insert(k * (kFrames - 1) / count_of_looks / keeping.group *
                 keeping.group);
  }
  keys.insert(looks.begin(), looks.end());
  // Once, but for keys of groups and the frames that told light and camera.
  constexpr std::int64_t kLight = 30;
  for (const auto& [frame, count] : both.decoded_early) {
    EXPECT_TRUE(frame < stop || keys.contains(frame)) << frame;
    const bool twice =
        keeping.group > 1 && frame < stop && keys.contains(frame);
    EXPECT_LE(count, 1 + (twice ? 1 : 0) + (frame < kLight ? 1 : 0) +
                         (looks.contains(frame) ? 1 : 0))
        << frame;
  }
  const auto document = filmed::ExpectDocument(both.early);
  EXPECT_EQ(document["stopped_at_frame"], stop);
  const std::string frames =
      "frames " + std::to_string(stop) + ":" + std::to_string(kFrames);
  ASSERT_TRUE(document["scene_model"]["left_out"].contains(frames))
      << document["scene_model"];
  EXPECT_NE(
      ToText(both.early)
          .find("stopped    at frame " + std::to_string(stop) + " of 600"),
      std::string::npos);
}

// All but what differs from run to run.
nlohmann::json Timeless(const Analysis& analysis) {
  auto document = nlohmann::json::parse(ToJson(analysis));
  document.erase("timing_s");
  return document;
}

// Not decided before the end: the document is that of a whole analysis, and
// frames are decoded as often, but for `most_more`.
void ExpectWhole(const Both& both, int most_more = 3) {
  EXPECT_FALSE(both.early.stopped_at);
  EXPECT_EQ(Timeless(both.early), Timeless(both.whole));
  int once = 0;
  int pieces = 0;
  for (const auto& [frame, count] : both.decoded_whole) once += count;
  for (const auto& [frame, count] : both.decoded_early) pieces += count;
  EXPECT_LE(pieces, once + most_more);
}

class StopEarly : public ::testing::TestWithParam<Keeping> {};

TEST_P(StopEarly, ABounceIsTheSame) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const double contact_s = 0.2 + 0.0003 * static_cast<double>(seed);
    const Both both = AnalyzeBoth(
        BuildScene(Bouncing({.contact_s = contact_s})), GetParam(), seed);
    EXPECT_EQ(both.whole.contacts.first.state.label,
              core::MotionState::kBounce);
    ExpectStopped(both, 320, GetParam());
    // Later contacts are those that were seen so far.
    EXPECT_GT(both.whole.contacts.later.size(),
              both.early.contacts.later.size());
  }
}

TEST_P(StopEarly, ASteepBounceIsTheSame) {
  const Pose pose = Bouncing(
      {.contact_s = 0.15037, .vx = 0.5, .vy = 2.0, .e = 0.3, .lead_s = 0.1});
  ExpectStopped(AnalyzeBoth(BuildScene(pose), GetParam()), 270, GetParam());
}

TEST_P(StopEarly, WhatStaysDownIsTheSame) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const Both both =
        AnalyzeBoth(BuildScene(Bouncing(kStays)), GetParam(), seed);
    EXPECT_EQ(both.whole.contacts.first.state.label,
              core::MotionState::kStaysDown);
    ExpectStopped(both, 330, GetParam());
  }
}

TEST_P(StopEarly, ALateBodyIsWaitedFor) {
  const Both both =
      AnalyzeBoth(BuildScene(Bouncing({.contact_s = 0.45037})), GetParam());
  ExpectStopped(both, 560, GetParam());
  // It comes in frame 330: of what was before that, little was decoded.
  constexpr std::int64_t kComes = 330;
  constexpr std::int64_t kKeysAndLight = 33 + 30;
  const std::int64_t group = GetParam().group;
  const auto before = std::count_if(
      both.decoded_early.begin(), both.decoded_early.end(),
      [&](const auto& frame) { return frame.first < kComes - group; });
  EXPECT_LE(before, kKeysAndLight);
  const auto document = filmed::ExpectDocument(both.early);
  bool said = false;
  for (const auto& item : document["scene_model"]["left_out"].items()) {
    said |= item.key().starts_with("frames 0:");
  }
  EXPECT_TRUE(said) << document["scene_model"];
}

TEST_P(StopEarly, WithoutAContactAllIsLookedAt) {
  const Pose over = [](double t) {  // 30 mm above the ground at the least
    const double since = t - 0.2;
    if (std::abs(since) > 0.1) return Away();
    return vision::ScenePose{
        {0.24 + 2.6 * since, 0.1 - 0.5 * kGravity * since * since}, 0.0};
  };
  ExpectWhole(AnalyzeBoth(BuildScene(over), GetParam()));
}

TEST_P(StopEarly, WhatNeverMovesIsLookedAtToTheEnd) {
  const Pose rests = [](double) {
    return vision::ScenePose{{0.2, kRadius_m}, 0.0};
  };
  ExpectWhole(AnalyzeBoth(BuildScene(rests), GetParam()));
}

// A body that is held in the picture until frame 250 is part of the background
// of the first pieces.
TEST_P(StopEarly, ABodyThatIsHeldAtFirstIsTheSame) {
  constexpr double kHeight_m = 0.06;
  const double fall_s = std::sqrt(2.0 * kHeight_m / kGravity);
  const Thrown falls{.contact_s = 0.25 + fall_s,
                     .vx = 0.0,
                     .vy = kGravity * fall_s,
                     .e = 0.5,
                     .vx_after = 0.0,
                     .lead_s = fall_s};
  const Pose held = [falls](double t) {
    return t < falls.contact_s - falls.lead_s
               ? vision::ScenePose{{0.2, kRadius_m + kHeight_m}, 0.0}
               : falls.At(t);
  };
  const Both both = AnalyzeBoth(BuildScene(held), GetParam());
  ASSERT_TRUE(both.whole.contacts.first.contact.found);
  if (!both.early.stopped_at) {
    // Its windows do not fit beside what is kept whole: once more at the most.
    ExpectWhole(both, kFrames);
  } else {
    ExpectStopped(both, kFrames, GetParam());
  }
}

// It rises to the bounce height itself: never decided.
TEST_P(StopEarly, WhatIsInDoubtIsLookedAtToTheEnd) {
  const double up = std::sqrt(2.0 * kGravity * 0.0005);  // h_c is 0.5 mm
  ExpectWhole(AnalyzeBoth(
      BuildScene(Bouncing({.e = up / Thrown{}.vy, .vx_after = 1.0})),
      GetParam()));
}

// Small enough to be kept whole: there is nothing to gain.
TEST(StopEarlySmall, AllIsLookedAt) {
  ExpectWhole(AnalyzeBoth(BuildScene(Bouncing({})), kWhole));
}

INSTANTIATE_TEST_SUITE_P(Kept, StopEarly, ::testing::Values(kAlone, kGroups),
                         [](const auto& tested) {
                           return tested.param.group > 1 ? "Groups" : "Alone";
                         });

// Each line of the rule by itself, of an analysis that it stops at.
TEST(StopRule, EachConditionCounts) {
  const Analysis good = AnalyzeBoth(BuildScene(Bouncing({})), kGroups).early;
  ASSERT_TRUE(good.stopped_at);
  const std::int64_t end = *good.stopped_at;
  EXPECT_EQ(ReasonToContinue(good, end, 0), "");
  const auto expect = [&](const std::function<void(Analysis&)>& change) {
    Analysis changed = good;
    change(changed);
    EXPECT_NE(ReasonToContinue(changed, end, 0), "");
  };
  expect([](Analysis& a) { a.track->several_bodies = true; });
  expect([](Analysis& a) { a.track->known_background = false; });
  expect([](Analysis& a) { a.track = core::AbsentBecause("lost"); });
  expect([](Analysis& a) { a.plane.reset(); });
  expect([](Analysis& a) { a.scale = core::AbsentBecause("lost"); });
  expect([](Analysis& a) { a.warnings.emplace_back("anything"); });
  expect([](Analysis& a) { a.contacts.ground_refuted = "anything"; });
  expect([](Analysis& a) { a.contacts.evidence.front().ground_px = 0.1; });
  expect([](Analysis& a) { a.contacts.first.contact.found = false; });
  expect([](Analysis& a) { a.contacts.first.contact.from_start = true; });
  expect([](Analysis& a) {
    a.contacts.first.state.label = core::MotionState::kUndecided;
  });
  expect([](Analysis& a) { a.contacts.first.state.p_bounce = 1.0 - 1e-5; });
  expect([](Analysis& a) {
    a.contacts.first.state.max_gap_m->value =
        1.5 * a.contacts.first.state.bounce_height_m->value;
  });
  expect([](Analysis& a) { a.contacts.first.contact.frame->value += 60.0; });
  Analysis warned = good;
  warned.warnings.emplace_back("of the file");
  EXPECT_EQ(ReasonToContinue(warned, end, 1), "");
  warned.warnings.emplace_back("the ground is off");
  warned.contacts.warnings.emplace_back("the ground is off");
  EXPECT_EQ(ReasonToContinue(warned, end, 1), "");

  const auto apart = [&](const std::function<void(Analysis&)>& change) {
    Analysis changed = good;
    change(changed);
    EXPECT_FALSE(SayTheSame(changed, good));
  };
  EXPECT_TRUE(SayTheSame(good, good));
  apart([](Analysis& a) {
    a.contacts.first.state.label = core::MotionState::kSlide;
  });
  apart([](Analysis& a) {
    core::Estimate& t = *a.contacts.first.contact.time_s;
    t.value += 2.1 * t.u;
  });
  apart([](Analysis& a) {
    core::Estimate& angle = *a.contacts.first.contact.approach_angle_rad;
    angle.value -= 2.1 * angle.u;
  });
}

// A block that stays down counts as decided only once it lies flat.
TEST(StopRule, ABlockThatStandsOnItsCornerMayStillFall) {
  Analysis good = AnalyzeBoth(BuildScene(Bouncing(kStays)), kGroups).early;
  ASSERT_TRUE(good.stopped_at);
  EXPECT_EQ(ReasonToContinue(good, *good.stopped_at, 0), "");
  good.plane->kind = core::BodyKind::kRectangle;
  good.plane->samples.back().face_rad = 0.01;
  EXPECT_EQ(ReasonToContinue(good, *good.stopped_at, 0), "");
  good.plane->samples.back().face_rad = 0.1;
  EXPECT_EQ(ReasonToContinue(good, *good.stopped_at, 0),
            "it does not lie flat");
}

// The option is part of the document and of the digest, and a stored trial is
// judged again as it was.
TEST(StopEarlyTrial, IsJudgedAgainTheSameWay) {
  Analysis early = AnalyzeBoth(BuildScene(Bouncing({})), kGroups).early;
  ASSERT_TRUE(early.stopped_at);
  AnalyzeOptions without = Known();
  without.stop_early = false;
  EXPECT_EQ(early.options_hash, OptionsHash(Known()));
  EXPECT_NE(early.options_hash, OptionsHash(without));
  early.clip.path = "shot.mp4";
  core::Trial trial = ToTrial(early);
  trial.clip.id = "id";
  const auto again = Replay(trial);
  ASSERT_TRUE(again) << again.error().reason;
  EXPECT_TRUE(again->options.stop_early);
  EXPECT_EQ(again->stopped_at, early.stopped_at);
  EXPECT_EQ(again->options_hash, early.options_hash);
  EXPECT_EQ(again->scene_model.left_out, early.scene_model.left_out);
  const core::Contact& a = again->contacts.first.contact;
  const core::Contact& b = early.contacts.first.contact;
  EXPECT_NEAR(a.time_s->value, b.time_s->value, 0.01 * b.time_s->u);
  EXPECT_EQ(again->contacts.first.state.label,
            early.contacts.first.state.label);
}

}  // namespace
}  // namespace touchdown::pipeline
