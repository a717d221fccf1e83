// Manifests: what each column means, and where a mistake is.
#include "app/batch/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

std::string ErrorOf(const std::string& text) {
  try {
    ParseManifest(text, "m.csv", "films");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Manifest, EveryColumn) {
  const auto rows = ParseManifest(
      "\xef\xbb\xbf"
      "set_angle_deg,clip,fps,campaign,set_speed_mps\r\n"
      "20.5,a.mraw,,,\r\n"
      "\r\n"
      ",\"b, \"\"quoted\"\"\nand broken.avi\",2000,sand,3.5\r\n"
      ",'=evil.avi,,,\r\n",
      "m.csv", "films");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].row, 2u);
  EXPECT_EQ(rows[0].clip, "films/a.mraw");
  EXPECT_THAT(rows[0].set_angle_rad, Optional(20.5 * core::kDegree));
  EXPECT_FALSE(rows[0].campaign || rows[0].set_speed_mps || rows[0].fps);
  EXPECT_EQ(rows[1].name, "b, \"quoted\"\nand broken.avi");
  EXPECT_THAT(rows[1].campaign, Optional(std::string("sand")));
  EXPECT_THAT(rows[1].set_speed_mps, Optional(3.5));
  EXPECT_THAT(rows[1].fps, Optional(2000.0));
  EXPECT_EQ(rows[2].clip, "films/=evil.avi");
  EXPECT_EQ(ParseManifest("clip\n/abs/c.avi\n", "m", "films")[0].clip,
            "/abs/c.avi");
}

TEST(Manifest, MistakesAreNamedByRowAndColumn) {
  EXPECT_THAT(ErrorOf(""), HasSubstr("m.csv: the file is empty"));
  EXPECT_THAT(ErrorOf("clip\n"), HasSubstr("no recording is listed"));
  EXPECT_THAT(ErrorOf("set_angle_deg\n1\n"), HasSubstr("'clip' is missing"));
  EXPECT_THAT(ErrorOf("clip,angle\na,1\n"),
              HasSubstr("row 1: there is no column 'angle'"));
  EXPECT_THAT(ErrorOf("clip,clip\na,b\n"), HasSubstr("comes twice"));
  EXPECT_THAT(ErrorOf("clip,fps\na\n"),
              HasSubstr("row 2: 1 cells, 2 as in the header"));
  EXPECT_THAT(
      ErrorOf("clip,set_angle_deg\na,1\nb,91\n"),
      HasSubstr("row 3, column set_angle_deg: '91': a number from -90"));
  EXPECT_THAT(ErrorOf("clip,set_angle_deg\na,nan\n"), HasSubstr("'nan'"));
  EXPECT_THAT(ErrorOf("clip,set_speed_mps\na,-1\n"), HasSubstr("'-1'"));
  EXPECT_THAT(ErrorOf("clip,fps\na,1e400\n"), HasSubstr("'1e400'"));
  EXPECT_THAT(ErrorOf("clip,fps\na,0\n"), HasSubstr("column fps: '0'"));
  EXPECT_THAT(ErrorOf("clip,fps\n,5\n"), HasSubstr("row 2, column clip"));
  EXPECT_THAT(ErrorOf("clip\na\nx/../a\n"),
              HasSubstr("row 3, column clip: 'x/../a': is already in row 2"));
  EXPECT_THAT(ErrorOf("clip\n\"a\n"), HasSubstr("a quote is left open"));
}

TEST(Manifest, AFileThatIsNone) {
  const testing::TemporaryFolder folder;
  EXPECT_THROW(ReadManifest(folder.path()), core::InputError);
  EXPECT_THROW(ReadManifest(folder / "none.csv"), core::InputError);
  EXPECT_EQ(ReadManifest(folder.Write("m.csv", "clip\na.avi\n"))[0].clip,
            folder / "a.avi");
}

}  // namespace
}  // namespace touchdown::pipeline
