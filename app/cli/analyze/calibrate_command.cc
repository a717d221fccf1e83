// touchdown calibrate lens makes a lens of pictures of a board, in a dated
// calibration file. `scale` and `ground` are in calibrate_references.cc, the
// flags and the file that all three share in calibrate_file.cc.
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/analyze/calibrate_file.h"
#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/progress.h"
#include "app/cli/rig/rig_print.h"
#include "app/measure/board_pictures.h"
#include "touchdown/calib/board.h"
#include "touchdown/calib/lens_calibration.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

// `board` is as typed, "chessboard:9x6:25mm"; `images` are files and folders.
struct LensFlags {
  CalibrationFileFlags file;
  std::vector<std::string> images;
  std::string board;
  bool json = false;
};

// Returns the pictures to look at: each file as it was given, each folder as
// the pictures in it, by name.
std::vector<std::filesystem::path> Expanded(
    const std::vector<std::string>& arguments) {
  std::vector<std::filesystem::path> images;
  for (const std::string& argument : arguments) {
    if (!std::filesystem::is_directory(argument)) {
      images.emplace_back(argument);
      continue;
    }
    const auto inside = pipeline::ListPictures(argument);
    images.insert(images.end(), inside.begin(), inside.end());
  }
  return images;
}

// Finds the board in each picture. Throws core::InputError where no picture was
// given, one cannot be read, or their sizes differ; a picture that shows no
// whole board is listed in `without` and left out of the fit.
pipeline::BoardPictures FindInPictures(const LensFlags& flags,
                                       const calib::Board& board) {
  const auto images = Expanded(flags.images);
  if (images.empty()) {
    throw core::InputError(
        fmt::format("{}: holds no PNG, TIFF or JPEG picture; give pictures of "
                    "the board",
                    flags.images.front()));
  }
  // --sensor-origin takes precedence over what the files say.
  std::optional<calib::SensorCorner> corner;
  if (!flags.file.sensor_origin.empty()) {
    corner = ParseCorner("--sensor-origin", flags.file.sensor_origin);
  }
  ProgressBar bar("calibrate");
  auto found = pipeline::FindBoards(images, board, corner,
                                    [&bar](double share) { bar.Show(share); });
  bar.Finish();
  return found;
}

// Returns the touchdown.calibrate.lens/1 document: each number of the lens with
// its u, how well the views fit, and the calibration file itself. Lengths are
// px, angles deg.
nlohmann::ordered_json LensJson(const pipeline::BoardPictures& found,
                                const calib::LensCalibration& lens,
                                const calib::Calibration& file) {
  nlohmann::ordered_json json;
  json["schema"] = "touchdown.calibrate.lens/1";
  for (int i = 0; i < calib::kLensParameters; ++i) {
    const core::Estimate e = lens.Parameter(i);
    json["lens"][calib::kLensNames[static_cast<std::size_t>(i)]] = {
        {"value", e.value}, {"u", e.u}};
  }
  json["rms_px"] = lens.rms_px;
  json["u_corner_px"] = lens.u_corner_px;
  json["widened"] = lens.widened;
  json["coverage"] = lens.coverage;
  json["cells"] = {{"columns", calib::kCoverageColumns},
                   {"rows", calib::kCoverageRows},
                   {"corners", lens.cells}};
  for (const calib::ViewResult& view : lens.views) {
    json["views"].push_back({{"name", view.name},
                             {"rms_px", view.rms_px},
                             {"most_px", view.most_px},
                             {"tilt_deg", view.tilt_rad / core::kDegree}});
  }
  json["without_board"] = found.without;
  json["warnings"] = lens.warnings;
  // This is the text that was written to --out: a script need not open that
  // file.
  json["calibration"] =
      nlohmann::ordered_json::parse(calib::CalibrationText(file));
  return json;
}

