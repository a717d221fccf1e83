// touchdown simulate: renders clips whose truth is known, from a scene file or
// for the 18 shots of the paper's Table 1.
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/progress.h"
#include "app/simulate/scene_file.h"
#include "app/simulate/simulate.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed; exactly one of `scene`, `table1` and `example` is
// meant.
struct SimulateFlags {
  std::string scene;
  bool table1 = false;
  bool example = false;
  std::string out;
  std::string format = "mraw";
  std::uint64_t seed = 1;
  bool json = false;
};

// Returns one line for a person: the clip's path, the angles at touchdown in
// degrees, the state, and how far the greatest gap is from the bounce height.
std::string ClipLine(const pipeline::SimulatedClip& made) {
  const auto& truth = made.truth;
  if (!truth.touchdown) {
    return fmt::format("{}  no contact", made.clip.string());
  }
  const auto& t = *truth.touchdown;
  std::string angles =
      fmt::format("approach {:.2f} deg", t.approach_angle_rad / core::kDegree);
  if (t.face_angle_rad) {
    angles +=
        fmt::format(", face {:.2f} deg, radius {:.2f} deg {}",
                    *t.face_angle_rad / core::kDegree,
                    *t.radius_angle_rad / core::kDegree, core::Name(*t.corner));
  }
  return fmt::format(
      "{}  {}  {}  greatest gap {:.3f} mm, bounce height {:.3f} mm",
      made.clip.string(), angles, core::Name(truth.state),
      truth.greatest.gap_m / core::kMillimetre,
      truth.bounce_height_m / core::kMillimetre);
}

// Renders the shots into --out and lists them as text or touchdown.simulate/1.
// Returns 0; throws std::invalid_argument for flags, core::InputError for a
// scene that is wrong.
int RunSimulate(const SimulateFlags& flags) {
  if (flags.example) {
    fmt::print("{}", pipeline::SceneText(pipeline::ExampleShot()));
    return 0;
  }
  // Both or neither was given.
  if (flags.table1 == !flags.scene.empty()) {
    throw std::invalid_argument(
        "simulate: give either a SCENE.json or --table1 (--example prints a "
        "scene)");
  }
  if (flags.out.empty()) {
    throw std::invalid_argument(
        "simulate: --out is missing, must be the folder for the clips");
  }
  const auto format = pipeline::ParseClipFormat(flags.format);
  if (!format) {
    throw std::invalid_argument("--format is '" + flags.format +
                                "', must be mraw, png, tiff or mp4");
  }
  // The scene is read, and found right, before the first clip is written.
  const std::vector<pipeline::Shot> shots =
      flags.table1
          ? pipeline::Table1Shots()
          : std::vector<pipeline::Shot>{pipeline::ReadSceneFile(flags.scene)};
  ProgressBar bar("simulate");
  nlohmann::ordered_json clips = nlohmann::ordered_json::array();
  // What is printed waits until all clips are there, so that the progress bar
  // stays in one line.
  std::string lines;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    pipeline::SimulateOptions options;
    options.folder = flags.out;
    options.format = *format;
    options.seed = flags.seed;
    options.progress = [&](double share) {
      bar.Show((static_cast<double>(i) + share) /
               static_cast<double>(shots.size()));
    };
    const pipeline::SimulatedClip made = pipeline::WriteShot(shots[i], options);
    clips.push_back(
        {{"clip", made.clip.string()}, {"truth", made.truth_file.string()}});
    lines += ClipLine(made) + "\n";
  }
  bar.Finish();
  if (flags.json) {
    const nlohmann::ordered_json document{{"schema", "touchdown.simulate/1"},
                                          {"clips", clips}};
    fmt::print("{}\n",
               document.dump(1, ' ', false,
                             nlohmann::ordered_json::error_handler_t::replace));
  } else {
    fmt::print("{}", lines);
  }
  return 0;
}

}  // namespace

void AddSimulate(CLI::App& app, Action& action) {
  auto flags = std::make_shared<SimulateFlags>();
  CLI::App* command = AddCommand(app, "simulate", "Footage with known truth");
  AddOption(*command, "SCENE", flags->scene,
            "a scene, JSON of schema touchdown.scene/1");
  AddFlag(*command, "--table1", flags->table1,
          "the 18 clips of the paper's Table 1");
  AddFlag(*command, "--example", flags->example, "print a scene and end");
  AddOption(*command, "--out", flags->out,
            "folder for the clips and, beside each, its NAME.truth.json");
  AddOption(*command, "--format", flags->format,
            "mraw, png, tiff (folders of images) or mp4 (8 bit, lossy)")
      .ShowDefault();
  AddOption(*command, "--seed", flags->seed, "of the sensor noise")
      .ShowDefault();
  AddFlag(*command, "--json", flags->json, "one JSON document on stdout");
  SetAction(*command, action, [flags] { return RunSimulate(*flags); });
}

}  // namespace touchdown::cli
