#include "app/pipeline/pictures.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"

namespace touchdown::pipeline {
namespace {

using testing::TemporaryFolder;

TEST(FindPictures, ByRecordingAndOptions) {
  const TemporaryFolder folder;
  const auto leave = [&](const char* name, const char* json, bool picture) {
    std::filesystem::create_directories(folder.path() / name);
    std::ofstream(folder.path() / name / "analysis.json") << json;
    if (picture) std::ofstream(folder.path() / name / "contact.png") << "p";
  };
  const char* const document =
      R"({"clip": {"id": "one"}, "software": {"options_hash": "h"}})";
  leave("b/deep", document, true);
  leave("a", document, false);
  leave("c", document, true);
  leave("damaged", "{", true);
  leave("other", R"({"clip": {"id": "two"}, "software": {}})", true);
  core::Trial trials[3];
  trials[0].id = "t0";
  trials[0].clip.id = "one";
  trials[0].options_hash = "h";
  trials[1] = trials[0];
  trials[1].id = "t1";
  trials[1].options_hash = "other options";
  trials[2].id = "by hand";
  const auto found = FindPictures(folder.path(), trials);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.at("t0"), folder.path() / "b/deep" / "contact.png");
  EXPECT_THROW(FindPictures(folder.path() / "none", trials), core::InputError);
}

}  // namespace
}  // namespace touchdown::pipeline
