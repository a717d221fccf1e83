#include "touchdown/calib/plane.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "touchdown/core/units.h"

namespace touchdown::calib {
namespace {

using core::PixelPoint;
using ::testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

template <class Function>
std::string Refusal(Function function) {
  try {
    function();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Plane, NamesAreThoseOfTheDocument) {
  EXPECT_EQ(Name(GroundSource::kCalibration), "calibration");
  EXPECT_EQ(Name(GroundSource::kUser), "user");
  EXPECT_EQ(Name(GroundSource::kDetected), "detected");
  EXPECT_EQ(Name(GroundSource::kContactPoints), "contact-points");
  EXPECT_EQ(Name(ScaleSource::kCalibration), "calibration");
  EXPECT_EQ(Name(ScaleSource::kUser), "user");
  EXPECT_EQ(Name(ScaleSource::kBodySize), "body_size");
}

// A 3-4-5 line, by hand: direction (4, 3)/5 in the image.
TEST(Plane, HeightAndPositionOfAThreeFourFiveLine) {
  const GroundLine line = MakeGroundLine({10.0, 20.0}, {50.0, 50.0});
  EXPECT_NEAR(ImageAngle(line), std::atan2(3.0, 4.0), 1e-15);
  EXPECT_EQ(line.reference, (PixelPoint{30.0, 35.0}));
  // 10 px along the normal, towards smaller y: (3, -4)/5 * 10.
  const PixelPoint above{30.0 + 6.0, 35.0 - 8.0};
  EXPECT_NEAR(HeightAboveLine(line, above), 10.0, 1e-12);
  EXPECT_NEAR(PositionOnLine(line, above), 0.0, 1e-12);
  const PixelPoint ahead{30.0 + 4.0, 35.0 + 3.0};
  EXPECT_NEAR(HeightAboveLine(line, ahead), 0.0, 1e-12);
  EXPECT_NEAR(PositionOnLine(line, ahead), 5.0, 1e-12);
}

TEST(Plane, PointsInEitherOrderGiveTheSameLine) {
  const GroundLine a = MakeGroundLine({10.0, 20.0}, {50.0, 50.0});
  const GroundLine b = MakeGroundLine({50.0, 50.0}, {10.0, 20.0});
  EXPECT_EQ(a.p1, b.p1);
  EXPECT_EQ(a.p2, b.p2);
  EXPECT_EQ(ImageAngle(a), ImageAngle(b));
}

// The direction lies in (-90, 90] degrees, as the header says: also where the
// two points are one above the other.
TEST(Plane, DirectionLiesInItsHalfTurn) {
  for (int k = 0; k < 360; ++k) {
    const double phi = k * kPi / 180.0;
    const double x = 100.0 * std::cos(phi);
    const double y = 100.0 * std::sin(phi);
    const double angle = ImageAngle(MakeGroundLine({5.0, 7.0}, {5 + x, 7 + y}));
    EXPECT_GT(angle, -0.5 * kPi - 1e-15) << k;
    EXPECT_LE(angle, 0.5 * kPi) << k;
    EXPECT_NEAR(std::remainder(angle - phi, kPi), 0.0, 1e-12) << k;
  }
  EXPECT_EQ(ImageAngle(MakeGroundLine({5.0, 0.0}, {5.0, 9.0})), 0.5 * kPi);
  EXPECT_EQ(ImageAngle(MakeGroundLine({5.0, 9.0}, {5.0, 0.0})), 0.5 * kPi);
}

// Of a height above the line at p: offset and angle of the line.
double HeightUncertainty(const GroundLine& line, core::PixelPoint p) {
  return std::hypot(line.u_offset_px,
                    line.u_angle_rad * PositionOnLine(line, p));
}

// Two points each good to u along the normal: the line is good to u at either
// point, to u / sqrt(2) in the middle, and beyond them grows in proportion.
TEST(Plane, UncertaintyOfTwoClicks) {
  for (const double u : {0.0, 0.2, 0.5, 3.0}) {
    const GroundLine line = MakeGroundLine({40.0, 300.0}, {600.0, 330.0}, u);
    const double length = std::hypot(560.0, 30.0);
    EXPECT_NEAR(HeightUncertainty(line, line.p1), u, 1e-12);
    EXPECT_NEAR(HeightUncertainty(line, line.p2), u, 1e-12);
    EXPECT_NEAR(HeightUncertainty(line, line.reference), u / std::sqrt(2.0),
                1e-12);
    EXPECT_NEAR(line.u_angle_rad, std::sqrt(2.0) * u / length, 1e-15);
    EXPECT_EQ(line.source, GroundSource::kUser);
  }
  EXPECT_DOUBLE_EQ(
      HeightUncertainty(MakeGroundLine({0, 0}, {10, 0}), {0.0, 0.0}), 0.5);
}

// Nothing depends on where the origin is: heights by 1e6 px keep ten digits.
TEST(Plane, FarOriginChangesNothing) {
  for (const double far : {1e3, 1e6}) {
    for (const double slope : {-0.3, 0.0, 0.01, 0.2}) {
      const GroundLine near =
          MakeGroundLine({0, 300}, {640, 300 + 640 * slope});
      const GroundLine moved = MakeGroundLine(
          {far, 300 - far}, {640 + far, 300 + 640 * slope - far});
      for (const double x : {-50.0, 12.5, 639.0}) {
        const PixelPoint p{x, 123.0};
        const PixelPoint q{x + far, 123.0 - far};
        EXPECT_NEAR(HeightAboveLine(near, p), HeightAboveLine(moved, q), 1e-7);
        EXPECT_NEAR(PositionOnLine(near, p), PositionOnLine(moved, q), 1e-7);
        EXPECT_NEAR(HeightUncertainty(near, p), HeightUncertainty(moved, q),
                    1e-9);
      }
    }
  }
}

TEST(Plane, ImpossibleLinesAreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THAT(Refusal([] {
                MakeGroundLine({3, 4}, {3, 4});
              }),
              HasSubstr("ground line"));
  EXPECT_THAT(Refusal([&] {
                MakeGroundLine({nan, 4}, {3, 4});
              }),
              HasSubstr("ground line"));
  EXPECT_THAT(Refusal([&] {
                MakeGroundLine({3, 4}, {inf, 4});
              }),
              HasSubstr("ground line"));
  for (const double u : {-0.1, nan, inf}) {
    EXPECT_THAT(Refusal([&] {
                  MakeGroundLine({0, 4}, {3, 4}, u);
                }),
                HasSubstr("u_point_px"));
  }
}

}  // namespace
}  // namespace touchdown::calib
