#include "app/cli/analyze/analyze_flags.h"

#include <fmt/format.h>

#include <stdexcept>
#include <tuple>

#include "app/cli/analyze/calibrate_file.h"
#include "app/cli/options.h"
#include "app/cli/values.h"
#include "app/text/dates.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {

// Returns the limit unchanged, in seconds; +infinity stands for no limit.
double ToLimit(double limit_s) {
  // The condition is written so that NaN is refused, too.
  if (!(limit_s > 0.0)) {
    throw std::invalid_argument(fmt::format(
        "--limit-s is {:g}, must be above 0: seconds for one clip", limit_s));
  }
  return limit_s;
}

// Only what concerns one flag alone is checked here. What depends on the clip
// or on two flags together is checked by Analyze(), which the review page calls
// as well.
pipeline::AnalyzeOptions ToOptions(const AnalyzeFlags& flags) {
  pipeline::AnalyzeOptions options;
  options.fps = flags.fps;
  options.gamma = flags.gamma;
  if (!flags.calibration.empty()) {
    // The date is needed besides the file: the analysis warns of a calibration
    // that has expired, and takes no clock of its own.
    options.calibration = calib::ReadCalibration(flags.calibration);
    options.today = pipeline::Today();
  }
  if (!flags.crop.empty()) options.crop = ParseCorner("--crop", flags.crop);
  // A number without "+-u" gets u = 0.1 % (kPlainSize); the same holds for the
  // sizes below.
  if (!flags.scale.empty()) {
    options.scale_px_per_m =
        ParseEstimate("--scale-px-per-m", flags.scale, 1.0, kPlainSize);
  }
  // `auto` leaves body_kind empty: the kind that fits the outlines is taken.
  if (flags.body != "auto") {
    options.body_kind = core::ParseBodyKind(flags.body);
    if (!options.body_kind) {
      throw std::invalid_argument("--body is '" + flags.body +
                                  "', must be sphere, rectangle or auto");
    }
  }
  if (!flags.diameter.empty()) {
    options.diameter_m = ParseEstimate("--diameter-mm", flags.diameter,
                                       core::kMillimetre, kPlainSize);
  }
  // The side that is typed first is taken for the long one.
  if (!flags.sides.empty()) {
    std::tie(options.long_m, options.short_m) =
        ParseSides("--sides-mm", flags.sides, core::kMillimetre, kPlainSize);
  }
  if (!flags.ground.empty()) {
    const auto n = ParseNumbers("--ground", flags.ground, 4,
                                "two points X1,Y1,X2,Y2 in pixels");
    // Both points are equally uncertain, --ground-u-px along the line's normal.
    // Throws where they coincide.
    options.ground =
        calib::MakeGroundLine({n[0], n[1]}, {n[2], n[3]}, flags.ground_u_px);
  }
  if (flags.contact_frame) {
    if (*flags.contact_frame < 0) {
      throw std::invalid_argument("--contact-frame is " +
                                  std::to_string(*flags.contact_frame) +
                                  ", must be a frame, from 0 on");
    }
    options.contact_frame = flags.contact_frame;
  }
  // "18:33" means frames 18 to 32; an open end, "18:", is last_frame = -1.
  if (!flags.frames.empty()) {
    std::tie(options.first_frame, options.last_frame) =
        ParseFrames("--frames", flags.frames);
  }
  if (!flags.region.empty()) {
    options.region = ParseRegion("--region", flags.region);
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
  options.stop_early = flags.stop_early;
  options.limit_s = ToLimit(flags.limit_s);
  return options;
}

// `demo` has this flag of all the flags of analyze: it runs analyses too.
void AddLimitFlag(CLI::App& command, double& limit_s) {
  AddOption(command, "--limit-s", limit_s,
            "an analysis that takes longer is ended, with how far it got "
            "(seconds of wall time for one clip)")
      .ShowDefault();
}

// --help shows the flags in this order: the camera's geometry, the body, time
// and light, the ground, what part of the clip is looked at, and the
// conventions by which the contact is judged.
void AddAnalyzeFlags(CLI::App& command, AnalyzeFlags& flags) {
  AddOption(command, "--calibration", flags.calibration,
            "a file of `touchdown calibrate`: the lens, and scale and ground "
            "where they are in it and not given here");
  AddOption(command, "--crop", flags.crop,
            "where the picture lies on the calibrated sensor, X,Y in pixels, "
            "where the file does not say");
  AddOption(command, "--scale-px-per-m", flags.scale,
            "pixels per metre in the plane of travel, e.g. 1000 or 1000+-0.8 "
            "(u 0.1 % where not given)");
  AddOption(command, "--body", flags.body, "sphere, rectangle or auto");
  AddOption(command, "--diameter-mm", flags.diameter,
            "the sphere's, e.g. 40 or 40+-0.02; tells the scale too");
  AddOption(
      command, "--sides-mm", flags.sides,
      "the rectangle's in the image plane, e.g. 60x20; tells the scale too");
  AddOption(command, "--fps", flags.fps,
            "frames per second of the recording, not of playback");
  AddOption(command, "--gamma", flags.gamma,
            "the camera's: its levels are light to this power (1: a linear "
            "camera; most that make pictures to look at: 0.45); default: what "
            "the outlines say, or unknown: taken for 1, and a size that is not "
            "stated is less certain");
  AddOption(command, "--ground", flags.ground,
            "ground line through two points, X1,Y1,X2,Y2 in pixels");
  AddOption(command, "--ground-u-px", flags.ground_u_px,
            "standard uncertainty of each of these points, px")
      .ShowDefault();
  AddOption(command, "--contact-frame", flags.contact_frame,
            "touchdown is between this frame and the next, whatever else looks "
            "like a blow");
  AddOption(command, "--frames", flags.frames,
            "only frames A up to but not including B, as A:B");
  AddOption(command, "--region", flags.region,
            "search only this part of the picture, X,Y,W,H");
  AddOption(command, "--angle-kind", flags.angle_kind,
            "the contact angle: approach, radius or face (default: approach "
            "for spheres, radius for rectangles)");
  AddOption(command, "--bounce-height-mm", flags.bounce_height_mm,
            "rising above it is what bounce means (default: the larger of 0.5 "
            "mm and 2 % of the body's size)");
  AddFlag(command, "--stop-early", flags.stop_early,
          "decode from the key frame before the body is seen until the first "
          "contact's state is decided beyond doubt; the rest is not looked at "
          "(raw recordings are always looked at whole)");
  AddLimitFlag(command, flags.limit_s);
}

}  // namespace touchdown::cli
