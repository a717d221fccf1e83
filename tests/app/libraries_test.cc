// What the program loads only when it is needed, and what a user is told where
// it is not there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/board_files.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace touchdown {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// A machine whose libavformat is no library.
class WithoutLibav : public ::testing::Test {
 protected:
  WithoutLibav() {
    folder_.Write("libavformat.so.59", "not a library");
    folder_.Write("film.mp4", "not a film");
  }
  testing::ProgramResult Run(std::vector<std::string> arguments) const {
    arguments.insert(
        arguments.begin(),
        {"/usr/bin/env", "LD_LIBRARY_PATH=" + folder_.path().string(),
         TOUCHDOWN_BINARY});
    return testing::RunProgram(std::move(arguments), folder_.path().string());
  }

  testing::TemporaryFolder folder_;
};

TEST_F(WithoutLibav, AVideoIsRefusedInOneLine) {
  const auto ran = Run({"analyze", (folder_ / "film.mp4").string()});
  EXPECT_EQ(ran.status, 3) << ran.err;
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err,
              AllOf(StartsWith("touchdown: "), HasSubstr("libavformat.so.59"),
                    HasSubstr("install it")));
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
}

// A machine whose LAPACK is no library.
TEST(WithoutLapack, CalibratingIsRefusedInOneLine) {
  const testing::TemporaryFolder folder;
  folder.Write("liblapack.so.3", "not a library");
  std::filesystem::create_directory(folder / "boards");
  testing::WriteBoardPictures(folder / "boards", 9);
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(
        arguments.begin(),
        {"/usr/bin/env", "LD_LIBRARY_PATH=" + folder.path().string(),
         TOUCHDOWN_BINARY});
    return testing::RunProgram(std::move(arguments), folder.path().string());
  };
  if (run({"--version"}).status != 0) {
    GTEST_SKIP() << "this build loads LAPACK when it starts";
  }
  const auto ran =
      run({"calibrate", "lens", (folder / "boards").string(), "--board",
           "chessboard:7x5:20mm", "--out", (folder / "lens.json").string()});
  EXPECT_EQ(ran.status, 3) << ran.err;
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err,
              AllOf(StartsWith("touchdown: "), HasSubstr("liblapack.so.3"),
                    HasSubstr("install liblapack3")));
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
}

TEST_F(WithoutLibav, WhatNeedsNoVideoWorks) {
  const auto ran = Run({"--version"});
  EXPECT_EQ(ran.status, 0) << ran.err;
}

}  // namespace
}  // namespace touchdown
