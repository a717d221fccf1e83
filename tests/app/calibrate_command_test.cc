// touchdown calibrate, run as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/board_files.h"
#include "tests/support/run_program.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::ReadAll;
using testing::RunProgram;
using testing::SmallLens;
using ::testing::StartsWith;
using testing::TemporaryFolder;
using testing::WriteBoardPictures;

// One line on stderr, the status, and no file.
void ExpectRefused(const std::string& arguments, int status,
                   const std::string& what, const std::filesystem::path& out) {
  const auto ran = RunProgram("calibrate " + arguments);
  EXPECT_EQ(ran.status, status) << arguments;
  EXPECT_THAT(ran.err, StartsWith("touchdown: ")) << arguments;
  EXPECT_THAT(ran.err, HasSubstr(what)) << arguments;
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  EXPECT_EQ(ran.out, "");
  EXPECT_FALSE(std::filesystem::exists(out)) << arguments;
}

TEST(CalibrateLensCommand, MakesAFileThatAnalyzeTakes) {
  const TemporaryFolder folder;
  const auto pictures = folder.path() / "pictures";
  std::filesystem::create_directory(pictures);
  WriteBoardPictures(pictures, 9);
  const auto out = folder.path() / "camera.json";
  const auto ran = RunProgram(
      "calibrate lens " + pictures.string() +
      " --board chessboard:7x5:20mm --camera test --date 2026-01-31 --out " +
      out.string() + " --json");
  ASSERT_EQ(ran.status, 0) << ran.err;
  const json document = json::parse(ran.out);
  EXPECT_EQ(document["schema"], "touchdown.calibrate.lens/1");
  EXPECT_EQ(document["views"].size(), 9u);
  const auto lens = document["lens"];
  const auto near = [&](const char* name, double truth) {
    EXPECT_NEAR(lens[name]["value"].get<double>(), truth,
                4.0 * lens[name]["u"].get<double>())
        << name;
  };
  near("fx_px", SmallLens().fx_px);
  near("fy_px", SmallLens().fy_px);
  near("cx_px", SmallLens().cx_px);
  near("cy_px", SmallLens().cy_px);
  near("k1", SmallLens().k1);
  const auto file = calib::ReadCalibration(out);
  EXPECT_EQ(file.camera, "test");
  EXPECT_EQ(file.date, "2026-01-31");
  EXPECT_EQ(file.expires, "2027-01-31");
  EXPECT_EQ(file.picture.width_px, 320);

  // A scale, with a check length, goes into the same file.
  const auto scaled =
      RunProgram("calibrate scale " + (pictures / "board_0.png").string() +
                 " --points 40,120,240,120 --length-mm 200+-0.1 --check-points "
                 "140,40,140,140 --check-length-mm 100 --calibration " +
                 out.string() + " --out " + out.string());
  ASSERT_EQ(scaled.status, 0) << scaled.err;
  EXPECT_THAT(scaled.out, HasSubstr("lens undone"));
  EXPECT_THAT(scaled.out, HasSubstr("check      error"));
  const auto both = calib::ReadCalibration(out);
  ASSERT_TRUE(both.lens && both.scale);
  EXPECT_TRUE(both.scale->check_error_m);
  // Its oldest part decides how long the whole is good.
  const auto other = folder.path() / "other.json";
  for (const char* flag : {"--date 2026-03-01", "--valid-days 9"}) {
    ExpectRefused(
        "scale " + (pictures / "board_0.png").string() +
            " --points 40,120,240,120 --length-mm 200 --calibration " +
            out.string() + " --out " + other.string() + " " + flag,
        2, std::string(flag).substr(0, 6), other);
  }

  // A clip of another size is refused.
  const auto refused =
      RunProgram("analyze " + (pictures).string() + " --fps 1000 --crop 9,9 " +
                 "--calibration " + out.string());
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr("reaches beyond what was calibrated"));
}

TEST(CalibrateLensCommand, RefusesInOneLine) {
  const TemporaryFolder folder;
  WriteBoardPictures(folder.path(), 2);
  const auto out = folder.path() / "camera.json";
  const std::string pictures = (folder.path() / "board_0.png").string() + " " +
                               (folder.path() / "board_1.png").string();
  const std::string to = " --out " + out.string();
  ExpectRefused("lens " + pictures + " --board chessboard:7x5:20mm" + to, 3,
                "too few views", out);
  ExpectRefused("lens " + pictures + " --board charuco:7x5:20mm" + to, 2,
                "ChArUco boards cannot be read", out);
  ExpectRefused("lens " + pictures + " --board chess:7x5" + to, 2,
                "must be chessboard:COLUMNSxROWS:SQUARE", out);
  ExpectRefused("lens /nowhere.png --board chessboard:7x5:20mm" + to, 3,
                "/nowhere.png", out);
  ExpectRefused("lens " + pictures +
                    " --board chessboard:7x5:20mm --out "
                    "/nowhere/camera.json",
                3, "too few views", "/nowhere/camera.json");
}

TEST(CalibrateGroundCommand, FromPointsPlumbLineAndPicture) {
  const TemporaryFolder folder;
  WriteBoardPictures(folder.path(), 1);
  const std::string picture = (folder.path() / "board_0.png").string();
  const auto out = folder.path() / "camera.json";
  const std::string to = " --out " + out.string();
  const auto ran = RunProgram("calibrate ground " + picture +
                              " --points 10,200,310,203 --plumb "
                              "160,20,160,180 --date 2026-02-01" +
                              to);
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto file = calib::ReadCalibration(out);
  ASSERT_TRUE(file.ground && file.ground->slope_rad);
  EXPECT_NEAR(file.ground->slope_rad->value, -0.01, 1e-6);
  EXPECT_EQ(file.date, "2026-02-01");
  EXPECT_FALSE(file.lens);
  std::filesystem::remove(out);
  ExpectRefused("ground " + picture + " --board chessboard:7x5:20mm" + to, 2,
                "needs --calibration with a lens", out);
  ExpectRefused("ground " + picture + " --points 1,2,1,2" + to, 2,
                "two different points", out);
  ExpectRefused("scale " + picture +
                    " --points 1,2,30,2 --length-mm 10 "
                    "--check-points 1,2,3,4" +
                    to,
                2, "give both", out);
  ExpectRefused("scale " + picture + " --points 1,2,30 --length-mm 10" + to, 2,
                "--points", out);
  ExpectRefused("ground " + picture + " --sensor-origin 1.5,0" + to, 2,
                "--sensor-origin", out);
}

}  // namespace
}  // namespace touchdown
