// touchdown calibrate scale|ground: things of known length or direction in one
// picture become a scale, a ground line, a slope. Each command begins with the
// file of --calibration, adds its part and writes the whole to --out.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/analyze/calibrate_file.h"
#include "app/cli/options.h"
#include "app/cli/rig/rig_print.h"
#include "app/cli/values.h"
#include "touchdown/calib/ground_lines.h"
#include "touchdown/calib/references.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

// Holds the flags of both commands as typed. Points are "X1,Y1,X2,Y2" in pixels
// of the picture as it is seen, lens not undone.
struct ReferenceFlags {
  CalibrationFileFlags file;
  std::string picture;
  std::int64_t frame = 0;
  double u_point_px = 0.5;
  std::string points, length, check_points, check_length, plumb, board;
  bool json = false;
};

// Holds the picture, the calibration that the command adds to, and its lens;
// without a lens the marked points are taken as they are.
struct Begun {
  StillPicture still;
  calib::Calibration file;
  std::optional<calib::Lens> lens;
};

// Reads picture and calibration. Throws core::InputError where either cannot be
// read, or the calibration is of another picture.
Begun Begin(const ReferenceFlags& flags) {
  Begun begun{ReadPicture(flags.picture, flags.frame), {}, std::nullopt};
  begun.file =
      BeginCalibration(flags.file, DescribePicture(flags.file, begun.still));
  if (begun.file.lens) begun.lens = begun.file.lens->lens;
  return begun;
}

// Writes the calibration to --out, then prints it (--json) or `lines`.
void WriteReference(const ReferenceFlags& flags, const calib::Calibration& file,
                    const std::vector<std::string>& lines) {
  calib::WriteCalibration(flags.file.out, file);
  if (flags.json) {
    fmt::print("{}", calib::CalibrationText(file));
    return;
  }
  for (const std::string& line : lines) fmt::print("{}\n", line);
  fmt::print("written    {}\n", flags.file.out);
}

// Measures the scale in px/m by a known length, and tests it on a second one
// where that is given. Returns 0: a failed test is a warning, since only the
// user knows which of the two lengths is wrong.
int RunScale(const ReferenceFlags& flags) {
  if (flags.check_points.empty() != flags.check_length.empty()) {
    throw std::invalid_argument(
        "--check-points and --check-length-mm go together: give both");
  }
  Begun begun = Begin(flags);
  const auto pair = ParsePair("--points", flags.points, flags.u_point_px);
  const auto length =
      ParseEstimate("--length-mm", flags.length, core::kMillimetre, kPlainSize);
  calib::ScaleRecord scale = calib::MeasureScale(pair, length, begun.lens);
  std::vector<std::string> lines = {
      fmt::format("scale      {} px/m{}", Rounded(scale.px_per_m),
                  begun.lens ? ", lens undone" : "")};
  if (!flags.check_points.empty()) {
    scale.check_error_m = calib::CheckError(
        scale,
        ParsePair("--check-points", flags.check_points, flags.u_point_px),
        ParseEstimate("--check-length-mm", flags.check_length,
                      core::kMillimetre, kPlainSize),
        begun.lens);
    const core::Estimate& error = *scale.check_error_m;
    lines.push_back(fmt::format("check      error {} mm",
                                Rounded(core::Scaled(error, 1e3))));
    // The error and 0 are apart by more than the 95 % interval.
    if (std::abs(error.value) > core::kNormal975 * error.u) {
      lines.emplace_back(
          "warning    the check length does not agree: look at the points, the "
          "lengths, the lens, and whether both lie in the plane of travel");
    }
  } else {
    lines.emplace_back(
        "check      none: give another known length with --check-points and "
        "--check-length-mm");
  }
  begun.file.scale = scale;
  WriteReference(flags, begun.file, lines);
  return 0;
}

// The picture's levels as floats, and the noise of a pixel from differences of
// neighbours in a row (median: edges do not count).
struct FloatPicture {
  std::vector<float> level;
  double noise_dn = 1.0;
};

