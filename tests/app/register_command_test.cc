// The register and the conditions of a trial, as a user enters them; and what
// must not become of a text that people type.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "touchdown/rig/description.h"

namespace touchdown {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class RegisterCommand : public ::testing::Test {
 protected:
  testing::ProgramResult Run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), TOUCHDOWN_BINARY);
    return testing::RunProgram(arguments, scratch_.path());
  }
  std::string Done(const std::vector<std::string>& arguments) const {
    const auto ran = Run(arguments);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.out;
  }
  void ExpectMistake(const std::vector<std::string>& arguments, int status,
                     const std::string& says) const {
    const auto ran = Run(arguments);
    EXPECT_EQ(ran.status, status) << says;
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, AllOf(StartsWith("touchdown: "), HasSubstr(says)));
    EXPECT_EQ(std::ranges::count(ran.err, '\n'), 1) << ran.err;
  }
  std::string Db() const { return folder_ / "lab.db"; }

  testing::TemporaryFolder folder_;
  testing::TemporaryFolder scratch_;
};

TEST_F(RegisterCommand, ATrialKeepsTheSpringOfItsTime) {
  const auto rig = folder_.Write("rig.toml", rig::ExampleDescription());
  Done({"register", "add", "rig", "R1", "--db", Db(), "--by", "Ada", "--file",
        rig.string()});
  Done({"register", "add", "spring", "S 3", "--db", Db(), "--by", "Ada",
        "--rig", "R1", "--wire-diameter-mm", "2+-0.01", "--stiffness-n-per-m",
        "1200+-5", "--coil-diameter-kind", "outer"});
  Done({"register", "add", "operator", "Bob", "--db", Db(), "--by", "Ada"});
  const std::string logged =
      Done({"log",         "--db",
            Db(),          "--body",
            "sphere",      "--state",
            "bounce",      "--by",
            "Bob",         "--json",
            "--condition", "spring=S 3",
            "--condition", "rig=R1",
            "--condition", "operator=Bob",
            "--condition", "temperature_c=21.5+-0.5",
            "--condition", "relative_humidity=0.45+-0.02",
            "--condition", "anomaly=other",
            "--condition", "anomaly_note=a fly"});
  const std::string id = nlohmann::json::parse(logged).at("id");
  const std::string changed =
      Done({"register", "change", "spring", "S 3", "--db", Db(), "--by", "Eve",
            "--why", "measured again", "--stiffness-n-per-m", "1150+-5"});
  EXPECT_THAT(changed, HasSubstr("by Eve: measured again"));
  // One line for each version.
  EXPECT_EQ(std::ranges::count(Done({"register", "show", "spring", "S 3",
                                     "--db", Db(), "--json", "--history"}),
                               '\n'),
            2);
  EXPECT_THAT(
      Done({"register", "show", "spring", "S 3", "--db", Db(), "--history"}),
      AllOf(HasSubstr("wire_diameter_mm    2.000 +- 0.010"),
            HasSubstr("stiffness_n_per_m: 1200 +- 5 -> 1150 +- 5")));
  EXPECT_THAT(Done({"show", id, "--db", Db()}),
              AllOf(HasSubstr("S 3 ("), HasSubstr("21.50 +- 0.50"),
                    HasSubstr("45.0 +- 2.0"), HasSubstr("other: a fly")));
  EXPECT_THAT(Done({"register", "list", "--db", Db()}),
              AllOf(HasSubstr("R1"), HasSubstr("Bob"), HasSubstr("S 3")));
  EXPECT_THAT(Done({"register", "list", "camera", "--db", Db()}),
              Not(HasSubstr("S 3")));
  // A correction changes what it names and nothing else.
  Done({"correct", id, "--db", Db(), "--by", "Ada", "--why", "it was a moth",
        "--condition", "anomaly_note=a moth"});
  EXPECT_THAT(
      Done({"show", id, "--db", Db(), "--history"}),
      AllOf(HasSubstr("conditions: anomaly_note: a fly -> a moth"),
            HasSubstr("45.0 +- 2.0"), Not(HasSubstr("conditions: spring"))));
  // All of it comes over, version by version.
  const std::string all = Done({"export", "--db", Db(), "--format", "jsonl"});
  const auto file = folder_.Write("all.jsonl", all);
  const std::string other = folder_ / "other.db";
  EXPECT_THAT(Done({"import", file.string(), "--db", other}),
              HasSubstr("4 versions of the register"));
  EXPECT_EQ(Done({"export", "--db", other, "--format", "jsonl"}).substr(100),
            all.substr(100));
  EXPECT_THAT(Done({"db", "merge", "--db", other, Db()}),
              HasSubstr("0 versions of the register"));
  EXPECT_THAT(Done({"db", "check", "--db", other}), HasSubstr("is sound"));
}

