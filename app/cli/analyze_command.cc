#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "app/cli/calibrate_file.h"
#include "app/cli/command.h"
#include "app/cli/dates.h"
#include "app/cli/progress.h"
#include "app/cli/values.h"
#include "app/pipeline/analysis_text.h"
#include "app/pipeline/analyze.h"
#include "app/pipeline/evidence.h"
#include "app/pipeline/log_analysis.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

struct Flags {
  std::string clip;
  std::string calibration;
  std::string crop;
  std::string scale;
  std::string body = "auto";
  std::string diameter;
  std::string sides;
  std::optional<double> fps;
  std::string ground;
  double ground_u_px = 0.5;
  std::string frames;
  std::string region;
  std::string angle_kind;
  std::optional<double> bounce_height_mm;
  std::string out;
  std::string db;
  std::string campaign;
  bool json = false;
};

// What a ruler or a caliper is good for, where nobody says otherwise.
constexpr double kDefaultRelativeU = 1e-3;

pipeline::AnalyzeOptions ToOptions(const Flags& flags) {
  pipeline::AnalyzeOptions options;
  options.fps = flags.fps;
  if (!flags.calibration.empty()) {
    options.calibration = calib::ReadCalibration(flags.calibration);
    options.today = Today();
  }
  if (!flags.crop.empty()) options.crop = ParseCorner("--crop", flags.crop);
  if (!flags.scale.empty()) {
    options.scale_px_per_m =
        ParseEstimate("--scale-px-per-m", flags.scale, 1.0, kDefaultRelativeU);
  }
  if (flags.body != "auto") {
    options.body_kind = core::ParseBodyKind(flags.body);
    if (!options.body_kind) {
      throw std::invalid_argument("--body is '" + flags.body +
                                  "', must be sphere, rectangle or auto");
    }
  }
  if (!flags.diameter.empty()) {
    options.diameter_m = ParseEstimate("--diameter-mm", flags.diameter,
                                       core::kMillimetre, kDefaultRelativeU);
  }
  if (!flags.sides.empty()) {
    std::tie(options.long_m, options.short_m) = ParseSides(
        "--sides-mm", flags.sides, core::kMillimetre, kDefaultRelativeU);
  }
  if (!flags.ground.empty()) {
    const auto n = ParseNumbers("--ground", flags.ground, 4,
                                "two points X1,Y1,X2,Y2 in pixels");
    options.ground =
        calib::GroundThrough({n[0], n[1]}, {n[2], n[3]}, flags.ground_u_px);
  }
  if (!flags.frames.empty()) {
    std::tie(options.first_frame, options.last_frame) =
        ParseFrames("--frames", flags.frames);
  }
  if (!flags.region.empty()) {
    const auto n = ParseNumbers("--region", flags.region, 4,
                                "X,Y,W,H in whole pixels, W and H positive");
    options.region = {
        static_cast<std::int32_t>(n[0]), static_cast<std::int32_t>(n[1]),
        static_cast<std::int32_t>(n[2]), static_cast<std::int32_t>(n[3])};
    if (options.region.width < 1 || options.region.height < 1) {
      throw std::invalid_argument("--region is '" + flags.region +
                                  "', its width and height must be positive");
    }
  }
  if (!flags.angle_kind.empty()) {
    options.angle_kind = core::ParseAngleKind(flags.angle_kind);
    if (!options.angle_kind) {
      throw std::invalid_argument("--angle-kind is '" + flags.angle_kind +
                                  "', must be approach, radius or face");
    }
  }
  if (flags.bounce_height_mm) {
    options.bounce_height_m = *flags.bounce_height_mm * core::kMillimetre;
  }
  return options;
}

int Run(const Flags& flags) {
  pipeline::AnalyzeOptions options = ToOptions(flags);
  if (flags.db.empty() && !flags.campaign.empty()) {
    throw std::invalid_argument("--campaign needs --db, the store it is in");
  }
  if (!flags.campaign.empty()) {
    pipeline::FillFromCampaign(flags.db, flags.campaign, options);
  }
  ProgressBar bar("analyze");
  options.progress = [&bar](double share) { bar.Show(share); };
  const pipeline::Analysis analysis = pipeline::Analyze(flags.clip, options);
  bar.Finish();
  if (!flags.out.empty()) pipeline::WriteEvidence(analysis, options, flags.out);
  std::optional<pipeline::Logged> logged;
  if (!flags.db.empty()) {
    logged = pipeline::LogAnalysis(analysis, flags.db, flags.campaign);
  }
  if (flags.json) {
    fmt::print("{}\n", pipeline::ToJson(analysis));
  } else {
    fmt::print("{}", pipeline::ToText(analysis));
    if (logged) {
      fmt::print("logged     trial {} revision {} in {}\n", logged->trial_id,
                 logged->revision, flags.db);
    }
  }
  return 0;
}

}  // namespace

void AddAnalyze(CLI::App& app, Action& action) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand(
      "analyze",
      "At what angle did it touch down, and did it slide or bounce?");
  command
      ->add_option("CLIP", flags->clip,
                   "a video, an .mraw (or its .cih/.cihx), or a folder of "
                   "PNG, TIFF or JPEG images")
      ->required();
  command->add_option("--calibration", flags->calibration,
                      "a file of `touchdown calibrate`: the lens, and scale "
                      "and ground where they are in it and not given here");
  command->add_option("--crop", flags->crop,
                      "where the picture lies on the calibrated sensor, X,Y in "
                      "pixels, where the file does not say");
  command->add_option("--scale-px-per-m", flags->scale,
                      "pixels per metre in the plane of travel, e.g. 1000 or "
                      "1000+-0.8 (u 0.1 % where not given)");
  command->add_option("--body", flags->body, "sphere, rectangle or auto");
  command->add_option("--diameter-mm", flags->diameter,
                      "the sphere's, e.g. 40 or 40+-0.02; tells the scale too");
  command->add_option("--sides-mm", flags->sides,
                      "the rectangle's in the image plane, e.g. 60x20; tells "
                      "the scale too");
  command->add_option("--fps", flags->fps,
                      "frames per second of the recording, not of playback");
  command->add_option("--ground", flags->ground,
                      "ground line through two points, X1,Y1,X2,Y2 in pixels");
  command
      ->add_option("--ground-u-px", flags->ground_u_px,
                   "standard uncertainty of each of these points, px")
      ->capture_default_str();
  command->add_option("--frames", flags->frames,
                      "only frames A up to but not including B, as A:B");
  command->add_option("--region", flags->region,
                      "search only this part of the picture, X,Y,W,H");
  command->add_option("--angle-kind", flags->angle_kind,
                      "the contact angle: approach, radius or face (default: "
                      "approach for spheres, radius for rectangles)");
  command->add_option("--bounce-height-mm", flags->bounce_height_mm,
                      "rising above it is what bounce means (default: the "
                      "larger of 0.5 mm and 2 % of the body's size)");
  command->add_option(
      "--out", flags->out,
      "write track.csv, contact.png and analysis.json into this folder");
  command->add_option("--db", flags->db, "log the trial in this store");
  command->add_option(
      "--campaign", flags->campaign,
      "the campaign the trial belongs to (with --db); body, sizes, "
      "angle kind and bounce height are then the campaign's "
      "where not given");
  command->add_flag("--json", flags->json, "one JSON document on stdout");
  command->callback(
      [flags, &action] { action = [flags] { return Run(*flags); }; });
}

}  // namespace touchdown::cli
