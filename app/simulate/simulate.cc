#include "app/simulate/simulate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <system_error>

#include "app/simulate/truth_json.h"
#include "app/text/text_file.h"
#include "app/text/truth_file.h"
#include "touchdown/core/body.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"
#include "touchdown/core/unfinished.h"
#include "touchdown/vision/footage/clip_writer.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::pipeline {
namespace {

// A body that has risen by a micrometre has left the ground (hops of the
// simulated contact are 2 nm high).
constexpr double kLeft_m = 1e-6;

// Returns the middle of the last frame's exposure, s from that of frame 0.
double LastFrame_s(const Shot& shot) {
  return static_cast<double>(shot.frames - 1) / shot.camera.fps;
}

// Does a stretch of this kind begin while the camera runs?
bool Filmed(const analysis::RigidMotion& motion, analysis::StretchKind kind,
            double end_s) {
  return std::any_of(motion.stretches.begin(), motion.stretches.end(),
                     [&](const analysis::Stretch& s) {
                       return s.kind == kind && s.start.time_s <= end_s;
                     });
}

// Names what a body does that did not bounce, from what was filmed up to
// `end_s`. A sphere is judged by its stretches; a rectangle, which hops and
// tilts while it slides, by whether it travelled on.
core::MotionState TrueState(const analysis::RigidMotion& motion,
                            const analysis::TouchdownTruth& touchdown,
                            double end_s) {
  using analysis::StretchKind;
  if (motion.body.kind == core::BodyKind::kSphere) {
    const bool slides = Filmed(motion, StretchKind::kSlide, end_s);
    const bool rolls = Filmed(motion, StretchKind::kRoll, end_s);
    if (slides && rolls) return core::MotionState::kRollSlide;
    if (slides) return core::MotionState::kSlide;
    if (rolls) return core::MotionState::kRoll;
    if (Filmed(motion, StretchKind::kRest, end_s)) {
      return core::MotionState::kStick;
    }
    return core::MotionState::kStaysDown;
  }
  // It slides if it travels on, however it wobbles.
  const double travelled =
      std::abs(analysis::ComputeState(motion, end_s).centre.x_m -
               touchdown.before.centre.x_m);
  // 0.1 mm is far above the rounding of the simulation and, at 1000 px/m, a
  // tenth of a pixel.
  constexpr double kTravelled_m = 1e-4;
  return travelled > kTravelled_m ? core::MotionState::kSlide
                                  : core::MotionState::kStick;
}

// Returns the word of --format, which is also the one of the truth file.
std::string_view Word(ClipFormat format) {
  switch (format) {
    case ClipFormat::kMraw:
      return "mraw";
    case ClipFormat::kPng:
      return "png";
    case ClipFormat::kTiff:
      return "tiff";
    case ClipFormat::kMp4:
      return "mp4";
  }
  return "?";
}

// Returns where the clip goes: a file, or for images a folder of the shot's
// name.
std::filesystem::path ClipPath(const Shot& shot,
                               const SimulateOptions& options) {
  std::filesystem::path base = options.folder / shot.name;
  switch (options.format) {
    case ClipFormat::kMraw:
      return base.string() + ".mraw";
    case ClipFormat::kMp4:
      return base.string() + ".mp4";
    case ClipFormat::kPng:
    case ClipFormat::kTiff:
      break;
  }
  return base;
}

// The name becomes that of files: a slash or dots would lead out of the folder.
// Throws std::invalid_argument.
void CheckName(const std::string& name) {
  const bool good =
      !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
               (c >= '0' && c <= '9') || c == '-' || c == '_';
      });
  if (!good) {
    throw std::invalid_argument(fmt::format(
        "name is '{}', must be of letters, digits, '-' and '_' only", name));
  }
}

// A stream of noise of its own for each name, so that a shot's clip does not
// depend on which others are made with it.
std::mt19937_64 NoiseEngine(std::uint64_t seed, const std::string& name) {
  std::vector<std::uint32_t> words{static_cast<std::uint32_t>(seed),
                                   static_cast<std::uint32_t>(seed >> 32)};
  for (const char c : name) words.push_back(static_cast<unsigned char>(c));
  std::seed_seq sequence(words.begin(), words.end());
  return std::mt19937_64(sequence);
}

// Writes the frames that `next` gives until it gives none. The file has its
// name only when it is complete. A folder of images keeps no frame rate.
void WriteClip(const std::filesystem::path& path, ClipFormat format, double fps,
               const vision::FrameSource& next) {
  switch (format) {
    case ClipFormat::kMraw: {
      vision::MrawOptions mraw;
      mraw.fps = fps;
      vision::WriteMraw(path, mraw, next);
      return;
    }
    case ClipFormat::kMp4: {
      vision::VideoOptions video;
      video.codec = vision::VideoCodec::kH264;
      video.fps = fps;
      vision::WriteVideo(path, video, next);
      return;
    }
    case ClipFormat::kPng:
    case ClipFormat::kTiff: {
      vision::ImageFolderOptions images;
      images.kind = format == ClipFormat::kPng ? vision::ImageKind::kPng
                                               : vision::ImageKind::kTiff;
      vision::WriteImageFolder(path, images, next);
      return;
    }
  }
}

}  // namespace

std::optional<ClipFormat> ParseClipFormat(std::string_view word) {
  for (const ClipFormat format : {ClipFormat::kMraw, ClipFormat::kPng,
                                  ClipFormat::kTiff, ClipFormat::kMp4}) {
    if (word == Word(format)) return format;
  }
  return std::nullopt;
}

