#include "app/review/trajectory.h"

#include <gtest/gtest.h>

namespace touchdown::review {
namespace {

TEST(TrajectoryCsv, HasTheColumnsOfTheDocumentAndEmptyCells) {
  core::Trial trial;
  trial.document_json =
      R"({"path": {"columns": "frame time_s x_mm face_angle_deg",
          "rows": ["3 0.0015 1.25 null", "4 0.002 2.5 -7.5"]}})";
  EXPECT_EQ(TrajectoryCsv(trial).value(),
            "frame,time_s,x_mm,face_angle_deg\r\n"
            "3,0.0015,1.25,\r\n"
            "4,0.002,2.5,-7.5\r\n");
}

TEST(TrajectoryCsv, SaysWhyThereIsNone) {
  core::Trial trial;
  EXPECT_EQ(TrajectoryCsv(trial).error().reason,
            "the trial was logged by hand");
  for (const char* document : {"{}", "[]", "no JSON", R"({"path": 3})",
                               R"({"path": {"columns": "a", "rows": [1]}})"}) {
    trial.document_json = document;
    EXPECT_FALSE(TrajectoryCsv(trial)) << document;
  }
}

}  // namespace
}  // namespace touchdown::review