// Prints the lens for a person: parameters with u, the fit of each view, the
// coverage and the warnings.
void PrintLens(const pipeline::BoardPictures& found,
               const calib::LensCalibration& lens, const calib::Board& board,
               const std::string& out) {
  fmt::print("board      {} in {} of {} pictures of {}x{} px\n",
             calib::Text(board), found.views.size(),
             found.views.size() + found.without.size(), found.picture.width_px,
             found.picture.height_px);
  for (int i = 0; i < calib::kLensParameters; ++i) {
    const std::string name = calib::kLensNames[static_cast<std::size_t>(i)];
    // "cx_px" is shown as "cx ... px"; k1 to k3, p1 and p2 have no unit.
    const bool px = name.ends_with("_px");
    fmt::print("{:<10} {}{}\n", px ? name.substr(0, 2) : name,
               Rounded(lens.Parameter(i)), px ? " px" : "");
  }
  // The displacement in px tells a person more than the parameters do.
  fmt::print("bends      up to {:.2f} px within the picture\n",
             calib::LargestDisplacement(lens.lens, found.picture.width_px,
                                        found.picture.height_px));
  fmt::print(
      "rms        {:.3f} px over {} corners; u of a corner {:.3f} px a "
      "coordinate, lens u widened {:.2f} times by what views have in common\n",
      lens.rms_px,
      lens.views.size() * static_cast<std::size_t>(board.columns) *
          static_cast<std::size_t>(board.rows),
      lens.u_corner_px, lens.widened);
  for (const calib::ViewResult& view : lens.views) {
    fmt::print(
        "view       {:<20} rms {:.3f} px, worst {:.3f} px, tilt {:.0f} "
        "deg\n",
        view.name, view.rms_px, view.most_px, view.tilt_rad / core::kDegree);
  }
  // Pictures that did not count are named, so that they can be taken again.
  for (const std::string& name : found.without) {
    fmt::print("view       {:<20} the board is not seen whole: left out\n",
               name);
  }
  fmt::print("coverage   {:.0f} % of {} x {} cells\n", 100.0 * lens.coverage,
             calib::kCoverageColumns, calib::kCoverageRows);
  for (const std::string& warning : lens.warnings) {
    fmt::print("warning    {}\n", warning);
  }
  fmt::print("written    {}\n", out);
}

// Fits the lens and writes the calibration file. Nothing is written where the
// pictures do not determine a lens (core::InputError with the reason).
int RunLens(const LensFlags& flags) {
  const calib::Board board = calib::ParseBoard(flags.board);
  const pipeline::BoardPictures found = FindInPictures(flags, board);
  const calib::LensCalibration lens =
      pipeline::CalibrateBoardLens(found, board);
  calib::Calibration file = BeginCalibration(flags.file, found.picture);
  file.lens = pipeline::MakeLensRecord(lens, board);
  calib::WriteCalibration(flags.file.out, file);
  if (flags.json) {
    fmt::print("{}\n", LensJson(found, lens, file)
                           .dump(2, ' ', false,
                                 nlohmann::json::error_handler_t::replace));
  } else {
    PrintLens(found, lens, board, flags.file.out);
  }
  return 0;
}

}  // namespace

void AddCalibrate(CLI::App& app, Action& action) {
  CLI::App* calibrate =
      AddCommand(app, "calibrate",
                 "what turns pixels into metres: a dated calibration file");
  RequireSubcommand(*calibrate);
  auto flags = std::make_shared<LensFlags>();
  CLI::App* lens =
      AddCommand(*calibrate, "lens",
                 "the lens's distortion, from ten or more pictures of a board");
  AddOption(*lens, "IMAGES", flags->images,
            "pictures of the board, tilted to different sides, all over the "
            "picture; or a folder of them")
      .Require();
  AddOption(*lens, "--board", flags->board,
            "chessboard:9x6:25mm (inner corners, side of a square), "
            "circles:7x5:20mm or acircles:4x11:20mm (centres)")
      .Require();
  AddFileFlags(*lens, flags->file, false);
  AddFlag(*lens, "--json", flags->json, "one JSON document on stdout");
  SetAction(*lens, action, [flags] { return RunLens(*flags); });
  AddCalibrateScale(*calibrate, action);
  AddCalibrateGround(*calibrate, action);
}

}  // namespace touchdown::cli
