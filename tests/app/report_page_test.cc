// The HTML report in a real browser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/run_program.h"

namespace touchdown {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ReadAll;
using testing::RunProgram;
using testing::TemporaryFolder;

// The first of the names that the path knows; empty where none is.
std::string FindBrowser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    const std::string command =
        std::string("command -v ") + name + " >/dev/null 2>&1";
    if (std::system(command.c_str()) == 0) return name;  // NOLINT
  }
  return "";
}

struct Visit {
  int status = -1;
  std::vector<std::string> console;   // everything that the page made it say
  std::vector<std::string> requests;  // of the page: http, https, ws, ftp
  std::string pdf;
};

// Prints the page to PDF, as a person would, and listens to console and net.
Visit Print(const std::string& browser, const std::filesystem::path& page,
            const std::filesystem::path& folder) {
  const std::string at = folder.string();
  const std::string command =
      "HOME=" + at + " timeout 100 " + browser +
      " --headless --no-sandbox --disable-gpu --disable-dev-shm-usage"
      " --no-first-run --disable-background-networking"
      " --disable-component-update --disable-sync --disable-extensions"
      " --proxy-server=http://127.0.0.1:9"  // nobody is there: no net at all
      " --user-data-dir=" +
      at + "/profile --enable-logging=stderr --log-net-log=" + at +
      "/net.json --no-pdf-header-footer --print-to-pdf=" + at +
      "/page.pdf file://" + page.string() + " >" + at + "/log 2>&1";
  Visit out;
  out.status = std::system(command.c_str());  // NOLINT
  std::ifstream log(folder / "log");
  for (std::string line; std::getline(log, line);) {
    if (line.find("CONSOLE") != std::string::npos) out.console.push_back(line);
  }
  const auto net =
      nlohmann::json::parse(ReadAll(folder / "net.json"), nullptr, false);
  if (!net.is_object() || !net.contains("events")) {
    out.requests.emplace_back("the log of the net cannot be read");
    return out;
  }
  for (const auto& event : net.at("events")) {
    const auto params = event.find("params");
    if (params == event.end() || !params->is_object()) continue;
    // The browser's own errands have an initiator that is "not an origin".
    const std::string initiator = params->value("initiator", "");
    if (initiator.empty() || initiator == "not an origin") continue;
    const std::string url = params->value("url", "");
    for (const char* scheme : {"http:", "https:", "ws:", "wss:", "ftp:"}) {
      if (url.starts_with(scheme)) out.requests.push_back(url);
    }
  }
  out.pdf = ReadAll(folder / "page.pdf");
  return out;
}

int CountPages(const std::string& pdf) {
  int n = 0;
  for (const std::string mark : {"/Type /Page\n", "/Type /Page "}) {
    for (std::size_t at = pdf.find(mark); at != std::string::npos;
         at = pdf.find(mark, at + 1)) {
      ++n;
    }
  }
  return n;
}

TEST(ReportPage, IsQuietAsksForNothingAndPrints) {
  const std::string browser = FindBrowser();
  if (browser.empty()) GTEST_SKIP() << "chromium is not installed";
  const TemporaryFolder folder;
  const auto ran = RunProgram("report --paper-table1 --out " +
                              (folder.path() / "report").string());
  ASSERT_EQ(ran.status, 0) << ran.err;
  const Visit visit =
      Print(browser, folder.path() / "report" / "table1.html", folder.path());
  EXPECT_EQ(visit.status, 0) << ReadAll(folder.path() / "log");
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_THAT(visit.requests, IsEmpty());
  EXPECT_THAT(visit.pdf.substr(0, 8), HasSubstr("%PDF-"));
  // Page 1, Table 1, two groups, the annexes: on A4 from 6 to 14 pages.
  EXPECT_GE(CountPages(visit.pdf), 6);
  EXPECT_LE(CountPages(visit.pdf), 14);
}

TEST(ReportPage, ThePdfIsTaggedAndHasAnOutline) {
  if (FindBrowser().empty()) GTEST_SKIP() << "chromium is not installed";
  const TemporaryFolder folder;
  const auto ran = RunProgram("report --paper-table1 --pdf --json --out " +
                              (folder.path() / "report").string());
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("table1.pdf"));
  const std::string pdf = ReadAll(folder.path() / "report" / "table1.pdf");
  for (const char* part :
       {"%PDF-", "/StructTreeRoot", "/Outlines", "/Lang (en"}) {
    EXPECT_THAT(pdf, HasSubstr(part));
  }
  EXPECT_GE(CountPages(pdf), 6);
}

TEST(ReportPage, APageOfEvidenceIsQuietAndPrints) {
  const std::string browser = FindBrowser();
  if (browser.empty()) GTEST_SKIP() << "chromium is not installed";
  const TemporaryFolder folder;
  const auto ran = RunProgram("report --paper-table1 --evidence --out " +
                              (folder.path() / "report").string());
  ASSERT_EQ(ran.status, 0) << ran.err;
  const std::filesystem::directory_iterator pages(folder.path() / "report" /
                                                  "evidence");
  const Visit visit = Print(browser, pages->path(), folder.path());
  EXPECT_EQ(visit.status, 0) << ReadAll(folder.path() / "log");
  EXPECT_THAT(visit.console, IsEmpty());
  EXPECT_THAT(visit.requests, IsEmpty());
  EXPECT_GE(CountPages(visit.pdf), 1);
  EXPECT_LE(CountPages(visit.pdf), 2);
}

// That the test above can fail.
TEST(ReportPage, ALoudPageIsHeard) {
  const std::string browser = FindBrowser();
  if (browser.empty()) GTEST_SKIP() << "chromium is not installed";
  const TemporaryFolder folder;
  const auto page = folder.path() / "loud.html";
  // Nobody listens on the discard port of this machine.
  std::ofstream(page) << "<!DOCTYPE html><script>console.error('aloud')"
                         "</script><img src=\"http://127.0.0.1:9/x.png\">";
  const Visit visit = Print(browser, page, folder.path());
  ASSERT_FALSE(visit.console.empty());
  EXPECT_THAT(visit.console.front(), HasSubstr("aloud"));
  EXPECT_FALSE(visit.requests.empty());
  EXPECT_EQ(CountPages(visit.pdf), 1);
}

}  // namespace
}  // namespace touchdown