analysis::RigidMotionProblem MakeProblem(const Shot& shot) {
  if (shot.frames < 1) {
    throw std::invalid_argument(
        fmt::format("frames is {}, must be at least 1", shot.frames));
  }
  if (shot.lead_in_frames < 0 || shot.lead_in_frames >= shot.frames) {
    throw std::invalid_argument(
        fmt::format("lead_in_frames is {}, must be from 0 to frames - 1 = {}",
                    shot.lead_in_frames, shot.frames - 1));
  }
  analysis::RigidMotionProblem thrown = shot.thrown;
  thrown.start.time_s =
      static_cast<double>(shot.lead_in_frames) / shot.camera.fps;
  // To the end of the last frame's exposure, and of a clip of one frame.
  thrown.end_s = LastFrame_s(shot) + 1.0 / shot.camera.fps;
  return thrown;
}

ShotTruth ComputeTruth(const Shot& shot) {
  ShotTruth truth;
  const analysis::RigidMotionProblem thrown = MakeProblem(shot);
  // The truth is that of what was filmed: a body that rises after the last
  // frame has not bounced here, as a camera would see it.
  const double last_s = LastFrame_s(shot);
  truth.motion = analysis::SimulateRigidMotion(thrown);
  if (!truth.motion.complete) {
    throw std::invalid_argument(
        "thrown: so many contacts that the motion cannot be followed to the "
        "last frame; give fewer frames or a smaller restitution");
  }
  truth.bounce_height_m =
      shot.bounce_height_m
          ? *shot.bounce_height_m
          : core::DefaultBounceHeight(core::Size(thrown.body)->value);
  const auto touchdown = analysis::FirstTouchdown(truth.motion);
  // Without a touchdown the state stays undecided.
  if (!touchdown || touchdown->time_s > last_s) return truth;
  truth.touchdown = touchdown;
  truth.greatest =
      analysis::ComputeGreatestGap(truth.motion, touchdown->time_s, last_s);
  if (truth.greatest.gap_m > truth.bounce_height_m) {
    truth.state = core::MotionState::kBounce;
  } else {
    truth.state = TrueState(truth.motion, *touchdown, last_s);
    // The body left the ground, but did not reach the bounce height.
    truth.micro_bounce = truth.greatest.gap_m > kLeft_m;
  }
  return truth;
}

vision::Scene BuildScene(const Shot& shot,
                         const analysis::RigidMotion& motion) {
  vision::Scene scene;
  scene.body = shot.thrown.body;
  scene.frames = shot.frames;
  scene.camera = shot.camera;
  scene.look = shot.look;
  scene.trouble = shot.trouble;
  scene.noise = shot.noise;
  const auto shared = std::make_shared<const analysis::RigidMotion>(motion);
  // Exposures are no longer than a frame: none sees it come into sight.
  const double appears_s =
      (static_cast<double>(shot.lead_in_frames) - 0.5) / shot.camera.fps;
  // The scene may outlive `motion`, so the function shares a copy of it.
  scene.pose = [shared, appears_s](double time_s) {
    constexpr double kOutOfSight_m = 1e4;
    if (time_s < appears_s) return vision::ScenePose{{0.0, kOutOfSight_m}, 0.0};
    const analysis::BodyState state = analysis::ComputeState(*shared, time_s);
    return vision::ScenePose{state.centre, state.angle_rad};
  };
  return scene;
}

SimulatedClip WriteShot(const Shot& shot, const SimulateOptions& options) {
  CheckName(shot.name);
  SimulatedClip out;
  out.truth = ComputeTruth(shot);
  // The renderer is made before any file or folder: a scene that cannot be
  // rendered leaves nothing behind.
  const vision::SceneRenderer renderer(BuildScene(shot, out.truth.motion));
  out.clip = ClipPath(shot, options);
  out.truth_file = TruthPath(out.clip);

  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (error) {
    throw core::OutputError(fmt::format("{}: cannot be made a folder: {}",
                                        options.folder.string(),
                                        error.message()));
  }
  // What an older run left is put aside until the new clip stands, not removed:
  // a disk that is full must not cost the old clip its truth.
  const bool had_truth = std::filesystem::exists(out.truth_file, error);
  const std::string truth =
      TruthText(shot, out.truth, out.clip.filename().string(),
                std::string(Word(options.format)), options.seed);
  // A clip without its truth would pass for a recording: the truth comes first,
  // when all of the clip is rendered, and neither without the other.
  std::optional<core::AllOrNothing> together;
  std::optional<core::TemporaryName> aside;  // of the older truth
  std::mt19937_64 engine = NoiseEngine(options.seed, shot.name);
  std::int64_t index = 0;
  vision::SensorImage image;
  const auto next = [&]() -> std::optional<core::Frame> {
    // The writer asks once more after the last frame; here all is rendered, and
    // the file is about to take its name.
    if (index == shot.frames) {
      if (!together) {
        together.emplace();
        if (had_truth) {
          aside.emplace(out.truth_file);
          std::filesystem::rename(out.truth_file, aside->path());
        }
        report::WriteTextFile(out.truth_file, truth);
      }
      return std::nullopt;
    }
    if (options.progress) {
      options.progress(static_cast<double>(index) /
                       static_cast<double>(shot.frames));
    }
    image = vision::RenderFrame(renderer, index++, engine);
    return image.view();
  };
  try {
    WriteClip(out.clip, options.format, shot.camera.fps, next);
  } catch (...) {
    // An older clip of that name is still there: its truth goes back to it,
    // which takes no space.
    if (aside) {
      std::filesystem::rename(aside->path(), out.truth_file, error);
    } else if (!had_truth) {
      std::filesystem::remove(out.truth_file, error);
    }
    throw;
  }
  return out;
}

}  // namespace touchdown::pipeline