TEST_F(RegisterCommand, MistakesAreOneLineAndMakeNoStore) {
  ExpectMistake({"register", "add", "surface", "x", "--db", Db(), "--by", "A",
                 "--condition", "slippery"},
                2, "condition is 'slippery', must be dry");
  ExpectMistake({"register", "add", "surface", "x", "--db", Db(), "--by", "A",
                 "--friction", "0.7"},
                2, "a number with its standard uncertainty");
  ExpectMistake({"register", "add", "body", "x", "--db", Db(), "--by", "A",
                 "--mass-g", "-1000+-100"},
                2, "mass_kg is -1");
  ExpectMistake({"register", "add", "calibration", "x", "--db", Db(), "--by",
                 "A", "--file", folder_ / "none.json"},
                3, "none.json");
  ExpectMistake({"register", "add", "spring", "x", "--db", Db(), "--by", "A",
                 "--rig", "R9"},
                4, "there is no such trial store");
  ExpectMistake({"log", "--db", Db(), "--body", "sphere", "--state", "bounce",
                 "--by", "A", "--condition", "weather=fine"},
                2, "--condition is 'weather=fine', must be KEY=VALUE");
  ExpectMistake({"log", "--db", Db(), "--body", "sphere", "--state", "bounce",
                 "--by", "A", "--condition", "temperature_c=-300+-1"},
                2, "temperature_k");
  ExpectMistake({"log", "--db", Db(), "--body", "sphere", "--state", "bounce",
                 "--by", "A", "--condition", "rig=R9"},
                4, "there is no such trial store");
  EXPECT_FALSE(std::filesystem::exists(Db()));
  Done({"register", "add", "rig", "R1", "--db", Db(), "--by", "A"});
  ExpectMistake({"register", "add", "rig", "R1", "--db", Db(), "--by", "A"}, 4,
                "there is a rig 'R1' already");
  ExpectMistake({"register", "change", "rig", "R1", "--db", Db(), "--by", "A",
                 "--why", "w"},
                2, "nothing of rig 'R1' would change");
  ExpectMistake({"register", "show", "rig", "R9", "--db", Db()}, 4,
                "there is no rig 'R9'");
  ExpectMistake({"register", "list", "boat", "--db", Db()}, 2,
                "KIND is 'boat', must be rig, camera");
  ExpectMistake({"log", "--db", Db(), "--body", "sphere", "--state", "bounce",
                 "--by", "A", "--condition", "rig=R9"},
                2, "rig is 'R9', must be a rig of the register");
}

// Through every text that a person can type: SQL, HTML, formulas, shells,
// terminals. Each is kept as it is, and harms no reader.
class HostileText : public RegisterCommand,
                    public ::testing::WithParamInterface<std::string> {};

INSTANTIATE_TEST_SUITE_P(
    EveryKind, HostileText,
    ::testing::Values("'); DROP TABLE trials; --",
                      "<script>alert(1)</script><img src=x onerror=alert(1)>",
                      "=HYPERLINK(\"http://x\")", "@SUM(A1)",
                      "$(touch harmed); `touch harmed` | touch harmed",
                      "two\nlines\r\x1b[2J", "\xc3\x9c\"ber'ma\xc3\x9f",
                      "\xff not UTF-8"));

TEST_P(HostileText, IsKeptAndHarmsNobody) {
  const std::string& text = GetParam();
  // A text that begins with a dash would be taken for a flag.
  const std::string db = folder_ / ("a" + text.substr(0, 9));
  const std::vector<std::string> store = {"--db", db};
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), store.begin(), store.end());
    return Done(arguments);
  };
  run({"register", "add", "surface", text, "--by", text, "--note", text,
       "--friction-method", text});
  run({"register", "change", "surface", text, "--by", text, "--why", text,
       "--note", "x" + text});
  run({"campaign", "new", text, "--body", "sphere", "--diameter-mm", "40",
       "--surface", text, "--theory", text, "--theory-boundary-deg", "20"});
  const std::string id = nlohmann::json::parse(
      run({"log", "--campaign", text, "--angle-deg", "20", "--angle-u-deg",
           "0.5", "--state", "bounce", "--by", text, "--note", text,
           "--condition", "surface=" + text, "--condition",
           "anomaly_note=" + text, "--json"}))["id"];
  run({"correct", id, "--by", text, "--why", text, "--state", "slide"});
  run({"correct", id, "--by", text, "--why", text, "--exclude"});
  run({"correct", id, "--by", text, "--why", text, "--include"});
  EXPECT_THAT(run({"db", "check"}), HasSubstr("is sound"));
  for (const auto& shown :
       {run({"show", id, "--history"}), run({"list"}),
        run({"register", "list"}), run({"campaign", "list"}),
        run({"register", "show", "surface", text, "--history"})}) {
    EXPECT_THAT(shown, Not(HasSubstr("\x1b")));
    EXPECT_THAT(shown, Not(HasSubstr("\r")));
    EXPECT_THAT(shown, Not(HasSubstr("two\nlines")));
  }
  // Lossless there and back.
  const std::string all = run({"export", "--format", "jsonl"});
  const auto file = folder_.Write("all", all);
  const std::string other = folder_ / "other";
  Done({"import", file.string(), "--format", "jsonl", "--db", other});
  EXPECT_EQ(Done({"export", "--db", other, "--format", "jsonl"}).substr(100),
            all.substr(100));
  const std::string csv = run({"export", "--format", "csv"});
  EXPECT_THAT(csv, Not(HasSubstr(",=")));
  EXPECT_THAT(csv, Not(HasSubstr(",\"=")));
  EXPECT_THAT(csv, Not(HasSubstr(",@")));
  const std::string report = folder_ / "report";
  run({"report", "--out", report});
  for (const auto& one :
       std::filesystem::recursive_directory_iterator(report)) {
    const std::string page = testing::ReadAll(one.path());
    if (one.path().extension() == ".html") {
      EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
      EXPECT_THAT(page, Not(HasSubstr("<img src=x")));
    }
    if (one.path().extension() == ".csv") {
      EXPECT_THAT(page, Not(HasSubstr(",=")));
      EXPECT_THAT(page, Not(HasSubstr("\n=")));
    }
  }
  EXPECT_FALSE(std::filesystem::exists("harmed"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "harmed"));
}

}  // namespace
}  // namespace touchdown
