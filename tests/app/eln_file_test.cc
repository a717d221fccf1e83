#include "app/report/eln_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "app/text/text_file.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"

namespace touchdown::report {
namespace {

using ::testing::HasSubstr;

TEST(WriteEln, IsACrateOfTheReport) {
  const testing::TemporaryFolder folder;
  ReportInput input;
  input.title = "A \"report\"";
  input.made_on = "2026-11-23";
  input.details.number = "17";
  WriteReport(MakeReport(input), folder.path());
  WriteEln(input, folder.path());
  const std::string zip = ReadTextFile(folder.path() / "table1.eln");
  const std::size_t begin = zip.find('{');
  const std::size_t end = zip.find("\n}\n", begin);
  const auto crate = nlohmann::json::parse(zip.substr(begin, end + 3 - begin));
  std::set<std::string> files;
  for (const auto& entity : crate["@graph"]) {
    if (entity["@type"] == "File") {
      files.insert(entity["@id"].get<std::string>().substr(2));
    }
    if (entity["@id"] == "./") {
      EXPECT_EQ(entity["identifier"], "17");
      EXPECT_EQ(entity["hasPart"].size(), std::size(kReportFiles));
    }
  }
  EXPECT_THAT(files, ::testing::UnorderedElementsAreArray(kReportFiles));
  for (const std::string& file : files) {
    EXPECT_THAT(zip, HasSubstr("table1/" + file));
  }
}

TEST(WriteEln, AMissingFileIsNamed) {
  const testing::TemporaryFolder folder;
  try {
    WriteEln({}, folder.path());
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("table1.csv: not found; make"));
  }
}

}  // namespace
}  // namespace touchdown::report
