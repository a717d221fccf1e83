// touchdown report-bug: what the archive holds, and that nothing is written
// without a person's word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "tests/pipeline/film_file.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::cli {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ReportBug : public ::testing::Test {
 protected:
  ReportBug() { pipeline::filmed::WriteSphere(clip_, 25.0, 1); }

  testing::Ran Run(const std::string& arguments) const {
    return testing::RunProgram("report-bug --out " + zip_.string() + " " +
                               arguments);
  }
  // Another's reader of archives: that of CMake, which is libarchive.
  fs::path Extracted() const {
    const fs::path to = folder_ / "extracted";
    fs::create_directories(to);
    const std::string command =
        "cd " + to.string() + " && cmake -E tar xf " + zip_.string();
    EXPECT_EQ(std::system(command.c_str()), 0);
    return to;
  }
  static std::set<std::string> FilesIn(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) {
        names.insert(fs::relative(entry.path(), folder).string());
      }
    }
    return names;
  }

  const testing::TemporaryFolder folder_;
  const fs::path clip_ = folder_ / "shot.mraw";
  const fs::path zip_ = folder_ / "bug.zip";
};

TEST_F(ReportBug, HoldsWhatItListed) {
  const auto ran = Run("--yes --diameter-mm 24 " + clip_.string());
  ASSERT_EQ(ran.status, 0) << ran.err;
  std::set<std::string> listed;
  std::istringstream lines(ran.out);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(" kB  ") == std::string::npos) continue;
    listed.insert(line.substr(0, line.find(' ')));
  }
  EXPECT_EQ(FilesIn(Extracted()), listed);
  EXPECT_THAT(listed, AllOf(Contains("command.txt"), Contains("analysis.json"),
                            Contains("log.txt"), Contains("doctor.txt")));
}

TEST_F(ReportBug, HoldsDocumentLogOptionsAndMachine) {
  ASSERT_EQ(Run("--yes --diameter-mm 24 --stop-early " + clip_.string()).status,
            0);
  const fs::path in = Extracted();
  const auto document =
      nlohmann::json::parse(testing::ReadAll(in / "analysis.json"));
  EXPECT_EQ(document.at("schema"), "touchdown.analysis/1");
  EXPECT_EQ(document.at("state").at("label"), "bounce");
  EXPECT_THAT(testing::ReadAll(in / "command.txt"),
              AllOf(HasSubstr("analyze --diameter-mm=24 --stop-early " +
                              clip_.string() + "\n"),
                    HasSubstr("\nexit status 0\n")));
  EXPECT_THAT(testing::ReadAll(in / "log.txt"),
              AllOf(HasSubstr("opened in "), HasSubstr("state: bounce")));
  EXPECT_THAT(testing::ReadAll(in / "doctor.txt"), HasSubstr("program"));
  for (const fs::path& header : {folder_ / "shot.cih", folder_ / "shot.cihx"}) {
    if (!fs::exists(header)) continue;
    EXPECT_EQ(testing::ReadAll(in / "beside" / header.filename()),
              testing::ReadAll(header));
  }
}

TEST_F(ReportBug, HoldsTheFramesOfTheContactAsTheyAre) {
  ASSERT_EQ(Run("--yes --diameter-mm 24 " + clip_.string()).status, 0);
  const fs::path frames = Extracted() / "frames";
  // Touchdown is at 80.37.
  EXPECT_THAT(FilesIn(frames),
              AllOf(Contains("000079.png"), Contains("000080.png"),
                    Contains("000081.png"), Contains("000000.png"),
                    Contains("000114.png"), ::testing::SizeIs(8)));
  const auto clip = vision::OpenClip(clip_);
  for (const std::int64_t index : {0, 80}) {
    const auto picture = vision::ReadImage(
        frames / ("0000" + std::string(index < 10 ? "0" : "") +
                  std::to_string(index) + ".png"));
    const core::Frame frame = clip->Read(index);
    ASSERT_EQ(picture.width_px, frame.width_px);
    ASSERT_EQ(picture.height_px, frame.height_px);
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      for (std::int32_t x = 0; x < frame.width_px; ++x) {
        ASSERT_EQ(picture.View().at(x, y), frame.at(x, y)) << x << "," << y;
      }
    }
  }
}

// They tell no frame rate.
TEST_F(ReportBug, HoldsTheFramesOfAFolderOfImages) {
  const fs::path images = folder_ / "images";
  pipeline::filmed::WriteImages(images, 25.0, 1);
  ASSERT_EQ(
      Run("--yes --pictures 3 --fps 1000 --diameter-mm 24 " + images.string())
          .status,
      0);
  EXPECT_THAT(FilesIn(Extracted() / "frames"),
              AllOf(Contains("000080.png"), ::testing::SizeIs(3)));
}

TEST_F(ReportBug, HoldsAsManyPicturesAsAskedFor) {
  ASSERT_EQ(Run("--yes --pictures 0 " + clip_.string()).status, 0);
  EXPECT_FALSE(fs::exists(Extracted() / "frames"));
  fs::remove_all(folder_ / "extracted");
  ASSERT_EQ(Run("--yes --pictures 3 " + clip_.string()).status, 0);
  EXPECT_EQ(FilesIn(Extracted() / "frames").size(), 3U);
}

TEST_F(ReportBug, HoldsTheReasonAndTheHeadOfWhatCannotBeRead) {
  const std::string bytes(100000, 'x');
  const fs::path film = folder_.Write("film.mp4", bytes);
  const auto ran = Run("--yes " + film.string());
  EXPECT_EQ(ran.status, 0) << ran.err;
  const fs::path in = Extracted();
  EXPECT_THAT(testing::ReadAll(in / "command.txt"),
              AllOf(HasSubstr("\nexit status 3\n"), HasSubstr("film.mp4")));
  EXPECT_EQ(testing::ReadAll(in / "head.bin"), bytes.substr(0, 65536));
  EXPECT_FALSE(fs::exists(in / "analysis.json"));
}

TEST_F(ReportBug, WritesNothingUnlessToldTo) {
  const auto answer = folder_.Write("answer", "n\n");
  const auto no = Run(clip_.string() + " <" + answer.string());
  EXPECT_EQ(no.status, 0);
  EXPECT_THAT(no.out, HasSubstr("analysis.json"));
  EXPECT_THAT(no.err, HasSubstr("nothing was written"));
  EXPECT_FALSE(fs::exists(zip_));

  const auto nobody = Run(clip_.string() + " </dev/null");
  EXPECT_EQ(nobody.status, 2);
  EXPECT_THAT(nobody.err, HasSubstr("give --yes"));
  EXPECT_FALSE(fs::exists(zip_));

  folder_.Write("answer", "y\n");
  EXPECT_EQ(Run(clip_.string() + " <" + answer.string()).status, 0);
  EXPECT_TRUE(fs::exists(zip_));
}

TEST_F(ReportBug, RefusesInOneLine) {
  for (const std::string& arguments :
       {"--yes " + (folder_ / "absent.mraw").string(),
        "--yes --pictures -1 " + clip_.string(),
        "--yes --diameter-mm wide " + clip_.string()}) {
    const auto ran = Run(arguments);
    EXPECT_THAT(ran.status, ::testing::AnyOf(2, 3)) << arguments;
    EXPECT_THAT(ran.err, StartsWith("touchdown: "));
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    EXPECT_FALSE(fs::exists(zip_));
  }
}

}  // namespace
}  // namespace touchdown::cli
