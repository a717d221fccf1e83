#include "touchdown/rig/spring.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace touchdown::rig {
namespace {

using testing::HasSubstr;
using testing::Not;

// 2 mm steel wire on 18 mm outside, the baseline of the reference cases (SP01).
Spring Baseline() {
  Spring spring;
  spring.shear_modulus_pa = 79.3e9;
  spring.wire_diameter_m = 2e-3;
  spring.coil_diameter_m = 18e-3;
  spring.coil_diameter = CoilDiameter::kOuter;
  spring.active_coils = 10.0;
  spring.total_coils = 12.0;
  return spring;
}

std::string MessageOf(const Spring& spring) {
  try {
    (void)Stiffness(spring);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

std::string All(const std::vector<Finding>& findings) {
  std::string out;
  for (const Finding& f : findings) {
    out += (f.severity == Severity::kRefusal ? "R:" : "W:") + f.what + "\n";
  }
  return out;
}

TEST(Spring, StiffnessByHand) {
  // 79.3e9 (2e-3)^4 / (8 10 (16e-3)^3) = 79.3e9 1.6e-11 / (80 4.096e-6)
  //   = 1.2688 / 3.2768e-4 = 3872.0703125 N/m.
  EXPECT_NEAR(StiffnessOfOne(Baseline()), 3872.0703125, 1e-10);
  EXPECT_NEAR(Stiffness(Baseline()), 7744.140625, 1e-10);
  // With 18 mm for 16 mm: times (8/9)^3 = 512/729.
  EXPECT_NEAR(StiffnessAsPrinted(Baseline()), 7744.140625 * 512.0 / 729.0,
              1e-9);
}

TEST(Spring, ThreeWaysToMeasureTheCoilAgree) {
  for (const double wire : {0.3e-3, 1e-3, 2e-3}) {
    Spring spring = Baseline();
    spring.wire_diameter_m = wire;
    spring.coil_diameter = CoilDiameter::kMean;
    spring.coil_diameter_m = 16e-3;
    const double mean = Stiffness(spring);
    const double printed = StiffnessAsPrinted(spring);
    spring.coil_diameter = CoilDiameter::kOuter;
    spring.coil_diameter_m = 16e-3 + wire;
    EXPECT_NEAR(Stiffness(spring), mean, 1e-14 * mean);
    EXPECT_NEAR(StiffnessAsPrinted(spring), printed, 1e-14 * printed);
    spring.coil_diameter = CoilDiameter::kInner;
    spring.coil_diameter_m = 16e-3 - wire;
    EXPECT_NEAR(Stiffness(spring), mean, 2e-14 * mean);
    EXPECT_NEAR(StiffnessAsPrinted(spring), printed, 2e-14 * printed);
  }
}

TEST(Spring, ScalesAsEquation11Says) {
  const Spring base = Baseline();
  for (const double k : {0.25, 0.5, 3.0, 7.0}) {
    Spring larger = base;  // every length times k: H times k
    larger.wire_diameter_m *= k;
    larger.coil_diameter_m *= k;
    EXPECT_NEAR(Stiffness(larger), k * Stiffness(base),
                1e-13 * k * Stiffness(base));
    Spring longer = base;  // more coils: H over k
    longer.active_coils *= k;
    longer.total_coils *= 10.0;
    EXPECT_NEAR(Stiffness(longer), Stiffness(base) / k,
                1e-14 * Stiffness(base) / k);
  }
  Spring three = base;
  three.count = 3;
  EXPECT_NEAR(Stiffness(three), 1.5 * Stiffness(base), 1e-11);
  EXPECT_NEAR(SpringMass(three), 1.5 * SpringMass(base), 1e-16);
  // Springs side by side surge each on its own.
  EXPECT_NEAR(SurgeFrequency(three), SurgeFrequency(base), 1e-11);
}

TEST(Spring, WahlFactorOfTextbook) {
  // C = 8: 31/28 + 0.615/8; C = 4: 15/12 + 0.615/4 (Shigley, chapter 10).
  EXPECT_DOUBLE_EQ(WahlFactor(8.0), 31.0 / 28.0 + 0.076875);
  EXPECT_DOUBLE_EQ(WahlFactor(4.0), 1.25 + 0.15375);
  EXPECT_NEAR(WahlFactor(1e9), 1.0, 1e-8);
  EXPECT_THROW((void)WahlFactor(1.0), std::invalid_argument);
  EXPECT_THROW((void)WahlFactor(std::numeric_limits<double>::infinity()),
               std::invalid_argument);
}

TEST(Spring, ShearStressByHand) {
  // F = 3872.07 0.05 = 193.6035 N; 8 F D/(pi d^3) = 24.78125/(pi 8e-9) Pa.
  const double plain = 24.78125 / (std::numbers::pi * 8e-9);
  const SpringReport report = CheckSpring(Baseline(), 0.05);
  EXPECT_NEAR(report.force_of_one_n, 193.603515625, 1e-11);
  EXPECT_NEAR(report.uncorrected_shear_pa, plain, 1e-14 * plain);
  EXPECT_NEAR(report.max_shear_pa, plain * (31.0 / 28.0 + 0.076875), 1e-5);
  EXPECT_EQ(CheckSpring(Baseline(), 0.0).max_shear_pa, 0.0);
}

TEST(Spring, MassAndSurgeByHand) {
  // Wire: pi 16e-3 12 m long, pi 1e-6 m^2 thick.
  const double pi = std::numbers::pi;
  const double mass = 2.0 * 7850.0 * pi * 1e-6 * pi * 0.016 * 12.0;
  EXPECT_NEAR(SpringMass(Baseline()), mass, 1e-17);
  EXPECT_NEAR(SurgeFrequency(Baseline()),
              0.5 * std::sqrt(3872.0703125 / (mass / 2.0)), 1e-11);
}

TEST(Spring, CoilBindIsRefused) {  // reference case SP10
  SpringLimits limits;
  limits.free_length_m = 0.1;
  const SpringReport report = CheckSpring(Baseline(), 0.08, limits);
  EXPECT_NEAR(*report.clearance_m, -0.004, 1e-16);
  EXPECT_FALSE(Allowed(report.findings));
  EXPECT_THAT(All(report.findings), HasSubstr("R:coil bind"));
}

TEST(Spring, ClearanceBelow15PercentIsRefused) {
  SpringLimits limits;
  limits.free_length_m = 0.1;  // 76 mm to solid: 15 % are left at 66.087 mm
  EXPECT_TRUE(Allowed(CheckSpring(Baseline(), 0.0660, limits).findings));
  const SpringReport tight = CheckSpring(Baseline(), 0.0662, limits);
  EXPECT_FALSE(Allowed(tight.findings));
  EXPECT_THAT(All(tight.findings), HasSubstr("at least 15 % is needed"));
  EXPECT_NEAR(*tight.clearance_share, 0.0098 / 0.0662, 1e-14);
}

TEST(Spring, StressAboveAllowableIsRefused) {
  SpringLimits limits;
  limits.allowable_shear_pa = 900e6;  // reached at 38.545 mm
  EXPECT_TRUE(Allowed(CheckSpring(Baseline(), 0.0385, limits).findings));
  const SpringReport over = CheckSpring(Baseline(), 0.0386, limits);
  EXPECT_FALSE(Allowed(over.findings));
  EXPECT_THAT(All(over.findings), HasSubstr("R:shear stress"));
}

TEST(Spring, WhatIsNotCheckedIsSaid) {
  const std::string all = All(CheckSpring(Baseline(), 0.05).findings);
  EXPECT_THAT(all, HasSubstr("no free length given"));
  EXPECT_THAT(all, HasSubstr("no allowable shear stress given"));
  EXPECT_THAT(all, Not(HasSubstr("R:")));
}

TEST(Spring, IndexAndBucklingWarn) {
  Spring thin = Baseline();
  thin.wire_diameter_m = 1e-3;
  thin.coil_diameter_m = 20e-3;  // index 19, reference case SP06
  EXPECT_THAT(All(CheckSpring(thin, 0.01).findings),
              HasSubstr("W:spring index 19 is outside 4 .. 12"));
  Spring thick = Baseline();
  thick.coil_diameter_m = 8e-3;  // index 3
  EXPECT_THAT(All(CheckSpring(thick, 0.01).findings), HasSubstr("index 3 "));
  EXPECT_THAT(All(CheckSpring(Baseline(), 0.01).findings),
              Not(HasSubstr("index")));
  SpringLimits limits;
  limits.free_length_m = 0.084;  // 5.25 mean diameters
  EXPECT_THAT(All(CheckSpring(Baseline(), 0.01, limits).findings),
              Not(HasSubstr("buckle")));
  limits.free_length_m = 0.085;  // 5.31
  EXPECT_THAT(All(CheckSpring(Baseline(), 0.01, limits).findings),
              HasSubstr("W:may buckle"));
}

TEST(Spring, ImpossibleInputIsRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Spring s = Baseline();
  s.shear_modulus_pa = 0.0;
  EXPECT_THAT(MessageOf(s), HasSubstr("shear_modulus_pa is 0, must be pos"));
  s = Baseline();
  s.wire_diameter_m = -2e-3;
  EXPECT_THAT(MessageOf(s), HasSubstr("wire_diameter_m is -0.002"));
  s = Baseline();
  s.coil_diameter_m = nan;
  EXPECT_THAT(MessageOf(s), HasSubstr("coil_diameter_m is nan"));
  s = Baseline();
  s.active_coils = std::numeric_limits<double>::infinity();
  EXPECT_THAT(MessageOf(s), HasSubstr("active_coils is inf"));
  s = Baseline();
  s.total_coils = 9.0;
  EXPECT_THAT(MessageOf(s), HasSubstr("total_coils is 9, must be at least"));
  s = Baseline();
  s.count = 0;
  EXPECT_THAT(MessageOf(s), HasSubstr("count is 0"));
  s = Baseline();
  s.density_kg_per_m3 = 0.0;
  EXPECT_THAT(MessageOf(s), HasSubstr("density_kg_per_m3"));
  s = Baseline();
  s.coil_diameter_m = 4e-3;  // outer diameter of two wires: no hole
  EXPECT_THAT(MessageOf(s), HasSubstr("greater than the wire diameter"));
  EXPECT_THROW((void)CheckSpring(Baseline(), -1e-3), std::invalid_argument);
}

TEST(Spring, KindsHaveNames) {
  for (const CoilDiameter kind :
       {CoilDiameter::kMean, CoilDiameter::kOuter, CoilDiameter::kInner}) {
    EXPECT_EQ(ParseCoilDiameter(Name(kind)), kind);
  }
  EXPECT_FALSE(ParseCoilDiameter("D2").has_value());
}

}  // namespace
}  // namespace touchdown::rig
