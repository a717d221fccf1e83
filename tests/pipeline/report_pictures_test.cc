#include "app/report_input/report_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/documents/log_analysis.h"
#include "app/documents/replay.h"
#include "tests/pipeline/film_file.h"
#include "tests/support/temporary_folder.h"

namespace touchdown::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// A trial of a recording on the disk, as every command logs it: without a
// folder of evidence.
class ReportPictures : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = folder_ / "shot.mraw";
    filmed::WriteSphere(path_, 30.0, 1);
    AnalyzeOptions options;
    options.body_kind = core::BodyKind::kSphere;
    options.diameter_m = core::Estimate{0.024, 2e-5, std::nullopt};
    input_.trials = {ToTrial(Analyze(path_, options))};
    input_.trials[0].id = "one";
    ASSERT_TRUE(input_.trials[0].first.contact.found);
  }

  testing::TemporaryFolder folder_;
  std::filesystem::path path_;
  report::ReportInput input_;
};

TEST_F(ReportPictures, ShowTheContactOfATrialThatHasARecording) {
  AddPictures(input_);
  EXPECT_TRUE(input_.no_strip.empty());
  ASSERT_EQ(input_.strips.size(), 1u);
  const auto& pictures = input_.strips.at("one").pictures;
  ASSERT_EQ(pictures.size(), 3u);
  EXPECT_THAT(pictures[0].label, StartsWith("before: frame "));
  EXPECT_THAT(pictures[0].label, HasSubstr(" ms earlier"));
  EXPECT_THAT(pictures[1].label, StartsWith("touchdown: frame "));
  EXPECT_THAT(pictures[2].label, StartsWith("after: frame "));
  for (const auto& picture : pictures) {
    EXPECT_EQ(picture.png.substr(1, 3), "PNG");
    // The whole body is in the piece.
    for (const core::PixelPoint p : picture.outline) {
      EXPECT_GE(p.x_px, picture.piece.x);
      EXPECT_LE(p.x_px, picture.piece.x + picture.piece.width);
      EXPECT_GE(p.y_px, picture.piece.y);
      EXPECT_LE(p.y_px, picture.piece.y + picture.piece.height);
    }
    // All show the same piece, so that the ground lies at one height.
    EXPECT_EQ(picture.piece, pictures[0].piece);
    ASSERT_TRUE(picture.touching);
  }
  // The outline of the sphere has its stated diameter, by the scale.
  const auto [left, right] = std::minmax_element(
      pictures[1].outline.begin(), pictures[1].outline.end(),
      [](const auto& a, const auto& b) { return a.x_px < b.x_px; });
  EXPECT_NEAR((right->x_px - left->x_px) / *input_.strips.at("one").px_per_m,
              0.024, 2e-4);
}

TEST_F(ReportPictures, ThePathTouchesDownAtItsOrigin) {
  AddPictures(input_);
  const report::Trajectory& path = input_.trajectories.at("one");
  ASSERT_EQ(path.centre.size(), path.gap_m.size());
  const auto nearest = std::min_element(
      path.centre.begin(), path.centre.end(), [](const auto& a, const auto& b) {
        return std::abs(a.x_m) < std::abs(b.x_m);
      });
  const auto at = static_cast<std::size_t>(nearest - path.centre.begin());
  // Within one frame of 1.3 m/s there.
  EXPECT_LT(std::abs(nearest->x_m), 2e-3);
  EXPECT_LT(std::abs(path.gap_m[at]), 1e-3);
  // The centre is a radius above the lowest point.
  EXPECT_NEAR(nearest->y_m - path.gap_m[at], 0.012, 1e-4);
  EXPECT_GT(path.gap_m.front(), path.gap_m[at]);
}

TEST_F(ReportPictures, ARecordingThatIsGoneOrAnotherIsAReason) {
  filmed::WriteSphere(path_, 30.0, 2);
  AddPictures(input_);
  EXPECT_TRUE(input_.strips.empty());
  EXPECT_EQ(input_.no_strip.at("one"), "another recording lies where it was");
  input_.no_strip.clear();
  std::filesystem::remove(path_);
  AddPictures(input_);
  EXPECT_EQ(input_.no_strip.at("one"), "the recording is not where it was");
  // The path is in the document.
  EXPECT_EQ(input_.trajectories.size(), 1u);
}

TEST_F(ReportPictures, WhereThereAreTooManyNoneIsTaken) {
  AddPictures(input_, 0);
  EXPECT_TRUE(input_.strips.empty());
  EXPECT_EQ(input_.no_strip.at("one"), "more than 0 trials");
}

TEST_F(ReportPictures, ATypedTrialHasNone) {
  core::Trial typed;
  typed.id = "typed";
  input_.trials = {typed};
  AddPictures(input_);
  EXPECT_EQ(input_.no_strip.at("typed"), "the trial was logged by hand");
}

}  // namespace
}  // namespace touchdown::pipeline
