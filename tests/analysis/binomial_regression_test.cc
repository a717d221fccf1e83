#include "touchdown/analysis/statistics/binomial_regression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/analysis/reference_data.h"
#include "tests/support/shared_data.h"

namespace touchdown::analysis {
namespace {

using Rows = std::vector<BinomialRow>;

// Flour beetles, Bliss (1935): log10 of the dose, exposed, killed.
Rows Beetles() {
  return {{{1.6907}, 59, 6},  {{1.7242}, 60, 13}, {{1.7552}, 62, 18},
          {{1.7842}, 56, 28}, {{1.8113}, 63, 52}, {{1.8369}, 59, 53},
          {{1.8610}, 62, 61}, {{1.8839}, 60, 60}};
}

Rows RowsOf(const std::vector<Observation>& trials) {
  Rows out;
  for (const Observation& o : trials) {
    out.push_back({{o.angle_rad}, 1.0, o.p_bounce});
  }
  return out;
}

TEST(FitRegression, BeetlesProbit) {
  // Dobson, An Introduction to Generalized Linear Models: deviance 10.12.
  const Regression fit = FitRegression(Beetles());
  ASSERT_TRUE(fit.found());
  EXPECT_NEAR(fit.coefficients[0], -34.93526, 1e-5);
  EXPECT_NEAR(fit.coefficients[1], 19.72793, 1e-5);
  EXPECT_NEAR(fit.deviance, 10.1198, 1e-4);
  const auto median = FindEffectiveLevel(fit);
  ASSERT_TRUE(median.has_value());
  EXPECT_NEAR(median->value, 1.770852, 1e-6);
  EXPECT_NEAR(median->u, 0.003803, 1e-6);
  EXPECT_NEAR(median->fieller95->low, 1.763114, 1e-6);
  EXPECT_NEAR(median->fieller95->high, 1.778194, 1e-6);
  const auto profile = MedianLevelProfile(Beetles(), fit);
  EXPECT_NEAR(profile.low, 1.763268, 1e-6);
  EXPECT_NEAR(profile.high, 1.778170, 1e-6);
}

TEST(FitRegression, BeetlesLogit) {
  const Regression fit = FitRegression(Beetles(), {.link = Link::kLogit});
  ASSERT_TRUE(fit.found());
  EXPECT_NEAR(fit.coefficients[0], -60.71745, 1e-5);
  EXPECT_NEAR(fit.coefficients[1], 34.27033, 1e-5);
  EXPECT_NEAR(fit.deviance, 11.2322, 1e-4);
  EXPECT_NEAR(FindEffectiveLevel(fit)->value, 1.771721, 1e-6);
}

// Every fit with one term that R made: greatest likelihood and Firth's, both
// links, coefficients, deviance, delta method, Fieller and profile.
TEST(FitRegression, EveryFitOfTheReference) {
  const auto folder = testing::Shared("reference/data");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " not here";
  std::map<std::string, std::map<std::string, std::map<std::string, double>>>
      reference;
  for (const auto& row : ReadCsv(folder / "reference_estimates_R.csv")) {
    const bool fit = row[1].starts_with("MLE_") || row[1].starts_with("Firth_");
    if (fit && row[1] != "MLE_logit_sexF" && row[3] != "NA") {
      reference[row[0]][row[1]][row[2]] = std::stod(row[3]);
    }
  }
  const auto log10 = [](double x) { return std::log10(x); };
  int fits = 0;
  int numbers = 0;
  for (const auto& [name, methods] : reference) {
    const auto path = folder / (name + ".csv");
    const bool grouped_n = name.starts_with("bliss");
    Rows rows;
    if (grouped_n) {
      rows = Beetles();
    } else if (name.starts_with("finney")) {
      rows = RowsOf(ReadGroups(path, false, log10));
    } else if (name.starts_with("psignifit")) {
      rows = RowsOf(ReadGroups(path, true, [](double x) { return x; }));
    } else if (name.starts_with("hamada")) {
      rows = RowsOf(ReadTrials(path, log10));
    } else {
      rows = RowsOf(ReadTrials(path));
    }
    for (const auto& [method, values] : methods) {
      SCOPED_TRACE(name + " " + method);
      RegressionOptions options;
      options.firth = method.starts_with("Firth");
      options.link = method.ends_with("logit") ? Link::kLogit : Link::kProbit;
      const Regression fit = FitRegression(rows, options);
      ASSERT_TRUE(fit.found());
      const auto median = FindEffectiveLevel(fit);
      ASSERT_TRUE(median.has_value());
      core::Interval profile;
      if (!options.firth) profile = MedianLevelProfile(rows, fit);
      ++fits;
      for (const auto& [quantity, expected] : values) {
        SCOPED_TRACE(quantity);
        // R's glm stops where the deviance changes by 1e-8 of itself.
        double tolerance = 2e-5;
        double value = 0.0;
        if (quantity == "beta0") {
          value = fit.coefficients[0];
        } else if (quantity == "beta1") {
          value = fit.coefficients[1];
        } else if (quantity == "theta50") {
          value = median->value;
          tolerance = 2e-6;
        } else if (quantity == "theta50_se_delta") {
          value = median->u;
        } else if (quantity == "scale=1/beta1") {
          value = 1 / fit.coefficients[1];
        } else if (quantity == "loglik_kernel") {
          value = fit.log_likelihood;
          tolerance = 1e-8;
        } else if (quantity == "deviance") {
          // Of single trials: twice the likelihood; else of the groups.
          if (rows.size() > 10 && values.contains("loglik_kernel") &&
              std::abs(expected + 2 * values.at("loglik_kernel")) > 1e-3) {
            continue;
          }
          value = fit.deviance;
          tolerance = 1e-7;
        } else if (quantity == "fieller95_lo") {
          value = median->fieller95.value().low;
        } else if (quantity == "fieller95_hi") {
          value = median->fieller95.value().high;
        } else if (quantity == "LR95_lo") {
          value = profile.low;
        } else if (quantity == "LR95_hi") {
          value = profile.high;
        } else {
          FAIL() << "unknown quantity";
        }
        EXPECT_NEAR(value / expected, 1.0, tolerance);
        ++numbers;
      }
    }
  }
  EXPECT_GT(fits, 30);
  EXPECT_GT(numbers, 200);
  ::testing::Test::RecordProperty("numbers", numbers);
}

TEST(FitRegression, FirthGoesOutsideThePapersBracket) {
  // The decisive fact against it as the primary estimate: 16.36 deg, while the
  // paper's rectangle bounced at 11.8 (brglm2: logit 16.3606, probit 17.8848).
  const double x[] = {0, 3.9, 7.8, 11.8, 27.4, 43, 58.7, 74.4, 90};
  Rows rows;
  for (const double angle : x) {
    rows.push_back({{angle}, 1.0, angle > 8 ? 1.0 : 0.0});
  }
  const auto at = [&](Link link) {
    return *FindEffectiveLevel(FitRegression(rows, {link, true, true}));
  };
  EXPECT_NEAR(at(Link::kLogit).value, 16.3605512, 1e-6);
  EXPECT_NEAR(at(Link::kLogit).u, 12.4009864, 1e-5);
  EXPECT_NEAR(at(Link::kProbit).value, 17.8848236, 1e-6);
  EXPECT_NEAR(at(Link::kProbit).u, 14.4974209, 1e-5);
  // Without the adjustment there is nothing to find.
  EXPECT_EQ(FitRegression(rows).status, RegressionStatus::kNoMaximum);
  EXPECT_EQ(FitRegression(rows, {.link = Link::kLogit}).status,
            RegressionStatus::kNoMaximum);
}

// Heinze and Schemper (2002), Statistics in Medicine 21, 2409: endometrial
// cancer; NV separates.
TEST(FitRegression, EndometrialCancerByFirth) {
  const auto path =
      testing::Shared("reference/data/endometrial_heinze_schemper.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  Rows rows;
  const auto cells = ReadCsv(path);
  for (std::size_t i = 1; i < cells.size(); ++i) {
    rows.push_back({{std::stod(cells[i][0]), std::stod(cells[i][1]),
                     std::stod(cells[i][2])},
                    1.0,
                    std::stod(cells[i][3])});
  }
  EXPECT_EQ(FitRegression(rows, {.link = Link::kLogit}).status,
            RegressionStatus::kNoMaximum);
  const Regression fit = FitRegression(rows, {Link::kLogit, true, true});
  const double b[] = {3.774560, 2.929273, -0.0347518, -2.604164};
  const double u[] = {1.48869, 1.55076, 0.0395781, 0.776018};
  const double low[] = {1.082537, 0.609724, -0.124459, -4.365183};
  const double high[] = {7.209280, 7.854632, 0.040455, -1.232721};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(fit.coefficients[i], b[i], 1e-6);
    EXPECT_NEAR(fit.StandardError(i), u[i], 1e-5);
    const auto profile = CoefficientProfile(rows, fit, i);
    EXPECT_NEAR(profile.low, low[i], 2e-5);
    EXPECT_NEAR(profile.high, high[i], 2e-5);
  }
}

// The urinary tract infections of logistf's documentation: six terms.
TEST(FitRegression, SexaggByFirth) {
  const auto folder = testing::Shared("reference/data");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " not here";
  Rows rows;
  const auto cells = ReadCsv(folder / "sexagg_logistf.csv");
  for (std::size_t i = 1; i < cells.size(); ++i) {
    BinomialRow row;
    for (std::size_t j = 1; j <= 6; ++j) {
      row.terms.push_back(std::stod(cells[i][j]));
    }
    row.n = std::stod(cells[i][7]);
    row.yes = cells[i][0] == "1" ? row.n : 0.0;
    rows.push_back(std::move(row));
  }
  const Regression fit = FitRegression(rows, {Link::kLogit, true, true});
  std::size_t term = 0;
  for (const auto& row : ReadCsv(folder / "reference_firth_ppl.csv")) {
    if (row[0] != "sexagg") continue;
    SCOPED_TRACE(row[1]);
    EXPECT_NEAR(fit.coefficients[term], std::stod(row[2]), 1e-6);
    const auto profile = CoefficientProfile(rows, fit, term);
    EXPECT_NEAR(profile.low, std::stod(row[3]), 2e-5);
    EXPECT_NEAR(profile.high, std::stod(row[4]), 2e-5);
    ++term;
  }
  EXPECT_EQ(term, 7u);
  EXPECT_NEAR(fit.coefficients[6], 3.096012, 1e-6);
  EXPECT_NEAR(fit.StandardError(6), 1.67500841, 1e-6);
}

// Venables and Ripley, Modern Applied Statistics with S, 4th ed., p. 193:
// budworms, doses that kill 25, 50 and 75 % of the females.
TEST(FindEffectiveLevel, BudwormsOfMass) {
  Rows rows;
  const double dead[2][6] = {{0, 2, 6, 10, 12, 16}, {1, 4, 9, 13, 18, 20}};
  for (const double male : {0.0, 1.0}) {
    for (int dose = 0; dose < 6; ++dose) {
      rows.push_back({{male, static_cast<double>(dose)},
                      20,
                      dead[male > 0.5 ? 1 : 0][dose]});
    }
  }
  const Regression fit = FitRegression(rows, {.link = Link::kLogit});
  const double p[] = {0.25, 0.5, 0.75};
  const double value[] = {2.231265, 3.263587, 4.295910};
  const double u[] = {0.2499089, 0.2297539, 0.2746874};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto level = FindEffectiveLevel(fit, p[i], 2);
    EXPECT_NEAR(level->value, value[i], 1e-6);
    EXPECT_NEAR(level->u, u[i], 1e-6);
  }
}

TEST(FindEffectiveLevel, WuAndTian2014) {
  const double x[] = {5.5, 16.5, 11,  13.8, 10.1, 14.7, 10.4, 11.7,
                      9.7, 7.3,  7.8, 8.1,  12.2, 8.5,  11.8};
  const bool y[] = {false, true,  false, true,  false, true,  true, true,
                    true,  false, false, false, true,  false, true};
  Rows rows;
  for (std::size_t i = 0; i < std::size(x); ++i) {
    rows.push_back({{x[i]}, 1.0, y[i] ? 1.0 : 0.0});
  }
  const Regression fit = FitRegression(rows);
  const auto median = FindEffectiveLevel(fit);
  EXPECT_NEAR(median->value, 10.223008, 1e-6);
  EXPECT_NEAR(1 / fit.coefficients[1], 1.161903, 1e-6);
  EXPECT_NEAR(fit.log_likelihood, -4.065935, 1e-6);
  EXPECT_NEAR(median->wald95.low, 9.0648, 5e-5);
  EXPECT_NEAR(median->wald95.high, 11.3812, 5e-5);
  // Published by gonogo, whose optimiser stops earlier.
  EXPECT_NEAR(FindEffectiveLevel(fit, 0.1)->value, 8.733958, 2e-5);
  EXPECT_NEAR(FindEffectiveLevel(fit, 0.9)->value, 11.712057, 2e-5);
  const auto profile = MedianLevelProfile(rows, fit);
  EXPECT_NEAR(profile.low, 8.737583, 3e-5);
  EXPECT_NEAR(profile.high, 11.644123, 3e-5);
}

TEST(FindEffectiveLevel, WhereTheSlopeIsDoubtfulFiellerIsUnbounded) {
  const Rows rows{{{1}, 4, 1}, {{2}, 4, 2}, {{3}, 4, 2}, {{4}, 4, 3}};
  const auto median = FindEffectiveLevel(FitRegression(rows));
  ASSERT_TRUE(median.has_value());
  EXPECT_NEAR(median->value, 2.5, 1e-9);
  EXPECT_FALSE(median->fieller95.has_value());
  const Rows falling{{{1}, 4, 3}, {{2}, 4, 2}, {{3}, 4, 2}, {{4}, 4, 1}};
  EXPECT_FALSE(FindEffectiveLevel(FitRegression(falling)).has_value());
}

// Property: a fit does not know in what units its terms are.
TEST(FitRegression, AnswersFollowShiftAndScale) {
  const Regression plain = FitRegression(Beetles());
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Rows rows = Beetles();
    for (auto& row : rows) row.terms[0] = scale * (row.terms[0] - 0.7);
    for (const bool firth : {false, true}) {
      const auto a = FindEffectiveLevel(
          FitRegression(Beetles(), {Link::kProbit, true, firth}));
      const auto b =
          FindEffectiveLevel(FitRegression(rows, {Link::kProbit, true, firth}));
      EXPECT_NEAR(b->value / scale + 0.7, a->value, 1e-9);
      EXPECT_NEAR(b->u / scale, a->u, 1e-9);
    }
  }
  EXPECT_TRUE(plain.found());
}

