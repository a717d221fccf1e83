#include "app/demo/demo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/temporary_folder.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

std::string ReadAll(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Table 1 as rendered, against the truth it was rendered from.
TEST(RunDemo, Table1IsRightAndItsUncertaintiesCover) {
  const testing::TemporaryFolder folder;
  DemoOptions options;
  options.folder = folder.path();
  const DemoResult demo = RunDemo(options);
  ASSERT_EQ(demo.rows.size(), 18u);
  EXPECT_EQ(demo.right, 18);
  EXPECT_EQ(demo.angles, 18);
  EXPECT_LE(demo.rmse_rad / core::kDegree, 0.15);
  for (const DemoRow& row : demo.rows) {
    ASSERT_TRUE(row.angle_rad)
        << row.clip << ": " << row.angle_rad.error().reason;
    EXPECT_NEAR(std::abs(row.angle_rad->value), row.true_angle_rad,
                4.0 * row.angle_rad->u)
        << row.clip;
    EXPECT_LT(row.angle_rad->u, 0.05 * core::kDegree) << row.clip;
  }
  // No verdict rests on simulated trials, and the report says so.
  const std::string html = ReadAll(demo.report);
  EXPECT_NE(html.find("SIMULATED"), std::string::npos);
  EXPECT_NE(html.find("No verdict"), std::string::npos);
  // Every contact is shown, and every path.
  int strips = 0;
  for (std::size_t at = html.find("class=\"strip\""); at != std::string::npos;
       at = html.find("class=\"strip\"", at + 1)) {
    ++strips;
  }
  EXPECT_EQ(strips, 18);
  EXPECT_NE(html.find("touchdown: frame "), std::string::npos);

  // A second run adds revisions of the same trials, and says the same.
  const DemoResult again = RunDemo(options);
  EXPECT_EQ(again.right, demo.right);
  EXPECT_EQ(again.rmse_rad, demo.rmse_rad);
}

}  // namespace
}  // namespace touchdown::pipeline
