#include "touchdown/calib/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/calib/board_picture.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"

namespace touchdown::calib {
namespace {

using nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Calibration Whole() {
  Calibration c;
  c.camera = "Nova S16, 50 mm";
  c.date = "2026-11-21";
  c.expires = "2027-11-21";
  c.picture = {640, 480, SensorCorner{0, 0}};
  LensRecord lens;
  lens.lens = board_picture::TestLens();
  lens.covariance.diagonal().setConstant(0.01);
  lens.covariance(0, 1) = lens.covariance(1, 0) = 0.0099;
  lens.board = "chessboard:9x6:25mm";
  lens.rms_px = 0.12;
  lens.coverage = 0.83;
  lens.views = {{"a.png", 0.11}, {"b.png", 0.13}};
  c.lens = lens;
  c.scale = ScaleRecord{{1000.25, 0.8, std::nullopt},
                        0.5,
                        core::Estimate{1e-4, 2e-4, std::nullopt}};
  GroundRecord ground;
  ground.p1 = {10.0, 330.2};
  ground.p2 = {600.0, 336.9};
  ground.u_point_px = 0.4;
  ground.slope_rad = core::Estimate{0.01, 0.002, std::nullopt};
  c.ground = ground;
  return c;
}

TEST(CalibrationFile, ReadsWhatItWrites) {
  const testing::TemporaryFolder folder;
  const Calibration c = Whole();
  WriteCalibration(folder / "camera.json", c);
  const Calibration back = ReadCalibration(folder / "camera.json");
  EXPECT_EQ(CalibrationText(back), CalibrationText(c));
  ASSERT_TRUE(back.lens && back.scale && back.ground);
  EXPECT_EQ(back.lens->lens, c.lens->lens);
  EXPECT_EQ(back.lens->covariance, c.lens->covariance);
  EXPECT_EQ(back.picture.corner, c.picture.corner);
  EXPECT_EQ(back.scale->px_per_m, c.scale->px_per_m);
  EXPECT_NEAR(back.ground->slope_rad->value, 0.01, 1e-15);
  EXPECT_FALSE(back.ground->yaw_rad);
  EXPECT_FALSE(std::filesystem::exists(folder / "camera.json.part"));
}

TEST(CalibrationFile, PartsMayBeAbsent) {
  Calibration c = Whole();
  c.lens.reset();
  c.scale.reset();
  c.ground.reset();
  c.picture.corner.reset();
  const Calibration back = ParseCalibration(CalibrationText(c), "text");
  EXPECT_FALSE(back.lens || back.scale || back.ground || back.picture.corner);
}

// One field damaged at a time: each is named.
TEST(CalibrationFile, RefusesDamagedFilesByField) {
  struct Damage {
    const char* pointer;
    ordered_json value;
    const char* named;
  };
  for (const Damage& d : std::initializer_list<Damage>{
           {"/schema", "touchdown.calibration/2", "/schema"},
           {"/date", "yesterday", "/date"},
           {"/expires", "2027-02-30", "/expires"},
           {"/picture/width_px", 0, "/picture/width_px"},
           {"/lens/model", "fisheye", "/lens/model"},
           {"/lens/fx_px", "wide", "/lens/fx_px"},
           {"/lens/k1", -5.0, "/lens/k1"},
           {"/lens/covariance", ordered_json::array(), "/lens/covariance"},
           {"/lens/covariance/0/0", -1.0, "/lens/covariance"},
           {"/lens/covariance/0/1", 1.0, "/lens/covariance"},
           {"/scale/px_per_m/value", 0.0, "/scale/px_per_m"},
           {"/scale/px_per_m/u", -1.0, "/scale/px_per_m/u"},
           {"/ground/u_point_px", nullptr, "/ground/u_point_px"}}) {
    ordered_json json = ordered_json::parse(CalibrationText(Whole()));
    json[ordered_json::json_pointer(d.pointer)] = d.value;
    EXPECT_THAT([&] { ParseCalibration(json.dump(), "camera.json"); },
                ThrowsMessage<core::InputError>(
                    HasSubstr(std::string("camera.json: ") + d.named)));
  }
  EXPECT_THAT([] { ParseCalibration("{\"schema\": ", "camera.json"); },
              ThrowsMessage<core::InputError>(HasSubstr("is not JSON")));
  EXPECT_THROW(ReadCalibration("/nowhere/camera.json"), core::InputError);
  EXPECT_THROW(WriteCalibration("/nowhere/camera.json", Whole()),
               core::InputError);
}

TEST(AdaptToPicture, MovesWithTheCrop) {
  const Calibration c = Whole();
  const auto part = AdaptToPicture(c, {320, 200, SensorCorner{100, 60}});
  ASSERT_TRUE(part) << part.error().reason;
  EXPECT_EQ(part->picture.width_px, 320);
  EXPECT_DOUBLE_EQ(part->lens->lens.cx_px, c.lens->lens.cx_px - 100.0);
  EXPECT_DOUBLE_EQ(part->lens->lens.cy_px, c.lens->lens.cy_px - 60.0);
  EXPECT_DOUBLE_EQ(part->ground->p1.x_px, -90.0);
  EXPECT_DOUBLE_EQ(part->ground->p2.y_px, 276.9);
  EXPECT_EQ(part->scale->px_per_m, c.scale->px_per_m);
  // A file that does not say where it was cropped, of the same size.
  EXPECT_TRUE(AdaptToPicture(c, {640, 480, std::nullopt}));
}

TEST(AdaptToPicture, RefusesOtherPictures) {
  const Calibration c = Whole();
  const auto reason = [&](const Picture& picture) {
    const auto fitted = AdaptToPicture(c, picture);
    return fitted ? "accepted" : fitted.error().reason;
  };
  EXPECT_THAT(reason({1280, 800, std::nullopt}), HasSubstr("--crop X,Y"));
  EXPECT_THAT(reason({320, 200, std::nullopt}), HasSubstr("--crop X,Y"));
  EXPECT_THAT(reason({320, 200, SensorCorner{400, 0}}),
              HasSubstr("reaches beyond"));
  EXPECT_THAT(reason({640, 480, SensorCorner{0, 8}}),
              HasSubstr("640x480 px at 0,8 of the sensor"));
}

TEST(AgeWarning, ComesTheDayAfterExpiry) {
  const Calibration c = Whole();
  EXPECT_FALSE(AgeWarning(c, "2027-11-21"));
  ASSERT_TRUE(AgeWarning(c, "2027-11-22"));
  EXPECT_THAT(*AgeWarning(c, "2027-11-22"), HasSubstr("expired on 2027-11-21"));
  ASSERT_TRUE(AgeWarning(c, "2026-11-20"));
  EXPECT_THAT(*AgeWarning(c, "2026-11-20"), HasSubstr("check the clocks"));
}

TEST(IsDate, KnowsTheCalendar) {
  EXPECT_TRUE(IsDate("2028-02-29"));
  for (const char* text : {"2027-02-29", "2027-13-01", "2027-1-01", "27-01-01",
                           "2027/01/01", "2027-01-0x", ""}) {
    EXPECT_FALSE(IsDate(text)) << text;
  }
}

}  // namespace
}  // namespace touchdown::calib
