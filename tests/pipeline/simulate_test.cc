#include "app/simulate/simulate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "app/simulate/scene_file.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::pipeline {
namespace {

// The paper's Table 1.
constexpr std::array<double, 9> kAngles_deg{0.0,  3.9,  7.8,  11.8, 27.4,
                                            43.0, 58.7, 74.4, 90.0};
constexpr std::array<bool, 9> kSphereBounces{false, false, false, false, true,
                                             true,  true,  true,  true};
constexpr std::array<bool, 9> kRectangleBounces{false, false, false, true, true,
                                                true,  true,  true,  true};

TEST(Table1, SimulatedPhysicsGivesThePapersStatesAtItsAngles) {
  const std::vector<Shot> shots = Table1Shots();
  ASSERT_EQ(shots.size(), 18u);
  for (std::size_t i = 0; i < 18; ++i) {
    const Shot& shot = shots[i];
    const bool sphere = i < 9;
    const double angle = kAngles_deg[i % 9] * core::kDegree;
    const bool bounces =
        sphere ? kSphereBounces[i % 9] : kRectangleBounces[i % 9];
    const ShotTruth truth = ComputeTruth(shot);
    ASSERT_TRUE(truth.touchdown.has_value()) << shot.name;
    EXPECT_NEAR(*shot.set_angle_rad, angle, 1e-15) << shot.name;
    EXPECT_NEAR(sphere ? truth.touchdown->approach_angle_rad
                       : *truth.touchdown->face_angle_rad,
                angle, 1e-12)
        << shot.name;
    EXPECT_EQ(truth.state == core::MotionState::kBounce, bounces) << shot.name;
    EXPECT_TRUE(bounces || core::IsNotBounce(truth.state)) << shot.name;
    // The default convention, and a clear factor away from it.
    EXPECT_NEAR(truth.bounce_height_m, sphere ? 0.80e-3 : 0.88e-3, 1e-12);
    const double factor = truth.greatest.gap_m / truth.bounce_height_m;
    if (bounces) {
      EXPECT_GT(factor, 1.5) << shot.name;
    } else {
      EXPECT_LT(factor, 1.0 / 1.5) << shot.name;
    }
  }
  EXPECT_TRUE(ComputeTruth(shots[0]).touchdown->from_start);
  EXPECT_EQ(ComputeTruth(shots[9]).touchdown->corner, core::Corner::kFlush);
  EXPECT_EQ(ComputeTruth(shots[10]).touchdown->corner, core::Corner::kTrailing);
  EXPECT_EQ(ComputeTruth(shots[17]).touchdown->corner, core::Corner::kFlush);
}

TEST(Table1, NineTrialsOfABodyShareTheirPhysics) {
  const std::vector<Shot> shots = Table1Shots();
  for (std::size_t i = 0; i < 18; ++i) {
    const Shot& first = shots[i / 9 * 9];
    EXPECT_EQ(shots[i].thrown.body, first.thrown.body);
    EXPECT_EQ(shots[i].thrown.mu, first.thrown.mu);
    EXPECT_EQ(shots[i].thrown.restitution, first.thrown.restitution);
    EXPECT_EQ(shots[i].angle_kind, first.angle_kind);
    EXPECT_FALSE(shots[i].bounce_height_m.has_value());
    const double speed =
        std::hypot(ComputeTruth(shots[i]).touchdown->before.vx_mps,
                   ComputeTruth(shots[i]).touchdown->before.vy_mps);
    EXPECT_GE(speed, 1.0) << shots[i].name;
    EXPECT_LE(speed, 2.0) << shots[i].name;
  }
}

TEST(Table1, EnoughOfEachShotIsFilmed) {
  for (const Shot& shot : Table1Shots()) {
    const ShotTruth truth = ComputeTruth(shot);
    const vision::Scene scene = BuildScene(shot, truth.motion);
    const double contact = truth.touchdown->time_s * shot.camera.fps;
    if (!truth.touchdown->from_start) {
      EXPECT_GE(contact - static_cast<double>(shot.lead_in_frames), 20.0)
          << shot.name;
      // Touchdowns fall between frames.
      EXPECT_GT(std::abs(contact - std::round(contact)), 0.02) << shot.name;
    }
    EXPECT_GE(static_cast<double>(shot.frames) - contact, 40.0) << shot.name;
    for (std::int64_t i = 0; i < shot.frames; ++i) {
      const vision::SceneTruth frame = vision::ComputeTruth(scene, i);
      if (i < shot.lead_in_frames) {
        EXPECT_GT(frame.gap_px, 1e5);  // out of sight
        continue;
      }
      // Wholly in the picture.
      EXPECT_GT(frame.centre.x_px, frame.radius_px) << shot.name;
      EXPECT_LT(frame.centre.x_px, 639.0 - frame.radius_px) << shot.name;
      EXPECT_GT(frame.centre.y_px, frame.radius_px) << shot.name;
      EXPECT_LT(frame.centre.y_px, 199.0 - frame.radius_px) << shot.name;
    }
  }
}

// A shot that takes no time to render.
Shot SmallShot() {
  Shot shot = ExampleShot();
  shot.name = "small";
  shot.camera.width_px = 96;
  shot.camera.height_px = 48;
  shot.camera.px_per_m = 400.0;
  shot.camera.ground_point = {50.0, 38.0};
  shot.lead_in_frames = 4;
  shot.frames = 64;
  return shot;
}

nlohmann::json Read(const std::filesystem::path& path) {
  std::ifstream in(path);
  return nlohmann::json::parse(in);
}
std::string Bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(WriteShot, ClipAndTruthBelongTogether) {
  const testing::TemporaryFolder folder;
  const Shot shot = SmallShot();
  const SimulatedClip made =
      WriteShot(shot, {folder.path() / "new", ClipFormat::kMraw, 5, nullptr});
  EXPECT_EQ(made.clip, folder.path() / "new" / "small.mraw");
  EXPECT_EQ(made.truth_file, folder.path() / "new" / "small.truth.json");

  const auto clip = vision::OpenClip(made.clip);
  EXPECT_EQ(clip->info().frames, 64);
  EXPECT_EQ(clip->info().bit_depth, 8);
  EXPECT_DOUBLE_EQ(clip->info().time_base.fps, 2000.0);

  const nlohmann::json truth = Read(made.truth_file);
  EXPECT_EQ(truth["schema"], "touchdown.truth/1");
  EXPECT_EQ(truth["origin"], "simulated");
  EXPECT_EQ(truth["seed"], 5);
  EXPECT_EQ(truth["clip"]["path"], "small.mraw");
  EXPECT_NEAR(truth["contact"]["angle_deg"].get<double>(), 20.0, 1e-9);
  EXPECT_NEAR(truth["contact"]["frame"].get<double>(), 44.0, 1e-9);
  EXPECT_TRUE(truth["contact"]["radius_angle_deg"].is_null());
  EXPECT_EQ(truth["state"]["label"], "bounce");
  EXPECT_NEAR(truth["motion"]["restitution"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(truth["motion"]["before"]["speed_mps"].get<double>(), 1.5, 1e-12);
  ASSERT_EQ(truth["events"].size(), 1u);
  EXPECT_EQ(truth["events"][0]["kind"], "impact");
  ASSERT_EQ(truth["frames"]["rows"].size(), 60u);
  EXPECT_EQ(truth["frames"]["rows"][0][0], 4);
  EXPECT_EQ(truth["frames"]["rows"][0].size(),
            truth["frames"]["columns"].size());

  // The picture shows the body where the truth says, and nothing before.
  const auto& row = truth["frames"]["rows"][30];
  const auto x = static_cast<std::int32_t>(std::lround(row[2].get<double>()));
  const auto y = static_cast<std::int32_t>(std::lround(row[3].get<double>()));
  EXPECT_NEAR(clip->Read(34).at(x, y), 0.15 * 255.0, 20.0);
  EXPECT_NEAR(clip->Read(3).at(x, y), 0.65 * 255.0, 20.0);

  // From the scene within the truth the clip is made again to the byte.
  Shot again = ParseScene(truth["scene"].dump(), "truth");
  const SimulatedClip second = WriteShot(
      again, {folder.path() / "again", ClipFormat::kMraw, 5, nullptr});
  EXPECT_EQ(Bytes(second.clip), Bytes(made.clip));
  const SimulatedClip third = WriteShot(
      again, {folder.path() / "other", ClipFormat::kMraw, 6, nullptr});
  EXPECT_NE(Bytes(third.clip), Bytes(made.clip));
}

TEST(WriteShot, AFolderOfImagesIsNeverReplaced) {
  const testing::TemporaryFolder folder;
  Shot shot = SmallShot();
  shot.frames = 6;
  const SimulateOptions options{folder.path(), ClipFormat::kPng, 1, nullptr};
  const SimulatedClip made = WriteShot(shot, options);
  EXPECT_EQ(vision::OpenClip(made.clip, {.fps = 2000.0})->info().frames, 6);
  const std::string truth = Bytes(made.truth_file);
  SimulateOptions other = options;
  other.seed = 2;
  try {
    WriteShot(shot, other);
    ADD_FAILURE() << "replaced";
  } catch (const core::OutputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("exists already"));
  }
  EXPECT_EQ(Bytes(made.truth_file), truth);
}

TEST(WriteShot, ACallThatFailsLeavesNoTruth) {
  const testing::TemporaryFolder folder;
  Shot shot = SmallShot();
  shot.camera.bit_depth = 12;  // more than H.264 is written with
  const SimulateOptions options{folder.path(), ClipFormat::kMp4, 1, nullptr};
  EXPECT_ANY_THROW(WriteShot(shot, options));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WriteShot, ImpossibleShotsAreRefused) {
  const testing::TemporaryFolder folder;
  const SimulateOptions options{folder.path(), ClipFormat::kMraw, 1, nullptr};
  Shot shot = SmallShot();
  shot.name = "../out";
  EXPECT_THROW(WriteShot(shot, options), std::invalid_argument);
  shot = SmallShot();
  shot.lead_in_frames = shot.frames;
  EXPECT_THROW(WriteShot(shot, options), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  SimulateOptions nowhere = options;
  nowhere.folder = "/dev/null/there";
  EXPECT_THROW(WriteShot(SmallShot(), nowhere), core::InputError);
}

TEST(TruthOfShot, WithoutContactNothingIsDecided) {
  Shot shot = SmallShot();
  shot.frames = 30;  // it touches down in frame 44
  const ShotTruth truth = ComputeTruth(shot);
  EXPECT_FALSE(truth.touchdown.has_value());
  EXPECT_EQ(truth.state, core::MotionState::kUndecided);
}

// What the command answers: one line and the exit status.
struct Answer {
  int status = 0;
  std::string text;
};
Answer Command(const std::string& arguments) {
  Answer answer;
  const std::string line =
      std::string(TOUCHDOWN_BINARY) + " simulate " + arguments + " 2>&1";
  FILE* pipe = popen(line.c_str(), "r");
  char buffer[512];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) {
    answer.text += buffer;
  }
  answer.status = WEXITSTATUS(pclose(pipe));
  return answer;
}

TEST(SimulateCommand, ExampleRunsAndMistakesAreOneLine) {
  const testing::TemporaryFolder folder;
  const std::string scene = (folder.path() / "scene.json").string();
  const std::string out = " --out " + (folder.path() / "clips").string();
  Answer example = Command("--example");
  EXPECT_EQ(example.status, 0);
  // A smaller picture of it.
  std::string text = SceneText(SmallShot());
  std::ofstream(scene) << text;
  EXPECT_EQ(ParseScene(example.text, "example").name, ExampleShot().name);
  const Answer made = Command(scene + out + " --json");
  EXPECT_EQ(made.status, 0) << made.text;
  const nlohmann::json document = nlohmann::json::parse(made.text);
  EXPECT_EQ(document["schema"], "touchdown.simulate/1");
  EXPECT_TRUE(
      std::filesystem::exists(document["clips"][0]["clip"].get<std::string>()));

  const auto one_line = [](const Answer& answer) {
    return std::count(answer.text.begin(), answer.text.end(), '\n') == 1;
  };
  Answer wrong = Command(scene);
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(one_line(wrong)) << wrong.text;
  wrong = Command(scene + out + " --format gif");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(one_line(wrong)) << wrong.text;
  wrong = Command(out);
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(one_line(wrong)) << wrong.text;
  std::ofstream(scene) << "{\"schema\": 3}";
  wrong = Command(scene + out);
  EXPECT_EQ(wrong.status, 3);
  EXPECT_TRUE(one_line(wrong)) << wrong.text;
  EXPECT_THAT(wrong.text, ::testing::HasSubstr("/schema"));
}

}  // namespace
}  // namespace touchdown::pipeline
