// `touchdown rig` from outside: what people and scripts see.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/shared_data.h"

namespace touchdown {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Ran {
  int status = -1;
  std::string out;  // stdout, or stderr where asked for
};

Ran Rig(const std::string& arguments, bool errors = false) {
  const std::string command = std::string(TOUCHDOWN_BINARY) + " rig " +
                              arguments +
                              (errors ? " 2>&1 >/dev/null" : " 2>/dev/null");
  Ran ran;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer{};
  while (const std::size_t n =
             std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    ran.out.append(buffer.data(), n);
  }
  ran.status = WEXITSTATUS(pclose(pipe));
  return ran;
}

// A file that lives as long as the test.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("touchdown-" + std::to_string(getpid()) + "-" + name)) {
    std::ofstream(path_) << text;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

using CsvRow = std::map<std::string, std::string>;

std::vector<CsvRow> ParseCsv(const std::string& text) {
  std::vector<CsvRow> rows;
  std::vector<std::string> header;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '\r') continue;
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        cells.emplace_back();
      } else {
        cells.back() += c;
      }
    }
    if (header.empty()) {
      header = cells;
      continue;
    }
    CsvRow row;
    for (std::size_t i = 0; i < header.size(); ++i) row[header[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

// Deterministic columns: 8 rounding errors, times the cancellation where
// gravity nearly eats the springs' energy (SP09: 2 parts in 1000 are left, and
// of v_gravity 1 in 100); `range` against the shot's length, since that of a
// vertical shot is 0.
constexpr double kEps = 2.3e-16;

double Tolerance(const std::string& column, const CsvRow& reference) {
  const double value = std::abs(std::stod(reference.at(column)));
  if (column.starts_with("MC_")) {
    // Both are random; ours has fewer draws than the reference's 2e6.
    const double u = std::stod(reference.at("MC_u_rel"));
    const double m = 200'000.0;
    if (column == "MC_mean_over_v") return 5.0 * u / std::sqrt(m);
    if (column == "MC_u_rel") return 5.0 * u / std::sqrt(2.0 * m);
    if (column == "MC_se_of_u") return 0.0;  // by its formula, below
    return 5.0 * 2.67 * u / std::sqrt(m);    // 2.5 % and 97.5 % quantiles
  }
  if (column == "coil_clearance_left_m") return 1e-17;  // a rounding of L0
  if (column == "range") {
    const double v = std::stod(reference.at("impact_speed"));
    return 8.0 * kEps * v * std::stod(reference.at("flight_time"));
  }
  const bool after_launch = column == "v_gravity" || column == "v_full" ||
                            column == "impact_speed" || column == "flight_time";
  if (after_launch) {
    // d(v^2)/v^2 = energy/(m v^2/2) times that of the terms.
    const double v =
        std::stod(reference.at(column == "v_gravity" ? "v_gravity" : "v_full"));
    const double energy = std::stod(reference.at("spring_energy_J"));
    const double left = 0.5 * std::stod(reference.at("m")) * v * v;
    return (8.0 + 4.0 * energy / left) * kEps * value;
  }
  return 8.0 * kEps * value;
}

TEST(RigCases, EveryRowAndColumnOfReference) {
  const auto path = testing::Shared("reference/data/spring_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  const auto reference = ParseCsv(text.str());
  const Ran ran = Rig("spring --draws 200000 --cases '" + path.string() + "'");
  ASSERT_EQ(ran.status, 0);
  const auto result = ParseCsv(ran.out);
  ASSERT_EQ(result.size(), reference.size());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (const auto& [column, text_of] : result[i]) {
      if (column == "allowed" || column == "findings" ||
          column == "leaves_muzzle") {
        continue;
      }
      ASSERT_TRUE(reference[i].contains(column)) << column;
      if (column == "id") {
        EXPECT_EQ(text_of, reference[i].at("id"));
        continue;
      }
      const double expected = std::stod(reference[i].at(column));
      const double actual = std::stod(text_of);
      ++compared;
      if (std::isnan(expected)) {
        EXPECT_TRUE(std::isnan(actual)) << result[i].at("id") << column;
      } else if (column == "MC_se_of_u") {
        EXPECT_NEAR(actual,
                    std::stod(result[i].at("MC_u_rel")) / std::sqrt(4e5),
                    1e-18);
      } else {
        EXPECT_NEAR(actual, expected, Tolerance(column, reference[i]))
            << result[i].at("id") << " " << column;
      }
    }
  }
  // Every column that the reference has beyond its 23 inputs.
  EXPECT_EQ(compared, result.size() * (reference[0].size() - 23));
}

constexpr const char* kCasesHeader =
    "id,G,d,n_active,n_total,D_outer,X,preload_X0,m,theta_deg,h0,rho_spring,"
    "eta,mu_barrel,g,n_springs,urel_G,urel_d,urel_n,urel_D,urel_X,urel_m,L0_m";

// SP01 and SP10, so that a checkout without the reference tests the door too.
TEST(RigCases, InlineRows) {
  const TemporaryFile in(
      "inline.csv",
      std::string(kCasesHeader) +
          "\nSP01,79300000000,0.002,10,12,0.018,0.05,0,0.1,0,0.5,7850,1,0,9.81,"
          "2,0.01,0.005,0.01,0.005,0.01,0.002,0.1\n"
          "SP10,79300000000,0.002,10,12,0.018,0.08,0,0.1,10,0.5,7850,1,0,9.81,"
          "2,0.01,0.005,0.01,0.005,0.01,0.002,0.1\n");
  const Ran ran = Rig("spring --draws 1000 --cases " + in.path());
  ASSERT_EQ(ran.status, 0);
  const auto rows = ParseCsv(ran.out);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(std::stod(rows[0].at("H_mean")), 7744.140625, 1e-11);
  EXPECT_NEAR(std::stod(rows[0].at("v_full")), 13.271628881356258, 2e-14);
  EXPECT_NEAR(std::stod(rows[0].at("impact_angle_deg")), 13.278785334840827,
              2e-14);
  EXPECT_EQ(rows[0].at("allowed"), "yes");
  EXPECT_EQ(rows[1].at("allowed"), "no");
  EXPECT_THAT(rows[1].at("findings"), HasSubstr("coil bind"));
  // Repeatable to the byte; another seed moves the MC_ columns only.
  EXPECT_EQ(ran.out, Rig("spring --draws 1000 --cases " + in.path()).out);
  const auto other =
      ParseCsv(Rig("spring --draws 1000 --seed 7 --cases " + in.path()).out);
  EXPECT_NE(other[0].at("MC_u_rel"), rows[0].at("MC_u_rel"));
  EXPECT_EQ(other[0].at("v_full"), rows[0].at("v_full"));
}

TEST(RigCases, HexWinsAndLossesCount) {
  // X_hex = 0.05 against a decimal that is wrong; eta and mu_barrel by hand:
  // v^2 = (0.8 19.3603515625 - 2 0.25 0.1 9.81 0.05)/(m + m_s/3).
  const TemporaryFile in(
      "hex.csv",
      std::string(kCasesHeader) +
          ",X_hex\nA,79300000000,0.002,10,12,0.018,7,0,0.1,0,0.5,7850,0.8,0.25,"
          "9.81,2,0,0,0,0,0,0,,0x1.999999999999ap-5\n");
  const auto rows = ParseCsv(Rig("spring --draws 10 --cases " + in.path()).out);
  ASSERT_EQ(rows.size(), 1u);
  const double v2 = (0.8 * 19.3603515625 - 2.0 * 0.25 * 0.1 * 9.81 * 0.05) /
                    (0.1 + 0.029750935506643761 / 3.0);
  EXPECT_NEAR(std::stod(rows[0].at("v_full")), std::sqrt(v2), 1e-13);
  EXPECT_EQ(rows[0].at("coil_clearance_left_m"), "");  // no L0 given
  EXPECT_EQ(std::stod(rows[0].at("MC_u_rel")), 0.0);
}

// What would be of no effect is refused.
TEST(RigCases, TheFileHasTheRigs) {
  for (const char* flag : {"--json", "--wire-mm 2", "--compression-mm 5"}) {
    const Ran ran = Rig(std::string("spring --cases x.csv ") + flag, true);
    EXPECT_EQ(ran.status, 2) << flag;
    EXPECT_THAT(ran.out, HasSubstr("goes without --cases")) << flag;
    EXPECT_THAT(ran.out, HasSubstr(std::string(flag).substr(0, 6))) << flag;
  }
}

TEST(RigCases, BadFilesAreNamed) {
  Ran ran = Rig("spring --cases /no/such.csv", true);
  EXPECT_EQ(ran.status, 3);
  EXPECT_EQ(
      ran.out,
      "touchdown: /no/such.csv: cannot be read: No such file or directory\n");
  const TemporaryFile word("word.csv", std::string(kCasesHeader) +
                                           "\nA,abc,0,0,0,0,0,0,0,0,0,0,0,0,0,"
                                           "0,0,0,0,0,0,0,0\n");
  ran = Rig("spring --cases " + word.path(), true);
  EXPECT_EQ(ran.status, 3);
  EXPECT_THAT(
      ran.out,
      HasSubstr("line 2, column G: is 'abc', expected a finite number"));
  const TemporaryFile negative(
      "negative.csv", std::string(kCasesHeader) +
                          "\nB7,79e9,-0.002,10,12,0.018,0.05,0,0.1,0,0.5,7850,"
                          "1,0,9.81,2,0,0,0,0,0,0,0.1\n");
  ran = Rig("spring --cases " + negative.path(), true);
  EXPECT_EQ(ran.status, 3);
  EXPECT_THAT(ran.out, HasSubstr(": line 2: wire_diameter_m is -0.002"));
  const TemporaryFile lacking("lacking.csv", "id,G\nA,1\n");
  ran = Rig("spring --cases " + lacking.path(), true);
  EXPECT_EQ(ran.status, 3);
  EXPECT_THAT(ran.out, HasSubstr(": header: there is no column 'd'"));
  const TemporaryFile ragged("ragged.csv", "id,G\nA,1,2\n");
  ran = Rig("spring --cases " + ragged.path(), true);
  EXPECT_THAT(ran.out,
              HasSubstr(": line 2: has 3 cells; expected 2 as in the header"));
  const TemporaryFile open_quote("quote.csv", "id,G\n\"A,1\n");
  EXPECT_THAT(Rig("spring --cases " + open_quote.path(), true).out,
              HasSubstr(": row 2: a quote is left open"));
  const TemporaryFile empty("empty.csv", "");
  EXPECT_EQ(Rig("spring --cases " + empty.path(), true).status, 3);
}

TEST(RigCommand, ExampleFeedsTheOthers) {
  const Ran example = Rig("example");
  ASSERT_EQ(example.status, 0);
  const TemporaryFile toml("rig.toml", example.out);
  const std::string rig = " --draws 2000 --json --rig " + toml.path();
  const auto spring = nlohmann::json::parse(Rig("spring" + rig).out);
  EXPECT_EQ(spring["schema"], "touchdown.rig.spring/1");
  EXPECT_NEAR(spring["stiffness_n_per_m"]["value"], 7744.140625, 1e-9);
  EXPECT_GT(spring["stiffness_n_per_m"]["u"], 0.0);
  EXPECT_EQ(spring["allowed"], true);  // 841 MPa at the trigger's end
  const auto launch = nlohmann::json::parse(
      Rig("launch --speed-mps 6 --height-mm 300" + rig).out);
  EXPECT_EQ(launch["schema"], "touchdown.rig.launch/1");
  EXPECT_NEAR(launch["contact"]["launch_speed_mps"]["value"], 6.0, 1e-12);
  EXPECT_EQ(launch["contact"]["corner"], "flush");
  const auto plan = nlohmann::json::parse(
      Rig("plan --angle-deg 10,30 --speed-mps 4" + rig).out);
  EXPECT_EQ(plan["schema"], "touchdown.rig.plan/1");
  EXPECT_EQ(plan["angle_kind"], "radius");
  ASSERT_EQ(plan["set_points"].size(), 2u);
  EXPECT_EQ(plan["set_points"][0]["possible"], false);
  EXPECT_THAT(std::string(plan["set_points"][0]["reason"]),
              HasSubstr("at least atan(short/long)"));
  const auto& contact = plan["set_points"][1]["contact"];
  EXPECT_NEAR(contact["radius_angle_deg"]["value"], 30.0, 1e-9);
  EXPECT_TRUE(
      contact["radius_angle_deg"]["monte_carlo"].contains("interval95"));
  EXPECT_FALSE(contact["radius_angle_deg"]["budget"].empty());
}

TEST(RigCommand, APlanIsALineForEachAngleAndTheRestWithAll) {
  const TemporaryFile toml("rig.toml", Rig("example").out);
  const std::string plan =
      "plan --angle-deg 10,30 --speed-mps 4 --draws 2000 --rig " + toml.path();
  const Ran brief = Rig(plan);
  ASSERT_EQ(brief.status, 0);
  EXPECT_EQ(std::ranges::count(brief.out, '\n'), 3) << brief.out;
  EXPECT_THAT(brief.out, HasSubstr("10 deg: REFUSED: "));
  EXPECT_THAT(brief.out, HasSubstr("mm; lands at 30."));
  EXPECT_THAT(brief.out, ::testing::Not(HasSubstr("flight time")));
  EXPECT_THAT(Rig(plan + " --all").out, HasSubstr("flight time"));
}

TEST(RigCommand, DirectFlagsWithoutAFile) {
  const Ran ran = Rig(
      "launch --json --draws 1000 --shear-modulus-gpa 79.3 --wire-mm 2.0+-0.01 "
      "--coil-mm 18 --coil-diameter outer --active-coils 10 --mass-g 100 "
      "--gravity-mps2 9.81 --compression-mm 50");
  ASSERT_EQ(ran.status, 0);
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_NEAR(json["contact"]["launch_speed_mps"]["value"], 13.271628881356258,
              1e-12);
  // 0.5 % on the wire: its exponent 2.1875 less what m_s/3 takes back.
  EXPECT_NEAR(json["contact"]["launch_speed_mps"]["u"].get<double>() / 13.27,
              0.0104, 6e-4);
  EXPECT_EQ(json["contact"]["approach_angle_deg"], nullptr);
  EXPECT_EQ(json["contact"]["absent"]["approach_angle_deg"], "no --height-mm");
  EXPECT_NEAR(json["ideal_speed_mps"], 13.914148038058244, 1e-12);
}

TEST(RigCommand, NotLeavingTheMuzzleIsAResult) {
  const std::string heavy =
      "launch --draws 100 --stiffness-n-per-m 53.5 --mass-g 1000 "
      "--elevation-deg 90 --compression-mm 50";
  const Ran text = Rig(heavy);
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("does not leave the muzzle"));
  const auto json = nlohmann::json::parse(Rig(heavy + " --json").out);
  EXPECT_EQ(json["leaves_muzzle"], false);
  EXPECT_EQ(json["contact"]["launch_speed_mps"], nullptr);
  EXPECT_EQ(text.out.find("nan"), std::string::npos);
}

TEST(RigCommand, Calibrates) {
  std::string forces = "compression_mm,force_n\n";
  std::string speeds = "compression_mm,speed_mps,u_speed_mps\n";
  for (int x = 10; x <= 50; x += 10) {
    forces += std::to_string(x) + "," + std::to_string(7.744 * x + 2.0) + "\n";
    speeds += std::to_string(x) + "," +
              std::to_string(
                  std::sqrt((0.9 * 7744.0 * x * x * 1e-6 - 2.0 * 0.02) / 0.1)) +
              ",0.01\n";
  }
  const TemporaryFile force("force.csv", forces);
  const TemporaryFile speed("speed.csv", speeds);
  const Ran ran =
      Rig("calibrate --json --stiffness-n-per-m 7744 --mass-g 100 "
          "--force " +
          force.path() + " --speeds " + speed.path());
  ASSERT_EQ(ran.status, 0);
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_NEAR(json["stiffness"]["stiffness_n_per_m"]["value"], 7744.0, 1e-3);
  EXPECT_NEAR(json["stiffness"]["force_at_zero_n"]["value"], 2.0, 1e-4);
  EXPECT_NEAR(json["efficiency"]["efficiency"]["value"], 0.9, 1e-6);
  EXPECT_NEAR(json["efficiency"]["loss_j"]["value"], 0.02, 1e-5);
}

TEST(RigCommand, MistakesAreOneLine) {
  const TemporaryFile toml("bad.toml", "schema = \"touchdown.rig/1\"\nx = 1\n");
  const std::vector<std::pair<std::string, std::string>> usage{
      {"launch --compression-mm 5", "--shear-modulus-gpa is missing"},
      {"launch --stiffness-n-per-m 10 --mass-g 1", "give either"},
      {"launch --stiffness-n-per-m 10 --compression-mm 5",
       "--mass-g is missing"},
      {"launch --stiffness-n-per-m ten --mass-g 1 --compression-mm 5",
       "--stiffness-n-per-m is 'ten', must be a number"},
      {"launch --stiffness-n-per-m 10+--1 --mass-g 1 --compression-mm 5",
       "its uncertainty must be at least 0"},
      {"launch --stiffness-n-per-m 10 --mass-g 1 --compression-mm -5",
       "compression_m is -0.005"},
      {"launch --stiffness-n-per-m 10 --mass-g 1 --compression-mm 5 --draws 1",
       "--draws is 1"},
      {"spring --coil-diameter D2 --shear-modulus-gpa 79 --wire-mm 2 --coil-mm "
       "18 --active-coils 10",
       "--coil-diameter is \"D2\", must be mean, outer or inner"},
      {"calibrate", "give --force"},
      {"plan --angle-deg 10 --speed-mps 4", "--rig is required"},
      {"nonsense", ""},
  };
  for (const auto& [arguments, what] : usage) {
    const Ran ran = Rig(arguments, true);
    EXPECT_EQ(ran.status, 2) << arguments << ": " << ran.out;
    EXPECT_THAT(ran.out, StartsWith("touchdown: ")) << arguments;
    EXPECT_THAT(ran.out, HasSubstr(what)) << arguments;
    EXPECT_EQ(std::count(ran.out.begin(), ran.out.end(), '\n'), 1) << ran.out;
  }
  const Ran input = Rig("spring --rig " + toml.path(), true);
  EXPECT_EQ(input.status, 3);
  EXPECT_THAT(input.out, HasSubstr("bad.toml:2: unknown key x, expected one"));
  EXPECT_EQ(std::count(input.out.begin(), input.out.end(), '\n'), 1);
}

}  // namespace
}  // namespace touchdown
