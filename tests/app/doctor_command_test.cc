// touchdown doctor: each thing that can be wrong is made wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/pipeline/film_file.h"
#include "tests/support/program.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/calib/calibration_file.h"

namespace touchdown::cli {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class Doctor : public ::testing::Test {
 protected:
  // `before`: variables of the environment, as for env(1).
  testing::ProgramResult Run(std::vector<std::string> arguments,
                             std::vector<std::string> before = {}) const {
    std::vector<std::string> all{"/usr/bin/env"};
    all.insert(all.end(), before.begin(), before.end());
    all.insert(all.end(), {TOUCHDOWN_BINARY, "doctor"});
    all.insert(all.end(), arguments.begin(), arguments.end());
    return testing::RunProgram(std::move(all), folder_.path().string());
  }

  const testing::TemporaryFolder folder_;
};

TEST_F(Doctor, SaysWhatIsThereAndEndsByIt) {
  const auto ran = Run({});
  EXPECT_EQ(ran.err, "");
  const bool trouble = ran.out.find("TROUBLE") != std::string::npos;
  EXPECT_EQ(ran.status, trouble ? 3 : 0) << ran.out;
  EXPECT_THAT(ran.out,
              AllOf(ContainsRegex("good     program      [0-9]+\\.[0-9]+"),
                    HasSubstr("libc.so"), HasSubstr("mjpeg"), HasSubstr("h264"),
                    HasSubstr("a process of its own"), HasSubstr("GB free"),
                    ContainsRegex("clock        20[0-9][0-9]-")));
}

TEST_F(Doctor, IsOneDocument) {
  const auto ran = Run({"--json"});
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json.at("schema"), "touchdown.doctor/1");
  for (const auto& finding : json.at("findings")) {
    EXPECT_THAT(finding.at("health").get<std::string>(),
                ContainsRegex("^(good|note|TROUBLE)$"));
    EXPECT_NE(finding.at("text"), "") << finding;
  }
}

TEST_F(Doctor, MissesLibav) {
  folder_.Write("libavcodec.so.59", "not a library");
  const auto ran = Run({}, {"LD_LIBRARY_PATH=" + folder_.path().string()});
  EXPECT_EQ(ran.status, 3);
  EXPECT_THAT(ran.out, ContainsRegex("TROUBLE  video .*libavcodec.so.59"));
}

TEST_F(Doctor, MissesPrograms) {
  const auto ran = Run({}, {"PATH=" + folder_.path().string()});
  EXPECT_EQ(ran.status, 3);
  EXPECT_THAT(ran.out, AllOf(HasSubstr("TROUBLE  gnuplot "),
                             HasSubstr("install the package gnuplot-nox"),
                             HasSubstr("note     xdg-open ")));
}

TEST_F(Doctor, LooksAtTheStore) {
  const std::string store = (folder_ / "lab.db").string();
  testing::RunProgram("campaign new asphalt --db " + store +
                      " --body sphere --diameter-mm 40");
  EXPECT_THAT(Run({"--db", store}).out,
              ContainsRegex("good     store .*0 trials in 1 campaigns"));
  folder_.Write("lab.db", "not a store");
  const auto damaged = Run({"--db", store});
  EXPECT_EQ(damaged.status, 3);
  EXPECT_THAT(damaged.out, ContainsRegex("TROUBLE  store .*lab.db"));
}

TEST_F(Doctor, OpensTheNewestRecording) {
  pipeline::filmed::WriteSphere(folder_ / "shot.mraw", 25.0, 1);
  EXPECT_THAT(
      Run({"--recordings", folder_.path().string()}).out,
      AllOf(ContainsRegex("recordings .*shot.mraw: mraw, 240x120 px, 8 bits, "
                          "115 frames, 1000 frames/s \\(header\\)"),
            Not(HasSubstr("camera clock"))));
  for (const char* name : {"shot.mraw", "shot.cih", "shot.cihx"}) {
    if (!std::filesystem::exists(folder_ / name)) continue;
    std::filesystem::last_write_time(
        folder_ / name,
        std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  }
  EXPECT_THAT(Run({"--recordings", folder_.path().string()}).out,
              ContainsRegex("note     camera clock .*dated 59 minutes after"));
}

// Images tell no frame rate, and can be looked at all the same.
TEST_F(Doctor, OpensAFolderOfImages) {
  pipeline::filmed::WriteImages(folder_ / "shot", 25.0, 1);
  const auto ran = Run({"--recordings", folder_.path().string()});
  EXPECT_THAT(ran.out,
              ContainsRegex("note     recordings .*shot: png-folder, 240x120 "
                            "px, 8 bits, 115 frames, no frame rate"));
  EXPECT_THAT(ran.out, HasSubstr("--fps"));
}

TEST_F(Doctor, SaysThatNothingWasRecorded) {
  const auto none = Run({"--recordings", folder_.path().string()});
  EXPECT_THAT(none.out, ContainsRegex("note     recordings .*none is there"));
  const auto absent = Run({"--recordings", (folder_ / "absent").string()});
  EXPECT_EQ(absent.status, 3);
  EXPECT_THAT(absent.out, HasSubstr("TROUBLE  recordings"));
}

TEST_F(Doctor, SaysThatTheCalibrationIsOld) {
  calib::Calibration camera;
  camera.camera = "left";
  camera.date = "2019-01-01";
  camera.expires = "2020-01-01";
  camera.picture.width_px = 640;
  camera.picture.height_px = 400;
  camera.scale = calib::ScaleRecord{{1000.0, 1.0}, 0.1, std::nullopt};
  const auto file = folder_ / "camera.json";
  calib::WriteCalibration(file, camera);
  // --camera is the flag's earlier name.
  for (const char* flag : {"--calibration", "--camera"}) {
    EXPECT_THAT(Run({flag, file.string()}).out,
                ContainsRegex("note     camera .*left, 640x400 px, scale; of "
                              "2019-01-01, valid until 2020-01-01"))
        << flag;
  }
}

}  // namespace
}  // namespace touchdown::cli
