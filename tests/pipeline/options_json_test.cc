#include "app/documents/options_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/measure/options_hash.h"

namespace touchdown::pipeline {
namespace {

using report::Json;

// None has the value that it begins with.
AnalyzeOptions AllTold() {
  AnalyzeOptions told;
  told.fps = 2000.5;
  told.gamma = 2.25;
  told.scale_px_per_m = core::Estimate{1000.5, 0.5, std::nullopt};
  told.body_kind = core::BodyKind::kRectangle;
  told.diameter_m = core::Estimate{0.5, 0.25, std::nullopt};
  told.long_m = core::Estimate{0.75, 0.25, std::nullopt};
  told.short_m = core::Estimate{0.25, 0.125, std::nullopt};
  told.ground = calib::MakeGroundLine({10.0, 97.5}, {230.0, 98.5}, 0.5);
  told.contact_frame = 5;
  told.first_frame = 2;
  told.last_frame = 90;
  told.region = {1, 2, 30, 40};
  told.angle_kind = core::AngleKind::kFace;
  told.bounce_height_m = 0.125;
  told.calibration.emplace();
  told.calibration->camera = "left";
  told.calibration->date = "2026-11-21";
  told.calibration->expires = "2027-11-21";
  told.calibration->picture = {640, 400, calib::SensorCorner{}};
  told.crop = calib::SensorCorner{16, 32};
  told.stop_early = true;
  return told;
}

std::vector<std::string> Names(std::optional<OptionScope> only = std::nullopt) {
  std::vector<std::string> names;
  const AnalyzeOptions options;
  VisitOptions(options, [&](const char* name, const auto&, OptionScope scope) {
    if (!only || scope == *only) names.emplace_back(name);
  });
  return names;
}

TEST(OptionsJson, EachOptionComesBack) {
  const Json json = OptionsJson(AllTold());
  std::vector<std::string> written;
  for (const auto& [name, value] : json.items()) written.push_back(name);
  EXPECT_EQ(written, Names());
  EXPECT_EQ(OptionsJson(ReadOptions(json)), json);
}

TEST(OptionsJson, WhatIsNotToldIsAbsent) {
  const Json json = OptionsJson(AnalyzeOptions());
  EXPECT_EQ(json.dump(), R"({"frames":[0,-1],"region":[0,0,0,0]})");
  EXPECT_EQ(OptionsJson(ReadOptions(json)), json);
}

TEST(OptionsJson, AnotherClipGetsWhatIsOfTheCamera) {
  const Json kept =
      OptionsJson(ReadOptions(OptionsJson(AllTold()), OptionScope::kCamera));
  for (const std::string& name : Names(OptionScope::kCamera)) {
    EXPECT_TRUE(kept.contains(name)) << name;
  }
  EXPECT_FALSE(kept.contains("contact_frame"));
  EXPECT_FALSE(kept.contains("diameter_m"));
  EXPECT_EQ(kept["frames"], Json({0, -1}));
}

TEST(OptionsJson, AnUnknownWordIsNoKind) {
  Json json = OptionsJson(AllTold());
  json["body_kind"] = "cube";
  EXPECT_THROW(ReadOptions(json), std::invalid_argument);
}

// Each option decides the answer: without it the hash is another.
TEST(OptionsHash, HangsOnEachOption) {
  const AnalyzeOptions told = AllTold();
  const Json unset = OptionsJson(AnalyzeOptions());
  for (const std::string& name : Names()) {
    Json json = OptionsJson(told);
    json.erase(name);
    if (unset.contains(name)) json[name] = unset[name];
    EXPECT_NE(OptionsHash(ReadOptions(json)), OptionsHash(told)) << name;
  }
}

}  // namespace
}  // namespace touchdown::pipeline
