// Footage with known truth: a shot's physics (analysis), its camera (vision),
// and the clip and truth file that come of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/analysis/theory/rigid_motion.h"
#include "touchdown/core/words.h"
#include "touchdown/vision/synthetic/scene.h"

namespace touchdown::pipeline {

// One shot to be filmed. Time zero is the middle of frame 0's exposure. Before
// frame `lead_in_frames` the body is out of sight, as behind a muzzle: the
// camera runs before the shot, and sees the background that the body is later
// in front of. thrown.start is the state at that frame; the body is
// thrown.body.
struct Shot {
  std::string name;  // of the files; letters, digits, '-' and '_'
  core::AngleKind angle_kind = core::AngleKind::kApproach;  // the varied angle
  std::optional<double> set_angle_rad;  // its set-point, where there is one
  // Rising above it is what bounce means; absent: the default convention.
  std::optional<double> bounce_height_m;
  analysis::RigidMotionProblem thrown;  // times follow from the frames
  std::int64_t lead_in_frames = 0;
  std::int64_t frames = 1;  // in all
  vision::SceneCamera camera;
  vision::SceneLook look;
  vision::SceneTrouble trouble;
  vision::SensorNoise noise;
};

// What is true of a shot, from its physics alone.
struct ShotTruth {
  analysis::RigidMotion motion;
  std::optional<analysis::TouchdownTruth> touchdown;  // within the frames
  // Of the greatest gap between touchdown and the last frame.
  analysis::GreatestGap greatest;
  double bounce_height_m = 0.0;
  core::MotionState state = core::MotionState::kUndecided;
  bool micro_bounce = false;  // left the ground, below the bounce height
};

// thrown with its start and end times set from the frames.
analysis::RigidMotionProblem MakeProblem(const Shot& shot);

// Throws std::invalid_argument if the shot is impossible.
ShotTruth ComputeTruth(const Shot& shot);

// The shot as the renderer takes it; its pose function shares the motion.
vision::Scene BuildScene(const Shot& shot, const analysis::RigidMotion& motion);

// The 18 shots of the paper's Table 1: 9 angles of approach of a sphere, 9 face
// angles of a rectangle. Nine trials of a body share body, surface, friction,
// restitution and camera: two campaigns, as in a laboratory. Their outcomes
// follow from the physics (table1.cc says how it was chosen).
std::vector<Shot> Table1Shots();

enum class ClipFormat { kMraw, kPng, kTiff, kMp4 };
std::optional<ClipFormat> ParseClipFormat(std::string_view word);

struct SimulateOptions {
  std::filesystem::path folder;  // made if it is not there
  ClipFormat format = ClipFormat::kMraw;
  std::uint64_t seed = 1;  // of the noise; a shot's depends on its name too
  std::function<void(double share)> progress;  // of this shot, 0..1
};

struct SimulatedClip {
  std::filesystem::path clip;
  std::filesystem::path truth_file;
  ShotTruth truth;
};

// Writes <folder>/<name>.mraw (.mp4, or the folder <name> of images) and
// <name>.truth.json beside it (schema touchdown.truth/1, truth_json.h), which
// marks the footage as simulated. The truth is written first: there is never
// a clip without its mark. Throws core::OutputError naming what cannot be
// written, or the folder of images that is in use.
SimulatedClip WriteShot(const Shot& shot, const SimulateOptions& options);

}  // namespace touchdown::pipeline
