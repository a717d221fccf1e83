// docs/reading-the-store.md: each of its examples runs and prints what stands
// below it. Where pandas or R are not, theirs skip.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace touchdown {
namespace {

using ::testing::HasSubstr;

struct Example {
  std::string language;
  std::string text;
  std::string prints;
};

std::vector<Example> Examples() {
  std::istringstream in(
      testing::ReadText(TOUCHDOWN_SOURCE_DIR "/docs/reading-the-store.md"));
  std::vector<Example> examples;
  std::string language;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      const bool opens = language.empty();
      language = opens ? line.substr(3) : "";
      if (opens && language != "text") examples.push_back({language, "", ""});
    } else if (!language.empty()) {
      Example& example = examples.back();
      (language == "text" ? example.prints : example.text) += line + '\n';
    }
  }
  return examples;
}

class ReadingTheStore : public ::testing::Test {
 protected:
  // In the folder; with touchdown on the path.
  testing::ProgramResult Shell(const std::string& command) {
    const std::string bin =
        std::filesystem::path(TOUCHDOWN_BINARY).parent_path().string();
    return testing::RunProgram({"/bin/sh", "-c",
                                "set -e; cd '" + folder_.path().string() +
                                    "'; PATH='" + bin + "':$PATH; " + command},
                               scratch_.path().string());
  }
  void SetUp() override {
    for (const Example& example : Examples()) {
      if (example.language != "sh") continue;
      const auto ran = Shell(example.text);
      ASSERT_EQ(ran.status, 0) << ran.err;
    }
  }
  // Runs every example of a language with `command FILE`.
  void ExpectPrinted(const std::string& language, const std::string& command) {
    int count = 0;
    for (const Example& example : Examples()) {
      if (example.language != language) continue;
      ++count;
      folder_.Write("example", example.text);
      const auto ran = Shell(command + " example");
      EXPECT_EQ(ran.status, 0) << ran.err;
      EXPECT_EQ(ran.out, example.prints);
    }
    EXPECT_GT(count, 0);
  }

  testing::TemporaryFolder folder_;
  testing::TemporaryFolder scratch_;
};

TEST_F(ReadingTheStore, ByPython) {
  if (Shell("python3 -c 'import sqlite3'").status != 0) {
    GTEST_SKIP() << "there is no python3 here";
  }
  ExpectPrinted("python", "python3");
}

TEST_F(ReadingTheStore, BySql) {
  if (Shell("python3 -c 'import sqlite3'").status != 0) {
    GTEST_SKIP() << "there is no python3 here";
  }
  folder_.Write("run.py",
                "import sqlite3, sys\n"
                "for row in sqlite3.connect('lab.db').execute("
                "open(sys.argv[1]).read()):\n"
                "    print(*row, sep='|')\n");
  ExpectPrinted("sql", "python3 run.py");
}

TEST_F(ReadingTheStore, ByPandas) {
  if (Shell("python3 -c 'import pandas'").status != 0) {
    GTEST_SKIP() << "there is no pandas here";
  }
  ExpectPrinted("pandas", "python3");
}

TEST_F(ReadingTheStore, ByR) {
  if (Shell("Rscript -e 'q()'").status != 0) {
    GTEST_SKIP() << "there is no R here";
  }
  ExpectPrinted("r", "Rscript");
}

// Every column of every CSV is in the schema beside it, in order.
TEST_F(ReadingTheStore, EachCsvHasItsSchemaBesideIt) {
  ASSERT_EQ(Shell("touchdown export --db lab.db --out flat.csv").status, 0);
  for (const char* name :
       {"flat.csv", "tidy/trials.csv", "tidy/contacts.csv", "tidy/tracks.csv",
        "tidy/campaigns.csv", "tidy/revisions.csv"}) {
    SCOPED_TRACE(name);
    const std::string path = (folder_ / name).string();
    const std::string csv = testing::ReadText(path);
    const auto schema =
        nlohmann::json::parse(testing::ReadText(path + "-metadata.json"));
    EXPECT_EQ(schema["url"], std::filesystem::path(name).filename().string());
    std::string header;
    for (const auto& column : schema["tableSchema"]["columns"]) {
      const std::string title = column["name"];
      header += (header.empty() ? "" : ",") + title;
      if (title.ends_with("_deg")) EXPECT_EQ(column["schema:unitText"], "deg");
      if (title.ends_with("_mm")) EXPECT_EQ(column["schema:unitText"], "mm");
    }
    EXPECT_EQ(csv.substr(0, csv.find("\r\n")), header);
  }
}

}  // namespace
}  // namespace touchdown