// Returns the levels row by row, and the noise of one pixel in DN: the median
// absolute difference of neighbours in a row, times 1.4826 to make it a
// standard deviation, over sqrt(2) because two pixels enter each.
FloatPicture Floats(const core::Frame& frame) {
  FloatPicture out;
  std::vector<double> differences;
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    for (std::int32_t x = 0; x < frame.width_px; ++x) {
      out.level.push_back(static_cast<float>(frame.at(x, y)));
      if (x > 0) {
        differences.push_back(
            std::abs(static_cast<double>(out.level.back()) -
                     static_cast<double>(out.level[out.level.size() - 2])));
      }
    }
  }
  if (!differences.empty()) {
    const auto middle = differences.begin() +
                        static_cast<std::ptrdiff_t>(differences.size() / 2);
    // The median alone is wanted: a full sort of all pixels would take longer.
    std::nth_element(differences.begin(), middle, differences.end());
    // Rounding to whole levels alone makes this much noise.
    out.noise_dn = std::max(1.4826 * *middle / std::sqrt(2.0), 0.3);
  }
  return out;
}

// Returns the edge of the picture with most support as the ground line. Throws
// core::InputError where there is none within 20 degrees of level. Its ends are
// in the picture as it is seen, as those are that a person marks.
calib::GroundRecord Detected(const Begun& begun, const std::string& path) {
  const core::Frame frame = begun.still.image.View();
  const FloatPicture picture = Floats(frame);
  calib::GroundLineOptions options;
  options.lens = begun.lens;
  // The lines come by falling support; only the best is used.
  options.most_lines = 1;
  const auto lines = calib::FindGroundLines(
      {picture.level.data(), frame.width_px, frame.height_px, picture.noise_dn},
      options);
  if (lines.empty()) {
    throw core::InputError(fmt::format(
        "{}: no straight edge within 20 degrees of level was found; give "
        "--points X1,Y1,X2,Y2 on the ground line",
        path));
  }
  const calib::GroundLine& line = lines.front();
  const double length =
      std::hypot(line.p2.x_px - line.p1.x_px, line.p2.y_px - line.p1.y_px);
  calib::GroundRecord ground;
  // The line was fitted in the lens's ideal picture; the file keeps points as
  // they are seen.
  const auto seen = [&](core::PixelPoint p) {
    return begun.lens ? calib::Distort(*begun.lens, p) : p;
  };
  ground.p1 = seen(line.p1);
  ground.p2 = seen(line.p2);
  // Two points with this u make a line whose height and direction are at least
  // as uncertain as those of the line found (calib::MakeGroundLine).
  ground.u_point_px = std::max(std::sqrt(2.0) * line.u_offset_px,
                               length * line.u_angle_rad / std::sqrt(2.0));
  return ground;
}

// Takes the ground line from a board or from two marked points, whichever is
// given, else from the picture itself; a plumb line adds the slope. Returns 0.
int RunGround(const ReferenceFlags& flags) {
  if (!flags.points.empty() && !flags.board.empty()) {
    throw std::invalid_argument(
        "both --points and --board are given; the ground is known from one");
  }
  Begun begun = Begin(flags);
  std::vector<std::string> lines;
  calib::GroundRecord ground;
  // Returns an angle with its u in degrees, as "0.52 +- 0.03".
  const auto degrees = [](const core::Estimate& e) {
    return Rounded(core::Scaled(e, 1.0 / core::kDegree));
  };
  // The board tells the yaw of the plane and the scale besides the line. Its
  // pose needs the lens: without it the pose would absorb the distortion.
  if (!flags.board.empty()) {
    if (!begun.lens) {
      throw std::invalid_argument(
          "--board needs --calibration with a lens: make one with `touchdown "
          "calibrate lens`");
    }
    const calib::Board board = calib::ParseBoard(flags.board);
    const auto points = calib::FindBoard(begun.still.image.View(), board);
    if (!points) {
      throw core::InputError(
          fmt::format("{}: {}; lay the board so that all of it is seen",
                      flags.picture, points.error().reason));
    }
    const auto located = calib::LocateBoard(*points, board, *begun.lens);
    if (!located) {
      throw core::InputError(
          fmt::format("{}: {}", flags.picture, located.error().reason));
    }
    ground = located->ground;
    calib::ScaleRecord scale;
    scale.px_per_m = located->px_per_m;
    // The length that the scale rests on is the middle row of the board.
    scale.length_m = board.pitch_m * (board.columns - 1);
    begun.file.scale = scale;
    lines.push_back(
        fmt::format("yaw        {} deg; seen lengths along the ground are "
                    "{:.3f} % short",
                    degrees(*ground.yaw_rad),
                    100.0 * (1.0 - std::cos(ground.yaw_rad->value))));
    lines.push_back(
        fmt::format("pitch      {} deg, down", degrees(located->pitch_rad)));
    lines.push_back(fmt::format("scale      {} px/m along the middle row",
                                Rounded(located->px_per_m)));
    lines.push_back(fmt::format("rms        {:.3f} px", located->rms_px));
  } else if (!flags.points.empty()) {
    const auto pair = ParsePair("--points", flags.points, flags.u_point_px);
    ground.p1 = pair.p1;
    ground.p2 = pair.p2;
    ground.u_point_px = flags.u_point_px;
  } else {
    ground = Detected(begun, flags.picture);
  }
  // Only marked points can coincide; the direction would be undefined.
  if (ground.p1 == ground.p2) {
    throw std::invalid_argument(fmt::format(
        "--points is '{}', must be two different points", flags.points));
  }
  // The ground may slope; gravity in the plane frame follows from it.
  if (!flags.plumb.empty()) {
    ground.slope_rad = calib::MeasureSlope(
        {ground.p1, ground.p2, ground.u_point_px},
        ParsePair("--plumb", flags.plumb, flags.u_point_px), begun.lens);
    lines.push_back(
        fmt::format("slope      {} deg, positive: rises to the "
                    "right",
                    degrees(*ground.slope_rad)));
  }
  // The ground line heads the output, whatever it was found from.
  lines.insert(
      lines.begin(),
      fmt::format("ground     ({:.2f}, {:.2f}) to ({:.2f}, {:.2f}) px, "
                  "each +- {:.3f} px",
                  ground.p1.x_px, ground.p1.y_px, ground.p2.x_px,
                  ground.p2.y_px, ground.u_point_px));
  begun.file.ground = ground;
  WriteReference(flags, begun.file, lines);
  return 0;
}

