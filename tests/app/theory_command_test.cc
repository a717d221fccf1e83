// `touchdown theory` as a user meets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/csv.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

namespace touchdown {
namespace {

using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::Row;

constexpr double kUlp = 0x1p-53;

class TheoryCommand : public ::testing::Test {
 protected:
  TheoryCommand()
      : folder_(
            std::filesystem::temp_directory_path() /
            ("touchdown_theory_" + std::to_string(getpid()) + "_" +
             ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~TheoryCommand() override {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }

  ProgramResult Theory(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {TOUCHDOWN_BINARY, "theory"});
    return testing::RunProgram(std::move(arguments), folder_);
  }

  nlohmann::json TheoryJson(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const ProgramResult r = Theory(std::move(arguments));
    EXPECT_EQ(r.status, 0) << r.err;
    return nlohmann::json::parse(r.out, nullptr, false);
  }

  std::string Write(const std::string& name, const std::string& text) {
    const std::string path = folder_ / name;
    std::ofstream(path) << text;
    return path;
  }

  void ExpectOneLine(const ProgramResult& r, int status) {
    EXPECT_EQ(r.status, status) << r.err;
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    EXPECT_TRUE(r.out.empty()) << r.out;
  }

  // Rows of the program's answer to a reference file, by id.
  std::map<std::string, Row> Answers(const std::string& command,
                                     const std::string& path) {
    const ProgramResult r = Theory({command, "--cases", path});
    EXPECT_EQ(r.status, 0) << r.err;
    std::map<std::string, Row> out;
    for (const Row& row : testing::ParseCsv(r.out)) {
      out[row.Text("id")] = row;
    }
    return out;
  }

  std::filesystem::path folder_;
};

// Every column of `columns` within `relative` of the reference.
void ExpectColumns(const Row& answer, const Row& reference,
                   const std::vector<std::string>& columns, double relative,
                   double scale) {
  for (const std::string& column : columns) {
    ASSERT_EQ(answer.Has(column), reference.Has(column)) << column;
    if (!answer.Has(column)) continue;
    const double value = answer.Number(column);
    const double truth = static_cast<double>(reference.Long(column));
    EXPECT_NEAR(value, truth,
                relative * (std::abs(truth) + scale) +
                    std::numeric_limits<double>::denorm_min())
        << column;
  }
}

TEST_F(TheoryCommand, RegimeCasesHoldAtTheAcceptance) {
  const auto path = testing::Shared("reference/data/lcp_hard_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto answers = Answers("regime", path);
  for (const Row& reference : testing::ReadCsv(path)) {
    const std::string& id = reference.Text("id");
    SCOPED_TRACE(id);
    ASSERT_TRUE(answers.count(id));
    const Row& answer = answers.at(id);
    const std::string& regime = answer.Text("regime");
    const std::string& exact = reference.Text("regime_exact");
    const std::string& tolerant = reference.Text("regime_with_tolerance");
    EXPECT_TRUE(regime == exact ||
                tolerant.substr(0, tolerant.find('(')) == regime);
    if (regime != exact) continue;
    EXPECT_EQ(answer.Text("n_solutions"), reference.Text("n_solutions"));
    const double condition =
        std::max({1.0, reference.Number("cond_B"),
                  reference.Has("cond_A") ? reference.Number("cond_A") : 1.0});
    for (const char* column : {"sol1_Fn", "sol2_Fn"}) {
      ASSERT_EQ(answer.Has(column), reference.Has(column));
      if (!reference.Has(column)) continue;
      const long double truth = reference.Long(column);
      if (std::abs(truth) > std::numeric_limits<double>::max()) continue;
      EXPECT_NEAR(answer.Number(column), static_cast<double>(truth),
                  16 * kUlp * condition * std::abs(static_cast<double>(truth)) +
                      std::numeric_limits<double>::denorm_min());
    }
  }
}

TEST_F(TheoryCommand, OtherCasesHold) {
  const auto data = [](const char* name) {
    return testing::Shared(std::string("reference/data/") + name);
  };
  if (!std::filesystem::exists(data("flat_cases.csv"))) {
    GTEST_SKIP() << data("flat_cases.csv") << " is not here";
  }
  struct File {
    const char* command;
    const char* name;
    std::vector<std::string> columns;
    double relative;
    double scale;
  };
  const std::vector<File> files = {
      {"flat",
       "flat_cases.csv",
       {"M_rr", "M_rf", "M_fr", "M_ff", "det", "slip*mu*H/L", "n_solutions",
        "s1_F_rear", "s1_F_front", "s1_gdd_rear", "s1_gdd_front"},
       16 * kUlp,
       1.0},
      {"impact",
       "impact_cases.csv",
       {"P_compress_per_m", "P_total_per_m", "T_total_per_m", "vN1", "vT1",
        "alphadot1"},
       64 * kUlp,
       5.0},
      {"boundary",
       "boundary_cases.csv",
       {"w=R*omega^2/g", "w-1", "alpha_b_rad", "alpha_b_deg", "dalpha_domega",
        "dalpha_dR", "dalpha_dg", "d2alpha_domega2", "rel_condition_wrt_omega"},
       16 * kUlp,
       0.0},
      {"boundary",
       "boundary_uncertainty.csv",
       {"w", "alpha_deg", "GUM_first_order_u_deg", "second_order_mean_deg",
        "P_no_boundary", "cond_mean_deg", "cond_std_deg", "cond_q2.5_deg",
        "cond_q97.5_deg"},
       1e-9,
       0.0},
  };
  for (const File& file : files) {
    const auto answers = Answers(file.command, data(file.name));
    for (const Row& reference : testing::ReadCsv(data(file.name))) {
      const std::string& id = reference.Text("id");
      SCOPED_TRACE(id);
      ASSERT_TRUE(answers.count(id));
      ExpectColumns(answers.at(id), reference, file.columns, file.relative,
                    file.scale);
      for (const char* column : {"s1_kind", "phases", "status"}) {
        if (!reference.cells.count(column)) continue;
        EXPECT_EQ(answers.at(id).Text(column), reference.Text(column));
      }
    }
  }
}

TEST_F(TheoryCommand, LcpCasesHold) {
  const auto path = testing::Shared("reference/data/lcp_anchor_cases.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const auto answers = Answers("lcp", path);
  for (const Row& reference : testing::ReadCsv(path)) {
    const std::string& name = reference.Text("name");
    ASSERT_TRUE(answers.count(name)) << name;
    for (const char* column : {"n_basic_solutions", "n_singular_bases"}) {
      EXPECT_EQ(answers.at(name).Text(column), reference.Text(column)) << name;
    }
  }
}

TEST_F(TheoryCommand, HexadecimalWins) {
  const std::string path =
      Write("cases.csv",
            "id,alpha_rad,mu,slip_sign,m,R,omega,g,kappa_in,mu_hex\n"
            "a,1.0471975511965976,99,1,1,0.1,30,9.81,3,0x1.8p+0\n");
  const ProgramResult r = Theory({"regime", "--cases", path});
  ASSERT_EQ(r.status, 0) << r.err;
  const auto rows = testing::ParseCsv(r.out);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].Text("regime"), "INDETERMINATE");
  EXPECT_NEAR(rows[0].Number("sol2_Fn"), 343.136892420108405941546, 2e-11);
}

TEST_F(TheoryCommand, WrongCaseFilesAreNamed) {
  ProgramResult r = Theory({"flat", "--cases", Write("a.csv", "id,a\nx,1\n")});
  ExpectOneLine(r, 3);
  EXPECT_THAT(r.err, HasSubstr("a.csv: header: there is no column 'b'"));
  r = Theory({"flat", "--cases",
              Write("b.csv", "id,a,b,mu,slip_sign,m,g\nx,1,2,zero,1,1,9.8\n")});
  ExpectOneLine(r, 3);
  EXPECT_THAT(r.err, HasSubstr("b.csv: line 2, column mu: is 'zero'"));
  r = Theory({"flat", "--cases",
              Write("c.csv", "id,a,b,mu,slip_sign,m,g\nx,1,2,0.5,1,1\n")});
  ExpectOneLine(r, 3);
  EXPECT_THAT(r.err, HasSubstr("c.csv: line 2: has 6 cells"));
  r = Theory({"flat", "--cases",
              Write("d.csv", "id,a,b,mu,slip_sign,m,g\nx,-1,2,0.5,1,1,9.8\n")});
  ExpectOneLine(r, 3);
  EXPECT_THAT(r.err, HasSubstr("d.csv: line 2: length is -1 m"));
  r = Theory({"flat", "--cases", (folder_ / "none.csv").string()});
  ExpectOneLine(r, 3);
  r = Theory(
      {"lcp", "--cases", Write("e.csv", "name,M,q\nx,3,\"[\"\"1\"\"]\"")});
  ExpectOneLine(r, 3);
  EXPECT_THAT(r.err, HasSubstr("e.csv: line 2, column M"));
}

TEST_F(TheoryCommand, WrongUsageIsOneLine) {
  ExpectOneLine(Theory({"regime", "--mu", "1"}), 2);
  ExpectOneLine(Theory({"regime", "--alpha-deg", "30", "--mu", "-1", "--corner",
                        "leading", "--body", "rectangle"}),
                2);
  ExpectOneLine(Theory({"regime", "--alpha-deg", "30", "--body", "solid-sphere",
                        "--mu", "1", "--corner", "leading"}),
                2);
  ExpectOneLine(Theory({"boundary", "--model", "guess", "--body", "hoop"}), 2);
  ExpectOneLine(Theory({"boundary", "--model", "detectable-bounce", "--body",
                        "solid-sphere"}),
                2);
  ExpectOneLine(Theory({"lcp", "--matrix", "1,2;3", "--vector", "1,1"}), 2);
  ExpectOneLine(Theory({"map", "--body", "rectangle", "--corner", "leading"}),
                2);
  // A map has no --cases that could be advised.
  const ProgramResult map = Theory({"map", "--body", "rectangle", "--corner",
                                    "leading", "--over", "omega", "--mu", "1"});
  ExpectOneLine(map, 2);
  EXPECT_THAT(map.err, HasSubstr("--radius-m is missing; give it a value\n"));
}

// The velocity of the contact point, and what would give it, at once.
TEST_F(TheoryCommand, TheVelocityIsGivenOnce) {
  const std::vector<std::string> common = {
      "impact",    "--alpha-deg",   "46.57",   "--body",
      "rectangle", "--radius-m",    "0.03354", "--mu",
      "0.4",       "--restitution", "0.5",     "--tangential-mps",
      "5",         "--normal-mps",  "-2"};
  EXPECT_EQ(Theory(common).status, 0);
  for (const std::vector<std::string>& flag :
       {std::vector<std::string>{"--speed-mps", "6"},
        {"--approach-deg", "25"},
        {"--corner", "trailing"}}) {
    auto both = common;
    both.insert(both.end(), flag.begin(), flag.end());
    const ProgramResult r = Theory(both);
    ExpectOneLine(r, 2);
    EXPECT_THAT(r.err, HasSubstr(flag[0])) << flag[0];
  }
}

TEST_F(TheoryCommand, AnUnwritableOutputLeavesNothing) {
  const ProgramResult r =
      Theory({"flat", "--length-m", "0.1", "--height-m", "0.02", "--mu", "0.5",
              "--out", (folder_ / "nowhere" / "x.txt").string()});
  ExpectOneLine(r, 6);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "nowhere"));
}

// The worked examples of docs/theory.md.
TEST_F(TheoryCommand, SphereWithSpin) {
  const auto regime = TheoryJson(
      {"regime", "--body", "solid-sphere", "--mu", "0.4", "--corner", "leading",
       "--mass-kg", "0.26", "--radius-m", "0.02", "--omega-rad-per-s", "200"});
  EXPECT_EQ(regime["regime"], "SLIDE");
  EXPECT_NEAR(regime["solutions"][0]["normal_n"].get<double>(), 2.549729, 1e-6);
  const auto boundary =
      TheoryJson({"boundary", "--body", "solid-sphere", "--radius-m", "0.02",
                  "--omega-rad-per-s", "200", "--speed-mps", "6",
                  "--restitution", "0.5", "--bounce-height-m", "0.0008"});
  ASSERT_EQ(boundary["models"].size(), 5u);
  EXPECT_NEAR(boundary["models"][1]["boundary_deg"].get<double>(), 0.7023,
              1e-4);
  EXPECT_TRUE(boundary["models"][2]["boundary_deg"].is_null());
  EXPECT_NEAR(boundary["models"][4]["boundary_deg"].get<double>(), 2.393, 1e-3);
}

TEST_F(TheoryCommand, NoseUpAndNoseDown) {
  const std::vector<std::string> common = {
      "impact",    "--alpha-deg",    "46.57",   "--body",
      "rectangle", "--radius-m",     "0.03354", "--mu",
      "0.4",       "--restitution",  "0.5",     "--speed-mps",
      "6",         "--approach-deg", "25"};
  auto up = common;
  up.insert(up.end(), {"--corner", "trailing"});
  auto down = common;
  down.insert(down.end(), {"--corner", "leading"});
  const auto nose_up = TheoryJson(up);
  const auto nose_down = TheoryJson(down);
  EXPECT_EQ(nose_up["phases"], "slip-1>slip-1");
  // The trailing corner throws the front down, the leading one up and over.
  EXPECT_LT(nose_up["after"]["omega_rad_per_s"].get<double>(), 0.0);
  EXPECT_GT(nose_down["after"]["omega_rad_per_s"].get<double>(), 0.0);
}

TEST_F(TheoryCommand, MapWritesTableAndDrawings) {
  const std::string out = folder_ / "map";
  const ProgramResult r =
      Theory({"map", "--over", "omega", "--body", "rectangle", "--corner",
              "leading", "--mu", "1.6", "--radius-m", "0.05", "--alpha-points",
              "31", "--axis-points", "21", "--out", out});
  if (r.err.find("gnuplot") != std::string::npos) {
    GTEST_SKIP() << "gnuplot is not installed";
  }
  ASSERT_EQ(r.status, 0) << r.err;
  const auto rows = testing::ReadCsv(out + "/regime_map.csv");
  EXPECT_EQ(rows.size(), 31u * 21u);
  EXPECT_EQ(rows[0].Text("regime"), "SLIDE");
  for (const char* name : {"regime_map.svg", "fig2_complementarity.svg",
                           "fig6_sphere.svg", "fig7_rectangle.svg"}) {
    const std::string svg = testing::ReadText(out + "/" + name);
    EXPECT_THAT(svg, HasSubstr("<svg")) << name;
    EXPECT_THAT(svg, HasSubstr("</svg>")) << name;
  }
}

TEST_F(TheoryCommand, AFolderMayHaveAnyName) {
  const auto r = TheoryJson({"map", "--body", "rectangle", "--corner",
                             "leading", "--alpha-points", "3", "--axis-points",
                             "3", "--no-plots", "--out", folder_ / "m\xFFp"});
  EXPECT_THAT(r["files"][0].get<std::string>(), HasSubstr("regime_map.csv"));
}

TEST_F(TheoryCommand, MonteCarloIsReproducible) {
  const std::vector<std::string> arguments = {"boundary",
                                              "--model",
                                              "printed-equations",
                                              "--body",
                                              "rectangle",
                                              "--radius-m",
                                              "0.1",
                                              "--omega-rad-per-s",
                                              "10",
                                              "--u-omega-rad-per-s",
                                              "0.1",
                                              "--gravity-mps2",
                                              "9.81",
                                              "--seed",
                                              "7"};
  const auto a = TheoryJson(arguments);
  EXPECT_EQ(a, TheoryJson(arguments));
  const auto& u = a["models"][0]["uncertainty"];
  EXPECT_FALSE(u["first_order_is_valid"].get<bool>());
  EXPECT_NEAR(u["p_none"].get<double>(), 0.1699, 0.01);
}

}  // namespace
}  // namespace touchdown
