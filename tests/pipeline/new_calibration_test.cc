// A calibration as it begins.
#include "app/measure/new_calibration.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "app/text/dates.h"

namespace touchdown::pipeline {
namespace {

TEST(NewCalibration, IsOfAPictureAndADay) {
  const calib::Calibration leap =
      NewCalibration("left", {640, 400, std::nullopt}, "2028-02-28", 1);
  EXPECT_EQ(leap.camera, "left");
  EXPECT_EQ(leap.date, "2028-02-28");
  EXPECT_EQ(leap.expires, "2028-02-29");
  EXPECT_EQ(leap.picture.width_px, 640);
  EXPECT_EQ(leap.picture.corner, calib::SensorCorner{});
  EXPECT_FALSE(leap.lens || leap.scale || leap.ground);
  const calib::Calibration year =
      NewCalibration("", {640, 400, calib::SensorCorner{8, 16}}, "2026-11-21");
  EXPECT_EQ(year.expires, "2027-11-21");
  EXPECT_EQ(year.picture.corner, (calib::SensorCorner{8, 16}));
}

TEST(NewCalibration, IsOfTodayWhereNobodySays) {
  // Midnight may pass between the two looks.
  const std::string before = Today();
  const std::string date = NewCalibration("", {}).date;
  EXPECT_TRUE(date == before || date == Today());
  EXPECT_TRUE(calib::IsDate(date));
}

TEST(NewCalibration, RefusesWhatIsNoDay) {
  EXPECT_THROW(NewCalibration("", {}, "21.11.2026"), std::invalid_argument);
  EXPECT_THROW(NewCalibration("", {}, "2026-02-30"), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::pipeline