// Adds the flags that `scale` and `ground` have in common.
void AddPictureFlags(CLI::App& command, ReferenceFlags& flags) {
  AddOption(command, "PICTURE", flags.picture,
            "a picture, or a clip of which one frame is looked at")
      .Require();
  AddOption(command, "--frame", flags.frame, "of a clip").ShowDefault();
  AddOption(command, "--u-point-px", flags.u_point_px,
            "standard uncertainty of each marked point, px")
      .ShowDefault();
  AddFileFlags(command, flags.file, true);
  AddFlag(command, "--json", flags.json, "the calibration file on stdout");
}

}  // namespace

void AddCalibrateScale(CLI::App& calibrate, Action& action) {
  auto flags = std::make_shared<ReferenceFlags>();
  CLI::App* command = AddCommand(
      calibrate, "scale",
      "pixels per metre, from a known length in the plane of travel");
  AddPictureFlags(*command, *flags);
  AddOption(*command, "--points", flags->points,
            "its two ends, X1,Y1,X2,Y2 in pixels")
      .Require();
  AddOption(*command, "--length-mm", flags->length,
            "the length, e.g. 500 or 500+-0.2 (u 0.1 % where not given)")
      .Require();
  AddOption(*command, "--check-points", flags->check_points,
            "the ends of another known length");
  AddOption(*command, "--check-length-mm", flags->check_length,
            "that length; how far the scale is off it is reported");
  SetAction(*command, action, [flags] { return RunScale(*flags); });
}

void AddCalibrateGround(CLI::App& calibrate, Action& action) {
  auto flags = std::make_shared<ReferenceFlags>();
  CLI::App* command =
      AddCommand(calibrate, "ground",
                 "the ground line: two points, a board that lies on it, or "
                 "(neither given) the straightest edge in the picture");
  AddPictureFlags(*command, *flags);
  AddOption(*command, "--points", flags->points,
            "two points on it, X1,Y1,X2,Y2 in pixels");
  AddOption(*command, "--board", flags->board,
            "a board flat on the ground, rows along the direction of travel, "
            "middle row under the body's path: tells the plane's yaw and the "
            "scale, too; needs --calibration");
  AddOption(*command, "--plumb", flags->plumb,
            "a plumb line, X1,Y1,X2,Y2 in pixels: tells the ground's slope, "
            "and so the direction of gravity");
  SetAction(*command, action, [flags] { return RunGround(*flags); });
}

}  // namespace touchdown::cli
