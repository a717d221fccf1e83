#include "touchdown/calib/lens_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/calib/board_picture.h"
#include "tests/support/shared_data.h"
#include "tests/support/statistics.h"

namespace touchdown::calib {
namespace {

using board_picture::ManyPoses;
using board_picture::TestLens;
using board_picture::Views;
using ::testing::HasSubstr;

const Board kBoard{BoardKind::kChessboard, 9, 6, 0.025};

// Over seeded sets of 12 views with noise of known size, the errors over their
// stated uncertainties are standard normal, and so is where ideal points lie.
TEST(CalibrateLens, ErrorsAreAsStated) {
  const Lens truth = TestLens();
  constexpr int kSets = 24;
  constexpr double kNoise_px = 0.1;
  std::vector<std::vector<double>> z(kLensParameters);
  int inside = 0;
  double widened = 0.0;
  for (int set = 0; set < kSets; ++set) {
    std::mt19937_64 engine(100 + static_cast<std::uint64_t>(set));
    const auto poses = ManyPoses(kBoard, truth, 12, 0.6, engine);
    const auto lens = CalibrateLens(
        Views(kBoard, poses, truth, kNoise_px, engine), kBoard, 640, 480);
    ASSERT_TRUE(lens) << lens.error().reason;
    EXPECT_NEAR(lens->u_corner_px, kNoise_px, 0.01);
    widened += lens->widened / kSets;
    for (int i = 0; i < kLensParameters; ++i) {
      const core::Estimate e = lens->Parameter(i);
      const double error = (e.value - ToVector(truth)[i]) / e.u;
      z[static_cast<std::size_t>(i)].push_back(error);
      inside += std::abs(error) < core::kNormal975;
    }
  }
  for (int i = 0; i < kLensParameters; ++i) {
    const auto& of = z[static_cast<std::size_t>(i)];
    const char* name = kLensNames[static_cast<std::size_t>(i)];
    const auto band = testing::RmsBand9999(of.size());
    // Never too small; at most what the widening makes too large.
    EXPECT_LT(testing::Rms(of), band.high) << name;
    EXPECT_GT(testing::Rms(of), band.low / 1.6) << name;
    EXPECT_LT(std::abs(testing::Mean(of)) * std::sqrt(kSets), 3.9) << name;
  }
  // 0.95 of 216, correlated within a set.
  EXPECT_GE(inside, 196);
  EXPECT_LT(widened, 1.6);
}

TEST(CalibrateLens, ExactPointsGiveTheLensBack) {
  std::mt19937_64 engine(3);
  const Lens truth = TestLens();
  const auto poses = ManyPoses(kBoard, truth, 12, 0.6, engine);
  const auto lens =
      CalibrateLens(Views(kBoard, poses, truth, 0.0, engine), kBoard, 640, 480);
  ASSERT_TRUE(lens) << lens.error().reason;
  // Points are handed to OpenCV as floats: 3e-5 px.
  EXPECT_LT(lens->rms_px, 1e-4);
  EXPECT_NEAR(lens->lens.fx_px, truth.fx_px, 0.01);
  EXPECT_NEAR(lens->lens.cx_px, truth.cx_px, 0.01);
  EXPECT_NEAR(lens->lens.k1, truth.k1, 1e-3);
  EXPECT_GT(lens->coverage, 0.6);
}

std::string ReasonFor(const std::vector<board_picture::BoardPose>& poses,
                      double noise_px = 0.1) {
  std::mt19937_64 engine(5);
  const auto lens = CalibrateLens(
      Views(kBoard, poses, TestLens(), noise_px, engine), kBoard, 640, 480);
  return lens ? "accepted" : lens.error().reason;
}

TEST(CalibrateLens, RefusesDegenerateSetsByName) {
  std::mt19937_64 engine(7);
  const Lens lens = TestLens();
  EXPECT_THAT(ReasonFor(ManyPoses(kBoard, lens, 4, 0.6, engine)),
              HasSubstr("too few views: the board was found in 4"));
  EXPECT_THAT(ReasonFor(ManyPoses(kBoard, lens, 12, 0.01, engine)),
              HasSubstr("straight on"));
  std::vector<board_picture::BoardPose> corner;
  std::uniform_real_distribution<double> tilt(-0.6, 0.6);
  for (int i = 0; i < 12; ++i) {
    corner.push_back(board_picture::PoseAt(kBoard, lens, 0.3, 0.3, tilt(engine),
                                           tilt(engine), 0.4));
  }
  EXPECT_THAT(ReasonFor(corner), HasSubstr("poor coverage"));
  EXPECT_THAT(ReasonFor(corner), HasSubstr("right"));
  // The same view again and again, tilted: nothing tells focal length from
  // distance well enough.
  const std::vector<board_picture::BoardPose> same(
      12, board_picture::PoseAt(kBoard, lens, 0.5, 0.5, 0.5, 0.0, 0.75));
  EXPECT_THAT(ReasonFor(same, 0.3), HasSubstr("too much alike"));
}

TEST(CalibrateLens, NamesTheViewThatIsOff) {
  std::mt19937_64 engine(11);
  const Lens lens = TestLens();
  auto views = Views(kBoard, ManyPoses(kBoard, lens, 12, 0.6, engine), lens,
                     0.05, engine);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (core::PixelPoint& p : views[4].points) p.x_px += normal(engine);
  const auto calibrated = CalibrateLens(views, kBoard, 640, 480);
  ASSERT_TRUE(calibrated) << calibrated.error().reason;
  EXPECT_THAT(calibrated->warnings,
              ::testing::Contains(HasSubstr("view4: its corners are off")));
}

TEST(CalibrateLens, RefusesImpossibleArguments) {
  EXPECT_THROW(CalibrateLens({{"one", {}}}, kBoard, 640, 480),
               std::invalid_argument);
  EXPECT_THROW(CalibrateLens({}, kBoard, 0, 480), std::invalid_argument);
}

// OpenCV's samples/data/left*.jpg with its published left_intrinsics.yml
// (square pixels, rms 0.393), and a free refit by others (rms 0.195).
TEST(CalibrateLens, ReproducesAPublishedCamera) {
  const auto folder = testing::Shared("footage/calibration");
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << folder << " is not here";
  }
  std::vector<BoardView> views;
  for (int i = 1; i <= 14; ++i) {
    const auto path = folder / ("left" + std::string(i < 10 ? "0" : "") +
                                std::to_string(i) + ".jpg");
    if (!std::filesystem::exists(path)) continue;
    const vision::Image image = vision::ReadImage(path);
    const auto points = FindBoard(image.View(), kBoard);
    ASSERT_TRUE(points) << path << ": " << points.error().reason;
    views.push_back({path.filename().string(), *points});
  }
  ASSERT_EQ(views.size(), 13u);
  const auto lens = CalibrateLens(views, kBoard, 640, 480);
  ASSERT_TRUE(lens) << lens.error().reason;
  struct Published {
    int index;
    double published;
    double refit;
  };
  for (const Published& p :
       {Published{0, 535.916, 532.8}, Published{1, 535.916, 532.9},
        Published{2, 342.283, 342.5}, Published{3, 235.571, 233.9}}) {
    const core::Estimate e = lens->Parameter(p.index);
    const char* name = kLensNames[static_cast<std::size_t>(p.index)];
    // The published fit's own uncertainty is not stated; its residuals are
    // twice as large as ours.
    const double u_published = e.u * 0.393 / lens->rms_px;
    std::cout << name << " " << e.value << " +- " << e.u << ", published "
              << p.published << ", refit " << p.refit << "\n";
    EXPECT_NEAR(e.value, p.published, 2.0 * std::hypot(e.u, u_published))
        << name;
    EXPECT_NEAR(e.value, p.refit, 2.0 * e.u) << name;
  }
  std::cout << "rms " << lens->rms_px << " px, widened " << lens->widened
            << ", coverage " << lens->coverage << ", k1 " << lens->lens.k1
            << " +- " << lens->Parameter(4).u << "\n";
  EXPECT_LT(lens->rms_px, 0.393);
  EXPECT_NEAR(lens->lens.k1, -0.281, 2.0 * lens->Parameter(4).u);
}

}  // namespace
}  // namespace touchdown::calib