TEST(FitRegression, DegenerateDataHaveAStatus) {
  using Status = RegressionStatus;
  EXPECT_EQ(FitRegression({}).status, Status::kNotIdentified);
  EXPECT_EQ(FitRegression(Rows{{{10}, 1, 1}}).status, Status::kNotIdentified);
  EXPECT_EQ(FitRegression(Rows{{{10}, 5, 2}}).status, Status::kNotIdentified);
  EXPECT_EQ(FitRegression(Rows{{{5}, 1, 0}, {{10}, 1, 0}}).status,
            Status::kNoMaximum);
  EXPECT_EQ(FitRegression(Rows{{{5}, 1, 0}, {{10}, 1, 1}}).status,
            Status::kNoMaximum);
  // gonogo21: quasi-separated.
  EXPECT_EQ(
      FitRegression(Rows{{{14}, 1, 0}, {{16}, 1, 0}, {{16}, 1, 1}}).status,
      Status::kNoMaximum);
  for (const auto link : {Link::kProbit, Link::kLogit}) {
    EXPECT_TRUE(
        FitRegression(Rows{{{5}, 1, 0}, {{10}, 1, 1}}, {link, true, true})
            .found());
  }
}

TEST(FitRegression, RefusesImpossibleRowsByName) {
  EXPECT_THROW(FitRegression(Rows{{{1}, 1, 2}}), std::invalid_argument);
  EXPECT_THROW(FitRegression(Rows{{{1}, 0, 0}}), std::invalid_argument);
  EXPECT_THROW(FitRegression(Rows{{{1}, 1, 0}, {{1, 2}, 1, 0}}),
               std::invalid_argument);
  EXPECT_THROW(FitRegression(Rows{{{NAN}, 1, 0}}), std::invalid_argument);
  EXPECT_THROW(CoefficientProfile({}, Regression{}, 0), std::invalid_argument);
  const Regression probit =
      FitRegression(Beetles(), {Link::kProbit, true, true});
  EXPECT_THROW(CoefficientProfile(Beetles(), probit, 0), std::invalid_argument);
  EXPECT_THROW(FindEffectiveLevel(probit, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
